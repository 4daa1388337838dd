# SPDX-License-Identifier: GPL-3.0-or-later
"""The silo at four times, and what flows through its orifice over time beside Torricelli's law; with implicit acoustics, with explicit
ones, on triangles, and of grains that rub: what Allrun has made in the folders explicit, triangles and friction (written as .csv files of
these names, too), or what is kept in these tables. Prints the flow."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script

WIDTH, HEIGHT, ORIFICE, PACKING, GRAVITY, CELL = 32.0, 40.0, 8.0, 0.64, 9810.0, 1.0  # mm, s
MOMENTS = 0.01, 0.1, 0.2, 0.3


def held(case):
    """Times (s), and what is left above the plate at packing 0.64 (mm^2)."""
    times = [t for t in case.times if float(t) > 0]
    above = case.centres[:, 1] > 0
    volume = case.volumes[above]
    left = [case.field("alpha", t)[above] @ volume / volume.sum() * WIDTH * HEIGHT / PACKING for t in times]
    return np.array([float(t) for t in times]), np.array(left)


def flow(times, left):
    """Middle times, flow (mm^2/s) and mean head between written times (mm)."""
    return (times[1:] + times[:-1]) / 2, -np.diff(left) / np.diff(times), (left[1:] + left[:-1]) / 2 / WIDTH


def picture(ax, case, t):
    x, y = 1e3 * case.centres[:, :2].T
    column, row = (np.round((v - v.min()) / CELL).astype(int) for v in (x, y))
    image = np.full((row.max() + 1, column.max() + 1), np.nan)
    image[row, column] = case.field("alpha", case.time(t))
    shown = ax.imshow(image, origin="lower", extent=(-WIDTH / 2, WIDTH / 2, y.min() - CELL / 2, y.max() + CELL / 2), vmin=0,
                      vmax=PACKING, cmap="magma_r")
    ax.set_facecolor("0.6")
    figures.label(ax, "$x$ (mm)", "$y$ (mm)" if t == MOMENTS[0] else "", f"$t$ = {1e3 * t:g} ms")
    return shown


def kept(folder, copy, end):
    """held() of a copy of the case, by way of its .csv file."""
    table = script.here(copy + ".csv")
    if os.path.isdir(os.path.join(folder, copy, end)):
        table = script.target(copy + ".csv")
        with open(table, "w") as f:
            f.write("time,left\n")
            f.writelines(f"{t:g},{v:.6g}\n" for t, v in zip(*held(haff.Case(os.path.join(folder, copy)))))
    read = np.genfromtxt(table, delimiter=",", names=True)
    return read["time"], read["left"]


def main(folder):
    case = haff.Case(folder)
    t, rate, head = flow(*held(case))
    fig, axes = figures.panels(1, len(MOMENTS) + 1, width=9, height=2.6)
    for ax, moment in zip(axes[0], MOMENTS):
        shown = picture(ax, case, moment)
    fig.colorbar(shown, ax=axes[0][:-1], shrink=0.8, label=r"$\alpha$", location="left")
    ideal = ORIFICE * np.sqrt(2 * GRAVITY * head)
    for moment, q, h, one in zip(t, rate, head, rate / ideal):
        print(f"{moment:.3f} s: {q:.0f} mm^2/s, head {h:.2f} mm, {one:.3f} of Torricelli's", file=sys.stderr)
    others = [(word, *flow(*kept(folder, copy, end))) for word, copy, end in
              (("explicit", "explicit", "0.06"), ("on triangles", "triangles", "0.2"), ("friction", "friction", "0.16"))]
    late = t > 0.05
    share = float((rate / ideal)[late].mean())
    ax = axes[0][-1]
    ax.plot(t, rate, label="implicit")
    for marker, (word, middle, other, left) in zip(".+x", others):
        ax.plot(middle, other, marker, label=word)
        for moment, q, h in zip(middle, other, left):
            print(f"{word}, {moment:.3f} s: {q:.0f} mm^2/s, head {h:.2f} mm", file=sys.stderr)
    ax.plot(t[late], share * ideal[late], ":", label=rf"{share:.2f} $D\sqrt{{2 g h}}$")
    ax.set_ylim(0, None)
    ax.legend(fontsize=7, loc="lower left")
    figures.label(ax, "$t$ (s)", "flow (mm$^2$/s)")
    script.save(fig, "hopper")


if __name__ == "__main__":
    main(script.folder())
