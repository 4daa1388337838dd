"""The layer at four moments of the last two cycles, how the waves grew, and the spectrum; beside the grains of ../faradayMD
where that case has been run."""
import os
import sys

import numpy as np

from haff.plot import figures, script
from haff.studies import faraday

WIDTH, HEIGHT = 150, 26  # sigma: what is shown of the box
MODES = (300 / 50, 300 / 33)  # the waves whose growth is drawn, per length of 300


def has_run(path):
    """Its layer, or None."""
    mesh = os.path.join(path, "constant", "polyMesh", "points")
    layer = faraday.Layer(path) if os.path.exists(mesh) or os.path.exists(mesh + ".gz") else None
    return layer if layer and len(layer.case.times) > 8 else None


def moment(ax, layer, phase, title):
    """Packing at that phase of the last two whole cycles written."""
    last = float(layer.case.times[-1]) * layer.frequency
    alpha = layer.field("alpha", layer.case.time((np.floor(last - 1.5) + phase) / layer.frequency))[:, :, 0]
    ax.pcolormesh(layer.x, layer.y, alpha.T, cmap="magma_r", vmin=0, vmax=0.82, rasterized=True)
    ax.set(xlim=(0, min(WIDTH, layer.length)), ylim=(0, HEIGHT), aspect="equal")
    figures.label(ax, "", r"$y$ ($\sigma$)", title)


folder = script.folder()
gas = faraday.Layer(folder)
grains = has_run(os.path.join(folder, "..", "faradayMD"))
layers = [("gas", gas)] + ([("grains", grains)] if grains else [])
shown = [(name, layer, phase) for phase in (0, 0.5, 1, 1.5) for name, layer in layers]
rows = len(shown) // 2
fig = figures.plt.figure(figsize=(7, 2.8 + 0.9 * rows), layout="constrained")
top, bottom = fig.add_gridspec(2, 1, height_ratios=(0.9 * rows, 2.6))
grid = top.subgridspec(rows, 2)
for i, (name, layer, phase) in enumerate(shown):
    moment(fig.add_subplot(grid[i // 2, i % 2]), layer, phase, f"{name}, $t$ = {phase:g} $T$")
grid = bottom.subgridspec(1, 2)
ax = fig.add_subplot(grid[0, 0])
heights = faraday.samples(gas, of="height")
cycles, amplitudes = heights[min(heights)]
number = np.arange(amplitudes.shape[1]) * 300 / gas.length
for k in np.flatnonzero((number >= MODES[0]) & (number <= MODES[1] + 0.1)):
    ax.semilogy(cycles, np.abs(amplitudes[:, k]), marker=".", markersize=3, label=f"{gas.length / k:.1f} $\\sigma$")
ax.legend()
figures.label(ax, "cycle", r"amplitude of the height ($\sigma$)", "waves of the centre of mass at $t = nT$")
spectra = []
for name, layer in layers:
    last = float(layer.case.times[-1]) * layer.frequency
    found = faraday.samples(layer, min(20, last / 2), last)
    result = faraday.measure(list(found.values()), layer.length)
    print(name, faraday.describe(result), file=sys.stderr)
    spectra.append((name if grains else "", layer.length, result))
faraday.spectra(fig.add_subplot(grid[0, 1]), spectra)
script.save(fig, "faraday")
