# SPDX-License-Identifier: GPL-3.0-or-later
"""Velocity, packing and temperature across the gap in the mean of the last windows, and the forces on the plates over time; prints the
stresses and their ratio."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script

GAP, AREA = 10e-3, 1e-4  # m, m^2


def table(folder):
    path = os.path.join(folder, "postProcessing", "grains", "0", "grains.dat")
    with open(path) as f:
        names = [line for line in f if line.startswith("# Time")][0].split()[1:]
    rows = np.loadtxt(path)
    return {name: rows[:, i] for i, name in enumerate(names)}


folder = script.folder()
case = haff.Case(folder)
times = case.times[-2:]
layer = np.round(case.centres[:, 1] / 1e-3 - 0.5).astype(int)


def across(field, component=None):
    values = np.mean([case.field(field, t) for t in times], axis=0)
    values = values if component is None else values[:, component]
    return np.array([values[layer == i].mean() for i in range(layer.max() + 1)])


y, at = np.arange(layer.max() + 1) + 0.5, table(folder)
fig, axes = figures.panels(1, 4, height=2.4)
for ax, values, label in zip(axes[0], (across("U", 0), across("alpha"), across("T")), ("$u_x$ (m/s)", r"$\alpha$", "$T$ (m$^2$/s$^2$)")):
    ax.plot(values, y)
    figures.label(ax, label, "$y$ (mm)")
shear = [name for name in at if name.endswith("_lid_x")][0]
normal = shear[:-1] + "y"
axes[0][3].plot(at["Time"], at[shear] / AREA, label="shear")
axes[0][3].plot(at["Time"], at[normal] / AREA, label="normal")
axes[0][3].legend()
figures.label(axes[0][3], "$t$ (s)", "stress on the lid (Pa)")
late = at["Time"] > 0.6 * at["Time"][-1]
tau, p = -at[shear][late].mean() / AREA, at[normal][late].mean() / AREA
low = at[[n for n in at if n.endswith("_floor_x")][0]][late].mean() / AREA
inner = slice(3, 7)
print(f"shear stress {tau:.1f} Pa at the lid, {low:.1f} at the floor, normal {p:.1f}, ratio {tau / p:.3f}; in the middle: -P_xy {-across('pShear', 0)[inner].mean():.1f}, "
      f"P_yy {across('pComponents', 1)[inner].mean():.1f}, slip at the lid {0.5 - across('U', 0)[-1]:.3f} m/s", file=sys.stderr)
script.save(fig, "shearDEM")
