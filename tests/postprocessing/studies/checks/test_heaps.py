# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of heaps: fronts, depths, slopes and velocities of fields that are known."""
import os
import tempfile
import unittest

import numpy as np

from studies.checks import heaps


class Made:
    """A case of 40 x 20 cells of 1 mm: a heap with a straight slope of 1 in 2 from 10.24 mm at x = 0, and grains of thin gas above it."""

    def __init__(self):
        x, y = (a.ravel() for a in np.meshgrid(np.arange(40) + 0.5, np.arange(20) + 0.5))
        self.centres = 1e-3 * np.stack([x, y, 0 * x], axis=1)
        height = np.clip(10.24 - 0.5 * x, 0, None)
        self.fields = {"alpha": 0.64 * np.clip(height - (y - 0.5), 0, 1), "U": np.stack([y, 0 * y, 0 * y], axis=1)}

    def field(self, name, time):
        return self.fields[name] * (1 - float(time) if name == "alpha" else 1)

    def time(self, value):
        return f"{value:g}"


class Heaps(unittest.TestCase):
    def setUp(self):
        self.case = Made()

    def test_depth(self):
        self.assertAlmostEqual(heaps.depth_at(self.case, None, 0, 0.0005), 9.99e-3, places=9)
        self.assertEqual(heaps.depth_at(self.case, None, 0, 0.0305), 0)

    def test_slope(self):
        self.assertAlmostEqual(heaps.slope(self.case, None, 0, 1e-3), np.degrees(np.arctan(0.5)), places=6)

    def test_surface(self):
        """Gravity leans by 10 degrees along x."""
        with tempfile.TemporaryDirectory() as self.case.path:
            os.mkdir(os.path.join(self.case.path, "constant"))
            with open(os.path.join(self.case.path, "constant", "g"), "w") as f:
                f.write(f"value ({np.sin(np.pi / 18)!r} {-np.cos(np.pi / 18)!r} 0);\n")
            self.assertAlmostEqual(heaps.surface(self.case, None, 0, 1e-3), 10 + np.degrees(np.arctan(0.5)), places=6)

    def test_run_out(self):
        """The depth is 1 mm at x = 18.48 mm: the last column that is a cell deep ends at 18 mm."""
        self.assertAlmostEqual(heaps.run_out(self.case, None, 0, 9e-3), 1)

    def test_outflow(self):
        """A tenth of the content in a tenth of a second."""
        whole = heaps.content(self.case, 0)
        self.assertAlmostEqual(whole, 1e-6 * np.clip(10.24 - 0.5 * (np.arange(40) + 0.5), 0, None).sum(), places=12)
        self.assertAlmostEqual(heaps.outflow(self.case, None, "0.1", 0.1), whole, places=12)

    def test_slope_between(self):
        self.assertAlmostEqual(heaps.slope_between(self.case, None, 0, (4e-3, 18e-3)), np.degrees(np.arctan(0.5)), places=6)

    def test_velocities(self):
        self.assertEqual(heaps.velocity_at(self.case, None, 0, 4.4e-3), 4.5)
        self.assertEqual(heaps.packed_speed(self.case, None, 0), 9.5)


if __name__ == "__main__":
    unittest.main()
