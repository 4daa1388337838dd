# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of soft grains and of the gas beside them, of fields that are known."""
import unittest

import numpy as np

from studies.checks import softGrains


class Made:
    """A gas of 40 x 20 cells of 1 mm: 10 mm deep up to x = 20 mm, from which it sinks by 1 mm in a second, and much thinner gas elsewhere."""
    path = ""

    def __init__(self):
        x, y = (a.ravel() for a in np.meshgrid(np.arange(40) + 0.5, np.arange(20) + 0.5))
        self.centres, self.volumes = 1e-3 * np.stack([x, y, 0 * x], axis=1), np.full(800, 1e-9)

    def field(self, _, time):
        x, y, _ = 1e3 * self.centres.T
        return np.where((x < 20) & (y < 10 - float(time)), 0.5, 1e-5)

    def time(self, value):
        return f"{value:g}"


class SoftGrains(unittest.TestCase):
    def test_reach(self):
        self.assertAlmostEqual(softGrains.reach(Made(), None, "0"), 0.99 * 20e-3)

    def test_height(self):
        self.assertAlmostEqual(softGrains.height(Made(), None, "2"), 0.99 * 8e-3)

    def test_outflow(self):
        """A layer of 20 cells that are half full, and the thin gas that takes its place."""
        self.assertAlmostEqual(softGrains.outflow(Made(), None, "2", 1), 20 * (0.5 - 1e-5) / (np.pi / 6))
