# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of demonMD, shearMD, coolingMixture and brazilNut."""
import glob
import os

import numpy as np

import haff
from haff.case import grains
from studies.exact import disks, garzoDufty, mixtures


def table_of(path):
    """The columns of grains.dat of a run, by their names."""
    with open(os.path.join(path, "postProcessing", "grains", "0", "grains.dat")) as f:
        lines = f.read().splitlines()
    return dict(zip(next(line for line in reversed(lines) if line.startswith("# Time"))[2:].split(), np.loadtxt(lines, ndmin=2).T))


def steady_shear(path, settled=0.25):
    """Of a sheared box of disks of mass 1: T, shear stress and shear rate, means over the run after its first quarter."""
    table = table_of(path)
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


def mixture(e):
    return mixtures.Mixture((2, 1), (8, 1), (0.5, 0.5), np.full((2, 2), e), 0.1)


def members(path):
    return [table_of(p) for p in sorted(glob.glob(os.path.join(path, "ensemble", "seed=*")))]


def temperature_ratio(tables):
    """Times, and m <u^2> of the big disks of coolingMixture over that of the small ones, of the means over members, each with its own T as unit. The momentum of a
    member is 0, which takes m/M from the energy of each grain, M being the mass of all: the ratio is that of many grains."""
    kinds = [sum(t[f"T_{name}"] / t["T"] for t in tables) * m for name, m in (("big", 8), ("small", 1))]
    total = tables[0]["kinetic"][0] / (0.5 * 2 * tables[0]["T"][0])
    return tables[0]["Time"], kinds[0] / kinds[1] * (1 - 1 / total) / (1 - 8 / total)


def steady_ratio(path, settled=0.2):
    """The mean of that ratio over the run after its first fifth, and its standard error by the jackknife over members."""
    tables = members(path)

    def mean(some):
        t, ratio = temperature_ratio(some)
        return ratio[t >= settled * t[-1]].mean()
    without = [mean(tables[:i] + tables[i + 1:]) for i in range(len(tables))]
    return mean(tables), float(np.std(without) * np.sqrt(len(tables) - 1))


def rise(path):
    """Of the members of brazilNut: written times, and [members][times] the mean height of the big disks over that of the small ones."""
    runs = [haff.Case(p) for p in sorted(glob.glob(os.path.join(path, "ensemble", "seed=*")))]
    times = [t for t in runs[0].times if float(t) > 0]
    y = runs[0].centres[:, 1]

    def mean(run, name, t):
        alpha = run.field("alpha." + name, t)
        return np.sum(alpha * y) / alpha.sum()
    return np.array(times, float), np.array([[mean(r, "big", t) - mean(r, "small", t) for t in times] for r in runs])


def risen(path):
    """The mean of that height over the last quarter of the run and all members, and its standard error by the scatter of members."""
    t, height = rise(path)
    late = height[:, t > 0.75 * t[-1]].mean(axis=1)
    return late.mean(), late.std(ddof=1) / np.sqrt(len(late))


QUANTITIES = {
    "height of the big disks over the small ones": lambda case, field, time: float(risen(case.path)[0]),
    "temperature of the big over that of the small, over theory":
        lambda case, field, time: float(steady_ratio(case.path)[0] / mixture(disks.Disks.of(case.path).e).temperatures()),
    "share of the grains at x < 0": lambda case, field, time: float(np.mean(grains.places(case, time)[:, 0] < 0)),
    "T over that of the gas": lambda case, field, time: over_theory(case, 0),
    "shear stress over that of the gas": lambda case, field, time: over_theory(case, 1),
    "T over that of the gas of Garzo & Dufty": lambda case, field, time: over_theory(case, 0, garzo_dufty),
    "shear stress over that of the gas of Garzo & Dufty": lambda case, field, time: over_theory(case, 1, garzo_dufty),
}
