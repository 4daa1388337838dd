"""Velocity, temperature and packing between the walls, beside the solution of the steady equations."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

from haff.exact import disks  # noqa: E402
from haff.studies import disksFigures  # noqa: E402

variants = ("$e$ = 1, $U$ = 2", "elastic"), ("$e$ = 0.9, $U$ = 2", ""), ("$e$ = 0.9, $U$ = 4", "fast")
disksFigures.channel("couetteDisks.png", variants, disks.couette, loc="upper left", fontsize=8)
