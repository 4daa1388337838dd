# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose cells are places of a lattice: boxes between straight lines along the axes, equal or not, with holes or not.

    lattice = haff.Case("cases/wedge").lattice()
    lattice.edges           (x, y, z): the lines between the cells along each axis, ascending, in m
    lattice.shape           (nx, ny, nz) cells of the box around all
    lattice.ijk             [cells][3]: the place of each cell
    lattice.raster(values)  [nz][ny][nx] of values [cells]; nan where there is no cell

It is recognised by whole numbers: a point is a place on the lines, and a face is right if its corners are neighbours there. No
centre and no area is computed.
"""
import functools

import numpy as np

CHUNK = 1 << 20  # points or faces at once
TOLERANCE = 1e-6  # of a cell: that of the solvers


class Lattice:
    """edges: three arrays (m); index [cells]: i + nx*(j + ny*k), the place of each cell."""

    def __init__(self, edges, index):
        self.edges, self.index = tuple(even(e) for e in edges), index
        self.shape = tuple(len(e) - 1 for e in edges)

    @property
    def full(self):
        """There are no holes."""
        return len(self.index) == np.prod(self.shape, dtype=np.int64)

    @functools.cached_property
    def ordered(self):
        """The cells are numbered as the places are, x fastest, without holes: rasters are views."""
        return self.full and bool((self.index == np.arange(len(self.index))).all())

    @property
    def ijk(self):
        """Places [cells][3] along x, y, z."""
        nx, ny, _ = self.shape
        return np.stack([self.index % nx, self.index // nx % ny, self.index // (nx * ny)], axis=1)

    @property
    def middles(self):
        """Of the cells along each axis: three arrays (m)."""
        return tuple((e[1:] + e[:-1]) / 2 for e in self.edges)

    @property
    def widths(self):
        """Of the cells along each axis: three arrays (m)."""
        return tuple(np.diff(e) for e in self.edges)

    @property
    def equal(self):
        """All cells are of one size, as the fast engine of granularGas wants them."""
        return all(np.ptp(w) <= TOLERANCE * w[0] for w in self.widths)

    def spread(self, along):
        """Three arrays, one for each axis, as [cells][3]."""
        out = np.empty((len(self.index), 3))
        nx, ny, _ = self.shape
        out[:, 0] = along[0][self.index % nx]
        out[:, 1] = along[1][self.index // nx % ny]
        out[:, 2] = along[2][self.index // (nx * ny)]
        return out

    def centres(self):
        """[cells][3], m."""
        return self.spread(self.middles)

    def volumes(self):
        """[cells], m^3."""
        if self.ordered:
            x, y, z = self.widths
            return (z[:, None, None] * y[:, None] * x).ravel()
        return self.spread(self.widths).prod(axis=1)

    def cells(self, missing=-1):
        """The cell at each place: [nz][ny][nx], `missing` in holes."""
        found = np.full(np.prod(self.shape, dtype=np.int64), missing, np.int64)
        found[self.index] = np.arange(len(self.index))
        return found.reshape(self.shape[::-1])

    def raster(self, values, fill=np.nan):
        """Values [cells] or [cells][m] as [nz][ny][nx] or [nz][ny][nx][m]; `fill` in holes. A view where that is possible."""
        shape = (*self.shape[::-1], *values.shape[1:])
        if self.ordered:
            return values.reshape(shape)
        found = np.full((np.prod(self.shape, dtype=np.int64), *values.shape[1:]), fill, np.result_type(values, type(fill)))
        found[self.index] = values
        return found.reshape(shape)

    def find(self, points):
        """The cells [n] that hold points [n][3] (m); -1 outside and in holes. On a face: the cell above."""
        place, inside = np.zeros(len(points), np.int64), np.ones(len(points), bool)
        for axis in (2, 1, 0):
            edges = self.edges[axis]
            x = points[:, axis]
            i = np.searchsorted(edges, x, "right") - 1
            i[x == edges[-1]] = len(edges) - 2
            inside &= (i >= 0) & (i <= len(edges) - 2)
            place = place * (len(edges) - 1) + np.clip(i, 0, len(edges) - 2)
        return np.where(inside, self._cells[place], -1)

    @functools.cached_property
    def _cells(self):
        return self.cells().ravel()


def even(edges):
    """Lines at equal distances, where those given are so within the tolerance: the cells of the solver have one size, and the places of points
    in a mesh file are some 1e-11 beside that."""
    width = np.diff(edges)
    return np.linspace(edges[0], edges[-1], len(edges)) if np.ptp(width) <= TOLERANCE * width.min() else edges


def recognise(mesh):
    """The Lattice of a mesh, or None. Arrays of the mesh that were not in memory are not left there."""
    had = set(mesh.__dict__)
    found = lattice_of(mesh)
    for name in {"points", "owner", "neighbour", "_faces"} - had:
        mesh.__dict__.pop(name, None)
    return found


def lattice_of(mesh):
    if not mesh.cells or not boxes(mesh):
        return None
    lines = [lines_of(mesh.points, axis) for axis in range(3)]
    if any(line is None or len(line) > mesh.cells + 1 for line in lines):
        return None
    n = [len(line) for line in lines]
    step = [1, n[0] + 2, (n[0] + 2) * (n[1] + 2)]  # a step over an end of a line does not lead to another line
    kind = np.int32 if 4 * (step[2] * (n[2] + 2)) < 2**31 else np.int64
    corner = corners_of(mesh, places_of(mesh.points, lines, step, kind), step, kind)
    if corner is None:
        return None
    k, rest = np.divmod(corner, step[2])
    j, i = np.divmod(rest, step[1])
    index = i + np.int64(n[0] - 1) * (j + np.int64(n[1] - 1) * k)
    if np.bincount(index, minlength=1).max() > 1:
        return None
    return Lattice(tuple(lines), index)


def boxes(mesh):
    """All faces have four points, all cells six faces."""
    start = mesh.face_start
    if not (np.diff(start[:CHUNK]) == 4).all() or start[-1] != 4 * (len(start) - 1) or not (np.diff(start) == 4).all():
        return False
    faces = np.bincount(mesh.owner, minlength=mesh.cells)
    faces += np.bincount(mesh.neighbour, minlength=mesh.cells)
    return bool((faces == 6).all())


class Line:
    """Lines along an axis, ascending; finds the line that a coordinate stands on."""

    def __init__(self, values):
        self.values = values
        gap = np.diff(values)
        self.tolerance = TOLERANCE * gap.max() if len(gap) else 0
        self.equal = len(gap) > 0 and np.ptp(gap) <= 1e-3 * gap.max()

    def place(self, x):
        """Numbers of the nearest lines."""
        if self.equal:
            first, n = self.values[0], len(self.values)
            return np.clip(np.rint((x - first) * ((n - 1) / (self.values[-1] - first))), 0, n - 1).astype(np.int32)
        middle = (self.values[1:] + self.values[:-1]) / 2
        return np.searchsorted(middle, x).astype(np.int32)

    def others(self, x):
        """The coordinates that stand on none."""
        return x[np.abs(x - self.values[self.place(x)]) > self.tolerance]


def lines_of(points, axis):
    """The different coordinates, ascending; those within TOLERANCE of the widest gap are one. None: they are too many."""
    line = None
    for first in range(0, len(points), CHUNK):
        x = np.ascontiguousarray(points[first:first + CHUNK, axis])
        new = x if line is None else line.others(x)
        if len(new):
            values = np.unique(new if line is None else np.concatenate((line.values, new)))
            line = Line(merged(values))
            if len(line.values) > len(points) // 4 + 1:  # a layer of the lattice has four points at least
                return None
    return line.values


def merged(values):
    """The first of each group of ascending values."""
    gap = np.diff(values)
    keep = np.concatenate(([True], gap > TOLERANCE * gap.max())) if len(gap) else np.ones(len(values), bool)
    return values[keep]


def places_of(points, lines, step, kind):
    """One whole number for each point: its place on the lines."""
    place = np.zeros(len(points), kind)
    for axis, values in enumerate(lines):
        line = Line(values)
        for first in range(0, len(points), CHUNK):
            some = slice(first, first + CHUNK)
            place[some] += line.place(points[some, axis]).astype(kind) * kind(step[axis])
    return place


def corners_of(mesh, place, step, kind):
    """The place of the lowest corner of each cell [cells]; None if a face is no face of a lattice, or the faces of a cell disagree.

    A face is a unit square: its corners 1 and 3 are one step from corner 0, along two axes, and corner 2 is both steps away. Its
    points run so that the area points from the owner to the neighbour, which says on which side of the face each of them is."""
    corner = np.full(mesh.cells, -1, kind)
    count, inner = len(mesh.owner), len(mesh.neighbour)
    for first in range(0, count, CHUNK):
        last = min(first + CHUNK, count)
        found = lowest(place[mesh.face_points[4 * first:4 * last]].reshape(-1, 4), step)
        if found is None:
            return None
        low, high = found
        if not agree(corner, mesh.owner[first:last], low):
            return None
        if first < inner and not agree(corner, mesh.neighbour[first:last], high[:min(last, inner) - first]):
            return None
    return corner


def lowest(place, step):
    """Places of the lowest corners of the owners and of the neighbours of faces whose corners have the places [n][4]; or None."""
    p = np.ascontiguousarray(place.T)
    one, two = p[1] - p[0], p[3] - p[0]
    if (p[2] - p[0] != one + two).any():
        return None
    a, b = axis_of(np.abs(one), step), axis_of(np.abs(two), step)
    normal = np.array([[-1, 2, 1, -1], [2, -1, 0, -1], [1, 0, -1, -1], [-1, -1, -1, -1]], np.int8)[a, b]
    if (normal < 0).any():
        return None
    turn = np.array([[0, 1, -1], [-1, 0, 1], [1, -1, 0]], np.int8)[a, b]
    along = ((one > 0) == (two > 0)) == (turn > 0)  # the area points up the axis
    low = p[0] + np.minimum(one, 0) + np.minimum(two, 0)
    below = low - np.array(step, place.dtype)[normal]
    return np.where(along, below, low), np.where(along, low, below)


def axis_of(distance, step):
    """0, 1 or 2 where the distance is one step along that axis, else 3."""
    return np.where(distance == step[0], 0, np.where(distance == step[1], 1, np.where(distance == step[2], 2, 3))).astype(np.int8)


def agree(corner, cell, low):
    """Notes the corners of cells; False if another one stood there."""
    before = corner[cell]
    if ((before >= 0) & (before != low)).any():
        return False
    corner[cell] = low
    return bool((corner[cell] == low).all())
