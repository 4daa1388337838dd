# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of jetOnPlate, of gas and grains alike, and the jet of a perfect fluid."""
import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

SHEET = (48.0, 80.0)  # along x: where the sheet that leaves the plate is measured


def perfect(ratio):
    """Angle (degrees) between the way of a plane jet of a perfect fluid and the sheets that leave a plate `ratio` times as wide.

    Free streamlines have the speed of the jet. On the plate the speed v rises from 0 to 1, and the potential of a source (the jet) and a sink (the
    sheet) in the plane of the velocity gives the length of the plate (Milne-Thomson, Theoretical Hydrodynamics, the impact of a jet on a lamina):
    ratio = 2/pi int_0^1 (1/v^4 - 1) (1/(v^2 + 1/v^2 + 2 cos 2 angle) - 1/(v + 1/v)^2) dv.
    """
    def width(angle):
        return 2 / np.pi * quad(lambda v: (1 / v**4 - 1) * (1 / (v * v + v**-2 + 2 * np.cos(2 * angle)) - 1 / (v + 1 / v) ** 2), 0, 1)[0]
    return float(np.degrees(brentq(lambda angle: width(angle) - ratio, 0.05, 1.5707)))


def sheet(case, time):
    """Mass, angle from the way of the jet (degrees) and speed (of all energy of its motion) of the sheet."""
    x, alpha, U = case.centres[:, 0], case.field("alpha", time), case.field("U", time)
    mass = np.where((x > SHEET[0]) & (x < SHEET[1]), alpha * case.volumes, 0)
    across, along = mass @ U[:, 0], -mass @ U[:, 1]
    return float(mass.sum()), float(np.degrees(np.arctan2(across, along))), float(np.sqrt((mass @ (U**2).sum(axis=1)) / mass.sum()))


QUANTITIES = {
    "angle of the sheet": lambda case, field, time: sheet(case, time)[1],
    "speed of the sheet": lambda case, field, time: sheet(case, time)[2],
    "angle of a perfect fluid": lambda case, field, time: perfect(2),
}
