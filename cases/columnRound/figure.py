# SPDX-License-Identifier: GPL-3.0-or-later
"""Half of the column at five times: packing. If the columns of other heights have run (Allrun all), also the outlines of the
heaps beside the run-outs of experiments; prints run-out, depth on the axis and the speed of what is packed."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.checks import heaps

MOMENTS = 0, 0.12, 0.24, 0.36, 0.6  # s
RADIUS = 0.1  # m, of the column at the start
HEIGHTS = {"a0.5": 0.5, ".": 1, "a3": 3}  # over the radius


def correlation(a):
    """Run-out over the radius (Lube, Huppert, Sparks & Hallworth 2004)."""
    return np.where(a < 1.7, 1.24 * a, 1.6 * a ** 0.5)


def outlines(cases):
    fig, ((ax,),) = figures.panels(1, 1, width=6, height=3)
    for height, case in cases.items():
        time = case.times[-1]
        r, depth, _ = heaps.depths(case, time)
        line, = ax.plot(r / RADIUS, depth / RADIUS, label=f"$a$ = {height:g}")
        ax.plot(1 + correlation(np.array(height)), 0, "^", color=line.get_color(), clip_on=False)
        print(f"a = {height:g}: run-out {heaps.run_out(case, None, time, RADIUS):.3f}, depth on the axis {depth[0] / RADIUS:.3f} radii, "
              f"fastest packed cell {heaps.packed_speed(case, None, time):.2e} m/s", file=sys.stderr)
    figures.label(ax, "$r/r_0$", "depth$/r_0$", "at the end; triangles: fronts of experiments")
    ax.legend()
    script.save(fig, "outlines")


def main(folder):
    script.save(figures.packing_at(haff.Case(folder), MOMENTS, width=5, height=1.2, across=False), "columnRound")
    paths = {height: os.path.join(folder, name) for name, height in HEIGHTS.items()}
    if all(os.path.isdir(path) for path in paths.values()):
        outlines({height: haff.Case(path) for height, path in paths.items()})


if __name__ == "__main__":
    main(script.folder())
