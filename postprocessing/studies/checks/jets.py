# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of jetOnPlate, of gas and grains alike."""
import numpy as np

from studies.exact import jet

SHEET = (48.0, 80.0)  # along x: where the sheet that leaves the plate is measured


def sheet(case, time):
    """Mass, angle from the way of the jet (degrees) and speed (of all energy of its motion) of the sheet."""
    x, alpha, U = case.centres[:, 0], case.field("alpha", time), case.field("U", time)
    mass = np.where((x > SHEET[0]) & (x < SHEET[1]), alpha * case.volumes, 0)
    across, along = mass @ U[:, 0], -mass @ U[:, 1]
    return float(mass.sum()), float(np.degrees(np.arctan2(across, along))), float(np.sqrt((mass @ (U**2).sum(axis=1)) / mass.sum()))


QUANTITIES = {
    "angle of the sheet": lambda case, field, time: sheet(case, time)[1],
    "speed of the sheet": lambda case, field, time: sheet(case, time)[2],
    "angle of a perfect fluid": lambda case, field, time: jet.angle(2),
}
