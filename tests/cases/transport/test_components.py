# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas that moves along an axis which the mesh does not resolve, with viscosity and heat conduction: Couette flow in one dimension,
and the section of a heap that runs down a slope. The same as with three cells along that axis, to round-off."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs, sections
from tests.cases.runtime import test_energyBudget as audit
from tests.cases.transport.channels import replace

from studies.exact import disks  # noqa: E402

# Polynomials of polyhedra are limited, where round-off may grow a thousandfold; on a lattice the same numbers are added.
ENGINES = (("lattice", 2e-14), ("polyhedral", 2e-10))
ROUGH = "JohnsonJacksonSlip; specularityCoefficient 0.6; restitutionCoefficient 0.9; value uniform "
WALLS = {
    "hold": ({"yLow": "translatingWallVelocity; U (-1 0 0.5)", "yHigh": "translatingWallVelocity; U (2 0 -1)"},
             {"yLow": "fixedValue; value uniform 1", "yHigh": "granularWall; restitution 0.9"}),
    "rub": ({"yLow": ROUGH + "(-1 0 0.5)", "yHigh": ROUGH + "(2 0 -1)"}, {"yLow": ROUGH + "1", "yHigh": ROUGH + "1"}),
    "rest": ({"yLow": "noSlip", "yHigh": "noSlip"}, {"yLow": "granularWall; restitution 0.8", "yHigh": "fixedValue; value uniform 2"}),
    "slip": ({}, {}),
    "flow": ({"yLow": "fixedValue; value uniform (1 0.3 2)", "yHigh": "zeroGradient"}, {"yLow": "fixedValue; value uniform 1"}),
}


def layer(at):
    return 300 - 150 * (at[:, 0] + at[:, 1] + at[:, 2]) / 2.4


def warm(at):
    return 1 + 0.3 * np.sin(2 * at[:, 0] + at[:, 1] + 3 * at[:, 2])


def sheared(at):
    return np.sin(2 * at[:, 1]), 0.2 * np.sin(3 * at[:, 1]), np.cos(4 * at[:, 1])


def calm(at):
    return 0, 0, 0


class Components(harness.Folder, unittest.TestCase):
    def couette(self, cells, engine):
        """The shipped case on one line of cells."""
        case = harness.copy("couetteDisks", self.folder)
        harness.boxes.write_mesh(case, (1, cells, 1), (1.0, 20.0, 1.0))
        for field in ("U", "T", "alpha"):
            for old, new in (("floor ", "yLow "), ("lid ", "yHigh "), ('"(left|right)"   { type cyclic; }', "xEmpty { type empty; }"),
                             ('"(front|back)"   { type empty; }', "zEmpty { type empty; }")):
                replace(case, "0.orig/" + field, old, new)
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        return case

    def test_couette(self):
        """Between walls that move along the missing axis, against the solution of the steady equations: the errors of the
        shipped case, in two dimensions, and their order."""
        for engine, measured in (("lattice", 3.3e-4), ("polyhedral", 4e-4)):
            found = []
            for cells in (16, 32):
                case = self.couette(cells, engine)
                flow = disks.Channel(disks.Disks.of(case), 20, 0.2, {"T": 1, "u": -2}, {"T": 1, "u": 2})
                result = harness.run(case, maxCo=0.4)
                found.append([disks.error(result, flow, *field, 1) for field in (("T", None), ("alpha", None), ("p", None), ("U", 0))])
                self.assertEqual(np.abs(result.field("U")[:, 2]).max(), 0)
            with self.subTest(engine):
                self.assertGreater(np.log2(np.divide(*found)).min(), 1.85)
                self.assertLess(np.max(found[1]), 1.3 * measured)

    def test_walls(self):
        """One dimension, two components beside it, each kind of wall, and a patch that gas flows in through with both."""
        for engine, tolerance in ENGINES:
            for name, (U, T) in WALLS.items():
                with self.subTest(engine=engine, walls=name):
                    gravity = (3.0, 0.0 if name == "flow" else -5.0, 1.0)
                    found, _ = sections.pair(self.folder, engine + name, (0, 24, 0), layer, sheared, warm, 0.06, engine=engine,
                                             rules={"U": U, "T": T}, gravity=gravity)
                    self.assertLess(found, tolerance)

    def test_time_schemes(self):
        """Every scheme of diffusion, and stress along the axes alone. PETSc solves to a tolerance."""
        for engine, tolerance in ENGINES:
            for diffusion, stress in (("RKL2", "full"), ("explicit", "full"), ("implicit", "full"), ("RKJ2", "diagonal")):
                if stress == "diagonal" and engine == "polyhedral":
                    continue
                with self.subTest(engine=engine, diffusion=diffusion, stress=stress):
                    U, T = WALLS["rub"]
                    found, _ = sections.pair(self.folder, engine + diffusion + stress, (0, 16, 0), layer, sheared, warm, 0.02,
                                             engine=engine, rules={"U": U, "T": T}, diffusion=diffusion, stress=stress)
                    self.assertLess(found, max(tolerance, 1e-8 if diffusion == "implicit" else 0))

    def test_section(self):
        """The section of a flow down a slope between walls, whatever axis is missing: it starts from rest, gravity alone asks for
        the component."""
        for engine, tolerance in ENGINES:
            for n, gravity, U in (((12, 10, 0), (0.0, -9.0, 4.0), {"xLow": "noSlip", "xHigh": "noSlip", "yLow": "noSlip"}),
                                  ((0, 10, 12), (4.0, -9.0, 0.0), {"zLow": "noSlip", "zHigh": ROUGH + "(2 1 0)", "yLow": "noSlip"}),
                                  ((10, 0, 12), (-9.0, 4.0, 0.0), {"zHigh": "translatingWallVelocity; U (1 2 0)", "xLow": "noSlip"})):
                with self.subTest(engine=engine, n=n):
                    T = {p: ROUGH + "1" for p in U if U[p].startswith("Johnson")}
                    found, thin = sections.pair(self.folder, "section%s%d%d" % (engine, n[0], n[1]), n, layer, calm, warm, 0.06,
                                                engine=engine, rules={"U": U, "T": T}, gravity=gravity)
                    self.assertLess(found, tolerance)
                    down = n.index(0)
                    u = np.abs(harness.haff.Case(thin).field("U")[:, down])
                    self.assertGreater(u.max(), 0.9 * 4 * 0.06)
                    self.assertLess(u.min(), 0.8 * u.max())  # walls hold the gas

    def budget(self, engine):
        """The table of a section that is sheared, cools and falls."""
        U, T = WALLS["rub"]
        case = sections.make(os.path.join(self.folder, "budget" + engine), (0, 16, 0), layer, sheared, warm, 0.1, engine=engine,
                             rules={"U": U, "T": T}, gravity=(3.0, -5.0, 1.0))
        audit.ask(case)
        harness.program("granularGas", "-case", case)
        return audit.budget(harness.haff.Case(case))

    def test_budget(self):
        """Work of gravity and of walls along the missing axes is counted: nothing else changes the energy."""
        for engine, _ in ENGINES:
            with self.subTest(engine):
                b = self.budget(engine)
                audit.EnergyBudget.close(self, b)
                self.assertGreater(np.abs(b["gravity"]).max(), 1e-3 * b["energy"][0])
                self.assertGreater(b["wallWork"][-1], 1e-3 * b["energy"][0])


if __name__ == "__main__":
    unittest.main()
