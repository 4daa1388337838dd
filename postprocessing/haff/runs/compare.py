# SPDX-License-Identifier: GPL-3.0-or-later
"""Two results beside each other: a gas and grains, two grids, two schemes, two codes.

    found = haff.compare("cases/bouncingBed", "cases/bouncingBedMD", ["alpha", "T"], times=[4.03])
    found.table["relative"]
    found.draw("compared.png")
    centres, gas, grains = found.values("alpha", 4.03)

On the coarser of the two meshes. Of two lattices, the finer one is averaged over the volumes of the coarser cells, exactly, whatever their
sizes; of other meshes, the cells of the finer mesh are averaged in the cell of the coarser one whose centre is the nearest. Means are means
over volumes, of U and T, too.
"""
import csv
import os

import numpy as np

from haff.case.case import Case
from haff.case.foam import FormatError
from haff.case.geometry import Geometry
from haff.case.tables import frame

USUAL = ("alpha", "rho", "U", "T", "p")
SAME_TIME = 1e-6  # relative: what is left of a time with six digits
COVERED = 1 - 1e-6  # of a cell's volume


class Comparison:
    """What `compare` found, with a row for each time and field.

    columns {name: array [rows]}: time; field; L1, the mean difference; L2, the root of the mean square; max; scale, the range of the first
    case there, of a vector its greatest length; relative, L1 over scale (nan: the scale is 0); x, y, z (m) of the greatest difference;
    covered, the part of the mesh's volume in which both have values. Differences of vectors are lengths. All in the units of the field.
    notes: texts, of fields whose units differ. table: columns as a pandas.DataFrame, or as a numpy structured array where pandas is not
    installed. times, fields; names: of the two cases; case: the haff.Case whose mesh it is on."""

    def __init__(self, one, other, pairs, fields):
        self.names = labels(one.path, other.path)
        self.times, self.fields = [float(a) for a, _ in pairs], fields
        self.bridge = bridge(one, other)
        self.case, self._cases, self._pairs = self.bridge.coarse, (one, other), pairs
        rows = [self._row(k, name) for k in range(len(pairs)) for name in fields]
        self.notes = [text for text in (self._unlike(name) for name in fields) if text]
        self.columns = {key: np.array([row[key] for row in rows]) for key in rows[0]}

    def _unlike(self, name):
        """Says that a field has another unit in each case; "" where it has not, or a file has none."""
        try:
            units = [case.unit(name, time) or "no unit" for case, time in zip(self._cases, self._pairs[-1])]
        except FormatError:
            return ""
        one, other = self.names
        return "" if units[0] == units[1] else (f"{name} has the unit {units[0]} in {one} and {units[1]} in {other}: "
                                                "their numbers are compared as they are, so convert one of both first")

    @property
    def table(self):
        return frame(self.columns)

    def _both(self, k, name):
        return self.bridge.values(*(case.field(name, time) for case, time in zip(self._cases, self._pairs[k])))

    def values(self, name, time=None):
        """Centres [n][3] of the cells in which both have values, and the values of both there: [n], or [n][components]."""
        one, other = self._both(index(self, time), name)
        cells = np.flatnonzero(present(one) & present(other))
        return self.case.centres[cells], one[cells], other[cells]

    def _row(self, k, name):
        one, other = self._both(k, name)
        if one.shape != other.shape:
            raise ValueError(f"{name} has {one.shape[1:]} components in {self.names[0]}, {other.shape[1:]} in {self.names[1]}")
        cells = np.flatnonzero(present(one) & present(other))
        if not len(cells):
            raise ValueError(f"{self.names[0]} and {self.names[1]} have no cell in common with values of {name} at t = {self.times[k]:g}")
        volume, far = self.case.volumes[cells], size(one[cells] - other[cells])
        weight, worst = volume / volume.sum(), int(far.argmax())
        L1, scale = float(weight @ far), span(one[cells])
        return {"time": self.times[k], "field": name, "L1": L1, "L2": float(np.sqrt(weight @ far**2)), "max": float(far[worst]), "scale": scale,
                "relative": L1 / scale if scale > 0 else np.nan, **dict(zip("xyz", self.case.centres[cells[worst]].tolist())),
                "covered": float(volume.sum() / self.case.volumes.sum())}

    def write(self, path):
        """The table as comma-separated values."""
        with open(path, "w", newline="") as f:
            rows = csv.writer(f, lineterminator="\n")
            rows.writerow(self.columns)
            rows.writerows(zip(*[a.tolist() for a in self.columns.values()]))

    def draw(self, path, fields=None, time=None):
        """The figure of a time (default the last). ValueError: a mesh in three dimensions that is no lattice has no plane to show here."""
        draw(self, path, fields or self.fields, time)


def labels(one, other):
    """Short names of two folders that differ."""
    one, other = os.path.abspath(one), os.path.abspath(other)
    names = os.path.basename(one), os.path.basename(other)
    return names if names[0] != names[1] else tuple(os.path.join(os.path.basename(os.path.dirname(p)), os.path.basename(p)) for p in (one, other))


def present(values):
    """Cells [n] that have a value."""
    return ~np.isnan(values if values.ndim == 1 else values.sum(axis=1))


def size(values):
    """[n]: lengths of vectors, absolute values of scalars."""
    return np.abs(values) if values.ndim == 1 else np.linalg.norm(values, axis=1)


def span(values):
    """The range of a scalar, the greatest length of a vector."""
    return float(np.ptp(values) if values.ndim == 1 else size(values).max())


# ---- one mesh for both ----


def bridge(one, other):
    """What brings both cases' values onto the coarser mesh."""
    if same_mesh(one, other):
        return Bridge(one, one, lambda v: v, False)
    swap = one.mesh.cells > other.mesh.cells
    coarse, fine = (other, one) if swap else (one, other)
    if coarse.lattice() and fine.lattice():
        move = between_lattices(coarse.lattice(), fine.lattice())
    else:
        move = between_centres(coarse, fine)
    return Bridge(coarse, fine, move, swap)


class Bridge:
    """coarse, fine: the cases; `move` takes values [cells] or [cells][m] of the fine mesh to the coarse one, nan where it has none."""

    def __init__(self, coarse, fine, move, swap):
        self.coarse, self.fine, self.move, self.swap = coarse, fine, move, swap

    def values(self, one, other):
        """Of both cases on the coarse mesh, in the order in which they came."""
        return (self.move(one), other) if self.swap else (one, self.move(other))


def same_mesh(one, other):
    if one.mesh.cells != other.mesh.cells:
        return False
    extent = np.ptp(one.centres, axis=0).max() or np.cbrt(one.volumes[0])
    return np.allclose(one.centres, other.centres, rtol=0, atol=1e-9 * extent) and np.allclose(one.volumes, other.volumes, rtol=1e-6, atol=0)


def between_lattices(coarse, fine):
    """Exact means over the volumes of the coarse cells; an axis along which both have one cell is left out."""
    def one_field(values):
        values = fine.raster(values.astype(float))
        here = ~np.isnan(values)
        total, part = np.where(here, values, 0), here.astype(float)
        for axis in range(3):
            if not coarse.shape[axis] == fine.shape[axis] == 1:
                total, part = (rebinned(a, fine.edges[axis], coarse.edges[axis], 2 - axis) for a in (total, part))
        mean = np.full(total.shape, np.nan)
        np.divide(total, part, out=mean, where=part > COVERED)
        return mean.ravel()[coarse.index]

    return lambda values: one_field(values) if values.ndim == 1 else np.stack([one_field(v) for v in values.T], axis=1)


def rebinned(values, old, new, axis):
    """Means over cells between the lines `new` of values that are constant between the lines `old`, 0 outside. Of equal lines: the values."""
    if len(old) == len(new) and np.allclose(old, new, rtol=0, atol=1e-9 * (old[-1] - old[0])):
        return values
    new = snapped(new, old)
    values = np.moveaxis(values, axis, 0)
    width = np.diff(old).reshape(-1, *[1] * (values.ndim - 1))
    below = np.concatenate((np.zeros_like(values[:1]), np.cumsum(values * width, axis=0)))  # the integral up to each old line
    at = np.clip(new, old[0], old[-1])
    cell = np.clip(np.searchsorted(old, at, "right") - 1, 0, len(old) - 2)
    integral = below[cell] + values[cell] * (at - old[cell]).reshape(-1, *[1] * (values.ndim - 1))
    return np.moveaxis(np.diff(integral, axis=0) / np.diff(new).reshape(-1, *[1] * (values.ndim - 1)), 0, axis)


def snapped(lines, to):
    """Lines that are within 1e-9 of the extent of another one are that one: the ends of two meshes differ by round-off."""
    above = np.clip(np.searchsorted(to, lines), 1, len(to) - 1)
    near = np.where(lines - to[above - 1] < to[above] - lines, to[above - 1], to[above])
    return np.where(np.abs(lines - near) <= 1e-9 * (to[-1] - to[0]), near, lines)


def between_centres(coarse, fine):
    """Means over the fine cells whose nearest coarse centre it is; a coarse cell without any takes the nearest fine cell's value, if that is
    no farther than both cells' sizes."""
    from scipy.spatial import cKDTree
    c, f = Geometry(coarse), Geometry(fine)
    if c.axes != f.axes:
        raise ValueError(f"{coarse.path} lies along the axes {c.axes}, {fine.path} along {f.axes}: they cannot be compared")
    away, cell = cKDTree(c.at).query(f.at)
    d = len(c.axes)
    reach = lambda g: g.h * (g.volumes / g.volumes.mean()) ** (1 / d)
    inside = away <= reach(c)[cell]
    volume = np.bincount(cell[inside], f.volumes[inside], len(c.at))
    nearest_away, nearest = cKDTree(f.at).query(c.at)
    alone = (volume == 0) & (nearest_away <= reach(c) + reach(f)[nearest])

    def one_field(values):
        total = np.bincount(cell[inside], (values * f.volumes)[inside], len(c.at))
        mean = np.full(len(c.at), np.nan)
        np.divide(total, volume, out=mean, where=volume > 0)
        mean[alone] = values[nearest[alone]]
        return mean

    return lambda values: one_field(values) if values.ndim == 1 else np.stack([one_field(v) for v in values.T], axis=1)


# ---- what is compared ----


def common_times(one, other, wanted=None):
    """Pairs of names. ValueError where there is none, or a wanted one is not among them."""
    pairs = []
    for a in one.times:
        b = min(other.times, key=lambda name: abs(float(name) - float(a)), default=None)
        if b is not None and abs(float(a) - float(b)) <= SAME_TIME * max(abs(float(a)), abs(float(b))):
            pairs.append((a, b))
    if not pairs:
        raise ValueError(f"{one.path} and {other.path} have no time in common: {', '.join(one.times) or 'none'}; {', '.join(other.times) or 'none'}")
    if wanted is None:
        return pairs
    found = [min(pairs, key=lambda p: abs(float(p[0]) - float(t))) for t in wanted]
    for t, (a, _) in zip(wanted, found):
        if abs(float(a) - float(t)) > SAME_TIME * max(abs(float(a)), abs(float(t))):
            raise ValueError(f"time {t:g} is not in both cases; they share {', '.join(p[0] for p in pairs)}")
    return found


def has(case, time, name):
    path = os.path.join(case.path, time, name)
    return os.path.exists(path) or os.path.exists(path + ".gz")


def common_fields(one, other, pairs, wanted=None):
    """The wanted fields, or those of USUAL that all times of both have. ValueError where one is missing."""
    lacks = lambda name: [f"{case.path}/{time}" for pair in pairs for case, time in zip((one, other), pair) if not has(case, time, name)]
    if wanted is None:
        found = [name for name in USUAL if not lacks(name)]
        if not found:
            raise ValueError(f"{one.path} and {other.path} share none of the fields {', '.join(USUAL)}: name them")
        return found
    wanted = [wanted] if isinstance(wanted, str) else list(wanted)
    for name in wanted:
        if lacks(name):
            raise ValueError(f"there is no field {name} in {lacks(name)[0]}")
    return wanted


def compare(one, other, fields=None, *, times=None, figure=None):
    """The Comparison of two cases (haff.Case, or paths).

    fields: a name or names; default those of alpha, rho, U, T, p that both have. times: numbers; default all that both have. figure: path
    of a figure of the last time (png, pdf, svg). ValueError: no time, field or cell in common; FileNotFoundError: no case there.
    """
    one, other = (case if isinstance(case, Case) else Case(str(case)) for case in (one, other))
    pairs = common_times(one, other, times)
    found = Comparison(one, other, pairs, common_fields(one, other, pairs, fields))
    if figure:
        found.draw(figure)
    return found


# ---- the figure ----


def draw(found, path, fields, time):
    from haff.plot import figures
    lattice = found.case.lattice()
    axes = [a for a in range(3) if lattice.shape[a] > 1] if lattice else None
    if lattice and len(axes) < 2:
        figure = lines(found, figures, fields, time, (axes or [0])[0])
    else:
        figure = maps(found, figures, fields, time, plane(found.case, axes))
    figure.suptitle(figures.with_time(found.times[index(found, time)], found.case.units), fontsize=9)
    kind = os.path.splitext(path)[1].lstrip(".") or "png"
    figure.savefig(path, format=kind)
    figures.plt.close(figure)


def both_sizes(found, name, time):
    """Values of the two on all cells [cells], of vectors the lengths; and what they are called, with the unit."""
    one, other = found._both(index(found, time), name)
    length, measured = one.ndim > 1, found._cases[0].unit(name, found._pairs[index(found, time)][0])
    title = (f"|{name}|" if length else name) + (f" ({measured})" if measured else "")
    return (size(one), size(other), title) if length else (one, other, title)


def index(found, time):
    """Of the time nearest to a number; None: of the last."""
    return len(found.times) - 1 if time is None else int(np.argmin(np.abs(np.array(found.times) - float(time))))


def lines(found, figures, fields, time, axis):
    figure, panels = figures.panels(1, len(fields), width=3.2 * len(fields))
    x = found.case.centres[:, axis]
    order = np.argsort(x)
    for ax, name in zip(panels[0], fields):
        one, other, title = both_sizes(found, name, time)
        ax.plot(x[order], one[order], label=found.names[0])
        ax.plot(x[order], other[order], "--", label=found.names[1])
        ax.set_xlabel(figures.with_unit(f"${'xyz'[axis]}$", (0, 1, 0), found.case.units))
        ax.set_ylabel(title)
    panels[0][0].legend()
    return figure


def plane(case, axes):
    """A function (axes of a figure, values [cells], options) that draws a plane of the mesh, and returns what a colour bar wants."""
    if axes is None:
        from haff.plot import cellmap
        empty = [name for name, (kind, _, count) in case.mesh.patches.items() if kind == "empty" and count]
        if not empty:
            raise ValueError(f"{case.path}: a mesh in three dimensions that is no lattice is not drawn here; haffPlot cuts it")
        patch = one_side(case.mesh, empty)
        return lambda ax, values, clim, colours: cellmap.draw(ax, case, values, patch, colours=colours, span=clim, unit=case.units["length"])
    lattice = case.lattice()
    across = min((a for a in range(3) if a not in axes[:2]), default=2)

    def draw_lattice(ax, values, clim, colours):
        cells = np.take(lattice.raster(values), lattice.shape[across] // 2, axis=2 - across)
        u, v = (a for a in range(3) if a != across)
        tint = ax.pcolormesh(lattice.edges[u], lattice.edges[v], cells, vmin=clim[0], vmax=clim[1], cmap=colours, rasterized=True)
        ax.set(aspect="equal", **{f"{side}label": f"${'xyz'[k]}$ ({case.units['length']})" for side, k in (("x", u), ("y", v))})
        return tint

    return draw_lattice


def one_side(mesh, patches):
    """The patch that shows each cell once: of several the first whose faces are as many as the cells."""
    return next((name for name in patches if mesh.patches[name][2] == mesh.cells), patches[0])


def maps(found, figures, fields, time, show):
    figure, panels = figures.panels(len(fields), 3, width=9.0)
    for row, name in zip(panels, fields):
        one, other, title = both_sizes(found, name, time)
        some = np.concatenate((one[~np.isnan(one)], other[~np.isnan(other)]))
        clim = some.min(), some.max()
        far = np.nanmax(np.abs(one - other)) or 1
        pictures = ((one, clim, "viridis", found.names[0]), (other, clim, "viridis", found.names[1]), (one - other, (-far, far), "RdBu_r", "difference"))
        for ax, (values, limits, colours, word) in zip(row, pictures):
            figure.colorbar(show(ax, values, limits, colours), ax=ax, shrink=0.8)
            ax.set_title(f"{title}, {word}", fontsize=9)
    return figure
