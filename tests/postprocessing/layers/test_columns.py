# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles over the height: kept, moved and compared."""
import os
import tempfile
import unittest

import numpy as np

from tests.cases import harness  # noqa: F401  (knows where postprocessing is)
from tests.cases.harness import boxes
from tests.postprocessing.plot import cases

from haff.layers import columns
from haff.plot.quantity import CannotDraw


class Columns(unittest.TestCase):
    def setUp(self):
        y = (np.arange(20) + 0.5) / 2
        bump = np.exp(-((y - 4) ** 2))
        self.p = {"y": y, "alpha": bump, "U": 2 + 3 * y, "T": bump, "Tx": bump, "Ty": 3 * bump, "Tz": 2 * bump}

    def test_raised(self):
        """Half a cell up, or onto other cells: the mass stays, and its centre goes up by as much."""
        for y in (self.p["y"], (np.arange(30) + 0.5) / 3):
            q = columns.onto(self.p, y, 0.25)
            self.assertAlmostEqual(q["alpha"].sum() * (y[1] - y[0]), self.p["alpha"].sum() / 2, places=6)
            self.assertAlmostEqual(columns.centre(q) - columns.centre(self.p), 0.25, places=5)
            np.testing.assert_allclose(q["U"][3:-3], 2 + 3 * (y[3:-3] - 0.25))
        np.testing.assert_allclose(columns.onto(self.p, self.p["y"])["alpha"], self.p["alpha"], atol=1e-14)

    def test_difference(self):
        """Of a tenth more where grains are; what they have not does not count."""
        grains = {**self.p, "alpha": np.where(self.p["y"] < 6, 0.1, 1e-3)}
        more = {**grains, "alpha": np.where(self.p["y"] < 6, 0.11, 0.5), "T": 1.3 * grains["T"]}
        self.assertAlmostEqual(columns.difference(more, grains, "alpha"), 0.1)
        self.assertAlmostEqual(columns.difference(more, grains, "T"), 0.3)
        self.assertAlmostEqual(columns.difference({**grains, "U": 0 * grains["U"]}, grains, lambda p: p["U"]), 1)
        np.testing.assert_allclose(columns.ratio(grains), 2)

    def test_kept(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "profiles.csv")
            columns.write(path, {0.3: self.p, 0.6: {**self.p, "T": 2 * self.p["T"]}})
            found = columns.read(path)
        self.assertEqual(list(found), [0.3, 0.6])
        for name, values in self.p.items():
            np.testing.assert_allclose(found[0.3][name], values, rtol=1e-4)
        np.testing.assert_allclose(found[0.6]["T"], 2 * self.p["T"], rtol=1e-4)

    def test_of_a_gas(self):
        """A gas has no T along each axis: its table has the columns that there are. What has no phases or too few cycles says so."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            at = cases.box(folder, (4, 5, 1), (0.4, 0.5, 0.1), {"x": "cyclic", "z": "empty"})
            for time, k in (("1", 1.0), ("2", 2.0)):
                cases.fields(folder, time, alpha=k * at[:, 1], T=1 + at[:, 0], U=np.outer(at[:, 1], (0, 1, 0)), p=at[:, 1])
            boxes.write_dictionary(folder, "constant", "g", "value (0 -9.81 0);")
            path = os.path.join(folder, "gas.csv")
            columns.write(path, columns.at(folder, [1, 2]))
            with open(path) as f:
                self.assertEqual(f.readline(), "moment,y,alpha,U,T,p\n")
            found = columns.read(path)
            np.testing.assert_allclose(found[2.0]["alpha"], 2 * (0.05 + 0.1 * np.arange(5)), rtol=1e-4)
            np.testing.assert_allclose(found[1.0]["U"], 0.05 + 0.1 * np.arange(5), rtol=1e-4)
            for other in (77, 1.03, -5):
                self.assertRaisesRegex(CannotDraw, rf"has no time {other}; the nearest is \d, the times are 1 2", columns.at, folder, [other])
            self.assertRaisesRegex(ValueError, "is not shaken .* leave out  -from", columns.at, folder, [0.5], 1)
            boxes.write_dictionary(folder, "constant", "shaking", "type sinusoidal; amplitude 2; frequency 1;")
            self.assertRaisesRegex(ValueError, "three cycles or more from cycle 1 on; the last time is 2", columns.at, folder, [0.5], 1)
            for time in ("3", "4"):
                cases.fields(folder, time, alpha=at[:, 1], T=1 + at[:, 0], U=np.outer(at[:, 1], (0, 1, 0)), p=at[:, 1])
            self.assertEqual(list(columns.at(folder, [0], 1)), [0])
            self.assertRaisesRegex(ValueError, "has no phase 0.3 of the shaking; the nearest is 0, the phases are 0$", columns.at, folder, [0.3], 1)


if __name__ == "__main__":
    unittest.main()
