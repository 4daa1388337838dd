# SPDX-License-Identifier: GPL-3.0-or-later
"""newCase -chute, -silo, -column, and gravity that is inclined to a floor: sound, without a warning, and they do what their names say."""
import os
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import haff
from haff.case import entries


@unittest.skipUnless(shutil.which("gmsh"), "gmsh is not there")
class Problems(harness.Folder, unittest.TestCase):
    def call(self, *words, code=0):
        done = harness.command("newCase", *words, cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def run_new(self, end, *words):
        """(case after a run to `end`, what newCase said) of a sound new case, whose name has a blank."""
        name = f"my {words[0][1:]}"
        said = self.call(name, *words)
        self.assertIn("checkCase finds sound", said)
        self.assertIn(f"\n    cd '{name}' && ./Allrun\n", said)
        path = os.path.join(self.folder, name)
        if end:
            entries.edit(os.path.join(path, "system", "controlDict"), {"endTime": end, "writeInterval": end})
            with tempfile.TemporaryDirectory() as first:  # whose haff makes no report, which takes longer than the run
                os.symlink("/usr/bin/false", os.path.join(first, "haff"))
                subprocess.run([os.path.join(path, "Allrun")], check=True, capture_output=True, env={**os.environ, "PATH": f"{first}:{harness.BIN}:{os.environ['PATH']}"})
        return haff.Case(path), said

    def mean(self, case, values, time=None):
        """Over the mass."""
        mass = case.field("rho", time) * case.volumes
        return (mass * values).sum() / mass.sum()

    def test_chute(self):
        """The layer slides down faster on a steeper floor, and slower than without friction; that it has friction is said once."""
        speed = {}
        for angle in (15, 30):
            case, said = self.run_new("0.1", "-chute", str(angle))
            self.assertEqual(said.count("friction { type muI; }"), 1)
            g = entries.get(os.path.join(case.path, "constant", "g"), "value")
            np.testing.assert_allclose(g, 9.81 * np.array([np.sin(np.radians(angle)), -np.cos(np.radians(angle)), 0]), rtol=1e-5)
            self.assertTrue(case.lattice())
            speed[angle] = self.mean(case, case.field("U")[:, 0])
            self.assertLess(speed[angle], 0.1 * g[0])
            for field in "UT":
                self.assertEqual(entries.get(os.path.join(case.path, "0.orig", field), "boundaryField/floor/type"), "JohnsonJacksonSlip")
            self.assertEqual(entries.get(os.path.join(case.path, "0.orig", "alpha"), "boundaryField/top/type"), "fixedValue")
            self.assertEqual(case.table("budget").shape[1] > 5, True)
            shutil.rmtree(case.path)
        self.assertGreater(speed[15], 0)
        self.assertGreater(speed[30], speed[15])

    def test_silo(self):
        """What runs through the slot by its flow rate is what is lost above it."""
        case, said = self.run_new("0.03", "-silo", "12")
        self.assertEqual(said.count("friction { type muI; }"), 1)
        with open(os.path.join(case.path, "log.granularGas")) as f:
            self.assertNotRegex(f.read(), "(?m)^warning")
        self.assertEqual(entries.get(os.path.join(case.path, "system", "fvSolution"), "acoustics/type"), "implicit")
        table = case.table("discharge", frame=True)
        self.assertTrue(case.lattice())
        time, flow = (np.asarray(table[name], float) for name in (list(table.columns) if hasattr(table, "columns") else table.dtype.names)[:2])
        through = ((flow[1:] + flow[:-1]) / 2 * np.diff(time)).sum()
        above = case.centres[:, 1] > -1.5e-3
        half = np.abs(case.centres[:, 1] + 1.5e-3) < 1e-5  # the plane goes through the middle of these cells
        mass = [(case.field("rho", t) * case.volumes * np.where(half, 0.5, above)).sum() for t in ("0", None)]
        # the rate is that of the end of a step, linear within half a cell: some per cent while the flow begins
        self.assertAlmostEqual(through / (mass[0] - mass[1]), 1, delta=0.05)
        self.assertGreater(through, 0)
        self.assertEqual(len(case.table("content")) > 1, True)

    def test_column(self):
        """It loses height, gains length, and nothing is lost."""
        case, said = self.run_new("0.05", "-column", "0.5")
        self.assertEqual(said.count("friction { type muI; }"), 1)
        x, y = case.centres[:, 0], case.centres[:, 1]
        self.assertAlmostEqual(self.mean(case, y, "0"), 4e-3, delta=2e-4)  # 8 diameters high; the rest is a thin gas
        self.assertLess(self.mean(case, y), 0.95 * self.mean(case, y, "0"))
        self.assertGreater(self.mean(case, x), 1.05 * self.mean(case, x, "0"))
        mass = [(case.field("rho", t) * case.volumes).sum() for t in ("0", None)]
        self.assertAlmostEqual(mass[1] / mass[0], 1, delta=1e-12)

    def test_inclined_gravity(self):
        """A layer lies on the floor that gravity points to within 60 degrees, also if that is not below."""
        case, said = self.run_new(None, "-gravity=3.4,-9.2,0", "-box", "2x30", "-cells", "2x30", "-periodic", "left,right", "-diameter", "1")
        self.assertIn("a layer, 7.5 diameters deep", said)
        self.assertIn("patch    top              outlet: an open side: the flow leaves as it comes, under gravity into a void, for the floor is inclined; else  -patch top=wall", said)
        for field, kind in (("alpha", "fixedValue"), ("U", "zeroGradient"), ("T", "zeroGradient")):
            self.assertEqual(entries.get(os.path.join(case.path, "0.orig", field), "boundaryField/top/type"), kind)
        self.assertEqual(entries.get(os.path.join(case.path, "0.orig", "alpha"), "expression"), "y < 7.5 ? 0.6 : 1e-6")
        said = self.call("other", "-gravity=9,3,0", "-box", "30x4", "-cells", "30x4", "-diameter", "1")
        self.assertEqual(entries.get(os.path.join(self.folder, "other", "0.orig", "alpha"), "expression"), "x > 22.5 ? 0.6 : 1e-6")
        self.assertIn("a layer", said)
        self.assertIn("patch    left             outlet", said)
        self.call("lid", "-gravity=3.4,-9.2,0", "-box", "2x30", "-cells", "2x30", "-diameter", "1", "-patch", "top=wall")
        self.assertEqual(entries.get(os.path.join(self.folder, "lid", "0.orig", "U"), "boundaryField/top/type"), "slip")

    def test_refused(self):
        for words, says in ((["-chute", "95"], "up to 60"), (["-silo", "5"], "an even number of 4 to 24"), (["-column", "20"], "0.2 to 10"),
                            (["-chute", "20", "-silo"], "leave out  -silo"), (["-chute", "20", "-box", "1x1"], "leave out  -box"),
                            (["-chute", "20", "-gravity", "0,-1,0"], "give its size"), (["-column", "-cells", "4x4"], "cells of its own"),
                            (["-chute", "20", "-application", "granularMD"], "a problem of granularGas"), (["-silo", "-diameter", "-1"], "a number above 0")):
            self.assertIn(says, self.call("refused", *words, code=2))
        self.assertIn("walls are smooth", self.call("refused", "-box", "1x1", "-patch", "bottom=rough", "-application", "granularMD", code=1))

    def test_grid_study(self):
        """haff sweep sets the numbers of mesh.geo that newCase wrote, of boxes and of problems."""
        for words, name, values in ((["-box", "1", "-cells", "10"], "N", (10, 20)), (["-silo"], "D", (6, 8))):
            path = os.path.join(self.folder, f"study {name}")
            self.call(path, *words)
            entries.edit(os.path.join(path, "system", "controlDict"), {"endTime": "1e-4", "writeInterval": "1e-4"})
            done = harness.command("sweep", path, f"mesh:{name}={values[0]},{values[1]}", "-quiet")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            cells = [haff.Case(os.path.join(f"{path}-sweep", f"{name}={value}")).mesh.cells for value in values]
            self.assertLess(*cells)


if __name__ == "__main__":
    unittest.main()
