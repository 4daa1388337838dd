# SPDX-License-Identifier: GPL-3.0-or-later
"""The bed of cases/bouncingBed, six periods of it: against a prototype (an independent program) and the grains."""
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.transport.channels import replace

from haff.layers import columns, faraday

EXTREMES = "extremes { type fieldMinMax; fields (alpha); writeControl timeStep; writeInterval 1; log false; }\n"


class BouncingBed(harness.Folder, unittest.TestCase):
    def test_expected(self):
        case = harness.copy("bouncingBed", self.folder)
        harness.mesh(case, 100)
        replace(case, "system/controlDict", "functions\n{\n", "functions\n{\n    " + EXTREMES)
        case = harness.run(case)
        self.compare(case, harness.entries("bouncingBed"))
        layer = faraday.Layer(case)
        self.assertAlmostEqual(layer.amplitude, 4e-3, places=12)
        # it has locked to the plate: the last cycle is the one before, to the 0.006 to 0.009 that 100 to 800 cells leave
        for phase in (0.3, 0.6, 0.9):
            before, last = (columns.profile(layer, case.time((n + phase) / 12)) for n in (4, 5))
            self.assertLess(columns.difference(last, before, "alpha"), 0.01)
        # the greatest packing of all is reached at the impact
        table = case.table("extremes", "fieldMinMax.dat")  # time, field, min and its place, max and its place
        times, most = table[:, 0], table[:, 6]
        cycle = times * 12 - 5
        inside = cycle > 0
        self.assertAlmostEqual(most[inside].max(), 0.593, delta=0.008)
        self.assertAlmostEqual(cycle[inside][np.argmax(most[inside])], 0.05, delta=0.03)


if __name__ == "__main__":
    unittest.main()
