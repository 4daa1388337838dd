# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures in three dimensions: surfaces, clouds, cuts beside them; and grains, as circles or as spheres."""
import os
import re

import numpy as np
from matplotlib.collections import EllipseCollection

from haff.case import grains
from haff.plot import figures, quantity, solid
from haff.plot.canvas import Canvas, FINE, View
from haff.plot.maps import drawn_ratio, names_of_axes, outline, paint
from haff.plot.quantity import CannotDraw, GRAINS
from haff.plot.scale import STRIP, Scale, arrange, bar, new, own_bar
from haff.plot.space import Section
from haff.plot.wish import chosen_times, title


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
        value = wish.iso if wish.iso is not None else parting_value(scale, q.values)
        corners, normals = solid.isosurface(space, q.values, value)
        if not len(corners) and wish.iso is not None:
            low, high = quantity.limits(q.values)
            raise CannotDraw(f"{q.name} has no surface at {value:g}; it lies between {low:g} and {high:g}")
        canvas.triangles(corners, normals, scale.colours(scale.norm(value))[:3])
    canvas.lines(named_edges(view, space.low, space.high), (0.75, 0.75, 0.75), width=0.7)
    canvas.lines(solid.edges(space), (0.35, 0.35, 0.38), hidden=0.18)
    if wish.volume:
        solid.cloud(canvas, space, q.values, (scale.norm.vmin, scale.norm.vmax), scale.colours)
    return canvas, value


def parting_value(scale, values):
    """The value that parts the field into two sets of cells whose means differ most (Otsu 1979): share (1 - share) (difference)^2 is
    largest. Of shocked and unshocked gas, or of clusters and what is between them, it is one between both. By their logarithms where the
    colours are logarithmic."""
    shown = np.clip(scale.norm(values[np.isfinite(values)]).filled(0), 0, 1)
    count, ends = np.histogram(shown, 128, (0, 1))
    middle = (ends[1:] + ends[:-1]) / 2
    low = np.cumsum(count)[:-1]
    high = count.sum() - low
    first = np.cumsum(count * middle)[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        parted = np.nan_to_num(low * high * (first / low - ((count * middle).sum() - first) / high) ** 2)
    best = np.flatnonzero(parted >= parted.max() * (1 - 1e-9))  # all of them where nothing parts
    return float(scale.norm.inverse(ends[1:-1][best].mean()))


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


def draw_solid(figure, axes, space, q, scale, wish):
    """The surface or the cloud of a field, with the edges of its box named."""
    canvas, _ = solid_image(space, q, scale, wish, room_of(figure, axes, wish))
    show(axes, canvas)
    name_edges(axes, canvas, space.low, space.high, q.units)
    margins(axes, canvas)


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
    value = None if wish.volume else wish.iso if wish.iso is not None else parting_value(scale, q.values)
    bar(figure, ax, scale, q.label, mark=value, shrink=0.75)
    draw_solid(figure, ax, space, q, scale, wish)
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
    middle = inside(space, q.values)
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
    value = wish.iso if wish.iso is not None else parting_value(scale, q.values)
    last.set_title(f"{q.symbol} = {value:.3g}", fontsize=9, loc="left")
    bar(figure, axes, scale, q.label, mark=value, aspect=35)
    draw_solid(figure, last, space, q, scale, wish)
    return figure


def inside(space, values):
    """A point that planes through it cut cells at, not the faces between them: the middle of a lattice; of any other mesh the middle of
    what differs from the median of the field, as a mesh around a body has most of its space where nothing happens."""
    middle = (space.low + space.high) / 2
    if space.lattice:
        for axis, edges in enumerate(space.lattice.edges):
            k = (len(edges) - 1) // 2
            middle[axis] = (edges[k] + edges[k + 1]) / 2
        return middle
    weight = np.abs(values - np.median(values)) * space.case.volumes
    if weight.sum() > 0:
        middle = weight @ space.case.centres / weight.sum()
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
                               cmap=scale.colours, norm=scale.norm, edgecolors="0.2", linewidths=0.15 if len(d) < 3000 else 0,
                               rasterized=len(d) > 3000)
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
