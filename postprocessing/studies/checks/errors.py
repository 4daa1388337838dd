# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for cases with an exact solution: their errors."""
import functools
import os

import numpy as np

from haff.runs import copies
from studies.exact import bunches, disks, extended, garzoDufty, segregation
from studies.exact.eos import of_case
from studies.exact.riemann import BLAST, Riemann
from studies.measured import mixture

CHANNELS = {"couetteDisks": (disks.couette, 1), "heatedWalls": (disks.heated_walls, 0), "poiseuilleDisks": (disks.poiseuille, 1),
            "couetteSpheres": (extended.couette, 1), "pipe": (garzoDufty.pipe, 1)}


@functools.lru_cache(maxsize=1)
def steady(name, path, stamp):
    """The steady flow of a case that is called so. Solving its equations takes seconds. stamp: changes with the files of the case."""
    return CHANNELS[name][0](path)


def channel(case, field):
    """Differences to the steady flow between two walls in all cells at the last time. The folder of the case, or the one above it, has the name
    of a shipped channel."""
    names = os.path.abspath(case.path).split(os.sep)[:-3:-1]
    name = next(name for name in names if name in CHANNELS)
    flow = steady(name, case.path, tuple(sorted(copies.digests(case.path).items())))
    found = case.field(field, case.times[-1])
    return np.abs((found[:, 0] if field == "U" else found) - flow(case.centres[:, CHANNELS[name][1]], "u" if field == "U" else field))


def grains_difference(case, field, _):
    """Root mean square of the differences between the grains of cases/couetteSpheres and the gas at 72 heights; of the decimal logarithms of T,
    which ranges over two decades."""
    y, grains = extended.grains(field)
    at = (np.arange(72) + 0.5) / 72
    row = case.centres[:, 0] < case.centres[:, 0].min() + 1e-6
    found = case.field(field, case.times[-1])[row]
    found = np.interp(at, case.centres[row, 1] / 18, found[:, 0] if field == "U" else found)
    grains = np.interp(at, y, grains)
    difference = np.log10(found / grains) if field == "T" else found - grains
    return float(np.sqrt(np.mean(difference**2)))


def front(norm):
    """Of the travelling front of cases/kink: max, L2 or H1."""
    def value(case, _, time):
        return float(mixture.front_errors(case.path, float(time))[norm])
    return value


def layer(case, time):
    """y, phi and the diffusivity of cases/segregationLinear."""
    y, phi = mixture.profile(case.path, time)
    return y, phi, copies.number(copies.entries.get(os.path.join(case.path, "constant", "segregationProperties"), "diffusivity/value"))


def layer_greatest(case, _, time):
    """At every tenth node, against Gray & Chugunov."""
    y, phi, D = layer(case, time)
    return float(np.abs(phi[::10] - np.array(segregation.gray_chugunov(y[::10], float(time), -1, D, 0.5, 0.55), float)).max())


def layer_mean(case, _, time):
    """Against the shocks that the layer would have without diffusion (Gray & Thornton)."""
    y, phi, _ = layer(case, time)
    return float(np.abs(phi - segregation.gray_thornton_uniform(y, float(time), 0.5, 0.55)).mean())


@functools.lru_cache
def blast(gas):
    """Many cases ask for the same one."""
    return Riemann(gas, *BLAST)


def blast_error(case, field, time):
    """L1 error of the elastic blast against the exact solution at the cell centres, over 50 grains/cm^3."""
    x, rho = case.line(("rho",), time)
    exact = blast(of_case(case)).sample((x - 5) / float(time))[0]
    return float(np.abs(rho - exact).mean() * 10 / 50)


QUANTITIES = {
    "L1 error": blast_error,
    "error of the bunches": lambda case, _, time: bunches.error(case, time),
    "rms difference to the grains": grains_difference,
    "mean error of the channel": lambda case, field, _: float(channel(case, field).mean()),
    "greatest error of the channel": lambda case, field, _: float(channel(case, field).max()),
    "greatest error of the front": front("max"),
    "L2 error of the front": front("L2"),
    "H1 error of the front": front("H1"),
    "greatest error of the layer": layer_greatest,
    "mean difference to the shocks": layer_mean,
}
