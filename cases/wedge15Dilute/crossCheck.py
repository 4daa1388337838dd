"""What postprocessing/crossCheck needs to know of this case."""
import numpy as np

from eos import PerfectGas
from obliqueShock import ObliqueShock

WEDGE = np.radians(15)
GRIDS, QUICK, COURANT = (20, 40, 80), (10, 20), 0.2
LINES = {f"x = {x}": ((x, x * np.tan(WEDGE) + 0.3, 0), (x, x * np.tan(WEDGE) + 3.3, 0)) for x in (5, 8)}


def exact(case, time):
    """Steady: the stream, and the state behind the oblique shock from the tip, at the cell centres."""
    gas = PerfectGas(5 / 3)
    shock = ObliqueShock(gas, rho=1.0, p=375.0, mach=4.0)
    beta = shock.angle(WEDGE)
    state = shock.behind(beta)
    x, y, _ = case.centres.T
    behind = (x > 0) & (y < x * np.tan(beta))
    choose = lambda there, ahead: np.where(behind, there, ahead)
    direction = state.speed * np.array((np.cos(WEDGE), np.sin(WEDGE), 0))
    return {"rho": choose(state.rho, 1.0), "T": choose(state.T, 375.0), "p": choose(state.p, 375.0),
            "U": np.where(behind[:, None], direction, (100.0, 0, 0))}
