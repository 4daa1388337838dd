# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing around the wedge, of the gas and of grains, and over the polar angle about its tip, beside the exact shock of elastic disks."""
import os
import sys

import haff
from haff.case import grains
from haff.plot import cellmap, figures, script
from studies.checks import wedgeShocks
from studies.exact import diskShocks

folder = script.folder()
runs = {name: haff.Case(os.path.join(folder, name)) for name in (".", "grains", "elastic", "grainsElastic")}
time = runs["."].time(None)
fig = figures.plt.figure(figsize=(7.5, 2.8), layout="constrained")
gas, cloud, profile = fig.subplots(1, 3)
shown = cellmap.draw(gas, runs["."], runs["."].field("alpha", time), colours="viridis", span=(0.1, 0.26), unit=r"$\sigma$")
x = grains.places(runs["grains"], time)
cloud.plot(x[:, 0], x[:, 1], ".", color=figures.COLOURS[0], markersize=0.8)
cloud.add_patch(figures.plt.Polygon([(0, 0), (150, 40.2), (150, 0)], color="0.5"))
for axes in (gas, cloud):
    axes.set(xlim=(-20, 150), ylim=(0, 130), aspect="equal")
figures.label(gas, r"$x/\sigma$", r"$y/\sigma$", "gas, $e$ = 0.97: packing")
figures.label(cloud, r"$x/\sigma$", "", "grains, $e$ = 0.97")
for colour, names, e in ((figures.COLOURS[0], (".", "grains"), 0.97), (figures.COLOURS[1], ("elastic", "grainsElastic"), 1)):
    for name, mark in zip(names, ("-", "o")):
        angle, alpha = wedgeShocks.sectors(runs[name], "alpha", time)
        kind = "grains" if "grains" in name else "gas"
        profile.plot(angle, alpha, mark, color=colour, markersize=2.5, label=f"{kind}, $e$ = {e}")
        print(f"{kind}, e = {e}: shock at {wedgeShocks.angle(runs[name], None, time, 0.155):.2f} degrees, packing {wedgeShocks.behind(runs[name], 'alpha', time, 25):.4f} behind", file=sys.stderr)
beta, packed = diskShocks.wedge(0.1, 0.003, wedgeShocks.WEDGE)
print(f"exact, e = 1: {beta:.2f} degrees, {packed:.4f}", file=sys.stderr)
profile.plot([wedgeShocks.WEDGE, beta, beta, 59], [packed, packed, 0.1, 0.1], ":", color="0.3", label="exact, $e$ = 1")
profile.legend(fontsize=6)
figures.label(profile, "angle from the stream (degrees)", r"$\alpha$")
script.save(fig, "wedgeDisks")
