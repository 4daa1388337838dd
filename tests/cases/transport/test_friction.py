# SPDX-License-Identifier: GPL-3.0-or-later
"""Beds with friction: slopes rest below their angle and flow above it, heaps stay, friction only takes energy. Restarts go on with the
stress to the bit, from any number of ranks to any other, on a lattice and on triangles."""
import math
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from tests.cases.runtime import test_energyBudget as audit
from tests.cases.transport.channels import replace

from haff.case import foam

D, G, PACKED = 1e-3, 9.81, 0.9 * 0.64  # m, m/s^2
SIZE = (20, 16, 1)  # of a collapse, in grain diameters
CORNER = "x < 0.007 && y < 0.01 ? 0.6 : 1e-5"
TRIANGLES = """L = 0.02; H = 0.016; Point(1) = {0, 0, 0}; Point(2) = {L, 0, 0}; Point(3) = {L, H, 0}; Point(4) = {0, H, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Mesh.MeshSizeMin = 0.0017; Mesh.MeshSizeMax = 0.0017; Physical Surface("gas") = {1};
Physical Curve("yLow") = {1}; Physical Curve("xHigh") = {2}; Physical Curve("yHigh") = {3}; Physical Curve("xLow") = {4};
"""
PROPERTIES = """grain { diameter 1e-3; mass 1.361356816555577e-6; restitution 0.9; thresholdSpeed 3e-3; }
equationOfState TorquatoSpheres; TorquatoSpheresCoeffs { alphaMax 0.64; alphaFreezing 0.49; }
cooling Haff;
"""
CONTROL = """application granularGas; startFrom latestTime; stopAt endTime; endTime %g; deltaT 1e-5; adjustTimeStep yes; maxCo 1;
writeControl adjustableRunTime; writeInterval %g; writeFormat binary; timePrecision 8; runTimeModifiable no;
"""
KEPT = ["frictionPressure"] + ["frictionStress" + side for side in ("XLow", "XHigh", "YLow", "YHigh")]


def bed(case, n, alpha, gravity, end, interval=None, floor="yLow", periodic="", friction="type muI;", schemes="", axis=None):
    """Cold spheres in a box of cells of one diameter, whose walls slip but for the floor; axis: x of the axis of a body of revolution."""
    symmetry = ["xLow"] if axis == 0 else []
    boxes.write_mesh(case, n, tuple(D * k for k in n), {**{a: "cyclic" for a in periodic}, **{p: "symmetryPlane" for p in symmetry}})
    if axis is not None:
        boxes.write_dictionary(case, "system", "meshDict", f"axis {{ origin ({axis} 0 0); direction (0 1 0); }}\n")
    os.makedirs(case + "/0.orig")
    for name, start in (("alpha", f'expression "{alpha}";'), ("T", "internalField uniform 1e-5;"), ("U", "internalField uniform (0 0 0);")):
        wall = "slip" if name == "U" else "zeroGradient"
        rules = "".join(f'"{a}.*" {{ type {"cyclic" if a in periodic else wall}; }}\n' for a in "xy")
        rules += '"(z|front|back).*" { type empty; }\n' + (f"{floor} {{ type noSlip; }}\n" if name == "U" else "")
        rules += "".join(f"{p} {{ type symmetryPlane; }}\n" for p in symmetry)
        with open(f"{case}/0.orig/{name}", "w") as f:
            f.write(boxes.header("volVectorField" if name == "U" else "volScalarField", name, "0.orig")
                    + f"dimensions {boxes.DIMENSIONS[name]};\n{start}\nboundaryField {{ {rules} }}\n")
    harness.write_dictionary(case, "system", "controlDict", CONTROL % (end, interval or end))
    harness.write_dictionary(case, "system", "fvSchemes", "fluxScheme common; reconstruct WPENO5; timeScheme SSPRK43;\n" + schemes)
    harness.write_dictionary(case, "system", "fvSolution", "acoustics { type automatic; }\n")
    harness.write_dictionary(case, "constant", "granularProperties", PROPERTIES + (f"friction {{ {friction} }}\n" if friction else ""))
    harness.write_dictionary(case, "constant", "g", "dimensions [0 1 -2 0 0 0 0]; value (%r %r %r);\n" % gravity)
    return case


def solve(case, ranks=1):
    done = harness.program("granularGas", "-case", case, ranks=ranks)
    return harness.haff.Case(case), done.stdout


class Friction(harness.Folder, unittest.TestCase):
    # ---- slopes ----

    def slope(self, angle, end, **options):
        a = math.radians(angle)
        return bed(os.path.join(self.folder, f"slope{angle}{end}"), (2, 24, 1), "y < 0.015 ? 0.6 : 1e-6", (G * math.sin(a), -G * math.cos(a), 0.0), end,
                   periodic="x", **options)

    def speeds(self, result):
        """max |u_x| and |u_y| over sqrt(g depth) of the rows that are packed and have a packed one above them."""
        alpha, y = (v.reshape(24, 2) for v in (result.field("alpha"), result.centres[:, 1]))
        rows = np.flatnonzero((alpha > PACKED).all(axis=1))
        self.assertEqual(list(rows), list(range(14)), "the layer lies on the floor")
        self.assertTrue((np.diff(y[:, 0]) > 0).all())
        u = np.abs(result.field("U").reshape(24, 2, 3)[:13])
        return u[..., 0].max() / math.sqrt(G * 0.015), u[..., 1].max() / math.sqrt(G * 0.015)

    def test_slopes(self):
        """tan 20 degrees is below muStatic = 0.38. Without cooling the bed keeps still, too."""
        case = self.slope(20, 1.2)
        result, log = solve(case)
        self.assertNotRegex(log, "noFriction|dampedSound|are left out")
        along, across = self.speeds(result)
        self.assertLess(along, 1e-6)
        self.assertLess(across, 1e-5, "it still contracts as it cools")
        harness.edit(case, "constant/granularProperties", cooling="none")
        harness.edit(case, "system/controlDict", endTime=1.6)
        along, across = self.speeds(solve(case)[0])
        self.assertLess(max(along, across), 1e-6)

    def test_bagnold(self):
        """Above its angle the layer speeds up to Bagnold's profile with the I at which mu(I) = tan 22 degrees. Cells at the surface, which have
        cohesion (docs/physics.md 9.3) and a load of thin gas, are left out; 22 degrees is that near to the angle at which the layer stops that
        0.002 of mu are 8 % of u. test_frictionFlows is stricter."""
        result, _ = solve(self.slope(22, 1.4))
        a = math.radians(22)
        inertia = 0.279 / ((0.64 - 0.38) / (math.tan(a) - 0.38) - 1)
        alpha, u = (v.reshape(24, 2)[:, 0] for v in (result.field("alpha"), result.field("U")[:, 0]))
        depth, y = alpha.sum() * D / 0.64, (np.arange(10) + 0.5) * D
        exact = 2 / 3 * inertia / D * math.sqrt(0.64 * G * math.cos(a)) * (depth ** 1.5 - (depth - y) ** 1.5)
        np.testing.assert_allclose(u[:10], exact, rtol=0.03)

    def test_warning(self):
        """A bed that comes to rest without friction is warned of, with the cure; one with friction is not."""
        for friction in ("", "type muI;"):
            case = bed(f"{self.folder}/warned{friction != ''}", (1, 20, 1), "y < 0.015 ? 0.6 : 1e-6", (0.0, -G, 0.0), 2.0, friction=friction)
            log = solve(case)[1]
            self.assertEqual(bool(re.search(r"granularProperties:1: .*without  friction \{ type muI; \}  a heap goes flat.*\[noFriction\]", log)), not friction)

    def test_few_steps_fail(self):
        """Packed gas in a box that tilts, below near vacuum. 103 of 507 steps failed while the stages could let more flow out of near vacuum beside
        the bed than the bed brings there."""
        case = harness.copy("tiltedBox", self.folder)
        harness.mesh(case, 1)
        harness.edit(case, "system/controlDict", endTime=0.065, writeInterval=0.065)
        log = solve(case)[1]
        failed = re.findall(r"rejected: .*in all (\d+)", log) or [0]
        self.assertGreater(int(re.search(r"^end at time .*: (\d+) steps", log, re.M)[1]), 300)
        self.assertLess(int(failed[-1]), 20)

    # ---- a silo at rest ----

    def silo(self, name, end, gravity_rises=0):
        """Grains 6 widths deep between walls of muWall 0.3: the floor's share of the weight, depths, pressures."""
        width, depth = 6, 36
        functions = "functions { floor { type forces; patches (yLow); CofR (0 0 0); writeControl timeStep; writeInterval 20; } }\n"
        case = bed(os.path.join(self.folder, name), (width, depth + 4, 1), f"y < {depth * D} ? 0.63 : 1e-6", (0.0, -G, 0.0), end)
        replace(case, "0.orig/U", "noSlip", "slip")
        replace(case, "0.orig/U", '"x.*" { type slip; }', '"x.*" { type frictionalSlip; muWall 0.3; }')
        runs.add(case, "system/controlDict", functions + "acceptWarnings (faintShaking);\n")
        if gravity_rises:
            rises = f"type sinusoidal; amplitude table ((0 0.999) ({gravity_rises} 0)); frequency 1e-6; phase {math.pi!r};\n"
            harness.write_dictionary(case, "constant", "shaking", rises)
        result, _ = solve(case)
        with open(os.path.join(case, "postProcessing", "floor", "0", "force.dat")) as f:
            force = -float(f.read().splitlines()[-1].split("(")[1].split()[1])
        p, y = (v.reshape(-1, width).mean(axis=1) for v in (result.field("p"), result.centres[:, 1]))
        column = result.field("rho").sum() / width * D
        return force / ((result.field("rho") * result.volumes).sum() * G), column / 2600 / 0.64 - y, p

    def test_janssen(self):
        """Walls bear weight as far as grains settle along them. Where gravity rises slowly they bear what Janssen's law says with the ratio
        K = 0.8 of horizontal to vertical stress; grains that are laid at once fall and spring back, and less is left to the walls."""
        share, depth, p = self.silo("slow", 0.5, gravity_rises=0.4)
        low, high = 0.3, 2.0
        for _ in range(50):
            K = (low + high) / 2
            x = 2 * 0.3 * K * 6
            low, high = (K, high) if (1 - math.exp(-x)) / x > share else (low, K)
        within = (depth > 5 * D) & (depth < 33 * D)
        scale = 6 * D / (2 * 0.3 * K)
        exact = (1 + K) / 2 * 2600 * 0.64 * G * scale * (1 - np.exp(-depth[within] / scale))  # the mean of both stresses
        laid = self.silo("laid", 0.2)[0]
        self.assertAlmostEqual(K, 0.8, delta=0.08)
        np.testing.assert_allclose(p[within], exact, rtol=0.1)
        self.assertGreater(laid, 1.3 * share)
        self.assertLess(laid, 0.7)

    # ---- a heap ----

    def test_heap(self):
        """The case heap2D in 32 x 24 cells on a rough floor: without friction it sloshes to and fro, about 16 mm. Friction takes energy in every
        step, and what the budget cannot explain is round-off."""
        case = harness.copy("heap2D", self.folder)
        harness.mesh(case, 32)
        with open(case + "/0.orig/U") as f:
            text = f.read()
        with open(case + "/0.orig/U", "w") as f:
            f.write(text.replace('"(floor|sides|lid)" { type slip; }', 'floor { type noSlip; } "(sides|lid)" { type slip; }'))
        runs.add(case, "constant/granularProperties", "friction { type muI; }\n")
        audit.ask(case)
        harness.edit(case, "system/controlDict", endTime=0.5, writeInterval=0.1)
        result, log = solve(case)
        self.assertNotIn("dampedSound", log, "what friction stops is no wave")
        centre = []
        for time in ("0.3", "0.5"):
            mass = result.field("alpha", time) * result.volumes
            centre.append(mass @ result.centres[:, 0] / mass.sum())
        self.assertAlmostEqual(centre[1], 0.01164, delta=1e-4)
        self.assertLess(abs(centre[1] - centre[0]), 2e-4)
        self.assertLess(int(re.search(r"end at time .*: (\d+) steps", log).group(1)), 3000)
        with open(case + "/postProcessing/budget/0/energyBudget.dat") as f:
            titles = next(line for line in f if "residual" in line).lstrip("# ").split()
        b = dict(zip(titles, result.table("budget", "energyBudget.dat").T))
        scale = max(np.abs(b[name]).max() for name in ("cooling", "gravity", "friction"))
        self.assertLess(b["friction"][-1], -0.1 * scale)
        self.assertLessEqual(np.diff(b["friction"]).max(), 0)
        self.assertLess(np.abs(b["residual"]).max(), 1e-12 * scale)

    def test_heating(self):
        """frictionalHeating leaves that part of the work of friction in the gas; the budget explains the rest to round-off."""
        lost = []
        for part in (0, 0.5, 1):
            with self.subTest(part=part):
                case = self.collapse(f"heating{part}", end=0.03, interval=0.01, friction=f"type muI; frictionalHeating {part};")
                harness.edit(case, "constant/granularProperties", cooling="none")
                audit.ask(case)
                result, log = solve(case)
                with open(case + "/postProcessing/budget/0/energyBudget.dat") as f:
                    titles = next(line for line in f if "residual" in line).lstrip("# ").split()
                b = dict(zip(titles, result.table("budget", "energyBudget.dat").T))
                self.assertLess(np.abs(b["residual"]).max(), 1e-12 * np.abs(b["gravity"]).max())
                lost.append(b["friction"][-1] / np.abs(b["gravity"]).max())
        self.assertLess(lost[0], -0.5)
        self.assertAlmostEqual(lost[1] / lost[0], 0.5, delta=0.03)
        self.assertAlmostEqual(lost[2] / lost[0], 0, delta=1e-3)

    def test_correlations_fade(self):
        """Where contacts carry the share s of the stress, the length of correlated impacts has 1 - s of the shear rate."""
        def cooled(alpha, c, friction):
            case = bed(f"{self.folder}/correlated{alpha}{c}{friction != ''}", (1, 8, 1), alpha, (0.0, 0.0, 0.0), 1e-4, friction=friction)
            harness.edit(case, "constant/granularProperties", cooling="Jenkins")
            runs.add(case, "constant/granularProperties", f"JenkinsCoeffs {{ c {c}; }}\n")
            replace(case, "0.orig/U", "internalField uniform (0 0 0);", 'expression ("40*y" "0" "0");')
            replace(case, "0.orig/U", "noSlip", "slip")
            return float(solve(case)[0].field("T")[3])

        rubs = "type Coulomb; alphaFriction 0.5; alphaSolid 0.58;"
        self.assertEqual(cooled(0.6, 0.8, rubs), cooled(0.6, 0, rubs))
        self.assertGreater(cooled(0.6, 0.8, ""), 1.001 * cooled(0.6, 0, ""))
        half, alone, less = cooled(0.54, 0.8, rubs), cooled(0.54, 0.8, ""), cooled(0.54, 0.4, "")
        self.assertAlmostEqual(half / less, 1, delta=1e-12)
        self.assertGreater(alone / less, 1.0001)

    def test_ratio(self):
        """The field stressRatio is |tau|/p of the stresses and pressures that a restart reads, with the normal stresses, also that along z."""
        case = self.collapse("ratio", end=0.01)
        runs.add(case, "system/controlDict", "functions { ratio { type writeObjects; objects (stressRatio); writeControl writeTime; } }\n")
        result, _ = solve(case)
        cells = int(np.prod(SIZE))
        p, *sides = (foam.read_field(os.path.join(case, "0.01", "uniform", name), cells) for name in KEPT)
        carry = sum((side != 0).any(axis=1) for side in sides)
        xx, xy, _, yy, _, _ = (sum(sides) / np.fmax(carry, 1)[:, None]).T
        size = np.sqrt(0.5 * (xx**2 + yy**2 + (xx + yy)**2) + xy**2)
        found, packed = result.field("stressRatio"), (p > 0) & (result.field("alpha") > 0.78 * 0.64)
        self.assertGreater(np.abs(yy[packed]).max(), 0.1 * np.abs(xy[packed]).max())
        np.testing.assert_allclose(found[packed], (size / np.where(p > 0, p, 1))[packed], rtol=1e-12)
        self.assertFalse(found[~packed].any())

    # ---- the same bits ----

    def collapse(self, name, mesh="lattice", end=0.01, interval=None, **options):
        case = bed(os.path.join(self.folder, name), SIZE, CORNER, (0.0, -G, 0.0), end, interval, **options)
        if mesh == "triangles":
            shutil.rmtree(case + "/constant/polyMesh")
            with open(case + "/mesh.geo", "w") as f:
                f.write(TRIANGLES)
            harness.mesh(case, 0, option="unused")
        return case

    def same_times(self, one, other, names):
        for name in names:
            runs.same(self, runs.contents(os.path.join(one, name)), runs.contents(os.path.join(other, name)), name)

    def ranks_and_restarts(self, mesh):
        whole = self.collapse(mesh, mesh, 0.015, 0.005)
        solve(whole)
        names = runs.times(whole)
        two = self.collapse(mesh + "2", mesh, 0.015, 0.005)
        solve(two, 2)
        self.same_times(whole, two, names[1:])
        for case, at, ranks in ((two, "0.005", 3), (two, "0.01", 1)):
            with self.subTest(mesh, at=at, ranks=ranks):
                part = runs.until(case, f"{case}_{at}_{ranks}", at)
                self.assertNotIn("starts without stress", solve(part, ranks)[1])
                self.same_times(whole, part, names[names.index(at) + 1:])
        return whole

    def test_lattice(self):
        """Also by stops at each time that is written. A time folder without stress is a start of its own, and the log says so."""
        whole = self.ranks_and_restarts("lattice")
        folder = os.path.join(whole, "0.01", "uniform")
        self.assertEqual(sorted(n for n in os.listdir(folder) if n.startswith("friction")), sorted(KEPT))
        stops = runs.until(whole, whole + "_stops", "0")
        harness.edit(stops, "system/controlDict", stopAt="nextWrite")
        for name in runs.times(whole)[1:]:
            solve(stops, 1 + (name == "0.01"))
            self.same_times(whole, stops, [name])
        lost = runs.until(whole, whole + "_lost", "0.01")
        for name in ["checksums"] + KEPT:
            os.remove(os.path.join(lost, "0.01", "uniform", name))
        result, log = solve(lost)
        self.assertIn("friction starts without stress: time 0.01 has no uniform/frictionPressure", log)
        self.assertTrue((result.field("U", "0.015") != harness.haff.Case(whole).field("U", "0.015")).any())

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_triangles(self):
        self.ranks_and_restarts("triangles")

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_stress_beside_heating(self):
        """The stress that the next step begins with is that of the velocity at the end of the step, whether friction heats or not."""
        without, least = (solve(self.collapse(name, "triangles", end=0.01, friction=f"type muI; frictionalHeating {heats};"))[0]
                          for name, heats in (("unheated", 0), ("hardlyHeated", 1e-12)))
        U = without.field("U", "0.01")
        np.testing.assert_allclose(least.field("U", "0.01"), U, rtol=0, atol=1e-7 * np.abs(U).max())

    def test_damaged_files(self):
        case = self.collapse("damaged", end=0.004, interval=0.002)
        solve(case)
        file = os.path.join(case, "0.004", "uniform", "frictionStressYLow")
        with open(file, "rb") as f:
            text = f.read()
        harness.edit(case, "system/controlDict", endTime=0.006)
        for damaged in (text[:-400], text.replace(b"List<symmTensor>", b"List<vector>")):
            for sums in (True, False):
                shutil.rmtree(case + "x", ignore_errors=True)
                shutil.copytree(case, case + "x")
                with open(file.replace(case, case + "x"), "wb") as f:
                    f.write(damaged)
                if not sums:
                    os.remove(os.path.join(case + "x", "0.004", "uniform", "checksums"))
                done = harness.program("granularGas", "-case", case + "x", check=False)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, r"frictionStressYLow: the file has" if sums else r"frictionStressYLow:\d+: ")

    def test_with_carried_quantities(self):
        """A bed with friction carries them, too: what is 1 everywhere stays 1."""
        case = self.collapse("carried", end=0.01)
        runs.add(case, "constant/granularProperties", "carried { dye { type passive; } }\n")
        boxes.write_field(case, "phi", np.ones(int(np.prod(SIZE))), '"[xy].*" zeroGradient\nzEmpty empty', time="0.orig")
        os.rename(case + "/0.orig/phi", case + "/0.orig/dye")
        result, _ = solve(case)
        np.testing.assert_allclose(result.field("dye", "0.01"), 1, rtol=1e-12)

    def test_packed_gas_at_an_outlet(self):
        """No bed can say how fast packed gas leaves where the patch gives no pressure. Then steps are explicit, and the log says so."""
        case = bed(os.path.join(self.folder, "outlet"), SIZE, "y < 0.01 ? 0.6 : 1e-6", (0.0, -G, 0.0), 0.012)
        with open(case + "/0.orig/U", "r+") as f:
            text = f.read().replace("yLow { type noSlip; }", "yLow { type noSlip; } xHigh { type zeroGradient; }")
            f.seek(0)
            f.write(text)
        self.assertRegex(solve(case)[1], r"packed gas at an open patch")

    def test_none(self):
        """type none; is a case without the dictionary, and writes nothing of friction."""
        cases = [self.collapse(f"none{i}", end=0.01, friction=f) for i, f in enumerate(("type none;", ""))]
        for case in cases:
            solve(case)
        self.same_times(*cases, runs.times(cases[0]))
        self.assertEqual([n for n in runs.contents(cases[0]) if "friction" in n], [])

    def test_mirror_and_turn(self):
        """A mirror image, and gravity along x in place of y. Solvers of beds keep both to round-off, which grows as grains yield (docs/design.md)."""
        g, end = -G, 0.01
        plain, _ = solve(self.collapse("plain", end=end))
        mirror, _ = solve(bed(self.folder + "/mirror", SIZE, "x > 0.013 && y < 0.01 ? 0.6 : 1e-5", (0.0, g, 0.0), end))
        turned, _ = solve(bed(self.folder + "/turned", (16, 20, 1), "y < 0.007 && x < 0.01 ? 0.6 : 1e-5", (g, 0.0, 0.0), end, floor="xLow"))
        for name in ("rho", "p"):
            one = plain.field(name).reshape(16, 20)
            for other in (mirror.field(name).reshape(16, 20)[:, ::-1], turned.field(name).reshape(20, 16).T):
                np.testing.assert_allclose(other, one, rtol=0, atol=1e-12 * one.max())
        one = plain.field("U").reshape(16, 20, 3)
        for other in (mirror.field("U").reshape(16, 20, 3)[:, ::-1] * [-1, 1, 1], turned.field("U").reshape(20, 16, 3).transpose(1, 0, 2)[..., [1, 0, 2]]):
            np.testing.assert_allclose(other, one, rtol=0, atol=1e-10 * np.abs(one).max())


if __name__ == "__main__":
    unittest.main()
