# SPDX-License-Identifier: GPL-3.0-or-later
"""Mean packing over the height at three strengths of shaking, of gas and grains; packing at the floor over the greatest, over the strength; the grains."""
import os
import re
import sys

from matplotlib.collections import EllipseCollection

import haff
from haff.case import grains
from haff.plot import figures, script
from studies.checks import vibrated

TOP = 40
found = {("gas", 36): haff.Case(script.folder())}
for name in os.listdir(script.folder()):
    if (match := re.fullmatch(r"(gas|grains)(\d+)", name)) and os.path.isdir(script.folder(name, "constant", "polyMesh")):
        found[match[1], int(match[2])] = haff.Case(script.folder(name))
profiles = {key: vibrated.shaken(case) for key, case in sorted(found.items())}
fig = figures.plt.figure(figsize=(9.5, 3.2), layout="constrained")
axes = fig.subplots(1, 3, width_ratios=(1.2, 1.2, 1))
for strength, colour in zip((4, 16, 64), figures.COLOURS):
    for kind, style in (("gas", "-"), ("grains", ".")):
        if p := profiles.get((kind, strength)):
            axes[0].plot(p["y"], p["alpha"], style, color=colour, markersize=4, label=f"{kind}, $S$ = {strength}")
axes[0].set_xlim(0, TOP)
axes[0].legend()
figures.label(axes[0], r"$y/\sigma$", r"mean of $\alpha$")
for (kind, style), colour in zip((("gas", "o-"), ("grains", "s--")), figures.COLOURS):
    points = [(strength, vibrated.inversion(p)) for (k, strength), p in profiles.items() if k == kind]
    axes[1].plot(*zip(*points), style, color=colour, label=kind)
    for strength, value in points:
        p = profiles[kind, strength]
        print(f"{kind}, S = {strength}: floor over greatest {value:.3f}, greatest {p['alpha'].max():.3f} at {p['y'][p['alpha'].argmax()]:.1f}, "
              f"centre {vibrated.columns.centre(p):.2f}", file=sys.stderr)
axes[1].set_ylim(0, 1)
axes[1].legend()
figures.label(axes[1], "$S$", "packing at the floor over the greatest")
if shown := found.get(("grains", 36)):
    x = grains.places(shown, shown.time(None))
    axes[2].add_collection(EllipseCollection(1, 1, 0, units="x", offsets=x[:, :2], offset_transform=axes[2].transData, facecolor="#3b0f70", linewidth=0))
axes[2].set(xlim=(0, 40), ylim=(0, TOP), aspect="equal")
figures.label(axes[2], r"$x/\sigma$", r"$y/\sigma$", "grains, $S$ = 36")
script.save(fig, "leidenfrost")
