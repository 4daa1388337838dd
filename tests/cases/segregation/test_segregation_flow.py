# SPDX-License-Identifier: GPL-3.0-or-later
"""What carries the mixture: flows of other cases, their density, shear and stress, gravity, cyclic axes, 3D."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.segregation import mixtures

LAWS = "percolation {{ type constant; velocity {f}; direction ({d}); }} diffusivity {{ type constant; value {D}; }}\n"


def laws(f, D, direction="0 1 0"):
    return LAWS.format(f=f, D=D, d=direction)


class Flow(mixtures.Mixture, unittest.TestCase):
    def phi(self, case, time=None):
        return harness.haff.Case(case).field("phi", time)

    def wedge(self, N):
        return self.short("wedge", N, writeInterval=0.0425).path

    def over_wedge(self, gas, N, f=None, D=None, more="weight rho;"):
        """The mixture of cases/segregationWedge with N cells a side, carried by the gas; f: instead of its stress."""
        case = harness.copy("segregationWedge", self.folder)
        harness.mesh(case, N)
        harness.edit(case, "system/controlDict", endTime=0.05, deltaT=1e-3, writeInterval=0.05)
        with open(case + "/constant/segregationProperties") as file:
            text = file.read()
        with open(case + "/constant/segregationProperties", "w") as file:
            file.write(text.replace('"gas"', f'"{os.path.relpath(gas, case)}"'))
        if f is not None:
            harness.write_dictionary(
                case, "constant", "segregationProperties",
                f"percolation {{ type constant; velocity {f}; }} diffusivity {{ type constant; value {D}; }}\n"
                f'velocity {{ case "{os.path.relpath(gas, case)}"; {more} }}\n')
        return case

    def test_wedge(self):
        """Carried by a gas at a time of its run, on its grid and on a finer one: uniform phi stays, so does 0 .. 1."""
        gas = self.wedge(20)
        rho = harness.haff.Case(gas).field("rho")
        for N, more in ((20, "weight rho;"), (20, "time 0.0425;"), (40, "time 4.25e-2; weight rho;")):
            still = self.over_wedge(gas, N, 0, 0.1, more)
            log = self.run_case(still)
            self.assertLess(np.max(np.abs(self.phi(still) - 0.5)), 1e-13)
            self.assertIn("mass flow rho U" if "rho" in more else "velocity U", log)
            if N == 20 and "rho" in more:
                mass = np.sum(rho * 0.5 * harness.haff.Case(still).volumes)
                self.assertIn(f"small grains {mass:.10g}", log)
        sorting = self.over_wedge(gas, 20, -5, 0)
        self.run_case(sorting)
        phi = self.phi(sorting)
        self.assertTrue((phi >= 0).all() and (phi <= 1).all())
        self.assertGreater(np.ptp(phi), 0.05)

    def test_wedge_of_stress(self):
        """The shipped case, coarse: small grains leave the shock, where the kinetic stress rises, for the wall."""
        gas = self.wedge(40)
        case = self.over_wedge(gas, 40)
        self.run_case(case)
        at, phi = harness.haff.Case(case).centres, self.phi(case)
        stress = harness.haff.Case(gas).field("rho") * harness.haff.Case(gas).field("T")
        column = np.flatnonzero(np.abs(at[:, 0] - 8.125) < 1e-6)
        column = column[np.argsort(at[column, 1])]
        phi, stress = phi[column], stress[column]
        steepest = np.argmax(stress[:-1] - stress[1:])
        self.assertLessEqual(abs(np.argmin(phi) - steepest), 1)
        self.assertLess(phi.min(), 0.4)
        self.assertGreater(phi[0], 0.55)
        np.testing.assert_allclose(phi[-8:], 0.5, atol=1e-3)

    def test_closed_box(self):
        """A compressible flow between walls: sum rho phi V stays, and a uniform mixture without percolation."""
        n, size = (24, 16, 1), (1.2, 0.8, 0.1)
        at = harness.boxes.centres(n, size)
        rho = 2 + np.sin(3 * at[:, 0] + at[:, 1])
        U = np.stack([np.sin(2 * at[:, 1]), np.cos(5 * at[:, 0]), 0 * rho], axis=1)
        for f, phi in ((0.3, np.where(at[:, 1] > 0.4, 1.0, 0.2)), (0, np.full(len(rho), 0.37))):
            text = laws(f, 0, "1 2 0") + 'velocity { case "gas"; weight rho; }\n'
            case = self.box(n, size, phi, text, "", 1, 0.02)
            gas = os.path.join(case, "gas")
            shutil.copytree(case + "/constant", gas + "/constant")
            for name, values in (("rho", rho), ("U", U)):
                harness.boxes.write_field(gas, name, values)
            self.run_case(case)
            end = self.phi(case)
            self.assertLess(abs(np.sum(rho * end) / np.sum(rho * phi) - 1), 1e-13)
            self.assertTrue((end >= 0).all() and (end <= 1).all())
            if not f:
                self.assertLess(np.max(np.abs(end - 0.37)), 1e-12)

    def test_flow_of_another_case(self):
        """U of another case's time on the same cells is U of the own folder, to the bit, through a restart, too."""
        own = self.chute(10, endTime=0.2, deltaT=5e-3, writeInterval=0.1)
        other = shutil.copytree(own, own + "_other")
        self.run_case(own)
        os.remove(other + "/0.orig/U")
        runs.add(other, "constant/segregationProperties", f'velocity {{ case "{own}"; time 0.1; }}\n')
        harness.edit(other, "system/controlDict", endTime=0.1)
        self.run_case(other)
        harness.edit(other, "system/controlDict", endTime=0.2)
        self.run_case(other)
        for name in ("0.1/phi", "0.2/phi"):
            with open(os.path.join(own, name), "rb") as a, open(os.path.join(other, name), "rb") as b:
                self.assertEqual(a.read(), b.read())

    def test_flow_that_changes(self):
        """A flow is taken once: patches of U that change in time are refused, as those of phi."""
        case, inlet = self.chute(10), "inlet   { type zeroGradient; }"
        value = 'value uniform (0 0 0); expression ("%s" "0" "0");'
        rows = (("0.orig/U", inlet, "inlet { type fixedValue; %s }" % (value % "t"), "patch inlet: its values change in time"),
                ("0.orig/U", inlet, "inlet { type uniformFixedValue; uniformValue table ((0 (0 0 0)) (1 (1 0 0))); }", "change in time"))
        self.refused(case, rows, ("checkCase", case))
        with open(case + "/0.orig/phi") as f:
            fixed = "type fixedValue;" in f.read()
        if fixed:
            self.refused(case, (("0.orig/phi", "type fixedValue;", 'type fixedValue; expression "t";', "'expression' is not used"),), ("checkCase", case))

    def test_flow_errors(self):
        gas = self.wedge(8)
        case = self.over_wedge(gas, 8, -5, 0.1, "weight rho;")
        far = harness.copy("wedge", self.folder)
        harness.boxes.write_mesh(far, (4, 4, 1), (9, 10, 0.1))
        harness.boxes.write_field(far, "U", np.zeros((16, 3)))
        name = os.path.basename(os.path.dirname(gas))
        rows = (("constant/segregationProperties", "weight rho;", "time 0.05;", "has no time 0.05; it has 0 0.0425"),
                ("constant/segregationProperties", "weight rho;", "weight rh;", "did you mean 'rho'?"),
                ("constant/segregationProperties", "weight rho;", "time last;", "'time' is last"),
                ("constant/segregationProperties", f"{name}/wedge", f"{name}/wdge", "velocity: there is no case"),
                ("constant/segregationProperties", f'"{os.path.relpath(gas, case)}"', f'"{far}"', "does not cover this one"),
                ("constant/segregationProperties", "constant; value 0.1", 'expression; value "shearRate - 1e6"', "must be 0 or more"),
                ("0.orig/phi", "wall   { type noFlux; }", "wall   { type zeroGradient; }", "phi must be noFlux"),
                ("0.orig/phi", "inlet  { type fixedValue; value uniform 0.5; }", "inlet  { type zeroGradient; }", "phi must be fixedValue"))
        self.refused(case, rows, ("checkCase", case))
        still = self.box((4, 4, 1), (1, 1, 0.1), np.full(16, 0.5), laws(-1, 0.1), "", 1, 0.1)
        rows = (("constant/segregationProperties", "constant; value 0.1", 'expression; value "shearRate"', "shearRate needs a flow"),
                ("constant/segregationProperties", "constant; value 0.1", 'expression; value "shearate"', "did you mean 'shearRate'?"),
                ("constant/segregationProperties", "direction (0 1 0);", "", "constant/g"))
        self.refused(still, rows, ("checkCase", still))
        still = self.box((4, 4, 1), (1, 1, 0.1), np.full(16, 0.5), laws(-1, 0.1), "xLow zeroGradient", 1, 0.1)
        rows = (("constant/polyMesh/boundary", "type patch", "type wall", "the mesh is 'wall' there, a wall: phi must be noFlux"),)
        self.refused(still, rows, ("checkCase", still))

    def test_gravity(self):
        """Without a direction f is counted against gravity."""
        given = self.chute(8, endTime=0.1, deltaT=5e-3, writeInterval=0.1)
        fallen = shutil.copytree(given, given + "_fallen")
        properties = os.path.join(fallen, "constant", "segregationProperties")
        with open(properties) as f:
            text = f.read()
        with open(properties, "w") as f:
            f.write(text.replace("velocity 0.02; direction (0.43837 -0.89879 0);", "velocity -0.02;"))
        harness.write_dictionary(fallen, "constant", "g", "value (4.3837 -8.9879 0);\n")
        self.run_case(given)
        self.run_case(fallen)
        np.testing.assert_allclose(self.phi(fallen), self.phi(given), atol=1e-12)

    def test_laws(self):
        """On a lattice: D of a shear rate, D(phi), and f of a kinetic stress that say what numbers say."""
        n, size = (8, 20, 1), (0.4, 1, 0.1)
        at = harness.boxes.centres(n, size)
        phi, U = 0.5 + 0.3 * at[:, 0], np.stack([5 * at[:, 1], 0 * at[:, 0], 0 * at[:, 0]], axis=1)
        ends = "xLow fixedValue; value uniform 0.5\nxHigh zeroGradient"
        results = []
        for D in ("constant; value 0.1", 'expression; value "0.02*shearRate"', 'expression; value "0.1 + 0*phi*shearRate"',
                  "stress"):
            f = "constant; velocity -0.6;" if D != "stress" else 'kineticStress; case "gas"; q 2; rho 1;'
            D = "constant; value 0.1" if D == "stress" else D
            case = self.box(n, size, phi, f"percolation {{ type {f} direction (0 1 0); }} diffusivity {{ type {D}; }}",
                            ends, 0.2, 0.01, U=U)
            gas = os.path.join(case, "gas")
            shutil.copytree(case + "/constant", gas + "/constant")
            for name, values in (("rho", 2 + 0 * phi), ("T", 3 - 0.15 * at[:, 1])):
                harness.boxes.write_field(gas, name, values)
            self.run_case(case)
            results.append(self.phi(case))
        for other in results[1:]:
            np.testing.assert_allclose(other, results[0], atol=2e-12)

    def test_shear_on_a_line(self):
        """The shear rate of 0/U and of another case's columns; a run in two parts finds U again."""
        n, size = (1, 40, 1), (0.1, 1, 0.1)
        y = harness.boxes.centres(n, size)[:, 1]
        U = np.stack([5 * y, 0 * y, 2 * y], axis=1)
        results, D = [], 'percolation { type constant; velocity -1; } diffusivity { type expression; value "%s"; }'
        for law, own, parts in (("0.1*sqrt(29)", None, False), ("0.1*shearRate", U, True), ("0.1*shearRate", None, False)):
            text = D % law + ("" if own is not None or "shear" not in law else ' velocity { case "gas"; time 0; }')
            case = self.box(n, size, 0.5 + 0 * y, text, "", 0.2, 0.01, U=own)
            gas = os.path.join(case, "gas")
            os.makedirs(gas)
            kinds = harness.boxes.write_mesh(gas, (3, 40, 1), (0.3, 1, 0.1))
            self.assertIn("yLow", kinds)
            harness.boxes.write_field(gas, "U", np.repeat(U, 3, axis=0) + np.tile([[0, 0, 0], [1, 0, 0], [-1, 0, 0]], (40, 1)))
            if parts:
                harness.edit(case, "system/controlDict", endTime=0.1, writeInterval=0.1)
                self.run_case(case)
                harness.edit(case, "system/controlDict", endTime=0.2)
            self.run_case(case)
            results.append(self.phi(case))
        for other in results[1:]:
            np.testing.assert_allclose(other, results[0], atol=1e-12)

    def test_cyclic(self):
        """A chute without ends, in 2D and 3D: layers that only know the height are those of a line of cells."""
        f, D, lean, results = 0.02, 2e-5, (0.43837, -0.89879), []
        for n in ((1, 20, 1), (6, 20, 1), (6, 20, 4)):
            size = np.array((0.006, 0.02, 0.004))
            at = harness.boxes.centres(n, size)
            types = {a: "cyclic" for a, k in zip("xz", (n[0], n[2])) if k > 1}
            U = np.stack([3e-3 * (1 - (1 - at[:, 1] / 0.02) ** 1.5), 0 * at[:, 0], 0 * at[:, 0]], axis=1)
            text = laws(f * lean[1] if n[0] == 1 else f, D, "0 1 0" if n[0] == 1 else f"{lean[0]} {lean[1]} 0")
            case = self.box(n, size, np.full(len(at), 0.5), text, "", 1, 5e-3, types=types, U=U if n[0] > 1 else None)
            self.run_case(case)
            phi = self.phi(case).reshape(n[2], 20, n[0])
            self.assertLess(np.max(np.ptp(phi, axis=(0, 2))), 1e-11)
            self.assertLess(abs(phi.mean() - 0.5), 1e-14)
            results.append(phi[0, :, 0])
        self.assertGreater(np.ptp(results[0]), 0.3)
        for other in results[1:]:
            np.testing.assert_allclose(other, results[0], atol=2e-4)  # Newton's one iteration

    def test_inlet(self):
        """phi on a patch with fixedValue is the value, whatever percolates and spreads there: the mixture that comes in at 0.5
        stays 0.5. The flow, at rest or not, is along the axis; D = 0 is as far from resolved as can be."""
        for u, f, D, outlet in ((0.3, 0.1, 0, "zeroGradient"), (0.3, 0.1, 0.01, "zeroGradient"), (0, 0.1, 0.05, "zeroGradient"),
                                (0.3, -0.1, 0.05, "fixedValue; value uniform 0.5"), (0, 0, 0.05, "noFlux")):
            n, size = (8, 4, 1), (0.4, 0.2, 0.1)
            patches = f"xLow fixedValue; value uniform 0.5\nxHigh {outlet}"
            U = np.tile((u, 0, 0), (32, 1)) if u else None
            case = self.box(n, size, np.full(32, 0.1), laws(f, D, "1 0 0"), patches, 40, 0.05, U=U)
            self.run_case(case)
            np.testing.assert_allclose(self.phi(case), 0.5, atol=2e-9, err_msg=f"u {u}, f {f}, D {D}")

    def kink_error(self, N, c, law):
        """Mean error of a kink that stands oblique in a box of N by N cells, with its own values on all four patches; where it
        would run at c, the flow carries it back."""
        d, D, f, U = np.array((0.6, 0.8)), 0.05, -1.0, None

        def exact(at):
            return (c - f) / (2 * f) * (np.tanh((c - f) * (np.asarray(at) @ d - 0.7) / (2 * D)) - 1)

        h = (np.arange(N) + 0.5) / N
        ends = {"xLow": (0 * h, h), "xHigh": (1 + 0 * h, h), "yLow": (h, 0 * h), "yHigh": (h, 1 + 0 * h)}
        patches = "\n".join(f"{name} fixedValue; value nonuniform List<scalar> {N} ("
                            + " ".join("%.17g" % v for v in exact(np.transpose(at))) + ")" for name, at in ends.items())
        at = harness.boxes.centres((N, N, 1), (1, 1, 0.1))[:, :2]
        if c:
            U = np.tile((-c * d[0], -c * d[1], 0), (N * N, 1))
        text = laws(f, D, "0.6 0.8 0").replace("constant; value 0.05", law)
        case = self.box((N, N, 1), (1, 1, 0.1), np.full(N * N, 0.3), text, patches, 40, 0.1, U=U)
        log = self.run_case(case)
        self.assertIn("(change ", log)
        return np.mean(np.abs(self.phi(case) - exact(at)))

    def test_oblique_kink(self):
        """Order 2 with open patches all around, carried and at rest, wherever it starts from and with long steps; a law of phi
        that says what a number says."""
        for c, finest, law in ((-0.25, 4.6e-5, "constant; value 0.05"), (0, 9.1e-5, "constant; value 0.05"),
                               (-0.25, 4.6e-5, 'expression; value "0.05 + 0*phi"')):
            errors = [self.kink_error(N, c, law) for N in (16, 32, 64)]
            self.assertLess(errors[2], finest)
            for coarse, fine in zip(errors, errors[1:]):
                self.assertAlmostEqual(np.log2(coarse / fine), 2, delta=0.1)

if __name__ == "__main__":
    unittest.main()
