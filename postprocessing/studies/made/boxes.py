# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a polyMesh of equal boxes, fields on it and whole cases, without any program of haff: for tests and studies.

    boxes.write_mesh(case, (64, 1, 1), (1.0, 0.1, 0.1), {"x": "cyclic"})
    boxes.box_case(case, (64, 1, 1), (1.0, 0.1, 0.1), rho, u, p, end=0.2, reconstruct="WENO5")

An axis of one cell gets one `empty` patch named after it ("yEmpty"); every other axis two patches ("xLow", "xHigh") of
the type given (patch, wall, cyclic; default patch). Cells run with x fastest. `hole` leaves cells out.
"""
import os

import numpy as np

from haff.case.foam import header, write_dictionary

AXES = "xyz"


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


def write_mesh(case, n, size, types=None, hole=None, hole_patch=None, binary=False):
    """hole: boolean [cells] of the full box, True where there is no cell; its faces belong to the patches of their
    axis, or to one patch named hole_patch. Returns {patch: type}."""
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
            inside = missing & (at[:, axis] != (0 if side == "Low" else n[axis] - 1))
            if hole_patch and inside.any():
                outer.setdefault(hole_patch, []).append((me[inside], points[inside]))
                missing = missing & ~inside
            outer.setdefault(name, []).append((me[missing], points[missing]))
    owner, neighbour, faces = (np.concatenate(v) for v in zip(*inner))
    order = np.lexsort((neighbour, owner))
    owner, neighbour, faces = [owner[order]], neighbour[order], [faces[order]]
    start, patches = len(neighbour), []
    for name, parts in outer.items():
        cells, points = (np.concatenate(v) for v in zip(*parts))
        owner.append(cells)
        faces.append(points)
        kind = "empty" if name.endswith("Empty") else (types or {}).get(name, (types or {}).get(name[0], "patch"))
        kind = "wall" if name == hole_patch else kind
        patches.append((name, kind, len(cells), start))
        start += len(cells)
    write_files(os.path.join(case, "constant", "polyMesh"), n, size, np.concatenate(owner), neighbour,
                np.concatenate(faces), patches, binary)
    return {name: kind for name, kind, _, _ in patches}


def raw(values, kind):
    """A list in binary."""
    values = np.ascontiguousarray(values, kind)
    return b"%d\n(" % len(values) + values.tobytes() + b")\n"


def write_files(folder, n, size, owner, neighbour, faces, patches, binary):
    os.makedirs(folder, exist_ok=True)
    z, y, x = np.meshgrid(*[np.linspace(0, size[a], n[a] + 1) for a in (2, 1, 0)], indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    note = (f"nPoints:{len(points)}  nCells:{owner.max() + 1}  nFaces:{len(owner)}  "
            f"nInternalFaces:{len(neighbour)}")

    def listing(name, kind, rows, lists=()):
        """rows: text of the entries, or None where `lists` holds the binary lists."""
        with open(os.path.join(folder, name), "wb") as f:
            f.write(header(kind, name, note=note if kind == "labelList" else "", binary=rows is None).encode() + b"\n")
            if rows is None:
                f.writelines(lists)
            else:
                f.write((f"{len(rows)}\n(\n" + "\n".join(rows) + "\n)\n").encode())

    if binary:
        listing("points", "vectorField", None, [raw(points, "<f8")])
        listing("faces", "faceCompactList", None, [raw(4 * np.arange(len(faces) + 1), "<i4"), raw(faces.ravel(), "<i4")])
        listing("owner", "labelList", None, [raw(owner, "<i4")])
        listing("neighbour", "labelList", None, [raw(neighbour, "<i4")])
    else:
        listing("points", "vectorField", ["(%.17g %.17g %.17g)" % tuple(p) for p in points])
        listing("faces", "faceList", ["4(%d %d %d %d)" % tuple(p) for p in faces])
        listing("owner", "labelList", [str(c) for c in owner])
        listing("neighbour", "labelList", [str(c) for c in neighbour])
    rows = []
    for name, kind, count, start in patches:
        other = name[0] + ("High" if name.endswith("Low") else "Low")
        more = f" neighbourPatch {other}; matchTolerance 1e-4; transform unknown;" if kind == "cyclic" else ""
        rows.append(f"    {name} {{ type {kind}; nFaces {count}; startFace {start};{more} }}")
    listing("boundary", "polyBoundaryMesh", rows)


DIMENSIONS = {"rho": "[1 -3 0 0 0 0 0]", "alpha": "[0 0 0 0 0 0 0]", "U": "[0 1 -1 0 0 0 0]",
              "T": "[0 2 -2 0 0 0 0]", "p": "[1 -1 -2 0 0 0 0]", "phi": "[0 0 0 0 0 0 0]"}


def write_field(case, name, values, patches='".*" zeroGradient', time="0", binary=False):
    """values: [cells] or [cells][3], 17 digits or binary; patches: lines "NAME TYPE"."""
    vector = np.ndim(values) > 1
    kind = "Vector" if vector else "Scalar"
    if binary:
        entries = raw(values, "<f8")
    else:
        rows = ["(%.17g %.17g %.17g)" % tuple(v) for v in values] if vector else ["%.17g" % v for v in values]
        entries = (f"{len(rows)}\n(\n" + "\n".join(rows) + "\n)\n").encode()
    boundary = "\n".join("    %s { type %s; }" % tuple(line.split(None, 1)) for line in patches.splitlines())
    os.makedirs(os.path.join(case, time), exist_ok=True)
    with open(os.path.join(case, time, name), "wb") as f:
        f.write((header(f"vol{kind}Field", name, time, binary=binary) + f"\ndimensions {DIMENSIONS[name]};\n"
                 f"internalField nonuniform List<{kind.lower()}>\n").encode() + entries
                + f";\nboundaryField\n{{\n{boundary}\n}}\n".encode())


CONTROL = """application granularGas; startFrom latestTime; startTime 0; stopAt endTime; endTime {end!r};
deltaT {step!r}; adjustTimeStep {adjust}; maxCo {courant!r}; writeControl {control}; writeInterval {interval!r}; purgeWrite {purge};
writeFormat {format}; writePrecision {digits}; writeCompression {compression}; timeFormat general; timePrecision 12;
runTimeModifiable no;
"""
PROPERTIES = """grain {{ diameter 0.1; mass 1; restitution {e!r}; }}
equationOfState {eos};
{eos}Coeffs {{ gamma {gamma!r}; }}
cooling {cooling}; transport none;
"""
SCHEMES = "fluxScheme {flux}; reconstruct {reconstruct}; timeScheme {stepper};\n"
STANDARD = {"eos": "GoldshteinShapiro", "gamma": 5 / 3, "e": 1.0, "cooling": "none", "flux": "common", "reconstruct": "PHM",
            "stepper": "SSPRK3", "adjust": "yes", "step": 1e-6, "courant": 0.5, "control": "adjustableRunTime", "interval": None,
            "purge": 0, "format": "binary", "digits": 17, "compression": "off", "types": None, "slip": (), "hole": None,
            "hole_patch": None, "binary": False}


def box_case(case, n, size, rho, u, p, end, **options):
    """A case on a box of n cells from arrays in the cells (u: [cells][3]). options: see STANDARD; types and hole are for
    write_mesh, patches in `slip` are slip walls, all others are zero gradient, cyclic or empty; binary: mesh and fields."""
    o = {**STANDARD, **options}
    patches = write_mesh(case, n, size, o["types"], o["hole"], o["hole_patch"], o["binary"])
    return write_case(case, patches, rho, u, p, end, **options)


def write_case(case, patches, rho, u, p, end, **options):
    """All but the mesh; patches: {name: type}."""
    o = {**STANDARD, **options}
    rules = {"scalar": [], "U": []}
    for name, kind in patches.items():
        kind = kind if kind in ("empty", "cyclic", "symmetryPlane") else "zeroGradient"
        rules["scalar"].append(f"{name} {kind}")
        rules["U"].append(f"{name} {'slip' if name in o['slip'] else kind}")
    for name, values in (("rho", rho), ("p", p), ("U", u)):
        write_field(case, name, values, "\n".join(rules.get(name, rules["scalar"])), binary=o["binary"])
    o["interval"] = o["interval"] or end
    write_dictionary(case, "system", "controlDict", CONTROL.format(end=end, **o))
    write_dictionary(case, "system", "fvSchemes", SCHEMES.format(**o))
    write_dictionary(case, "system", "fvSolution", "")
    write_dictionary(case, "constant", "granularProperties", PROPERTIES.format(**o))
    if "gravity" in o:
        write_dictionary(case, "constant", "g", "dimensions [0 1 -2 0 0 0 0];\nvalue (%r %r %r);\n" % o["gravity"])
    return case
