# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures layers on a plate, of gas and of grains: profiles over the height, patterns."""
