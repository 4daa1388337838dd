# SPDX-License-Identifier: GPL-3.0-or-later
"""Where points lie in a mesh, of any kind and dimension, and values there: at points, along lines, in planes.

Along axes of one cell between empty patches a point may be anywhere. Order 1 is the value of the cell that holds the point; order 2
adds the cell's gradient times the way from its centre, so that linear fields are exact. The gradient is the least-squares fit to the
neighbours across faces, weighted by 1/distance^2, and to theirs, too, where the mesh is no lattice; where they do not span the axes
of the mesh, to cells farther away.
Cells of a mesh that is no lattice are taken as convex; a face whose corners lie in no plane counts as thick as they deviate from one.
"""
import functools

import numpy as np

AXES = "xyz"
CLOSE = 1e-9  # of a cell: what still counts as inside
CHUNK = 1 << 20  # pairs of a point and a cell that are looked at together
FARTHEST = 6  # faces to a neighbour: of a cell in a way of one cell's width
SPANNED = 1e-8  # smallest eigenvalue of a spanned axis over the greatest


class Finder:
    """Finds the cells of a case that hold points, and the neighbours and gradients of cells."""

    def __init__(self, case):
        self.case, self.mesh, self.lattice = case, case.mesh, case.lattice()

    @functools.cached_property
    def empty_axes(self):
        """Axes across which the mesh has one cell: those of its `empty` patches. A list of 0, 1, 2."""
        found = set()
        for kind, first, count in self.mesh.patches.values():
            if kind == "empty" and count:
                area = np.abs(self.mesh.face_geometry(first, first + count)[1])
                found |= set(area.argmax(axis=1).tolist())
        return sorted(found)

    @property
    def axes(self):
        """The others."""
        return [a for a in range(3) if a not in self.empty_axes]

    @functools.cached_property
    def box(self):
        """Lowest and highest corner [3] of the mesh, m."""
        if self.lattice:
            return np.array([e[0] for e in self.lattice.edges]), np.array([e[-1] for e in self.lattice.edges])
        return self.mesh.points.min(axis=0), self.mesh.points.max(axis=0)

    @property
    def middle(self):
        """Of the box, [3], m."""
        return (self.box[0] + self.box[1]) / 2

    def flattened(self, points):
        """Points [n][3] (m) moved to the middle of the mesh along its empty axes. ValueError for other shapes."""
        points = np.array(points, float)
        if points.ndim not in (1, 2) or points.shape[-1] != 3:
            raise ValueError(f"points have the shape {points.shape}; [n][3] is wanted")
        points = points.reshape(-1, 3)
        points[:, self.empty_axes] = self.middle[self.empty_axes]
        return points

    def cells(self, points):
        """The cells [n] that hold points [n][3] (m); -1 where none does."""
        points = self.flattened(points)
        return self.lattice.find(points) if self.lattice else self.boxes.find(points)

    @functools.cached_property
    def boxes(self):
        return Boxes(self)

    @functools.cached_property
    def faces(self):
        """Of all cells: start [cells + 1]; face, and sign of its area outwards, [start[-1]]: those of cell i from start[i] to start[i+1]."""
        mesh = self.mesh
        cell = np.concatenate((mesh.owner, mesh.neighbour))
        order = np.argsort(cell, kind="stable")
        start = np.concatenate(([0], np.cumsum(np.bincount(cell, minlength=mesh.cells))))
        face = np.where(order < len(mesh.owner), order, order - len(mesh.owner))
        return start, face, np.where(order < len(mesh.owner), 1.0, -1.0)

    # ---- neighbours and gradients ----

    def neighbours(self, cells):
        """Pairs (row [k], cell [k]): the neighbours of cells[row], across faces."""
        if self.lattice:
            return self.lattice_neighbours(cells)
        return self.across(np.arange(len(cells)), cells)

    def around(self, cells, reach):
        """The same up to `reach` faces away."""
        row, near = self.neighbours(cells)
        for _ in range(reach - 1):
            again, far = self.neighbours(near)
            row, near = np.unique(np.stack((np.concatenate((row, row[again])), np.concatenate((near, far)))), axis=1)
        other = near != cells[row]
        return row[other], near[other]

    def across(self, rows, cells):
        start, face, sign = self.faces
        row, at = ranges(start[cells], start[cells + 1])
        inner = face[at] < len(self.mesh.neighbour)
        at = at[inner]
        return rows[row[inner]], np.where(sign[at] > 0, self.mesh.neighbour[face[at]], self.mesh.owner[face[at]])

    def lattice_neighbours(self, cells):
        n, place, number = self.lattice.shape, self.lattice.index[cells], self.lattice._cells
        rows, found, stride = [], [], 1
        for axis in range(3):
            along = place // stride % n[axis]
            for step in (-1, 1):
                row = np.flatnonzero((along + step >= 0) & (along + step < n[axis]))
                near = number[place[row] + step * stride]
                rows.append(row[near >= 0])
                found.append(near[near >= 0])
            stride *= n[axis]
        return np.concatenate(rows), np.concatenate(found)

    def centres(self, cells):
        """[n][3] (m) of some cells, without those of the others on a lattice."""
        if not self.lattice:
            return self.case.centres[cells]
        n, place = self.lattice.shape, self.lattice.index[cells]
        x, y, z = self.lattice.middles
        return np.stack((x[place % n[0]], y[place // n[0] % n[1]], z[place // (n[0] * n[1])]), axis=1)

    def gradients(self, values, cells):
        """[n][3] of values [all cells], or [n][m][3] of [all cells][m], in n cells (per m). 0 along axes that no cell near it is on."""
        reach = 1 if self.lattice else 2
        found, spanned = self.fit(values, cells, *self.around(cells, reach))
        while not spanned.all() and reach < FARTHEST:
            reach += 1
            some = np.flatnonzero(~spanned)
            found[some], spanned[some] = self.fit(values, cells[some], *self.around(cells[some], reach))
        return found

    def fit(self, values, cells, row, near):
        """Gradients by these neighbours, and whether they span the axes of the mesh, [n]."""
        away = self.centres(near) - self.centres(cells)[row]
        weight = 1 / np.einsum("ij,ij->i", away, away)
        normal = np.zeros((len(cells), 3, 3))
        for i in range(3):
            for j in range(3):
                normal[:, i, j] = np.bincount(row, weight * away[:, i] * away[:, j], len(cells))
        change = values[near] - values[cells][row]
        flat = change.reshape(len(row), -1)
        right = np.stack([np.stack([np.bincount(row, weight * away[:, i] * flat[:, m], len(cells)) for i in range(3)], 1)
                          for m in range(flat.shape[1])], 1)
        found = np.einsum("nij,nmj->nmi", np.linalg.pinv(normal, rcond=SPANNED, hermitian=True), right)
        size = np.linalg.eigvalsh(normal[:, self.axes][:, :, self.axes]) if self.axes else np.ones((len(cells), 1))
        return found.reshape(len(cells), *change.shape[1:], 3), size[:, 0] > SPANNED * size[:, -1]

    def values(self, values, points, order=1, cells=None):
        """Values [all cells] or [all cells][m] at points [n][3] (m): [n] or [n][m]; nan where no cell is. cells [n]: if they are known."""
        if order not in (1, 2):
            raise ValueError(f"order is {order}; allowed are 1 (the cell's value) and 2 (with its gradient)")
        points = self.flattened(points)
        cells = self.cells(points) if cells is None else cells
        found = np.full((len(points), *values.shape[1:]), np.nan)
        inside = np.flatnonzero(cells >= 0)
        found[inside] = values[cells[inside]]
        if order == 2 and len(inside):
            held, back = np.unique(cells[inside], return_inverse=True)
            away = points[inside] - self.centres(held)[back]
            found[inside] += np.einsum("n...j,nj->n...", self.gradients(values, held)[back], away)
        return found


def ranges(first, last):
    """(row, number): the numbers first[row] .. last[row]-1 of all rows, one after the other."""
    count = last - first
    row = np.repeat(np.arange(len(first)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)


class Boxes:
    """Cells by the boxes around them, to find those that hold points: of each size of boxes, a grid of rooms as wide as they are, and
    in each room the cells whose boxes reach into it. A cell holds a point that is behind all its faces; of several cells it is the one
    in which the point lies deepest, and of these the first."""

    def __init__(self, finder):
        self.finder, mesh = finder, finder.mesh
        self.faces = finder.faces
        self.low, self.high = self.corners(mesh, self.faces)
        self.origin, self.size = finder.box[0], (self.high - self.low)
        self.close = CLOSE * self.size.max(axis=1)
        self.centre, area = mesh.face_geometry()
        self.normal = area / np.maximum(np.linalg.norm(area, axis=1), 1e-300)[:, None]
        self.warp = self.deviation(mesh)
        self.groups = [self.group(cells, width) for cells, width in self.sizes()]

    @staticmethod
    def corners(mesh, faces):
        """Lowest and highest corners [cells][3]."""
        start, face, _ = faces
        found = []
        for least in (np.minimum, np.maximum):
            of_face = least.reduceat(mesh.points[mesh.face_points], mesh.face_start[:-1].astype(np.int64), axis=0)
            found.append(least.reduceat(of_face[face], start[:-1], axis=0))
        return found

    def deviation(self, mesh):
        """The greatest distance [faces] of a corner from the plane of its face, m."""
        face = np.repeat(np.arange(len(mesh.owner)), np.diff(mesh.face_start))
        away = np.abs(np.einsum("ij,ij->i", mesh.points[mesh.face_points] - self.centre[face], self.normal[face]))
        return np.maximum.reduceat(away, mesh.face_start[:-1].astype(np.int64))

    def sizes(self):
        """(cells, width [3] of rooms): groups of cells whose boxes are equal to a factor of 2 along each axis."""
        power = np.ceil(np.log2(np.maximum(self.size, 1e-300)) - 1e-6)
        different, group = np.unique(power, axis=0, return_inverse=True)
        for k, row in enumerate(different):
            yield np.flatnonzero(group.reshape(-1) == k), 2.0**row

    def group(self, cells, width):
        """(width, rooms along the axes, numbers of rooms ascending, the cell in each)."""
        margin = self.close[cells, None]
        low, high = (np.floor((x - self.origin) / width).astype(np.int64) for x in (self.low[cells] - margin, self.high[cells] + margin))
        least = low.min(axis=0)
        count = high.max(axis=0) - least + 1
        number, held = [], []
        reach = high - low
        for step in np.ndindex(*(reach.max(axis=0) + 1)):
            some = np.flatnonzero((reach >= step).all(axis=1))
            number.append(self.room(low[some] + step - least, count))
            held.append(cells[some])
        number, held = np.concatenate(number), np.concatenate(held)
        order = np.argsort(number, kind="stable")
        return width, least, count, number[order], held[order]

    @staticmethod
    def room(place, count):
        return place[:, 0] + count[0] * (place[:, 1] + count[1] * place[:, 2])

    def find(self, points):
        """The cells [n] that hold points [n][3] (m); -1 where none does."""
        found, depth = np.full(len(points), -1), np.full(len(points), np.inf)
        for width, least, count, number, held in self.groups:
            place = np.floor((points - self.origin) / width)
            inside = np.flatnonzero(((place >= least) & (place < least + count)).all(axis=1))
            room = self.room(place[inside].astype(np.int64) - least, count)
            first, last = np.searchsorted(number, room, "left"), np.searchsorted(number, room, "right")
            self.try_all(points, found, depth, inside, held, first, last)
        return found

    def try_all(self, points, found, depth, inside, held, first, last):
        """Looks at the cells held[first:last] of each point, CHUNK pairs at a time."""
        total = np.cumsum(last - first)
        at = 0
        while at < len(inside):
            end = max(at + 1, int(np.searchsorted(total, (total[at - 1] if at else 0) + CHUNK, "right")))
            row, k = ranges(first[at:end], last[at:end])
            self.try_pairs(points, found, depth, inside[at:end][row], held[k])
            at = end

    def try_pairs(self, points, found, depth, point, cell):
        x, near = points[point], self.close[cell, None]
        boxed = ((x >= self.low[cell] - near) & (x <= self.high[cell] + near)).all(axis=1)
        point, cell, x = point[boxed], cell[boxed], x[boxed]
        if not len(point):
            return
        start, face, sign = self.faces
        row, at = ranges(start[cell], start[cell + 1])
        f = face[at]
        before = sign[at] * np.einsum("ij,ij->i", x[row] - self.centre[f], self.normal[f])
        begin = np.concatenate(([0], np.cumsum(start[cell + 1] - start[cell])[:-1]))
        holds = np.maximum.reduceat(before - self.warp[f], begin) <= self.close[cell]
        before = np.maximum.reduceat(before, begin)
        point, cell, before = point[holds], cell[holds], before[holds]
        order = np.lexsort((cell, before, point))
        order = order[np.concatenate(([True], np.diff(point[order]) > 0))] if len(order) else order
        point, cell, before = point[order], cell[order], before[order]
        better = (before < depth[point]) | ((before == depth[point]) & (cell < found[point]))
        found[point[better]], depth[point[better]] = cell[better], before[better]


class Plane:
    """A plane: normal [3] of length 1, distance from 0 along it (m), and the directions u, v [3] of coordinates in it.

    normal: "x", "y", "z" or a vector; at: a point [3], a distance, or None (through the middle of the mesh of `finder`). Of a plane
    across an axis u and v are the other two axes, in their order; of any other, these two turned into it.
    ValueError for other names and a normal of length 0.
    """

    def __init__(self, normal, at, finder):
        if isinstance(normal, str) and normal not in tuple(AXES):
            raise ValueError(f"normal '{normal}'; allowed are x, y, z and vectors (x, y, z)")
        n = np.eye(3)[AXES.index(normal)] if isinstance(normal, str) else np.array(normal, float)
        if n.shape != (3,) or not np.linalg.norm(n) > 0:
            raise ValueError(f"the normal {normal} of a plane has no direction; three numbers are wanted, not all 0")
        self.normal = n / np.linalg.norm(n)
        k = int(np.abs(self.normal).argmax())
        self.axis = k if np.count_nonzero(self.normal) == 1 else None  # the one that the plane is across
        at = finder.middle if at is None else at
        self.distance = float(at) * (self.normal[k] if self.axis is not None else 1) if np.ndim(at) == 0 else float(np.dot(at, self.normal))
        first, second = (np.eye(3)[a] for a in range(3) if a != k)
        u = first - self.normal * (first @ self.normal)
        self.u = u / np.linalg.norm(u)
        v = second - self.normal * (second @ self.normal) - self.u * (second @ self.u)
        self.v = v / np.linalg.norm(v)

    def flat(self, points):
        """Coordinates [..][2] (m) in the plane of points [..][3]."""
        return np.stack((points @ self.u, points @ self.v), axis=-1)

    def solid(self, u, v):
        """Points [..][3] (m) at coordinates of the plane [..]."""
        return self.distance * self.normal + np.multiply.outer(u, self.u) + np.multiply.outer(v, self.v)


class Slice:
    """A plane as a picture: u [nu + 1], v [nv + 1] are the edges of its pixels (m), in the directions plane.u, plane.v [3];
    points [nv][nu][3] their middles, cells [nv][nu] the cells there, -1 where none is; slice["alpha"] a field that was asked for,
    [nv][nu] or [nv][nu][m], nan where no cell is."""

    def __init__(self, finder, plane, u, v, cells):
        self.finder, self.plane, self.u, self.v, self.cells, self.fields = finder, plane, u, v, cells, {}
        self.points = plane.solid(*np.meshgrid((u[1:] + u[:-1]) / 2, (v[1:] + v[:-1]) / 2))

    def __getitem__(self, name):
        return self.fields[name]

    def add(self, name, values, order=1):
        """Adds the field `name` of values [all cells] or [all cells][m]."""
        found = self.finder.values(values, self.points.reshape(-1, 3), order, self.cells.reshape(-1))
        self.fields[name] = found.reshape(*self.cells.shape, *values.shape[1:])


def cut(finder, plane, pixels):
    """The Slice of a mesh by a plane, without fields: of a lattice across an axis its own cells, else `pixels` along the longer side."""
    if finder.lattice and plane.axis is not None:
        return cut_lattice(finder, plane)
    low, high = finder.box
    u, v = frame(plane, low, high, pixels)
    found = Slice(finder, plane, u, v, np.full((len(v) - 1, len(u) - 1), -1))
    points = found.points.reshape(-1, 3)
    inside = (points >= low) & (points <= high)
    inside[:, finder.empty_axes] = True
    inside = inside.all(axis=1)
    found.cells.reshape(-1)[inside] = finder.cells(points[inside])
    return found


def frame(plane, low, high, pixels):
    """Edges u, v of square pixels, around the part of the plane inside a box; around the box where the plane misses it."""
    corners = np.array([[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
    side = corners @ plane.normal - plane.distance
    ends = [(a, a | 1 << k) for a in range(8) for k in range(3) if not a >> k & 1]
    crossed = [corners[a] + (corners[b] - corners[a]) * side[a] / (side[a] - side[b]) for a, b in ends if side[a] * side[b] < 0]
    touched = [c for c, s in zip(corners, side) if s == 0]
    flat = plane.flat(np.array(crossed + touched if len(crossed + touched) > 2 else corners))
    lowest, length = flat.min(axis=0), np.ptp(flat, axis=0)
    step = length.max() / pixels
    return [x + np.linspace(0, width, max(1, round(width / step)) + 1) for x, width in zip(lowest, length)]


def cut_lattice(finder, plane):
    lattice, axis = finder.lattice, plane.axis
    u, v = (lattice.edges[a] for a in range(3) if a != axis)
    k = 0
    if axis not in finder.empty_axes:
        edges, x = lattice.edges[axis], plane.distance * plane.normal[axis]
        k = lattice.shape[axis] - 1 if x == edges[-1] else int(np.searchsorted(edges, x, "right")) - 1
    if not 0 <= k < lattice.shape[axis]:
        return Slice(finder, plane, u, v, np.full((len(v) - 1, len(u) - 1), -1))
    return Slice(finder, plane, u, v, np.take(lattice._cells.reshape(lattice.shape[::-1]), k, axis=2 - axis))
