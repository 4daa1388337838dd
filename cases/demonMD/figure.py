# SPDX-License-Identifier: GPL-3.0-or-later
"""The grains at the end, and the share of them in the left compartment over time, beside the run that is shaken more."""
import os
import sys

import numpy as np
from matplotlib.collections import EllipseCollection

import haff
from haff.case import grains
from haff.plot import figures, script

folder = script.folder()
runs = {"acceleration 10 g": folder, "20 g": os.path.join(folder, "strong")}
fig = figures.plt.figure(figsize=(7, 3.4), layout="constrained")
axes = fig.subplots(1, 3, width_ratios=(1, 1, 1.4))
for k, (name, path) in enumerate(runs.items()):
    case = haff.Case(path)
    times = [float(t) for t in case.times]
    share = np.array([np.mean(grains.places(case, case.time(t))[:, 0] < 0) for t in times])
    axes[2].plot(times, share, color=figures.COLOURS[k], label=name)
    half = share[len(share) // 2:]
    print(f"{name}: left {half.mean():.3f} +- {half.std():.3f} in the second half of the run", file=sys.stderr)
    x = grains.places(case, case.time(None))
    axes[k].add_collection(EllipseCollection(np.ones(len(x)), np.ones(len(x)), np.zeros(len(x)), units="xy", offsets=x[:, :2],
                                             transOffset=axes[k].transData, facecolors=figures.COLOURS[k], linewidths=0))
    for low, high in ((0, 8), (12, 40)):
        axes[k].add_patch(figures.plt.Rectangle((-1, low), 2, high - low, color="0.5"))
    axes[k].set(xlim=(-21, 21), ylim=(0, 40), aspect="equal")
    figures.label(axes[k], r"$x$ ($\sigma$)", r"$y$ ($\sigma$)" if k == 0 else "", name)
axes[2].set(ylim=(0, 1))
axes[2].axhline(0.5, color="0.7", linewidth=0.8)
figures.label(axes[2], r"$t$ ($\sqrt{\sigma/g}$)", "share in the left compartment", "")
axes[2].legend()
script.save(fig, "demonMD")
