# SPDX-License-Identifier: GPL-3.0-or-later
"""Which laws of transport go with which grains, in one, two and three dimensions, and what the programs say of a choice."""
import os
import unittest

import numpy as np

from tests.cases import harness

SHAPES = ((8, 1, 1), (6, 4, 1), (4, 3, 2))
COEFFS = "GarzoDufty; GarzoDuftyCoeffs { alphaMin 1e-3; knudsenCut 0.02; zetaU full; stress %s; }"


class Choices(harness.Folder, unittest.TestCase):
    def box(self, name, n, eos, transport):
        """Warm gas that shears and is denser in the middle, in a periodic box."""
        size = tuple(0.5 * k for k in n)
        x, y, z = harness.boxes.centres(n, size).T
        phase = 2 * np.pi * x / size[0]
        rho, u = 20 - 5 * np.cos(phase), np.stack([0.3 * np.sin(phase), np.cos(phase), 0 * x], axis=1)
        u[:, 1] *= n[1] > 1
        case = harness.box_case(os.path.join(self.folder, name), n, size, rho, u, 10 + 0 * rho, 0.02, eos=eos, e=0.8,
                                gamma=2.0 if "Disks" in eos else 5 / 3, cooling="GarzoDufty",
                                types=dict.fromkeys("xyz", "cyclic"))
        harness.edit(case, "constant/granularProperties", transport=transport, diameter="0.2")
        return case

    def test_grains_and_dimensions(self):
        """Disks by both laws, spheres by Garzo & Dufty's, which runs and conserves mass; disks not in 3D."""
        for eos in ("perfectGas", "GoldshteinShapiro", "TorquatoDisks", "TorquatoSpheres"):
            disks = eos == "TorquatoDisks"
            for n in SHAPES:
                dim = sum(k > 1 for k in n)
                for transport in ("JenkinsRichman", "GarzoDufty"):
                    case = self.box(f"{eos}{dim}{transport}", n, eos, transport)
                    with self.subTest(f"{eos} {dim}D {transport}"):
                        done = harness.program("checkCase", case, check=False)
                        if transport == "JenkinsRichman" and not disks:
                            self.assertIn(f"JenkinsRichman is for disks, equationOfState {eos} for spheres", done.stderr)
                        elif disks and dim == 3:
                            self.assertIn("is for disks, which move in one or two dimensions", done.stderr)
                        else:
                            self.assertIn("The case ", done.stdout, done.stderr)
                            self.assertRegex(done.stdout, rf"transport +{transport}\n")
                            harness.program("granularGas", "-case", case)
                            result = harness.haff.Case(case)
                            self.assertAlmostEqual(result.field("rho").mean(), 20, delta=1e-13 * 20)
                            self.assertTrue((result.field("T") > 0).all())

    def test_values_are_listed(self):
        """Each parameter as it was read, or with its default; -listModels has the law with ranges and words."""
        case = self.box("listed", SHAPES[1], "TorquatoSpheres", COEFFS % "diagonal")
        for said in (harness.program("checkCase", case).stdout, harness.program("granularGas", "-case", case).stdout):
            for line in ("transport +GarzoDufty", "alphaMin +0.001", "knudsenCut +0.02", "zetaU +full", "stress +diagonal"):
                self.assertRegex(said, rf"(?m)^ +{line}$")
        plain = harness.program("checkCase", self.box("plain", SHAPES[1], "TorquatoSpheres", "GarzoDufty")).stdout
        for line in ("alphaMin +0.0001", "knudsenCut +0", "zetaU +off", "stress +full"):
            self.assertRegex(plain, rf"(?m)^ +{line}$")
        listed = harness.program("granularGas", "-listModels").stdout
        law = listed[listed.index("  GarzoDufty           viscosities"):]
        for line in (r"alphaMin +0.0001 +0 .. 0.1 ", r"knudsenCut +0 +0 .. 1 ", "zetaU +off +or geometric, full ",
                     "stress +full +or diagonal "):
            self.assertRegex(law[:law.index("sources")], rf"(?m)^ +{line}")

    def test_polyhedra(self):
        """A lattice that is run as polyhedra: the full stress runs, the diagonal one is refused."""
        for stress in ("full", "diagonal"):
            case = self.box("polyhedra" + stress, SHAPES[2], "TorquatoSpheres", COEFFS % stress)
            harness.edit(case, "system/fvSchemes", reconstruct="PHM; meshEngine polyhedral")
            done = harness.program("granularGas", "-case", case, check=False)
            if stress == "full":
                self.assertRegex(done.stdout, r"meshEngine +polyhedral")
                self.assertEqual(done.returncode, 0, done.stderr)
            else:
                self.assertEqual(done.returncode, 1)
                self.assertIn("stress diagonal is for lattices", done.stderr)
                self.assertIn("granularProperties:", done.stderr)


if __name__ == "__main__":
    unittest.main()
