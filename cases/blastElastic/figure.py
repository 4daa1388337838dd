# SPDX-License-Identifier: GPL-3.0-or-later
"""The elastic blast and the exact solution: the upper row of Fig. 3 of Serna & Marquina."""
import numpy as np

import haff
from haff.plot import figures, script
from studies.exact.eos import of_case
from studies.exact.riemann import BLAST, Riemann

case = haff.Case(script.folder())
time = case.times[-1]
gas = of_case(case)
x, alpha, T = case.line(("alpha", "T"), time)
fine = np.linspace(0, 10, 8001)
rho, _, p = Riemann(gas, *BLAST).sample((fine - 5) / float(time))
fig, axes = figures.panels(1, 2)
for panel, name, values, exact in zip(axes[0], ("alpha", "T"), (alpha, T), (gas.nu(rho), gas.T(rho, p))):
    panel.plot(fine, exact, color="0.3", linewidth=0.7, label="exact")
    panel.plot(x, values, "o", markersize=2, markerfacecolor="none", markeredgewidth=0.5, label=f"{len(x)} cells")
    figures.label(panel, "x", name)
    panel.set_xlim(4.5, 9)
axes[0][0].legend(loc="upper left")
axes[0][0].set_title(f"$e$ = 1, $t$ = {time} s", fontsize=9)
script.save(fig, "blastElastic")
