# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, velocity and T over the height at five phases of the shaking, of the gas (lines) and the grains (dots)."""
import os
import sys

from haff.layers import columns
from haff.plot import figures, script
from studies.checks import shockLayers

PHASES = (0.9, 0, 0.1, 0.2, 0.5)
runs = {name: script.folder(sub) for name, sub in (("gas", ""), ("grains", "grains")) if os.path.isdir(script.folder(sub, "constant", "polyMesh"))}
beds = {name: columns.at(path, PHASES, shockLayers.SETTLED) for name, path in runs.items()}
fig, axes = figures.panels(3, len(PHASES), height=1.7)
for column, phase in enumerate(PHASES):
    for name, bed in beds.items():
        p = bed[phase]
        for ax, values in zip(axes[:, column], (p["alpha"], columns.seen(p, p["U"]), columns.seen(p, p["T"]))):
            ax.plot(p["y"], values, **({"marker": ".", "markersize": 2.5, "linestyle": "none"} if name == "grains" else {}), label=name)
        height, T = shockLayers.hottest(p)
        print(f"{name}, {phase:g} T: centre {columns.centre(p):.2f}, greatest alpha {p['alpha'].max():.3f}, hottest {T:.1f} at {height:.1f}", file=sys.stderr)
    axes[0, column].set_title(f"{phase:g} $T$", fontsize=9)
    for ax, label, most in zip(axes[:, column], (r"$\alpha$", r"$u_y/\sqrt{g\sigma}$", r"$T/(g\sigma)$"), (0.9, None, 26)):
        ax.set_xlim(0, 40)
        if most:
            ax.set_ylim(0, most)
        figures.label(ax, r"$y/\sigma$" if ax is axes[-1, column] else "", "" if column else label)
axes[0, -1].legend()
script.save(fig, "shockLayer")
