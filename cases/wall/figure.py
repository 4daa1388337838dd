# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume fraction, temperature, pressure and Mach number at the end: Fig. 2 of Serna & Marquina."""
import haff
from haff.plot import figures, script
from studies.exact.eos import of_case

case = haff.Case(script.folder())
time = case.times[-1]
x, alpha, rho, T, p, u = case.line(("alpha", "rho", "T", "p", "U"), time)
mach = abs(u) / of_case(case).c(rho, T)
fig, axes = figures.panels(2, 2)
for panel, name, values in zip(axes.flat, ("alpha", "T", "p", "Ma"), (alpha, T, p, mach)):
    panel.plot(x, values)
    figures.label(panel, "x", name)
    panel.set_xlim(0, 10)
    panel.ticklabel_format(scilimits=(-3, 4), useMathText=True)
axes[0][0].axhline(0.65, linestyle=":", linewidth=0.6, color="0.4")
axes[0][0].set_title(rf"$t$ = {time} s, at the wall $\alpha$ = {alpha[-1]:.6f}", fontsize=9)
script.save(fig, "wall")
