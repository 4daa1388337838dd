# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for shocks on meshes without order."""
import numpy as np

from studies.exact import obliqueShock
from studies.exact.eos import of_case
from studies.measured import shocks


def shock_angle(case, _, time):
    """Degrees."""
    return float(np.degrees(shocks.straight_shock(case, shocks.upstream(case, of_case(case), time), shocks.WEDGE, time).angle))


def behind_shock(case, field, time):
    """rho, p or mach over the exact value, less 1."""
    return float(getattr(shocks.behind_wedge(case, shocks.upstream(case, of_case(case), time), shocks.WEDGE, time), field))


def wedge_error(case, _, time):
    return shocks.wedge_error(case, shocks.upstream(case, of_case(case), time), shocks.WEDGE, time)


def stand_off(case, _, time):
    return float(shocks.stand_off(case, shocks.upstream(case, of_case(case), time), time))


def nose_pressure(case, _, time):
    """Largest p over that of the stream at rest behind a normal shock."""
    stream = shocks.upstream(case, of_case(case), time)
    behind = stream.behind(np.pi / 2)
    return float(case.field("p", time).max() / obliqueShock.stagnation(of_case(case), behind.rho, behind.T, behind.speed)[1])


QUANTITIES = {
    "shock angle": shock_angle,
    "error behind the shock": behind_shock,
    "L1 error of a wedge": wedge_error,
    "stand-off distance": stand_off,
    "pressure at the nose": nose_pressure,
}
