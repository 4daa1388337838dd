# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, velocity and the components of T over the height at three phases, means over the cycles from the fourth on; prints
the centres of mass and how they scatter from cycle to cycle. Beside the gas: ../bouncingBed."""
import sys

import numpy as np

from haff.layers import columns, faraday
from haff.plot import script

SETTLED, PHASES = 4, (0.3, 0.6, 0.9)
folder = script.folder()
layer = faraday.Layer(folder)
written = layer.phases(SETTLED)
beds = columns.at(layer.case, PHASES, SETTLED)
for phase, p in beds.items():
    names = written[min(written, key=lambda k: abs(k - phase))][1]
    centres = [1e3 * columns.centre(columns.profile(layer, name)) for name in names]
    print(f"{phase:g} T: centre of mass {np.mean(centres):.3f} +- {np.std(centres):.3f} mm ({len(centres)} cycles), greatest alpha "
          f"{p['alpha'].max():.3f} at {1e3 * p['y'][np.argmax(p['alpha'])]:.1f} mm, in the lowest cells {p['alpha'][0]:.3f}, "
          f"{p['alpha'][1]:.3f}", file=sys.stderr)


def part(axis):
    return lambda p: columns.seen(p, p[axis])


columns.draw(script.target("bouncingBedMD"), [(f"{phase:g} $T$", {"": p}) for phase, p in beds.items()],
             ((r"$\alpha$", lambda p: p["alpha"]), ("$u_y$ (m/s)", part("U")), ("$T_y$ (m$^2$/s$^2$)", part("Ty")),
              ("$T_x$ (m$^2$/s$^2$)", part("Tx"))), 0.04)
