# SPDX-License-Identifier: GPL-3.0-or-later
"""Grains at four moments of two cycles, where the mass is in every cycle, and its spectrum."""
import sys

import numpy as np
from matplotlib.collections import EllipseCollection

from haff.case import grains
from haff.layers import faraday
from haff.plot import figures, script

SETTLED, WIDTH, HEIGHT = 20, 150, 26  # cycles until the pattern stands; sigma: what is shown of the box
layer = faraday.Layer(script.folder())
last = float(layer.case.times[-1]) * layer.frequency
found = faraday.samples(layer, SETTLED if last > SETTLED + 3 else 0)
fig = figures.plt.figure(figsize=(7, 4.8), layout="constrained")
grid = fig.add_gridspec(3, 2, height_ratios=(1, 1, 2.6))
cycle = np.floor(last - 1.5)
for row in range(2):
    for side in range(2):
        phase = row + side / 2
        ax = fig.add_subplot(grid[row, side])
        x = grains.places(layer.case, layer.case.time((cycle + phase) / layer.frequency))
        ax.add_collection(EllipseCollection(np.ones(len(x)), np.ones(len(x)), np.zeros(len(x)), units="xy", offsets=x[:, :2],
                                            transOffset=ax.transData, facecolors=figures.COLOURS[0], linewidths=0))
        ax.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), aspect="equal")
        figures.label(ax, "", r"$y$ ($\sigma$)" if side == 0 else "", f"$t$ = {phase:g} $T$")
result = faraday.measure(list(found.values()), layer.length)
faraday.cycles_over_place(fig, fig.add_subplot(grid[2, 0]), layer, list(found)[result["phase"]])
faraday.spectra(fig.add_subplot(grid[2, 1]), [("", layer.length, result)])
mean, deviation = faraday.strongest(list(found.values()), layer.length)
print(faraday.describe(result), f"; mean of the strongest {mean:.1f} +- {deviation:.1f}", sep="", file=sys.stderr)
script.save(fig, "faradayMD")
