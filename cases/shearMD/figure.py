# SPDX-License-Identifier: GPL-3.0-or-later
"""T of sheared disks over time beside the gas of Garzo & Dufty, and in the steady state T and shear stress over those of two gases."""
import os
import sys

import numpy as np

import haff
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
    gas = haff.Case(os.path.join(folder, f"gas{e}"))
    time.plot([float(t) for t in gas.times], [gas.field("T", t).mean() for t in gas.times], "--", color=figures.COLOURS[k], linewidth=0.8)
    found = grainCases.steady_shear(path)
    viscosity = found[1] / disks.Disks(e).shear(0.3 / disks.Disks(e).per, found[0])
    other = grainCases.balance(grainCases.garzo_dufty(e), 0.3, 1)
    rows.append((1 - e, found[0] / other[0], found[1] / other[1], found[0] / wanted[0], found[1] / wanted[1], viscosity))
    print(f"e = {e}: T {found[0]:.3f}, {rows[-1][1]:.3f} of the gas of Garzo & Dufty, {rows[-1][3]:.3f} of that of Jenkins & Richman; shear stress "
          f"{found[1]:.4f}, {rows[-1][2]:.3f}, {rows[-1][4]:.3f}; over viscosity at that T "
          f"times the shear rate {viscosity:.3f}", file=sys.stderr)
rows = np.array(rows).T
for row, mark, fill, name in zip(rows[1:5], "osos", ("full", "full", "none", "none"), ("$T$, Garzo & Dufty", "shear stress", "$T$, Jenkins & Richman", "shear stress")):
    ratio.plot(rows[0], row, mark, color=figures.COLOURS[0], markersize=4, fillstyle=fill, label=name)
ratio.axhline(1, color="0.7", linewidth=0.8)
time.set_yscale("log")
time.legend(fontsize=7)
ratio.set(xlim=(0, 0.22), ylim=(0.6, 1.1))
ratio.legend(fontsize=7)
figures.label(time, r"$\dot\gamma t$", r"$T/(\dot\gamma\sigma)^2$")
figures.label(ratio, "$1 - e$", "grains over gas")
script.save(fig, "shearMD")
