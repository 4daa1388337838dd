"""Blast waves: elastic against the exact solution, inelastic against the prototype, clustering ordered by restitution."""
import unittest

from tests.cases import harness


class Blast(harness.Folder, unittest.TestCase):
    def test_elastic(self):
        errors = {}
        for cells in (250, 500):
            case = self.short("blastElastic", cells, writeInterval=5.48)
            self.compare(case, harness.entries("blastElastic", cells=cells))
            errors[cells] = harness.expected.blast_error(case, "rho", case.times[-1])
        self.assertLess(errors[500], 0.7 * errors[250], "the error does not fall with the grid")

    def test_every_scheme_converges(self):
        """The contact of a scheme of order r is smeared over h^(r/(r+1)), at worst h^(1/2); the shocks converge faster."""
        case = self.short("blastElastic", 500, writeInterval=5.48)  # made once; the runs below only change the scheme
        fluxes = ("common", "Marquina", "LaxFriedrichs", "globalLaxFriedrichs")
        schemes = [(f, r) for f in fluxes for r in ("PHM", "WPENO5", "WENO5", "WENOZ", "TENO5", "firstOrder")] + [
            ("Rusanov", "firstOrder")]
        errors = {}
        for cells in (500, 1000):
            harness.mesh(case.path, cells)
            harness.edit(case.path, "system/controlDict", startFrom="startTime")
            for scheme in schemes:
                harness.edit(case.path, "system/fvSchemes", fluxScheme=scheme[0], reconstruct=scheme[1])
                result = harness.run(case.path)
                errors[scheme, cells] = harness.expected.blast_error(result, "rho", result.times[-1])
        for scheme in schemes:
            with self.subTest(scheme):
                coarse, fine = errors[scheme, 500], errors[scheme, 1000]
                self.assertLess(fine, coarse / 2 ** 0.5, f"errors {coarse:.4f}, {fine:.4f}")
                if scheme[1] != "firstOrder":
                    self.assertLess(fine, errors[(scheme[0], "firstOrder"), 1000])

    def test_inelastic(self):
        packing = []
        for e in (0.9, 0.7, 0.2):
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

    def test_dense(self):
        self.compare(self.short("blastDense", 2000, endTime=4), harness.entries("blastDense"))


if __name__ == "__main__":
    unittest.main()
