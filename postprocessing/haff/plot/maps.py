# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures in colours: cases in two dimensions, and cuts through cases in three, with walls, meshes and lines of equal values."""
import dataclasses

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from haff.plot import figures, quantity
from haff.plot.contours import to_walls
from haff.plot.quantity import CannotDraw
from haff.plot.scale import STRIP, Scale, arrange, bar, common, new, own_bar
from haff.plot.space import text
from haff.plot.wish import at_time, chosen_times, spread, title

MANY = 30  # pictures of one field at all times in one figure


def paint(ax, section, q, scale, wish):
    """The values of a section in colours, with walls and ends."""
    if section.raster is not None:
        h, v = section.edges
        lines = dict(edgecolors="0.35", linewidth=0.15) if wish.mesh else {}
        ax.pcolormesh(h, v, np.ma.masked_invalid(section.image(q.values)), norm=scale.norm, cmap=scale.colours, rasterized=True, **lines)
    else:
        tint = PolyCollection(section.shapes, array=q.values[section.cells], cmap=scale.colours, norm=scale.norm, rasterized=True,
                              edgecolors="0.35" if wish.mesh else "face", linewidths=0.15 if wish.mesh else 0.4, antialiaseds=wish.mesh)
        ax.add_collection(tint)
    if wish.contours:
        contour_lines(ax, section, q, scale, wish)
    outline(ax, section)


def outline(ax, section):
    ax.add_collection(LineCollection(section.rims, colors=figures.RIM, linewidths=0.5, capstyle="projecting", zorder=3))
    ax.add_collection(LineCollection(section.walls, colors=figures.WALL, linewidths=1.4, capstyle="projecting", zorder=4))
    size = section.high - section.low
    room = 0.012 * size.max() if len(section.walls) else 0
    ax.set_xlim(section.low[0] - min(room, 0.05 * size[0]), section.high[0] + min(room, 0.05 * size[0]))
    ax.set_ylim(section.low[1] - min(room, 0.05 * size[1]), section.high[1] + min(room, 0.05 * size[1]))
    ratio = size[0] / size[1]
    ax.set_aspect("equal" if 1 / STRIP <= ratio <= STRIP else "auto")
    for spine in ax.spines.values():
        spine.set_visible(False)
    ax.tick_params(direction="out", top=False, right=False)


def contour_lines(ax, section, q, scale, wish):
    """Lines between equal steps of the colours."""
    low, high = scale.norm.vmin, scale.norm.vmax
    levels = (np.geomspace if wish.log else np.linspace)(low, high, wish.contours + 2)[1:-1]
    style = dict(levels=levels, colors="white" if scale.colours.name in ("magma",) else "#102030", linewidths=0.4, zorder=2)
    if section.raster is not None:
        h, v = ((e[1:] + e[:-1]) / 2 for e in section.edges)
        ax.contour(*to_walls(h, v, section.image(q.values)), **style)
        if (section.raster < 0).any():  # lines end at walls: what is beyond is painted over
            ax.pcolormesh(*section.edges, np.where(section.raster < 0, float(figures.SOLID), np.nan), cmap="gray", vmin=0, vmax=1, zorder=2.5)
        return
    places, triangles, corner, cell = section.triangles()
    total = np.bincount(corner, q.values[cell], len(places)) / np.bincount(corner, minlength=len(places))
    ax.tricontour(places[:, 0], places[:, 1], triangles, total, **style)


def names_of_axes(ax, section, units, outer=(True, True)):
    for name, which, setter in ((section.names[0], outer[0], ax.set_xlabel), (section.names[1], outer[1], ax.set_ylabel)):
        if which:
            setter(figures.with_unit(f"${name}$", (0, 1, 0), units))


def drawn_ratio(section):
    size = section.high - section.low
    return min(max(size[0] / size[1], 1 / STRIP), STRIP)


def section_of(space, wish):
    section = space.flat() if space.dim == 2 else space.cut(*wish.cut)
    return section.mirrored(*wish.mirror) if wish.mirror else section


def sections(space, wish):
    """Fields, or one field at several times, in colours on one section."""
    case = space.case
    times = chosen_times(case, wish.time)
    names = wish.fields or (quantity.main_fields(case, times[-1]) if len(times) == 1 else quantity.main_fields(case, times[-1])[:1])
    if len(times) > 1 and len(names) > 1:
        raise CannotDraw("one field at several times, or several fields at one time")
    if len(times) > MANY:
        raise CannotDraw(f"{len(times)} pictures are too many for one figure; haffMovie makes a film of them, or name some times:"
                         f"  -time {','.join(spread(times, 4))}")
    section = section_of(space, wish)
    shown = [(time, word) for time in times for word in names]
    if len(times) > 1 and not wish.span:
        wish = dataclasses.replace(wish, span=common_span(case, times, names[0], wish))
    columns, tall = arrange(len(shown), drawn_ratio(section))
    rows = -(-len(shown) // columns)
    width = min(7.2, columns * ((tall - 0.55) * drawn_ratio(section) + 1.35)) if rows * tall > 2 else 7.2
    figure, axes = new(rows, columns, max(width, 3.2), tall * rows + 0.35, wish)
    for k, (time, word) in enumerate(shown):
        q = quantity.read(case, word, time, wish.component)
        scale = Scale(q, wish, shown_values(q, section))
        ax = axes.flat[k]
        paint(ax, section, q, scale, wish)
        names_of_axes(ax, section, q.units, (k + columns >= len(shown), k % columns == 0))
        ax.set_title(q.label if len(times) == 1 else at_time(case, time), fontsize=9, loc="left")
        if len(times) == 1:
            own_bar(figure, ax, scale)
    if len(times) > 1:
        bar(figure, axes, scale, q.label)
    for ax in axes.flat[len(shown):]:
        ax.set_axis_off()
    where = "" if space.dim == 2 else f"    {plane(wish.cut)}"
    figure.suptitle(title(case, times[0] if len(times) == 1 else None) + where, fontsize=9)
    return figure


def shown_values(q, section):
    cells = section.raster[section.raster >= 0] if section.raster is not None else section.cells
    return q.values[cells]


def plane(cut):
    normal, point = cut
    axis = np.flatnonzero(normal)
    if len(axis) == 1:
        return f"${'xyz'[axis[0]]}$ = {point[axis[0]]:.4g}"
    return f"plane through {text(point)} across {text(normal)}"


def common_span(case, times, word, wish):
    """The range of a field over all times."""
    return common((quantity.read(case, word, time, wish.component).values for time in times), wish)
