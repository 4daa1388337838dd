# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of blastCold, of the gas and of the grains alike: by the fields that both write."""
import numpy as np

LATE = 600.0  # from here on the blast has lost its energy, and keeps its momentum


def shell(case, time):
    """Radius of the moving shell, the mean over the radial momentum, and that momentum in diameters and masses per radian and depth."""
    x, alpha, U = case.centres, case.field("alpha", time), case.field("U", time)
    r = np.hypot(x[:, 0], x[:, 1])
    momentum = alpha * case.volumes / (np.pi / 4) * (U[:, 0] * x[:, 0] + U[:, 1] * x[:, 1]) / r
    depth = case.volumes.sum() / (np.ptp(case.mesh.points[:, 0]) * np.ptp(case.mesh.points[:, 1]))
    return float((momentum * r).sum() / momentum.sum()), float(momentum.sum() / (depth * np.pi / 2))


def course(case):
    """Times, radii and momenta of all written times."""
    return np.array([(float(name), *shell(case, name)) for name in case.later_times()]).T


def exponents(case):
    """d ln radius/d ln t and d ln momentum/d ln t, by least squares from LATE on."""
    t, *values = course(case)
    late = t >= LATE
    return [float(np.polyfit(np.log(t[late]), np.log(v[late]), 1)[0]) for v in values]


QUANTITIES = {
    "radius of the shell": lambda case, field, time: shell(case, time)[0],
    "radial momentum per radian": lambda case, field, time: shell(case, time)[1],
    "exponent of the radius": lambda case, field, time: exponents(case)[0],
    "exponent of the momentum": lambda case, field, time: exponents(case)[1],
}
