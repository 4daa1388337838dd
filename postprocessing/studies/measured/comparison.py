# SPDX-License-Identifier: GPL-3.0-or-later
"""Two results on one mesh, and what both should have been: mean differences, places, positions of shocks.

A state is {"rho", "U", "T", "p": values in the cells}, a geometry one of haff.case.geometry.
"""
import numpy as np
from scipy.interpolate import LinearNDInterpolator

FIELDS = ("rho", "U", "T", "p")


def gap(one, other):
    """In every cell; of vectors the length."""
    return np.abs(one - other) if one.ndim == 1 else np.linalg.norm(one - other, axis=1)


def scale(values):
    """The range of a scalar, the greatest length of a vector."""
    return float(np.ptp(values) if values.ndim == 1 else np.linalg.norm(values, axis=1).max())


def difference(geometry, one, other, scales):
    """{field: mean difference over its scale}."""
    return {name: geometry.mean(gap(one[name], other[name])) / scales[name] for name in FIELDS}


def worst(geometry, one, other, name):
    """Cell and place of the greatest difference."""
    cell = int(np.argmax(gap(one[name], other[name])))
    return cell, geometry.at[cell]


def along(geometry, rho, line):
    """Distances from the start of a line, a quarter of a cell apart, and the density there, linear between cell centres."""
    start, end = (np.array(p, float)[geometry.axes] for p in line)
    length = np.linalg.norm(end - start)
    s = np.linspace(0, length, max(int(4 * length / geometry.h), 8) + 1)
    points = start + np.outer(s / length, end - start)
    if len(geometry.axes) == 1:
        order = np.argsort(geometry.at[:, 0])
        return s, np.interp(points[:, 0], geometry.at[order, 0], rho[order])
    offset = geometry.at - start
    t = np.clip(offset @ (end - start) / length**2, 0, 1)
    near = np.linalg.norm(offset - np.outer(t, end - start), axis=1) < 3 * geometry.h
    return s, LinearNDInterpolator(geometry.at[near], rho[near])(points)


def shock(geometry, rho, line):
    """Distance of the steepest gradient of the density over a cell from the start of the line: the centre of what is above
    half of the greatest gradient there."""
    s, values = along(geometry, rho, line)
    slope = np.abs(values[4:] - values[:-4])
    middle = s[2:-2]
    peak = int(np.nanargmax(slope))
    part = np.where(np.abs(middle - middle[peak]) < 2 * geometry.h, np.nan_to_num(slope), 0)
    part = np.where(part > slope[peak] / 2, part, 0)
    return float(part @ middle / part.sum())
