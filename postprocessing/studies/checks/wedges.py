# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for flow about a wedge, on the square of 10 cm of cases/wedge, as a gas and as grains (cases/wedgeMD)."""
import os

import numpy as np

import haff
from haff.paths import TOP
from haff.plot import cellmap
from studies.exact.eos import of_case

STREAM, TIP = 0.018, 5.0  # packing of the stream; cm: the tip of the step
LAYER, REACH, ALONG = 0.25, 4.0, (2.5, 4.0)  # cm: thickness of a layer off the faces, the farthest one; stretch of the faces from the tip
REFERENCES = os.path.join(TOP, "postprocessing", "references")


def upstream_mach(case, _, time):
    """At the upper left corner."""
    cell = np.argmax(case.centres[:, 1] - case.centres[:, 0])
    c = of_case(case).c(case.field("rho", time)[cell], case.field("T", time)[cell])
    return np.linalg.norm(case.field("U", time)[cell]) / c


def asymmetry(case, field, time):
    """Greatest difference to the mirror image about the line y = 10 - x, relative to the greatest value."""
    x, y = np.round(case.centres[:, :2].T, 9)
    here, there = np.lexsort((y, x)), np.lexsort((np.round(10 - x, 9), np.round(10 - y, 9)))
    value = case.field(field, time)
    mirrored = -value[:, [1, 0]] if value.ndim > 1 else value
    value = value[:, :2] if value.ndim > 1 else value
    return float(np.abs(value[here] - mirrored[there]).max() / np.abs(value).max())


def reference_error(case, field, time):
    """L1 difference of the density to cell averages of the fine lattice runs of cases/wedge (workPrecision), over the
    upstream density."""
    with np.load(os.path.join(REFERENCES, "wedge.npz")) as f:
        known = f["mean"].astype(float)
    n = len(known)
    column, row = np.moveaxis(np.clip((cellmap.spread(case.mesh) / 10 * n).astype(int), 0, n - 1), -1, 0)
    miss = np.abs(case.field("rho", time) - known[row, column].mean(axis=1))
    return float(case.volumes @ miss / case.volumes.sum() / known[-1, 0])


def off_faces(case, field, time):
    """Middle of each layer of LAYER cm off the two faces of the step, and the mean of a field in it, over the stretch ALONG."""
    x, y = case.centres[:, 0] - TIP, case.centres[:, 1] - TIP
    off, along = np.r_[y, -x], np.r_[x, -y]
    inside = (off > 0) & (off < REACH) & (along > ALONG[0]) & (along < ALONG[1])
    k = (off / LAYER).astype(int)[inside]
    weight, values = (np.tile(a, 2)[inside] for a in (case.volumes, case.field(field, time)))
    return (np.arange(k.max() + 1) + 0.5) * LAYER, np.bincount(k, weight * values) / np.bincount(k, weight)


def front(case, _, time):
    """Distance of the shock from the faces (cm): the outermost place where packing passes 1.5 times that of the stream."""
    off, alpha = off_faces(case, "alpha", time)
    level = 1.5 * STREAM
    last = np.flatnonzero(alpha >= level)[-1]
    return float(np.interp(-level, -alpha[last:last + 2], off[last:last + 2]))


def layer(case, _, time):
    """Packing over that of the stream in the second layer off the faces: centres of grains leave half a diameter of the first one free."""
    return float(off_faces(case, "alpha", time)[1][1] / STREAM)


def front_beside(case, field, time):
    """Distance of the shock in this gas, less that in the grains of the folder beside."""
    return front(case, field, time) - front(grains_of(case), field, time)


def layer_beside(case, field, time):
    """Packing of the layer in this gas over that of the grains in the folder beside, less 1."""
    return layer(case, field, time) / layer(grains_of(case), field, time) - 1


def grains_of(case):
    """The grains that a gas of cases/wedgeMD is compared with."""
    name = os.path.basename(os.path.abspath(case.path))
    return haff.Case(os.path.join(case.path, {"viscous": "../grains", "viscousSmall": "../grainsSmall"}.get(name, "grains")))


QUANTITIES = {
    "upstream Mach number": upstream_mach,
    "asymmetry": asymmetry,
    "L1 difference to the lattice": reference_error,
    "front off the faces": front,
    "front off the faces less that of the grains": front_beside,
    "packing of the layer over that of the stream": layer,
    "packing of the layer beside that of the grains": layer_beside,
}
