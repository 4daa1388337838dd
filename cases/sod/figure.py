# SPDX-License-Identifier: GPL-3.0-or-later
"""Sod's tube and its exact solution."""
import numpy as np

import haff
from haff.plot import figures, script
from studies.exact.eos import PerfectGas
from studies.exact.riemann import Riemann

case = haff.Case(script.folder())
x, *computed = case.line(("rho", "U", "p", "T"))
fine = np.linspace(0, 1, 4001)
rho, u, p = Riemann(PerfectGas(1.4), (1, 0, 1), (0.125, 0, 0.1)).sample((fine - 0.5) / float(case.times[-1]))
fig, axes = figures.panels(1, 4, width=9.0, height=2.2)
for ax, name, values, exact in zip(axes[0], (r"$\rho$", "$u$", "$p$", "$T$"), computed, (rho, u, p, p / rho)):
    ax.plot(fine, exact, color="0.3", linewidth=0.7, label="exact")
    ax.plot(x, values, ".", markersize=2, label=f"{len(x)} cells")
    figures.label(ax, "", name)
axes[0][0].legend()
script.save(fig, "sod")
