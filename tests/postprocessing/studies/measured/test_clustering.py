# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas and grains in a box: their spectra, the noise that the one begins with, and when Haff's law is left."""
import re
import unittest

import numpy as np

from tests.cases import harness  # noqa: F401  (knows where postprocessing is)

from studies.measured import clustering


class Bare(clustering.Box):
    """A box without a case."""

    def __init__(self, d, length, number):
        self.d, self.length, self.number = d, length, number


def value(text, x, length):
    """Of an expression of waves at a place."""
    return eval(text, {"cos": np.cos, "pi": np.pi, **dict(zip("xyz", x))})


class Clustering(unittest.TestCase):
    def test_noise(self):
        """Grains at random with Maxwell's velocities of T = 2 have a density of power 1 and momenta of power 2, across and along, to
        three standard deviations of the mean of the long waves."""
        for d in (2, 3):
            random = np.random.default_rng(5)
            box = Bare(d, 10.0, 100000)
            n, *power = box.spectra(*box.put(random.uniform(0, 10, (100000, d)), random.normal(0, np.sqrt(2), (100000, d)), 24))
            waves = {2: np.pi * n, 3: 2 * np.pi * n * n}[d]  # and their negatives
            long = n < 4.5  # a cell averages over itself: by up to 6 % of the power of these
            for found, wanted, directions in zip(power, (1, 2, 2), (1, d - 1, 1)):
                mean = np.average(found[long], weights=waves[long])
                self.assertLess(abs(mean / wanted - 1), 0.06 + 3 / np.sqrt(directions * waves[long].sum()), f"d = {d}: {mean}, not {wanted}")

    def test_wave(self):
        """A wave of velocity is found where it is, in the direction it has, with its amplitude."""
        box, side = Bare(3, 1.0, 1000), 16
        z, y, x = np.meshgrid(*(np.arange(side) / side,) * 3, indexing="ij")
        u = 0.1 * np.cos(2 * np.pi * 3 * y)
        for direction, part in ((1, 2), (0, 1)):  # along y, across
            j = np.zeros((3, side, side, side))
            j[direction] = u
            n, *power = box.spectra(np.ones_like(x), j)
            found = np.array(power)
            shell = 2  # n = 3
            waves = (np.rint(np.sqrt(sum(a * a for a in np.meshgrid(*(np.fft.fftfreq(side, 1 / side),) * 3)))) == 3).sum()
            self.assertAlmostEqual(found[part][shell] * waves * (2 if part == 1 else 1), 1000 * 2 * 0.05**2, places=9)
            found[part][shell] = 0
            self.assertLess(found.max(), 1e-20)
        slanting = 0.1 * np.cos(2 * np.pi * (x - 2 * y + 2 * z))
        _, _, across, along = box.spectra(np.ones_like(x), np.multiply.outer(np.array([1, -2, 2]) / 3, slanting))
        self.assertAlmostEqual(along[shell] * waves, 1000 * 2 * 0.05**2, places=9)
        self.assertLess(across.max(), 1e-15)

    def test_expression(self):
        """The text has the waves that it was made of, to the three digits it is printed with; each pair of waves counts once."""
        for d, longest in ((2, 5), (3, 6)):
            waves, random = clustering.half(d, longest), np.random.default_rng(1)
            everything = [n for n in np.ndindex(*(7,) * d) if 0 < sum((k - 3) ** 2 for k in n) <= longest]
            self.assertEqual(2 * len(waves), len(everything))
            amplitudes = random.normal(size=len(waves)) + 1j * random.normal(size=len(waves))
            text = clustering.expression(waves, amplitudes, 50)
            self.assertIsNone(re.search(r"[^-+*/().\dcosepixyz]", text))
            for x in random.uniform(0, 50, (5, d)):
                exact = 2 * (amplitudes * np.exp(2j * np.pi / 50 * (waves @ x))).real.sum()
                self.assertLess(abs(value(text, x, 50) - exact), 0.01 * 2 * np.sqrt((abs(amplitudes) ** 2).sum()))

    def test_left(self):
        """Where a power law crosses twice another; never, if it does not."""
        t = np.geomspace(1, 100, 40)
        self.assertAlmostEqual(clustering.left(t, t**-1.0, t**-2.0), 2, places=9)
        self.assertTrue(np.isnan(clustering.left(t, t**-2.0, t**-2.0)))

    def test_likeness(self):
        """1 with itself, -1 with its negative, 0 a quarter of a wave further, whatever short waves are added."""
        y, x = np.meshgrid(*(np.arange(32) / 32,) * 2, indexing="ij")
        wave, short = np.cos(2 * np.pi * (x + 2 * y)), np.cos(2 * np.pi * 9 * x)
        for other, wanted in ((wave + short, 1), (-wave + short, -1), (np.sin(2 * np.pi * (x + 2 * y)), 0)):
            self.assertAlmostEqual(clustering.likeness(wave, other), wanted, places=9)


if __name__ == "__main__":
    unittest.main()
