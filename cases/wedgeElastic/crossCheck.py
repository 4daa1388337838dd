# SPDX-License-Identifier: GPL-3.0-or-later
"""What postprocessing/studies/crossCheck.py needs to know of this case."""
GRIDS, QUICK, FINE = (50, 100, 200), (20, 40), 400
LINES = {"corner": ((3.5, 6.5, 0), (4.95, 5.05, 0)), "x = 7": ((7, 7.5, 0), (7, 5.2, 0)), "x = 9": ((9, 8, 0), (9, 5.3, 0))}
