# SPDX-License-Identifier: GPL-3.0-or-later
"""Friction and packing of grains on slopes, from layers and fits that are known."""
import os
import tempfile
import types
import unittest

import numpy as np

from studies.measured import rheology


def slope(path, rate, mu, alpha, p=100.0):
    """A run on a slope whose fields are uniform but for the velocity, with 4 cells in each layer of 20."""
    y = np.repeat((np.arange(40) + 0.5) * 0.5e-3, 2)
    n = len(y)
    fields = {"alpha": np.full(n, alpha), "U": np.outer(rate * y, (1, 0, 0)), "pShear": np.tile((-mu * p, 0, 0), (n, 1)), "pComponents": np.full((n, 3), p)}
    return types.SimpleNamespace(path=path, times=["0", "1", "2"], centres=np.stack([0 * y, y, 0 * y], axis=1), field=lambda name, t: fields[name])


class Rheology(unittest.TestCase):
    def test_bulk(self):
        with tempfile.TemporaryDirectory() as path:
            os.mkdir(os.path.join(path, "2"))
            open(os.path.join(path, "2", "pShear"), "w").close()
            (inertial, spread), (mu, _), (alpha, _) = rheology.bulk(slope(path, 30.0, 0.45, 0.57))
        self.assertAlmostEqual(inertial, 30 * 1e-3 / np.sqrt(100 / 2600))
        self.assertLess(spread, 1e-9)
        self.assertAlmostEqual(mu, 0.45)
        self.assertAlmostEqual(alpha, 0.57)

    def test_fit(self):
        rows = [((i, 0.001), (rheology.law(i, 0.36, rheology.DYNAMIC, 0.85), 0.001), (0.59 - 0.2 * i, 0.001)) for i in (0.05, 0.1, 0.2, 0.4)]
        found = [value for value, _ in rheology.fit(rows)]
        np.testing.assert_allclose(found, (0.36, 0.85, 0.59, -0.2), rtol=1e-4)
