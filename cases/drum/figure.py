# SPDX-License-Identifier: GPL-3.0-or-later
"""The column at five times: packing; prints run-out, depth at the wall and the speed of what is packed."""
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.checks import heaps

MOMENTS = 0, 0.06, 0.09, 0.15, 0.3
WIDTH = 0.024  # m, of the column at the start


def main(folder):
    case = haff.Case(folder)
    fig, axes = figures.panels(len(MOMENTS), 1, width=5, height=1.1)
    order = np.lexsort(np.round(case.centres[:, :2].T, 9))
    low, high = 1e3 * case.mesh.points.min(axis=0), 1e3 * case.mesh.points.max(axis=0)
    n = len(np.unique(np.round(case.centres[:, 0], 9)))
    for (ax,), t in zip(axes, MOMENTS):
        time = case.time(t)
        alpha = case.field("alpha", time)
        image = ax.imshow(alpha[order].reshape(-1, n), origin="lower", extent=(low[0], high[0], low[1], high[1]), vmin=0, vmax=0.64, cmap="magma_r")
        figures.label(ax, "$x$ (mm)" if t == MOMENTS[-1] else "", "$y$ (mm)", f"$t$ = {1e3 * t:g} ms")
        print(f"{t:g} s: run-out {heaps.run_out(case, None, time, WIDTH):.3f}, depth at the wall {heaps.depth_at(case, None, time, 0) / WIDTH:.3f} widths, "
              f"fastest packed cell {heaps.packed_speed(case, None, time):.2e} m/s", file=sys.stderr)
    fig.colorbar(image, ax=axes, shrink=0.8, label=r"$\alpha$")
    script.save(fig, "columnCollapse")


if __name__ == "__main__":
    main(script.folder())
