# SPDX-License-Identifier: GPL-3.0-or-later
"""The rate of cooling of disks and spheres over that of Enskog's theory: runs of granularMD in sweep/, the numbers in
sweep/rates.csv (d, packing, restitution, mean over the seeds, its standard error)."""
import os
import sys

import numpy as np

from studies.made import homogeneous

HERE = os.path.dirname(os.path.abspath(__file__))
SEEDS, GRAINS = 4, 10000
folder = os.path.join(HERE, "sweep")
os.makedirs(folder, exist_ok=True)
rows = []
for d in (2, 3):
    for e in (0.9, 0.95):
        for packing in (0.05, 0.1, 0.2, 0.3):
            found = [homogeneous.cooling(os.path.join(folder, "run"), HERE, d, packing, e, GRAINS, 1 + s) for s in range(SEEDS)]
            rows.append((d, packing, e, np.mean(found), np.std(found, ddof=1) / np.sqrt(SEEDS)))
            print("d = %d, packing %.2f, e = %.2f: rate of cooling / Enskog's %.4f +- %.4f" % rows[-1], file=sys.stderr)
np.savetxt(os.path.join(folder, "rates.csv"), rows, "%.6g", ",", header="d, packing, restitution, rate over Enskog's, standard error")
