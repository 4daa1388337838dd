# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls that change in time, through the whole program: one that swings along itself (Stokes' second problem) and one that is heated
in time, against the exact linear waves; what is refused. (tests/libcore/gas/test_mpi_vary.c has all time schemes.)"""
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes
from tests.cases.transport.channels import POLYHEDRAL, replace

from studies.exact import disks  # noqa: E402

HEIGHT, ALPHA, SMALL = 20.0, 0.2, 1e-4
EMPTY = '\n"(left|right)" cyclic\n"(front|back)" empty'


class Gas:
    """Linear waves of angular frequency `omega` between two walls, of elastic disks at T = 1."""

    def __init__(self, case, omega):
        gas, self.omega = disks.Disks.of(case), omega
        rho = self.rho = ALPHA / gas.per
        self.nu = gas.shear(rho, 1.0) / rho
        # d/dt as i omega, d/dy as k: mass, momentum and energy leave a quadratic equation for k^2
        mu, kappa, p = gas.bulk(rho, 1.0) + gas.shear(rho, 1.0), gas.heat(rho, 1.0), rho * gas.A(ALPHA)
        a, b = 1j * omega * rho, gas.stiffness(ALPHA) * rho / (1j * omega) + mu
        square = np.roots([-b * kappa, a * kappa + b * a + p * p, -a * a])
        self.k = np.concatenate([np.sqrt(square), -np.sqrt(square)])
        shift = np.where(self.k.real > 0, HEIGHT, 0.0)  # each wave is 1 at the wall that it leaves
        self.shift, self.heat, self.mass = shift, p * self.k / (kappa * self.k**2 - a), -rho * self.k / (1j * omega)
        ends = np.exp(self.k * (np.array([[0.0], [HEIGHT]]) - shift))
        self.u = np.linalg.solve(np.vstack([ends, ends * self.heat]), [0, 0, 1, 0])  # u = 0 at both; T' = 1 at the floor

    def swinging(self, y, t):
        """u along the walls where the floor has cos(omega t)."""
        k = np.sqrt(1j * self.omega / self.nu)
        return (np.exp(1j * self.omega * t) * np.sinh(k * (HEIGHT - y)) / np.sinh(k * HEIGHT)).real

    def heated(self, y, t):
        """rho', u across and T' where the floor has T' = cos(omega t)."""
        waves = np.exp(1j * self.omega * t) * self.u * np.exp(self.k * (y[:, None] - self.shift))
        return [(waves * part).sum(axis=1).real for part in (self.mass, 1, self.heat)]


class VaryingWalls(harness.Folder, unittest.TestCase):
    def channel(self, cells, other=()):
        case = harness.copy("couetteDisks", self.folder)
        for change in other:
            replace(case, *change)
        harness.mesh(case, cells)
        harness.edit(case, "constant/granularProperties", restitution=1)
        return case, harness.haff.Case(case).centres[:, 1]

    def finish(self, case, fields, rules, time):
        for name, values in fields.items():
            boxes.write_field(case, name, values, rules[name] + EMPTY, time="0.orig")
        harness.edit(case, "system/controlDict", endTime=repr(time), writeInterval=repr(time), maxCo=0.4)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def swinging(self, cells, other):
        """The largest error after a third of a period; the wall's velocity as an expression and, at rest, as a table."""
        case, y = self.channel(cells, other)
        gas = Gas(case, 0.3)
        time = 2 * np.pi / 0.3 / 3
        u = np.zeros((len(y), 3))
        u[:, 0] = SMALL * gas.swinging(y, 0)
        wall = f'translatingWallVelocity; U (0 0 0); expression ("{SMALL}*cos(0.3*t)" "0" "0"); value uniform (0 0 0)'
        at_rest = "translatingWallVelocity; U table ((0 (0 0 0)) (1 (0 0 0))); value uniform (0 0 0)"
        rules = {"alpha": '"(floor|lid)" zeroGradient', "T": '"(floor|lid)" fixedValue; value uniform 1',
                 "U": f"floor {wall}\nlid {at_rest}"}
        result = self.finish(case, {"alpha": np.full(len(y), ALPHA), "T": np.ones(len(y)), "U": u}, rules, time)
        return np.abs(result.field("U")[:, 0] / SMALL - gas.swinging(y, time)).max()

    def heated(self, cells, other):
        """The largest error of T after a third of a period."""
        case, y = self.channel(cells, other)
        gas, per = Gas(case, 0.3), disks.Disks.of(case).per
        time = 2 * np.pi / 0.3 / 3
        rho, v, T = gas.heated(y, 0)
        u = np.zeros((len(y), 3))
        u[:, 1] = SMALL * v
        rules = {"alpha": '"(floor|lid)" zeroGradient', "U": '"(floor|lid)" noSlip',
                 "T": f'floor exprFixedValue; valueExpr "1 + {SMALL}*cos(0.3*time())"; value uniform 1\nlid uniformFixedValue; uniformValue 1'}
        result = self.finish(case, {"alpha": ALPHA + per * SMALL * rho, "T": 1 + SMALL * T, "U": u}, rules, time)
        return np.abs((result.field("T") - 1) / SMALL - gas.heated(y, time)[2]).max()

    def test_waves(self):
        for what, other, measured in ((self.swinging, (), 1.4e-3), (self.swinging, [POLYHEDRAL], 1.4e-3), (self.heated, (), 3.6e-4),
                                      (self.heated, [POLYHEDRAL], 3.6e-4)):
            with self.subTest(what=what.__name__, other=other):
                errors = np.array([what(n, other) for n in (40, 80)])
                self.assertGreater(np.log2(errors[0] / errors[1]), 1.9)
                self.assertLess(errors[1], 1.3 * measured)

    def test_refused(self):
        """A wall that begins to move through itself, found on the way; walls and patches that other programs would not follow."""
        lid = "type translatingWallVelocity; U (2 0 0);"
        for expression, code, says in (('("2" "t > 1 ? 1e-3 : 0" "0")', 2, "lid: expression gives (2 0.001 0) at the face at"),
                                       ('("2" "0" "t")', 1, "along z, out of it")):
            case, _ = self.channel(16, [("0.orig/U", lid, lid + f" expression {expression};")])
            harness.edit(case, "system/controlDict", endTime=2, writeInterval=2)
            done = harness.program("granularGas", "-case", case, check=False)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(says, done.stderr)
        case, _ = self.channel(16, [("0.orig/U", lid, lid + ' expression ("t" "0" "0");')])
        harness.edit(case, "system/controlDict", application="granularMD")
        done = harness.program("granularMD", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"0.orig/U:\d+: patch (floor|lid): type is translatingWallVelocity; walls of grains are smooth")

    def test_heated_grains(self):
        """granularMD has no walls that give heat, in time or not."""
        case, _ = self.channel(16, [("0.orig/T", "lid              { type fixedValue; value uniform 1; }",
                                     "lid              { type uniformFixedValue; uniformValue table ((0 1) (1 2)); }"),
                                    ("0.orig/U", "type translatingWallVelocity; U (-2 0 0);", "type slip;"),
                                    ("0.orig/U", "type translatingWallVelocity; U (2 0 0);", "type slip;"),
                                    ("0.orig/T", "floor            { type fixedValue; value uniform 1; }", "floor { type zeroGradient; }")])
        harness.edit(case, "system/controlDict", application="granularMD")
        done = harness.program("granularMD", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"0.orig/T:\d+: patch lid: U is 'slip', a wall; .* T cannot be 'uniformFixedValue'")


if __name__ == "__main__":
    unittest.main()
