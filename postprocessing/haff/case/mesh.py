# SPDX-License-Identifier: GPL-3.0-or-later
"""constant/polyMesh: points, faces, cells and patches."""
import functools
import os
import re

import numpy as np

from haff.case import lattice
from haff.case.foam import FoamFile, FormatError, LIST, text_numbers

MOST_EQUAL = 1000000  # entries of a list N{..}
CHUNK = 1 << 16  # faces whose geometry is in memory at once


class Mesh:
    """constant/polyMesh. The files are read on demand, and stay in memory until release().

    points [points][3] in m; face_start [faces + 1], face_points: the points of face f are face_points[face_start[f]:face_start[f + 1]];
    owner [faces], neighbour [inner faces]; cells: their number; patches {name: (type, first face, faces)}.
    """

    def __init__(self, folder):
        self.folder = folder
        self.patches = {}
        text = FoamFile(self._path("boundary")).body.decode(errors="replace")
        for name, entries in re.findall(r"(\S+)\s*\{(.*?)\}", text, re.S):
            value = dict(re.findall(r"(\w+)\s+([^;]*);", entries))
            try:
                self.patches[name] = (value["type"], int(value["startFace"]), int(value["nFaces"]))
            except (KeyError, ValueError):
                raise self.wrong("boundary", f"patch {name} needs a type and the whole numbers nFaces and startFace") from None

    def _path(self, name):
        return os.path.join(self.folder, name)

    def wrong(self, name, why):
        """The error of a file of the mesh."""
        return FormatError(f"{self._path(name)}: {why}; the mesh is damaged: make it again (gmshToCase, or the case's Allrun)")

    def _labels(self, name):
        f = FoamFile(self._path(name))
        found = f.numbers(0, 1, f.label)[0]
        self._many(name, found)
        if len(found) and found.min() < 0:
            raise self.wrong(name, f"entry {int(found.argmin())} is {found.min()}, and cells are counted from 0")
        return found

    def _many(self, name, found):
        """Refuses a long N{..}, for whose entries there need not be memory."""
        if len(found) > MOST_EQUAL and not found.flags.writeable:
            raise self.wrong(name, f"all of {len(found)} entries are the same")

    @functools.cached_property
    def points(self):
        f = FoamFile(self._path("points"))
        found = f.numbers(0, 3, f.scalar)[0]
        self._many("points", found)
        found = found.astype(float, copy=False)
        if not np.isfinite(found).all():
            raise self.wrong("points", f"point {int(np.flatnonzero(~np.isfinite(found).all(axis=1))[0])} is no number")
        return found

    @functools.cached_property
    def owner(self):
        found = self._labels("owner")
        for name, (_, first, count) in self.patches.items():
            if first < 0 or count < 0 or first + count > len(found):
                raise self.wrong("boundary", f"patch {name} has the faces {first} to {first + count - 1}, and the file owner has {len(found)} faces")
        return found

    @functools.cached_property
    def neighbour(self):
        found = self._labels("neighbour")
        if len(found) > len(self.owner):
            raise self.wrong("neighbour", f"{len(found)} faces, and the file owner has {len(self.owner)}")
        return found

    @functools.cached_property
    def cells(self):
        found = int(max(self.owner.max(initial=-1), self.neighbour.max(initial=-1))) + 1
        if found > len(self.owner) + len(self.neighbour):
            raise self.wrong("owner", f"the largest cell of owner and neighbour is {found - 1}, and {len(self.owner)} faces do not enclose that many")
        return found

    @functools.cached_property
    def _faces(self):
        start, points = self.read_faces(self._path("faces"))
        if len(start) != len(self.owner) + 1:
            raise self.wrong("faces", f"{len(start) - 1} faces, and the file owner has {len(self.owner)}")
        if start[0] != 0 or start[-1] != len(points) or (np.diff(start) < 3).any():
            raise self.wrong("faces", "a face has fewer than three points")
        if len(points) and not 0 <= points.min() <= points.max() < len(self.points):
            raise self.wrong("faces", f"there is a point {points.max() if points.min() >= 0 else points.min()}, and the file points has {len(self.points)}")
        return start, points

    @property
    def face_start(self):
        return self._faces[0]

    @property
    def face_points(self):
        return self._faces[1]

    def release(self):
        """Gives back the memory of points, faces, owner and neighbour; they are read again on demand."""
        for name in ("points", "owner", "neighbour", "_faces"):
            self.__dict__.pop(name, None)

    @staticmethod
    def read_faces(path):
        """face_start [faces + 1] and face_points."""
        f = FoamFile(path)
        if f.header.get("class") == "faceCompactList":
            start, end = f.numbers(0, 1, f.label)
            return start, f.numbers(end, 1, f.label)[0]
        head = LIST.match(f.view)
        if not head:
            raise FormatError(f"{path}: no list of faces")
        flat, faces = text_numbers(f.part(head.end(), len(f.view)), np.dtype(np.int64), path), int(head.group(1))
        at = first_words(flat, faces, path)
        keep = np.ones(len(flat), bool)
        keep[at] = False
        return np.concatenate(([0], np.cumsum(flat[at]))), flat[keep]

    @functools.cached_property
    def lattice(self):
        """The lattice.Lattice that the cells are places of, or None."""
        return lattice.recognise(self)

    def face_geometry(self, first=0, last=None):
        """Centres (m) and area vectors (m^2), [faces][3] each, of faces first .. last-1: triangles about the mean of the points."""
        start = self.face_start[first:(len(self.face_start) - 1 if last is None else last) + 1]
        count = np.diff(start)
        corners = self.points[self.face_points[start[0]:start[-1]]]
        if len(count) and (count == count[0]).all():
            return polygons(corners.reshape(len(count), count[0], 3))
        centre, area = np.empty((len(count), 3)), np.empty((len(count), 3))
        for n in np.unique(count):
            some = np.flatnonzero(count == n)
            centre[some], area[some] = polygons(corners[(start[some] - start[0])[:, None] + np.arange(n)])
        return centre, area

    def chunks(self):
        """(first, last) of chunks of faces, those of the inner faces first; no chunk holds both kinds."""
        for low, high in ((0, len(self.neighbour)), (len(self.neighbour), len(self.owner))):
            for first in range(low, high, CHUNK):
                yield first, min(first + CHUNK, high)

    def sides(self, first, last):
        """(cells of faces first .. last-1, +1) of their owners, and (.., -1) of their neighbours, which boundary faces have not."""
        yield self.owner[first:last], 1
        if first < len(self.neighbour):
            yield self.neighbour[first:last], -1

    def cell_geometry(self):
        """Centres [cells][3] (m) and volumes [cells] (m^3): pyramids about the mean of the face centres, chunk by chunk of faces."""
        middle, faces = np.zeros((3, self.cells)), np.zeros(self.cells)
        for first, last in self.chunks():
            centre = self.face_geometry(first, last)[0].T
            for cell, _ in self.sides(first, last):
                add(cell, (faces, None), *zip(middle, centre))
        middle /= faces
        volume, moment = faces, np.zeros((3, self.cells))
        volume[:] = 0
        for first, last in self.chunks():
            centre, area = (a.T for a in self.face_geometry(first, last))
            for cell, sign in self.sides(first, last):
                here = middle[:, cell]
                pyramid = (sign / 3) * np.einsum("xn,xn->n", area, centre - here)
                add(cell, (volume, pyramid), *zip(moment, pyramid * (0.75 * centre + 0.25 * here)))
        moment /= volume
        return moment.T.copy(), volume


def first_words(flat, faces, path):
    """Where the words stand in `n a b .. n a b ..` that say how many follow."""
    width = int(flat[0]) + 1 if len(flat) else 1
    if len(flat) == faces * width and (flat[::width] == width - 1).all():
        return np.arange(0, len(flat), width)
    if faces > len(flat):
        raise FormatError(f"{path}: {len(flat)} numbers for {faces} faces")
    at, found = 0, np.empty(faces, int)
    for i in range(faces):
        if at >= len(flat):
            raise FormatError(f"{path}: {i} faces of {faces}")
        found[i], at = at, at + 1 + int(flat[at])
    if at != len(flat):
        raise FormatError(f"{path}: more numbers than {faces} faces have")
    return found


def polygons(corners):
    """Centres and area vectors [n][3] of polygons of c corners [n][c][3]."""
    x = np.ascontiguousarray(corners.transpose(2, 1, 0))  # [3][c][n]: long rows
    middle = x.mean(axis=1)
    x -= middle[:, None]
    there = np.concatenate((x[:, 1:], x[:, :1]), axis=1)
    area = np.stack([x[i] * there[j] - x[j] * there[i] for i, j in ((1, 2), (2, 0), (0, 1))])
    size = np.sqrt(area[0] ** 2 + area[1] ** 2 + area[2] ** 2)
    there += x
    offset = (size * there).sum(axis=1) / (3 * size.sum(axis=0))
    return (middle + offset).T, area.sum(axis=1).T / 2


def add(cell, *sums):
    """total[cell] += values of each pair (total [cells], values or None for 1); cells may repeat. Only their range is touched."""
    if not len(cell):
        return
    low, high = int(cell.min()), int(cell.max()) + 1
    cell = cell - low
    for total, values in sums:
        total[low:high] += np.bincount(cell, values, high - low)
