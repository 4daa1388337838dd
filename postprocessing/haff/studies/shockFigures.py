"""Figures of the cases with shocks on general meshes: the flow over a wedge, and bow shocks in three gases."""
import os

import numpy as np

import haff
from haff.plot import cellmap, figures, script
from haff.runs import expected
from haff.studies import shocks

FLOWS = (("", "$e$ = 0.98"), ("e1", "$e$ = 1"), ("perfect", "perfect gas, 1.4"))


def wedge(name):
    """Density on the triangles, and all cells beside the exact oblique shock."""
    case = haff.Case(script.folder())
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
    for field, exact in (("rho", behind.rho / shock.rho), ("p", behind.p / shock.p)):
        values = case.field(field)[here] / getattr(shock, field)
        axes[0][1].plot(angle[here], values, ".", markersize=1.5, label=rf"${dict(rho=chr(92) + 'rho', p='p')[field]}$")
        axes[0][1].plot((15, np.degrees(beta), np.degrees(beta), 60), (exact, exact, 1, 1), color="0.2", linewidth=0.7)
    figures.label(axes[0][1], "polar angle about the tip (degrees)", "over the upstream value", "all cells of 2 < $x$ < 8; line: exact")
    axes[0][1].set_xlim(15, 60)
    axes[0][1].legend()
    script.save(fig, name)


def blunt_body(picture, patch):
    """Density on a patch in the plane of x and y, and along the axis."""
    flows = [(haff.Case(os.path.join(script.folder(), sub)), name) for sub, name in FLOWS
             if os.path.isdir(os.path.join(script.folder(), sub, "constant"))]
    fig, axes = figures.panels(1, len(flows) + 1, width=2.4 * (len(flows) + 1) + 0.6, height=3.3)
    for panel, (case, name) in zip(axes[0], flows):
        shock = shocks.upstream(case, expected.gas(case))
        radius = shocks.body_radius(case)
        ratio = case.field("rho") / shock.rho
        tint = cellmap.draw(panel, case, ratio, patch=patch, span=(0.8, 6))
        panel.set_title(f"{name}: stand-off {shocks.stand_off(case, shock):.3f} $R$", fontsize=9)
        x = np.linspace(case.mesh.points[:, 0].min(), -1.001 * radius, 300)
        flow = shocks.Samples(case, ("rho",), mirror=range(1, shocks.dimensions(case)))
        axes[0][-1].plot(x / radius, flow(np.outer(x, np.eye(flow.dim)[0]))["rho"] / shock.rho, label=name)
    fig.colorbar(tint, ax=axes[0][:-1], label="density over upstream density", location="bottom", shrink=0.6, extend="max")
    figures.label(axes[0][-1], "$x/R$ on the axis", "density over upstream density")
    axes[0][-1].legend()
    script.save(fig, picture)
