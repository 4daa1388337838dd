# SPDX-License-Identifier: GPL-3.0-or-later
"""p/(n T) of disks and spheres: runs of granularMD in sweep/, the numbers in sweep/elastic.csv (d, packing, p/(n T), its
standard error) and sweep/inelastic.csv (d, packing, restitution, p/(n T), its standard error)."""
import os
import sys

import numpy as np

from haff.start import enskog
from studies.made import homogeneous

HERE = os.path.dirname(os.path.abspath(__file__))
ELASTIC = {2: (0.1, 0.2, 0.3, 0.4, 0.5, 0.55, 0.6, 0.65), 3: (0.1, 0.2, 0.3, 0.4, 0.45, 0.49)}
INELASTIC = {2: (0.1, 0.3, 0.5, 0.6), 3: (0.1, 0.2, 0.3, 0.4)}
folder = os.path.join(HERE, "sweep")
run = os.path.join(folder, "run")
os.makedirs(folder, exist_ok=True)


def say(d, packing, e, z, error):
    theory = enskog.pressure_factor(packing, e, d, enskog.simulated)
    print(f"d = {d}, packing {packing:.2f}, e = {e:.1f}: p/(n T) = {z:.4f} +- {error:.4f}, {100 * (z / theory - 1):+.2f} %",
          file=sys.stderr)


rows = []
for d in (2, 3):
    for packing in ELASTIC[d]:
        rows.append((d, packing, *homogeneous.compressibility(run, HERE, d, packing, 4000, 800)))
        say(d, packing, 1, *rows[-1][2:])
np.savetxt(os.path.join(folder, "elastic.csv"), rows, "%.6g", ",", header="d, packing, p/(n T), standard error")
rows = []
for d in (2, 3):
    for e in (0.9, 0.7):
        for packing in INELASTIC[d]:
            z = [homogeneous.cooling_pressure(run, HERE, d, packing, e, 20000, 1 + s) for s in range(4)]
            rows.append((d, packing, e, np.mean(z), np.std(z, ddof=1) / 2))
            say(d, packing, e, *rows[-1][3:])
np.savetxt(os.path.join(folder, "inelastic.csv"), rows, "%.6g", ",", header="d, packing, restitution, p/(n T), standard error")
