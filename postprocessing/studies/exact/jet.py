# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane jet of a perfect fluid on a plate, with free streamlines. Needs scipy."""
import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq


def angle(ratio):
    """Angle (degrees) between the way of a plane jet of a perfect fluid and the sheets that leave a plate `ratio` times as wide.

    Free streamlines have the speed of the jet. On the plate the speed v rises from 0 to 1, and the potential of a source (the jet) and a sink (the
    sheet) in the plane of the velocity gives the length of the plate (Milne-Thomson, Theoretical Hydrodynamics, the impact of a jet on a lamina):
    ratio = 2/pi int_0^1 (1/v^4 - 1) (1/(v^2 + 1/v^2 + 2 cos 2 angle) - 1/(v + 1/v)^2) dv.
    """
    def width(at):
        return 2 / np.pi * quad(lambda v: (1 / v**4 - 1) * (1 / (v * v + v**-2 + 2 * np.cos(2 * at)) - 1 / (v + 1 / v) ** 2), 0, 1)[0]
    return float(np.degrees(brentq(lambda at: width(at) - ratio, 0.05, 1.5707)))
