# SPDX-License-Identifier: GPL-3.0-or-later
"""The shaken layer in its first two cycles: packing at the plate, and the drift of the total."""
import unittest

from tests.cases import harness


class VibratedLayer(harness.Folder, unittest.TestCase):
    def test_two_cycles(self):
        case = self.short("vibratedLayer", 1500, endTime=0.00675)
        self.compare(case, harness.entries("vibratedLayer"))
        sums = [case.field("alpha", time).sum() for time in case.times[1:]]
        self.assertLess(max(sums) / min(sums) - 1, 0.003, "the layer gains or loses grains")


if __name__ == "__main__":
    unittest.main()
