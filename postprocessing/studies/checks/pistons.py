# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of cases/piston: shocks that run from a piston into cold disks, seen from the piston, which moves at 1."""
import numpy as np

SMOOTH = 5  # cells over which packing is averaged: grains lie in layers


def profile(case, field, time):
    """x of the columns of cells, and a field over them; T is weighted by the mass."""
    x, columns = np.unique(np.round(case.centres[:, 0], 9), return_inverse=True)
    alpha, values = case.field("alpha", time), case.field(field, time)
    weights = np.ones_like(alpha) if field == "alpha" else alpha
    return x, np.bincount(columns, weights * values) / np.maximum(np.bincount(columns, weights), 1e-300)


def front(case, time, level):
    """The last x at which the smoothed packing falls below that level."""
    x, alpha = profile(case, "alpha", time)
    alpha = np.convolve(alpha, np.full(SMOOTH, 1 / SMOOTH), "valid")
    x = x[SMOOTH // 2:-(SMOOTH // 2)]
    last = np.flatnonzero(alpha >= level)[-1]
    return float(np.interp(-level, -alpha[last:last + 2], x[last:last + 2]))


def late(case, time):
    return [t for t in case.times if 0.5 * float(time) <= float(t) <= float(time)]


def speed(case, field, time, level):
    """Of a front, over the second half of the time."""
    times = late(case, time)
    return float(np.polyfit([float(t) for t in times], [front(case, t, level) for t in times], 1)[0])


def thickness(case, field, time, level):
    """Of the agitated layer ahead of the plug: from packing 0.5 to that level, mean over the second half of the time."""
    return float(np.mean([front(case, t, level) - front(case, t, 0.5) for t in late(case, time)]))


def behind(case, field, time, depth):
    """Mean from 5 diameters off the piston to that depth."""
    x, values = profile(case, field, time)
    return float(values[(x > 5) & (x < depth)].mean())


def packed(case, field, time, depth):
    """Mean packing from the piston to that depth."""
    x, alpha = profile(case, "alpha", time)
    return float(alpha[x < depth].mean())


QUANTITIES = {
    "speed of the front of that packing": speed,
    "thickness of the agitated layer to that packing": thickness,
    "mean behind the shock to that depth": behind,
    "packing of the plug to that depth": packed,
}
