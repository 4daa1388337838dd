"""Volume-fraction contours: a row of Fig. 8 of Serna & Marquina."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import contours  # noqa: E402
import figures  # noqa: E402
import haff  # noqa: E402

contours.figure([haff.Case(figures.folder())], os.path.join(figures.folder(), "wedgeDense.png"))
