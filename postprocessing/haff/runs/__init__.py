# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes, runs and compares cases."""
