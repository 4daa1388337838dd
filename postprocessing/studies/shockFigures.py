# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of the cases with shocks on general meshes: the flow over a wedge, and bow shocks in three gases."""
import os

import numpy as np
from matplotlib.patches import Circle
from matplotlib.tri import Triangulation

import haff
from haff.plot import cellmap, figures, script
from studies.exact.eos import of_case
from studies.measured import shocks

FLOWS = (("", "$e$ = 0.98"), ("e1", "$e$ = 1"), ("perfect", "perfect gas, 1.4"))


def wedge(name):
    """Density on the triangles, and all cells beside the exact oblique shock."""
    case = haff.Case(script.folder())
    shock = shocks.upstream(case, of_case(case))
    beta = shock.angle(shocks.WEDGE)
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


def smooth(axes, mesh, patch, values, mirrored=False, **options):
    """values [cells] on a patch of triangles in the plane of x and y, smoothly: a corner has the mean of the triangles around it,
    weighted by their angles there. mirrored: at -y. Returns what a colour bar wants, the triangulation and the values at its corners."""
    _, start, count = mesh.patches[patch]
    corners = mesh.face_points[mesh.face_start[start]:mesh.face_start[start + count]].reshape(-1, 3)
    used, corners = np.unique(corners, return_inverse=True)
    corners, at = corners.reshape(-1, 3), mesh.points[used, :2] * (1, -1 if mirrored else 1)
    one, other = (at[np.roll(corners, k, axis=1)] - at[corners] for k in (1, 2))
    angle = np.abs(np.arctan2(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0], (one * other).sum(axis=-1)))
    weighted = angle * np.asarray(values)[mesh.owner[start:start + count], None]
    mean = np.bincount(corners.ravel(), weighted.ravel()) / np.bincount(corners.ravel(), angle.ravel())
    net = Triangulation(*at.T, corners)
    return axes.tripcolor(net, mean, shading="gouraud", rasterized=True, **options), net, mean


def blunt_body(picture, patch):
    """On a patch in the plane of x and y: density above the axis, Mach number below it, whose white line is Mach 1; and the density along
    the axis."""
    flows = [(haff.Case(script.folder(sub)), name) for sub, name in FLOWS if os.path.isdir(script.folder(sub, "constant"))]
    low, high = np.array([f(flows[0][0].mesh.points[:, :2], axis=0) for f in (np.min, np.max)])
    wide = 0.5 + 3.9 * -low[0] / (2 * high[1])
    fig, axes = figures.plt.subplots(1, len(flows) + 1, figsize=(len(flows) * wide + 3.4, 5.4), squeeze=False, layout="constrained",
                                     width_ratios=[wide] * len(flows) + [2.8])
    for panel, (case, name) in zip(axes[0], flows):
        eos = of_case(case)
        shock, radius = shocks.upstream(case, eos), shocks.body_radius(case)
        rho, p, speed = case.field("rho"), case.field("p"), np.linalg.norm(case.field("U"), axis=1)
        above, *_ = smooth(panel, case.mesh, patch, rho / shock.rho, cmap="viridis", vmin=1, vmax=6)
        below, *net = smooth(panel, case.mesh, patch, speed / eos.c(rho, eos.T(rho, p)), mirrored=True, cmap="magma", vmin=0, vmax=round(shock.mach))
        panel.tricontour(*net, levels=[1], colors="w", linewidths=0.8)
        panel.add_patch(Circle((0, 0), radius, facecolor="0.75", edgecolor="k", linewidth=0.8))
        panel.axhline(0, color="w", linewidth=0.6)
        panel.set(xlim=(1.02 * low[0], 0), ylim=(-high[1], high[1]), aspect="equal")
        figures.label(panel, "x", "$y$ (cm)" if case is flows[0][0] else "", f"{name}\nstand-off {shocks.stand_off(case, shock):.3f} $R$")
        x = np.linspace(case.mesh.points[:, 0].min(), -1.001 * radius, 300)
        flow = shocks.Samples(case, ("rho",), mirror=range(1, shocks.dimensions(case)))
        axes[0][-1].plot(x / radius, flow(np.outer(x, np.eye(flow.dim)[0]))["rho"] / shock.rho, label=name)
    for shown, words in ((above, "density over that of the stream (above)"), (below, "Mach number (below)")):
        fig.colorbar(shown, ax=axes[0][:-1], label=words, location="bottom", extend="max" if shown is above else "neither", aspect=40, pad=0.02)
    figures.label(axes[0][-1], "$x/R$ on the axis", "density over that of the stream")
    axes[0][-1].legend()
    script.save(fig, picture)
