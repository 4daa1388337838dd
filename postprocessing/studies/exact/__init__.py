# SPDX-License-Identifier: GPL-3.0-or-later
"""References written independently of the solver: exact solutions, equations of state, closures."""
