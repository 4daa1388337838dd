# SPDX-License-Identifier: GPL-3.0-or-later
"""p/(n T) of disks and spheres beside contact values and fits to other simulations (sweep.py)."""
import numpy as np

from haff.plot import figures, script
from haff.start import enskog

# For spheres below freezing Torquato's is Carnahan and Starling's.
# Name, contact value, line, and where its name stands: the part of the curve it points at, alpha, percent.
FORMS = {2: (("Torquato", enskog.torquato, "--", 0.93, 0.38, 2.1), ("Henderson", enskog.carnahan_starling, ":", 0.9, 0.36, 1.55),
             ("Luding", enskog.luding, "-.", 0.86, 0.5, -0.7)),
         3: (("Carnahan-Starling", enskog.carnahan_starling, "--", 0.8, 0.12, -0.75),)}
fig, ((pressure, elastic, inelastic),) = figures.panels(1, 3, width=9.0, height=3.3)
table = np.loadtxt(script.folder("sweep", "elastic.csv"), delimiter=",", ndmin=2)
rows = np.loadtxt(script.folder("sweep", "inelastic.csv"), delimiter=",", ndmin=2)
names = {2: "disks", 3: "spheres"}

elastic.axhspan(-0.5, 0.5, color="0.93")
for panel in (elastic, inelastic):
    panel.axhline(0, color="0.3", linewidth=0.7)
for k, d in enumerate((2, 3)):
    colour = figures.COLOURS[k]
    _, phi, z, error = table[table[:, 0] == d].T
    fine = np.linspace(0.005, phi[-1], 200)
    fit, fitted = (enskog.pressure_factor(x, 1, d, enskog.simulated) for x in (fine, phi))
    pressure.semilogy(fine, fit, color=colour, linewidth=0.9)
    pressure.semilogy(phi, z, "os"[k], markersize=4, color=colour, label=names[d])
    elastic.errorbar(phi, 100 * (z / fitted - 1), 100 * error / fitted, fmt="os"[k], markersize=4, color=colour)
    for name, chi, style, *away in FORMS[d]:
        curve = 100 * (enskog.pressure_factor(fine, 1, d, chi) / fit - 1)
        elastic.plot(fine, curve, style, color=colour, linewidth=0.9)
        at = int(away[0] * (len(fine) - 1))
        elastic.annotate(name, (fine[at], curve[at]), away[1:], color=colour, fontsize=7.5, arrowprops={"arrowstyle": "-", "color": colour,
                                                                                                          "linewidth": 0.5})
    for e, fill in ((0.9, "full"), (0.7, "none")):
        _, phi, _, z, error = rows[(rows[:, 0] == d) & (rows[:, 2] == e)].T
        theory = enskog.pressure_factor(phi, e, d, enskog.simulated)
        inelastic.errorbar(phi, 100 * (z / theory - 1), 100 * error / theory, fmt="os"[k], markersize=4, color=colour,
                           fillstyle=fill, label=f"{names[d]}, $e$ = {e}")
pressure.set_yticks([1, 2, 5, 10], ["1", "2", "5", "10"])
pressure.minorticks_off()
pressure.legend(loc="upper left")
elastic.set_ylim(-1, 2.5)
inelastic.set_ylim(-3.5, 1)
inelastic.legend(ncols=2, loc="upper center", columnspacing=1, fontsize=7)
figures.label(pressure, r"$\alpha$", "$p/(n T)$", "elastic: runs and fits")
figures.label(elastic, r"$\alpha$", "over the fit to simulations - 1 (%)", "elastic; grey: 0.5 %")
figures.label(inelastic, r"$\alpha$", "over Garzó and Dufty - 1 (%)", "cooling: runs")
script.save(fig, "equationOfState")
