# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, velocity, energy (Fig. 3 of Shakeri et al.) and temperature (Fig. 4) over the height at 50, 100 and 150 ms: the gas, and
the grains of ../sedimentationMD (its profiles.csv); prints how far apart the two are."""
import sys

import numpy as np

from haff.layers import columns
from haff.plot import script

DENSITY = 2600.0
folder = script.folder()
grains = columns.read(script.here("..", "sedimentationMD", "profiles.csv"))
gas = columns.at(folder, list(grains))
rows = ((r"$\alpha$", lambda p: p["alpha"]), ("$u_y$ (m/s)", lambda p: columns.seen(p, p["U"])),
        (r"$\rho(u^2 + 3T)/2$ (J/m$^3$)", lambda p: DENSITY * columns.energy(p)),
        ("$T$ (m$^2$/s$^2$)", lambda p: columns.seen(p, p["T"])))
for t, g in grains.items():
    far = {name: columns.difference(gas[t], g, of) for name, of in (("alpha", "alpha"), ("U", "U"), ("energy", columns.energy), ("T", "T"))}
    ratio = columns.seen(g, columns.ratio(g))
    print(f"t = {1e3 * t:g} ms: centre of mass {1e3 * columns.centre(gas[t]):.2f} mm, grains {1e3 * columns.centre(g):.2f}; L1 differences "
          + ", ".join(f"{name} {value:.3f}" for name, value in far.items())
          + f"; alpha of the gas raised by 0.25 mm {columns.difference(gas[t], g, 'alpha', 0.25e-3):.3f}; Ty/Txz of the grains "
          f"{np.nanmin(ratio):.2f} .. {np.nanmax(ratio):.2f} at {1e3 * g['y'][np.nanargmax(ratio)]:.1f} mm", file=sys.stderr)
columns.draw(script.target("sedimentation"),
             [(f"$t$ = {1e3 * t:g} ms", {"gas": gas[t], "grains": grains[t]}) for t in grains], rows, 0.1)
