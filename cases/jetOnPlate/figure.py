# SPDX-License-Identifier: GPL-3.0-or-later
"""The jet on the plate as a gas and as grains, and the angle and the speed of the sheet over time beside a perfect fluid."""
import os
import sys

from matplotlib.collections import EllipseCollection

import haff
from haff.case import grains
from haff.plot import figures, script
from studies.checks import jets
from studies.exact import jet

TIME = 200
found = {name: haff.Case(script.folder(sub)) for name, sub in (("gas", ""), ("grains", "grains")) if os.path.isdir(script.folder(sub, "constant", "polyMesh"))}
fig = figures.plt.figure(figsize=(9.5, 4), layout="constrained")
axes = fig.subplots(1, 3, width_ratios=(1, 1, 1.2))
plane = found["gas"].slice("alpha", "z", time=found["gas"].time(TIME))
shown = axes[0].pcolormesh(plane.u, plane.v, plane["alpha"], cmap="magma_r", vmin=0, vmax=0.82)
fig.colorbar(shown, ax=axes[0], label=r"$\alpha$", location="bottom", shrink=0.8)
if "grains" in found:
    x = grains.places(found["grains"], found["grains"].time(TIME))
    axes[1].add_collection(EllipseCollection(1, 1, 0, units="x", offsets=x[:, :2], offset_transform=axes[1].transData, facecolor="#3b0f70", linewidth=0))
for ax, name in zip(axes, ("gas", "grains")):
    ax.add_patch(figures.plt.Rectangle((0, -6), 24, 6, color="0.5"))
    ax.set(xlim=(0, 96), ylim=(-48, 100), aspect="equal")
    figures.label(ax, r"$x/\sigma$", r"$y/\sigma$", f"{name}, $t$ = {TIME}")
speed = axes[2].twinx()
for (name, case), colour in zip(found.items(), figures.COLOURS):
    times = [name for name in case.times if float(name) >= 100]
    values = [jets.sheet(case, time) for time in times]
    axes[2].plot([float(t) for t in times], [v[1] for v in values], ".-", color=colour, label=f"angle, {name}")
    speed.plot([float(t) for t in times], [v[2] for v in values], "--", color=colour, label=f"speed, {name}")
    print(f"{name}: angle and speed at {TIME} {jets.sheet(case, case.time(TIME))[1:]}", file=sys.stderr)
axes[2].axhline(jet.angle(2), color="0.5", label="angle, perfect fluid")
axes[2].set_ylim(60, 95)
speed.set_ylim(0, 1)
axes[2].legend(loc="upper right")
figures.label(axes[2], "$t$", "angle from the jet (degrees); dashed, right: speed")
script.save(fig, "jetOnPlate")
