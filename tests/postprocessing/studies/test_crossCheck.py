# SPDX-License-Identifier: GPL-3.0-or-later
"""crossCheck through the real programs: Sod's tube in short, refusals, the limits in small, OpenFOAM's tools on what is written."""
import csv
import glob
import os
import subprocess
import sys
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.openfoam import foam
from tests.postprocessing.report import made as reports

import haff
from haff.case.geometry import Geometry
from studies.made import rhocentral, twin
from studies.measured import comparison

needs_foam = unittest.skipUnless(rhocentral.installed(), f"{rhocentral.MISSING}: no comparison")


def tool(*arguments):
    return harness.command("crossCheck", "--bin", harness.BIN, *arguments)


def rows(path):
    with open(path, newline="") as f:
        return list(csv.DictReader(f))


@needs_foam
class Sod(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.done = tool("sod", "--quick", "--out", cls.folder)
        cls.rows = rows(os.path.join(cls.folder, "sod.csv")) if cls.done.returncode in (0, 3) else []

    def values(self, quantity, name):
        return {int(r["cells"]): float(r["value"]) for r in self.rows if (r["quantity"], r["name"]) == (quantity, name)}

    def test_agrees(self):
        self.assertEqual(self.done.returncode, 0, self.done.stdout[-2000:] + self.done.stderr[-2000:])
        for words in ("The differences shrink", "Shocks agree within a cell", "is nearer"):
            self.assertIn(words, self.done.stdout)

    def test_numbers(self):
        """Both converge to the exact solution; each is nearer to it than half a per cent of the range in p on 100 cells."""
        for name in comparison.FIELDS:
            apart = self.values("difference", name)
            self.assertLess(apart[100], apart[50])
            for code in ("haff", "rhoCentralFoam"):
                error = self.values(f"error {code}", name)
                self.assertLess(error[100], 0.75 * error[50], f"{code} {name}")
            self.assertLessEqual(apart[100], sum(self.values(f"error {code}", name)[100] for code in ("haff", "rhoCentralFoam")))
        for code in ("haff", "rhoCentralFoam"):
            self.assertAlmostEqual(0.75 + self.values(f"shock {code}", "shock")[100], 0.850431, delta=0.01)

    def test_files(self):
        with open(os.path.join(self.folder, "sod.png"), "rb") as f:
            self.assertEqual(f.read(4), b"\x89PNG")


@needs_foam
class Triangles(harness.Folder, unittest.TestCase):
    @reports.white()
    def test_wedge15(self):
        """On a mesh without order: both within 5 % of the exact oblique shock in the mean, and nearer to each other than that."""
        done = tool("wedge15Dilute", "--grids", "20", "--out", self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        values = {(r["quantity"], r["name"]): float(r["value"]) for r in rows(os.path.join(self.folder, "wedge15Dilute.csv"))}
        for code in ("haff", "rhoCentralFoam"):
            self.assertLess(values[f"error {code}", "rho"], 0.05)
        self.assertLess(values["difference", "rho"], values["error rhoCentralFoam", "rho"])


@needs_foam
class Blocks(harness.Folder, unittest.TestCase):
    @reports.white()
    def test_fresh_from_openfoam(self):
        """A converted case whose mesh is system/blockMeshDict, which has no constant/polyMesh: blockMesh makes it for both. Of other grids it has none."""
        case = os.path.join(self.folder, "tube")
        done = harness.command("fromOpenFOAM", foam.tube(self.folder), case)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(os.path.exists(os.path.join(case, "constant", "polyMesh")))
        done = tool(case, "--out", os.path.join(self.folder, "out"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        values = {(r["quantity"], r["name"]): float(r["value"]) for r in rows(os.path.join(self.folder, "out", "tube.csv"))}
        self.assertLess(values["difference", "rho"], 0.05)  # three fronts, each over five of the 100 cells, a third of the range apart
        self.assertFalse(os.path.exists(os.path.join(case, "constant", "polyMesh")))
        self.assertIn("leave out --grids", tool(case, "--grids", "50", "--out", os.path.join(self.folder, "out")).stderr)


@needs_foam
class Refusals(harness.Folder, unittest.TestCase):
    def refused(self, name, *words, **changes):
        case = harness.copy(name, self.folder)
        for key, value in changes.items():
            twin.append(os.path.join(case, "constant", "granularProperties"), f"{key} {value}\n")
        done = tool(case, "--grids", "50", "--out", os.path.join(self.folder, "out"))
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_inelastic(self):
        self.refused("blast", "cooling Haff with restitution 0.9", "restitution 1, or cooling none")

    def test_dense(self):
        self.refused("blastElastic", "GoldshteinShapiro at a volume fraction of 0.0262", "10.5%", "grain diameter 0.021 or less")

    def test_gravity(self):
        self.refused("wall", "gravity (980 0 0)", cooling="none;")

    def test_dilute_grains_pass(self):
        """With the diameter that the refusal names the blast has a twin."""
        case = harness.copy("blastElastic", self.folder)
        twin.append(os.path.join(case, "constant", "granularProperties"), "grain { diameter 0.021; }\n")
        both = twin.Twin(case, os.path.join(self.folder, "twin"), harness.BIN, cells=50)
        p, T = (haff.read_field(os.path.join(both.foam, "0", name), 50) for name in ("p", "T"))
        np.testing.assert_allclose(p / T, np.repeat((44.5, 50), 25), rtol=1e-3)


class Translation(unittest.TestCase):
    """Rules of patches, without OpenFOAM."""

    def patch(self, velocity, density, energy, pressure=True):
        none = lambda kind: (kind, None)
        part = lambda rule: none(rule) if isinstance(rule, str) else (rule[0], np.array(rule[1], float))
        return twin.translate("inlet", "patch", part(velocity), part(density), part(energy), pressure)

    def test_values(self):
        given = self.patch(("fixedValue", [3, 0, 0]), ("fixedValue", [2]), ("fixedValue", [5]))
        self.assertEqual(given, {"p": "fixedValue; value uniform 5", "T": "fixedValue; value uniform 2.5",
                                 "U": "fixedValue; value uniform (3 0 0)"})
        given = self.patch("zeroGradient", ("inletOutlet", [2]), ("inletOutlet", [5]), pressure=False)
        self.assertEqual(given["p"], "inletOutlet; inletValue uniform 10; value uniform 10")
        self.assertEqual(given["T"], "inletOutlet; inletValue uniform 5; value uniform 5")
        given = self.patch("zeroGradient", ("fixedValue", [[2], [4]]), ("fixedValue", [[6], [8]]))
        self.assertEqual(given["T"], "fixedValue; value nonuniform List<scalar> 2(3 2)")

    def test_kinds(self):
        self.assertEqual(self.patch("slip", "zeroGradient", "zeroGradient"), {"p": "zeroGradient", "U": "slip", "T": "zeroGradient"})
        self.assertEqual(twin.translate("sides", "empty", *[("empty", None)] * 3, True), dict.fromkeys("pUT", "empty"))
        with self.assertRaisesRegex(twin.Refused, "noSlip"):
            self.patch("noSlip", "zeroGradient", "zeroGradient")
        with self.assertRaisesRegex(twin.Refused, "rho fixedValue with p zeroGradient"):
            self.patch("zeroGradient", ("fixedValue", [2]), "zeroGradient")


class Positions(unittest.TestCase):
    def test_shock(self):
        """A smeared front across a lattice that is not along its axes is found to a tenth of a cell."""
        n, front = 40, 0.613
        x, y = (c.ravel() for c in np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n))
        geometry = Geometry.__new__(Geometry)
        geometry.at, geometry.axes, geometry.h = np.stack([x, y], axis=1), [0, 1], 1 / n
        rho = 1 - np.tanh(((x + y) / np.sqrt(2) - front) * n / 1.5)
        found = comparison.shock(geometry, rho, ((0.1, 0.1, 0), (0.9, 0.9, 0)))
        self.assertAlmostEqual(0.1 * np.sqrt(2) + found, front, delta=0.1 / n)


class Limits(harness.Folder, unittest.TestCase):
    @reports.white()
    def test_short(self):
        """Three steps on 50 cells: the elastic sweeps are of first order by then, the one in e at once."""
        done = tool("--limits", "--quick", "--out", self.folder)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        found = rows(os.path.join(self.folder, "limits.csv"))
        for series, small, low, high in (("sigma", "nu", 0.9, 1.1), ("e", "loss", 0.9, 1.1), ("both", "nu", 0.8, 1.1), ("inelastic", "nu", 0.4, 0.75)):
            (_, a, b) = [r for r in found if r["series"] == series]
            order = np.log(float(a["rho"]) / float(b["rho"])) / np.log(float(a[small]) / float(b[small]))
            with self.subTest(series):
                self.assertGreater(order, low)
                self.assertLess(order, high)
        exact = [(float(r["rho"]), float(r["exact"])) for r in found if r["exact"]]
        for ours, known in exact:
            self.assertAlmostEqual(ours / known, 1, delta=0.25)


@needs_foam
class Tools(harness.Folder, unittest.TestCase):
    def foam(self, name, case, *arguments):
        done = subprocess.run([name, "-case", case, *arguments], capture_output=True, text=True, env=rhocentral.ENVIRONMENT)
        self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])
        return done.stdout

    def openfoam_takes(self, name, cells, end):
        """Both twins of a case: checkMesh and foamToVTK; granularGas on two ranks through reconstructPar."""
        both = twin.Twin(os.path.join(harness.SOURCE, "cases", name), self.folder, harness.BIN, cells=cells)
        for case, more in ((both.ours, "writeProcessors yes;"), (both.foam, "")):
            twin.append(os.path.join(case, "system", "controlDict"), f"endTime {end}; writeInterval {end}; {more}\n")
        harness.program("granularGas", "-case", both.ours, ranks=2)
        self.foam("rhoCentralFoam", both.foam)
        for case in (both.ours, both.foam):
            self.assertIn("Mesh OK.", self.foam("checkMesh", case))
            self.foam("foamToVTK", case, "-latestTime", "-name", "fromOpenFOAM")
            self.assertTrue(glob.glob(os.path.join(case, "fromOpenFOAM", "*", "internal.vtu")))
        path, count = os.path.join(both.ours, str(end)), haff.Case(both.ours).mesh.cells
        gathered = {field: haff.read_field(os.path.join(path, field), count) for field in comparison.FIELDS}
        for field in gathered:
            os.remove(os.path.join(path, field))
        self.foam("reconstructPar", both.ours, "-latestTime")
        for field, values in gathered.items():
            np.testing.assert_array_equal(haff.read_field(os.path.join(path, field), count), values, err_msg=field)

    def test_periodic_lattice(self):
        self.openfoam_takes("vortex", 16, 0.1)

    def test_triangles(self):
        self.openfoam_takes("wedge15Dilute", 10, 0.01)


class Arguments(harness.Folder, unittest.TestCase):
    def test_help_and_mistakes(self):
        self.assertIn("--limits", tool("-help").stdout)
        for wrong, words in ((("sod", "--grids", "a,b"), "whole numbers"), ((), "give a case")):
            done = tool(*wrong)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)

    def test_without_openfoam(self):
        """Skipped, with a line that says what is missing."""
        done = subprocess.run([sys.executable, "-m", "haff", "crossCheck", "sod", "--bin", harness.BIN, "--out", self.folder], capture_output=True, text=True,
                              env={"PATH": "/nowhere", "PYTHONPATH": os.environ["PYTHONPATH"]})
        self.assertEqual(done.returncode, 77)
        self.assertIn("rhoCentralFoam (package openfoam) is not installed", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
