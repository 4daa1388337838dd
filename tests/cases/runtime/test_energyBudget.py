# SPDX-License-Identifier: GPL-3.0-or-later
"""The function object energyBudget: mass and energy close to round-off, every change has its cause, and the gas has the same
bits with it."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.gas import test_limiter as limiter

from studies.exact import disks  # noqa: E402

COLUMNS = ("t", "mass", "massFlow", "massFloor", "massResidual", "energy", "cooling", "gravity", "heat", "wallWork", "flow", "floors",
           "residual")


def ask(case):
    path = os.path.join(case, "system", "controlDict")
    with open(path) as f:
        text = f.read()
    if "functions" not in text:
        text += "functions\n{\n}\n"
    with open(path, "w") as f:
        f.write(text.replace("functions\n{\n", "functions\n{\n    budget { type energyBudget; }\n"))


def budget(result):
    return dict(zip(COLUMNS, result.table("budget", "energyBudget.dat").T))


class EnergyBudget(harness.Folder, unittest.TestCase):
    def close(self, b):
        """Round-off: of some thousand sums of the largest entry."""
        scale = max(np.abs(b[name]).max() for name in COLUMNS[5:12])
        self.assertLess(np.abs(b["residual"]).max(), 1e-13 * scale)
        self.assertLess(np.abs(b["massResidual"]).max(), 1e-13 * b["mass"][0])
        total = b["energy"][0] + sum(b[name] for name in COLUMNS[6:12]) - b["energy"]
        np.testing.assert_allclose(total, b["residual"], atol=1e-14 * scale)
        self.assertEqual(np.abs(b["flow"]).max() + np.abs(b["massFlow"]).max(), 0)

    def layer(self, restitution):
        """The layer of the case faraday, thrown up and fallen."""
        case = harness.copy("faraday", self.folder)
        harness.mesh(case, 8, "L")
        harness.edit(case, "constant/granularProperties", restitution=restitution)
        ask(case)
        return harness.run(case, endTime=0.12, writeInterval=0.12, maxCo=0.4)

    def test_layer(self):
        """Gravity and shaking do work, impacts take it; nothing else does, whatever is limited or repeated."""
        for restitution in (0.75, 1):
            with self.subTest(restitution=restitution):
                result = self.layer(restitution)
                b = budget(result)
                self.close(b)
                for name in ("heat", "wallWork", "floors", "massFloor"):
                    self.assertEqual(np.abs(b[name]).max(), 0, name)
                self.assertGreater(np.ptp(b["gravity"]), 0.1 * b["energy"][0])
                if restitution == 1:
                    self.assertEqual(np.abs(b["cooling"]).max(), 0)
                else:
                    self.assertTrue((np.diff(b["cooling"]) <= 0).all())
                    self.assertLess(b["cooling"][-1], -0.1 * b["energy"][0])

    def test_floor(self):
        """Lumps fly apart in a gas on the density floor: the mass and the energy that adds are counted, whatever is limited,
        on both engines; the same table on two ranks."""
        for engine in ("lattice", "polyhedral"):
            tables = []
            for ranks in (1, 2):
                case = limiter.Limiter.shot(self, f"{engine}{ranks}", engine, 0.006)
                runs.add(case, "system/fvSolution", "limits { alphaFloor 5e-9; }\n")
                ask(case)
                harness.program("granularGas", "-case", case, ranks=ranks)
                tables.append(budget(harness.haff.Case(case)))
            self.close(tables[0])
            self.assertGreater(tables[0]["massFloor"][-1], 0)
            self.assertGreater(tables[0]["floors"][-1], 0)
            for name in COLUMNS:
                np.testing.assert_array_equal(tables[0][name], tables[1][name])

    def test_walls(self):
        """Steady heat through walls of given temperature: what the reference says, and what impacts take."""
        case = harness.copy("heatedWalls", self.folder)
        harness.mesh(case, 20)
        ask(case)
        result = harness.run(case)
        b = budget(result)
        self.close(b)
        late = b["t"] > 200
        heat, cooling = (np.polyfit(b["t"][late], b[name][late], 1)[0] for name in ("heat", "cooling"))
        flux = disks.heated_walls(case).solution.sol([0, 20])[2] * result.volumes.sum() / 20
        self.assertAlmostEqual(heat, -cooling, delta=1e-4 * heat)
        self.assertAlmostEqual(heat, flux[1] - flux[0], delta=0.02 * heat)

    def test_moving_walls(self):
        """Steady shear: the walls do the work of the stress that the reference says; impacts and walls take it."""
        case = harness.copy("couetteDisks", self.folder)
        harness.mesh(case, 16)
        ask(case)
        result = harness.run(case, maxCo=0.4)
        b = budget(result)
        self.close(b)
        late = b["t"] > 200
        work, heat, cooling = (np.polyfit(b["t"][late], b[name][late], 1)[0] for name in ("wallWork", "heat", "cooling"))
        stress, area = disks.couette(case).solution.sol(10)[4], result.volumes.sum() / 20
        self.assertAlmostEqual(work, 2 * 2 * stress * area, delta=2e-3 * work)
        self.assertAlmostEqual(work + heat + cooling, 0, delta=1e-4 * work)

    def test_bits(self):
        """Of a gas on a lattice whose uniform cells are left out, and of a viscous one."""
        for name in ("inviscid", "viscous"):
            results = []
            for with_budget in (False, True):
                path = os.path.join(self.folder, f"{name}{with_budget}")
                if name == "inviscid":
                    runs.make(path, (40, 40, 1), 0.01)
                else:
                    path = harness.copy("faraday", self.folder)
                    harness.mesh(path, 8, "L")
                    harness.edit(path, "system/controlDict", endTime=0.01, writeInterval=0.01)
                if with_budget:
                    ask(path)
                harness.program("granularGas", "-case", path)
                results.append(harness.haff.Case(path))
            if name == "inviscid":
                self.close(budget(results[1]))
            for field in ("rho", "rhoU", "rhoE"):
                np.testing.assert_array_equal(*(r.field(field) for r in results), f"{name} {field}")

    def test_refused(self):
        case = harness.copy("coolingGas", self.folder)
        harness.mesh(case, 4)
        ask(case)
        done = harness.program("granularMD", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("granularMD keeps no budget by cause", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
