# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of cases/wedgeDisks: packing over the polar angle about the tip of the wedge, of gas and of grains."""
import os

import numpy as np

import haff

WEDGE, RADII, WIDTH = 15.0, (40, 140), 2.0  # degrees; diameters from the tip; degrees of a sector


def sectors(case, field, time):
    """Middle of each sector above the wedge (degrees), and the mean of a field in it; T and velocities by the mass."""
    x, y = case.centres[:, 0], case.centres[:, 1]
    r, angle = np.hypot(x, y), np.degrees(np.arctan2(y, x))
    inside = (r > RADII[0]) & (r < RADII[1]) & (x > 0)
    k = ((angle - WEDGE) / WIDTH).astype(int)[inside]
    weight = (case.volumes * (1 if field == "alpha" else case.field("alpha", time)))[inside]
    values = case.field(field, time)[inside]
    means = np.bincount(k, weight * values) / np.bincount(k, weight)
    return (WEDGE + WIDTH * (np.arange(len(means)) + 0.5))[:22], means[:22]


def angle(case, field, time, level):
    """Of the shock, from the stream: where packing passes that level."""
    middle, alpha = sectors(case, "alpha", time)
    last = np.flatnonzero(alpha >= level)[-1]
    return float(np.interp(-level, -alpha[last:last + 2], middle[last:last + 2]))


def behind(case, field, time, most):
    """Mean over the sectors from one off the wedge to that angle."""
    middle, values = sectors(case, field, time)
    return float(values[(middle > WEDGE + WIDTH) & (middle < most)].mean())


def apart(case, _, time):
    """Mean difference of the packing in sectors to that of the grains in the folder beside, over the packing of the stream."""
    name = {"elastic": "../grainsElastic"}.get(os.path.basename(os.path.abspath(case.path)), "grains")
    grains = haff.Case(os.path.join(case.path, name))
    return float(np.abs(sectors(case, "alpha", time)[1] - sectors(grains, "alpha", time)[1]).mean() / 0.1)


QUANTITIES = {
    "angle of the shock at that packing": angle,
    "mean behind the shock to that angle": behind,
    "packing beside that of the grains, mean difference": apart,
}
