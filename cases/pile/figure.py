# SPDX-License-Identifier: GPL-3.0-or-later
"""The section of the channel: velocity along it and packing at two times, with the secondary flow; profiles of packing in the middle and
centre of mass and greatest velocity over time, also of the variants that Allrun has made. Prints these, and the flow rate."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script

MOMENTS = 0.2, 0.5, 1, 2, 5
SHOWN = 0.3, 5
WIDTH, GRAIN, GRAVITY = 48.0, 1.0, 9810.0  # mm, s
THIN = 0.01  # alpha below which gas is left out of extremes


def section(case, name, t):
    """A field as [rows of y][columns of x] and more."""
    order = np.lexsort(np.round(case.centres[:, :2].T, 9))
    columns = len(np.unique(np.round(case.centres[:, 0], 9)))
    value = case.field(name, t)[order]
    return value.reshape(len(order) // columns, columns, *value.shape[1:])


def over_time(case):
    """t (s), height of the centre of mass (mm), greatest velocity along the channel, that across it (m/s), flow rate (mm^3/s)."""
    rows = []
    for t in case.times:
        if float(t) == 0:
            continue
        alpha, U = case.field("alpha", t), case.field("U", t)
        m, gas = alpha * case.volumes, alpha > THIN
        low, high = case.mesh.points.min(axis=0), case.mesh.points.max(axis=0)
        area = 1e6 * np.prod((high - low)[:2]) / case.volumes.sum() if len(np.unique(np.round(case.centres[:, 0], 9))) > 1 else np.nan
        rows.append((float(t), 1e3 * m @ case.centres[:, 1] / m.sum(), U[gas, 2].max(), np.hypot(U[gas, 0], U[gas, 1]).max(),
                     1e3 * area * m @ U[:, 2]))
    return np.array(rows).T


def maps(axes, case):
    for ax, t in zip(axes, SHOWN):
        time = case.time(t)
        alpha, U = section(case, "alpha", time), section(case, "U", time)
        rows, columns = alpha.shape
        x, y = (np.arange(columns) + 0.5) * WIDTH / columns, (np.arange(rows) + 0.5) * 80 / rows
        speed = np.where(alpha > THIN, U[..., 2], np.nan)
        shown = ax.pcolormesh(x, y, speed, cmap="viridis", vmin=0, shading="auto")
        ax.contour(x, y, alpha, levels=[0.1, 0.3, 0.5, 0.6], colors="w", linewidths=0.6)
        step = max(1, columns // 20)
        gas = alpha[::step, ::step] > THIN
        ax.quiver(x[::step], y[::step], np.where(gas, U[::step, ::step, 0], 0), np.where(gas, U[::step, ::step, 1], 0), color="k", scale=4,
                  width=0.004)
        ax.set_ylim(0, 60)
        ax.set_aspect("equal")
        ax.figure.colorbar(shown, ax=ax, label="$u_z$ (m/s)", shrink=0.8)
        figures.label(ax, "$x$ (mm)", "$y$ (mm)", f"$t$ = {t:g} s")


def main(folder):
    case = haff.Case(folder)
    fig, axes = figures.panels(2, 2, width=8, height=2.9)
    maps(axes[0], case)
    ax = axes[1][0]
    for t in MOMENTS:
        alpha = section(case, "alpha", case.time(t))
        middle = alpha[:, alpha.shape[1] // 2 - 1:alpha.shape[1] // 2 + 1].mean(axis=1)
        ax.plot(middle, (np.arange(len(middle)) + 0.5) * 80 / len(middle), label=f"{t:g} s")
    ax.set_ylim(0, 45)
    ax.legend(fontsize=7)
    figures.label(ax, r"$\alpha$ in the middle", "$y$ (mm)")
    ax, other = axes[1][1], axes[1][1].twinx()
    for name in ("", "explicit", "e07", "cold", "rough"):
        path = os.path.join(folder, name)
        if not os.path.isdir(os.path.join(path, "0.1")):
            continue
        t, height, u, across, flow = over_time(haff.Case(path))
        line, = ax.plot(t, u, label=name or "e = 0.9")
        other.plot(t, height, ":", color=line.get_color())
        for row in zip(t, height, u, across, flow):
            print("{} {:.1f} s: centre of mass {:.3f} mm, u {:.4f} m/s, across {:.4f} m/s, flow {:.4g} mm^3/s; V* {:.2f}, Q* {:.1f}".format(
                name or "pile", *row, 1e3 * row[2] / np.sqrt(GRAVITY * GRAIN), row[4] / WIDTH / np.sqrt(GRAVITY * GRAIN**3)), file=sys.stderr)
    ax.set_xlim(0, None)
    ax.set_ylim(0, None)
    ax.legend(fontsize=7, loc="lower right")
    other.set_ylabel("centre of mass (mm), dotted")
    figures.label(ax, "$t$ (s)", "greatest $u_z$ (m/s)")
    script.save(fig, "pile")


if __name__ == "__main__":
    main(script.folder())
