"""Bow shocks ahead of the cylinder in three gases."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

from haff.studies import shockFigures  # noqa: E402

shockFigures.blunt_body("cylinder.png", "back")
