# SPDX-License-Identifier: GPL-3.0-or-later
"""The wave over sqrt(T) while the gas cools, in a box below and one above that at which vortices appear: gas, grains, linear theory."""
import sys

import numpy as np

from haff.plot import figures, script
from studies.checks import vortices

top = script.folder()
fig, (row,) = figures.panels(1, 3, width=7.5, height=2.6)
for axes, (alpha, e) in zip(row, ((0.1, 0.9), (0.3, 0.8), (0.45, 0.7))):
    wanted = vortices.theory(alpha, e)
    for kind, measure, mark in (("gas", vortices.of_gas, "-"), ("grains", vortices.of_grains, "o")):
        for colour, (side, paths) in zip(figures.COLOURS, vortices.boxes(top, alpha, kind).items()):
            s, a, _ = vortices.track(paths, measure)
            axes.plot(s, a / a[0], mark, color=colour, markersize=3, label=f"{kind}, $L$ = {side:g}" + (f", {len(paths)} runs" if kind == "grains" else ""))
            if kind == "gas":
                axes.plot(s, np.exp((1 - (wanted / side) ** 2) * s), ":", color="0.3", linewidth=0.8)
    found = [vortices.critical(top, alpha, kind) for kind in ("gas", "grains")]
    print(f"alpha = {alpha}, e = {e}: vortices appear in a box of {found[0]:.2f} in the gas, {found[1]:.2f} among grains, {wanted:.2f} by linear theory", file=sys.stderr)
    axes.set(yscale="log", ylim=(0.2, 8))
    axes.legend(fontsize=6, loc="upper left")
    figures.label(axes, r"$\frac{1}{2}\ln(T_0/T)$", r"wave over $\sqrt{T}$", rf"$\alpha$ = {alpha}, $e$ = {e}: $L_c$ = {wanted:.2f}")
script.save(fig, "vortices")
