"""Volume-fraction contours: a row of Fig. 8 of Serna & Marquina."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import haff  # noqa: E402
from haff.plot import contours, figures  # noqa: E402

contours.figure([haff.Case(figures.folder())], os.path.join(figures.folder(), "wedgeDense.png"))
