# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of fields on meshes without order: every cell is drawn as it is, in the colour of its value."""
import numpy as np


def polygons(mesh, patch):
    """The faces of a patch as lists of points [n][2] (x, y) and the cells behind them."""
    _, start, count = mesh.patches[patch]
    faces = range(start, start + count)
    return [mesh.points[mesh.face_points[mesh.face_start[f]:mesh.face_start[f + 1]], :2] for f in faces], mesh.owner[start:start + count]


def spread(mesh, parts=4):
    """Points [cells][parts^2][2] spread evenly over the triangles of a mesh of one layer, for averages over them."""
    shapes, cells = polygons(mesh, "back")
    corner = np.empty((mesh.cells, 3, 2))
    corner[cells] = np.array(shapes)
    at = [(i + s, j + s) for s, top in ((1 / 3, parts), (2 / 3, parts - 1)) for i in range(top) for j in range(top - i)]
    a, b = (np.array(at) / parts).T[:, None, :, None]
    return corner[:, :1] * (1 - a - b) + corner[:, 1:2] * a + corner[:, 2:] * b


def outlines(mesh, patch):
    """Edges that only one face of a patch has: its outline [n][2][2]."""
    _, start, count = mesh.patches[patch]
    edges = {}
    for f in range(start, start + count):
        p = mesh.face_points[mesh.face_start[f]:mesh.face_start[f + 1]]
        for edge in zip(p, np.roll(p, -1)):
            edges.setdefault(tuple(sorted(edge)), []).append(f)
    return np.array([mesh.points[list(edge), :2] for edge, faces in edges.items() if len(faces) == 1])


def draw(axes, case, values, patch="back", window=None, colours="Blues", span=None, mesh_lines=0.0, unit="cm"):
    """values [cells] on the faces of a patch in the plane of x and y (of a 2D case `back`; of a solid a plane of symmetry);
    returns what a colour bar wants. span: values of the ends of the colours. mesh_lines: width of the cells' edges."""
    from matplotlib.collections import LineCollection, PolyCollection
    shapes, cells = polygons(case.mesh, patch)
    tint = PolyCollection(shapes, array=np.asarray(values)[cells], cmap=colours, linewidths=mesh_lines or 0.2,
                          edgecolors="0.5" if mesh_lines else "face", rasterized=True)
    tint.set_clim(*(span or (np.min(values), np.max(values))))
    axes.add_collection(tint)
    axes.add_collection(LineCollection(outlines(case.mesh, patch), colors="k", linewidths=0.6))
    corners = np.concatenate(shapes)
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes.set(xlim=window[:2] if window else (low[0], high[0]), ylim=window[2:] if window else (low[1], high[1]),
             aspect="equal", xlabel=f"$x$ ({unit})", ylabel=f"$y$ ({unit})")
    return tint
