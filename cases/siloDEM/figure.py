# SPDX-License-Identifier: GPL-3.0-or-later
"""The grains in the silo at three times, and how many are left over time, of the gas, too; prints the flow rates and their constants in Beverloo's
law."""
import os
import sys

import numpy as np

import haff
from haff.case import grains
from haff.plot import figures, script
from studies.checks import softGrains

ORIFICE, DEPTH, DIAMETER, PACKING, GRAVITY = 6e-3, 4e-3, 1e-3, 0.58, 9.81

folder = script.folder()
case = haff.Case(folder)
rows = np.loadtxt(os.path.join(folder, "postProcessing", "grains", "0", "grains.dat"))
t, left = rows[:, 0], rows[:, 1]
fig, axes = figures.panels(1, 4, height=2.8)
for ax, at in zip(axes[0], (0.05, 0.15, 0.3)):
    x = 1e3 * grains.places(case, case.time(at))
    ax.plot(x[:, 0], x[:, 1], ".", markersize=1.5)
    ax.set_xlim(-10, 10)
    ax.set_ylim(-8, 40)
    ax.set_aspect("equal")
    figures.label(ax, "$x$ (mm)", "$y$ (mm)", f"{at:g} s")
gas = haff.Case(os.path.join(folder, "gas"))
for run, name in ((case, "grains"), (gas, "gas")):
    axes[0][3].plot([float(at) for at in run.times], [softGrains.above(run, at) for at in run.times], label=name)
axes[0][3].legend()
figures.label(axes[0][3], "$t$ (s)", "grains above the slot")
steady = (t > 0.1) & (t <= 0.2)
rate = -np.polyfit(t[steady], left[steady], 1)[0]
# Q = C phi sqrt(g) depth (W - k d)^(3/2) of volume, for a slot; k = 1.4
law = PACKING * np.sqrt(GRAVITY) * DEPTH * (ORIFICE - 1.4 * DIAMETER) ** 1.5 / (np.pi / 6 * DIAMETER**3)
print(f"{rate:.0f} grains a second from 0.1 to 0.2 s, C = {rate / law:.2f} in Beverloo's law with k = 1.4; left at the end {left[-1]:.0f}", file=sys.stderr)
for run, name in ((case, "grains"), (gas, "gas")):
    rate = softGrains.outflow(run, None, run.time(0.2), 0.1)
    print(f"{name}: {rate:.0f} in a second through the slot from 0.1 to 0.2 s, C = {rate / law:.2f}", file=sys.stderr)
script.save(fig, "siloDEM")
