# SPDX-License-Identifier: GPL-3.0-or-later
"""Flow down a slope whose section alone is solved: the shipped case `pile` on a coarse mesh, its bits on two ranks, and homogeneous
shear, whose stress over pressure decides at which angle a layer without side walls can flow steadily."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs, sections

from haff.start import enskog  # noqa: E402
from studies.exact import garzoDufty  # noqa: E402

SIGMA = 0.1


def steepness(alpha, e):
    """tau/p of homogeneous shear: eta g^2 = 3/2 rho T zeta, with the shear rate g, gives tau/p = sqrt(3/2 eta* zeta*)/p*."""
    grains = garzoDufty.Grains(3, e)
    _, shear, _, _, zeta = grains.starred(alpha)
    return np.sqrt(1.5 * shear * zeta) / enskog.pressure_factor(alpha, e, 3)


def temperature(alpha, e, rate):
    """T of homogeneous shear: tau = eta* eta0 g and p = p* rho T give g/sqrt(T) with eta0 = 5 sqrt(T/pi)/(16 sigma^2)."""
    _, shear, _, _, _ = garzoDufty.Grains(3, e).starred(alpha)
    rho = alpha * 6 / np.pi / SIGMA**3
    viscous = shear * 5 / (16 * np.sqrt(np.pi) * SIGMA**2)  # eta over sqrt(T)
    return (viscous * rate / (steepness(alpha, e) * enskog.pressure_factor(alpha, e, 3) * rho))**2


class Pile(harness.Folder, unittest.TestCase):
    def test_expected(self):
        case = self.short("pile", 10, endTime=0.2, writeInterval=0.1)
        self.compare(case, harness.entries("pile"))
        U = case.field("U", case.time(0.2))
        dense = case.field("alpha", case.time(0.2)) > 0.1
        self.assertGreater(U[dense, 2].min(), -1e-3)
        self.assertGreater(np.abs(U[dense, :2]).max(), 0.01)  # the secondary flow
        mirror = np.lexsort((np.round(-case.centres[:, 0], 9), np.round(case.centres[:, 1], 9)))
        straight = np.lexsort((np.round(case.centres[:, 0], 9), np.round(case.centres[:, 1], 9)))
        np.testing.assert_allclose(U[mirror, 2], U[straight, 2], atol=1e-6)
        again = harness.copy("pile", self.folder)
        harness.mesh(again, 10)
        other = harness.run(again, ranks=2, endTime=0.2, writeInterval=0.1)
        for name in ("rho", "rhoU", "rhoE"):
            np.testing.assert_array_equal(other.field(name), case.field(name))

    def test_homogeneous_shear(self):
        """Between walls that move along the missing axis and conduct no heat T settles where impacts take what shear heats."""
        for alpha in (0.01, 0.1, 0.3, 0.5, 0.6):
            with self.subTest(alpha):
                rate, cells = 1.0, 4
                T = temperature(alpha, 0.9, rate)
                rho = alpha * 6 / np.pi / SIGMA**3
                end = 12 / enskog.cooling_rate(alpha, T, 0.9, 3, SIGMA)
                half = 0.5 * 0.1 * cells * rate
                rules = {"U": {"yLow": f"translatingWallVelocity; U (0 0 {-half})", "yHigh": f"translatingWallVelocity; U (0 0 {half})"}}
                case = sections.make(os.path.join(self.folder, f"shear{alpha}"), (0, cells, 0), lambda at: rho + 0 * at[:, 1],
                                     lambda at: (0, 0, rate * at[:, 1] - half), lambda at: 1.05 * T + 0 * at[:, 1], end, rules=rules,
                                     adjust="yes", step=1e-6)
                runs.add(case, "system/controlDict", f"maxDeltaT {end / 3000!r};\n")
                result = harness.run(case)
                found = result.field("T")
                self.assertLess(np.ptp(found), 1e-5 * T)
                self.assertAlmostEqual(np.sqrt(T / found.mean()), 1, delta=1e-4)  # tau/p over that of the closure

    def test_steepness(self):
        """The angles of the README, to three digits."""
        for e, alpha, ratio in ((0.9, 0.1, 0.293), (0.9, 0.5, 0.294), (0.9, 0.6, 0.302), (0.7, 0.5, 0.488)):
            self.assertAlmostEqual(steepness(alpha, e), ratio, delta=6e-4)


if __name__ == "__main__":
    unittest.main()
