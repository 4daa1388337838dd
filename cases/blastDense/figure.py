"""Volume fraction, temperature and acoustic impedance at the end: Fig. 5 of Serna & Marquina."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import numpy as np  # noqa: E402

import haff  # noqa: E402
from haff.plot import figures  # noqa: E402
from haff.runs import expected  # noqa: E402

case = haff.Case(figures.folder())
time = case.times[-1]
x, alpha, rho, T = case.line(("alpha", "rho", "T"), time)
impedance = rho * expected.gas(case).c(rho, T)
middle = x[np.argmax(alpha)]
fig, axes = figures.panels(1, 3, width=9)
for panel, name, values in zip(axes[0], ("alpha", "T", "impedance"), (alpha, T, impedance)):
    panel.plot(x, values)
    figures.label(panel, "x", name)
    panel.set_xlim(max(0, middle - 4), min(10, middle + 3))
axes[0][0].set_title(rf"$e$ = 0.9, $t$ = {time} s, $\nu_\mathrm{{max}}$ = {alpha.max():.4f}", fontsize=9)
figures.save(fig, os.path.join(figures.folder(), "blastDense.png"))
