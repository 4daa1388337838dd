# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for cases/inclineSpheres: a layer that flows down a slope, beside the local balance."""
import os

import numpy as np

from haff.case import entries
from studies.exact import extended

DEPTH = 40


def local(path):
    """The local balance of a case: of the grains of the case and the angle of its gravity."""
    gx, gy, _ = entries.get(os.path.join(path, "constant", "g"), "value")
    return extended.Incline(extended.Grains(0.7, 0.5), float(np.degrees(np.arctan2(gx, -gy))))


def column(case, time):
    """y, packing, velocity and inertial number of the cells of one column."""
    x, y = case.centres[:, :2].T
    row = np.flatnonzero(x < x.min() + 1e-6)
    row = row[np.argsort(y[row])]
    alpha, p, u = case.field("alpha", time)[row], case.field("p", time)[row], case.field("U", time)[row, 0]
    return y[row], alpha, u, np.gradient(u, y[row]) / np.sqrt(p)


def middle(which):
    """Mean over the middle half of the depth."""
    def value(case, _, time):
        y, *columns = column(case, time)
        return float(columns[which][np.abs(y / DEPTH - 0.5) < 0.25].mean())
    return value


def surface(case, _, time):
    """Velocity at the height of the layer, over sqrt(g sigma) (depth/sigma)^(3/2)."""
    y, _, u, _ = column(case, time)
    return float(np.interp(DEPTH, y, u) / DEPTH**1.5)


QUANTITIES = {
    "packing in the middle": middle(0),
    "inertial number in the middle": middle(2),
    "velocity at the surface": surface,
}
