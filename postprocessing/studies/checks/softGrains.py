# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of chuteDEM, columnDEM and siloDEM: soft grains with friction, and the gas beside them in the copy gas."""
import os

import numpy as np

import haff
from haff.case import grains
from studies.measured import rheology

DIAMETER = rheology.DIAMETER


def share(case, time, axis, part, within=None):
    """The place along an axis (m) before which a part of the mass lies, of grains by their centres, of a gas by its cells; within(x): of which points."""
    path = os.path.join(case.path, time, "lagrangian")
    if os.path.isdir(path):
        x = grains.places(case, time)
        x = x if within is None else x[within(x)]
        return float(np.quantile(x[:, axis], part))
    x, mass = case.centres, case.field("alpha", time) * case.volumes
    on = (mass > 0.01 * case.volumes) & (True if within is None else within(x))
    at, layer = np.unique(np.round(x[on, axis], 9), return_inverse=True)
    edges = np.append(at - 0.5 * (at[1] - at[0]), at[-1] + 0.5 * (at[1] - at[0]))
    return float(np.interp(part, np.append(0, np.cumsum(np.bincount(layer, mass[on]))) / mass[on].sum(), edges))


def reach(case, _, time):
    return share(case, time, 0, 0.99)


def height(case, _, time):
    return share(case, time, 1, 0.99, lambda x: x[:, 0] < 4 * DIAMETER)


def above(case, time):
    """Number of grains above y = 0."""
    if os.path.isdir(os.path.join(case.path, time, "lagrangian")):
        return np.count_nonzero(grains.places(case, time)[:, 1] > 0)
    on = case.centres[:, 1] > 0
    return float((case.field("alpha", time) * case.volumes)[on].sum() / (np.pi / 6 * DIAMETER**3))


def outflow(case, _, time, span):
    """Grains that sink below y = 0 in a second, over a span of time before."""
    earlier = case.time(float(time) - span)
    return (above(case, earlier) - above(case, time)) / (float(time) - float(earlier))


def velocity(case, _, time, height):
    a = rheology.layers(case, [time])
    return float(np.interp(height, a["y"], a["u"]))


def shear(case, _, time):
    """Difference of the velocities 7.5 and 0.5 mm above the floor."""
    return velocity(case, _, time, 7.5e-3) - velocity(case, _, time, 0.5e-3)


def beside(quantity):
    """By how much a quantity of a gas is more than that of the grains, in the folder around or in the copy named rough for gas, in percent."""
    def percent(case, field, time, *more):
        folder, name = os.path.split(os.path.abspath(case.path))
        other = haff.Case(os.path.join(folder, name.replace("gas", "rough")) if name != "gas" else folder)
        return 100 * (quantity(case, field, time, *more) / quantity(other, field, other.time(min(float(time), float(other.times[-1]))), *more) - 1)
    return percent


PLAIN = {
    "reach of 99 % of the mass": reach,
    "height at the wall": height,
    "grains that leave in a second": outflow,
    "mean velocity along x at height": velocity,
    "velocity at 7.5 mm less that at 0.5 mm": shear,
}
QUANTITIES = {
    **PLAIN,
    **{f"{name}, percent more than the grains": beside(quantity) for name, quantity in PLAIN.items()},
    "inertial number": lambda case, field, time: rheology.bulk(case)[0][0],
    "shear stress over pressure": lambda case, field, time: rheology.bulk(case)[1][0],
    "packing": lambda case, field, time: rheology.bulk(case)[2][0],
}
