# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of columns of gas and of grains over a floor that warms them: heatedColumn."""
import numpy as np

from haff.layers import faraday
from studies.exact import disks, garzoDufty

BAND = 10.0  # grain diameters about a height that T is a mean over


def steady(case):
    """The profile of the last time; of grains, the mean over all written times but the first."""
    layer = faraday.Layer(case)
    written = [name for name in case.times if float(name) > 0]
    return layer.profile(written[1:] if grains_of(case) else written[-1])


def grains_of(case):
    return "TComponents" in case.fields(case.times[-1])


def temperature(case, field, time, height):
    """Mean over the mass between height - BAND and height + BAND."""
    p = steady(case)
    near = np.abs(p["y"] - height) < BAND
    return float((p["alpha"] * p["T"])[near].sum() / p["alpha"][near].sum())


def column(path):
    """The steady equations of heatedColumn, by a boundary value problem; gravity is raised in parts so that each solution starts the next."""
    warm = disks.numbers(path, "0.orig/T", r"floor\s+\{ type fixedValue; value uniform (\S+);")[0]
    gas, flow = garzoDufty.Grains(2, disks.Disks.of(path).e), None
    for part in (0, 0.1, 0.3, 0.6, 1):
        flow = disks.Channel(gas, 600, gas.per * 3 / 600, {"T": warm}, {}, (0, -part), guess=flow)
    return flow


QUANTITIES = {
    "T about height": temperature,
    "mean error of the column": lambda case, field, time: float(disks.error(case, column(case.path), field, axis=1)),
    "least T": lambda case, field, time: float(steady(case)["T"].min()),
    "height of the least T": lambda case, field, time: float(steady(case)["y"][steady(case)["T"].argmin()]),
}
