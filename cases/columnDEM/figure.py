# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing in the plane of the collapse at four times; prints the runout (99 % of the grains lie before it) and the height at the wall."""
import sys

import numpy as np

import haff
from haff.case import grains
from haff.plot import figures, script

WIDTH = 12.0  # mm, of the column

folder = script.folder()
case = haff.Case(folder)
times = [case.times[i] for i in np.linspace(1, len(case.times) - 1, 4).astype(int)]
fig, axes = figures.panels(2, 2, height=1.6)
for ax, t in zip(np.ravel(axes), times):
    x = 1e3 * grains.places(case, t)
    ax.plot(x[:, 0], x[:, 1], ".", markersize=1.5)
    ax.set_xlim(0, 80)
    ax.set_ylim(0, 30)
    ax.set_aspect("equal")
    figures.label(ax, "$x$ (mm)", "$y$ (mm)", f"$t$ = {float(t):g} s")
    reach = np.quantile(x[:, 0], 0.99) + 0.5
    print(f"{float(t):g} s: runout {reach:.1f} mm, {reach / WIDTH - 1:.2f} widths, height at the wall {np.quantile(x[x[:, 0] < 4, 1], 0.99) + 0.5:.1f} mm", file=sys.stderr)
script.save(fig, "columnDEM")
