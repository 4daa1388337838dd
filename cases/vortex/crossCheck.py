# SPDX-License-Identifier: GPL-3.0-or-later
"""What postprocessing/studies/crossCheck.py needs to know of this case."""
import numpy as np

GRIDS, QUICK, COURANT = (20, 40, 80), (20, 40), 0.05


def exact(case, time):
    """The initial state, carried along with (1, 1); after a multiple of 10 it is back. Values at the centres."""
    x, y, _ = case.centres.T
    x, y = ((c - time) % 10 - 5 for c in (x, y))
    swirl = 5 / (2 * np.pi) * np.exp((1 - x**2 - y**2) / 2)
    T = 1 - swirl**2 / 7
    return {"rho": T**2.5, "U": np.stack([1 - swirl * y, 1 + swirl * x, 0 * x], axis=1), "T": T, "p": T**3.5}
