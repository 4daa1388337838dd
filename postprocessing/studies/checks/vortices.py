# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of cases/vortices: how fast a wave of velocity across itself grows in a gas that cools, and the box in which it neither grows nor decays.

With tau, d tau = sqrt(T/T0) dt, the amplitude A of such a wave over sqrt(T) grows as exp(lambda tau), and T falls as exp(-2 beta tau). So lambda/beta is
the slope of ln(A/sqrt(T)) over -ln(T)/2, whatever the units; by linear theory it is 1 - (Lc/L)^2. The wave heats the gas, so that T falls as
exp(-2 (beta - (beta - lambda) a^2/3) tau) with a^2 the mean square of such waves over T: both velocities across x make that heat uniform.
"""
import glob
import os
import re

import numpy as np

import haff
from haff.case import grains
from studies.exact import garzoDufty


def of_gas(case, time, length):
    """Amplitude of the wave, the square of the velocity that all waves as long as the box have across themselves, and T."""
    x = 2 * np.pi * case.centres[:, 0] / length
    u = case.field("U", time)
    amplitude = np.mean(u[:, 1] * np.sin(x) + u[:, 2] * np.cos(x))
    return amplitude, amplitude**2, case.field("T", time).mean()


def of_grains(case, time, length):
    """The same; their noise has such waves along all three axes, which are no heat."""
    cloud = grains.read(case, time)
    x, u = 2 * np.pi * cloud["x"] / length, cloud["U"]
    amplitude = np.mean(u[:, 1] * np.sin(x[:, 0]) + u[:, 2] * np.cos(x[:, 0]))
    waves = sum(2 * abs(np.mean(u[:, k] * np.exp(1j * x[:, axis]))) ** 2 for axis in range(3) for k in range(3) if k != axis)
    return amplitude, waves, (np.mean(np.sum(u**2, axis=1)) - waves) / 3


def track(paths, measure):
    """-ln(T)/2, A/sqrt(T) and the square of all waves over T at the written times, of the means over some runs of the same box."""
    rows = []
    for path in paths:
        case = haff.Case(path)
        length = float(np.ptp(case.mesh.points[:, 0]))
        rows.append([measure(case, time, length) for time in case.times])
    amplitude, waves, T = np.mean(rows, axis=0).T
    return -0.5 * np.log(T / T[0]), amplitude / np.sqrt(T), waves / T


def growth(paths, measure):
    """lambda/beta, by least squares, without the heat of the waves."""
    s, a, squares = track(paths, measure)
    damped = 1 - np.polyfit(s, np.log(a), 1)[0]  # (beta - lambda)/(beta - (beta - lambda) a^2/3)
    return float(1 - damped / (1 + damped * np.mean(squares) / 3))


def boxes(top, alpha, kind):
    """{side: folders of its runs} at a packing. kind: gas or grains."""
    found = {}
    for path in glob.glob(os.path.join(top, "grains" if kind == "grains" else "", f"a{alpha:g}L*")) + ([top] if kind == "gas" and alpha == 0.1 else []):
        side = 31.0 if path == top else float(re.search(r"L([\d.]+?)(s\d+)?$", path)[1])
        found.setdefault(side, []).append(path)
    return dict(sorted(found.items()))


def critical(top, alpha, kind):
    """The box in which the wave neither grows nor decays: lambda/beta is a straight line in 1/L^2 between the two boxes."""
    found = boxes(top, alpha, kind)
    if len(found) != 2:
        raise ValueError(f"{top}: {len(found)} boxes of packing {alpha:g} have run, of {kind}; two are wanted")
    measure = of_grains if kind == "grains" else of_gas
    (low, high), rates = found, [growth(paths, measure) for paths in found.values()]
    return float(np.interp(0, rates, [low**-2, high**-2]) ** -0.5)


def theory(alpha, e):
    """Linear theory with the coefficients of Garzo & Dufty: 2 pi sqrt(eta/(rho beta))."""
    gas = garzoDufty.Grains(3, e)
    rho = alpha / gas.per
    return 2 * np.pi * np.sqrt(gas.shear(rho, 1.0) / rho / (0.5 * gas.cooling(alpha)))


QUANTITIES = {
    "box at which vortices appear in the gas": lambda case, field, time, alpha: critical(case.path, alpha, "gas"),
    "box at which vortices appear among grains": lambda case, field, time, alpha: critical(case.path, alpha, "grains"),
    "growth of the wave over the rate of cooling": lambda case, field, time: growth([case.path], of_gas),
}
