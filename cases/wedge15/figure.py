"""The flow over the wedge and the exact oblique shock."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

from haff.studies import shockFigures  # noqa: E402

shockFigures.wedge("wedge15.png")
