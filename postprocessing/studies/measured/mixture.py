# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of granularSegregation on lines along y."""
import numpy as np

import haff
from studies.exact import segregation


def profile(path, time=None):
    """y and phi of a case, ascending; with `wallValues wall;` the first and the last value stand on the walls."""
    case = haff.Case(path)
    y = case.centres[:, 1]
    order = np.argsort(y)
    y, phi = y[order], case.field("phi", time)[order]
    width = y[2] - y[1]
    if abs(2 * (y[1] - y[0]) - 1.5 * width) < 1e-6 * width:  # half cells at the ends
        y[0], y[-1] = y[1] - width, y[-2] + width
    return y, phi


def history(path):
    """Times, y and phi[time][y]."""
    times = haff.Case(path).times
    profiles = [profile(path, t) for t in times]
    return np.array([float(t) for t in times]), profiles[0][0], np.array([p for _, p in profiles])


def front_errors(path, time):
    """Distance of the nodes, and errors against the front of cases/kink in max, L2 and H1."""
    y, phi = profile(path, time)
    h, e = y[1] - y[0], phi - segregation.kink(y, time)
    slope = np.gradient(e, h, edge_order=2)
    trapezium = np.full(len(y), h)
    trapezium[[0, -1]] = h / 2
    l2 = np.sqrt(np.sum(trapezium * e**2))
    return {"h": h, "max": np.max(np.abs(e)), "L2": l2, "H1": np.hypot(l2, np.sqrt(np.sum(trapezium * slope**2)))}
