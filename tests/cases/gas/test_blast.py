# SPDX-License-Identifier: GPL-3.0-or-later
"""Blast waves: elastic against the exact solution, inelastic against the prototype, clustering ordered by restitution."""
import unittest

from tests.cases import harness
from studies.checks.errors import blast_error


class Blast(harness.Folder, unittest.TestCase):
    def test_elastic(self):
        errors = {}
        for cells in (250, 500):
            case = self.short("blastElastic", cells, writeInterval=5.48)
            self.compare(case, harness.entries("blastElastic", cells=cells))
            errors[cells] = blast_error(case, "rho", case.times[-1])
        self.assertLess(errors[500], 0.7 * errors[250], "the error does not fall with the grid")

    def test_every_scheme_converges(self):
        """The contact of a scheme of order r is smeared over h^(r/(r+1)), at worst h^(1/2); the shocks converge faster."""
        case = self.short("blastElastic", 125, writeInterval=5.48)  # made once; the runs below only change the scheme
        fluxes = ("common", "Marquina", "LaxFriedrichs", "globalLaxFriedrichs")
        schemes = [(f, r) for f in fluxes for r in ("PHM", "WPENO5", "WENO5", "WENOZ", "TENO5", "firstOrder")] + [
            ("Rusanov", "firstOrder")]
        errors = {}
        for cells in (125, 250):
            harness.mesh(case.path, cells)
            harness.edit(case.path, "system/controlDict", startFrom="startTime")
            for scheme in schemes:
                harness.edit(case.path, "system/fvSchemes", fluxScheme=scheme[0], reconstruct=scheme[1])
                result = harness.run(case.path)
                errors[scheme, cells] = blast_error(result, "rho", result.times[-1])
        for scheme in schemes:
            with self.subTest(scheme):
                coarse, fine = errors[scheme, 125], errors[scheme, 250]
                self.assertLess(fine, coarse / 2 ** 0.5, f"errors {coarse:.4f}, {fine:.4f}")
                if scheme[1] != "firstOrder":
                    self.assertLess(fine, errors[(scheme[0], "firstOrder"), 250])

    def test_inelastic(self):
        packing = []
        for e in (0.9, 0.7, 0.2, 0):
            case = harness.copy("blast", self.folder)
            harness.edit(case, "constant/granularProperties", restitution=e)
            harness.mesh(case, 500)
            result = harness.run(case, writeInterval=5.48)
            packing.append(result.field("alpha").max())
            wanted = [x for x in harness.entries("blast") if x["restitution"] == e]
            if wanted:
                self.compare(result, wanted)
        self.assertLess(packing[0] * 1.5, packing[1], "e = 0.7 clusters far more than 0.9")
        self.assertLess(packing[1] * 2, packing[2], "e = 0.2 clusters far more than 0.7")
        self.assertLess(packing[2] * 1.1, packing[3], "and e = 0 even more")

    def test_dense(self):
        self.compare(self.short("blastDense", 2000, endTime=4), harness.entries("blastDense"))

    def test_through_the_collapse(self):
        """Grains that stick, far beyond the collapse: a packed cluster moves, and no mass is lost."""
        case = harness.copy("blastDense", self.folder)
        harness.mesh(case, 250)
        harness.edit(case, "constant/granularProperties", restitution=0)
        harness.edit(case, "system/controlDict", endTime=4, writeInterval=4)
        stopped = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(stopped.returncode, 2)
        self.assertIn("inelastic collapse", stopped.stderr)
        harness.edit(case, "constant/granularProperties", thresholdSpeed=0.04)
        harness.edit(case, "system/controlDict", startFrom="startTime")
        result = harness.run(case)
        alpha, rho = (result.field(name, 4) for name in ("alpha", "rho"))
        self.assertTrue(0.64 < alpha.max() < 0.65)
        flown_in = 178 * 0.698 * 4
        self.assertAlmostEqual(rho.sum() * 10 / 250 / (178 * 2 + 200 * 8 + flown_in), 1, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
