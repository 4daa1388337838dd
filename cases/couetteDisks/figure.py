# SPDX-License-Identifier: GPL-3.0-or-later
"""Velocity, temperature and packing between the walls, beside the solution of the steady equations."""
from studies import disksFigures
from studies.exact import disks

variants = ("$e$ = 1, $U$ = 2", "elastic"), ("$e$ = 0.9, $U$ = 2", ""), ("$e$ = 0.9, $U$ = 4", "fast")
disksFigures.channel("couetteDisks", variants, disks.couette, loc="upper left", fontsize=8)
