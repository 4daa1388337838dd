# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for flow about a wedge, on the square of 10 cm of cases/wedge."""
import os

import numpy as np

from haff.paths import TOP
from haff.plot import cellmap
from studies.exact.eos import of_case

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


QUANTITIES = {
    "upstream Mach number": upstream_mach,
    "asymmetry": asymmetry,
    "L1 difference to the lattice": reference_error,
}
