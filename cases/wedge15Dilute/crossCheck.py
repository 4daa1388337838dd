# SPDX-License-Identifier: GPL-3.0-or-later
"""What postprocessing/studies/crossCheck.py needs to know of this case."""
import numpy as np

from haff.plot import cellmap
from studies.exact.eos import PerfectGas
from studies.exact.obliqueShock import ObliqueShock

WEDGE = np.radians(15)
GRIDS, QUICK, COURANT = (20, 40, 80), (10, 20), 0.2
LINES = {f"x = {x}": ((x, x * np.tan(WEDGE) + 0.3, 0), (x, x * np.tan(WEDGE) + 3.3, 0)) for x in (5, 8)}


def exact(case, time):
    """Steady: the stream, and the state behind the oblique shock from the tip; means over 36 points of every triangle."""
    shock = ObliqueShock(PerfectGas(5 / 3), rho=1.0, p=375.0, mach=4.0)
    beta = shock.angle(WEDGE)
    state = shock.behind(beta)
    x, y = np.moveaxis(cellmap.spread(case.mesh, 6), -1, 0)
    share = ((x > 0) & (y < x * np.tan(beta))).mean(axis=1)
    mean = lambda behind, ahead: share * behind + (1 - share) * ahead
    direction = state.speed * np.array((np.cos(WEDGE), np.sin(WEDGE), 0))
    return {"rho": mean(state.rho, 1.0), "T": mean(state.T, 375.0), "p": mean(state.p, 375.0),
            "U": np.outer(share, direction) + np.outer(1 - share, (100.0, 0, 0))}
