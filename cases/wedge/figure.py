# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume-fraction contours: a row of Fig. 8 of Serna & Marquina."""
import haff
from haff.plot import contours, script

contours.figure([haff.Case(script.folder())], script.target("wedge"))
