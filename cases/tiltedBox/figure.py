# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing at five times: grains that slide in a box that stands at an angle."""
import numpy as np

import haff
from haff.plot import figures, script

MOMENTS = 0, 0.04, 0.1, 0.2, 0.4  # s


def main(folder):
    case = haff.Case(folder)
    fig, axes = figures.panels(1, len(MOMENTS), width=9, height=3)
    low, high = 1e3 * case.mesh.points.min(axis=0), 1e3 * case.mesh.points.max(axis=0)
    column, row = (np.unique(np.round(case.centres[:, k], 9), return_inverse=True)[1] for k in (0, 1))
    picture = np.full((row.max() + 1, column.max() + 1), np.nan)
    for ax, t in zip(axes[0], MOMENTS):
        picture[row, column] = case.field("alpha", case.time(t))
        image = ax.imshow(picture.copy(), origin="lower", extent=(low[0], high[0], low[1], high[1]), vmin=0, vmax=0.64, cmap="magma_r")
        figures.label(ax, "$x$ (mm)", "$y$ (mm)" if t == MOMENTS[0] else "", f"$t$ = {1e3 * t:g} ms")
    fig.colorbar(image, ax=axes, shrink=0.8, label=r"$\alpha$")
    script.save(fig, "tiltedBox")


if __name__ == "__main__":
    main(script.folder())
