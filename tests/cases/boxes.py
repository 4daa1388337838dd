"""Writes a polyMesh of equal boxes and fields on it, without any program of haff: for tests.

    boxes.write_mesh(case, (64, 1, 1), (1.0, 0.1, 0.1), {"x": "cyclic"})

An axis of one cell gets one `empty` patch named after it ("yEmpty"); every other axis two patches ("xLow", "xHigh") of
the type given (patch, wall, cyclic; default patch). Cells run with x fastest. `hole` leaves cells out.
"""
import os

import numpy as np

AXES = "xyz"


def header(kind, name, location="constant/polyMesh", note=""):
    note = f'    note        "{note}";\n' if note else ""
    return (f"FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {kind};\n{note}"
            f'    location    "{location}";\n    object      {name};\n}}\n')


def centres(n, size):
    """[cells][3], x fastest."""
    line = [(np.arange(k) + 0.5) * s / k for k, s in zip(n, size)]
    z, y, x = np.meshgrid(line[2], line[1], line[0], indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def corner_points(axis, n):
    """Offsets of the four points of a cell's low face normal to axis, right-handed about +axis, in point numbers."""
    step = np.array([1, n[0] + 1, (n[0] + 1) * (n[1] + 1)])
    a, b = step[(axis + 1) % 3], step[(axis + 2) % 3]
    return np.array([0, a, a + b, b]), step[axis]


def write_mesh(case, n, size, types=None, hole=None):
    """hole: boolean [cells] of the full box, True where there is no cell."""
    types = types or {}
    n = np.array(n)
    number = np.full(n[::-1], -1)
    keep = np.ones(n.prod(), bool) if hole is None else ~hole
    number.ravel()[keep] = np.arange(keep.sum())
    k, j, i = np.nonzero(number >= 0)
    at = np.stack([i, j, k], axis=1)
    base = i + (n[0] + 1) * (j + (n[1] + 1) * k)
    inner, outer = [], {}
    for axis in range(3):
        offset, step = corner_points(axis, n)
        pad = [(1, 1) if 2 - a == axis else (0, 0) for a in range(3)]
        wide = np.pad(number, pad, constant_values=-1)
        move = np.eye(3, dtype=int)[axis]
        below = wide[tuple(at[:, a] for a in (2, 1, 0))]
        above = wide[tuple((at + 2 * move)[:, a] for a in (2, 1, 0))]
        me = number[k, j, i]
        has = above >= 0
        inner.append((me[has], above[has], base[has, None] + offset + step))
        for side, missing, points in (("Low", below < 0, (base[:, None] + offset)[:, [0, 3, 2, 1]]),
                                      ("High", above < 0, base[:, None] + offset + step)):
            name = AXES[axis] + ("Empty" if n[axis] == 1 else side)
            outer.setdefault(name, []).append((me[missing], points[missing]))
    owner, neighbour, faces = (np.concatenate(v) for v in zip(*inner))
    order = np.lexsort((neighbour, owner))
    owner, neighbour, faces = [owner[order]], neighbour[order], [faces[order]]
    start, patches = len(neighbour), []
    for name, parts in outer.items():
        cells, points = (np.concatenate(v) for v in zip(*parts))
        owner.append(cells)
        faces.append(points)
        patches.append((name, len(cells), start))
        start += len(cells)
    write_files(os.path.join(case, "constant", "polyMesh"), n, size, np.concatenate(owner), neighbour,
                np.concatenate(faces), patches, types)


def write_files(folder, n, size, owner, neighbour, faces, patches, types):
    os.makedirs(folder, exist_ok=True)
    z, y, x = np.meshgrid(*[np.linspace(0, size[a], n[a] + 1) for a in (2, 1, 0)], indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    note = (f"nPoints:{len(points)}  nCells:{owner.max() + 1}  nFaces:{len(owner)}  "
            f"nInternalFaces:{len(neighbour)}")

    def listing(name, kind, rows):
        with open(os.path.join(folder, name), "w") as f:
            f.write(header(kind, name, note=note if kind == "labelList" else "") + f"\n{len(rows)}\n(\n"
                    + "\n".join(rows) + "\n)\n")

    listing("points", "vectorField", ["(%.17g %.17g %.17g)" % tuple(p) for p in points])
    listing("faces", "faceList", ["4(%d %d %d %d)" % tuple(p) for p in faces])
    listing("owner", "labelList", [str(c) for c in owner])
    listing("neighbour", "labelList", [str(c) for c in neighbour])
    rows = []
    for name, count, start in patches:
        kind = "empty" if name.endswith("Empty") else types.get(name, types.get(name[0], "patch"))
        other = name[0] + ("High" if name.endswith("Low") else "Low")
        more = f" neighbourPatch {other}; matchTolerance 1e-4; transform unknown;" if kind == "cyclic" else ""
        rows.append(f"    {name} {{ type {kind}; nFaces {count}; startFace {start};{more} }}")
    listing("boundary", "polyBoundaryMesh", rows)


DIMENSIONS = {"rho": "[1 -3 0 0 0 0 0]", "alpha": "[0 0 0 0 0 0 0]", "U": "[0 1 -1 0 0 0 0]",
              "T": "[0 2 -2 0 0 0 0]", "p": "[1 -1 -2 0 0 0 0]"}


def write_field(case, name, values, patches='".*" zeroGradient', time="0"):
    """values: [cells] or [cells][3], 17 digits; patches: lines "NAME TYPE"."""
    vector = np.ndim(values) > 1
    kind = "Vector" if vector else "Scalar"
    rows = ["(%.17g %.17g %.17g)" % tuple(v) for v in values] if vector else ["%.17g" % v for v in values]
    boundary = "\n".join("    %s { type %s; }" % tuple(line.split(None, 1)) for line in patches.splitlines())
    os.makedirs(os.path.join(case, time), exist_ok=True)
    with open(os.path.join(case, time, name), "w") as f:
        f.write(header(f"vol{kind}Field", name, time) + f"\ndimensions {DIMENSIONS[name]};\n"
                f"internalField nonuniform List<{kind.lower()}>\n{len(rows)}\n(\n" + "\n".join(rows)
                + f"\n)\n;\nboundaryField\n{{\n{boundary}\n}}\n")
