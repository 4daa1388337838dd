# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes meshes and cases for studies and tests."""
