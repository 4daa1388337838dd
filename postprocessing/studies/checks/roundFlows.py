# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for bodies of revolution: blasts beside radial flow, cones beside conical flow, the Mach disk of a jet."""
import functools

import numpy as np

from studies.exact import radial
from studies.exact.cone import Cone
from studies.exact.eos import of_case
from studies.measured import shocks

HALF = np.radians(20)  # angle of cases/cone
FINE, MARGIN = 2000, np.radians(3)


def start(r):
    """Of cases/blastRound: Toro's spherical explosion, with an edge of 0.02."""
    inside = np.clip((0.41 - r) / 0.02, 0, 1)
    return 0.125 + 0.875 * inside, 0 * r, 0.1 + 0.9 * inside


@functools.lru_cache(maxsize=4)
def blast(cells, geometry, end, gamma):
    """r, rho, u, p of the radial scheme."""
    return radial.solve(cells, end, start, geometry, gamma)


def distances(case, geometry):
    """From the middle, or from the axis."""
    return np.hypot(*case.centres.T[:2]) if geometry == 2 else case.centres[:, 1]


def blast_error(geometry):
    """L1 error of rho by volume, beside the radial scheme on 2000 cells; of a sphere out to r = 1."""
    def value(case, _, time):
        r, rho, *_ = blast(FINE, geometry, float(time), of_case(case).gamma)
        away = distances(case, geometry)
        weight = case.centres[:, 1] * (away < 1)
        return float(weight @ np.abs(case.field("rho", time) - np.interp(away, r, rho)) / weight.sum())
    return value


def over_line(geometry):
    """That error over the one of the radial scheme on as many cells along the radius."""
    def value(case, _, time):
        gamma = of_case(case).gamma
        r, rho, *_ = blast(FINE, geometry, float(time), gamma)
        at, coarse, *_ = blast(round(len(case.centres) ** 0.5), geometry, float(time), gamma)
        weight = at**geometry
        return blast_error(geometry)(case, _, time) / float(weight @ np.abs(coarse - np.interp(at, r, rho)) / weight.sum())
    return value


def conical(case, time):
    stream = shocks.upstream(case, of_case(case), time)
    return Cone(stream.rho, stream.p, stream.mach, HALF, stream.eos.gamma)


def cone_angle(case, _, time):
    """Degrees, of the straight line through the shock."""
    return float(np.degrees(shocks.straight_shock(case, conical(case, time).shock, HALF, time).angle))


def cone_error(case, field, time):
    """Mean of rho or p over the exact value, less 1, between cone and shock, 3 degrees off both, for 4 < x < 9."""
    flow = conical(case, time)
    angle = np.arctan2(*case.centres.T[1::-1])
    here = (case.centres[:, 0] > 4) & (case.centres[:, 0] < 9) & (angle > HALF + MARGIN) & (angle < flow.angle - MARGIN)
    return float(np.mean(case.field(field, time)[here] / getattr(flow.sample(angle[here]), field)) - 1)


def axis_of_jet(case, time):
    """x, p and Mach number of the cells on the axis of cases/jet (gamma 1.4), by x."""
    r = case.centres[:, 1]
    row = np.flatnonzero(r < 1.5 * r.min())
    row = row[np.argsort(case.centres[row, 0])]
    p = case.field("p", time)[row]
    return case.centres[row, 0], p, case.field("U", time)[row, 0] / np.sqrt(1.4 * p / case.field("rho", time)[row])


def disk(x, p):
    """Where p rises most from cell to cell along the axis, behind the first tenth."""
    rise = np.where(x[:-1] > 0.1 * x[-1], np.diff(p), 0)
    at = int(np.argmax(rise))
    return float((x[at] + x[at + 1]) / 2)


def mach_disk(case, _, time):
    """m."""
    return disk(*axis_of_jet(case, time)[:2])


def greatest_mach(case, _, time):
    return float(axis_of_jet(case, time)[2].max())


QUANTITIES = {
    "place of the Mach disk": mach_disk,
    "greatest Mach number": greatest_mach,
    "L1 error of a ball": blast_error(2),
    "L1 error of a cylinder": blast_error(1),
    "ball over line": over_line(2),
    "cylinder over line": over_line(1),
    "shock angle of a cone": cone_angle,
    "error between cone and shock": cone_error,
}
