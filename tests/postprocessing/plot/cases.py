# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiny cases with fields that are known, for tests of pictures: nothing is run."""
import os

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes, haff

from haff.plot.space import Space

CONTROL = "application granularGas;\nendTime 2;\n"


def control(path):
    os.makedirs(os.path.join(path, "system"), exist_ok=True)
    with open(os.path.join(path, "system", "controlDict"), "w") as f:
        f.write(CONTROL)


def box(path, n, size, types=None, hole=None, hole_patch=None):
    """A case on a lattice without fields; returns the centres [cells][3]."""
    control(path)
    boxes.write_mesh(path, n, size, types, hole=hole, hole_patch=hole_patch, binary=True)
    at = boxes.centres(n, size)
    return at if hole is None else at[~hole]


def meshed(folder, name, cells):
    """A shipped case meshed by gmsh; returns its path and its centres."""
    path = harness.copy(name, folder)
    harness.mesh(path, cells)
    return path, haff.Case(path).centres


def fields(path, time, **values):
    """Fields at a time: alpha, T, p, U or others, [cells] or [cells][3]."""
    for name, v in values.items():
        boxes.write_field(path, name, np.asarray(v), time=time)


def space(path):
    return Space(haff.Case(path))


def cloud(path, time, x, U, d):
    """A cloud of grains as granularMD writes it."""
    folder = os.path.join(path, time, "lagrangian", "grains")
    os.makedirs(folder)
    where = f"{time}/lagrangian/grains"
    with open(os.path.join(folder, "positions"), "wb") as f:
        rows = b"".join(b"(%.17g %.17g %.17g) 0\n" % tuple(p) for p in x)
        f.write(boxes.header("Cloud<passiveParticle>", "positions", where).encode() + b"\n%d\n(\n" % len(x) + rows + b")\n")
    for name, kind, values in (("U", "vectorField", U), ("d", "scalarField", d)):
        with open(os.path.join(folder, name), "wb") as f:
            f.write(boxes.header(kind, name, where, binary=True).encode() + b"\n" + boxes.raw(np.asarray(values), "<f8"))


def files(path):
    """{relative path: (bytes, time of the last change)} of all files of a case."""
    found = {}
    for base, _, names in os.walk(path):
        for name in names:
            full = os.path.join(base, name)
            with open(full, "rb") as f:
                found[os.path.relpath(full, path)] = (f.read(), os.stat(full).st_mtime_ns)
    return found
