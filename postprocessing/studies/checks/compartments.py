# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of demonMD."""
import numpy as np

from haff.case import grains

QUANTITIES = {
    "share of the grains at x < 0": lambda case, field, time: float(np.mean(grains.places(case, case.time(time))[:, 0] < 0)),
}
