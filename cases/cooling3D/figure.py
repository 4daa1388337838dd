"""The gas beside the grains of ../cooling3DMD: Haff's law, impacts, spectra; and the clusters of both as clouds."""
import os
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "postprocessing"))

import matplotlib  # noqa: E402
import numpy as np  # noqa: E402
from scipy.ndimage import gaussian_filter  # noqa: E402

from haff.plot import clouds, figures  # noqa: E402
from haff.studies import clustering  # noqa: E402

LOW, HIGH = 0.13, 0.36  # packing that begins to be seen, and that is seen best
folder, kept = figures.folder(), os.path.join(here, "..", "cooling3DMD")
clustering.draw(folder, kept, os.path.join(folder, "cooling3D.png"), (500, 3000, 20000))

box = clustering.Box(folder)
with np.load(os.path.join(kept, "density.npz")) as f:
    counts, time = f["counts"].astype(float), float(f["time"])
gas, grains = box.cells(box.case.time(time))[0], gaussian_filter(counts, 0.6, mode="wrap") / counts.mean()
both = [clouds.picture(box.alpha * rho, LOW, HIGH, fine=max(1, 192 // len(rho))) for rho in (gas, grains)]
matplotlib.image.imsave(os.path.join(folder, "clusters.png"), np.hstack(both))
print(os.path.join(folder, "clusters.png"))
