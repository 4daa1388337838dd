# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinetic stress of the gas around the wedge and the concentration of small grains in it, and both across the layer."""
import sys

import numpy as np

import haff
from haff.plot import figures, script

SHOWN, SECTION = (3, 10, 0, 7), 8  # cm: the part of the domain that is drawn; where the profiles are
gas, mixture = haff.Case(script.folder("gas")), haff.Case(script.folder())
x, y = np.round(mixture.centres[:, :2], 9).T
h = np.unique(x)[1] - np.unique(x)[0]
stress = gas.field("rho", 0.0425) * gas.field("T", 0.0425) / 1910  # cm^2/s^2, per density of the grains
phi = mixture.field("phi", 0.2)
fig, axes = figures.panels(1, 3, width=9.0, height=3.4)


def show(ax, values, title, **options):
    grid = np.full((np.unique(y).size, np.unique(x).size), np.nan)
    grid[np.floor(y / h).astype(int), np.floor(x / h).astype(int)] = values
    picture = ax.pcolormesh(np.unique(x), np.unique(y), grid, rasterized=True, **options)
    fig.colorbar(picture, ax=ax, location="bottom", label=title, shrink=0.9)
    ax.axvline(SECTION, ymin=5 / 7, color="0.6", linewidth=0.6, linestyle=":")
    ax.set(aspect="equal", xlim=SHOWN[:2], ylim=SHOWN[2:], facecolor="0.75")
    figures.label(ax, "$x$ (cm)", "$y$ (cm)")


show(axes[0][0], stress, r"kinetic stress $\rho T/\rho_s$ (cm$^2$ s$^{-2}$)", cmap="magma")
show(axes[0][1], phi, r"fraction of small grains $\phi$", cmap="RdBu_r", vmin=0, vmax=1)
column = np.flatnonzero(np.floor(x / h) == np.floor(SECTION / h))
column = column[np.argsort(y[column])]
last = axes[0][2]
last.plot(phi[column], y[column], ".-", markersize=3, label=r"$\phi$")
last.plot(stress[column] / stress.max(), y[column], ".-", markersize=3, label="stress / largest")
last.set(xlim=(0, 1), ylim=(5, 7))
last.legend()
figures.label(last, "", "$y$ (cm)", f"$x$ = {SECTION} cm (dotted)")
place = {(a, b): p for a, b, p in zip(np.round(x, 6), np.round(y, 6), phi)}
mirror = max(abs(p - place[round(10 - b, 6), round(10 - a, 6)]) for (a, b), p in place.items())
print(f"phi {phi.min():.4f} .. {phi.max():.4f}; at the wall at x = 8 {phi[column][0]:.4f}; "
      f"difference to the mirror image {mirror:.1e}", file=sys.stderr)
script.save(fig, "segregationWedge")
