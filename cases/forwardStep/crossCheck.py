# SPDX-License-Identifier: GPL-3.0-or-later
"""What postprocessing/studies/crossCheck.py needs to know of this case."""
GRIDS, QUICK, FINE = (15, 30, 60), (15, 30), 120
LINES = {"bow": ((0.05, 0.1, 0), (0.5, 0.1, 0)), "stem": ((0.3, 0.95, 0), (0.9, 0.95, 0)), "reflected": ((2, 0.35, 0), (2, 0.98, 0))}
