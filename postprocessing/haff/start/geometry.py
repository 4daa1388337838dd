# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a new case: made by gmsh and gmshToCase, and measured: its box, cells and patches."""
import os
import re
import shutil
import subprocess

import numpy as np

from haff import paths
from haff.case.mesh import Mesh


class Patch:
    """A patch of the mesh: type in the polyMesh, faces, area (m^2), mean normal (outwards; of length 1 where the patch is plane), look: the
    mean sizes of the normals' components; low: lowest centre of a face; extruded: is it empty without being told so?"""

    def __init__(self, name, kind, faces, areas, low):
        size = np.sqrt((areas**2).sum(axis=1))
        self.name, self.type, self.faces, self.area = name, kind, faces, float(size.sum())
        self.normal, self.look = areas.sum(axis=0) / self.area, np.abs(areas).sum(axis=0) / self.area
        self.low, self.extruded = low, kind == "empty"

    @property
    def plane(self):
        return bool(np.linalg.norm(self.normal) > 1 - 1e-6)


class Geometry:
    """What a case must know of its mesh: low, high [3] (m); cells; width (m): the median of the cells' widths, least: the 1 % quantile;
    axes: those that are solved; lattice: are the cells equal boxes on a grid?; patches: list of Patch."""

    def __init__(self, case):
        mesh = Mesh(os.path.join(case, "constant", "polyMesh"))
        self.low, self.high, self.cells = mesh.points.min(axis=0), mesh.points.max(axis=0), mesh.cells
        self.patches = []
        for name, (kind, first, faces) in mesh.patches.items():
            centres, areas = mesh.face_geometry(first, first + faces)
            self.patches.append(Patch(name, kind, faces, areas, centres.min(axis=0)))
        self.volumes, self.lattice, self.edges = mesh.cell_geometry()[1], mesh.lattice is not None, mesh.lattice and mesh.lattice.edges
        self.find_axes()

    def find_axes(self):
        """The solved axes, along which no face of an empty patch looks, and the widths of the cells along them. ValueError."""
        self.axes = [k for k in range(3) if not any(p.type == "empty" and p.look[k] > 1e-6 for p in self.patches)]
        if not self.axes:
            raise ValueError("every axis of the mesh ends in empty patches, so that nothing can move")
        thickness = float(np.prod([self.size[k] for k in range(3) if k not in self.axes]))
        widths = (self.volumes / thickness) ** (1 / len(self.axes))
        self.width, self.least = float(np.median(widths)), float(np.quantile(widths, 0.01))

    @property
    def size(self):
        return self.high - self.low

    @property
    def box(self):
        """Do the cells fill a box along the axes?"""
        return bool(abs(self.volumes.sum() / np.prod(self.size) - 1) < 1e-9)

    @property
    def cell_text(self):
        """How wide the cells are: along each axis of a lattice of equal boxes, else in the mean."""
        steps = [np.diff(self.edges[k]) for k in self.axes] if self.lattice else []
        if steps and all(np.ptp(s) < 1e-6 * s.max() for s in steps):
            return " x ".join(f"{s.mean():.3g}" for s in steps)
        return f"{self.width:.3g}, by the root of their size," if len(self.axes) > 1 else f"{self.width:.3g}"

    @property
    def longest(self):
        """m: the greatest extent along a solved axis."""
        return float(max(self.size[k] for k in self.axes))


def called(command, folder, why):
    """Runs a command in a folder. ValueError with what it said on stderr, behind `why`."""
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    except FileNotFoundError:
        name = os.path.basename(command[0])
        raise ValueError(f"{command[0]} is not there: on Debian, apt-get install {name}" + "; else  pip install gmsh" * (name == "gmsh")) from None
    if done.returncode:
        lines = [line for line in (done.stdout + done.stderr).splitlines() if "rror" in line] or done.stderr.splitlines()[-3:]
        raise ValueError(why + "\n  " + "\n  ".join(re.sub(r"^error: ", "", line) for line in lines))
    return done.stdout


def with_merged(geo, folder):
    """Copies a .geo file to FOLDER/mesh.geo, and the files beside it that it merges or includes under their names."""
    with open(geo, "rb") as f:
        text = f.read()
    with open(os.path.join(folder, "mesh.geo"), "wb") as f:
        f.write(text if text.endswith(b"\n") else text + b"\n")  # gmsh passes over a last line without an end
    named = re.findall(r'^\s*(?:Merge|Include|ShapeFromFile)\s*\(?\s*"([^"]+)"', text.decode("utf-8", "replace"), re.M)
    for name in named:
        source, target = os.path.join(os.path.dirname(os.path.abspath(geo)), name), os.path.join(folder, name)
        if os.path.isfile(source) and not os.path.isabs(name) and ".." not in name.split("/"):
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copy(source, target)


CORNERS = {0: [()], 1: [(0,), (1,)], 2: [(0, 0), (1, 0), (1, 1), (0, 1)]}  # of an element, in the order of gmsh
CORNERS[3] = [(*corner, k) for k in (0, 1) for corner in CORNERS[2]]
TYPES = {0: 15, 1: 1, 2: 3, 3: 5}  # of gmsh: point, line, quadrangle, hexahedron


def box_msh(lengths, cells, names=("left", "right", "bottom", "top", "back", "front")):
    """The text of a mesh.msh (format 2.2) of the box that `box` describes, for machines without gmsh."""
    axes = range(len(cells))
    nodes = 1 + np.arange(np.prod([n + 1 for n in cells])).reshape([n + 1 for n in cells])
    places = np.stack(np.meshgrid(*(np.linspace(0, length, n + 1) for length, n in zip(lengths, cells)), indexing="ij"), axis=-1).reshape(-1, len(cells))
    groups = [(name, nodes.take(-(k % 2), axis=k // 2)) for k, name in enumerate(names[:2 * len(cells)])] + [("gas", nodes)]
    elements = []
    for group, (_, block) in enumerate(groups, 1):
        corners = [block[tuple(slice(s, s + n - 1) for s, n in zip(corner, block.shape))].reshape(-1) for corner in CORNERS[block.ndim]]
        elements += [(TYPES[block.ndim], 2, group, group, *element) for element in np.stack(corners, axis=1).tolist()]
    section = lambda name, rows: f"${name}\n{len(rows)}\n" + "".join(f"{row}\n" for row in rows) + f"$End{name}\n"
    at = np.zeros((len(places), 3))
    at[:, list(axes)] = places
    return ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + section("PhysicalNames", [f'{block.ndim} {k} "{name}"' for k, (name, block) in enumerate(groups, 1)])
            + section("Nodes", [f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(at.tolist(), 1)])
            + section("Elements", [f"{k} {' '.join(map(str, e))}" for k, e in enumerate(elements, 1)]))


def make_msh(folder):
    """mesh.geo of a folder becomes its mesh.msh."""
    said = called(["gmsh", "-3", "-v", "3", "mesh.geo", "-o", "mesh.msh"], folder, "gmsh cannot make a mesh of mesh.geo:")
    if not os.path.isfile(os.path.join(folder, "mesh.msh")):
        raise ValueError("gmsh made no mesh of mesh.geo: " + (said.splitlines() or ["is there a geometry in it?"])[-1])


def make_poly_mesh(folder):
    """mesh.msh of a folder becomes its constant/polyMesh, by system/meshDict where there is one."""
    called([paths.program("gmshToCase"), "mesh.msh", "-case", "."], folder, "gmshToCase cannot take the mesh:")


def box(lengths, cells, names=("left", "right", "bottom", "top", "back", "front")):
    """The text of a .geo file of a box with these numbers of cells along its axes: a line, a rectangle, a box. names: of its sides."""
    names = names[:2 * len(lengths)]
    head = [f"// A box of {' x '.join(f'{x:g}' for x in lengths)} in {' x '.join(map(str, cells))} cells."]
    head += [f'DefineConstant[ {key} = {{{value:.12g}, Name "length along {axis}"}} ];' for key, value, axis in zip("LHD", lengths, "xyz")]
    head += [f'DefineConstant[ {key} = {{{value}, Min 1, Step 1, Name "cells along {axis}"}} ];' for key, value, axis in zip("NMK", cells, "xyz")]
    if len(lengths) == 1:
        body = ["Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};", "Line(1) = {1, 2};   Transfinite Curve {1} = N + 1;"]
        groups = [f'Physical Point("{name}") = {{{k + 1}}};' for k, name in enumerate(names)] + ['Physical Curve("gas") = {1};']
        return "\n".join(head + [""] + body + [""] + groups) + "\n"
    body = ["Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};",
            "Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};",
            "Curve Loop(1) = {1:4};   Plane Surface(1) = {1};",
            "Transfinite Curve {1, 3} = N + 1;   Transfinite Curve {2, 4} = M + 1;", "Transfinite Surface {1};   Recombine Surface {1};"]
    sides = dict(zip(names, ("4", "2", "1", "3")))
    what, inside = "Curve", 'Physical Surface("gas") = {1};'
    if len(lengths) == 3:
        body += ["out[] = Extrude {0, 0, D} { Surface{1}; Layers{K}; Recombine; };"]
        sides = dict(zip(names, ("out[5]", "out[3]", "out[2]", "out[4]", "1", "out[0]")))
        what, inside = "Surface", 'Physical Volume("gas") = {out[1]};'
    groups = [f'Physical {what}("{name}") = {{{of}}};' for name, of in sides.items()]
    return "\n".join(head + [""] + body + [""] + groups + [inside]) + "\n"
