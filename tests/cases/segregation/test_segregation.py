# SPDX-License-Identifier: GPL-3.0-or-later
"""granularSegregation through the real program: orders, exact solutions, conservation, bounds, restarts, errors."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.segregation import mixtures

from studies.exact import segregation  # noqa: E402
from studies.measured import mixture  # noqa: E402

EXACT = os.path.join(harness.SOURCE, "tests", "oracles", "gray_chugunov_exact.csv")


class Segregation(mixtures.Mixture, unittest.TestCase):
    def test_kink_order(self):
        """The errors and orders of the scheme (4) with (7), as an independent implementation has them."""
        expected = {51: 1.2651e-2, 101: 4.8219e-3, 201: 1.1912e-3, 401: 3.0606e-4}
        for M, value in expected.items():
            case = self.case("kink", M, deltaT=1 / (M - 1), writeInterval=2)
            self.run_case(case)
            y, phi = mixture.profile(case)
            error = np.max(np.abs(phi - segregation.kink(y, 2.0)))
            self.assertAlmostEqual(error / value, 1, delta=1e-3, msg=f"M = {M}: {error}")

    def test_gray_chugunov(self):
        exact = np.genfromtxt(EXACT, delimiter=",", skip_header=1)
        for D, limit in ((0.5, 1e-6), (0.1, 1e-6), (0.02, 1e-5)):
            case = self.case("segregationLinear", 1601, {"value": D}, endTime=0.5, deltaT=0.5 / 1600, writeInterval=0.1)
            self.run_case(case)
            for t in (0.1, 0.5):
                rows = exact[(exact[:, 0] == D) & (exact[:, 1] == t)]
                y, phi = mixture.profile(case, t)
                np.testing.assert_allclose(y[::10], rows[:, 2], atol=1e-10)
                self.assertLessEqual(np.max(np.abs(phi[::10] - rows[:, 3])), limit, f"D = {D}, t = {t}")
            mean = harness.haff.Case(case).table("mean", "volFieldValue.dat")[:, 1]
            self.assertLess(np.max(np.abs(mean / 0.55 - 1)), 1e-12)

    def test_no_diffusion(self):
        """D = 0: the shocks of Gray & Thornton, within 0 .. 1."""
        case = self.case("segregationLinear", 401, {"value": 0}, endTime=0.5, deltaT=1e-3, writeInterval=0.25)
        self.run_case(case)
        for t in (0.25, 0.5):
            y, phi = mixture.profile(case, t)
            self.assertTrue((phi >= 0).all() and (phi <= 1).all())
            error = np.mean(np.abs(phi - segregation.gray_thornton_uniform(y, t, 0.5, 0.55)))
            self.assertLess(error, 1 / 400)  # a cell

    def test_restart(self):
        """A run in two parts ends with the bits of one that went through."""
        for adjust in ("no", "yes"):
            whole = self.case("segregationLinear", 101, {"value": 0.02}, endTime=0.2, deltaT=1e-3, writeInterval=0.1,
                              adjustTimeStep=adjust)
            parts = shutil.copytree(whole, whole + "_parts")
            self.run_case(whole)
            harness.edit(parts, "system/controlDict", endTime=0.1)
            self.run_case(parts)
            harness.edit(parts, "system/controlDict", endTime=0.2)
            self.assertIn("from time 0.1 (step", self.run_case(parts))
            runs.same(self, runs.contents(whole + "/0.2"), runs.contents(parts + "/0.2"), adjust)

    def test_adaptive(self):
        """The tolerance steers the error, whatever deltaT starts with."""
        exact = np.genfromtxt(EXACT, delimiter=",", skip_header=1)
        rows, errors = exact[(exact[:, 0] == 0.5) & (exact[:, 1] == 2)], []
        for tolerance in (1e-5, 1e-7):
            case = self.case("segregationLinear", 321, {"value": 0.5}, writeInterval=2, adjustTimeStep="yes", deltaT=0.1)
            harness.edit(case, "system/fvSolution", tolerance="1e-10")
            runs.add(case, "system/fvSolution", f"timeTolerance {tolerance};\n")
            log = self.run_case(case)
            self.assertIn("(limited by: timeTolerance)", log)
            errors.append(np.max(np.abs(mixture.profile(case)[1][::2] - rows[:, 3])))
        self.assertLess(errors[0], 1e-4)
        self.assertLess(errors[1], 5e-6)

    def test_laws(self):
        """Laws that say the same give the same: expressions, D(phi), a constant gradient of the kinetic stress."""
        results = []
        for text in ("percolation { type constant; velocity -1; } diffusivity { type constant; value 0.1; }",
                     'percolation { type expression; velocity "-1 + 0*y"; } diffusivity { type expression; value "0.1 + 0*phi"; }',
                     'percolation { type kineticStress; case "gas"; q 1; rho 2; } diffusivity { type constant; value 0.1; }'):
            case = self.case("segregationLinear", 101, endTime=0.2, deltaT=0.01, writeInterval=0.2)
            harness.write_dictionary(case, "constant", "segregationProperties", text)
            gas = os.path.join(case, "gas")
            os.makedirs(gas + "/0")
            shutil.copytree(case + "/constant", gas + "/constant")
            y = harness.haff.Case(case).centres[:, 1]
            for name, values in (("rho", 2 + 0 * y), ("T", 3 - y)):
                harness.boxes.write_field(gas, name, values, '".*" zeroGradient')
            self.run_case(case)
            results.append(mixture.profile(case)[1])
        for other in results[1:]:
            np.testing.assert_allclose(other, results[0], atol=1e-9)

    def test_paper_closure_drifts(self):
        """(5) loses 7.8e-6 of the integral by t = 0.3 at M = 101 (physics: documented); conservative nothing."""
        for closure, low, high in (("paper", 7e-6, 9e-6), ("conservative", 0, 1e-12)):
            case = self.case("segregationLinear", 101, endTime=0.3, deltaT=0.003, writeInterval=0.3)
            harness.edit(case, "system/fvSchemes", closure=closure)
            harness.edit(case, "system/fvSolution", dampedSteps=0)
            self.run_case(case)
            y, phi = mixture.profile(case)
            drift = abs(np.sum(0.5 * (phi[1:] + phi[:-1]) * np.diff(y)) / 0.55 - 1)
            self.assertTrue(low <= drift <= high, f"{closure}: {drift}")

    def test_chute(self):
        """Steady and sorted, the small grains run where the flow carries as much as came in, carried and percolating; within 0 .. 1."""
        N = 40
        case = self.chute(N, deltaT=5e-3, writeInterval=6)
        log = self.run_case(case)
        at = np.round(harness.haff.Case(case).centres, 9)
        phi = harness.haff.Case(case).field("phi")
        self.assertTrue((phi >= 0).all() and (phi <= 1).all())
        last = at[:, 0] == at[:, 0].max()
        order = np.argsort(at[last, 1])
        y, phi = at[last, 1][order], phi[last][order]
        k = np.argmax(phi < 0.5)
        height = y[k - 1] + (phi[k - 1] - 0.5) / (phi[k - 1] - phi[k]) * (y[k] - y[k - 1])
        self.assertLess(abs(height / 0.02 - segregation.chute_height(0.5, 0.02 * 0.43837 / 0.3)), 0.5 / N)
        self.assertIn("velocity U", log)

    def test_chute_restart(self):
        """In two parts, with fixed steps and with chosen ones, then on two ranks, the bits of one run; U comes along."""
        for adjust in ("no", "yes"):
            whole = self.chute(10, endTime=0.2, deltaT=5e-3, writeInterval=0.1, adjustTimeStep=adjust)
            parts = shutil.copytree(whole, whole + "_parts")
            self.run_case(whole)
            harness.edit(parts, "system/controlDict", endTime=0.1)
            self.run_case(parts)
            harness.edit(parts, "system/controlDict", endTime=0.2)
            self.run_case(parts, ranks=1 + (adjust == "yes"))
            self.assertIn("U", os.listdir(whole + "/0.2"))
            runs.same(self, runs.contents(whole + "/0.2"), runs.contents(parts + "/0.2"), adjust)

    def test_chute_errors(self):
        case = self.chute(8)
        rows = (("constant/segregationProperties", " direction (0.43837 -0.89879 0);", "", "add  direction (x y z);"),
                ("0.orig/phi", "fixedValue; value uniform 0.5;", "zeroGradient;", "phi must be fixedValue"),
                ("0.orig/phi", "value uniform 0.5;", "value uniform 1.5;", "it must lie between 0 and 1"),
                ("system/fvSolution", "Newton", "Picard", "factored Newton"),
                ("0.orig/phi", "base    { type noFlux; }", "base    { type zeroGradient; }", "phi must be noFlux"),
                ("system/fvSchemes", "conservative;", "conservative;\nwallValues wall;", "wallValues cell;"))
        self.refused(case, rows, ("checkCase", case))

    def test_errors(self):
        """Bad input is named with file and line, and a cure; nothing is written."""
        case = self.case("segregationLinear", 21)
        rows = (("constant/segregationProperties", "type constant;", "type constnat;", "did you mean 'constant'?"),
                ("constant/segregationProperties", "velocity -1;", "velocty -1;", "velocity"),
                ("constant/segregationProperties", "value 0.1;", "value -0.1;", "segregationProperties:"),
                ("constant/segregationProperties", "type constant; value 0.1;", 'type expression; value "y";', "must be 0 or more"),
                ("constant/segregationProperties", "type constant; velocity -1;", 'type expression; velocity "log(y)";', "f is"),
                ("constant/segregationProperties", "type constant; velocity -1;", "type kineticStress; case nowhere; q 1; rho 1;",
                 "nowhere"),
                ("system/fvSchemes", "conservative", "conservativ", "did you mean 'conservative'?"),
                ("system/fvSchemes", "wallValues wall;", "wallValues wall; bound yes;", "did you mean 'bounded'?"),
                ("system/fvSchemes", "closure    conservative;\nwallValues wall;", "closure paper;", "wallValues wall;"),
                ("system/fvSolution", "Newton", "Newtn", "did you mean 'Newton'?"),
                ("0.orig/phi", "uniform 0.55", "uniform 1.5", "it must lie between 0 and 1"),
                ("0.orig/phi", "bottom { type noFlux; }", "bottom { type noFlx; }", "did you mean 'noFlux'?"),
                ("system/controlDict", "fields (phi)", "fields (ph)", "did you mean 'phi'?"))
        self.refused(case, rows, ("granularSegregation", "-case", case), ("checkCase", case))
        self.assertIn("The case is sound.", harness.program("checkCase", case).stdout)

    def test_help(self):
        self.assertIn("exponential", harness.program("granularSegregation", "-listModels").stdout)
        self.assertIn("percolation and diffusion go through", harness.program("granularSegregation", "-listBCs").stdout)
        self.assertIn("Christov", harness.program("granularSegregation", "-help").stdout)


if __name__ == "__main__":
    unittest.main()
