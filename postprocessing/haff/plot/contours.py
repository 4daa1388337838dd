# SPDX-License-Identifier: GPL-3.0-or-later
"""Contour lines of a field on a two-dimensional lattice with holes, with the walls drawn: Fig. 8 of Serna & Marquina.

    haff contours CASE [CASE ...] -o FIGURE.png      the whole domain and the corner of each
"""

import numpy as np

from haff import command
from haff.case.case import Case
from haff.plot import figures


def lattice(case, values):
    """x, y of columns and rows and values[y][x] on the bounding box of a 2D case; nan in holes."""
    centre = np.round(case.centres[:, :2], 9)
    x, i = np.unique(centre[:, 0], return_inverse=True)
    y, j = np.unique(centre[:, 1], return_inverse=True)
    if min(len(x), len(y)) < 2:
        raise ValueError(f"{case.path}: contours want two dimensions, and the mesh has {len(x)} x {len(y)} cells; haffPlot draws any case")
    grid = np.full((len(y), len(x)), np.nan)
    grid[j, i] = values
    return x, y, grid


def walls(case):
    """The faces of all wall patches as segments [n][2][2]."""
    mesh = case.mesh
    segments = []
    for kind, start, count in mesh.patches.values():
        for face in range(start, start + count) if kind == "wall" else ():
            points = mesh.points[mesh.face_points[mesh.face_start[face]:mesh.face_start[face + 1]], :2]
            segments.append((points.min(axis=0), points.max(axis=0)))
    return np.array(segments)


def to_walls(x, y, grid):
    """The grid with one more layer of values around, and one inside holes, so that lines reach walls and boundary."""
    grid = np.pad(grid, 1, mode="edge")
    pad = lambda c: np.concatenate(([2 * c[0] - c[1]], c, [2 * c[-1] - c[-2]]))
    wide = np.pad(grid, 1, constant_values=np.nan)
    beside = np.stack([wide[1:-1, :-2], wide[1:-1, 2:], wide[:-2, 1:-1], wide[2:, 1:-1]])
    known = ~np.isnan(beside)
    mean = np.where(known, beside, 0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    return pad(x), pad(y), np.where(np.isnan(grid) & known.any(axis=0), mean, grid)


def draw(axes, case, time, window, levels=30, name="alpha"):
    """Contours in window = (x0, x1, y0, y1): tinted, with lines; holes are grey, walls are thick."""
    from matplotlib.collections import LineCollection
    values = case.field(name, time)
    if not np.isfinite(values).all():
        raise ValueError(f"{case.path}: {name} at time {time} is no number in {int((~np.isfinite(values)).sum())} cells; take a sound time, or haffPlot, which leaves them blank")
    x, y, grid = lattice(case, values)
    if np.ptp(values) == 0:
        raise ValueError(f"{case.path}: {name} is {values[0]:g} in all cells at time {time}, and has no contours")
    steps = np.linspace(values.min(), values.max(), levels + 1)
    around = to_walls(x, y, grid)
    tint = axes.contourf(*around, steps, cmap="Blues", alpha=0.8)
    axes.contour(*around, steps[1:-1], colors="#12304d", linewidths=0.35)
    axes.pcolormesh(x, y, np.where(np.isnan(grid), 0.88, np.nan), cmap="gray", vmin=0, vmax=1, zorder=2)
    axes.add_collection(LineCollection(walls(case), colors="k", linewidths=1.2, capstyle="projecting", zorder=3))
    axes.set(xlim=window[:2], ylim=window[2:], aspect="equal", xlabel="$x$ (cm)", ylabel="$y$ (cm)")
    return tint


def figure(cases, path):
    """The whole domain and the corner at the last time: side by side for one case, for more as in Fig. 8, a column each."""
    from matplotlib.ticker import MaxNLocator
    n = len(cases)
    fig, axes = figures.panels(2 if n > 1 else 1, max(n, 2), width=7.4, height=3.5)
    for pair, case in zip(axes.T if n > 1 else axes, cases):
        time = case.time(None)
        tint = draw(pair[0], case, time, (0, 10, 0, 10))
        pair[0].set_title(rf"$t$ = {time} s, $\alpha_\mathrm{{max}}$ = {case.field('alpha', time).max():.4f}", fontsize=9)
        draw(pair[1], case, time, (3.5, 6.5, 3.5, 6.5))
        pair[1].set_title("near the corner", fontsize=9)
        where = {"ax": pair[1]} if n == 1 else {"ax": pair[1], "location": "bottom"}
        fig.colorbar(tint, **where, label=figures.AXES["alpha"], ticks=MaxNLocator(8 if n == 1 else 6), shrink=0.9)
    figures.save(fig, path)


def main():
    parser = command.parser(__doc__)
    parser.add_argument("cases", nargs="+", metavar="CASE")
    parser.add_argument("-o", required=True, metavar="FIGURE", help="written; png, pdf or svg")
    o = parser.parse_args()
    figure([Case(p) for p in o.cases], o.o)


if __name__ == "__main__":
    main()
