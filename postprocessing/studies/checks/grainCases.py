# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of demonMD and shearMD."""
import os

import numpy as np

from haff.case import grains
from studies.exact import disks, garzoDufty


def steady_shear(path, settled=0.25):
    """Of a sheared box of disks of mass 1: T, shear stress and shear rate, means over the run after its first quarter."""
    with open(os.path.join(path, "postProcessing", "grains", "0", "grains.dat")) as f:
        lines = f.read().splitlines()
    table = dict(zip(next(line for line in reversed(lines) if line.startswith("# Time"))[2:].split(), np.loadtxt(lines, ndmin=2).T))
    rate, area = 1.0, 40.0**2
    late = table["Time"] >= settled * table["Time"][-1]
    work, t = (table["workFlow"] + table["workImpacts"])[late], table["Time"][late]
    return float(table["T"][late].mean()), float((work[-1] - work[0]) / (t[-1] - t[0]) / area / rate), rate


def balance(gas, nu, rate):
    """T and shear stress at which friction gives what impacts take, by the law of a gas."""
    rho = nu / gas.per
    T = rate**2 * gas.shear(rho, 1) / gas.sink(rho, 1)
    return T, gas.shear(rho, T) * rate


def over_theory(case, index, law=disks.Disks):
    """T (index 0) or shear stress (1) of the grains over that of a gas of Jenkins & Richman, or of Garzo & Dufty."""
    found = steady_shear(case.path)
    return found[index] / balance(law(disks.Disks.of(case.path).e), 0.3, found[2])[index]


def garzo_dufty(e):
    return garzoDufty.Grains(2, e)


QUANTITIES = {
    "share of the grains at x < 0": lambda case, field, time: float(np.mean(grains.places(case, case.time(time))[:, 0] < 0)),
    "T over that of the gas": lambda case, field, time: over_theory(case, 0),
    "shear stress over that of the gas": lambda case, field, time: over_theory(case, 1),
    "T over that of the gas of Garzo & Dufty": lambda case, field, time: over_theory(case, 0, garzo_dufty),
    "shear stress over that of the gas of Garzo & Dufty": lambda case, field, time: over_theory(case, 1, garzo_dufty),
}
