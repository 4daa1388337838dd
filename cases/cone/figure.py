# SPDX-License-Identifier: GPL-3.0-or-later
"""The flow along the cone, mirrored about the axis, and all cells beside the conical flow of Taylor & Maccoll."""
import numpy as np

import haff
from haff.plot import cellmap, figures, script
from studies.checks import roundFlows

case = haff.Case(script.folder())
flow = roundFlows.conical(case, case.times[-1])
fig, axes = figures.panels(1, 2, height=3.6)
shapes, cells = cellmap.polygons(case.mesh, "back")
values = case.field("p") / flow.p
tint = cellmap.draw(axes[0][0], case, values, colours="viridis")
axes[0][0].add_collection(type(tint)([shape * (1, -1) for shape in shapes], array=values[cells], cmap="viridis", clim=tint.get_clim(),
                                     edgecolors="face", linewidths=0.2, rasterized=True))
for side in (1, -1):
    axes[0][0].plot((0, 10), (0, 10 * side * np.tan(flow.angle)), "--", color="#c0392b", linewidth=0.8)
axes[0][0].set(xlim=(-1, 10), ylim=(-10, 10), ylabel="$r$ (cm)")
axes[0][0].set_title("pressure over that of the stream; dashed: exact shock", fontsize=9)
fig.colorbar(tint, ax=axes[0][0], shrink=0.8)
x = case.centres[:, 0]
here = (x > 4) & (x < 9)
angle = np.arctan2(case.centres[here, 1], x[here])
fine = np.linspace(roundFlows.HALF, np.radians(60), 2000)
exact = flow.sample(fine)
for field, name in (("rho", r"$\rho$"), ("p", "$p$")):
    axes[0][1].plot(np.degrees(angle), case.field(field)[here] / getattr(flow, field), ".", markersize=1.5, label=name)
    axes[0][1].plot(np.degrees(fine), getattr(exact, field) / getattr(flow, field), color="0.2", linewidth=0.7)
figures.label(axes[0][1], "polar angle about the tip (degrees)", "over the upstream value", "all cells of 4 < $x$ < 9; lines: exact")
axes[0][1].set_xlim(20, 60)
axes[0][1].legend(markerscale=4)
script.save(fig, "cone")
