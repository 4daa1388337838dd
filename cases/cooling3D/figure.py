# SPDX-License-Identifier: GPL-3.0-or-later
"""The gas beside the grains of ../cooling3DMD: Haff's law, impacts, spectra; and the clusters of both as clouds."""
import os

import matplotlib
import numpy as np
from scipy.ndimage import gaussian_filter

from haff.plot import clouds, script
from studies.measured import clustering

LOW, HIGH = 0.13, 0.36  # packing that begins to be seen, and that is seen best
folder, kept = script.folder(), script.here("..", "cooling3DMD")
clustering.draw(folder, kept, script.target("cooling3D"), (500, 3000, 20000))

box = clustering.Box(folder)
with np.load(os.path.join(kept, "density.npz")) as f:
    counts, time = f["counts"].astype(float), float(f["time"])
gas, grains = box.cells(box.case.time(time))[0], gaussian_filter(counts, 0.6, mode="wrap") / counts.mean()
both = [clouds.picture(box.alpha * rho, LOW, HIGH, fine=max(1, 192 // len(rho))) for rho in (gas, grains)]
matplotlib.image.imsave(script.target("clusters"), np.hstack(both))
print(script.target("clusters"))
