# SPDX-License-Identifier: GPL-3.0-or-later
"""Local time steps through the programs: what they gain in steps, the same bytes on ranks and after a restart, the budget, and
what is refused."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from tests.cases.polyhedral import test_rest
from tests.cases.runtime import test_forces as forces

N, SIZE = (40, 30, 1), (4.0, 3.0, 0.1)


class Local(harness.Folder, unittest.TestCase):
    gmsh, shear, layer = test_rest.Rest.gmsh, test_rest.Rest.shear, test_rest.Rest.bed

    def make(self, name, engine="polyhedral", scheme="linear", stepper="local", end=0.03, **options):
        """Gas that cools, hot in a spot, on a lattice as polyhedra, between open sides."""
        at = boxes.centres(N, SIZE)
        hot = ((at[:, :2] - (1.6, 1.2)) ** 2).sum(axis=1) < 0.3
        one, case = np.ones(len(at)), os.path.join(self.folder, name)
        harness.box_case(case, N, SIZE, 100 * one, np.outer(one, (3, 1, 0)), np.where(hot, 1e5, 1e3), end,
                         **{"e": 0.9, "cooling": "Haff", "stepper": stepper, "courant": 1.0, "interval": 0.01, **options})
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\npolyReconstruct {scheme};\n")
        runs.add(case, "system/controlDict", "functions { budget { type energyBudget; } }\n")
        return case

    def run_case(self, case, **options):
        return int(re.search(r"(\d+) steps in", harness.program("granularGas", "-case", case, **options).stdout)[1])

    def check_restart_on_ranks_and_budget(self, case):
        """Of a run on one rank: from its first time on, 3 ranks write the same bytes."""
        self.run_case(case)
        part = runs.until(case, case + "part", "0.01")
        self.run_case(part, ranks=3)
        for time in ("0.02", "0.03"):
            runs.same(self, *(runs.contents(os.path.join(c, time)) for c in (case, part)))
        budget = forces.columns(case, "budget", "energyBudget.dat")
        self.assertLess(np.abs(budget["residual"]).max(), 1e-12 * np.abs(budget["cooling"]).max())
        self.check_momentum(case)

    def check_momentum(self, case):
        table, _, scale = forces.momentum(case)
        for columns in table.values():
            self.assertLess(np.abs(columns["Residual"]).max(), 1e-12 * scale)

    def test_ranks_restarts_and_budget(self):
        case = self.make("plain")
        copy = shutil.copytree(case, case + "2")
        self.check_restart_on_ranks_and_budget(case)
        self.run_case(copy, ranks=2)
        runs.same(self, runs.results(case), runs.results(copy))

    def test_transport(self):
        case = self.make("viscous", **runs.SPHERES)
        runs.conduct(case)
        self.check_restart_on_ranks_and_budget(case)

    def test_gravity(self):
        self.check_restart_on_ranks_and_budget(self.make("falls", gravity=(3.0, -900.0, 0.0)))

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_rest(self):
        """A settledLayer stays at rest, with the same bits on 2 ranks."""
        for mesh in ("sheared", "triangles"):
            with self.subTest(mesh):
                case = self.layer(mesh, mesh, "linear", steps=300)
                harness.edit(case, "system/controlDict", adjustTimeStep="yes", maxCo=1)
                harness.edit(case, "system/fvSchemes", timeScheme="local")
                runs.add(case, "system/controlDict", "functions { budget { type energyBudget; } }\n")
                copy = shutil.copytree(case, case + "2")
                self.assertRegex(harness.program("granularGas", "-case", case).stdout, "local steps: .* deltaT/2")
                if mesh == "triangles":
                    harness.program("granularGas", "-case", copy, ranks=2)
                    runs.same(self, runs.results(case), runs.results(copy))
                self.check_momentum(case)
                last = harness.haff.Case(case)
                self.assertLess(np.abs(last.field("U")).max() / np.sqrt(last.field("T").max()), 1e-12)

    def test_difference_from_stages(self):
        """It takes a third of the steps, and comes to the same flow as steps get shorter."""
        cases = [self.make(f"courant{stepper}{courant}", stepper=stepper, courant=courant, end=0.06, interval=0.02)
                 for stepper, courant in (("SSPRK43", 0.25), ("local", 1.0), ("local", 0.25), ("SSPRK43", 1.0))]
        steps = [self.run_case(case) for case in cases]
        self.assertLess(3 * steps[1], steps[3])
        rho = [harness.haff.Case(case).field("rho") for case in cases]
        first, second = (np.abs(q - rho[0]).mean() / rho[0].mean() for q in rho[1:3])
        self.assertLess(second, first / 2)

    def test_refusals(self):
        """Each names the line of timeScheme and a cure; checkCase says the same."""
        def edited(name, file, text, **options):
            case = self.make(name, **options)
            runs.add(case, file, text)
            return case

        coeffs = "commonCoeffs { contacts on; }\n"
        cases = {"meshEngine polyhedral;": self.make("lattice", engine="lattice"),
                 "polyReconstruct linear;": self.make("quadratic", scheme="CWENO3"),
                 "fluxScheme common;": self.make("paced", flux="FORCE"),
                 "out of commonCoeffs": edited("ruled", "system/fvSchemes", coeffs),
                 "acoustics { type explicit; }": edited("bed", "system/fvSolution", "acoustics { type implicit; }\n"),
                 "carried quantities": edited("carries", "constant/granularProperties", "carried { dye { type passive; } }\n")}
        with open(os.path.join(cases["carried quantities"], "0", "rho")) as f:
            text = re.sub(r"dimensions .*", "dimensions [0 0 0 0 0 0 0];", f.read().replace("rho;", "dye;"))
        with open(os.path.join(cases["carried quantities"], "0", "dye"), "w") as f:
            f.write(text)
        for cure, case in cases.items():
            with self.subTest(cure):
                harness.refused(self, case, r"system/fvSchemes:\d+: key 'timeScheme' is local; local is not there for", cure)
        done = harness.program("checkCase", "-case", cases["polyReconstruct linear;"], check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("polyReconstruct linear;", done.stderr + done.stdout)

    def test_log(self):
        case = self.make("logged")
        self.assertRegex(harness.program("granularGas", "-case", case).stdout,
                         r"local steps: \d+ cells take deltaT, \d+ deltaT/2, \d+ deltaT/4")


if __name__ == "__main__":
    unittest.main()
