# SPDX-License-Identifier: GPL-3.0-or-later
"""T of sheared disks over time, and in the steady state T and shear stress over those of the gas of Jenkins & Richman."""
import os
import sys

import numpy as np

from haff.plot import figures, script
from studies.checks import grainCases
from studies.exact import disks

folder = script.folder()
runs = {0.98: "e0.98", 0.95: "e0.95", 0.9: ".", 0.8: "e0.8"}
fig, ((time, ratio),) = figures.panels(1, 2, width=7.5, height=3)
rows = []
for k, (e, name) in enumerate(runs.items()):
    path = os.path.join(folder, name)
    t, T = np.loadtxt(os.path.join(path, "postProcessing", "grains", "0", "grains.dat"), usecols=(0, 5)).T
    wanted = grainCases.balance(disks.Disks(e), 0.3, 1)
    time.plot(t, T, color=figures.COLOURS[k], linewidth=0.8, label=f"$e$ = {e}")
    time.axhline(wanted[0], color=figures.COLOURS[k], linewidth=0.8, linestyle=":")
    found = grainCases.steady_shear(path)
    viscosity = found[1] / disks.Disks(e).shear(0.3 / disks.Disks(e).per, found[0])
    rows.append((1 - e, found[0] / wanted[0], found[1] / wanted[1], viscosity))
    print(f"e = {e}: T {found[0]:.3f}, {rows[-1][1]:.3f} of the gas; shear stress {found[1]:.4f}, {rows[-1][2]:.3f}; over viscosity at that T "
          f"times the shear rate {viscosity:.3f}", file=sys.stderr)
rows = np.array(rows).T
for row, mark, name in zip(rows[1:], "osv", ("$T$", "shear stress", "viscosity at that $T$")):
    ratio.plot(rows[0], row, mark, markersize=4, label=name)
ratio.axhline(1, color="0.7", linewidth=0.8)
time.set_yscale("log")
time.legend(fontsize=7)
ratio.set(xlim=(0, 0.22), ylim=(0.6, 1.1))
ratio.legend(fontsize=7)
figures.label(time, r"$\dot\gamma t$", r"$T/(\dot\gamma\sigma)^2$")
figures.label(ratio, "$1 - e$", "grains over gas")
script.save(fig, "shearMD")
