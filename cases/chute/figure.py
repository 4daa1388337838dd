# SPDX-License-Identifier: GPL-3.0-or-later
"""The layer at four times: velocity along the floor over the height, beside Bagnold's profile of mu(I). Prints the greatest difference at the end."""
import math
import os
import sys

import numpy as np

import haff
from haff.case import entries
from haff.plot import figures, script
from studies.checks import heaps

MOMENTS = 0.5, 1, 2, 6
DEPTH, DIAMETER, PACKING = 0.03, 1e-3, 0.64


def bagnold(case, y):
    """u = (2/3) (I/sigma) sqrt(alpha g cos theta) (H^(3/2) - (H - y)^(3/2)), where mu(I) = tan theta."""
    gravity = entries.get(os.path.join(case.path, "constant", "g"), "value")
    friction = {name: entries.get(os.path.join(case.path, "constant", "granularProperties"), f"friction/{name}") for name in ("muStatic", "muDynamic", "I0")}
    slope = -gravity[0] / gravity[1]
    inertial = friction["I0"] * max(slope - friction["muStatic"], 0) / (friction["muDynamic"] - slope)
    return 2 / 3 * inertial / DIAMETER * math.sqrt(-PACKING * gravity[1]) * (DEPTH ** 1.5 - np.clip(DEPTH - y, 0, None) ** 1.5)


def main(folder):
    case = haff.Case(folder)
    fig, axes = figures.panels(1, 1, width=4, height=2.5)
    ax, y = axes[0][0], case.centres[:, 1]
    for t in MOMENTS:
        bed = np.flatnonzero(case.field("alpha", case.time(t)) > heaps.PACKED)
        u = case.field("U", case.time(t))[bed, 0]
        ax.plot(u, 1e3 * y[bed], marker=".", label=f"{t:g} s")
    exact = bagnold(case, y[bed])
    ax.plot(exact, 1e3 * y[bed], color="black", label="exact")
    print(f"{MOMENTS[-1]:g} s: greatest difference to the exact profile {np.abs(u - exact).max() / exact.max():.4f} of its greatest value", file=sys.stderr)
    ax.legend()
    figures.label(ax, "$u$ (m/s)", "$y$ (mm)")
    script.save(fig, "chute")


if __name__ == "__main__":
    main(script.folder())
