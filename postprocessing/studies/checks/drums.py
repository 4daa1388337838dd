# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for drums that rotate about the origin, half full of grains."""
import numpy as np

NEAR = 0.6  # of the drum's radius: the surface in the middle, not beside the wall


def angles(case, times):
    """Of the surface in the middle of the drum at some times, in degrees, downwards along x. The mass of grains below a plane through the axis has
    its centre straight below that plane."""
    x, y = case.centres[:, 0], case.centres[:, 1]
    near = np.hypot(x, y) < NEAR * np.hypot(x, y).max()
    weights = [case.field("alpha", time)[near] * case.volumes[near] for time in times]
    return np.array([-np.degrees(np.arctan2((w * x[near]).sum(), -(w * y[near]).sum())) for w in weights])


def mean_angle(case, _, time, span):
    """Over the written times of a span before."""
    end = float(time)
    return float(angles(case, [t for t in case.times if end - span <= float(t) <= end]).mean())


QUANTITIES = {"mean angle of the surface over a span": mean_angle}
