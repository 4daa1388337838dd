# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing (above) and temperature at five times: a fast jet of grains on a bed."""
import numpy as np
from matplotlib.colors import LogNorm

import haff
from haff.plot import figures, script

MOMENTS = 0, 0.02, 0.06, 0.1, 0.3  # s
ROWS = ("alpha", r"$\alpha$", {"vmin": 0, "vmax": 0.64, "cmap": "magma_r"}), ("T", "$T$ (m$^2$/s$^2$)", {"norm": LogNorm(1e-6, 1), "cmap": "viridis"})


def main(folder):
    case = haff.Case(folder)
    fig, axes = figures.panels(len(ROWS), len(MOMENTS), width=9, height=1.5)
    low, high = 1e3 * case.mesh.points.min(axis=0), 1e3 * case.mesh.points.max(axis=0)
    order = np.lexsort(np.round(case.centres[:, :2].T, 9))
    columns = len(np.unique(np.round(case.centres[:, 0], 9)))
    for line, (name, symbol, look) in zip(axes, ROWS):
        for ax, t in zip(line, MOMENTS):
            image = ax.imshow(case.field(name, case.time(t))[order].reshape(-1, columns), origin="lower", extent=(low[0], high[0], low[1], high[1]), **look)
            figures.label(ax, "$x$ (mm)" if name == "T" else "", "$y$ (mm)" if t == 0 else "", f"$t$ = {1e3 * t:g} ms" if name == "alpha" else None)
        fig.colorbar(image, ax=line, shrink=0.8, label=symbol)
    script.save(fig, "jetOnPile")


if __name__ == "__main__":
    main(script.folder())
