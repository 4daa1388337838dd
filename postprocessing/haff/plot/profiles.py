# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of curves: profiles of cases in one dimension at several times, and values along lines through any case."""
import dataclasses

import numpy as np
from matplotlib import colormaps, colors
from matplotlib.cm import ScalarMappable

from haff.plot import figures, quantity
from haff.plot.quantity import CannotDraw
from haff.plot.scale import new
from haff.plot.wish import at_time, chosen_times, spread, title

PROFILES = 6  # times in a picture of profiles, unless all are wanted


def profiles(space, wish):
    """Fields along the only axis with many cells, at several times: means over the few cells across it."""
    case, axis = space.case, space.column
    x, layers = space.along(axis)
    times = chosen_times(case, wish.time if wish.time != "last" else "all")
    times = readable(case, times, wish) if wish.time in ("last", "all") else times
    times = times if wish.time not in ("last", "all") else spread(times, PROFILES if wish.time == "last" else 1 << 30)
    names = wish.fields or quantity.main_fields(case, times[-1])
    wish = dataclasses.replace(wish, fields=names)
    return curves(space, wish, names, times, lambda q: (x, layers(q.values)), "xyz"[axis], upright=axis == 1,
                  ends=(space.low[axis], space.high[axis]))


def readable(case, times, wish):
    """The times at which all fields can be read: not those that are given by expressions, before a run."""
    names = wish.fields or quantity.main_fields(case, times[-1])
    found = []
    for t in times:
        try:
            for name in names:
                quantity.read(case, name, t, wish.component)
            found.append(t)
        except CannotDraw:
            if t == times[-1]:
                raise
    return found


def main_axis(case, name, time, axis):
    """The component of a vector that a picture of profiles shows: the largest; of equal ones that along the axis."""
    values = np.abs(case.field(name, time)).max(axis=0)
    return "xyz"[axis] if values[axis] == values.max() else "xyz"[int(np.argmax(values))]


def curves(space, wish, names, times, values_of, along, upright=False, length=None, ends=None):
    """Panels of curves, one for each field, a colour for each time. ends: of the axis along which they go."""
    case = space.case
    columns = 1 if len(names) == 1 else 2
    rows = -(-len(names) // columns)
    figure, axes = new(rows, columns, 7.2, (3.4 if len(names) == 1 else 2.5 if not upright else 3.0) * rows + 0.5, wish)
    tints = [figures.COLOURS[0]] if len(times) == 1 else colormaps["viridis"](np.linspace(0, 0.88, len(times)))
    handles = []
    for ax, word in zip(axes.flat, names):
        lines, q = [], None
        for time, tint in zip(times, tints):
            q = quantity.read(case, word, time, wish.component, along=vector_part(space, word, wish, times[-1]))
            x, y = values_of(q)
            lines += ax.plot(*((y, x) if upright else (x, y)), color=tint, label=at_time(case, time))
        finish_curve(ax, wish, upright, ends)
        (ax.set_ylabel if upright else ax.set_xlabel)(figures.with_unit(length or f"${along}$", (0, 1, 0), figures.units(case.path)))
        (ax.set_xlabel if upright else ax.set_ylabel)(q.label)
        handles = lines
    for ax in axes.flat[len(names):]:
        ax.set_axis_off()
    figure.suptitle(title(case, times[0] if len(times) == 1 else None), fontsize=9)
    if len(times) > 1:
        key(figure, axes, handles, times, case)
    return figure


def vector_part(space, word, wish, time):
    name, part = quantity.split(word, wish.component)
    there = quantity.fields(space.case, time)
    if part or name not in there or there[name][0] != 3 or space.column is None or not wish.plain:
        return None
    return main_axis(space.case, name, time, space.column)


def finish_curve(ax, wish, upright, ends):
    """Limits: the whole values, or the wished ones; a constant field is a line in the middle."""
    (ax.set_xscale if upright else ax.set_yscale)("log" if wish.log else "linear")
    lines = ax.get_lines()
    values = np.concatenate([line.get_xdata() if upright else line.get_ydata() for line in lines])
    low, high = quantity.limits(values)
    set_limits = ax.set_xlim if upright else ax.set_ylim
    if wish.span:
        set_limits(wish.span)
    elif high - low <= 1e-9 * max(abs(low), abs(high)) or high - low < 1e-300:
        room = 0.1 * abs(high) or 1.0
        set_limits(low - room, high + room)
    places = np.concatenate([line.get_ydata() if upright else line.get_xdata() for line in lines])
    (ax.set_ylim if upright else ax.set_xlim)(*(ends or (places.min(), places.max())))


def key(figure, axes, handles, times, case):
    """Which colour is which time: a legend of few, a colour bar of many."""
    if len(times) <= 8:
        lines = -(-len(times) // 6)
        share = 0.22 * lines / figure.get_figheight()
        figure.get_layout_engine().set(rect=(0, share, 1, 1 - share))
        figure.legend(handles=handles, loc="lower center", ncol=min(len(times), 6), columnspacing=1.4, handlelength=1.5)
        return
    norm = colors.Normalize(float(times[0]), float(times[-1]))
    shown = ScalarMappable(norm, colors.LinearSegmentedColormap.from_list("times", colormaps["viridis"](np.linspace(0, 0.88, 64))))
    figure.colorbar(shown, ax=axes, aspect=30, pad=0.02, label=figures.axis("t", figures.units(case.path)))


def along_line(space, wish):
    """Fields along a line through a case of any dimension."""
    a, b = wish.line
    times = chosen_times(space.case, wish.time)
    distance, cells = space.line(a, b)
    names = wish.fields or quantity.main_fields(space.case, times[-1])
    differ = np.flatnonzero(np.asarray(a) != np.asarray(b))
    if len(differ) == 1:
        axis = int(differ[0])
        place = a[axis] + distance * np.sign(b[axis] - a[axis])
        return curves(space, wish, names, times, lambda q: (place, q.values[cells]), "xyz"[axis])
    return curves(space, wish, names, times, lambda q: (distance, q.values[cells]), "s", length="distance along the line")
