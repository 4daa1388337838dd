# SPDX-License-Identifier: GPL-3.0-or-later
"""Implicit acoustics of dense cells on triangles, tetrahedra and hexahedra: rest, bounds and budgets, the same bits on any number of ranks
and over restarts, the lattice's answer on its own boxes, and heat that cold dense cells beside hot thin gas can bear."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.polyhedral import test_rest
from tests.cases.runtime import test_energyBudget as audit

LIMIT = 0.82  # alphaMax of TorquatoDisks
BLOCK = 'expression "x < 7 && y < 6 ? 0.7 : 1e-4";'


class Acoustics(harness.Folder, unittest.TestCase):
    gmsh, shear, layer = test_rest.Rest.gmsh, test_rest.Rest.shear, test_rest.Rest.bed

    def bed(self, name, mesh, end, coefficients="", acoustics="implicit", poly="linear", **options):
        """What tests.cases.polyhedral.test_rest lays, with steps as long as they may be."""
        case = self.layer(name, mesh, poly, **options)
        harness.write_dictionary(case, "system", "fvSolution", f"acoustics {{ type {acoustics}; implicitCoeffs {{ {coefficients} }} }}\n"
                                 if acoustics == "implicit" else "acoustics { type explicit; }\n")
        harness.edit(case, test_rest.CONTROL, adjustTimeStep="yes", deltaT=1e-3, endTime=end, writeInterval=end / 4, maxCo=1)
        return case

    def block(self, name, mesh="triangles", end=0.8, **options):
        """A block of cold dense disks falls in a corner and breaks."""
        case = self.bed(name, mesh, end, alpha=BLOCK, T="x < 7 && y < 6 ? 0.02 : 0.5", **options)
        harness.edit(case, test_rest.PROPERTIES, cooling="Haff", restitution="0.9; thresholdSpeed 0.3")
        return case

    def run_case(self, case, ranks=1):
        done = harness.program("granularGas", "-case", case, ranks=ranks)
        return harness.haff.Case(case), done.stdout

    def same(self, a, b, time):
        for name in ("rho", "rhoU", "rhoE"):
            np.testing.assert_array_equal(a.field(name, time), b.field(name, time))

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_rest(self):
        """A layer that settledLayer lays keeps still, in the bed, beside it, and across its border."""
        tetrahedra = dict(alpha="settledLayer { depth 4.5; packing 0.5; }", n=(4, 4, 8), size=(3.0, 3.0, 6.0), up=2, eos="GoldshteinShapiro")
        for mesh, dense, options in (("sheared", 0.6, {}), ("triangles", 0.6, {}), ("triangles", 0.05, dict(poly="CWENO3")),
                                     ("tetrahedra", 0.5, tetrahedra)):
            with self.subTest(f"{mesh} {dense}"):
                case = self.bed(f"rest{mesh}{dense}", mesh, 2.0, f"dense {dense}; gain 1;", T=5.0, **options)
                result, log = self.run_case(case)
                self.assertIn("implicit acoustics", log)
                self.assertLess(np.abs(result.field("U")).max() / np.sqrt(5), 1e-11)
                np.testing.assert_allclose(result.field("T"), 5, rtol=1e-10)

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_bits_on_ranks_and_over_restarts(self):
        whole, log = self.run_case(self.block("whole", end=0.4))
        self.assertIn("implicit acoustics", log)
        self.same(whole, self.run_case(self.block("ranks", end=0.4), 3)[0], "0.4")
        again = os.path.join(self.folder, "again")
        shutil.copytree(whole.path, again)
        for time in ("0.3", "0.4"):
            shutil.rmtree(os.path.join(again, time))
        self.same(whole, self.run_case(again, 2)[0], "0.4")

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_bounds_and_budget(self):
        """Packing is a bound, no mass is lost, energy comes from named causes; fewer steps than with explicit acoustics."""
        steps = {}
        for acoustics in ("implicit", "explicit"):
            case = self.block("budget" + acoustics, acoustics=acoustics)
            audit.ask(case)
            result, log = self.run_case(case)
            b = audit.budget(result)
            scale = max(np.abs(b[name]).max() for name in audit.COLUMNS[5:12])
            self.assertLess(np.abs(b["residual"]).max(), 1e-11 * scale)
            self.assertLess(np.abs(b["massResidual"]).max(), 1e-12 * b["mass"][0])
            self.assertTrue(0.95 * LIMIT < result.field("alpha").max() < LIMIT)
            self.assertGreater(result.field("T").min(), 0)
            steps[acoustics] = int(re.findall(r"(\d+) steps in", log)[-1])
        self.assertLess(1.5 * steps["implicit"], steps["explicit"])

    def test_boxes(self):
        """Both engines on the same boxes, with the same flux: on polyhedra no face follows a rule of its own."""
        fields = []
        for mesh in ("lattice", "boxes"):
            case = self.block("engine" + mesh, mesh, n=(24, 20, 1), size=(12.0, 10.0, 0.5))
            runs.add(case, "system/fvSchemes", "commonCoeffs { shocks off; expansions off; contacts off; }\n")
            result, log = self.run_case(case)
            self.assertIn("implicit acoustics", log)
            mass = result.field("rho") * result.volumes
            fields.append(mass @ result.centres / mass.sum())
        np.testing.assert_allclose(fields[1], fields[0], atol=0.02)

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_cold_cells_beside_hot_gas(self):
        """Heat does not take from cold cells what they do not have: no half step of diffusion is done twice."""
        case = self.bed("hot", "triangles", 0.02, acoustics="explicit", alpha='expression "y < 5 ? 0.6 : 1e-3";',
                        T="y < 5 ? 1e-4 : 10")
        harness.edit(case, test_rest.PROPERTIES, transport="JenkinsRichman")
        result, log = self.run_case(case)
        self.assertNotIn("repeated", log)
        self.assertGreater(result.field("T").min(), 0)


if __name__ == "__main__":
    unittest.main()
