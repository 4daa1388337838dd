# SPDX-License-Identifier: GPL-3.0-or-later
"""Roots of increasing functions, elementwise over arrays."""
import numpy as np


def root(function, low, high):
    """The root between arrays low and high, to 1e-14 of itself, by the Illinois method (Dowell & Jarratt 1971); every fourth step halves, for
    functions that are far from straight. The function may be infinite at the ends."""
    low, high = np.array(low, float), np.array(high, float)
    below, above, at, before = function(low), function(high), low, 2
    found = np.zeros(low.shape, bool)
    for k in range(200):
        with np.errstate(invalid="ignore", divide="ignore"):
            new = low - below * ((high - low) / (above - below))
        inside = (new > low) & (new < high) & (k % 4 < 3)
        last, at = at, np.where(found, at, np.where(inside, new, (low + high) / 2))
        value = function(at)
        found |= (value == 0) | (abs(at - last) <= 1e-14 * abs(at))
        if found.all():
            break
        less = value < 0
        again = np.where(less == before, 0.5, 1)  # the same end moved twice: the other one counts half
        low, high = np.where(less, at, low), np.where(less, high, at)
        below, above, before = np.where(less, value, again * below), np.where(less, again * above, value), less
    return at
