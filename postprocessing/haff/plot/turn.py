# SPDX-License-Identifier: GPL-3.0-or-later
"""A body of revolution in 3D: turns the plane mesh of an axisymmetric case about its axis, as legacy VTK for ParaView.

    haff turn CASE [FIELD ..]          rho alpha U T p, those that are there, at the last time
    haff turn CASE -angle 270 -n 96    with a quarter left open, in 96 sectors
    haff turn CASE -time all           all times, with a series

Writes CASE/VTK/NAME-turned_TIME.vtk. The axis is that of system/meshDict, or that of OpenFOAM's wedges, which must pass through the origin.
Vectors turn with their sector: the swirl stays around the axis. Polygons of more than four sides become prisms of three sides.
Exit code: 2 for a wrong command line, 1 for a case that is no body of revolution.
"""
import json
import os
import sys

import numpy as np

from haff import command
from haff.case import entries
from haff.case.case import Case
from haff.plot import wish

PRISM, BOX = 13, 12  # cell types of VTK
USUAL = ("rho", "alpha", "U", "T", "p")


class Body:
    """The faces of the plane mesh on one side of it, one for each cell, and the axis."""

    def __init__(self, case):
        mesh, self.case = case.mesh, case
        patches = [(kind, first, count) for kind, first, count in mesh.patches.values() if count and kind in ("empty", "wedge")]
        if not patches:
            raise ValueError(f"{case.path} is no body of revolution: no patch of its mesh is of type empty or wedge")
        faces = np.concatenate([np.arange(first, first + count) for _, first, count in patches])
        normals = np.concatenate([mesh.face_geometry(first, first + count)[1] for _, first, count in patches])
        self.origin, self.frame = self.axis(patches[0][0] == "wedge", normals / np.linalg.norm(normals, axis=1)[:, None])
        faces = faces[normals @ self.frame[2] > 0]
        if len(np.unique(mesh.owner[faces])) != mesh.cells or len(faces) != mesh.cells:
            raise ValueError(f"{case.path}: its mesh is not one layer of (axial, radial) cells, so that there is nothing to turn")
        self.cell = mesh.owner[faces]
        self.shapes = [mesh.face_points[mesh.face_start[face]:mesh.face_start[face + 1]] for face in faces]

    def axis(self, wedge, normals):
        """Its origin, and the directions along it, along the radius and around it: [3], [3][3]."""
        sizes = np.abs(normals).mean(axis=0)
        across = int(np.argmax(sizes))
        if wedge:
            along, origin = int(np.argmin(sizes)), np.zeros(3)
        else:
            along, origin = self.given()
            if along == across or sizes[across] < 0.99:
                raise ValueError(f"{self.case.path}: its mesh has no cells along {'xyz'[along]}, the axis, and one other direction alone: there is nothing to turn")
        return origin, np.eye(3)[[along, 3 - along - across, across]]

    def given(self):
        """By system/meshDict: the number of the axis, and a point of it."""
        path = os.path.join(self.case.path, "system", "meshDict")
        try:
            direction = entries.get(path, "axis/direction")
        except (FileNotFoundError, entries.EntryError):
            raise ValueError(f"{self.case.path} is no body of revolution: system/meshDict has no axis, and the mesh no patches of type wedge") from None
        try:
            origin = np.array(entries.get(path, "axis/origin"))
        except entries.EntryError:
            origin = np.zeros(3)
        return int(np.argmax(np.abs(direction))), origin

    def points(self, angles):
        """Of the mesh, at each angle: [angles][points][3]."""
        at = self.case.mesh.points - self.origin
        along, r = at @ self.frame[0], np.hypot(at @ self.frame[1], at @ self.frame[2])
        turned = [np.stack((along, r * np.cos(a), r * np.sin(a)), axis=1) @ self.frame + self.origin for a in angles]
        return np.array(turned)

    def cells(self):
        """(type, corners, cell) of the prisms between two planes, by the points of one: triangles and quadrangles; others as fans."""
        for shape, cell in zip(self.shapes, self.cell):
            if len(shape) in (3, 4):
                yield (PRISM if len(shape) == 3 else BOX), shape, cell
                continue
            for i in range(1, len(shape) - 1):
                yield PRISM, shape[[0, i, i + 1]], cell

    def vector(self, values, angles):
        """A field [cells][3] in each sector: [angles][cells][3]."""
        along, out, around = (values @ direction for direction in self.frame)
        return np.array([np.stack((along, out * np.cos(a) - around * np.sin(a), out * np.sin(a) + around * np.cos(a)), axis=1) @ self.frame for a in angles])


def write(body, path, time, fields, sectors, angle):
    """One legacy file, binary."""
    full = angle == 360
    planes = np.radians(np.linspace(0, angle, sectors + 1))[:sectors + (not full)]
    points, npoints = body.points(planes).reshape(-1, 3), len(body.case.mesh.points)
    kinds, corners, cell = zip(*body.cells())
    rows, types = [], []
    for s in range(sectors):
        low, high = s * npoints, (s + 1) % len(planes) * npoints
        for kind, of in zip(kinds, corners):
            first, second = (low, high) if kind == BOX else (high, low)  # VTK counts the corners of a prism the other way round
            rows.append(np.concatenate(([2 * len(of)], of + first, of + second)))
            types.append(kind)
    cell, middle = np.array(cell), np.radians((np.arange(sectors) + 0.5) * angle / sectors)
    flat = np.concatenate(rows)
    with open(path, "wb") as f:
        f.write(f"# vtk DataFile Version 3.0\nhaff turn, time {time}\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(points)} double\n".encode())
        f.write(points.astype(">f8").tobytes())
        f.write(f"\nCELLS {len(rows)} {len(flat)}\n".encode() + flat.astype(">i4").tobytes())
        f.write(f"\nCELL_TYPES {len(types)}\n".encode() + np.array(types, ">i4").tobytes())
        f.write(f"\nCELL_DATA {len(types)}\n".encode())
        for name in fields:
            values = body.case.field(name, time)
            if values.ndim == 1:
                f.write(f"SCALARS {name} double 1\nLOOKUP_TABLE default\n".encode() + np.tile(values[cell], sectors).astype(">f8").tobytes() + b"\n")
            else:
                f.write(f"VECTORS {name} double\n".encode() + body.vector(values, middle)[:, cell].astype(">f8").tobytes() + b"\n")


def turn(case, fields=(), time="last", sectors=48, angle=360.0):
    """Writes the files; returns their paths, the series first if there are several times."""
    body, folder, name = Body(case), os.path.join(case.path, "VTK"), os.path.basename(os.path.abspath(case.path))
    os.makedirs(folder, exist_ok=True)
    paths, times = [], wish.chosen_times(case, time)
    for at in times:
        there = case.fields(at)
        wanted = list(fields) or [f for f in USUAL if f in there]
        paths.append(os.path.join(folder, f"{name}-turned_{at}.vtk"))
        write(body, paths[-1], at, wanted, sectors, angle)
    if len(times) > 1:
        series = os.path.join(folder, f"{name}-turned.vtk.series")
        with open(series, "w", encoding="utf-8") as f:
            json.dump({"file-series-version": "1.0", "files": [{"name": os.path.basename(p), "time": float(t)} for p, t in zip(paths, times)]}, f)
        paths.insert(0, series)
    return paths


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case")
    parser.add_argument("fields", nargs="*", metavar="FIELD", help="scalars and vectors on cells")
    parser.add_argument("-time", default="last", help="last, all, or names with commas between them")
    parser.add_argument("-n", dest="sectors", type=int, default=48, metavar="N", help="sectors around the axis (48)")
    parser.add_argument("-angle", type=float, default=360.0, help="degrees from the plane of the mesh on (360)")
    wanted = parser.parse_args()
    if not 0 < wanted.angle <= 360:
        parser.error(f"-angle {wanted.angle:g}: more than 0, at most 360 degrees")
    if wanted.sectors < 3:
        parser.error(f"-n {wanted.sectors}: three sectors at least")
    print("\n".join(turn(Case(wanted.case), wanted.fields, wanted.time, wanted.sectors, wanted.angle)))


if __name__ == "__main__":
    sys.exit(main())
