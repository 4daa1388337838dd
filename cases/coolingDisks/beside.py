# SPDX-License-Identifier: GPL-3.0-or-later
"""The gas that begins with the noise of the grains (fromGrains, made by Allrun) beside these grains, ../coolingDisksMD."""
from haff.plot import script
from studies.measured import clustering

clustering.draw(script.folder("fromGrains"), script.here("..", "coolingDisksMD"), script.target("besideGrains"), (100, 500, 4000))
