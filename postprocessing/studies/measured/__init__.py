# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures results of shipped cases and studies."""
