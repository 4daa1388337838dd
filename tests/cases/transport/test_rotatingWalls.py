# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls that rotate (rotatingWallVelocity), through the whole program: gas between two cylinders, slow enough to stay isothermal,
against u = A r + B/r and its torque; walls of Johnson & Jackson and of friction; what is refused."""
import os
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
        for n in (4,8,12):
          for quads in (QUADS,TRIANGLES):
            print(n,quads,self.steady(n, (1.0, -0.5), quads))


if __name__ == "__main__":
    unittest.main()
