# SPDX-License-Identifier: GPL-3.0-or-later
"""Density at the end."""
import haff
from haff.plot import script
from studies import crossCheckFigures

crossCheckFigures.density(haff.Case(script.folder()), script.target("vortex"))
