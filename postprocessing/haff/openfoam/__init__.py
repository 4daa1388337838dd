# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads cases of OpenFOAM's compressible solvers and writes them as cases of haff."""
