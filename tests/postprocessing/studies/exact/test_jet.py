# SPDX-License-Identifier: GPL-3.0-or-later
"""The jet on a plate between its two limits: a narrow plate in a wide stream, which Kirchhoff solved, and a wide plate."""
import unittest

import numpy as np

from tests.cases import harness  # noqa: F401  (finds the packages)

from studies.exact import jet


class Limits(unittest.TestCase):
    def test_narrow_plate(self):
        """The momentum that a half-jet of width 1 loses, 1 - cos(angle), is Kirchhoff's drag of a plate with a wake, pi/(4 + pi) times its half-width."""
        for ratio in (0.01, 0.02):
            self.assertAlmostEqual((1 - np.cos(np.radians(jet.angle(ratio)))) / ratio, np.pi / (4 + np.pi), delta=0.3 * ratio)

    def test_wide_plate(self):
        self.assertAlmostEqual(jet.angle(6), 90, delta=0.1)
        self.assertLess(jet.angle(2), jet.angle(3))


if __name__ == "__main__":
    unittest.main()
