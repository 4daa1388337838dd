# SPDX-License-Identifier: GPL-3.0-or-later
"""The column at five times: packing; prints run-out, depth at the wall and the speed of what is packed. If the columns of
other heights have run (Allrun all), also what all come to, beside the run-out of experiments."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.checks import heaps

MOMENTS = 0, 0.12, 0.24, 0.36, 0.6
WIDTH = 0.1  # m, of the column at the start
HEIGHTS = {"a0.5": 0.5, ".": 1, "a3": 3, "a7": 7}  # over the width


def describe(case, name, time):
    print(f"{name}: run-out {heaps.run_out(case, None, time, WIDTH):.3f}, depth at the wall {heaps.depth_at(case, None, time, 0) / WIDTH:.3f} widths, "
          f"fastest packed cell {heaps.packed_speed(case, None, time):.2e} m/s", file=sys.stderr)


def panels(case):
    fig, axes = figures.panels(len(MOMENTS), 1, width=5, height=1.1)
    order = np.lexsort(np.round(case.centres[:, :2].T, 9))
    low, high = 1e3 * case.mesh.points.min(axis=0), 1e3 * case.mesh.points.max(axis=0)
    n = len(np.unique(np.round(case.centres[:, 0], 9)))
    for (ax,), t in zip(axes, MOMENTS):
        time = case.time(t)
        alpha = case.field("alpha", time)
        image = ax.imshow(alpha[order].reshape(-1, n), origin="lower", extent=(low[0], high[0], low[1], high[1]), vmin=0, vmax=0.64, cmap="magma_r")
        figures.label(ax, "$x$ (mm)" if t == MOMENTS[-1] else "", "$y$ (mm)", f"$t$ = {1e3 * t:g} ms")
        describe(case, f"{t:g} s", time)
    fig.colorbar(image, ax=axes, shrink=0.8, label=r"$\alpha$")
    script.save(fig, "columnCollapse")


def correlation(a):
    """Run-out over the width in channels (Lube et al. 2005; Lajeunesse, Monnier & Homsy 2005)."""
    return np.where(a < 2.3, 1.2 * a, 1.9 * a ** (2 / 3))


def outlines(cases):
    fig, axes = figures.panels(1, 2, width=9, height=3)
    deposits, runs = axes[0]
    a = np.geomspace(0.3, 10, 200)
    runs.loglog(a, correlation(a), "k", label="experiments in channels")
    for height, case in cases.items():
        time = case.times[-1]
        x, depth, _ = heaps.depths(case, time)
        line, = deposits.plot(x / WIDTH, depth / WIDTH, label=f"$a$ = {height:g}")
        deposits.plot(1 + correlation(np.array(height)), 0, "^", color=line.get_color(), clip_on=False)
        runs.plot(height, heaps.run_out(case, None, time, WIDTH), "o", color=line.get_color())
        describe(case, f"a = {height:g}", time)
    figures.label(deposits, "$x/L_0$", "depth$/L_0$", "at the end; triangles: fronts of experiments")
    figures.label(runs, "$a$", "run-out$/L_0$", "")
    deposits.legend()
    runs.legend()
    script.save(fig, "outlines")


def main(folder):
    panels(haff.Case(folder))
    paths = {height: os.path.join(folder, name) for name, height in HEIGHTS.items()}
    if all(os.path.isdir(path) for path in paths.values()):
        outlines({height: haff.Case(path) for height, path in paths.items()})


if __name__ == "__main__":
    main(script.folder())
