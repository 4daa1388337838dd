"""Figures of crossCheck: both results side by side with their difference; in one dimension as lines."""
import numpy as np
from matplotlib.collections import PolyCollection

import comparison
import figures

NAMES = {"rho": r"$\rho$", "U": "$u$", "T": "$T$", "p": "$p$"}


def polygons(mesh):
    """The cells of a mesh one cell thick: one face of each on an empty patch, in the plane. None: there is no such patch."""
    faces = np.concatenate([np.arange(start, start + count) for kind, start, count in mesh.patches.values() if kind == "empty"] or [[]])
    cells, first = np.unique(mesh.owner[faces.astype(int)], return_index=True)
    if len(cells) != mesh.cells:
        return None
    return [mesh.points[mesh.face_points[mesh.face_start[f]:mesh.face_start[f + 1]]][:, :2] for f in faces[first].astype(int)]


def colours(ax, cells, values, title, **colour):
    tint = PolyCollection(cells, array=values, edgecolors="face", linewidths=0.1, rasterized=True, **colour)
    ax.add_collection(tint)
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_title(title, fontsize=9)
    ax.figure.colorbar(tint, ax=ax, shrink=0.8, location="bottom")


def plane(path, name, result, cells):
    ours, foam = (result.states[code]["rho"] for code in result.states)
    extent = np.ptp(result.geometry.at, axis=0)
    fig, axes = figures.panels(1, 3, width=9.0, height=max(2.2, min(4.0, 2.6 * extent[1] / extent[0] + 1.0)))
    low, high = min(ours.min(), foam.min()), max(ours.max(), foam.max())
    for ax, (code, state) in zip(axes[0], result.states.items()):
        colours(ax, cells, state["rho"], rf"{name}, $\rho$: {code}", cmap="viridis", clim=(low, high))
    most = np.abs(ours - foam).max() / 2
    colours(axes[0][2], cells, ours - foam, "difference (colours end at half of the greatest)", cmap="RdBu_r", clim=(-most, most))
    fig.savefig(path, dpi=100)


def line(path, name, result, what):
    geometry = result.geometry
    sort = np.argsort(geometry.at[:, 0])
    x = geometry.at[sort, 0]
    part = lambda state, field: (state[field] if state[field].ndim == 1 else state[field][:, geometry.axes[0]])[sort]
    fig, axes = figures.panels(2, 4, width=10.0, height=2.2)
    for k, field in enumerate(comparison.FIELDS):
        if result.known:
            axes[0][k].plot(x, part(result.known, field), color="0.5", label=what)
        for (code, state), style in zip(result.states.items(), ("-", "--")):
            axes[0][k].plot(x, part(state, field), style, label=code)
        one, other = (part(state, field) for state in result.states.values())
        axes[1][k].plot(x, one - other)
        figures.label(axes[0][k], "", NAMES[field], name if k == 0 else None)
        figures.label(axes[1][k], "$x$", f"difference of {NAMES[field]}")
    axes[0][0].legend(fontsize=7)
    fig.savefig(path, dpi=100)


def draw(path, name, result, what):
    """The PNG; nothing where the mesh is neither a line nor one cell thick."""
    cells = polygons(result.case.mesh) if len(result.geometry.axes) == 2 else None
    if cells is not None:
        plane(path, name, result, cells)
    elif len(result.geometry.axes) == 1:
        line(path, name, result, what)


def density(case, path):
    """rho of a plane case at its last time: the figure of a case."""
    values = case.field("rho")
    extent = np.ptp(case.centres, axis=0)
    fig, axes = figures.panels(1, 1, width=5.0, height=max(2.4, 4.4 * extent[1] / extent[0]))
    colours(axes[0][0], polygons(case.mesh), values, rf"$\rho$, $t$ = {case.times[-1]}, {len(values)} cells", cmap="viridis")
    figures.save(fig, path)
