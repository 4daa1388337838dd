# SPDX-License-Identifier: GPL-3.0-or-later
"""The jet, mirrored about the axis, and the Mach number along the axis beside rhoCentralFoam."""
import os

import numpy as np

import haff
from haff.plot import cellmap, figures, script
from studies.checks import roundFlows

case = haff.Case(script.folder())
time = case.times[-1]
rho, p, U = (case.field(name, time) for name in ("rho", "p", "U"))
mach = np.linalg.norm(U, axis=1) / np.sqrt(1.4 * p / rho)
fig, axes = figures.panels(2, 1, height=2.3)
tint = cellmap.draw(axes[0][0], case, mach, colours="viridis", unit="m")
shapes, cells = cellmap.polygons(case.mesh, "back")
axes[0][0].add_collection(type(tint)([shape * (1, -1) for shape in shapes], array=mach[cells], cmap="viridis", clim=tint.get_clim(), edgecolors="face",
                                     linewidths=0.2, rasterized=True))
axes[0][0].set(ylim=(-0.01, 0.01), ylabel="$r$ (m)")
fig.colorbar(tint, ax=axes[0][0], label="Mach number")
x, _, mach = roundFlows.axis_of_jet(case, time)
axes[1][0].plot(1000 * x, mach, label=f"haff, {round(0.005 / (2 * case.centres[:, 1].min()))} cells along the radius of the nozzle")
other = np.genfromtxt(os.path.join(script.here(), "rhoCentralFoam.csv"), delimiter=",", names=True)
axes[1][0].plot(1000 * other["x"], other["mach"], "--", label=f"rhoCentralFoam, {len(other) // 6}")
axes[1][0].set(xlabel="$x$ along the axis (mm)", ylabel="Mach number", xlim=(0, 30))
axes[1][0].legend()
script.save(fig, "jet")
