# SPDX-License-Identifier: GPL-3.0-or-later
"""Growth of noise in uniform gas with Marquina's flux: the formulas against the program, and the flux that is cured."""
import unittest

import numpy as np

from studies import marquinaStability as stability
from studies.exact.eos import GoldshteinShapiro

GAS = GoldshteinShapiro(1.0)


class Stability(unittest.TestCase):
    def test_onset_at_rest(self):
        """The closed form changes sign where the Fourier analysis of all waves finds the first growth."""
        onset = stability.onset(GAS, least=1e-5)
        self.assertAlmostEqual(onset, 0.4496, delta=5e-4)
        self.assertGreater(stability.rest_determinant(GAS, onset - 1e-3), 0)
        self.assertLess(stability.rest_determinant(GAS, onset + 1e-3), 0)
        self.assertTrue(np.isnan(stability.onset(GAS, flux="common")))

    def test_upwind_scheme(self):
        """f = A U and |A| >= 0: the analysis finds the upwind scheme stable, and Marquina's in the dilute gas."""
        for mach in (0.0, 0.3, 0.9):
            self.assertLess(stability.growth(GAS, 0.6, mach, "common", "WENO5"), 1e-9)
            self.assertLess(stability.growth(GAS, 0.01, mach, "Marquina", "WENO5"), 1e-9)

    def test_onset_measured(self):
        """Noise in the program decays below the predicted onset and grows above, with printed A' where that says so."""
        for mach, printed in ((0.1, False), (0.3, False), (0.3, True)):
            gas = stability.PrintedSound(1.0) if printed else GAS
            onset = stability.onset(gas, mach)
            with self.subTest(f"Mach {mach}, printed {printed}: {onset:.4f}"):
                self.assertLess(stability.noise(gas, onset - 0.02, mach), 1)
                self.assertGreater(stability.noise(gas, onset + 0.03, mach), 10)

    def test_rates_measured(self):
        """The worst wave of the formulas grows as they say."""
        for nu, mach, reconstruct in ((0.6, 0.0, "firstOrder"), (0.5, 0.1, "firstOrder"), (0.42, 0.3, "firstOrder"),
                                      (0.55, 0.2, "WENO5"), (0.4, 0.7, "WENO5")):
            with self.subTest(f"{nu} Mach {mach} {reconstruct}"):
                rate, formulas = stability.measured(GAS, nu, mach, reconstruct)
                self.assertAlmostEqual(rate / formulas, 1, delta=0.05)

    def test_cured(self):
        """MarquinaStable: neither that wave nor noise grows, however dense the gas."""
        for nu, mach, reconstruct in ((0.5, 0.0, "firstOrder"), (0.6, 0.1, "PHM"), (0.6, 0.3, "firstOrder"), (0.64, 0.3, "WENO5"),
                                      (0.4, 0.9, "WENO5")):
            with self.subTest(f"{nu} Mach {mach} {reconstruct}"):
                self.assertGreater(stability.noise(GAS, nu, mach, "Marquina", reconstruct), 10)
                self.assertLess(stability.noise(GAS, nu, mach, "MarquinaStable", reconstruct), 1)


if __name__ == "__main__":
    unittest.main()
