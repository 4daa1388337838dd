# SPDX-License-Identifier: GPL-3.0-or-later
"""Short forms of faradayMD and sedimentationMD: what is exact of them, the pattern of a small box, free fall and cooling."""
import os
import subprocess
import sys
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import haff

from haff.case import grains
from haff.layers import faraday
from haff.start import enskog


class Short(harness.Folder):
    def run_short(self, name, sizes, N, **control):
        case = harness.copy(name, self.folder)
        msh = os.path.join(case, "mesh.msh")
        numbers = [w for key, value in sizes.items() for w in ("-setnumber", key, str(value))]
        command = ["gmsh", "-3", "-v", "2", *numbers, os.path.join(case, "mesh.geo"), "-o", msh]
        subprocess.run(command, check=True, capture_output=True)
        harness.program("gmshToCase", msh, "-case", case)
        harness.edit(case, "constant/particleProperties", N=N)
        harness.edit(case, "system/controlDict", **control)
        harness.program("granularMD", "-case", case)
        return haff.Case(case)


class FaradayMD(Short, unittest.TestCase):
    def test_two_waves(self):
        """Two wavelengths in a box of 80: the pattern stands after 12 cycles and has twice the period."""
        cycles, N = 20, 501
        case = self.run_short("faradayMD", {"L": 80}, N, endTime=repr(cycles / 3.5), writeInterval=repr(1 / 7.0))
        layer = faraday.Layer(case)
        self.assertAlmostEqual(layer.amplitude, 5.57, places=12)
        for time in case.times[1:]:
            mass = case.field("alpha", time) @ case.volumes / np.ptp(case.mesh.points[:, 2])
            self.assertAlmostEqual(mass / (N * np.pi / 4), 1, places=11, msg=time)
        found = faraday.samples(layer, 12, cycles)
        result = faraday.measure(list(found.values()), layer.length)
        self.assertTrue(result["stands"], faraday.describe(result))
        self.assertEqual(result["mode"], 2, faraday.describe(result))
        cloud = grains.read(case, case.times[-1])
        self.assertEqual(len(cloud["x"]), N)
        self.assertTrue(((cloud["x"][:, 1] >= 0.5 - 1e-9) & (cloud["x"][:, 0] >= 0) & (cloud["x"][:, 0] <= 80)).all())


class Table1(harness.Folder, unittest.TestCase):
    def test_driver(self):
        """One row for five cycles, stopped and started again: the line is there once."""
        script = os.path.join(harness.SOURCE, "cases", "faradayMD", "table1.py")
        command = [sys.executable, script, self.folder, "-rows", "7", "-cycles", "1", "5", "-plate", "0.75"]
        for n in range(2):
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("0 rows to run, 1 stand", done.stdout)
        with open(os.path.join(self.folder, "table1.csv")) as f:
            lines = f.read().split("\n")
        self.assertEqual(len(lines), 3)
        line = dict(zip(lines[0].split(","), lines[1].split(",")))
        self.assertEqual((line["N"], line["paper"], line["plate"], line["stands"]), ("1566", "21.0", "0.75", "no"))
        self.assertGreater(float(line["contrast"]), 1)


class SedimentationMD(Short, unittest.TestCase):
    def test_fall_and_cooling(self):
        """A narrow column. What the walls have not yet been felt by falls freely and cools by Haff's law."""
        N, t = 7639, 0.03
        case = self.run_short("sedimentationMD", {"W": 0.02}, N, endTime=t, writeInterval=t)
        volume = case.field("alpha") @ case.volumes
        self.assertAlmostEqual(volume / (N * enskog.volume(3, 1e-3)), 1, places=11)
        parts = case.field("TComponents")
        np.testing.assert_allclose(parts.mean(axis=1), case.field("T"), rtol=1e-14)
        self.assertGreater(np.ptp(parts, axis=1).max(), 0)
        p = faraday.Layer(case).profile(case.times[-1])
        free = (p["y"] > 0.03) & (p["y"] < 0.07)
        mean = lambda values: np.average(values[free], weights=p["alpha"][free])
        late = t - 0.025e-3  # fields are of the middle of the last window
        T = enskog.cooled(9.81e-3, late, 0.1, 0.9, 3, 1e-3)
        self.assertLess(abs(mean(p["U"]) / (-9.81 * late) - 1), 0.02)
        self.assertLess(abs(mean(p["T"]) / T - 1), 0.06)
        self.assertLess(abs(mean(p["alpha"]) / 0.1 - 1), 0.03)


if __name__ == "__main__":
    unittest.main()
