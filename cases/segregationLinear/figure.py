# SPDX-License-Identifier: GPL-3.0-or-later
"""Concentration of small grains in time and height for four diffusivities (Christov, Fig. 3), errors against the exact solution;
little and no diffusion beside the exact solution without (Gray & Thornton 2005)."""
import os
import sys

import numpy as np

from haff.plot import figures, script
from studies.exact import segregation
from studies.measured import mixture

case = script.folder()
fig, axes = figures.panels(2, 2, width=7.0, height=2.5)
print("largest error at t = 0.12, 0.48, 1, 2 s; largest drift of the integral:", file=sys.stderr)
for ax, D in zip(axes.flat, (0.002, 0.02, 0.1, 0.5)):
    path = case if D == 0.1 else os.path.join(case, f"D{D:g}")
    t, y, phi = mixture.history(path)
    ax.contour(t, y, phi.T, levels=np.arange(1, 19) / 19, colors="k", linewidths=0.5)
    figures.label(ax, "$t$ (s)", "$y$ (m)", f"$D_r$ = {D:g}")
    worst = []
    for time in (0.12, 0.48, 1, 2):
        here = phi[np.argmin(np.abs(t - time))]
        exact = np.array(segregation.gray_chugunov(y[::10], time, -1, D, 0.5, 0.55), float)
        worst.append(np.max(np.abs(here[::10] - exact)))
    mass = np.sum(0.5 * (phi[:, 1:] + phi[:, :-1]) * np.diff(y), axis=1)
    print(f"   D_r {D:g}:", " ".join(f"{v:.1e}" for v in worst), f" {np.max(np.abs(mass / mass[0] - 1)):.1e}", file=sys.stderr)
script.save(fig, "segregationLinear")

fig, axes = figures.panels(1, 3)
print("without diffusion: D_r, mean difference to Gray & Thornton's shocks at t = 0.24, 0.72, 2 s:", file=sys.stderr)
for D, style in (("0", "-"), ("0.002", "--")):
    t, y, phi = mixture.history(os.path.join(case, "D" + D))
    away = []
    for ax, time in zip(axes.flat, (0.24, 0.72, 2)):
        here, exact = phi[np.argmin(np.abs(t - time))], segregation.gray_thornton_uniform(y, time, 0.5, 0.55)
        if D == "0":
            ax.plot(exact, y, color="0.7", linewidth=2.5, label="exact, no diffusion")
        ax.plot(here, y, style, color="C0" if D == "0" else "C3", linewidth=1, label=f"$D_r$ = {D}")
        figures.label(ax, r"$\phi$", "$y$ (m)", f"$t$ = {time:g} s")
        away.append(np.mean(np.abs(here - exact)))
    print(f"   {D}:", " ".join(f"{v:.1e}" for v in away), f" phi in {phi.min():.3g} .. {phi.max():.10g}", file=sys.stderr)
axes.flat[2].legend(loc="upper right")
script.save(fig, "grayThornton")
