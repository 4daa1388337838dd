# SPDX-License-Identifier: GPL-3.0-or-later
"""The flow over the wedge and the exact oblique shock."""
from studies import shockFigures

shockFigures.wedge("wedge15Dilute")
