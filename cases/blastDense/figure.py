# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume fraction, temperature and acoustic impedance at the end: Fig. 5 of Serna & Marquina."""
import numpy as np

import haff
from haff.plot import figures, script
from studies.exact.eos import of_case

case = haff.Case(script.folder())
time = case.times[-1]
x, alpha, rho, T = case.line(("alpha", "rho", "T"), time)
impedance = rho * of_case(case).c(rho, T)
middle = x[np.argmax(alpha)]
fig, axes = figures.panels(1, 3, width=9)
for panel, name, values in zip(axes[0], ("alpha", "T", "impedance"), (alpha, T, impedance)):
    panel.plot(x, values)
    figures.label(panel, "x", name)
    panel.set_xlim(max(0, middle - 4), min(10, middle + 3))
axes[0][0].set_title(rf"$e$ = 0.9, $t$ = {time} s, $\alpha_\mathrm{{max}}$ = {alpha.max():.4f}", fontsize=9)
script.save(fig, "blastDense")
