# SPDX-License-Identifier: GPL-3.0-or-later
"""Velocity, packing and pressure over the height in the mean of the last window, beside the gas, and the forces on the floor over time; prints
friction on the floor, and the balance of momentum. If grains have run down rough slopes (Allrun rough), also their mu(I) and packing, the
parameters of the law by a fit, and their velocities beside those of the gas."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.checks import grainCases
from studies.measured import rheology

AREA, GRAVITY, MASS = 2e-4, (4.1459, 8.8909), 1.361356816555577e-6
PARAMETERS = "muStatic", "I0", "alpha at I = 0", "its slope over I"


def sliding(folder):
    case, gas, at = haff.Case(folder), haff.Case(os.path.join(folder, "gas")), grainCases.table_of(folder)
    fig, axes = figures.panels(1, 4, height=2.4)
    rows = {name: rheology.layers(run, run.times[-1:]) for name, run in (("grains", case), ("gas", gas))}
    for ax, key, label in zip(axes[0], ("u", "alpha", "p"), ("$u_x$ (m/s)", r"$\alpha$", "$P_{yy}$ (Pa)")):
        for name, layers in rows.items():
            bed = layers["alpha"] > (0 if key == "alpha" else 0.1)
            ax.plot(layers[key][bed], 1e3 * layers["y"][bed], label=name)
        ax.set_ylim(0, 14)
        figures.label(ax, label, "$y$ (mm)")
    axes[0][0].legend()
    along, down = (at[next(n for n in at if n.endswith(f"_floor_{k}"))] for k in "xy")
    axes[0][3].plot(at["Time"], along / AREA, label="along")
    axes[0][3].plot(at["Time"], -down / AREA, label="down")
    axes[0][3].legend()
    figures.label(axes[0][3], "$t$ (s)", "stress on the floor (Pa)")
    late, mass = at["Time"] > 0.5 * at["Time"][-1], at["grains"][0] * MASS
    gain = np.polyfit(at["Time"][late], at["momentum_x"][late], 1)[0]
    print(f"friction on the floor over the load {along[late].mean() / -down[late].mean():.3f}; load over the weight {-down[late].mean() / (mass * GRAVITY[1]):.4f}; "
          f"gain of momentum over weight along less friction {gain / (mass * GRAVITY[0] - along[late].mean()):.4f}; mean velocity at the end "
          f"{at['momentum_x'][-1] / mass:.3f} m/s", file=sys.stderr)
    for name, a in rows.items():
        print(f"{name}: velocity at the floor {a['u'][0]:.3f} m/s, 7.5 mm above it {np.interp(7.5e-3, a['y'], a['u']):.3f} m/s", file=sys.stderr)
    script.save(fig, "chuteDEM")


def rough(folder):
    flowing, slopes = rheology.measured(folder)
    found = rheology.fit(flowing)
    for slope, row in slopes.items():
        print(f"{slope} degrees: " + ", ".join(f"{name} {v:.4f} +- {e:.4f}" for name, (v, e) in zip(("I", "mu", "alpha"), row)), file=sys.stderr)
    print("fit: " + ", ".join(f"{name} {v:.4f} +- {e:.4f}" for name, (v, e) in zip(PARAMETERS, found)), file=sys.stderr)
    fig, axes = figures.panels(1, 3, height=2.4)
    at = np.linspace(1e-3, 1.1 * max(r[0][0] for r in flowing), 100)
    lines = rheology.law(at, found[0][0], rheology.DYNAMIC, found[1][0]), found[2][0] + found[3][0] * at
    for ax, k, line, label in zip(axes[0], (1, 2), lines, (r"$\mu$", r"$\alpha$")):
        ax.errorbar(*[[r[j][0] for r in slopes.values()] for j in (0, k)], xerr=[r[0][1] for r in slopes.values()], yerr=[r[k][1] for r in slopes.values()], fmt="o", markersize=3)
        ax.plot(at, line)
        figures.label(ax, "$I$", label)
    for colour, slope in zip(figures.COLOURS, ("23", "26")):
        for name, mark in (("rough", "o"), ("gas", "-")):
            run = haff.Case(os.path.join(folder, name + slope))
            a = rheology.layers(run, rheology.late(run) if name == "rough" else run.times[-1:])
            bed = a["alpha"] > 0.3
            axes[0][2].plot(a["u"][bed], 1e3 * a["y"][bed], mark, color=colour, markersize=3, label=f"{'grains' if name == 'rough' else name}, {slope} degrees")
    axes[0][2].legend(fontsize=6)
    figures.label(axes[0][2], "$u_x$ (m/s)", "$y$ (mm)")
    script.save(fig, "muI")


def main(folder):
    sliding(folder)
    if all(os.path.isdir(os.path.join(folder, "rough" + slope)) for slope in rheology.SLOPES):
        rough(folder)


if __name__ == "__main__":
    main(script.folder())
