"""Kinetic stress of the gas around the wedge and the concentration of small grains in it, and both across the layer."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script

folder = script.folder()
gas, mixture = haff.Case(os.path.join(folder, "gas")), haff.Case(folder)
x, y = np.round(mixture.centres[:, :2], 9).T
h = np.unique(x)[1] - np.unique(x)[0]
stress = gas.field("rho", 0.0425) * gas.field("T", 0.0425) / 1910  # cm^2/s^2, per density of the grains
phi = mixture.field("phi", 0.2)
fig, axes = figures.panels(1, 3, width=9.0, height=2.6)


def show(ax, values, title, **options):
    grid = np.full((np.unique(y).size, np.unique(x).size), np.nan)
    grid[np.floor(y / h).astype(int), np.floor(x / h).astype(int)] = values
    picture = ax.pcolormesh(np.unique(x), np.unique(y), grid, rasterized=True, **options)
    fig.colorbar(picture, ax=ax)
    ax.set_aspect("equal")
    figures.label(ax, "$x$ (cm)", "$y$ (cm)", title)


show(axes[0][0], stress, r"$\rho T/\rho_s$ (cm$^2$ s$^{-2}$)", cmap="magma")
show(axes[0][1], phi, r"$\phi$", cmap="RdYlBu_r", vmin=0, vmax=1)
column = np.flatnonzero(np.floor(x / h) == np.floor(8 / h))
column = column[np.argsort(y[column])]
last = axes[0][2]
last.plot(y[column], phi[column], label=r"$\phi$")
last.plot(y[column], stress[column] / stress.max(), label="stress / largest")
last.set_xlim(5, 6.5)
last.legend()
figures.label(last, "$y$ (cm)", "", "$x = 8$ cm")
place = {(a, b): p for a, b, p in zip(np.round(x, 6), np.round(y, 6), phi)}
mirror = max(abs(p - place[round(10 - b, 6), round(10 - a, 6)]) for (a, b), p in place.items())
print(f"phi {phi.min():.4f} .. {phi.max():.4f}; at the wall at x = 8 {phi[column][0]:.4f}; "
      f"difference to the mirror image {mirror:.1e}", file=sys.stderr)
script.save(fig, "segregationWedge")
