"""Velocity, temperature and packing across the channel, beside the solution of the steady equations."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

from haff.exact import disks  # noqa: E402
from haff.studies import disksFigures  # noqa: E402

variants = ("$e$ = 1, $g$ = 0.03", "elastic"), ("$e$ = 0.9, $g$ = 0.1", "")
disksFigures.channel("poiseuilleDisks.png", variants, disks.poiseuille, loc="center")
