# SPDX-License-Identifier: GPL-3.0-or-later
"""What postprocessing/studies/crossCheck.py needs to know of this case."""
GRIDS, QUICK, FINE, COURANT = (50, 100, 200), (20, 40), 400, 0.05
LINES = {"above": ((0.15, 0.8, 0), (0.45, 0.8, 0)), "below": ((0.2, 0.1, 0), (0.5, 0.1, 0)), "jet": ((0.15, 0.15, 0), (0.37, 0.37, 0))}
