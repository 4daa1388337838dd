# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks shipped cases: runs them in full, and has the quantities that only they check."""
