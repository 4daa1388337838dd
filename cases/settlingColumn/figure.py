# SPDX-License-Identifier: GPL-3.0-or-later
"""The column that settles: centre of mass over time, packing and temperature over the height at the end, with implicit acoustics and
with explicit ones: those of the folder explicit, if Allrun has made it (then explicit.csv is written, too), or those kept in
explicit.csv. Prints both."""
import os
import sys

import numpy as np

from haff.layers import columns, faraday
from haff.plot import figures, script

DIAMETER, GRAVITY = 1e-3, 9.81
MOMENTS = 0.0782, 0.391, 3.91  # of the profiles: one, five and fifty times of free fall through the box


def measured(folder):
    """{moment: {y, alpha, T}}, and (times, heights of the centre of mass in mm)."""
    layer = faraday.Layer(folder)
    times = [t for t in layer.case.times if float(t) > 0]
    heights = [1e3 * columns.centre(columns.profile(layer, t)) for t in times]
    return {t: columns.profile(layer, layer.case.time(t)) for t in MOMENTS}, ([float(t) for t in times], heights)


def keep(path, profiles, course):
    """Rows of profiles; those of the course have y = -1, the time as moment and the height as alpha."""
    with open(path, "w") as f:
        f.write("moment,y,alpha,T\n")
        for t, p in profiles.items():
            f.writelines(f"{t:g},{y:.6g},{a:.8g},{T:.5g}\n" for y, a, T in zip(p["y"], p["alpha"], p["T"]))
        f.writelines(f"{t:.6g},-1,{y:.6g},0\n" for t, y in zip(*course))


def kept(path):
    rows = np.genfromtxt(path, delimiter=",", names=True)
    course, rows = rows[rows["y"] < 0], rows[rows["y"] >= 0]
    return ({t: {n: rows[n][rows["moment"] == t] for n in ("y", "alpha", "T")} for t in MOMENTS}, (course["moment"], course["alpha"]))


def draw(runs):
    fig, axes = figures.panels(1, 3, height=2.5)
    for (name, (profiles, (t, y))), style in zip(runs.items(), ({}, {"marker": ".", "markersize": 3, "linestyle": "none"})):
        axes[0][0].plot(t, y, label=name, **style)
        p = profiles[MOMENTS[-1]]
        axes[0][1].plot(1e3 * p["y"], p["alpha"], **style)
        axes[0][2].semilogy(1e3 * p["y"], p["T"] / (GRAVITY * DIAMETER), **style)
    axes[0][0].set_ylim(7.02, 7.3)
    axes[0][0].legend()
    figures.label(axes[0][0], "$t$ (s)", "centre of mass (mm)")
    figures.label(axes[0][1], "$y$ (mm)", r"$\alpha$", f"$t$ = {MOMENTS[-1]:g} s")
    figures.label(axes[0][2], "$y$ (mm)", r"$T/(g\,d)$", f"$t$ = {MOMENTS[-1]:g} s")
    script.save(fig, "settlingColumn")


def main(folder):
    reference = script.here("explicit.csv")
    if os.path.isdir(os.path.join(folder, "explicit", f"{MOMENTS[-1]:g}")):
        reference = script.target("explicit.csv")
        keep(reference, *measured(os.path.join(folder, "explicit")))
    runs = {"implicit": measured(folder), "explicit": kept(reference)}
    for name, (profiles, _) in runs.items():
        for t, p in profiles.items():
            bed = p["alpha"] > 0.6
            print(f"{name} {t:g} s: centre of mass {1e3 * columns.centre(p):.4f} mm, 1 - alpha/alphaMax {1 - p['alpha'].max() / 0.64:.2e}, T in "
                  f"the bed {np.median(p['T'][bed]) if bed.any() else np.nan:.3g}", file=sys.stderr)
    draw(runs)


if __name__ == "__main__":
    main(script.folder())
