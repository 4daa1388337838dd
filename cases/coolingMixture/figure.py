# SPDX-License-Identifier: GPL-3.0-or-later
"""The temperatures of two kinds of disks that cool together: their ratio in time, and in the common cooling beside kinetic theory."""
import os
import sys

import numpy as np

from haff.plot import figures, script
from studies.checks import grainCases

folder = script.folder()
runs = {0.95: "e0.95", 0.9: ".", 0.8: "e0.8", 0.7: "e0.7"}
fig, ((time, steady),) = figures.panels(1, 2, width=7.5, height=3)
for k, (e, name) in enumerate(runs.items()):
    path, exact = os.path.join(folder, name), grainCases.mixture(e).temperatures()
    tables = grainCases.members(path)
    t, ratio = grainCases.temperature_ratio(tables)
    time.plot(t, ratio, color=figures.COLOURS[k], linewidth=0.9, label=f"$e$ = {e}")
    time.axhline(exact, color=figures.COLOURS[k], linewidth=0.8, linestyle="--")
    found, error = grainCases.steady_ratio(path)
    steady.errorbar(e, found, error, fmt="o", color=figures.COLOURS[k], markersize=4, capsize=3)
    impacts = np.mean([2 * x["collisions"][-1] / (x["kinetic"][0] / x["T"][0] / 4.5) for x in tables])
    print(f"e = {e}: T_big/T_small {found:.3f} +- {error:.3f}, theory {exact:.3f}, over it {found / exact:.3f}; {impacts:.0f} impacts a grain, T/T_0 {np.mean([x['T'][-1] / x['T'][0] for x in tables]):.4f}", file=sys.stderr)
line = np.linspace(0.6, 1, 41)
steady.plot(line, [grainCases.mixture(e).temperatures() for e in line], color="0.4", linewidth=0.9, label="Garzo & Dufty")
time.legend(fontsize=7)
steady.legend(fontsize=7)
figures.label(time, "$t$", r"$T_\mathrm{big}/T_\mathrm{small}$")
figures.label(steady, "$e$", r"$T_\mathrm{big}/T_\mathrm{small}$")
script.save(fig, "coolingMixture")
