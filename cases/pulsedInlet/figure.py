# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing fraction and temperature along the tube, beside grains that fly freely."""
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.exact import bunches

case = haff.Case(script.folder())
time = case.times[-1]
x, alpha, T = case.line(("alpha", "T"), time)
fig, (panels,) = figures.panels(1, 2)
fine = np.linspace(0, 0.97 * bunches.FOCUS, 2000)
panels[0].plot(fine, bunches.packing(fine, float(time)), color="0.3", label="free flight")
panels[0].plot(x[::12], alpha[::12], "o", markersize=3, fillstyle="none", label="granularGas, every 12th cell")
panels[0].axvline(bunches.FOCUS, color="0.7", linewidth=0.5)
panels[0].set_yscale("log")
panels[0].legend()
panels[1].plot(x, T, linewidth=0.7)
panels[1].set_yscale("log")
figures.label(panels[0], "$x$", r"$\alpha$")
figures.label(panels[1], "$x$", "$T$")
print(f"error {bunches.error(case, time):.2e}, focus {bunches.FOCUS:.4f}", file=sys.stderr)
script.save(fig, "pulsedInlet")
