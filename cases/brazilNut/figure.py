# SPDX-License-Identifier: GPL-3.0-or-later
"""Disks of two sizes on a shaken floor: the grains of a member at the end, the height of the big ones over the small ones in time for three
masses, and the packing of both over the height at the end, means of six runs with standard errors."""
import os
import sys

import numpy as np
from matplotlib.collections import EllipseCollection

import haff
from haff.case import grains
from haff.plot import figures, script
from studies.checks import grainCases

folder = script.folder()
runs = {1: ".", 2: "m2", 4: "m4"}
BIG, SMALL = figures.COLOURS[1], figures.COLOURS[5]
fig = figures.plt.figure(figsize=(9, 3.6), layout="constrained")
axes = fig.subplots(1, 4, width_ratios=(1, 1, 1.9, 1.5))
for k, m in enumerate((1, 4)):
    c = grains.read(haff.Case(os.path.join(folder, runs[m], "ensemble", "seed=1")), haff.Case(os.path.join(folder, runs[m])).time(None))
    for shift in (-20, 0, 20):
        axes[k].add_collection(EllipseCollection(c["d"], c["d"], 0 * c["d"], units="xy", offsets=c["x"][:, :2] + [shift, 0], transOffset=axes[k].transData,
                                                 facecolors=[BIG if s == 0 else SMALL for s in c["species"]], linewidths=0))
    axes[k].set(xlim=(0, 20), ylim=(0, 28), aspect="equal")
    figures.label(axes[k], "$x$", "$y$" if k == 0 else "", f"mass of the big: {m}")
for k, (m, name) in enumerate(runs.items()):
    path = os.path.join(folder, name)
    t, height = grainCases.rise(path)
    mean, error = height.mean(axis=0), height.std(axis=0, ddof=1) / np.sqrt(len(height))
    axes[2].plot(t, mean, color=figures.COLOURS[k], label=f"mass {m}")
    axes[2].fill_between(t, mean - error, mean + error, color=figures.COLOURS[k], alpha=0.25, linewidth=0)
    print("mass %d: %.3f +- %.3f in the last quarter" % (m, *grainCases.risen(path)), file=sys.stderr)
axes[2].axhline(0, color="0.7", linewidth=0.8)
axes[2].legend(fontsize=7)
figures.label(axes[2], "$t$", "height over the small ones")
case = haff.Case(folder)
x, y, _ = case.centres.T
rows = np.unique(y)
for name, colour in (("big", BIG), ("small", SMALL)):
    alpha = [case.field(f"alpha.{name}")[y == at].mean() for at in rows]
    error = [np.sqrt(np.sum(case.field(f"alphaError.{name}")[y == at] ** 2)) / np.sum(y == at) for at in rows]
    axes[3].errorbar(alpha, rows, xerr=error, color=colour, marker="o", markersize=3, linewidth=0.9, label=name)
axes[3].set(ylim=(0, 28))
axes[3].legend(fontsize=7)
figures.label(axes[3], r"$\alpha$", "$y$", "mass 1, end of the run")
script.save(fig, "brazilNut")
