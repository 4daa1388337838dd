# SPDX-License-Identifier: GPL-3.0-or-later
"""Short forms of the cases coolingGas and equationOfState. Seeds are fixed; what the bounds are in standard deviations is
said beside them."""
import math
import os
import unittest

import numpy as np

from tests.cases import harness

from haff.start import enskog  # noqa: E402
from studies.made import homogeneous  # noqa: E402

os.environ["PATH"] = harness.BIN + os.pathsep + os.environ["PATH"]


def source(name):
    return os.path.join(harness.SOURCE, "cases", name)


class GrainCases(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def test_fits(self):
        """The virial coefficients (in powers of the packing fraction) that the fits imply are those of Clisby & McCoy, J. Stat.
        Phys. 122 (2006) 15."""
        known = {2: (2, 3.128018, 4.257855, 5.336897, 6.36296, 7.35186), 3: (4, 10, 18.364768, 28.22445, 39.81545)}
        for d, virial in known.items():
            for n, value in enumerate(virial, 1):
                implied = sum(a * math.comb(n - 1, k - 1) for k, a in enskog.SIMULATED[d].items() if 1 <= k <= n)
                self.assertAlmostEqual(implied / value, 1, delta=1e-4, msg=f"d = {d}, B{n + 1}")
            self.assertAlmostEqual(float(enskog.simulated(1e-9, d)), 1, places=7)

    def test_cooling(self):
        """To half of the first T at e = 0.95: within 2 %. Standard deviation 0.4 %, and vortices take up to 1.5 %."""
        for d, packing in ((2, 0.05), (2, 0.2), (3, 0.1), (3, 0.3)):
            rate = homogeneous.cooling(self.path("cooling"), source("coolingGas"), d, packing, 0.95, 10000)
            self.assertLess(abs(rate - 1), 0.02, f"d = {d}, packing {packing}: {rate}")

    def test_pressure(self):
        """0.5 %, and four standard errors of the windows."""
        for d, packing in ((2, 0.2), (2, 0.6), (3, 0.1), (3, 0.45)):
            z, error = homogeneous.compressibility(self.path("gas"), source("equationOfState"), d, packing, 3000, 250)
            fit = float(enskog.pressure_factor(packing, 1, d, enskog.simulated))
            self.assertLess(error / fit, 0.003)
            self.assertLess(abs(z - fit), min(0.005 * fit, 4 * error), f"d = {d}, packing {packing}: {z} +- {error}, fit {fit}")

    def test_pressure_of_cooling(self):
        """Garzo & Dufty's pressure at e = 0.8 within 2 %: the standard deviation is 0.7 %; the elastic one is 6 % higher."""
        z = homogeneous.cooling_pressure(self.path("inelastic"), source("equationOfState"), 2, 0.3, 0.8, 10000)
        theory, elastic = (float(enskog.pressure_factor(0.3, e, 2, enskog.simulated)) for e in (0.8, 1))
        self.assertLess(abs(z / theory - 1), 0.02, z)
        self.assertGreater(elastic / theory - 1, 0.05)

    def test_long_cooling(self):
        """The shipped case, coarser in time: Haff's law at first; vortices slow the cooling down much later."""
        case = harness.copy("coolingGas", self.folder)
        harness.mesh(case, 8)
        harness.drop_vtk(case)
        harness.edit(case, "system/controlDict", endTime=800, writeInterval=40)
        harness.program("granularMD", "-case", case)
        case = harness.haff.Case(case)
        t, T = homogeneous.temperatures(case)
        ratio = np.interp([40, 800], t, T / enskog.cooled(1, t, 0.1, 0.9, 2, 1, enskog.simulated))
        self.assertLess(abs(ratio[0] - 1), 0.05)
        self.assertGreater(ratio[1], 1.15)
        alpha = case.field("alpha", 800)
        self.assertAlmostEqual(float(np.mean(alpha)), 9982 * np.pi / 4 / 280**2, places=9)


if __name__ == "__main__":
    unittest.main()
