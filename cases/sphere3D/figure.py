"""Bow shocks ahead of the sphere in three gases: the plane of symmetry."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import numpy as np  # noqa: E402

import cellmap  # noqa: E402
import expected  # noqa: E402
import figures  # noqa: E402
import haff  # noqa: E402
import shocks  # noqa: E402

FLOWS = (("", "$e$ = 0.98"), ("e1", "$e$ = 1"), ("perfect", "perfect gas, 1.4"))
flows = [(haff.Case(os.path.join(figures.folder(), sub)), name) for sub, name in FLOWS
         if os.path.isdir(os.path.join(figures.folder(), sub, "constant"))]
fig, axes = figures.panels(1, len(flows) + 1, width=2.4 * (len(flows) + 1) + 0.6, height=3.3)
for panel, (case, name) in zip(axes[0], flows):
    shock = shocks.upstream(case, expected.gas(case))
    radius = shocks.body_radius(case)
    ratio = case.field("rho") / shock.rho
    tint = cellmap.draw(panel, case, ratio, patch="symmetryBottom", span=(0.8, 6))
    panel.set_title(f"{name}: stand-off {shocks.stand_off(case, shock):.3f} $R$", fontsize=9)
    x = np.linspace(case.mesh.points[:, 0].min(), -1.001 * radius, 300)
    flow = shocks.Samples(case, ("rho",), mirror=range(1, shocks.dimensions(case)))
    axes[0][-1].plot(x / radius, flow(np.outer(x, np.eye(flow.dim)[0]))["rho"] / shock.rho, label=name)
fig.colorbar(tint, ax=axes[0][:-1], label="density over upstream density", location="bottom", shrink=0.6, extend="max")
figures.label(axes[0][-1], "$x/R$ on the axis", "density over upstream density")
axes[0][-1].legend()
figures.save(fig, os.path.join(figures.folder(), "sphere3D.png"))
