# SPDX-License-Identifier: GPL-3.0-or-later
"""Concentration of small grains in a layer shaken from both sides (Christov, Fig. 4): to 100 s and to 1000 s."""
import sys

import numpy as np

from haff.plot import figures, script
from studies.measured import mixture

case = script.folder()
t, y, phi = mixture.history(case)
fig, axes = figures.panels(1, 3, width=9.0, height=2.6)
for ax, end in zip(axes[0], (100, 1000)):
    ax.contour(t[t <= end], 1e3 * y, phi[t <= end].T, levels=np.arange(1, 19) / 19, colors="k", linewidths=0.5)
    figures.label(ax, "$t$ (s)", "$y$ (mm)")
for time in (10, 100, 300, 1000):
    axes[0][2].plot(phi[np.argmin(np.abs(t - time))], 1e3 * y, label=f"{time} s")
axes[0][2].legend()
figures.label(axes[0][2], r"$\phi$", "$y$ (mm)")
mass = np.sum(0.5 * (phi[:, 1:] + phi[:, :-1]) * np.diff(y), axis=1)
print(f"largest drift of the integral {np.max(np.abs(mass / mass[0] - 1)):.1e}; at 1000 s phi = {phi[-1].min():.6f} .. "
      f"{phi[-1].max():.6f}, {phi[-1][len(y) // 2]:.6f} in the middle", file=sys.stderr)
script.save(fig, "segregationExponential")
