# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing ahead of the piston, and the way of the fronts in time: gas, grains, theory."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.checks import pistons
from studies.exact import diskShocks

folder = script.folder()
runs = {name: haff.Case(os.path.join(folder, name)) for name in (".", "elastic", "grains", "grainsElastic")}
fig, ((dense, thin, way),) = figures.panels(1, 3, width=7.5, height=2.6)
wanted = diskShocks.piston(0.1)
for axes, names, times, level, e in ((dense, (".", "grains"), ("100", "200", "300"), 0.5, 0.9), (thin, ("elastic", "grainsElastic"), ("100", "200"), 0.16, 1)):
    for name, style in zip(names, ("-", ":")):
        for colour, time in zip(figures.COLOURS, times):
            x, alpha = pistons.profile(runs[name], "alpha", time)
            alpha = np.convolve(alpha, np.full(pistons.SMOOTH, 1 / pistons.SMOOTH), "same")
            axes.plot(x[3:-3], alpha[3:-3], style, color=colour, label=f"{'grains' if 'grains' in name else 'gas'}, $t$ = {time}")
    axes.legend(fontsize=6)
    figures.label(axes, r"$x/\sigma$", r"$\alpha$", f"$e$ = {e}")
dense.set_xlim(0, 80)
thin.set_xlim(0, 240)
thin.axhline(wanted[0], color="0.6", linewidth=0.6)
for colour, names, level, end, law in ((figures.COLOURS[0], (".", "grains"), 0.5, 300, 0.1 / 0.72), (figures.COLOURS[1], ("elastic", "grainsElastic"), 0.16, 200, wanted[2])):
    t = np.array([float(t) for t in runs["."].times if (80 if level == 0.5 else 20) <= float(t) <= end])
    for name, mark in zip(names, ("-", "o")):
        x = [pistons.front(runs[name], f"{time:g}", level) for time in t]
        way.plot(t, x, mark, color=colour, markersize=2, label=f"{'grains' if 'grains' in name else 'gas'}, $e$ = {1 if 'lastic' in name else 0.9}")
        print(f"{name}: speed of the front {pistons.speed(runs[name], None, f'{end}', level):.4f}, by theory {law:.4f}", file=sys.stderr)
way.legend(fontsize=6)
figures.label(way, "$t$", r"front$/\sigma$")
script.save(fig, "piston")
