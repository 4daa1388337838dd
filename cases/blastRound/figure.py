# SPDX-License-Identifier: GPL-3.0-or-later
"""The section of the ball, mirrored about the axis, and all cells beside radial flow."""
import numpy as np

import haff
from haff.plot import cellmap, figures, script
from studies.checks import roundFlows
from studies.exact.eos import of_case

case = haff.Case(script.folder())
time = case.times[-1]
r, *exact = roundFlows.blast(roundFlows.FINE, 2, float(time), of_case(case).gamma)
away = roundFlows.distances(case, 2)
fig, axes = figures.panels(1, 2, height=3.3)
shapes, cells = cellmap.polygons(case.mesh, "back")
tint = cellmap.draw(axes[0][0], case, case.field("rho"), colours="viridis", unit="")
for x, y in ((-1, 1), (-1, -1), (1, -1)):
    axes[0][0].add_collection(type(tint)([shape * (x, y) for shape in shapes], array=case.field("rho")[cells], cmap="viridis", clim=tint.get_clim(),
                                         edgecolors="face", linewidths=0.2, rasterized=True))
axes[0][0].set(xlim=(-1, 1), ylim=(-1, 1), xlabel="$x$, along the axis", ylabel="$y$, along the radius")
fig.colorbar(tint, ax=axes[0][0], shrink=0.8, label="density")
near = away < 1
for name, values, line in (("rho", case.field("rho"), exact[0]), ("u", np.linalg.norm(case.field("U"), axis=1), exact[1]), ("p", case.field("p"), exact[2])):
    axes[0][1].plot(away[near], values[near], ".", markersize=1, label={"rho": r"$\rho$"}.get(name, f"${name}$"))
    axes[0][1].plot(r, line, color="0.2", linewidth=0.7)
axes[0][1].set(xlabel="distance from the middle", xlim=(0, 1))
axes[0][1].set_title(f"$t$ = {time}: all cells; lines: radial flow", fontsize=9)
axes[0][1].legend(markerscale=5)
script.save(fig, "blastRound")
