# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for heaps and layers of packed grains: fronts, depths, slopes, velocities."""
import os

import numpy as np

from haff.case import entries

PACKED, MOST = 0.5, 0.64  # packing that counts as packed; of a bed


def depths(case, time):
    """(x, depth of the columns of cells there if it were packed to MOST, width of a cell), m."""
    x = np.round(case.centres[:, 0], 9)
    at, column = np.unique(x, return_inverse=True)
    width = at[1] - at[0]
    return at, np.bincount(column, case.field("alpha", time)) * width / MOST, width


def run_out(case, _, time, width):
    """Way of the front beyond the column's own width, over that width. The front is the last column of cells, without a gap, that is a cell deep."""
    x, depth, cell = depths(case, time)
    shallow = np.flatnonzero(depth < cell)
    front = x[shallow[0]] - cell / 2 if len(shallow) else x[-1] + cell / 2
    return float(front / width - 1)


def round_run_out(case, _, time, radius):
    """Way of the front beyond a round column about x = z = 0, of which the case has a quarter, over its radius. The front is the circle whose area
    is that of the columns of cells that are a cell deep."""
    _, column = np.unique(np.round(case.centres[:, [0, 2]], 9), axis=0, return_inverse=True)
    cell = np.diff(np.unique(np.round(case.centres[:, 0], 9)))[0]
    depth = np.bincount(column.ravel(), case.field("alpha", time)) * cell / MOST
    return float(np.sqrt(4 / np.pi * np.count_nonzero(depth >= cell)) * cell / radius - 1)


def depth_at(case, _, time, place):
    x, depth, _ = depths(case, time)
    return float(depth[np.argmin(np.abs(x - place))])


def slope(case, _, time, least, beside=0):
    """Of a straight line through the depths above `least` (m), in degrees, downwards along x, further than `beside` (m) from the sides."""
    x, depth, cell = depths(case, time)
    on = (depth > least) & (np.minimum(x - x[0], x[-1] - x) + cell / 2 > beside)
    return float(-np.degrees(np.arctan(np.polyfit(x[on], depth[on], 1)[0])))


def surface(case, _, time, least):
    """That slope, further than 4 mm from the sides, to the horizontal: with the angle at which gravity leans in the axes of the case."""
    gx, gy, _ = entries.get(os.path.join(case.path, "constant", "g"), "value")
    return float(np.degrees(np.arctan2(gx, -gy))) + slope(case, None, time, least, 4e-3)


def packed_speed(case, _, time):
    U = case.field("U", time)[case.field("alpha", time) > PACKED]
    return float(np.sqrt((U ** 2).sum(axis=1).max()))


def velocity_at(case, _, time, height):
    """Along x, in the cell at that height."""
    return float(case.field("U", time)[np.argmin(np.abs(case.centres[:, 1] - height)), 0])


def content(case, time):
    """Area above y = 0 that the grains there would take at packing MOST (m^2), on a lattice."""
    _, _, width = depths(case, time)
    return float(case.field("alpha", time)[case.centres[:, 1] > 0].sum()) * width ** 2 / MOST


def outflow(case, _, time, span):
    """Of that content, in a second (m^2/s), over a span of time before."""
    earlier = case.time(float(time) - span)
    return (content(case, earlier) - content(case, time)) / (float(time) - float(earlier))


def round_outflow(case, _, time, span):
    """Volume at packing MOST that leaves the half of a body of revolution above y = 0 in a second (m^3/s), over a span of time before; x is the radius."""
    def content(at):
        return 2 * np.pi * float((case.field("alpha", at) * case.centres[:, 0])[case.centres[:, 1] > 0].sum()) * depths(case, at)[2] ** 2 / MOST
    earlier = case.time(float(time) - span)
    return (content(earlier) - content(time)) / (float(time) - float(earlier))


def slope_between(case, _, time, ends):
    """In degrees, of a straight line through the depths between two places x (m), downwards along x."""
    x, depth, _ = depths(case, time)
    on = (x > ends[0]) & (x < ends[1])
    return float(-np.degrees(np.arctan(np.polyfit(x[on], depth[on], 1)[0])))


QUANTITIES = {
    "run-out over the width": run_out,
    "run-out of a round column over its radius": round_run_out,
    "depth at x": depth_at,
    "slope above that depth": slope,
    "slope of the surface to the horizontal": surface,
    "slope from 4 to 18 mm": lambda case, field, time: slope_between(case, field, time, (0.004, 0.018)),
    "outflow over a span": outflow,
    "outflow of a round silo over a span": round_outflow,
    "speed of packed gas": packed_speed,
    "velocity along x at height": velocity_at,
}
