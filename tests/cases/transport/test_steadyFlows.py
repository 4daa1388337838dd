# SPDX-License-Identifier: GPL-3.0-or-later
"""Flows of disks with viscosity and heat conduction between two walls, against the solution of the ordinary differential
equations of steady flow (postprocessing/studies/exact/disks.py) and that of Couette flow that starts."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.transport.channels import POLYHEDRAL, friction, replace, spheres

from studies.exact import disks, garzoDufty  # noqa: E402

MARGIN = 1.3  # what an error may exceed the measured one by; that it falls at second order is asserted beside it


class SteadyFlows(harness.Folder, unittest.TestCase):
    flows = {}

    def flow(self, case, reference):
        """The exact flow, once for all cases that differ in mesh and scheme alone."""
        gas = frozenset((name, text) for folder in ("constant", "0.orig") for name, text in runs.contents(os.path.join(case, folder)).items()
                        if not name.startswith("polyMesh"))
        if gas not in self.flows:
            self.flows[gas] = reference(case)
        return self.flows[gas]

    def errors(self, name, cells, reference, fields, granular=None, control=None, other=()):
        """Mean errors on each of the grids; the orders between them. other: file, old and new text, or a function of the case."""
        found = []
        for n in cells:
            case = harness.copy(name, self.folder)
            for change in other:
                change(case) if callable(change) else replace(case, *change)
            harness.edit(case, "constant/granularProperties", **(granular or {}))
            harness.mesh(case, n)
            result = harness.run(case, **(control or {}))
            flow = self.flow(case, reference)
            found.append([disks.error(result, flow, *field) for field in fields])
        found = np.array(found)
        return found, np.log2(found[:-1] / found[1:])

    def test_heated_walls(self):
        for e, other, measured in ((1, (), 8.3e-5), (1, [POLYHEDRAL], 7.9e-5), (0.95, (), 2.9e-4)):
            with self.subTest(restitution=e, other=other):
                errors, order = self.errors("heatedWalls", (20, 40), disks.heated_walls, (("T",), ("alpha",), ("p",)),
                                            {"restitution": e}, {"maxCo": 0.8}, other)
                self.assertGreater(order.min(), 1.9)
                self.assertLess(errors[-1].max(), MARGIN * measured)

    def test_poiseuille(self):
        fields = [(name, None, 1) for name in ("T", "alpha", "p")] + [("U", 0, 1)]
        errors, order = self.errors("poiseuilleDisks", (16, 32), disks.poiseuille, fields, {}, {"maxCo": 0.8})
        self.assertGreater(order.min(), 1.85)
        self.assertLess(errors[-1].max(), MARGIN * 2.4e-3)

    def test_granular_wall(self):
        """Heat from one wall, which gas and impacts with the other take."""
        wall = ("0.orig/T", "right { type fixedValue; value uniform 4; }", "right { type granularWall; restitution 0.8; }")
        errors, order = self.errors("heatedWalls", (20, 40), disks.heated_walls, (("T",), ("alpha",), ("p",)), other=[wall])
        self.assertGreater(order.min(), 1.9)
        self.assertLess(errors[-1].max(), MARGIN * 1.6e-4)

    def test_couette(self):
        fields = [(name, None, 1) for name in ("T", "alpha", "p")] + [("U", 0, 1)]
        for other, measured in (((), 3.3e-4), ([POLYHEDRAL], 4e-4)):
            with self.subTest(other=other):
                errors, order = self.errors("couetteDisks", (16, 32), disks.couette, fields, {}, {"maxCo": 0.8}, other)
                self.assertGreater(order.min(), 1.85)
                self.assertLess(errors[-1].max(), MARGIN * measured)

    def test_friction(self):
        """Walls of Johnson & Jackson, which differ: gas slips along both and takes heat from that."""
        fields = [(name, None, 1) for name in ("T", "alpha", "p")] + [("U", 0, 1)]
        for other, end, least, measured in (([friction], 1200, 1.85, 4.2e-5), ([friction, POLYHEDRAL], 800, 1.5, 2.3e-4)):
            with self.subTest(other=other):
                errors, order = self.errors("couetteDisks", (16, 32), disks.frictional, fields, {},
                                            {"maxCo": 0.8, "endTime": end, "writeInterval": end}, other)
                self.assertGreater(order.min(), least, f"orders {order}, errors {errors}")
                self.assertLess(errors[-1].max(), MARGIN * measured)

    def test_spheres(self):
        """The heat flux of inelastic spheres follows grad rho, too: at walls that hold T, pulled onto one of them, and at one that
        takes heat. On polyhedra the order is 1.7 between these grids under the stronger gravity, and 2.0 to 2.2 from 40 to 80 cells.
        test_mpi_conduction has the second order of conduction alone."""
        absorbs = ("0.orig/T", "right { type fixedValue; value uniform 4; }", "right { type granularWall; restitution 0.8; }")
        for e, gravity, other, least, measured in (
                (0.8, -0.1, [], 1.85, 7.9e-4), (0.8, -0.1, [POLYHEDRAL], 1.65, 1.4e-3), (0.9, 0.02, [absorbs], 1.9, 2.5e-4),
                (0.9, 0.02, [absorbs, POLYHEDRAL], 1.9, 9e-4), (0.8, 0.0, [absorbs], 1.9, 4.2e-4)):
            with self.subTest(restitution=e, gravity=gravity, other=other):
                errors, order = self.errors("heatedWalls", (20, 40), lambda case: disks.heated_walls(case, garzoDufty.Grains(3, e), gravity),
                                            (("T",), ("alpha",), ("p",)), {}, {"maxCo": 0.8, "endTime": 600, "writeInterval": 600},
                                            [spheres(e, gravity), *other])
                self.assertGreater(order.min(), least, f"orders {order}, errors {errors}")
                self.assertLess(errors[-1].max(), MARGIN * measured)

    def test_spheres_along_walls_with_friction(self):
        """On the lattice what is left of the start at t = 1200 would hide the second order: the gas relaxes slowly."""
        def rough(case):
            """Two walls that are alike: with other walls the mean velocity would take long to become steady."""
            friction(case, (-2, 0.8, 0.9), (2, 0.8, 0.9))
            replace(case, "0.orig/T", "internalField   uniform 0.34;", "internalField   uniform 0.07;")
            replace(case, "0.orig/U", "0.15*(y - 10) + 0.14", "0.17*(y - 10)")
        fields = [(name, None, 1) for name in ("T", "alpha", "p")] + [("U", 0, 1)]
        for other, end, least, measured in (([], 1600, 1.9, 9.8e-5), ([POLYHEDRAL], 800, 1.5, 1.9e-3)):
            with self.subTest(other=other):
                errors, order = self.errors("couetteDisks", (16, 32), lambda case: disks.frictional(case, garzoDufty.Grains(3, 0.9)), fields, {},
                                            {"maxCo": 0.8, "endTime": end, "writeInterval": end}, [spheres(0.9), rough, *other])
                self.assertGreater(order.min(), least, f"orders {order}, errors {errors}")
                self.assertLess(errors[-1].max(), MARGIN * measured)

    def test_uniform_shear(self):
        """Friction and impacts balance in the gas, and at the walls: T and rho are uniform, and what is left of u is linear, on
        any lattice. Splitting, of second order, moves them."""
        gas, e = disks.Disks(0.9), 0.6
        rho = 0.2 / gas.per
        p, mu = rho * gas.A(0.2), gas.shear(rho, 1)
        rate = float(np.sqrt(gas.sink(rho, 1) / mu))
        phi = float(2 * np.pi * (mu * rate / p)**2 / (1 - e * e))
        u = float(10 * rate + mu * rate * np.sqrt(2 * np.pi) / (phi * p))
        most = []
        for courant in (0.4, 0.2):
            case = harness.copy("couetteDisks", self.folder)
            friction(case, (-u, phi, e), (u, phi, e))
            replace(case, "0.orig/T", "internalField   uniform 0.34;", "internalField   uniform 1;")
            replace(case, "0.orig/U", "0.15*(y - 10) + 0.14", f"{rate!r}*(y - 10)")
            harness.mesh(case, 16)
            result = harness.run(case, maxCo=courant, endTime=20, writeInterval=20)
            off = result.field("U")[:, 0] - rate * (result.centres[:, 1] - 10)
            most.append(max(np.abs(result.field("T") - 1).max(), np.abs(result.field("alpha") / 0.2 - 1).max(), np.abs(off).max()))
        self.assertLess(most[0], MARGIN * 5.9e-6)
        self.assertGreater(np.log2(most[0] / most[1]), 1.8)

    def test_start(self):
        """A wall begins to move, so slowly that the gas stays as it is: u obeys the heat equation."""
        faint, end, gas = 1e-4, 20, disks.Disks(1)
        nu = gas.shear(0.2 / gas.per, 1) / (0.2 / gas.per)
        errors = []
        for n in (16, 32):
            case = harness.copy("couetteDisks", self.folder)
            harness.mesh(case, n)
            harness.edit(case, "constant/granularProperties", restitution=1)
            replace(case, "0.orig/T", "type fixedValue; value uniform 1;", "type zeroGradient;")
            replace(case, "0.orig/U", "type translatingWallVelocity; U (-2 0 0);", "type noSlip;")
            replace(case, "0.orig/U", "U (2 0 0)", f"U ({faint} 0 0)")
            replace(case, "0.orig/U", "0.2*(y - 10)", "0")
            result = harness.run(case, endTime=end, writeInterval=end, maxCo=0.4)
            y = result.centres[:, 1] / 20
            exact = y + sum(2 / (k * np.pi) * (-1)**k * np.sin(k * np.pi * y) * np.exp(-nu * end * (k * np.pi / 20)**2)
                            for k in range(1, 40))
            errors.append(np.abs(result.field("U")[:, 0] / faint - exact).max())
        self.assertLess(errors[1], MARGIN * 4.5e-4)
        self.assertGreater(np.log2(errors[0] / errors[1]), 1.85)


if __name__ == "__main__":
    unittest.main()
