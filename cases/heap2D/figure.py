# SPDX-License-Identifier: GPL-3.0-or-later
"""The heap at five times: packing over a floor without friction (above), over a rough one, and of grains that rub; prints centre of mass and
energies."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script

MOMENTS = 0, 0.03, 0.05, 0.07, 0.1


def numbers(name, case):
    for t in case.times:
        if not float(t):
            continue
        alpha, U, T = (case.field(n, t) for n in ("alpha", "U", "T"))
        m = alpha * case.volumes / (alpha @ case.volumes)
        x, y = 1e3 * m @ case.centres[:, :2]
        print(f"{name} {t} s: centre of mass ({x:.3f} {y:.3f}) mm, energy of motion {m @ (U ** 2).sum(axis=1) / 2:.4e} m^2/s^2, heat "
              f"{1.5 * m @ T:.3e}, greatest alpha {alpha.max():.7f}", file=sys.stderr)


def main(folder):
    rows = ("smooth floor", ""), ("rough floor", "rough"), ("friction", "friction")
    fig, axes = figures.panels(len(rows), len(MOMENTS), width=9, height=1.45)
    for row, (line, (name, copy)) in enumerate(zip(axes, rows)):
        case = haff.Case(os.path.join(folder, copy))
        numbers(name, case)
        order = np.lexsort(np.round(case.centres[:, :2].T, 9))
        low, high = 1e3 * case.mesh.points.min(axis=0), 1e3 * case.mesh.points.max(axis=0)
        n = len(np.unique(np.round(case.centres[:, 0], 9)))
        for ax, t in zip(line, MOMENTS):
            alpha = case.field("alpha", case.time(t))
            image = ax.imshow(alpha[order].reshape(-1, n), origin="lower", extent=(low[0], high[0], low[1], high[1]), vmin=0, vmax=0.64,
                              cmap="magma_r")
            figures.label(ax, "$x$ (mm)" if row == len(rows) - 1 else "", f"{name}\n$y$ (mm)" if t == 0 else "",
                          f"$t$ = {1e3 * t:g} ms" if not row else None)
    fig.colorbar(image, ax=axes, shrink=0.8, label=r"$\alpha$")
    script.save(fig, "heap2D")


if __name__ == "__main__":
    main(script.folder())
