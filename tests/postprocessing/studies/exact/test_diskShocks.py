# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact shocks of elastic disks: the dilute limit is a perfect gas of gamma = 2, and the jump conditions hold in dense gas."""
import unittest

import numpy as np

from tests.cases import harness  # noqa: F401  (finds the packages)

from studies.exact import disks, diskShocks
from studies.exact.eos import PerfectGas
from studies.exact.obliqueShock import ObliqueShock


class Shocks(unittest.TestCase):
    def test_dilute_piston(self):
        """A strong shock of gamma = 2 compresses three times."""
        packed, T, speed = diskShocks.piston(1e-7)
        self.assertAlmostEqual(packed / 1e-7, 3, delta=1e-5)
        self.assertAlmostEqual(speed, 0.5, delta=1e-5)
        self.assertEqual(T, 0.5)

    def test_dilute_wedge(self):
        beta, packed = diskShocks.wedge(1e-8, 0.003, 15)
        known = ObliqueShock(PerfectGas(2.0), rho=1.0, p=0.003, mach=1 / np.sqrt(2 * 0.003))
        angle = known.angle(np.radians(15))
        self.assertAlmostEqual(beta, np.degrees(angle), delta=1e-4)
        self.assertAlmostEqual(packed / 1e-8, known.behind(angle).rho, delta=1e-5)

    def test_normal(self):
        """Dilute: the known jump of gamma = 2 at Mach 4; dense: mass, momentum and energy, seen from the shock."""
        packed, T = diskShocks.normal(1e-8, 1 / 32)
        self.assertAlmostEqual(packed / 1e-8, 3 * 16 / (16 + 2), delta=1e-5)
        self.assertAlmostEqual(T * 32, (2 * 2 * 16 - 1) / 3 * 18 / (3 * 16), delta=1e-5)
        packed, T = diskShocks.normal(0.2, 0.02)
        A, slow = disks.Disks(1.0).A, 0.2 / packed
        self.assertAlmostEqual(packed * T * A(packed) + packed * slow**2, 0.2 * 0.02 * A(0.2) + 0.2, delta=1e-10)
        self.assertAlmostEqual(T * (1 + A(packed)) + slow**2 / 2, 0.02 * (1 + A(0.2)) + 0.5, delta=1e-10)

    def test_dense_piston(self):
        """Mass and momentum, seen from the piston: what arrives is 0.1 (1 + speed), and the pressure stops it."""
        packed, T, speed = diskShocks.piston(0.1)
        self.assertAlmostEqual(packed * speed, 0.1 * (1 + speed), delta=1e-12)
        self.assertAlmostEqual(packed * T * disks.Disks(1.0).A(packed), 0.1 * (1 + speed), delta=1e-12)


if __name__ == "__main__":
    unittest.main()
