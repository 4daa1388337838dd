"""The flow over the wedge and the exact oblique shock."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import numpy as np  # noqa: E402

import cellmap  # noqa: E402
import expected  # noqa: E402
import figures  # noqa: E402
import haff  # noqa: E402
import shocks  # noqa: E402

case = haff.Case(figures.folder())
shock = shocks.upstream(case, expected.gas(case))
beta = shock.angle(expected.WEDGE)
behind = shock.behind(beta)
fig, axes = figures.panels(1, 2, height=3.3)
ratio = case.field("rho") / shock.rho
x, y = case.centres[:, :2].T
tint = cellmap.draw(axes[0][0], case, ratio)
axes[0][0].plot((0, 10), (0, 10 * np.tan(beta)), "--", color="#c0392b", linewidth=0.8)
axes[0][0].set_title(f"density over upstream density, {case.mesh.cells} triangles", fontsize=9)
fig.colorbar(tint, ax=axes[0][0], shrink=0.8)
here = (x > 2) & (x < 8)
angle = np.degrees(np.arctan2(y, x))
for name, exact in (("rho", behind.rho / shock.rho), ("p", behind.p / shock.p)):
    values = case.field(name)[here] / getattr(shock, name)
    axes[0][1].plot(angle[here], values, ".", markersize=1.5, label=rf"${dict(rho=chr(92) + 'rho', p='p')[name]}$")
    axes[0][1].plot((15, np.degrees(beta), np.degrees(beta), 60), (exact, exact, 1, 1), color="0.2", linewidth=0.7)
figures.label(axes[0][1], "polar angle about the tip (degrees)", "over the upstream value", "all cells of 2 < $x$ < 8; line: exact")
axes[0][1].set_xlim(15, 60)
axes[0][1].legend()
figures.save(fig, os.path.join(figures.folder(), "wedge15.png"))
