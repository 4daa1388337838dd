# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing of the gas, the grains, and radius and momentum of the shell over time beside t^(1/3)."""
import os
import sys

import numpy as np
from matplotlib.collections import EllipseCollection

import haff
from haff.case import grains
from haff.plot import figures, script
from studies.checks import coldBlast

TIME = 1600
found = {name: haff.Case(script.folder(sub)) for name, sub in (("gas", ""), ("grains", "grains")) if os.path.isdir(script.folder(sub, "constant", "polyMesh"))}
fig = figures.plt.figure(figsize=(9.5, 3), layout="constrained")
axes = fig.subplots(1, 3)
gas = found["gas"]
plane = gas.slice("alpha", "z", time=gas.time(TIME))
shown = axes[0].imshow(plane["alpha"], origin="lower", extent=(0, 144, 0, 144), vmin=0, vmax=0.82, cmap="magma_r")
fig.colorbar(shown, ax=axes[0], label=r"$\alpha$", shrink=0.8)
if "grains" in found:
    x = grains.places(found["grains"], found["grains"].time(TIME))
    axes[1].add_collection(EllipseCollection(1, 1, 0, units="x", offsets=x[:, :2], offset_transform=axes[1].transData, facecolor="#3b0f70", linewidth=0))
for ax, name in zip(axes, ("gas", "grains")):
    ax.set(xlim=(0, 144), ylim=(0, 144), aspect="equal")
    figures.label(ax, r"$x/\sigma$", r"$y/\sigma$", f"{name}, $t$ = {TIME}")
for (name, case), colour in zip(found.items(), figures.COLOURS):
    t, radius, momentum = coldBlast.course(case)
    axes[2].loglog(t, radius, ".-", markersize=3, color=colour, label=f"radius, {name}")
    axes[2].loglog(t, momentum, "--", color=colour, label=f"momentum, {name}")
    print(f"{name}: exponents of radius and momentum {coldBlast.exponents(case)[0]:.3f}, {coldBlast.exponents(case)[1]:.3f}", file=sys.stderr)
t = np.array([300, 3200])
axes[2].loglog(t, 70 * (t / 600) ** (1 / 3), color="0.5", label="$t^{1/3}$")
axes[2].legend(fontsize=7, loc="lower right", bbox_to_anchor=(1, 0.12))
figures.label(axes[2], "$t$", r"$R/\sigma$, radial momentum per radian")
script.save(fig, "blastCold")
