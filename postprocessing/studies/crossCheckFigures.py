# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of crossCheck: both results side by side with their difference; in one dimension as lines."""
import numpy as np

from haff.plot import cellmap, figures
from studies.measured import comparison

NAMES = {"rho": r"$\rho$", "U": "$u$", "T": "$T$", "p": "$p$"}


def layer(mesh):
    """The empty patch that has a face of every cell of a mesh one cell thick, or None."""
    return next((name for name, (kind, _, count) in mesh.patches.items() if kind == "empty" and count == mesh.cells), None)


def colours(ax, case, values, title, names, span=None):
    tint = cellmap.draw(ax, case, values, layer(case.mesh), colours=names, span=span)
    ax.set(xlabel="", ylabel="")
    ax.set_title(title, fontsize=9)
    ax.figure.colorbar(tint, ax=ax, shrink=0.8, location="bottom")


def plane(path, name, result):
    ours, foam = (result.states[code]["rho"] for code in result.states)
    extent = np.ptp(result.geometry.at, axis=0)
    fig, axes = figures.panels(1, 3, width=9.0, height=max(2.2, min(4.0, 2.6 * extent[1] / extent[0] + 1.0)))
    low, high = min(ours.min(), foam.min()), max(ours.max(), foam.max())
    for ax, (code, state) in zip(axes[0], result.states.items()):
        colours(ax, result.case, state["rho"], rf"{name}, $\rho$: {code}", "viridis", (low, high))
    most = np.abs(ours - foam).max() / 2
    colours(axes[0][2], result.case, ours - foam, "difference (colours to half the greatest)", "RdBu_r", (-most, most))
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
    if len(result.geometry.axes) == 2 and layer(result.case.mesh):
        plane(path, name, result)
    elif len(result.geometry.axes) == 1:
        line(path, name, result, what)


def density(case, path):
    """rho of a plane case at its last time: the figure of a case."""
    values = case.field("rho")
    extent = np.ptp(case.centres, axis=0)
    fig, axes = figures.panels(1, 1, width=5.0, height=max(2.4, 4.4 * extent[1] / extent[0]))
    colours(axes[0][0], case, values, rf"$\rho$, $t$ = {case.times[-1]}, {len(values)} cells", "viridis")
    figures.save(fig, path)
