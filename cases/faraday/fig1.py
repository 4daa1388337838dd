# SPDX-License-Identifier: GPL-3.0-or-later
"""Grains at eight moments of two periods, as Fig. 1 of Carrillo et al.; dashed: the lowest place of the plate. `./Allrun faraday fig1` calls this."""
import numpy as np
from matplotlib.collections import EllipseCollection

from haff.case import grains
from haff.layers import faraday
from haff.plot import figures, script

WIDTH, HEIGHT = 150, 32  # sigma: what is shown of the box
layer = faraday.Layer(script.folder())
first = float(layer.case.times[0])
fig, axes = figures.plt.subplots(8, 1, figsize=(5, 8.5), sharex=True, sharey=True, layout="constrained")
for k, ax in enumerate(axes, 1):  # the film begins behind its first moment
    time = layer.case.time(first + k / 4 / layer.frequency)
    plate = layer.amplitude * np.sin(2 * np.pi * float(time) * layer.frequency)
    x = grains.places(layer.case, time)[:, [layer.along, layer.up]] + (0, plate)
    ax.add_collection(EllipseCollection(1, 1, 0, units="x", offsets=x, offset_transform=ax.transData, facecolor=figures.COLOURS[0], linewidth=0))
    ax.plot((0, WIDTH), (plate, plate), "k", linewidth=1)
    ax.axhline(-layer.amplitude, color="k", linewidth=0.6, linestyle="--")
    ax.set(xlim=(0, WIDTH), ylim=(-layer.amplitude - 1, HEIGHT), aspect="equal")
    figures.label(ax, r"$x$ ($\sigma$)" if k == 8 else "", r"$y$ ($\sigma$)", f"$t$ = {k / 4:g} $T$")
script.save(fig, "fig1")
