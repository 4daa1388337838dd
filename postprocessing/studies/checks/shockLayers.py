# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of shockLayer, of gas and grains alike: at a phase of the shaking, means over the cycles from the fourth on."""
import numpy as np

from haff.layers import columns

SETTLED = 4  # cycles
LEAST = 0.02  # packing of what belongs to the layer


def at(case, phase):
    return columns.at(case, [phase], SETTLED)[phase]


def hottest(p):
    """Height and T of the hottest row of the layer: behind a shock on its way up."""
    row = np.argmax(np.where(p["alpha"] > LEAST, p["T"], 0))
    return float(p["y"][row]), float(p["T"][row])


QUANTITIES = {
    "centre of mass at a phase": lambda case, field, time, phase: float(columns.centre(at(case, phase))),
    "height of the hottest row": lambda case, field, time, phase: hottest(at(case, phase))[0],
    "greatest T of the layer": lambda case, field, time, phase: hottest(at(case, phase))[1],
}
