"""constant/polyMesh: points, faces, cells and patches."""
import os
import re

import numpy as np

from haff.case.foam import FoamFile


class Mesh:
    """constant/polyMesh: points, faces, owner, neighbour, patches {name: (type, first face, faces)}."""

    def __init__(self, folder):
        path = lambda name: os.path.join(folder, name)
        f = FoamFile(path("points"))
        self.points = f.numbers(0, 3, f.scalar)[0].astype(float)
        self.face_start, self.face_points = self.read_faces(path("faces"))
        f = FoamFile(path("owner"))
        self.owner = f.numbers(0, 1, f.label)[0]
        f = FoamFile(path("neighbour"))
        self.neighbour = f.numbers(0, 1, f.label)[0]
        self.cells = int(max(self.owner.max(), self.neighbour.max(initial=-1))) + 1
        self.patches = {}
        text = FoamFile(path("boundary")).body.decode()
        for name, entries in re.findall(r"(\S+)\s*\{(.*?)\}", text, re.S):
            value = dict(re.findall(r"(\w+)\s+([^;]*);", entries))
            self.patches[name] = (value["type"], int(value["startFace"]), int(value["nFaces"]))

    @staticmethod
    def read_faces(path):
        f = FoamFile(path)
        if f.header["class"] == "faceCompactList":
            start, end = f.numbers(0, 1, f.label)
            return start, f.numbers(end, 1, f.label)[0]
        faces = [np.array(t.split(), int) for t in re.findall(rb"\d+\s*\(([\d\s]+)\)", f.body)]
        return np.concatenate(([0], np.cumsum([len(t) for t in faces]))), np.concatenate(faces)

    def face_geometry(self):
        """Centres and area vectors [faces][3]: triangles about the mean of the points."""
        count = np.diff(self.face_start)
        face = np.repeat(np.arange(len(count)), count)
        here = self.points[self.face_points]
        following = np.arange(1, len(face) + 1)
        following[self.face_start[1:] - 1] = self.face_start[:-1]
        there = here[following]
        middle = sums(face, here, len(count)) / count[:, None]
        area = np.cross(here - middle[face], there - middle[face]) / 2
        size = np.linalg.norm(area, axis=1)
        centre = sums(face, size[:, None] * (here + there + middle[face]) / 3, len(count))
        return centre / sums(face, size, len(count))[:, None], sums(face, area, len(count))

    def cell_geometry(self):
        """Centres [cells][3] and volumes [cells]: pyramids about the mean of the face centres."""
        centre, area = self.face_geometry()
        inner = len(self.neighbour)
        cell = np.concatenate((self.owner, self.neighbour))
        centre = np.concatenate((centre, centre[:inner]))
        area = np.concatenate((area, -area[:inner]))
        middle = sums(cell, centre, self.cells) / np.bincount(cell, minlength=self.cells)[:, None]
        pyramid = np.einsum("ij,ij->i", area, centre - middle[cell]) / 3
        volume = sums(cell, pyramid, self.cells)
        moment = sums(cell, pyramid[:, None] * (0.75 * centre + 0.25 * middle[cell]), self.cells)
        return moment / volume[:, None], volume


def sums(index, values, n):
    """Sum of values by index: [n] or [n][3]."""
    if values.ndim == 1:
        return np.bincount(index, values, n)
    return np.stack([np.bincount(index, v, n) for v in values.T], axis=1)
