# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads cases: meshes, fields, tables, grains. Needs numpy only."""
