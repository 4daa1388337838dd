# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, velocity and temperature over the height at three phases, soft grains with friction beside the smooth hard ones of
../bouncingBedMD and the gas of ../bouncingBed (their profiles.csv), means over the cycles from the second on; prints the centres of mass."""
import sys

import numpy as np

from haff.layers import columns, faraday
from haff.plot import script

SETTLED, PHASES = 2, (0.3, 0.6, 0.9)
layer = faraday.Layer(script.folder())
hard = columns.read(script.here("..", "bouncingBedMD", "profiles.csv"))
gas = columns.read(script.here("..", "bouncingBed", "profiles.csv"))
beds = columns.at(layer.case, PHASES, SETTLED)
for phase, p in beds.items():
    g = hard[phase]
    print(f"{phase:g} T: centre of mass {1e3 * columns.centre(p):.3f} mm, hard grains {1e3 * columns.centre(g):.3f}, gas {1e3 * columns.centre(gas[phase]):.3f}; greatest alpha {p['alpha'].max():.3f} at "
          f"{1e3 * p['y'][np.argmax(p['alpha'])]:.1f} mm, hard {g['alpha'].max():.3f}; L1 of alpha {columns.difference(p, g, 'alpha'):.3f}", file=sys.stderr)
columns.draw(script.target("bouncingBedDEM"), [(f"{phase:g} $T$", {"gas": gas[phase], "hard grains": hard[phase], "soft, rough grains": beds[phase]}) for phase in PHASES],
             ((r"$\alpha$", lambda p: p["alpha"]), ("$u_y$ (m/s)", lambda p: columns.seen(p, p["U"])), ("$T$ (m$^2$/s$^2$)", lambda p: columns.seen(p, p["T"]))), 0.04)
