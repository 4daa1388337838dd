# SPDX-License-Identifier: GPL-3.0-or-later
"""Velocity, packing, pressure and spin over the height in the mean of the last window, and the forces on the floor over time; prints
friction on the floor, and the balance of momentum."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script

AREA, GRAVITY = 2e-4, (4.1459, 8.8909)


def table(folder):
    path = os.path.join(folder, "postProcessing", "grains", "0", "grains.dat")
    with open(path) as f:
        names = [line for line in f if line.startswith("# Time")][0].split()[1:]
    rows = np.loadtxt(path)
    return {name: rows[:, i] for i, name in enumerate(names)}


folder = script.folder()
case, at = haff.Case(folder), table(folder)
layer = np.round(case.centres[:, 1] / 1e-3 - 0.5).astype(int)


def over(field, component=None):
    values = case.field(field, case.times[-1])
    values = values if component is None else values[:, component]
    return np.array([values[layer == i].mean() for i in range(layer.max() + 1)])


y = np.arange(layer.max() + 1) + 0.5
fig, axes = figures.panels(1, 4, height=2.4)
lines = (over("U", 0), over("alpha"), over("pComponents", 1))
for ax, values, label in zip(axes[0], lines, ("$u_x$ (m/s)", r"$\alpha$", "$P_{yy}$ (Pa)")):
    ax.plot(values, y)
    ax.set_ylim(0, 14)
    figures.label(ax, label, "$y$ (mm)")
along, down = (at[[n for n in at if n.endswith(f"_floor_{k}")][0]] for k in "xy")
axes[0][3].plot(at["Time"], along / AREA, label="along")
axes[0][3].plot(at["Time"], -down / AREA, label="down")
axes[0][3].legend()
figures.label(axes[0][3], "$t$ (s)", "stress on the floor (Pa)")
late = at["Time"] > 0.5 * at["Time"][-1]
mass = at["grains"][0] * 1.361356816555577e-6
gain = np.polyfit(at["Time"][late], at["momentum_x"][late], 1)[0]
print(f"friction on the floor over the load {along[late].mean() / -down[late].mean():.3f}; load over the weight {-down[late].mean() / (mass * GRAVITY[1]):.4f}; "
      f"gain of momentum over weight along less friction {gain / (mass * GRAVITY[0] - along[late].mean()):.4f}; mean velocity at the end "
      f"{at['momentum_x'][-1] / mass:.3f} m/s", file=sys.stderr)
script.save(fig, "chuteDEM")
