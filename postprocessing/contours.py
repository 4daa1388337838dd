"""Contour lines of a field on a two-dimensional lattice with holes, with the walls drawn: Fig. 8 of Serna & Marquina.

    contours.py CASE [CASE ...] FIGURE.png      one column per case, the whole domain above, the corner below
"""
import sys

import numpy as np

import figures
import haff


def lattice(case, values):
    """x, y of columns and rows and values[y][x] on the bounding box of a 2D case; nan in holes."""
    centre = np.round(case.centres[:, :2], 9)
    x, i = np.unique(centre[:, 0], return_inverse=True)
    y, j = np.unique(centre[:, 1], return_inverse=True)
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


def to_walls(case, x, y, grid):
    """The grid with one more row and column on each side that repeat the edge, so that lines reach the boundary."""
    pad = lambda c: np.concatenate(([1.5 * c[0] - 0.5 * c[1]], c, [1.5 * c[-1] - 0.5 * c[-2]]))
    return pad(x), pad(y), np.pad(grid, 1, mode="edge")


def draw(axes, case, time, window, levels=30, name="alpha"):
    """Contour lines in window = (x0, x1, y0, y1); the hole is grey, walls are thick."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Rectangle
    values = case.field(name, time)
    x, y, grid = to_walls(case, *lattice(case, values))
    axes.contour(x, y, grid, np.linspace(values.min(), values.max(), levels + 2)[1:-1],
                 colors=figures.COLOURS[0], linewidths=0.45)
    segments = walls(case)
    if len(segments):
        corner = segments.reshape(-1, 2)
        tip = (corner[:, 0].min(), corner[:, 1].max())
        axes.add_patch(Rectangle((tip[0], y[0]), x[-1] - tip[0], tip[1] - y[0], facecolor="0.9", zorder=2))
        axes.add_collection(LineCollection(segments, colors="k", linewidths=1.2, zorder=3))
    axes.set(xlim=window[:2], ylim=window[2:], aspect="equal", xlabel="$x$ (cm)", ylabel="$y$ (cm)")


def figure(cases, path):
    """Fig. 8: whole domain and corner, one column per case; the last time of each."""
    fig, axes = figures.panels(2, len(cases), width=3.5 * len(cases), height=3.4)
    for column, case in zip(axes.T, cases):
        time = case.times[-1]
        most = case.field("alpha", time).max()
        draw(column[0], case, time, (0, 10, 0, 10))
        column[0].set_title(rf"$t$ = {time} s, $\nu_\mathrm{{max}}$ = {most:.4f}", fontsize=9)
        draw(column[1], case, time, (3.5, 6.5, 3.5, 6.5))
        column[1].set_title("near the corner", fontsize=9)
    figures.save(fig, path)


if __name__ == "__main__":
    figure([haff.Case(p) for p in sys.argv[1:-1]], sys.argv[-1])
