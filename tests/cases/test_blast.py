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
