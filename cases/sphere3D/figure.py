"""Bow shocks ahead of the sphere in three gases: the plane of symmetry."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

from haff.studies import shockFigures  # noqa: E402

shockFigures.blunt_body("sphere3D.png", "symmetryBottom")
