# SPDX-License-Identifier: GPL-3.0-or-later
"""Boxes of triangles by gmsh, with cyclic sides that match, and exact means over their cells.

    triangles.make(case, 10.0, 40, "build/bin/gmshToCase")      # constant/polyMesh: 40 edges a side, patches left, right, ...
    rho = triangles.means(haff.Mesh(case + "/constant/polyMesh"), lambda x: density(x))
"""
import os
import subprocess

import numpy as np

GEO = """// Triangles in a box of {size!r} x {height!r}, {n} x {rows} edges a side.
Point(1) = {{0, 0, 0}}; Point(2) = {{{size!r}, 0, 0}}; Point(3) = {{{size!r}, {height!r}, 0}}; Point(4) = {{0, {height!r}, 0}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Curve Loop(1) = {{1:4}}; Plane Surface(1) = {{1}};
Transfinite Curve {{1, 3}} = {n} + 1; Transfinite Curve {{2, 4}} = {rows} + 1;
Mesh.Algorithm = 6; Mesh.MeshSizeMax = {size!r}/{n};
Physical Curve("bottom") = {{1}}; Physical Curve("right") = {{2}}; Physical Curve("top") = {{3}}; Physical Curve("left") = {{4}};
Physical Surface("gas") = {{1}};
"""
SIDES = {"x": ("left", "right"), "y": ("bottom", "top")}
# Dunavant's rule of six points, exact to degree 4: (barycentric coordinate of two corners, weight of each of three points)
RULE = (0.44594849091596488632, 0.22338158967801146570), (0.09157621350977074346, 0.10995174365532186764)


def make(case, size, n, gmsh_to_case, cyclic="xy", rows=None, patches=""):
    """The mesh, a square or as many rows of edges high. cyclic: axes whose sides are halves of a cyclic pair; patches: rules
    of others."""
    from studies.made import boxes
    os.makedirs(case, exist_ok=True)
    rules = " ".join(f"{a} {{ type cyclic; neighbourPatch {b}; }}" for axis in cyclic for a, b in (SIDES[axis], SIDES[axis][::-1]))
    boxes.write_dictionary(case, "system", "meshDict", f"patches {{ {rules} {patches} }}\n")
    geo, msh = os.path.join(case, "mesh.geo"), os.path.join(case, "mesh.msh")
    with open(geo, "w") as f:
        f.write(GEO.format(size=size, n=n, rows=rows or n, height=size * (rows or n) / n))
    subprocess.run(["gmsh", "-2", "-v", "2", geo, "-o", msh], check=True, capture_output=True)
    subprocess.run([gmsh_to_case, msh, "-case", case, "-binary"], check=True, capture_output=True)
    os.remove(msh)


def corners(mesh):
    """[cells][3][2] of the triangles of a mesh one prism deep along z."""
    count = np.diff(mesh.face_start)
    low = mesh.points[:, 2].min()
    lids = np.flatnonzero(count == 3)
    points = mesh.points[mesh.face_points[mesh.face_start[lids][:, None] + np.arange(3)]]
    bottom = np.isclose(points[:, :, 2], low).all(axis=1)
    found = np.empty((mesh.cells, 3, 2))
    found[mesh.owner[lids[bottom]]] = points[bottom][:, :, :2]
    return found


def means(mesh, function, parts=2):
    """Of function(x[n][2]), [n] or [n][m], over the cells, each cut into parts^2 triangles."""
    corner, total = corners(mesh), 0
    for i in range(parts):
        for j in range(parts - i):
            for up in ((1,) if i + j == parts - 1 else (1, -1)):
                at = np.array([(i, j), (i + 1, j), (i, j + 1)]) if up > 0 else np.array([(i + 1, j + 1), (i, j + 1), (i + 1, j)])
                cut = np.stack([parts - at.sum(axis=1), at[:, 0], at[:, 1]], axis=1) / parts
                total = total + over_triangles(np.einsum("ab,nbx->nax", cut, corner), function) / parts**2
    return total


def over_triangles(corner, function):
    total = 0
    for b, weight in RULE:
        for k in range(3):
            share = np.full(3, b)
            share[k] = 1 - 2 * b
            total = total + weight * function(np.einsum("b,nbx->nx", share, corner))
    return total
