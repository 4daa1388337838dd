"""p/(n T) of disks and spheres beside contact values and fits to other simulations (sweep.py)."""
import os

import numpy as np

from haff.exact import enskog
from haff.plot import figures, script

# For spheres below freezing Torquato's is Carnahan and Starling's.
FORMS = {2: (("Torquato", enskog.torquato, "--"), ("Henderson", enskog.carnahan_starling, ":"), ("Luding", enskog.luding, "-.")),
         3: (("Carnahan-Starling", enskog.carnahan_starling, "--"),)}
path = script.folder()
fig, ((pressure, elastic, inelastic),) = figures.panels(1, 3, width=9.0, height=2.9)
table = np.loadtxt(os.path.join(path, "sweep", "elastic.csv"), delimiter=",", ndmin=2)
rows = np.loadtxt(os.path.join(path, "sweep", "inelastic.csv"), delimiter=",", ndmin=2)
names = {2: "disks", 3: "spheres"}

elastic.axhspan(-0.5, 0.5, color="0.92")
elastic.axhline(0, color="0.3", linewidth=0.7)
inelastic.axhline(0, color="0.3", linewidth=0.7)
for k, d in enumerate((2, 3)):
    colour = figures.COLOURS[k]
    _, phi, z, error = table[table[:, 0] == d].T
    fine = np.linspace(0.005, phi[-1], 200)
    fit, fitted = (enskog.pressure_factor(x, 1, d, enskog.simulated) for x in (fine, phi))
    pressure.semilogy(fine, fit, color=colour, linewidth=0.7)
    pressure.semilogy(phi, z, "os"[k], markersize=3, color=colour, label=names[d])
    elastic.errorbar(phi, 100 * (z / fitted - 1), 100 * error / fitted, fmt="os"[k], markersize=3, color=colour, label=names[d])
    for name, chi, style in FORMS[d]:
        elastic.plot(fine, 100 * (enskog.pressure_factor(fine, 1, d, chi) / fit - 1), style, color=colour, linewidth=0.7,
                     label=f"{names[d]}, {name}")
    for e, fill in ((0.9, "full"), (0.7, "none")):
        _, phi, _, z, error = rows[(rows[:, 0] == d) & (rows[:, 2] == e)].T
        theory = enskog.pressure_factor(phi, e, d, enskog.simulated)
        inelastic.errorbar(phi, 100 * (z / theory - 1), 100 * error / theory, fmt="os"[k], markersize=3.5, color=colour,
                           fillstyle=fill, label=f"{names[d]}, $e$ = {e}")
pressure.legend()
elastic.set_ylim(-1, 2.5)
elastic.legend(fontsize=7)
inelastic.set_ylim(-3.5, 2)
inelastic.legend(fontsize=7, ncols=2)
figures.label(pressure, r"$\alpha$", "$p/(n T)$", "elastic")
figures.label(elastic, r"$\alpha$", "over the fit to simulations - 1 (%)", "elastic")
figures.label(inelastic, r"$\alpha$", "over Garzó and Dufty - 1 (%)", "cooling")
script.save(fig, "equationOfState")
