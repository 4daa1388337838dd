"""Pictures of cases: profiles in one dimension, colours in two, cuts and surfaces in three, grains as what they are.

    wish = picture.Wish(fields=["alpha"])
    figure = picture.draw(Space(haff.Case("cases/wedge")), wish)

What is not wished is chosen: the fields that one wants to see first, the last time, the whole range of values. CannotDraw says what a
case lacks.
"""
import dataclasses
import os
import re

import numpy as np
from matplotlib import colormaps, colors
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection

from haff.case import grains
from haff.plot import figures, quantity, solid
from haff.plot.canvas import FINE, Canvas, View
from haff.plot.contours import to_walls
from haff.plot.quantity import GRAINS, CannotDraw
from haff.plot.space import Section, text

PROFILES = 6  # times in a picture of profiles, unless all are wanted
MANY = 30  # pictures of one field at all times in one figure
STRIP = 8.0  # ratio of the sides beyond which a domain is not drawn to scale


@dataclasses.dataclass
class Wish:
    """fields: names, U.x is a component; time: a name, "last", "all" or several names; cut: (normal, point); line: (a, b); span: (low, high) of
    colours and values; size: (width, height) in pixels."""
    fields: list = dataclasses.field(default_factory=list)
    time: str = "last"
    cut: tuple = None
    line: tuple = None
    component: str = None
    span: tuple = None
    log: bool = False
    contours: int = 0
    mesh: bool = False
    iso: float = None
    volume: bool = False
    size: tuple = None
    dpi: int = 150

    @property
    def plain(self):
        """Nothing is asked for that only fields have."""
        return not (self.line or self.cut or self.iso is not None or self.volume)

    def names(self):
        """Of the fields with their components, for the name of a file."""
        return [f if not self.component or "." in f else f"{f}.{self.component}" for f in self.fields]


# ---- times ----

def times_with_results(case):
    """Names of times that hold fields or grains; CannotDraw without any."""
    found = [t for t in case.times if quantity.known(case, t)]
    if not found:
        start = " (0.orig is where a run starts: granularGas makes time 0 of it)" if os.path.isdir(os.path.join(case.path, "0.orig")) else ""
        raise CannotDraw(f"{case.path} has no times with fields: run it first{start}")
    return found


def chosen_times(case, word):
    """The names of the times that a word asks for: last, all, a number, or numbers with commas between them."""
    there = times_with_results(case)
    if word == "last":
        return there[-1:]
    if word == "all":
        return there
    return [named_time(case, w, there) for w in word.split(",")]


def named_time(case, word, there):
    """The time within 1e-6 of its own value, or of the span of all times, of a number."""
    try:
        wanted = float(word)
    except ValueError:
        raise CannotDraw(f"'{word}' is no time; the times are {some_of(there)}, last, all") from None
    nearest = min(there, key=lambda t: abs(float(t) - wanted))
    if abs(float(nearest) - wanted) > 1e-6 * max(abs(wanted), float(there[-1]) - float(there[0])):
        raise CannotDraw(f"{case.path} has no time {word}; the nearest is {nearest}, the times are {some_of(there)}")
    return nearest


def some_of(names, most=12):
    return " ".join(names) if len(names) <= most else " ".join(names[:6]) + " .. " + " ".join(names[-5:])


def spread(names, count):
    """At most so many names, evenly from the first to the last."""
    if len(names) <= count:
        return list(names)
    return [names[i] for i in np.unique(np.rint(np.linspace(0, len(names) - 1, count)).astype(int))]


def at_time(case, time):
    return figures.with_time(time, figures.units(case.path))


def title(case, time=None):
    name = os.path.basename(os.path.abspath(case.path))
    return name if time is None else f"{name}    {at_time(case, time)}"


# ---- colours ----

def span_of(values, wish, positive=False):
    """The ends of the colours: as wished, or least and largest, without the outermost 0.2 % where these stretch it twofold."""
    if wish.span:
        return wish.span
    values = values[np.isfinite(values)]
    if positive:
        values = values[values > 0]
    if not values.size:
        return (1.0, 10.0) if positive else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    inner = np.percentile(values if values.size < 2_000_000 else values[::values.size // 1_000_000], (0.2, 99.8))
    if inner[1] - inner[0] < 0.5 * (high - low) and inner[1] > inner[0] and not positive:
        low, high = float(inner[0]), float(inner[1])
    if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
        low, high = -max(-low, high), max(-low, high)
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        room = 0.05 * abs(high) or 1.0
        low, high = low - room, high + room
    return low, high


class Scale:
    """Colours of values: norm, map, and whether values lie beyond its ends."""

    def __init__(self, q, wish, values=None):
        values = q.values if values is None else values
        span = span_of(values, wish, positive=wish.log)
        if wish.log and span[0] <= 0:
            raise CannotDraw(f"-log needs values above 0, but the range begins at {span[0]:g}")
        self.norm = (colors.LogNorm if wish.log else colors.Normalize)(*span)
        self.colours = colormaps[q.colours(span)].copy()
        self.colours.set_bad(figures.SOLID)
        low, high = quantity.limits(values)
        slack = 1e-6 * (span[1] - span[0])
        below, above = low < span[0] - slack, high > span[1] + slack
        self.extend = "both" if below and above else "min" if below else "max" if above else "neither"

    def mappable(self):
        return ScalarMappable(self.norm, self.colours)


def own_bar(figure, ax, scale, text=None):
    """A colour bar of the height of one picture, which is drawn to scale."""
    box = ax.inset_axes([1.03, 0, 0.02 + 0.02 / min(1.0, ratio_of(ax)), 1])
    return finish_bar(figure.colorbar(scale.mappable(), cax=box, extend=scale.extend, extendfrac=0.03), text)


def ratio_of(ax):
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    return (right - left) / (high - low) if ax.get_aspect() == 1 else STRIP


def bar(figure, axes, scale, text=None, mark=None, **options):
    """A colour bar beside axes; mark: a value to be marked on it."""
    made = figure.colorbar(scale.mappable(), ax=axes, extend=scale.extend, extendfrac=0.03, **{"aspect": 25, "pad": 0.015, **options})
    return finish_bar(made, text, mark)


def finish_bar(made, text=None, mark=None):
    made.outline.set_linewidth(0.5)
    made.ax.tick_params(width=0.5, labelsize=8)
    if text:
        made.set_label(text)
    if mark is not None and made.norm.vmin <= mark <= made.norm.vmax:
        vertical = made.orientation == "vertical"
        (made.ax.axhline if vertical else made.ax.axvline)(mark, color="white", linewidth=2.4)
        (made.ax.axhline if vertical else made.ax.axvline)(mark, color="black", linewidth=1.0)
    return made


# ---- layout ----

def arrange(count, ratio, width=7.2, most=8.0):
    """(columns, height of a panel) for so many panels whose width over height is `ratio`, on a page that is wider than high."""
    best = None
    for columns in range(1, count + 1):
        rows = -(-count // columns)
        tall = max((width / columns - 1.0) / ratio, 0.45) + 0.55
        if tall * rows > most:
            tall = most / rows
        room = min((width / columns - 1.0), (tall - 0.55) * ratio)  # width of the picture itself
        waste = rows * columns - count
        score = room * min(1.0, 0.75 * width / (tall * rows)) * (1 - 0.12 * waste)
        if best is None or score > best[0]:
            best = (score, columns, tall)
    return best[1:]


def new(rows, columns, width, height, wish):
    """A figure and its axes, of the size that is wished, or of the given one in inches."""
    if wish.size:
        width, height = (n / wish.dpi for n in wish.size)
    figure, axes = figures.plt.subplots(rows, columns, figsize=(width, height), squeeze=False, layout="constrained")
    figure.get_layout_engine().set(w_pad=0.04, h_pad=0.04, wspace=0.03, hspace=0.03)
    return figure, axes


# ---- one dimension ----

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
    """The component of a vector that profiles show: along the axis, unless the field is small there beside another."""
    values = np.abs(case.field(name, time)).max(axis=0)
    return "xyz"[axis] if values[axis] > 0.02 * values.max() else "xyz"[int(np.argmax(values))]


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


# ---- two dimensions ----

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


def sections(space, wish):
    """Fields, or one field at several times, in colours on one section."""
    case = space.case
    times = chosen_times(case, wish.time)
    names = wish.fields or (quantity.main_fields(case, times[-1]) if len(times) == 1 else quantity.main_fields(case, times[-1])[:1])
    if len(times) > 1 and len(names) > 1:
        raise CannotDraw("one field at several times, or several fields at one time")
    if len(times) > MANY:
        raise CannotDraw(f"{len(times)} pictures are too many for one figure; haffMovie makes a film of them, or name some times: -time {','.join(spread(times, 4))}")
    section = space.flat() if space.dim == 2 else space.cut(*wish.cut)
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
    low, high = np.inf, -np.inf
    for time in times:
        some = span_of(quantity.read(case, word, time, wish.component).values, wish, positive=wish.log)
        low, high = min(low, some[0]), max(high, some[1])
    return low, high


# ---- three dimensions ----

def upwards(case):
    """The axis that points up: against gravity, else y."""
    try:
        words = quantity.head(os.path.join(case.path, "constant", "g"))
        g = np.array([float(w) for w in re.search(r"\bvalue\s*\(([^)]*)\)", words).group(1).split()])
        return int(np.argmax(np.abs(g))) if np.abs(g).any() and np.argmax(np.abs(g)) else 1
    except (AttributeError, ValueError):
        return 1


def best_view(space):
    """From one of four corners: that from which one sees most of the walls of bodies in the gas."""
    views = [View(space.low, space.high, azimuth=a, up=upwards(space.case)) for a in (35, -35, 145, -145)]
    shares = [solid.wall_area(space, view) for view in views]
    return views[int(np.argmax(np.round(np.array(shares) / (max(shares) or 1), 6)))]


def solid_image(space, q, scale, wish, pixels):
    """The view of a field in three dimensions [rows][columns][4], and the value of its surface or None."""
    view = best_view(space)
    canvas = Canvas(view, pixels)
    corners, normals = solid.walls(space, view)
    canvas.triangles(corners, normals, (0.80, 0.80, 0.82))
    value = None
    if not wish.volume:
        value = wish.iso if wish.iso is not None else middle_value(scale)
        corners, normals = solid.isosurface(space, q.values, value)
        if not len(corners) and wish.iso is not None:
            raise CannotDraw(f"{q.name} has no surface at {value:g}; it lies between {quantity.limits(q.values)[0]:g} and {quantity.limits(q.values)[1]:g}")
        canvas.triangles(corners, normals, scale.colours(scale.norm(value))[:3])
    canvas.lines(named_edges(view, space.low, space.high), (0.75, 0.75, 0.75), width=0.7)
    canvas.lines(solid.edges(space), (0.35, 0.35, 0.38), hidden=0.18)
    if wish.volume:
        solid.cloud(canvas, space, q.values, (scale.norm.vmin, scale.norm.vmax), scale.colours)
    return canvas, value


def middle_value(scale):
    return float(np.sqrt(scale.norm.vmin * scale.norm.vmax)) if isinstance(scale.norm, colors.LogNorm) else (scale.norm.vmin + scale.norm.vmax) / 2


def show(ax, canvas):
    ax.imshow(canvas.image(), interpolation="lanczos", aspect="equal")
    ax.set_axis_off()


def named_edges(view, low, high):
    """For each axis an edge of the box on the outside of its picture: points [3][2][3]."""
    centre, ends = (low + high) / 2, []
    for axis in range(3):
        best = None
        for corner in range(4):
            place = centre.copy()
            for k, other in enumerate(a for a in range(3) if a != axis):
                place[other] = (low, high)[corner >> k & 1][other]
            at = view.project(place[None])[0]
            outer = np.array([-at[1], abs(at[0] - view.middle[0])]) if axis != upright_axis(view) else np.array([-at[0], 0])
            score = outer[0] + 1e-3 * at[2]
            if best is None or score > best[0]:
                best = (score, place)
        edge = np.stack([best[1], best[1]])
        edge[:, axis] = low[axis], high[axis]
        ends.append(edge)
    return np.array(ends)


def name_edges(ax, canvas, low, high, units):
    """The names of the axes and their ends along three edges of the box."""
    for axis, edge in enumerate(named_edges(canvas.view, low, high)):
        annotate(ax, canvas, axis, edge, units)


def upright_axis(view):
    return int(np.argmax(np.abs(view.up)))


def annotate(ax, canvas, axis, edge, units):
    at = canvas.place(edge)[:, :2] / FINE
    middle = np.array([canvas.width, canvas.height]) / FINE / 2
    along = at[1] - at[0]
    length = np.hypot(*along)
    if length < 1e-9:
        return
    out = np.array([-along[1], along[0]]) / length
    out = out if out @ (at.mean(axis=0) - middle) > 0 else -out
    words = (f"{edge[0, axis]:.3g}", figures.with_unit(f"${'xyz'[axis]}$", (0, 1, 0), units), f"{edge[1, axis]:.3g}")
    share = (0.06, 0.5, 0.94)
    for word, s in zip(words, share):
        sideways = "right" if out[0] < -0.9 else "left" if out[0] > 0.9 else "center"
        ax.annotate(word, at[0] + s * along, xytext=out * ((11 if s == 0.5 else 8) if sideways == "center" else 5) * (1, -1),
                    textcoords="offset points", ha=sideways, va="center", fontsize=8 if s == 0.5 else 7)


def margins(ax, canvas, share=0.06):
    w, h = canvas.width / FINE, canvas.height / FINE
    ax.set_xlim(-share * w, (1 + share) * w)
    ax.set_ylim((1 + share) * h, -share * h)


def view_ratio(space):
    view = best_view(space)
    return float(np.clip(view.span[0] / view.span[1], 0.3, 3))


def room_of(figure, ax, wish):
    """Pixels of a picture in axes once the figure is laid out."""
    figure.canvas.draw()
    box = ax.get_window_extent()
    factor = wish.dpi / figure.dpi
    return max(int(box.width * factor), 200), max(int(box.height * factor), 200)


def surface_alone(space, wish):
    """The surface or the cloud of one field."""
    case = space.case
    time = one_time(case, wish)
    q = quantity.read(case, one_field(case, wish, time), time, wish.component)
    scale = Scale(q, wish)
    ratio = view_ratio(space)
    figure, axes = new(1, 1, 6.4 if ratio > 0.8 else 4.8, min(max(5.2 / ratio, 3.6), 7.0) if ratio > 0.8 else 6.6, wish)
    ax = axes[0][0]
    ax.set_axis_off()
    figure.suptitle(title(case, time), fontsize=9)
    value = None if wish.volume else wish.iso if wish.iso is not None else middle_value(scale)
    bar(figure, ax, scale, q.label, mark=value, shrink=0.75)
    canvas, value = solid_image(space, q, scale, wish, room_of(figure, ax, wish))
    show(ax, canvas)
    name_edges(ax, canvas, space.low, space.high, q.units)
    margins(ax, canvas)
    return figure


def one_time(case, wish):
    times = chosen_times(case, wish.time)
    if len(times) > 1:
        raise CannotDraw("a picture in three dimensions is of one time; -slice draws several, haffMovie films them")
    return times[0]


def one_field(case, wish, time):
    names = wish.fields or quantity.main_fields(case, time)[:1]
    if len(names) > 1:
        raise CannotDraw("a picture in three dimensions is of one field; -slice draws several")
    return names[0]


def cuts(space, wish):
    """Three cuts through the middle, and a surface of the field."""
    case = space.case
    time = one_time(case, wish)
    q = quantity.read(case, one_field(case, wish, time), time, wish.component)
    scale = Scale(q, wish)
    middle = inside(space)
    made = [space.cut(np.eye(3)[axis], middle) for axis in range(3)]
    rows, columns, width, height, shape = page(space, made)
    figure, axes = new(rows, columns, width, height, wish)
    for ax, axis, section in zip(axes.flat, range(3), made):
        paint(ax, section, q, scale, wish)
        names_of_axes(ax, section, q.units)
        ax.set_title(f"${'xyz'[axis]}$ = {middle[axis]:.3g}", fontsize=9, loc="left")
    last = axes.flat[3]
    last.set_axis_off()
    figure.suptitle(title(case, time), fontsize=9)
    value = wish.iso if wish.iso is not None else middle_value(scale)
    last.set_title(f"{q.symbol} = {value:.3g}", fontsize=9, loc="left")
    bar(figure, axes, scale, q.label, mark=value, aspect=35)
    canvas, value = solid_image(space, q, scale, wish, room_of(figure, last, wish))
    show(last, canvas)
    name_edges(last, canvas, space.low, space.high, q.units)
    margins(last, canvas)
    return figure


def inside(space):
    """A point in the middle of the mesh through which planes cut cells, not the faces between them."""
    middle = (space.low + space.high) / 2
    if space.lattice:
        for axis, edges in enumerate(space.lattice.edges):
            k = (len(edges) - 1) // 2
            middle[axis] = (edges[k] + edges[k + 1]) / 2
        return middle
    return middle + 1e-4 * space.size * np.array([0.7, 0.9, 1.1])


def page(space, made):
    """Rows, columns and inches of a page with three cuts and a view."""
    ratios = [drawn_ratio(s) for s in made] + [view_ratio(space)]
    if np.mean(ratios[:3]) < 0.5 or min(ratios[0], ratios[2]) < 0.45:
        return 1, 4, 7.4, 5.2, ratios
    if min(ratios) > 2.2:
        return 4, 1, 7.2, 9.0, ratios
    return 2, 2, 7.4, min(max(6.6 / np.median(ratios), 4.6), 7.4), ratios


# ---- grains ----

def read_grains(case, time, wish):
    """Places, diameters and speeds (or components of the velocity) of grains."""
    cloud = grains.read(case, time)
    if "d" not in cloud:
        raise CannotDraw(f"{os.path.join(case.path, time)}/lagrangian/grains has no diameters d")
    U = cloud.get("U", np.zeros_like(cloud["x"]))
    part = wish.component or "mag"
    return cloud["x"], cloud["d"], quantity.Quantity("U", part, (0, 1, -1), quantity.component_of(U, part, 3), figures.units(case.path))


def draw_grains(space, wish):
    """Grains at their places, coloured by speed: disks as circles, spheres shaded."""
    case = space.case
    time = one_time_of_grains(case, wish)
    x, d, q = read_grains(case, time, wish)
    scale = Scale(q, wish)
    return (disks if space.dim == 2 else spheres)(space, wish, time, x, d, q, scale)


def one_time_of_grains(case, wish):
    times = chosen_times(case, wish.time)
    if len(times) > 1:
        raise CannotDraw("a picture of grains is of one time; haffMovie films them")
    if not quantity.has_grains(case, times[0]):
        raise quantity.unknown(case, GRAINS, times[0])
    return times[0]


def disks(space, wish, time, x, d, q, scale):
    h, v = space.axes
    walls, rims = space.flat_ends(h, v, 3 - h - v)
    size = space.size[[h, v]]
    ratio = min(max(size[0] / size[1], 1 / STRIP), STRIP)
    _, tall = arrange(1, ratio)
    figure, axes = new(1, 1, max(min(7.2, (tall - 0.55) * ratio + 1.4), 3.2), tall + 0.35, wish)
    ax = axes[0][0]
    shapes = EllipseCollection(d, d, np.zeros(len(d)), units="xy", offsets=x[:, [h, v]], transOffset=ax.transData, array=q.values,
                               cmap=scale.colours, norm=scale.norm, edgecolors="0.2", linewidths=0.15 if len(d) < 3000 else 0, rasterized=len(d) > 3000)
    ax.add_collection(shapes)
    box = Section(("xyz"[h], "xyz"[v]), walls, rims, corners=np.array([space.low[[h, v]], space.high[[h, v]]]))
    outline(ax, box)
    names_of_axes(ax, box, q.units)
    own_bar(figure, ax, scale, q.label)
    figure.suptitle(f"{title(space.case, time)}    {len(d)} grains", fontsize=9)
    return figure


def spheres(space, wish, time, x, d, q, scale):
    ratio = view_ratio(space)
    figure, axes = new(1, 1, 6.4 if ratio > 0.8 else 4.4, min(max(5.2 / ratio, 3.6), 7.0) if ratio > 0.8 else 7.0, wish)
    ax = axes[0][0]
    ax.set_axis_off()
    figure.suptitle(f"{title(space.case, time)}    {len(d)} grains", fontsize=9)
    bar(figure, ax, scale, q.label, shrink=0.75)
    view = best_view(space)
    canvas = Canvas(view, room_of(figure, ax, wish))
    corners, normals = solid.walls(space, view)
    canvas.triangles(corners, normals, (0.85, 0.85, 0.87))
    canvas.spheres(x, d / 2, scale.colours(scale.norm(q.values))[:, :3])
    canvas.lines(solid.edges(space), (0.35, 0.35, 0.38), hidden=0.1)
    show(ax, canvas)
    name_edges(ax, canvas, space.low, space.high, q.units)
    margins(ax, canvas)
    return figure


# ---- any case ----

def filmed(space, wish, time):
    """The values that a picture at a time gives colours to."""
    if wish.fields == [GRAINS]:
        return read_grains(space.case, time, wish)[2].values
    q = quantity.read(space.case, wish.fields[0], time, wish.component, along=vector_part(space, wish.fields[0], wish, time))
    return q.values if not wish.cut or space.dim < 3 else shown_values(q, space.cut(*wish.cut))


def draw(space, wish):
    """The figure of a case as wished."""
    case = space.case
    first = chosen_times(case, wish.time)[-1]
    if wish.fields == [GRAINS] or (not wish.fields and wish.plain and quantity.has_grains(case, first)):
        if not wish.plain:
            raise CannotDraw("grains are drawn where they are; -slice, -line, -iso and -volume are for fields")
        return draw_grains(space, wish)
    if wish.line:
        return along_line(space, wish)
    if space.dim == 1 and wish.cut:
        raise CannotDraw(f"{case.path} has cells along one axis only, which a plane cuts in one point; -line or no option shows the profile")
    if space.dim == 1 and not wish.plain:
        raise CannotDraw(f"{case.path} has one dimension; -iso and -volume are for three")
    if space.column is not None and wish.plain:
        return profiles(space, wish)
    if wish.cut and space.dim == 2:
        return along_line(space, dataclasses.replace(wish, line=line_of_cut(space, wish.cut), cut=None))
    if space.dim == 2:
        if wish.iso is not None or wish.volume:
            raise CannotDraw(f"{case.path} has two dimensions; -iso and -volume are for three, -contours N draws lines")
        return sections(space, wish)
    if wish.cut:
        return sections(space, wish)
    return surface_alone(space, wish) if wish.volume or wish.iso is not None else cuts(space, wish)


def line_of_cut(space, cut):
    """The line in which a plane cuts a case of two dimensions, from end to end."""
    normal, point = (np.asarray(v, float) for v in cut)
    away = ({0, 1, 2} - set(space.axes)).pop()
    along = np.cross(normal, np.eye(3)[away])
    if not np.linalg.norm(along):
        raise CannotDraw(f"{space.case.path} has no cells along {'xyz'[away]}, across which the plane lies; give x or y")
    along /= np.linalg.norm(along)
    middle = (space.low + space.high) / 2
    point = point.copy()
    point[away] = middle[away]
    free = [k for k in space.axes if abs(normal[k]) < 1e-12]
    for k in free:
        point[k] = middle[k]
    reach = np.linalg.norm(space.size) * 1.01
    a, b = point - reach * along, point + reach * along
    if len(free) == 1:  # along an axis: from its lower end to its upper one
        k = free[0]
        a, b = point.copy(), point.copy()
        a[k], b[k] = space.low[k], space.high[k]
    return tuple(a), tuple(b)
