# SPDX-License-Identifier: GPL-3.0-or-later
"""Velocity, temperature and packing across the channel, beside the solution of the steady equations."""
from studies import disksFigures
from studies.exact import disks

variants = ("$e$ = 1, $g$ = 0.03", "elastic"), ("$e$ = 0.9, $g$ = 0.1", "")
disksFigures.channel("poiseuilleDisks", variants, disks.poiseuille, loc="center")
