# SPDX-License-Identifier: GPL-3.0-or-later
"""Bow shocks ahead of the cylinder in three gases."""
from studies import shockFigures

shockFigures.blunt_body("cylinder", "back")
