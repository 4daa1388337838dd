# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a case as flat shapes: the cells of a case in two dimensions, cuts through one in three, lines through any.

    space = Space(case)                  space.axes: the axes along which there is more than one cell; space.low, space.high
    space.flat()                         Section of a case in two dimensions
    space.cut(normal, point)             Section of a case in three dimensions
    space.line(a, b)                     distances from a, and the cells there

A lattice gives sections that are rasters; any other mesh polygons. All that is cut is a convex polyhedron, as every cell here is.
"""
import functools

import numpy as np

from haff.plot.quantity import CannotDraw

FEW = 4  # cells along an axis that is not worth a picture of its own
BIG = 2_000_000  # cells above which a lattice is not asked for its patches


class Section:
    """Shapes in a plane with the coordinates h (to the right) and v (upwards).

    names: of both coordinates; low, high: corners [2] of the box around it
    raster: the cell at each place [nv][nh], -1 where there is none, and edges (h, v); or None, and then
    shapes: corners of polygons, [n][2] each, cells [n]: the cell of each, ends: number of corners of each
    walls, rims: lines [n][2][2]: of walls, and of all other ends of the mesh
    """

    def __init__(self, names, walls, rims, raster=None, edges=None, corners=None, ends=None, cells=None):
        self.names, self.walls, self.rims = names, walls, rims
        self.raster, self.edges, self.corners, self.ends, self.cells = raster, edges, corners, ends, cells
        if raster is not None:
            self.low, self.high = np.array([e[0] for e in edges]), np.array([e[-1] for e in edges])
        else:
            self.low, self.high = corners.min(axis=0), corners.max(axis=0)

    @property
    def shapes(self):
        """Polygons [n][corners][2] in one array where all have as many corners, else a list of them."""
        if (self.ends == self.ends[0]).all():
            return self.corners.reshape(len(self.ends), self.ends[0], 2)
        return np.split(self.corners, np.cumsum(self.ends)[:-1])

    def mirrored(self, name, at):
        """This section and its image beyond the line name = at, as of a body of revolution about its axis."""
        k = self.names.index(name) if name in self.names else None
        if k is None:
            raise CannotDraw(f"-mirror {name}: the picture has the coordinates {' and '.join(self.names)}")
        near = 1e-6 * (self.high - self.low)[k]
        if self.low[k] < at - near:
            raise CannotDraw(f"-mirror {name}={at:g}: the mesh lies on both sides, from {self.low[k]:g} to {self.high[k]:g}")

        def image(places):
            beyond = places.copy()
            beyond[..., k] = 2 * at - beyond[..., k]
            return beyond
        lines = [np.concatenate((lines, image(lines)))[np.tile((np.abs(lines[..., k] - at) > near).any(axis=1), 2)] for lines in (self.walls, self.rims)]
        if self.raster is None:
            return Section(self.names, *lines, corners=np.concatenate((image(self.corners), self.corners)), ends=np.tile(self.ends, 2),
                           cells=np.tile(self.cells, 2))
        edges, rows = list(self.edges), np.moveaxis(self.raster, 1 - k, 0)
        touches = edges[k][0] < at + near
        hole = np.full((0 if touches else 1, *rows.shape[1:]), -1)
        edges[k] = np.concatenate((2 * at - edges[k][:0 if touches else None:-1], edges[k]))
        return Section(self.names, *lines, raster=np.moveaxis(np.concatenate((rows[::-1], hole, rows)), 0, 1 - k), edges=tuple(edges))

    def image(self, values):
        """Values [cells] on the raster, nan where there is no cell."""
        picture = values[self.raster].astype(float)
        picture[self.raster < 0] = np.nan
        return picture

    def triangles(self):
        """(places [n][2], triangles [m][3], of each place the cells around it as (place [k], cell [k])) of the polygons."""
        scale = max(np.ptp(self.corners, axis=0).max(), 1e-300)
        _, first, place = np.unique(np.round(self.corners / scale, 9), axis=0, return_index=True, return_inverse=True)
        place = place.reshape(-1)
        start = np.concatenate(([0], np.cumsum(self.ends)))[:-1]
        found = []
        for k in range(1, self.ends.max() - 1):
            some = start[self.ends > k + 1]
            found.append(np.stack([place[some], place[some + k], place[some + k + 1]], axis=1))
        all_triangles = np.concatenate(found)
        a, b, c = (self.corners[first][all_triangles[:, i]] for i in range(3))
        area = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
        return self.corners[first], all_triangles[area > 1e-14 * scale**2], place, np.repeat(self.cells, self.ends)


def basis(normal):
    """Unit vectors (h, v) of the plane across a normal. Along an axis they are the two others, upwards the one that people draw so."""
    n = np.abs(normal) / np.linalg.norm(normal)
    for axis, (h, v) in enumerate(((2, 1), (0, 2), (0, 1))):
        if n[axis] > 1 - 1e-9:
            return np.eye(3)[h], np.eye(3)[v]
    up = np.array([0, 1.0, 0]) if n[1] < 0.9 else np.array([0, 0, 1.0])
    h = np.cross(up, normal)
    h /= np.linalg.norm(h)
    v = np.cross(normal, h)
    return h, v / np.linalg.norm(v)


class Space:
    def __init__(self, case):
        self.case = case
        self.mesh = case.mesh
        self.lattice = case.lattice()
        if self.lattice:
            self.low = np.array([e[0] for e in self.lattice.edges])
            self.high = np.array([e[-1] for e in self.lattice.edges])
            layers = np.array(self.lattice.shape)
        else:
            points = self.mesh.points
            self.low, self.high = points.min(axis=0), points.max(axis=0)
            layers = np.array([1 if self.one_layer(points[:, k], self.low[k], self.high[k]) else 2 for k in range(3)])
        self.axes = tuple(int(k) for k in np.flatnonzero(layers > 1)) or (0,)
        self.dim = len(self.axes)
        self._sections = {}

    @staticmethod
    def one_layer(x, low, high):
        return bool((np.minimum(x - low, high - x) < 1e-6 * (high - low)).all())

    @property
    def size(self):
        return self.high - self.low

    @property
    def column(self):
        """The axis of a lattice along which alone there are more than a FEW cells; None where there is none such, or more."""
        if not self.lattice:
            return self.axes[0] if self.dim == 1 else None
        long = [k for k in self.axes if self.lattice.shape[k] > FEW]
        return long[0] if len(long) == 1 else self.axes[0] if self.dim == 1 else None

    def along(self, axis):
        """(places [n] along an axis, ascending, and a function that makes the means over the cells of each layer of values [cells])."""
        if self.lattice:
            layer = self.lattice.ijk[:, axis]
            count = np.bincount(layer)
            return self.lattice.middles[axis][:len(count)], lambda values: np.bincount(layer, values) / np.maximum(count, 1)
        x = self.case.centres[:, axis]
        order = np.argsort(x)
        return x[order], lambda values: values[order]

    # ---- patches ----

    @functools.cached_property
    def ends(self):
        """(faces, whether they are walls) of all patches that the gas can reach: not those across an axis without cells."""
        faces, wall = [], []
        for kind, start, count in self.mesh.patches.values():
            if kind != "empty" and count:
                faces.append(np.arange(start, start + count))
                wall.append(np.full(count, kind == "wall"))
        if not faces:
            return np.empty(0, int), np.empty(0, bool)
        return np.concatenate(faces), np.concatenate(wall)

    @property
    def few(self):
        """The mesh is no big lattice, whose faces are not read again after it has been recognised."""
        return not self.lattice or self.mesh.cells <= BIG

    @functools.cached_property
    def end_areas(self):
        """Area vectors [n][3] of the faces of `ends`, out of the gas."""
        first = len(self.mesh.neighbour)
        return self.mesh.face_geometry(first)[1][self.ends[0] - first]

    def corners(self, faces):
        """Points of faces, one behind the other [n][3], and how many each has."""
        start = self.mesh.face_start[faces].astype(np.int64)
        count = self.mesh.face_start[np.asarray(faces) + 1] - start
        first = np.cumsum(count) - count
        at = np.repeat(start - first, count) + np.arange(count.sum())
        return self.mesh.points[self.mesh.face_points[at]], count

    # ---- two dimensions ----

    def flat(self):
        """The Section of a case in two dimensions: its upper layer of faces, or for a lattice its raster."""
        if "flat" not in self._sections:
            self._sections["flat"] = self._flat()
        return self._sections["flat"]

    def _flat(self):
        h, v = self.axes
        away = 3 - h - v
        walls, rims = self.flat_ends(h, v, away)
        names = ("xyz"[h], "xyz"[v])
        if self.lattice:
            raster = np.squeeze(self.lattice.cells(), axis=2 - away)  # [nv][nh], as the axes ascend
            return Section(names, walls, rims, raster=raster, edges=(self.lattice.edges[h], self.lattice.edges[v]))
        faces = self.layer(away)
        corners, count = self.corners(faces)
        return Section(names, walls, rims, corners=corners[:, [h, v]], ends=count, cells=self.mesh.owner[faces])

    def layer(self, away):
        """The faces at the upper end of an axis without cells: one for each cell."""
        mesh = self.mesh
        top = mesh.points[:, away] > self.low[away] + 0.5 * self.size[away]
        outer = np.arange(len(mesh.neighbour), len(mesh.owner))
        start = mesh.face_start
        all_up = np.add.reduceat(top[mesh.face_points[start[outer[0]]:]], start[outer] - start[outer[0]]) == start[outer + 1] - start[outer]
        faces = outer[all_up]
        if len(faces) != mesh.cells:
            raise CannotDraw(f"{self.case.path}: {len(faces)} faces for {mesh.cells} cells across the {'xyz'[away]} axis, which has no cells: "
                             "this is no mesh of one layer")
        return faces

    def flat_ends(self, h, v, away):
        """Lines of walls and of other ends: the edge at the upper end of the axis without cells, of each face."""
        faces, wall = self.ends
        if not len(faces):
            return np.empty((0, 2, 2)), np.empty((0, 2, 2))
        corners, count = self.corners(faces)
        face = np.repeat(np.arange(len(faces)), count)
        up = corners[:, away] > self.low[away] + 0.5 * self.size[away]
        across = np.bincount(face[up], minlength=len(faces)) == 2
        keep = up & across[face]
        lines = corners[keep][:, [h, v]].reshape(-1, 2, 2)
        return lines[wall[across]], lines[~wall[across]]

    # ---- three dimensions ----

    def cut(self, normal, point):
        """The Section of a case in three dimensions by the plane through a point, across a normal."""
        normal = np.asarray(normal, float) / np.linalg.norm(normal)
        key = (tuple(normal), float(normal @ point))
        if key not in self._sections:
            self._sections[key] = self._cut(normal, np.asarray(point, float))
        return self._sections[key]

    def _cut(self, normal, point):
        axis = int(np.argmax(np.abs(normal)))
        h, v = basis(normal)
        along = np.abs(normal[axis]) > 1 - 1e-9
        names = ("xyz"[int(np.argmax(h))], "xyz"[int(np.argmax(v))]) if along else ("h", "v")
        if self.lattice and along:
            return self.lattice_cut(axis, point[axis], names)
        distance = (self.mesh.points - point) @ normal
        if not (distance.min() < 0 < distance.max()):
            raise CannotDraw(f"the plane through {text(point)} across {text(normal)} does not cut the mesh, which lies within "
                             f"{text(self.low)} .. {text(self.high)}")
        distance[distance == 0] = 1e-300  # a point in the plane belongs to its upper side
        a, b, face = self.crossings(distance)
        walls, rims = self.cut_ends(face, a, b, h, v)
        corners, count, cells = self.polygons(face, a, b, h, v)
        return Section(names, walls, rims, corners=corners, ends=count, cells=cells)

    def crossings(self, distance):
        """Faces that a plane cuts, and both ends of the cut [n][3]."""
        mesh = self.mesh
        start, corners = mesh.face_start, mesh.face_points
        above = distance[corners] > 0
        following = np.roll(np.arange(len(corners)), -1)
        following[start[1:] - 1] = start[:-1]
        crossed = np.flatnonzero(above != above[following])
        face = np.searchsorted(start, crossed, "right") - 1
        p, q = corners[crossed], corners[following[crossed]]
        share = distance[p] / (distance[p] - distance[q])
        place = mesh.points[p] + share[:, None] * (mesh.points[q] - mesh.points[p])
        twice = np.flatnonzero(np.bincount(face, minlength=len(start) - 1)[face] == 2)  # a convex face is cut once
        return place[twice[::2]], place[twice[1::2]], face[twice[::2]]

    def polygons(self, face, a, b, h, v):
        """The polygons that a plane makes of cells: the ends of the cuts of their faces, ordered around their middle."""
        mesh = self.mesh
        inner = face < len(mesh.neighbour)
        cell = np.concatenate((mesh.owner[face], mesh.neighbour[face[inner]]))
        ends = np.concatenate((a, b, a[inner], b[inner]))
        ends = np.stack([ends @ h, ends @ v], axis=1)
        n, m = len(face), int(inner.sum())
        cell = np.concatenate((cell[:n], cell[:n], cell[n:], cell[n:]))
        unique, index = np.unique(cell, return_inverse=True)
        count = np.bincount(index)
        middle = np.stack([np.bincount(index, e) / count for e in ends.T], axis=1)
        away = ends - middle[index]
        order = np.lexsort((np.arctan2(away[:, 1], away[:, 0]), index))
        assert len(cell) == 2 * (n + m)
        ends, index = ends[order], index[order]
        size = np.sqrt(np.bincount(index, (away[order]**2).sum(axis=1)) / count)  # each corner is the end of two cuts: one is kept
        repeated = (index[1:] == index[:-1]) & (np.abs(ends[1:] - ends[:-1]).max(axis=1) < 1e-6 * size[index[1:]])
        keep = np.concatenate(([True], ~repeated))
        ends, index = ends[keep], index[keep]
        count = np.bincount(index, minlength=len(unique))
        real = count > 2
        return ends[real[index]], count[real], unique[real]

    def cut_ends(self, face, a, b, h, v):
        faces, wall = self.ends
        kind = np.zeros(len(self.mesh.owner), np.int8)
        kind[faces] = 1 + wall
        lines = np.stack([np.stack([a @ h, a @ v], axis=1), np.stack([b @ h, b @ v], axis=1)], axis=1)
        return lines[kind[face] == 2], lines[kind[face] == 1]

    def lattice_cut(self, axis, where, names):
        edges = self.lattice.edges
        if not edges[axis][0] <= where <= edges[axis][-1]:
            name = "xyz"[axis]
            raise CannotDraw(f"{name} = {where:g} lies outside the mesh, which has {name} from {edges[axis][0]:g} to {edges[axis][-1]:g}")
        layer = min(max(int(np.searchsorted(edges[axis], where, "right")) - 1, 0), len(edges[axis]) - 2)
        raster = self.cell_at[tuple(layer if k == 2 - axis else slice(None) for k in range(3))]  # [slow][fast]
        h, v = ("xyz".index(n) for n in names)
        if h > v:
            raster = raster.T
        walls, rims = raster_ends(raster, edges[h], edges[v])
        if len(self.mesh_walls(axis, where)):
            walls, rims = np.concatenate((walls, self.mesh_walls(axis, where))), rims
        return Section(names, walls, rims, raster=raster, edges=(edges[h], edges[v]))

    @functools.cached_property
    def cell_at(self):
        return self.lattice.cells()

    def mesh_walls(self, axis, where):
        """Lines in which a plane across an axis cuts the walls of a lattice; none of a big one, whose faces are not read again."""
        if not self.few:
            return np.empty((0, 2, 2))
        faces, wall = self.ends
        faces = faces[wall]
        if not len(faces):
            return np.empty((0, 2, 2))
        corners, count = self.corners(faces)
        corners = corners.reshape(len(faces), 4, 3)
        inside = (corners[:, :, axis].min(axis=1) <= where) & (corners[:, :, axis].max(axis=1) > where)
        h, v = (int(np.argmax(e)) for e in basis(np.eye(3)[axis]))
        low, high = corners[inside].min(axis=1), corners[inside].max(axis=1)
        return np.stack([low[:, [h, v]], high[:, [h, v]]], axis=1)

    # ---- lines ----

    def line(self, a, b, samples=2000):
        """Distances from a [n], ascending, and cells [n] along the line from a to b: for each cell it passes the middle of its part."""
        a, b = np.asarray(a, float), np.asarray(b, float)
        length = np.linalg.norm(b - a)
        if not length:
            raise CannotDraw(f"a line needs two different ends, not {text(a)} twice")
        share, cells = self.lattice_line(a, b) if self.lattice else self.mesh_line(a, b)
        if not len(cells):
            raise CannotDraw(f"the line from {text(a)} to {text(b)} does not meet the mesh, which lies within {text(self.low)} .. {text(self.high)}")
        return share * length, cells

    def lattice_line(self, a, b):
        """All lines between cells that the line crosses cut it into parts; each part lies in one cell."""
        cuts = [np.array([0.0, 1.0])]
        for axis, edges in enumerate(self.lattice.edges):
            if b[axis] != a[axis]:
                share = (edges - a[axis]) / (b[axis] - a[axis])
                cuts.append(share[(share > 0) & (share < 1)])
        cut = np.unique(np.concatenate(cuts))
        cut = cut[np.concatenate(([True], np.diff(cut) > 1e-9))]
        share = (cut[1:] + cut[:-1]) / 2
        places = a + share[:, None] * (b - a)
        index = []
        for axis in (2, 1, 0):
            edges = self.lattice.edges[axis]
            i = np.searchsorted(edges, places[:, axis], "right") - 1
            i[(i == len(edges) - 1) & (places[:, axis] <= edges[-1] + 1e-9 * (edges[-1] - edges[0]))] -= 1
            index.append(i)
        inside = np.all([(i >= 0) & (i < n) for i, n in zip(index, self.lattice.shape[::-1])], axis=0)
        cells = np.full(len(share), -1)
        cells[inside] = self.cell_at[tuple(i[inside] for i in index)]
        return share[cells >= 0], cells[cells >= 0]

    def mesh_line(self, a, b):
        """The part of the line within each cell: behind all faces through which it enters, before those through which it leaves."""
        centre, area = self.mesh.face_geometry()
        fall = area @ (b - a)
        room = np.einsum("ij,ij->i", area, centre - a)
        enter, leave = np.zeros(self.mesh.cells), np.ones(self.mesh.cells)
        size = np.abs(area).sum(axis=1)
        scale = np.linalg.norm(b - a)
        sides = ((self.mesh.owner, slice(None), 1), (self.mesh.neighbour, slice(0, len(self.mesh.neighbour)), -1))
        for cell, some, sign in sides:
            f, r = sign * fall[some], sign * room[some]
            flat = np.abs(f) < 1e-9 * size[some] * scale
            np.minimum.at(leave, cell[~flat & (f > 0)], (r / np.where(flat, 1, f))[~flat & (f > 0)])
            np.maximum.at(enter, cell[~flat & (f < 0)], (r / np.where(flat, 1, f))[~flat & (f < 0)])
            leave[cell[flat & (r < -1e-9 * size[some] * scale)]] = -1
        cells = np.flatnonzero(leave > enter + 1e-7)
        share = (enter[cells] + leave[cells]) / 2
        order = np.argsort(share, kind="stable")
        return share[order], cells[order]


def raster_ends(raster, h, v):
    """Lines around the holes of a raster, as walls, and its outline as rims."""
    there = np.pad(raster >= 0, 1)
    lines, outer = [], []
    up = there[1:, 1:-1] != there[:-1, 1:-1]
    for j, i in zip(*np.nonzero(up)):
        (outer if j in (0, len(v) - 1) else lines).append(((h[i], v[j]), (h[i + 1], v[j])))
    side = there[1:-1, 1:] != there[1:-1, :-1]
    for j, i in zip(*np.nonzero(side)):
        (outer if i in (0, len(h) - 1) else lines).append(((h[i], v[j]), (h[i], v[j + 1])))
    return np.array(lines).reshape(-1, 2, 2), np.array(outer).reshape(-1, 2, 2)


def text(point):
    return "(" + " ".join(f"{x:g}" for x in point) + ")"
