# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing of the drum at five times, and the angle of the surface in time."""
import sys

import numpy as np
from matplotlib.collections import PolyCollection

import haff
from haff.plot import figures, script
from studies.checks import drums
from studies.made import triangles

MOMENTS = 0, 0.3, 0.45, 0.7, 1.5  # s
FRICTION = np.degrees(np.arctan([0.38, 0.64]))


def main(folder):
    case = haff.Case(folder)
    fig, axes = figures.panels(2, 3, width=8.5, height=2.6)
    corners = 1e3 * triangles.corners(case.mesh)
    for ax, t in zip(axes.flat, MOMENTS):
        image = ax.add_collection(PolyCollection(corners, array=case.field("alpha", case.time(t)), cmap="magma_r", clim=(0, 0.64)))
        ax.set(xlim=(-31, 31), ylim=(-31, 31), aspect="equal")
        figures.label(ax, "$x$ (mm)", "$y$ (mm)", f"$t$ = {1e3 * t:g} ms")
    fig.colorbar(image, ax=list(axes[:, 2]), shrink=0.8, label=r"$\alpha$")
    ax, angles = axes.flat[5], drums.angles(case, case.times)
    ax.plot([float(t) for t in case.times], angles, "k.-")
    for angle in FRICTION:
        ax.axhline(angle, color="0.6", lw=0.8)
    figures.label(ax, "$t$ (s)", "angle (degrees)", "surface, and atan $\\mu$")
    print(f"angle over the last half second {drums.mean_angle(case, None, case.times[-1], 0.5):.1f} degrees", file=sys.stderr)
    script.save(fig, "drum")


if __name__ == "__main__":
    main(script.folder())
