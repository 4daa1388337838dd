# SPDX-License-Identifier: GPL-3.0-or-later
"""What postprocessing/studies/crossCheck.py needs to know of this case."""
import numpy as np

from studies.exact.eos import PerfectGas
from studies.exact.riemann import Riemann

GRIDS, QUICK, COURANT = (100, 200, 400), (50, 100), 0.1
LINES = {"shock": ((0.75, 0, 0), (0.95, 0, 0))}


def exact(case, time):
    """Cell averages; T is that of the average rho and p."""
    x = case.centres[:, 0]
    edges = np.linspace(0, 1, len(x) + 1)
    rho, u, p = Riemann(PerfectGas(1.4), (1, 0, 1), (0.125, 0, 0.1)).averages(edges, 0.5, time)[:, np.argsort(np.argsort(x))]
    return {"rho": rho, "U": np.outer(u, (1, 0, 0)), "T": p / rho, "p": p}
