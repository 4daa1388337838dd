# SPDX-License-Identifier: GPL-3.0-or-later
"""cases/vortices and cases/piston on coarse grids: the growth of a wave in a gas that cools, and a shock ahead of a piston."""
import unittest

from tests.cases import harness


class Short(harness.Folder, unittest.TestCase):
    def test_vortices(self):
        """In the box of 31 the wave grows as linear theory says, to 0.02 of the rate of cooling."""
        case = self.short("vortices", 16)
        self.compare(case, harness.entries("vortices"))

    def test_piston(self):
        """An elastic shock has the speed of mass, momentum and energy across it."""
        case = harness.copy("piston", self.folder)
        harness.edit(case, "constant/granularProperties", restitution=1, thresholdSpeed=0)
        harness.mesh(case, 200)
        self.compare(harness.run(case, endTime=100), harness.entries("piston"))


if __name__ == "__main__":
    unittest.main()
