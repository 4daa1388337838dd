# SPDX-License-Identifier: GPL-3.0-or-later
"""A start as its user writes it, 0.orig, and the time 0 that programs make of it for all who read the case."""
import os
import re
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.grains.test_particles import grains

haff = harness.haff
LAYER = "settledLayer { depth 6; packing 0.82; hydrostatic yes; background 1e-6; } perturbation { modes 3; amplitude 1e-2; of depth; }"


class Original(harness.Folder, unittest.TestCase):
    def bubble(self, name, polyhedral=False, **options):
        """A case whose alpha is an expression."""
        case = runs.make(os.path.join(self.folder, name), (24, 16, 1), 0.01, interval=0.005, **options)
        os.remove(case + "/0/rho")
        alpha = harness.boxes.header("volScalarField", "alpha", "0.orig") + (
            'dimensions [0 0 0 0 0 0 0];\nexpression "0.06 + 0.02*sin(3*x)*cos(2*y)";\nboundaryField\n{\n".*" { type zeroGradient; }\nzEmpty { type empty; }\n}\n')
        with open(case + "/0/alpha", "w") as f:
            f.write(alpha)
        if polyhedral:
            runs.add(case, "system/fvSchemes", "meshEngine polyhedral; polyReconstruct CWENO3;\n")
        os.rename(case + "/0", case + "/0.orig")
        return case

    def faraday(self, name, **control):
        """The shipped layer on a coarser mesh."""
        case = harness.copy("faraday", self.folder)
        harness.mesh(case, 120)
        harness.edit(case, "0.orig/alpha", modes=3)
        harness.edit(case, "system/controlDict", **control)
        harness.drop_vtk(case)
        return case

    def same(self, a, b):
        """What runs wrote, byte for byte, but for the start."""
        left, right = ({k: v for k, v in runs.results(c).items() if not k.startswith("0/")} for c in (a, b))
        self.assertGreater(len(left), 10)
        self.assertEqual(left, right)

    def test_bits(self):
        """From 0.orig, from the same folder called 0, and from the time 0 that was written: the same run, on both engines."""
        for polyhedral in (False, True):
            with self.subTest(polyhedral=polyhedral):
                first = self.bubble(f"first{polyhedral}", polyhedral)
                plain, written = (shutil.copytree(first, first + kind) for kind in ("plain", "written"))
                said = harness.program("granularGas", "-case", first, ranks=2).stdout
                self.assertEqual(re.findall("written: (.*)", said), ["0", "0.005", "0.01"])
                os.rename(plain + "/0.orig", plain + "/0")
                self.assertRegex(harness.program("granularGas", "-case", plain).stdout, r"warning: .*/0/alpha:\d+: .*rename the folder to 0.orig.*unevaluated")
                self.same(first, plain)
                harness.program("initialFields", written)
                self.assertEqual(runs.times(written), ["0"])
                shutil.rmtree(written + "/0.orig")
                harness.program("granularGas", "-case", written)
                self.same(first, written)
                harness.edit(first, "system/controlDict", startFrom="firstTime")
                said = harness.program("granularGas", "-case", first).stdout  # 0 is made again, as 0.orig may have changed
                self.assertEqual(re.findall("written: (.*)", said), ["0", "0.005", "0.01"])
                self.same(first, plain)

    def test_rest(self):
        """Polyhedra find the settledLayer in 0.orig, also when a run goes on; it rests in both parts."""
        case = self.faraday("rest", endTime=0.004, writeInterval=0.002)
        harness.edit(case, "0.orig/alpha", amplitude="0")
        os.remove(case + "/constant/shaking")
        runs.add(case, "system/fvSchemes", "meshEngine polyhedral; polyReconstruct CWENO3;\n")
        part = shutil.copytree(case, case + "_part")
        harness.program("granularGas", "-case", case)
        harness.edit(part, "system/controlDict", endTime=0.002)
        harness.program("granularGas", "-case", part)
        harness.edit(part, "system/controlDict", endTime=0.004)
        self.assertNotIn("the start is gone", harness.program("granularGas", "-case", part).stdout)
        whole, parts = (haff.Case(c).field("rhoE", "0.004") for c in (case, part))
        np.testing.assert_array_equal(whole, parts)

    def test_values(self):
        """Time 0 holds what the expression and the rest of the start say; every field is there, in ascii and binary."""
        for format in ("ascii", "binary"):
            case = self.bubble("values_" + format, format=format)
            done = harness.program("caseToVTK", case, check=False)
            self.assertIn(f"initialFields {case}  writes the time 0", done.stderr)
            harness.program("initialFields", case)
            result = haff.Case(case)
            x, y, _ = result.centres.T
            np.testing.assert_allclose(result.field("alpha", "0"), 0.06 + 0.02 * np.sin(3 * x) * np.cos(2 * y), rtol=1e-14)
            np.testing.assert_allclose(result.field("p", "0"), haff.read_field(case + "/0.orig/p", result.mesh.cells), rtol=1e-13)
            for field in ("rho", "U", "T", "rhoU", "rhoE"):
                self.assertEqual(len(result.field(field, "0")), result.mesh.cells)
            harness.program("caseToVTK", case, "-time", "0")
            self.assertTrue(os.path.isfile(f"{case}/VTK/values_{format}_0.vtk"))

    def test_purge(self):
        """purgeWrite counts the times of the run, not its start."""
        case = self.bubble("purge", purge=1)
        harness.program("granularGas", "-case", case)
        self.assertEqual(runs.times(case), ["0", "0.01"])

    def test_changed(self):
        """A change in the 0 that a run wrote is not lost in silence; a run that goes on from later does not care."""
        case = self.bubble("changed", format="ascii")
        harness.program("granularGas", "-case", case)
        harness.program("checkCase", case)
        with open(case + "/0/alpha", "a") as f:
            f.write("// mine\n")
        harness.edit(case, "system/controlDict", endTime=0.02)
        harness.program("checkCase", case)
        harness.edit(case, "system/controlDict", startFrom="firstTime")
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"/0: a run writes it anew from 0.orig: make changes there and remove this folder(.|\n)*/0/alpha")
        shutil.rmtree(case + "/0")
        harness.program("granularGas", "-case", case)

    def test_refused(self):
        case = self.bubble("refused")
        shutil.copytree(case + "/0.orig", case + "/0")
        os.utime(case + "/0.orig/alpha", (2e9, 2e9))  # a newer 0 would count: tests/cases/openfoam/test_taken.py
        for program in (("checkCase", case), ("granularGas", "-case", case), ("initialFields", case)):
            done = harness.program(*program, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn("/0: 0.orig is there, too, from which a run writes the time 0, and no run has written this folder", done.stderr)
        shutil.rmtree(case + "/0.orig")
        done = harness.program("initialFields", case, check=False)
        self.assertIn("there is no folder 0.orig to write the time 0 from", done.stderr)
        shutil.rmtree(case + "/0")
        self.assertIn("the initial fields belong in", harness.program("granularGas", "-case", case, check=False).stderr)

    def test_gas_and_grains(self):
        """One word makes grains of the gas: as many as the layer holds, as high up as there."""
        case = self.faraday("word", endTime=1e-5)
        harness.program("granularGas", "-case", case)
        alpha = haff.Case(case).field("alpha", "0")
        area = haff.Case(case).volumes / np.ptp(haff.Case(case).mesh.points[:, 2])
        harness.edit(case, "system/controlDict", application="granularMD")
        self.assertIn("The case is sound.", harness.program("checkCase", case, "-strict").stdout)
        harness.program("initialFields", case)
        number = len(grains.read(haff.Case(case), "0")["x"])
        self.assertAlmostEqual(number * np.pi / 4 / (alpha * area).sum(), 1, delta=1e-3)
        y, places = haff.Case(case).centres[:, 1], grains.read(haff.Case(case), "0")["x"]
        height = (alpha * y).sum() / alpha.sum()
        self.assertGreater(height, 3)
        self.assertAlmostEqual(places[:, 1].mean(), height, delta=0.5)  # a radius: no grain is nearer to the floor

    def test_walls(self):
        """granularWall { restitution } of T means the same to grains as walls { } of particleProperties; both may not differ."""
        case = self.faraday("walls", endTime=1e-5, application="granularMD")
        with open(case + "/0.orig/T") as f:
            text = f.read()
        self.assertIn('"(floor|lid)" { type zeroGradient; }', text)
        with open(case + "/0.orig/T", "w") as f:
            f.write(text.replace('"(floor|lid)" { type zeroGradient; }',
                                 "floor { type granularWall; restitution 0.7; } lid { type zeroGradient; }"))
        self.assertRegex(harness.program("granularMD", "-case", case, "-dry-run").stdout, r"walls, restitution 0.7 and 1\n")
        with open(case + "/constant/particleProperties", "w") as f:
            f.write(harness.boxes.header("dictionary", "particleProperties", "constant") + "walls { floor { restitution 0.8; } }\n")
        done = harness.program("granularMD", "-case", case, check=False)
        self.assertRegex(done.stderr, r"0.orig/T:\d+: patch floor: restitution is 0.7 here, and 0.8 in line \d+ of constant/particleProperties")

    def test_other_shape(self):
        """A gas of spheres whose grains would be disks."""
        case = self.faraday("shape", application="granularMD")
        harness.edit(case, "constant/granularProperties", equationOfState="TorquatoSpheres")
        self.assertRegex(harness.program("checkCase", case).stdout, r"warning: .*:\d+: equationOfState TorquatoSpheres is of spheres.*\[otherShape\]")

    @unittest.skipUnless(shutil.which("foamToVTK"), "OpenFOAM is not installed")
    def test_foamToVTK(self):
        case = self.faraday("foam")
        harness.program("initialFields", case)
        done = subprocess.run(["foamToVTK", "-case", case, "-time", "0"], capture_output=True, text=True, cwd=case,
                              env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
        self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])


if __name__ == "__main__":
    unittest.main()
