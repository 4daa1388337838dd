"""The gas that begins with the noise of the grains (fromGrains, made by Allrun) beside these grains, ../coolingDisksMD."""
import os
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "postprocessing"))

from haff.plot import figures  # noqa: E402
from haff.studies import clustering  # noqa: E402

folder = figures.folder()
clustering.draw(os.path.join(folder, "fromGrains"), os.path.join(here, "..", "coolingDisksMD"), os.path.join(folder, "besideGrains.png"),
                (100, 500, 4000))
