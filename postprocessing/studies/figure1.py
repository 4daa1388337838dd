# SPDX-License-Identifier: GPL-3.0-or-later
"""Fig. 1 of Serna & Marquina: adiabatic exponent, Grueneisen coefficient and fundamental derivative of the gas.

    haff figure1 FIGURE.png

The paper draws its printed eqs (9) and (13); these are the corrected ones (docs/physics.md 2.5, S3, S4), so the
exponent for e = 0.9 ends at 18.2 at nu = 0.55 and not at 32.7.
"""
import numpy as np

from haff import command
from haff.plot import figures
from studies.exact.eos import GoldshteinShapiro

QUANTITIES = (
    (r"adiabatic exponent $\gamma_A$", GoldshteinShapiro.adiabatic_exponent),
    (r"Grüneisen coefficient $\Gamma$", GoldshteinShapiro.grueneisen),
    (r"fundamental derivative $\mathcal{G}$", GoldshteinShapiro.fundamental_derivative),
)


def main():
    parser = command.parser(__doc__)
    parser.add_argument("figure", help="written; png, pdf or svg")
    path = parser.parse_args().figure
    nu = np.linspace(0, 0.55, 101)[1:]
    fig, axes = figures.panels(1, 3, width=8.5)
    for panel, (name, function) in zip(axes[0], QUANTITIES):
        for e, mark in ((0.9, "o"), (0.2, "+")):
            panel.plot(nu, function(GoldshteinShapiro(e), nu), mark, markersize=2.5, markerfacecolor="none",
                       markeredgewidth=0.5, label=f"$e$ = {e}")
        figures.label(panel, "alpha", name)
        panel.set(xlim=(0, 0.56), ylim=(0, None))
    axes[0][0].legend(loc="upper left")
    figures.save(fig, path)


if __name__ == "__main__":
    main()
