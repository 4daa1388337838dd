# SPDX-License-Identifier: GPL-3.0-or-later
"""The studies behind the figures and reports of the papers."""
