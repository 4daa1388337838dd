"""Density at the end."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import haff  # noqa: E402
from haff.plot import figures  # noqa: E402
from haff.studies import crossCheckFigures  # noqa: E402

crossCheckFigures.density(haff.Case(figures.folder()), os.path.join(figures.folder(), "forwardStep.png"))
