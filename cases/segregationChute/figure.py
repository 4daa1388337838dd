# SPDX-License-Identifier: GPL-3.0-or-later
"""Concentration of small grains on the chute in time, and across the outlet beside the height that the flow alone fixes."""
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.exact import segregation

H = 0.02
case = haff.Case(script.folder())
places = np.round(case.centres, 9)
x, y = np.unique(places[:, 0]), np.unique(places[:, 1])
order = np.lexsort((places[:, 0], places[:, 1]))
fig, axes = figures.panels(2, 2, width=8.0, height=2.4)
for ax, t in zip(axes.flat, (0.5, 1.5, 6)):
    phi = case.field("phi", t)[order].reshape(len(y), len(x))
    picture = ax.pcolormesh(x, 1e3 * y, phi, vmin=0, vmax=1, cmap="RdYlBu_r", rasterized=True)
    figures.label(ax, "$x$ (m)", "$y$ (mm)", f"{t:g} s")
fig.colorbar(picture, ax=axes[1][0], label=r"$\phi$")
height = H * segregation.chute_height(0.5, 0.02 * 0.43837 / 0.3)
last = axes[1][1]
last.plot(phi[:, -1], 1e3 * y, label="outlet, 6 s")
last.axhline(1e3 * height, color="0.5", linewidth=0.7, label="sorted, same flux")
last.legend()
figures.label(last, r"$\phi$", "$y$ (mm)")
k = np.argmax(phi[:, -1] < 0.5)
found = y[k - 1] + (phi[k - 1, -1] - 0.5) / (phi[k - 1, -1] - phi[k, -1]) * (y[k] - y[k - 1])
print(f"phi = 0.5 at the outlet at y = {1e3 * found:.3f} mm; sorted grains of the same flux {1e3 * height:.3f} mm; "
      f"phi {phi.min():.2e} .. {phi.max():.6f}", file=sys.stderr)
script.save(fig, "segregationChute")
