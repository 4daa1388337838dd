# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing around the front of a cylinder, of the gas and of the grains, and along the axis ahead of the nose, with and without loss in impacts."""
import os
import sys

import haff
from haff.plot import cellmap, figures, script
from studies.checks import bowShocks
from studies.exact import diskShocks

folder = script.folder()
runs = {name: haff.Case(os.path.join(folder, name)) for name in (".", "grains", "elastic", "grainsElastic")}
time = runs["."].time(None)
fig = figures.plt.figure(figsize=(8.5, 3.3), layout="constrained")
axes = fig.subplots(1, 3, width_ratios=(1, 1, 1.5))
for k, (name, title) in enumerate(((".", "gas"), ("grains", "grains"))):
    cellmap.draw(axes[k], runs[name], runs[name].field("alpha", time), colours="viridis", span=(0.05, 0.3), unit=r"$\sigma$")
    axes[k].set(xlim=(-560, 0), ylim=(0, 900), aspect="equal")
    figures.label(axes[k], r"$x/\sigma$", r"$y/\sigma$" if k == 0 else "", f"{title}, $e$ = 0.98: packing")
for colour, names, e in ((figures.COLOURS[0], (".", "grains"), 0.98), (figures.COLOURS[1], ("elastic", "grainsElastic"), 1)):
    for name, mark in zip(names, ("-", "o")):
        kind, case = "grains" if "grains" in name else "gas", runs[name]
        axes[2].plot(*bowShocks.profile(case, "alpha", time), mark, color=colour, markersize=2.5, label=f"{kind}, $e$ = {e}")
        print(f"{kind}, e = {e}: stand-off {bowShocks.stand_off(case, None, time):.3f} R, drag coefficient {bowShocks.drag(case, None, time):.3f}", file=sys.stderr)
packed, hot = diskShocks.normal(bowShocks.STREAM, bowShocks.T)
print(f"normal shock, e = 1: packing {packed:.4f}, T {hot:.4f}; level {bowShocks.level():.4f}", file=sys.stderr)
axes[2].axhline(packed, linestyle=":", color="0.3", linewidth=0.9, label="normal shock, $e$ = 1")
axes[2].set(xlim=(0, 1.7), yscale="log")
axes[2].legend(fontsize=6)
figures.label(axes[2], "distance from the nose, radii", r"$\alpha$")
script.save(fig, "cylinderDisks")
