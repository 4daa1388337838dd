# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, velocity and temperature over the height at three phases of the last cycle (Fig. 5 of Shakeri et al.): the gas, and the
grains of ../bouncingBedMD (its profiles.csv); prints how far apart the two are, and how far with the gas raised."""
import sys

import numpy as np

from haff.layers import columns, faraday
from haff.plot import script

folder = script.folder()
grains = columns.read(script.here("..", "bouncingBedMD", "profiles.csv"))
layer = faraday.Layer(folder)
cycle = np.floor(float(layer.case.times[-1]) * layer.frequency - 0.9 + 1e-6)
gas = {phase: columns.profile(layer, layer.case.time((cycle + phase) / layer.frequency)) for phase in grains}
rows = ((r"$\alpha$", lambda p: p["alpha"]), ("$u_y$ (m/s)", lambda p: columns.seen(p, p["U"])),
        ("$T$ (m$^2$/s$^2$)", lambda p: columns.seen(p, p["T"])))
for phase, g in grains.items():
    p = gas[phase]
    top, most = np.argmax(p["alpha"]), np.argmax(g["alpha"])
    raised = ", ".join(f"{columns.difference(p, g, 'alpha', by * 1e-3):.3f}" for by in (0, 0.25, 0.5))
    print(f"{phase:g} T: centre of mass {1e3 * columns.centre(p):.3f} mm, grains {1e3 * columns.centre(g):.3f}; greatest alpha {p['alpha'][top]:.3f}"
          f", grains {g['alpha'][most]:.3f}; T there {p['T'][top]:.3g}, {g['T'][most]:.3g}; alpha in the lowest cell {p['alpha'][0]:.3f}, "
          f"{g['alpha'][0]:.3f}; L1 of alpha with the gas raised by 0, 1/4, 1/2 diameter {raised}; L1 of U "
          f"{columns.difference(p, g, 'U'):.3f}, of T {columns.difference(p, g, 'T'):.3f}", file=sys.stderr)
columns.draw(script.target("bouncingBed"), [(f"{phase:g} $T$", {"gas": gas[phase], "grains": grains[phase]}) for phase in grains],
             rows, 0.04)
