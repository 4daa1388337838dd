# SPDX-License-Identifier: GPL-3.0-or-later
"""The grains at four times, and where the gas beside them has half of its greatest packing; prints how far both have come (99 % of the mass
lies before it) and their heights at the wall."""
import os
import sys

import numpy as np

import haff
from haff.case import grains
from haff.plot import figures, script
from studies.checks import softGrains

MOST = 0.6  # packing of the bed

folder = script.folder()
runs = {"grains": haff.Case(folder), "gas": haff.Case(os.path.join(folder, "gas"))}
times = [runs["grains"].times[i] for i in np.linspace(1, len(runs["grains"].times) - 1, 4).astype(int)]
fig, axes = figures.panels(2, 2, height=1.6)
for ax, t in zip(np.ravel(axes), times):
    x = 1e3 * grains.places(runs["grains"], t)
    ax.plot(x[:, 0], x[:, 1], ".", markersize=1.5)
    gas, at = runs["gas"], 1e3 * runs["gas"].centres
    plane = np.flatnonzero(at[:, 2] < at[:, 2].min() + 1e-6)
    ax.tricontour(at[plane, 0], at[plane, 1], gas.field("alpha", gas.time(float(t)))[plane], [MOST / 2], colors=[figures.COLOURS[1]])
    ax.set_xlim(0, 80)
    ax.set_ylim(0, 30)
    ax.set_aspect("equal")
    figures.label(ax, "$x$ (mm)", "$y$ (mm)", f"$t$ = {float(t):g} s")
    print(f"{float(t):g} s: " + "; ".join(f"{name}: reach {1e3 * softGrains.reach(run, None, run.time(float(t))):.1f} mm, height at the wall "
          f"{1e3 * softGrains.height(run, None, run.time(float(t))):.1f} mm" for name, run in runs.items()), file=sys.stderr)
script.save(fig, "columnDEM")
