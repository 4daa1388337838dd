# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas that falls on a wall: the way through its collapse; what the threshold changes. Packing and mass before: tests/cases/test_variants.py."""
import unittest

import numpy as np

from tests.cases import harness

PROPERTIES = "constant/granularProperties"


class Wall(harness.Folder, unittest.TestCase):
    def test_threshold_matters_in_the_cluster_only(self):
        """Away from the cluster a threshold ten times less changes a hundred times less, or nearly so."""
        rho = {}
        for threshold in (3, 10, 30):
            case = harness.copy("wall", self.folder)
            harness.edit(case, PROPERTIES, thresholdSpeed=threshold)
            harness.mesh(case, 250)
            result = harness.run(case, endTime=0.25, writeInterval=0.25)
            rho[threshold], alpha = (result.field(name) for name in ("rho", "alpha"))
            self.assertLess(alpha.max(), 0.65)
        away = rho[3] < 0.5 / (np.pi / 6 * 0.1**3)
        change = [np.abs(rho[v] - rho[3])[away].sum() / rho[3][away].sum() for v in (30, 10)]
        self.assertLess(change[1], 1e-3)
        self.assertLess(change[1], change[0] / 3**2)


class Through(harness.Folder, unittest.TestCase):
    def test_far_beyond_the_collapse(self):
        case = self.short("wallThrough", 125, endTime=1)
        self.compare(case, harness.entries("wallThrough"))
        packing = [case.field("alpha", t).max() for t in case.times if float(t) > 0]
        self.assertLess(max(packing), 0.65)
        self.assertGreater(packing[-1], 0.645, "a packed bed")
        steps = case.table("extremes", "fieldMinMax.dat")[::2, 0]  # the time after every 100 steps
        width, fastest = 0.8, 998 + 8  # u + c of the free stream at t = 1
        least = 100 * 0.5 * width / fastest
        self.assertGreater(np.diff(steps).min(), least / 10, "the bed's sound takes over the time step")

    def test_without_a_threshold_it_stops(self):
        case = harness.copy("wallThrough", self.folder)
        harness.mesh(case, 125)
        harness.edit(case, PROPERTIES, thresholdSpeed=0)
        harness.edit(case, "system/controlDict", endTime=1)
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"inelastic collapse at t = 0\.\d+, \(9\.\d+ ")
        self.assertIn("thresholdSpeed", done.stderr)


if __name__ == "__main__":
    unittest.main()
