# SPDX-License-Identifier: GPL-3.0-or-later
"""T of a cooling gas of disks beside Haff's law, where its grains are at the end, and the rate of cooling over that of
Enskog's theory (sweep.py)."""
import os
import sys

import numpy as np

import haff
from haff.case import grains
from haff.plot import figures, script
from haff.start import enskog
from studies.made import homogeneous

path = script.folder()
case = haff.Case(path)
fig, ((cooling, places, rates),) = figures.panels(1, 3, width=9.0, height=2.9)

t, T = homogeneous.temperatures(case)
fine = np.linspace(0, t[-1], 200)
theory = [enskog.cooled(1, x, 0.1, 0.9, 2, 1, enskog.simulated) for x in (t, fine)]
cooling.plot(fine, theory[1] ** -0.5, color="0.3", linewidth=0.7, label="Haff's law, Enskog's rate")
cooling.plot(t, T**-0.5, "o", markersize=2.5, label="granularMD")
cooling.legend()
figures.label(cooling, r"$t\,\sqrt{T_0}/\sigma$", r"$\sqrt{T_0/T}$", r"9982 disks, $\alpha$ = 0.1, $e$ = 0.9")
for a, b, c in zip(t, T, theory[0]):
    print(f"t = {a:5g}: T = {b:.5f}, {b / c:.3f} of Haff's law", file=sys.stderr)

x = grains.places(case, case.times[-1])
places.plot(x[:, 0], x[:, 1], ".", markersize=0.6, color="0.2", rasterized=True)
places.set_aspect("equal")
places.set_xlim(0, 280)
places.set_ylim(0, 280)
figures.label(places, r"$x/\sigma$", r"$y/\sigma$", f"$t$ = {case.times[-1]}")

table = np.loadtxt(os.path.join(path, "sweep", "rates.csv"), delimiter=",", ndmin=2)
rates.axhspan(-2, 2, color="0.92")
rates.axhline(0, color="0.3", linewidth=0.7)
for k, (d, name) in enumerate(((2, "disks"), (3, "spheres"))):
    for e, fill in ((0.9, "full"), (0.95, "none")):
        row = table[(table[:, 0] == d) & (table[:, 2] == e)]
        rates.errorbar(row[:, 1] + 0.004 * k, 100 * (row[:, 3] - 1), 100 * row[:, 4], fmt="os"[k], markersize=3.5,
                       color=figures.COLOURS[k], fillstyle=fill, label=f"{name}, $e$ = {e}")
rates.set_ylim(-4, 4)
rates.legend(fontsize=7)
figures.label(rates, r"$\alpha$", "rate of cooling / Enskog's - 1 (%)")
script.save(fig, "coolingGas")
