# SPDX-License-Identifier: GPL-3.0-or-later
"""The layer at four moments of the last two cycles, how the waves grew, and the spectrum; beside the grains of ../faradayMD
where that case has been run."""
import os
import sys

import numpy as np
from matplotlib.collections import EllipseCollection

from haff.case import grains
from haff.layers import faraday
from haff.plot import figures, script

WIDTH, HEIGHT = 150, 26  # sigma: what is shown of the box
MODES = (300 / 50, 300 / 33)  # the waves whose growth is drawn, per length of 300


def has_run(path):
    """Its layer, or None."""
    mesh = os.path.join(path, "constant", "polyMesh", "points")
    layer = faraday.Layer(path) if os.path.exists(mesh) or os.path.exists(mesh + ".gz") else None
    return layer if layer and len(layer.case.times) > 8 else None


def moment(ax, layer, phase, title):
    """Packing, or the grains themselves, at that phase of the last two whole cycles written; returns what a colour bar wants, or None."""
    last = float(layer.case.times[-1]) * layer.frequency
    time, shown = layer.case.time((np.floor(last - 1.5) + phase) / layer.frequency), None
    if os.path.isdir(os.path.join(layer.case.path, time, "lagrangian", "grains")):
        x = grains.places(layer.case, time)
        ax.add_collection(EllipseCollection(1, 1, 0, units="x", offsets=x[:, :2], offset_transform=ax.transData, facecolor="#3b0f70",
                                            linewidth=0))
    else:
        alpha = layer.field("alpha", time)[:, :, 0]
        shown = ax.pcolormesh(layer.x, layer.y, alpha.T, cmap="magma_r", vmin=0, vmax=0.82, shading="gouraud", rasterized=True)
    ax.set(xlim=(0, min(WIDTH, layer.length)), ylim=(0, HEIGHT), aspect="equal")
    ax.text(0.01, 0.93, title, transform=ax.transAxes, va="top", fontsize=8, bbox={"facecolor": "w", "edgecolor": "none", "pad": 1.5, "alpha": 0.8})
    return shown


def fields(part, layers):
    """Four moments of every layer, one below the other, with one colour bar."""
    phases, shown = (0, 0.5, 1, 1.5), None
    axes = part.subplots(len(phases), len(layers), sharex=True, sharey=True, squeeze=False)
    for row, phase in zip(axes, phases):
        for ax, (name, layer) in zip(row, layers):
            shown = moment(ax, layer, phase, f"{name}, $t$ = {phase:g} $T$") or shown
    for ax in axes[-1]:
        ax.set_xlabel(r"$x$ ($\sigma$)")
    for row in axes:
        row[0].set_ylabel(r"$y$ ($\sigma$)")
    part.colorbar(shown, ax=axes, label=r"$\alpha$", shrink=0.7, aspect=30, pad=0.01)


def growth(ax, gas):
    """How the waves of the centre of mass grow."""
    heights = faraday.samples(gas, of="height")
    cycles, amplitudes = heights[min(heights)]
    number = np.arange(amplitudes.shape[1]) * 300 / gas.length
    for k in np.flatnonzero((number >= MODES[0]) & (number <= MODES[1] + 0.1)):
        ax.semilogy(cycles, np.abs(amplitudes[:, k]), marker=".", markersize=3, label=f"{gas.length / k:.1f} $\\sigma$")
    ax.legend(title="gas, wavelength", title_fontsize=8)
    figures.label(ax, "cycle", r"amplitude of the height ($\sigma$)", "waves of the centre of mass at $t = nT$")


def spectra(ax, layers):
    rows = []
    for name, layer in layers:
        last = float(layer.case.times[-1]) * layer.frequency
        result = faraday.measure(list(faraday.samples(layer, min(20, last / 2), last).values()), layer.length)
        print(name, faraday.describe(result), file=sys.stderr)
        rows.append((name if len(layers) > 1 else "", layer.length, result))
    faraday.spectra(ax, rows)


gas, beside = faraday.Layer(script.folder()), has_run(script.folder("..", "faradayMD"))
layers = [("gas", gas)] + ([("grains", beside)] if beside else [])
fig = figures.plt.figure(figsize=(9, 6.6 if beside else 8.5), layout="constrained")
top, bottom = fig.subfigures(2, 1, height_ratios=(4, 2.8) if beside else (6.5, 2.8))
fields(top, layers)
left, right = bottom.subplots(1, 2)
growth(left, gas)
spectra(right, layers)
script.save(fig, "faraday")
