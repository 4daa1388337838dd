# SPDX-License-Identifier: GPL-3.0-or-later
"""FORCE and MUSTA in whole runs: a Riemann problem of the granular gas with its exact solution, on both engines; parameters."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from studies.checks.errors import blast
from studies.exact.eos import GoldshteinShapiro
from studies.exact.riemann import BLAST

LENGTH, FACE, END = 10.0, 5.0, 1.0


class Force(harness.Folder, unittest.TestCase):
    def blast(self, name, n, flux, engine="lattice", more="", **options):
        """The shock, contact and shock of BLAST without sink from its two states."""
        case, size = os.path.join(self.folder, name), (LENGTH, 0.1, 0.1)
        left = (boxes.centres((n, 1, 1), size)[:, 0] < FACE)[:, None]
        rho, u, p = np.where(left, *BLAST).T
        harness.box_case(case, (n, 1, 1), size, rho, np.stack([u, 0 * u, 0 * u], axis=1), p, END, flux=flux,
                         reconstruct="WENO5", stepper="SSPRK43", courant=0.5, **options)
        runs.add(case, "system/fvSchemes", f"meshEngine {engine}; polyReconstruct linear;\n{more}\n")
        return case

    def error(self, *arguments, **options):
        """L1 error of rho over the height of the blast above what is before it."""
        case = self.blast("-".join(str(a) for a in arguments), *arguments, **options)
        harness.program("granularGas", "-case", case)
        rho = harness.haff.Case(case).field("rho")
        exact = blast(GoldshteinShapiro(1.0)).averages(np.linspace(0, LENGTH, len(rho) + 1), FACE, END)[0]
        return np.abs(rho - exact).mean() / np.ptp(exact)

    def test_blast(self):
        """Errors fall with the cells, FORCE smears most, and MUSTA comes within a third of `common`."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                error = {flux: [self.error(n, flux, engine) for n in (100, 400)] for flux in ("common", "FORCE", "MUSTA")}
                for coarse, fine in error.values():
                    self.assertGreater(np.log(coarse / fine) / np.log(4), 0.75, error)
                for k in range(2):
                    self.assertGreater(error["FORCE"][k], error["MUSTA"][k], error)
                    self.assertLess(error["MUSTA"][k], 4 / 3 * error["common"][k], error)

    def test_no_stage_is_force(self):
        """MUSTA of no stage writes FORCE's files, with more stages others."""
        force, none, one = [self.blast(f"p{k}", 60, flux, more=more) for k, (flux, more) in enumerate(
            (("FORCE", ""), ("MUSTA", "MUSTACoeffs { stages 0; }"), ("MUSTA", "MUSTACoeffs { stages 1; tolerance 0.1; }")))]
        for case in (force, none, one):
            harness.program("granularGas", "-case", case)
        runs.same(self, runs.results(force), runs.results(none))
        self.assertNotEqual(runs.results(force), runs.results(one))

    def test_mistakes(self):
        for more, words in (("MUSTACoeffs { stages -1; }", "stages"), ("MUSTACoeffs { tolerance 2; }", "tolerance"),
                            ("MUSTACoeffs { stage 3; }", "stages")):
            case = self.blast(words + str(len(more)), 20, "MUSTA", more=more)
            done = harness.program("checkCase", case, check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(words, done.stdout + done.stderr)
            self.assertIn("system/fvSchemes:", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
