"""Energy of the grains beside Haff's law and their impacts; spectra of this run beside the kept ones. Beside the gas: ../coolingDisks."""
import os
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "postprocessing"))

from haff.plot import figures  # noqa: E402
from haff.studies import clustering  # noqa: E402

folder = figures.folder()
clustering.draw_grains(folder, here, os.path.join(folder, "coolingDisksMD.png"), (100, 500, 4000))
