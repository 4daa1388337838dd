# SPDX-License-Identifier: GPL-3.0-or-later
"""Bow shocks ahead of the sphere in three gases: the plane of symmetry."""
from studies import shockFigures

shockFigures.blunt_body("sphere3D", "symmetryBottom")
