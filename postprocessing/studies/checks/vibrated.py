# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of gas and grains over a floor that warms them or shakes them: heatedColumn, leidenfrost, demon."""
import numpy as np

from haff.layers import columns, faraday
from studies.exact import disks, garzoDufty

BAND = 10.0  # grain diameters about a height that T is a mean over


def steady(case):
    """The profile of the last time; of grains, the mean over all written times but the first."""
    layer = faraday.Layer(case)
    written = case.later_times()
    return layer.profile(written[1:] if grains_of(case) else written[-1])


def grains_of(case):
    return "TComponents" in case.fields()


def temperature(case, field, time, height):
    """Mean over the mass between height - BAND and height + BAND."""
    p = steady(case)
    near = np.abs(p["y"] - height) < BAND
    return float((p["alpha"] * p["T"])[near].sum() / p["alpha"][near].sum())


def column(case):
    """The steady equations of heatedColumn with the mass of the run, by a boundary value problem; gravity is raised in parts so that each solution starts
    the next."""
    warm = disks.numbers(case.path, "0.orig/T", r"floor\s+\{ type fixedValue; value uniform (\S+);")[0]
    gas, flow = garzoDufty.Grains(2, disks.Disks.of(case.path).e), None
    packing = case.field("alpha").mean()
    for part in (0, 0.1, 0.3, 0.6, 1):
        flow = disks.Channel(gas, 600, packing, {"T": warm}, {}, (0, -part), 1e-8 if part == 1 else 1e-4, flow)
    return flow


def shaken(case):
    """The profile of a shaken layer: the mean over the written times of the second half."""
    layer = faraday.Layer(case)
    written = case.later_times()
    return layer.profile([name for name in written if float(name) >= 0.5 * float(written[-1])])


def inversion(p):
    """Packing beside the floor, in the lowest two rows, over the greatest."""
    return float(p["alpha"][:2].mean() / p["alpha"].max())


def shares(case):
    """Times that were written, and the part of the mass at x < 0 at each."""
    left, names = case.centres[:, 0] < 0, case.later_times()
    masses = [case.field("alpha", name) * case.volumes for name in names]
    return np.array(names, float), np.array([mass[left].sum() / mass.sum() for mass in masses])


def share_rate(case):
    """d ln |share - 1/2|/dt over the second half of the run: above 0 where the compartments become more unlike."""
    t, share = shares(case)
    late = t >= t[-1] / 2
    return float(np.polyfit(t[late], np.log(np.abs(share[late] - 0.5)), 1)[0])


QUANTITIES = {
    "growth rate of the unlikeness": lambda case, field, time: share_rate(case),
    "share of the mass at x < 0": lambda case, field, time: float(shares(case)[1][-1]),
    "mean T over the mass": lambda case, field, time: float(np.average(case.field("T", time), weights=case.field("alpha", time) * case.volumes)),
    "packing at the floor over the greatest": lambda case, field, time: inversion(shaken(case)),
    "greatest mean packing": lambda case, field, time: float(shaken(case)["alpha"].max()),
    "height of the greatest packing": lambda case, field, time: float(shaken(case)["y"][shaken(case)["alpha"].argmax()]),
    "mean height of the centre of mass": lambda case, field, time: float(columns.centre(shaken(case))),
    "T about height": temperature,
    "mean error of the column": lambda case, field, time: float(disks.error(case, column(case), field, axis=1)),
    "least T": lambda case, field, time: float(steady(case)["T"].min()),
    "height of the least T": lambda case, field, time: float(steady(case)["y"][steady(case)["T"].argmin()]),
}
