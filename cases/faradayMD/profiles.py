# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing fraction and rho T/(g diameter) over the height through two periods, where a heap lies at the first moment: Fig. 6 of
Carrillo et al.    haff figure profiles.py RUN  (RUN: one of table1.py -keep, written at quarters of the period)"""
import sys

import numpy as np

from haff.layers import faraday
from haff.plot import figures, script

SETTLED, HEIGHT, GRAVITY = 20, 25, 981.0
layer = faraday.Layer(script.folder())
written = layer.phases(SETTLED)
mode = faraday.measure(list(faraday.samples(layer, SETTLED).values()), layer.length)["mode"]
name = {(n, round(4 * phase)): time for phase, (cycles, names) in written.items() for n, time in zip(cycles, names)}
starts = [n for n in range(SETTLED, max(written[0][0]) - 1, 2)]
heaps = [layer.crests(name[n, 0], mode) for n in starts]
fig, axes = figures.panels(2, 4, width=8, height=2.1)
for quarter, ax in enumerate(axes.flat):
    p = layer.profile([name[n + quarter // 4, quarter % 4] for n in starts], heaps)
    ax.plot(p["y"], p["alpha"], label=r"$\alpha$")
    energy = 4 / np.pi * p["alpha"] * p["T"] / GRAVITY
    ax.plot(p["y"], energy, "--", label=r"$\rho T/\sigma g$")
    ax.set(xlim=(0, HEIGHT), ylim=(0, 2.5))
    figures.label(ax, r"$y$ ($\sigma$)" if quarter > 3 else "", "", f"$t$ = {quarter / 4:g} $T$")
    print(f"t = {quarter / 4:g} T: at the plate {p['alpha'][0]:.3f}, greatest {p['alpha'].max():.3f} at "
          f"{p['y'][np.argmax(p['alpha'])]:.1f}, rho T/g {energy.max():.3f}", file=sys.stderr)
axes[0][0].legend()
script.save(fig, "profiles")
