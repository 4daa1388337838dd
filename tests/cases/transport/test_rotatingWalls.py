# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls that rotate (rotatingWallVelocity), through the whole program: gas between two cylinders, slow enough to stay isothermal,
against u = A r + B/r and its torque; walls of Johnson & Jackson and of friction; what is refused."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.transport.channels import replace

from studies.exact import disks  # noqa: E402

INNER, OUTER, ALPHA, SLOW = 5.0, 10.0, 0.2, 1e-4
GEO = """DefineConstant[ N = {8, Min 2, Name "cells across"} ];
Point(9) = {0, 0, 0};
For q In {0:3}
  Point(1 + q) = {5*Cos(q*Pi/2), 5*Sin(q*Pi/2), 0};   Point(5 + q) = {10*Cos(q*Pi/2), 10*Sin(q*Pi/2), 0};
  Line(9 + q) = {1 + q, 5 + q};
EndFor
For q In {0:3}
  Circle(1 + q) = {1 + q, 9, 1 + (q + 1)%4};   Circle(5 + q) = {5 + q, 9, 5 + (q + 1)%4};
  Curve Loop(1 + q) = {9 + q, 5 + q, -(9 + (q + 1)%4), -(1 + q)};   Plane Surface(1 + q) = {1 + q};
EndFor
SURFACES
Physical Curve("shaft") = {1:4};
Physical Curve("drum") = {5:8};
Physical Surface("gas") = {1:4};
"""
QUADS = "Transfinite Curve {1:8} = 2*N + 1;   Transfinite Curve {9:12} = N + 1;   Transfinite Surface {1:4};   Recombine Surface {1:4};"
TRIANGLES = "MeshSize {:} = 5/N;"
TORQUE = """
    torque { type forces; patches (shaft); CofR (0 0 0); writeControl timeStep; writeInterval 5; }
    brake  { type forces; patches (drum); CofR (0 0 0); writeControl timeStep; writeInterval 5; }
    budget { type energyBudget; }
"""
CONTACT = "contact { type hertz; youngsModulus 5e9; friction 0.5; impactSpeed 1; }\n"


def rotating(omega, more="value uniform (0 0 0);"):
    return f"type rotatingWallVelocity; origin (0 0 0); axis (0 0 2); omega {omega}; {more}"


@unittest.skipUnless(runs.shutil.which("gmsh"), "gmsh is not installed")
class RotatingWalls(harness.Folder, unittest.TestCase):
    def cylinders(self, cells, walls, T='"(shaft|drum)" fixedValue; value uniform 1', restitution=1, surfaces=QUADS):
        """A gas of disks between two cylinders; the functions of TORQUE; `walls`: entries of U by patch."""
        case = harness.copy("couetteDisks", self.folder)
        with open(os.path.join(case, "mesh.geo"), "w") as f:
            f.write(GEO.replace("SURFACES", surfaces))
        harness.write_dictionary(case, "system", "meshDict", "patches { shaft { type wall; } drum { type wall; } }\n")
        harness.mesh(case, cells)
        harness.edit(case, "constant/granularProperties", restitution=restitution)
        replace(case, "system/controlDict", "functions\n{", "functions\n{" + TORQUE)
        at = harness.haff.Case(case).centres
        empty = '\n"(front|back)" empty'
        rules = {"alpha": '"(shaft|drum)" zeroGradient' + empty, "T": T + empty,
                 "U": "\n".join(f"{name} {wall.removeprefix('type ').rstrip(';')}" for name, wall in walls.items()) + empty}
        return case, at, rules

    def start(self, case, rules, alpha, u, T):
        for name, values in (("alpha", alpha), ("U", u), ("T", T)):
            harness.boxes.write_field(case, name, values, rules[name], time="0.orig")

    def steady(self, cells, omegas, surfaces=QUADS):
        """Errors of the velocity and of both torques, each over the largest of the exact ones, after a run from the exact flow."""
        walls = {"shaft": rotating(SLOW * omegas[0]), "drum": rotating(SLOW * omegas[1])}
        case, at, rules = self.cylinders(cells, walls, surfaces=surfaces)
        gas, r = disks.Disks.of(case), np.hypot(at[:, 0], at[:, 1])
        rho = ALPHA / gas.per
        B = (omegas[0] - omegas[1]) / (INNER**-2 - OUTER**-2)
        A = omegas[1] - B / OUTER**2
        u = SLOW * (A + B / r**2)[:, None] * np.stack([-at[:, 1], at[:, 0], 0 * r], axis=1)
        self.start(case, rules, np.full(len(r), ALPHA), u, np.ones(len(r)))
        harness.edit(case, "system/controlDict", endTime=30, writeInterval=30, maxCo=0.6)
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        depth = np.ptp(result.mesh.points[:, 2])
        exact = -depth * 4 * np.pi * gas.shear(rho, 1.0) * B * SLOW  # on the shaft, by the gas
        torque = [result.table(name, "moment.dat")[-1, 3] / exact for name in ("torque", "brake")]
        return np.abs(result.field("U") - u).max() / np.abs(u).max(), torque[0] - 1, torque[1] + 1

    def test_couette(self):
        """Second order on curved quadrilaterals and on triangles; the torque on each cylinder, extrapolated from two meshes."""
        for surfaces, cells, error, extrapolated in ((QUADS, (8, 12), 0.013, 1.5e-4), (TRIANGLES, (4, 8), 0.021, None)):
            with self.subTest(cells=cells):
                found = np.abs(np.array([self.steady(n, (1.0, -0.5), surfaces) for n in cells]))
                order = np.log(found[0] / found[1]) / np.log(cells[1] / cells[0])
                self.assertGreater(order.min(), 1.6 if surfaces is TRIANGLES else 1.95, f"orders {order}")
                self.assertLess(found[1, 0], error)
                if extrapolated:
                    square = (cells[1] / cells[0]) ** 2
                    self.assertLess(((square * found[1] - found[0]) / (square - 1))[1:].__abs__().max(), extrapolated)

    def spin_up(self, shaft, drum, **control):
        """Elastic gas at rest, from t = 0 to 1, between a shaft that drags it by impacts and a drum that it sticks to."""
        drags = "type JohnsonJacksonSlip; specularityCoefficient 0.6; restitutionCoefficient 1; "
        walls = {"shaft": f"{drags} origin (0 0 0); axis (0 0 2); omega {shaft}; value uniform (0 0 0);", "drum": rotating(drum)}
        case, at, rules = self.cylinders(3, walls, T=f"shaft {drags.removeprefix('type ')} value uniform 1\ndrum zeroGradient")
        self.start(case, rules, np.full(len(at), ALPHA), np.zeros((len(at), 3)), np.ones(len(at)))
        replace(case, "system/controlDict", "writeControl timeStep; writeInterval 5; }", "writeControl timeStep; writeInterval 1; }")
        harness.edit(case, "system/controlDict", endTime=1, writeInterval=0.5, maxCo=0.4, **control)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def test_budget(self):
        """The energy of an elastic gas changes by the work of the walls alone, which is torque times omega; momentum by their force."""
        result = self.spin_up(0.2, -0.1)
        budget = result.table("budget")[-1]
        change = budget[5] - result.table("budget")[0, 5]
        self.assertGreater(change, 1)
        self.assertLess(abs(change - budget[9]), 1e-12 * change)
        work = 0
        for name, omega in (("torque", 0.2), ("brake", -0.1)):
            rows = result.table(name, "moment.dat")
            work -= (np.diff(rows[:, 0], prepend=0) * rows[:, 3]).sum() * omega
        self.assertLess(abs(work / change - 1), 1e-10)
        self.assertLess(np.abs(budget[[19, 26]]).max(), 1e-12)  # what is left over of momentum along x, y

    def test_in_time(self):
        """A table and an expression of omega are the same, and a run that goes on has the bits of one that does not stop."""
        table = self.spin_up("table ((0 0) (1 0.4))", "constant -0.1", startFrom="latestTime")
        expression = self.spin_up('"0.4*t"', '"-0.1"')
        self.assertGreater(np.abs(table.field("U")).max(), 0.1)
        np.testing.assert_allclose(table.field("U"), expression.field("U"), rtol=1e-10, atol=1e-13)
        whole = table.field("U")
        shutil.rmtree(os.path.join(table.path, "1"))
        shutil.rmtree(os.path.join(table.path, "0.orig"))
        harness.program("granularGas", "-case", table.path, ranks=2)
        np.testing.assert_array_equal(harness.haff.Case(table.path).field("U"), whole)


class Lattices(harness.Folder, unittest.TestCase):
    """A plate that rotates about the axis of a box of gas: gas and grains."""

    def plate(self, U, low="noSlip"):
        n = np.array((6, 6, 4))
        one = np.ones(n.prod())
        case = harness.box_case(os.path.join(self.folder, f"plate{len(os.listdir(self.folder))}"), n, 0.1 * n, 100 * one, np.outer(one, (0, 0, 0)), one,
                                0.05, types=dict.fromkeys("xyz", "wall"), digits=17, **runs.SPHERES)
        runs.conduct(case)
        os.remove(case + "/0/p")
        for name, values, rules in (("rho", 100 * one, '".*" zeroGradient'), ("T", one, '".*" zeroGradient'),
                                    ("U", np.outer(one, (0, 0, 0)), f'zHigh {U}\nzLow {low}\n"[xy].*" slip')):
            harness.boxes.write_field(case, name, values, rules)
        return case

    def test_same_bits_as_expressions(self):
        """The velocities of faces: those of an expression of place."""
        fields = []
        for U in ("rotatingWallVelocity; origin (0.3 0.3 1); axis (0 0 4); omega 8; value uniform (0 0 0)",
                  'translatingWallVelocity; U (0 0 0); expression ("-8*(y - 0.3)" "8*(x - 0.3)" "0")'):
            case = self.plate(U)
            harness.program("granularGas", "-case", case)
            fields.append(harness.haff.Case(case).field("U"))
        self.assertGreater(np.abs(fields[0][:, :2]).max(), 1e-2)
        np.testing.assert_allclose(*fields, rtol=1e-11, atol=1e-14)

    def test_grains(self):
        """Walls of grains do not rotate."""
        U = "rotatingWallVelocity; origin (0.3 0.3 1); axis (0 0 1); omega 8; value uniform (0 0 0)"
        for program, says in (("granularMD", "patch zHigh: type is rotatingWallVelocity; walls of grains are smooth or rough: use  slip;  or  JohnsonJacksonSlip;"),
                              ("granularDEM", "patch zHigh: walls of granularDEM do not rotate: give  noSlip;  (a wall at rest) or run granularGas")):
            case = self.plate(U, "slip")
            harness.edit(case, "system/controlDict", application=program)
            harness.boxes.write_dictionary(case, "constant", "particleProperties", CONTACT if program == "granularDEM" else "")
            done = harness.program(program, "-case", case, "-dry-run", check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()
