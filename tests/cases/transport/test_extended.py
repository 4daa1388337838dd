# SPDX-License-Identifier: GPL-3.0-or-later
"""Extended kinetic theory in whole runs: homogeneous shear between walls that move, against tests/oracles/extended.csv."""
import csv
import os
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.transport.channels import POLYHEDRAL, replace

HEIGHT = 0.5


def table():
    with open(os.path.join(harness.SOURCE, "tests", "oracles", "extended.csv"), newline="", encoding="utf-8") as f:
        return {(row["e"], row["mu_p"], row["nu"]): row for row in csv.DictReader(f)}


class HomogeneousShear(harness.Folder, unittest.TestCase):
    """Work of the shear and loss by impacts balance in gas between adiabatic walls: T and packing stay uniform, u linear."""

    def shear(self, row, courant, end, changes=()):
        """A run to its steady state, from 1.2 times its T, at a shear rate of 1 and a density of the grains of 1."""
        case = harness.copy("couetteSpheres", self.folder)
        harness.edit(case, "constant/granularProperties", restitution=row["e"], mass=repr(np.pi / 6))
        replace(case, "constant/granularProperties", "grain {", f"grain {{ friction {row['mu_p']};")
        for old, new in ((f"4*18/N", f"4*{HEIGHT}/N"), ("{L, 18, 0}", f"{{L, {HEIGHT}, 0}}"), ("{0, 18, 0}", f"{{0, {HEIGHT}, 0}}")):
            replace(case, "mesh.geo", old, new)
        replace(case, "0.orig/alpha", "uniform 0.45", f"uniform {row['nu']}")
        replace(case, "0.orig/T", '"0.0005 + 0.004*(y/9 - 1)^4"', f'"{1.2 * float(row["T"])!r}"')
        for value in ("0.004", "0.005"):
            replace(case, "0.orig/T", f"type fixedValue; value uniform {value};", "type zeroGradient;")
        replace(case, "0.orig/U", "0.498 + 0.172*(y/9 - 1) + 0.173*(y/9 - 1)^5", "y")
        replace(case, "0.orig/U", "U (0.17 0 0)", "U (0 0 0)")
        replace(case, "0.orig/U", "U (0.86 0 0)", f"U ({HEIGHT} 0 0)")
        for change in changes:
            replace(case, *change)
        harness.mesh(case, 8)
        result = harness.run(case, maxCo=courant, endTime=end, writeInterval=end)
        self.assertLess(np.abs(result.field("alpha") / float(row["nu"]) - 1).max(), 1e-7)
        return [np.abs(result.field(field) / float(row[field]) - 1).max() for field in ("T", "p")]

    def test_steady(self):
        """T and p of the table to 1e-6, on both engines: the error of the splitting, which the next test has of second order."""
        rows = table()
        for e, friction, nu, courant, end, changes in (
                ("0.7", "0", "0.2", 0.4, 36, ()), ("0.7", "0", "0.3", 0.4, 18, ()), ("0.7", "0", "0.48", 0.2, 7, ()),
                ("0.7", "0", "0.5", 0.15, 6, ()), ("0.7", "0", "0.55", 0.15, 3, ()), ("0.7", "0", "0.6", 0.3, 1.2, ()),
                ("0.9", "0.5", "0.55", 0.3, 3, [POLYHEDRAL])):
            with self.subTest(e=e, friction=friction, nu=nu):
                self.assertLess(max(self.shear(rows[e, friction, nu], courant, end, changes)), 1e-6)

    def test_second_order(self):
        row = table()["0.7", "0.3", "0.55"]
        coarse, fine = (self.shear(row, courant, 3)[0] for courant in (0.8, 0.4))
        self.assertAlmostEqual(np.log2(coarse / fine), 2, delta=0.2)


class Refused(harness.Folder, unittest.TestCase):
    """What does not fit together is refused with file, line and what to do, by checkCase as by a run."""

    def said(self, *change):
        case = harness.copy("couetteSpheres", self.folder)
        replace(case, "constant/granularProperties", *change)
        harness.mesh(case, 8)
        done = harness.program("checkCase", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"granularProperties:\d+: ")
        return done.stderr

    def test_disks(self):
        self.assertIn("BerziVescovi is for spheres, equationOfState TorquatoDisks for disks", self.said("VescoviSpheres", "TorquatoDisks"))

    def test_packing(self):
        self.assertIn("lies from 0.5 to 0.7", self.said("cooling ", "VescoviSpheresCoeffs { alphaMax 0.4; } cooling "))

    def test_hard_grains(self):
        case = harness.copy("coolingDisksMD", self.folder)
        harness.mesh(case, 8)
        replace(case, "constant/granularProperties", "grain {", "grain { friction 0.5;")
        done = harness.program("granularMD", "-case", case, check=False)
        self.assertIn("hard grains do not rub: say  friction 0;", done.stderr)


if __name__ == "__main__":
    unittest.main()
