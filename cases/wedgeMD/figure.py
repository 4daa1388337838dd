# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing around the step, of the gas and of the grains, and over the distance from its faces, of all five runs."""
import os
import sys

import haff
from haff.plot import cellmap, figures, script
from studies.checks import wedges

RUNS = ((".", "gas of the paper", "0.3", ":"), ("viscous", "gas, $d$ = 0.1", figures.COLOURS[0], "-"), ("grains", "grains, $d$ = 0.1", figures.COLOURS[0], "o"),
        ("viscousSmall", "gas, $d$ = 0.05", figures.COLOURS[1], "-"), ("grainsSmall", "grains, $d$ = 0.05", figures.COLOURS[1], "o"))
folder = script.folder()
runs = {name: haff.Case(os.path.join(folder, name)) for name, *_ in RUNS}
time = runs["."].time(None)
fig = figures.plt.figure(figsize=(9, 3), layout="constrained")
axes = fig.subplots(1, 3, width_ratios=(1, 1, 1.3))
for k, (name, title) in enumerate(((".", "gas of the paper"), ("grainsSmall", "grains, $d$ = 0.05"))):
    cellmap.draw(axes[k], runs[name], runs[name].field("alpha", time), colours="viridis", span=(0.018, 0.1), unit="cm")
    axes[k].set(xlim=(0, 10), ylim=(0, 10), aspect="equal")
    figures.label(axes[k], "$x$ (cm)", "$y$ (cm)" if k == 0 else "", f"{title}: packing")
for name, label, colour, mark in RUNS:
    axes[2].plot(*wedges.off_faces(runs[name], "alpha", time), mark, color=colour, markersize=3, label=label)
    print(f"{label}: front {wedges.front(runs[name], None, time):.3f} cm off the faces, packing of the layer {wedges.layer(runs[name], None, time):.3f} times the stream's",
          file=sys.stderr)
axes[2].set(xlim=(0, 2.5), ylim=(0, 0.1))
axes[2].legend(fontsize=6)
figures.label(axes[2], "distance from the faces (cm)", r"$\alpha$")
script.save(fig, "wedgeMD")
