# SPDX-License-Identifier: GPL-3.0-or-later
"""How studies/checks/vortices.py measures a wave among grains, its growth, and the box in which it neither grows nor decays."""
import os
import tempfile
import unittest
from unittest import mock

import numpy as np

from tests.cases import harness  # noqa: F401  (finds the packages)

from studies.checks import vortices


class Measures(unittest.TestCase):
    def test_of_grains(self):
        """A wave of 0.4 in 100,000 grains of T = 1: within five standard deviations. All other waves together are noise."""
        random, n, length = np.random.default_rng(1), 100000, 9.0
        x = random.uniform(0, length, (n, 3))
        u = random.standard_normal((n, 3)) + 0.4 * np.array([0 * x[:, 0], np.sin(2 * np.pi * x[:, 0] / length), np.cos(2 * np.pi * x[:, 0] / length)]).T
        with mock.patch.object(vortices.grains, "read", return_value={"x": x, "U": u}):
            amplitude, waves, T = vortices.of_grains(None, "1", length)
        self.assertAlmostEqual(amplitude, 0.4, delta=5 / np.sqrt(n))
        self.assertAlmostEqual(waves, 0.16, delta=5 * 0.8 / np.sqrt(n) + 20 / n)
        self.assertAlmostEqual(T, 1, delta=5 * np.sqrt(2 / 3 / n))

    def test_growth(self):
        """Of a wave that heats the gas: lambda/beta is found although T falls more slowly for it, to the variation of the heat while it grows."""
        rate, tau = 0.15, np.linspace(0, 4, 4001)
        a = np.exp(rate * tau)  # over the thermal velocity without heat, beta = 1
        for height, delta in ((0.01, 1e-5), (0.3, 0.01)):
            log_T = np.cumsum(np.append(0, -2 * (1 - (1 - rate) * (height * a[:-1]) ** 2 / 3) * np.diff(tau)))
            wave = height * a * np.exp(-tau) / np.exp(log_T / 2)
            with mock.patch.object(vortices, "track", return_value=(-log_T / 2, wave, wave**2)):
                self.assertAlmostEqual(vortices.growth([], None), rate, delta=delta)

    def test_critical(self):
        """From 1 - (Lc/L)^2 of two boxes their Lc; another number of boxes is refused."""
        with tempfile.TemporaryDirectory() as top:
            for name in ("a0.3L7.7s1", "a0.3L7.7s2", "a0.3L9.3s1", "a0.45L5.3s1"):
                os.makedirs(os.path.join(top, "grains", name))
            self.assertEqual({side: len(paths) for side, paths in vortices.boxes(top, 0.3, "grains").items()}, {7.7: 2, 9.3: 1})
            with mock.patch.object(vortices, "growth", side_effect=[1 - (8.5 / 7.7) ** 2, 1 - (8.5 / 9.3) ** 2]):
                self.assertAlmostEqual(vortices.critical(top, 0.3, "grains"), 8.5, delta=1e-9)
            with self.assertRaisesRegex(ValueError, "1 boxes of packing 0.45"):
                vortices.critical(top, 0.45, "grains")

    def test_theory(self):
        """Garzo (2005): 28.5, 8.47, 5.87."""
        for alpha, e, box in ((0.1, 0.9, 28.5), (0.3, 0.8, 8.47), (0.45, 0.7, 5.87)):
            self.assertAlmostEqual(vortices.theory(alpha, e), box, delta=0.005)


if __name__ == "__main__":
    unittest.main()
