# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of revolution: `axis` of system/meshDict on lattices and polyhedra.

References: gas that must stay as it is; conserved sums; the standing wave of linear sound in a cylinder,
J_0(k r) cos(m z) cos(w t), w^2 = c^2 (k^2 + m^2), J_0'(k) = 0; rigid rotation; volumes and areas by Pappus.
"""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from studies.made import triangles

ROOT = 3.8317059702075125  # the first zero of J_1
GAMMA = 5 / 3
SMALL = 1e-5  # amplitude of the wave: what is not linear is smaller by that
CAN = {"xLow": "wall", "xHigh": "wall", "yLow": "symmetryPlane", "yHigh": "wall"}


def bessel(order, x):
    """J_0, J_1 by their series, for x < 6 exact to round-off."""
    term, total = (x / 2)**order, 0
    for k in range(1, 40):
        total = total + term
        term = -term * (x / 2)**2 / (k * (k + order))
    return total


class Round(harness.Folder, unittest.TestCase):
    def case(self, name, n, rho, u, p, end, types=None, axis="1 0 0", engine="lattice", size=None, add="", **options):
        """A case of perfect gas about an axis through the origin; u: three arrays."""
        case = os.path.join(self.folder, name)
        size = size or [1.0 if k > 1 else 0.1 for k in n]
        types = CAN if types is None else types
        harness.box_case(case, n, size, rho, np.stack(u, axis=1), p, end, eos="perfectGas", types=types,
                         slip=[k for k in types if types[k] == "wall"], **options)
        boxes.write_dictionary(case, "system", "meshDict", f"axis {{ direction ({axis}); }}\n")
        runs.add(case, "system/fvSchemes", "" if engine == "lattice" else f"meshEngine polyhedral; polyReconstruct {engine};\n")
        runs.add(case, "system/controlDict", add)
        return case

    def run_case(self, *arguments, ranks=1, **options):
        case = self.case(*arguments, **options)
        harness.program("granularGas", "-case", case, ranks=ranks)
        return harness.haff.Case(case)

    @staticmethod
    def blast(n, size=(1.0, 1.0, 0.1)):
        x = boxes.centres(n, size)
        zero = 0 * x[:, 0]
        return x, zero + 1, [zero, zero, zero], np.where((x[:, 0] - 0.3)**2 + x[:, 1]**2 < 0.04, 10.0, 1.0)

    def test_stays(self):
        """Uniform gas at rest, and one that flows along the axis, stay as they are: on lattices to the bit."""
        for axis, across, engine in (("1 0 0", "y", "lattice"), ("0 1 0", "x", "lattice"), ("1 0 0", "y", "linear"),
                                     ("1 0 0", "y", "CWENO3")):
            for speed in (0.0, 0.7):
                with self.subTest(axis=axis, engine=engine, speed=speed):
                    n = (12, 16, 1)
                    one = np.ones(12 * 16)
                    along = "x" if across == "y" else "y"
                    types = {along: "cyclic", across + "Low": "symmetryPlane", across + "High": "wall"}
                    u = [one * speed * (along == a) for a in "xyz"]
                    result = self.run_case(f"stay{along}{engine}{speed}", n, one, u, one, 0.2, types, axis, engine)
                    least = 0 if engine == "lattice" else 3e-15
                    for name, wanted in (("rho", one), ("U", np.stack(u, axis=1)), ("p", one)):
                        self.assertLessEqual(np.abs(result.field(name) - wanted).max(), least, name)

    def test_force(self):
        """Gas at rest presses on the lid of a can with pi R^2 p, on its side with nothing along the axis."""
        one = np.ones(12 * 16)
        add = "functions { %s }\n" % " ".join(f"{p} {{ type forces; patches ({p}); CofR (0 0 0); }}" for p in ("xHigh", "yHigh"))
        for engine in ("lattice", "CWENO3"):
            case = self.case("press" + engine, (12, 16, 1), one, [0 * one] * 3, 3 * one, 0.01, engine=engine, add=add)
            self.assertIn("along x at y = 0: sums and forces are those of a full turn", harness.program("granularGas", "-case", case).stdout)
            for patch, wanted in (("xHigh", 3 * np.pi), ("yHigh", 0)):
                with open(os.path.join(case, "postProcessing", patch, "0", "force.dat")) as f:
                    last = f.read().split("\n")[-2].replace("(", " ").replace(")", " ").split()
                np.testing.assert_allclose([float(v) for v in last[1:4]], [wanted, 0, 0], atol=1e-13, rtol=1e-14)

    def test_rate(self):
        """A patch across the axis, and one around it, let in the mass per time that is given for the full turn."""
        one = np.ones(12 * 16)
        for engine in ("lattice", "CWENO3"):
            for patch in ("xLow", "yHigh"):
                with self.subTest(engine=engine, patch=patch):
                    case = self.case(f"rate{engine}{patch}", (12, 16, 1), one, [0 * one] * 3, one, 0.1, {**CAN, patch: "patch"},
                                     engine=engine, add="functions { books { type energyBudget; } }\n")
                    path = os.path.join(case, "0", "U")
                    with open(path) as f:
                        text = f.read().replace(f"{patch} {{ type zeroGradient; }}",
                                                f"{patch} {{ type flowRateInletVelocity; massFlowRate 0.5; }}")
                    with open(path, "w") as f:
                        f.write(text)
                    harness.program("granularGas", "-case", case)
                    budget = np.loadtxt(os.path.join(case, "postProcessing", "books", "0", "energyBudget.dat"))
                    self.assertAlmostEqual(budget[-1, 1] - np.pi, 0.5 * budget[-1, 0], delta=1e-12)
                    self.assertLess(abs(budget[-1, 4]), 1e-13)

    def test_weight(self):
        """Gas at rest under gravity along the axis stays so, to round-off: p of neighbours differs by half of both weights."""
        n, g = (16, 8, 1), 1.0
        x = boxes.centres(n, (1.0, 1.0, 0.1))[:, 0]
        p = [1.0]
        half = 0.5 * g / 16
        for _ in range(15):  # isothermal: p = rho
            p.append(p[-1] * (1 - half) / (1 + half))
        p = np.array(p)[np.rint(x * 16 - 0.5).astype(int)]
        result = self.run_case("weight", n, p, [0 * x, 0 * x, 0 * x], p, 0.5, gravity=(-g, 0.0, 0.0))
        self.assertLess(np.abs(result.field("U")).max(), 1e-14)

    def test_conserved(self):
        """A blast in a closed can keeps mass and energy of the full turn to round-off; the walls take all of the axial
        momentum."""
        functions = ("functions { sums { type volFieldValue; fields (rho); operation volIntegrate; } "
                     "books { type energyBudget; } }\n")
        for engine in ("lattice", "CWENO3"):
            with self.subTest(engine):
                x, rho, u, p = self.blast((12, 16, 1))
                result = self.run_case("blast" + engine, (12, 16, 1), rho, u, p, 0.4, engine=engine, add=functions)
                table = np.loadtxt(os.path.join(result.path, "postProcessing", "sums", "0", "volFieldValue.dat"))
                self.assertLess(np.ptp(table[:, 1]) / np.pi, 1e-14)
                self.assertAlmostEqual(table[0, 1], np.pi, delta=1e-13)
                budget = np.loadtxt(os.path.join(result.path, "postProcessing", "books", "0", "energyBudget.dat"))
                self.assertLess(np.abs(budget[:, [4, 12, 19]]).max(), 1e-14)  # residuals of mass, energy, axial momentum
                cells = 2 * np.pi * x[:, 1] / (12 * 16)
                self.assertAlmostEqual((result.field("rho") * cells).sum(), np.pi, delta=1e-12)

    def test_same(self):
        """1 and 3 ranks, a restart, and cells that are not skipped as uniform give the same bits; polyhedra rotate."""
        n = (40, 48, 1)
        x, rho, u, p = self.blast(n)
        for engine in ("lattice", "CWENO3"):
            with self.subTest(engine):
                options = {"engine": engine, "interval": 0.01, "control": "adjustableRunTime"}
                u = u if engine == "lattice" else [*u[:2], x[:, 1]]
                one = self.case("one" + engine, n, rho, u, p, 0.02, **options)
                harness.program("granularGas", "-case", one)
                three = self.case("three" + engine, n, rho, u, p, 0.02, **options)
                harness.program("granularGas", "-case", three, ranks=3)
                runs.same(self, runs.results(one), runs.results(three), "ranks")
                part = runs.until(one, os.path.join(self.folder, "part" + engine), 0.01)
                harness.program("granularGas", "-case", part)
                runs.same(self, runs.contents(os.path.join(one, "0.02")), runs.contents(os.path.join(part, "0.02")), "restart")
        full = self.case("full", n, rho, [*u[:2], 0 * rho], p, 0.02, interval=0.01)
        runs.add(full, "system/fvSolution", "skipUniform no;\n")
        harness.program("granularGas", "-case", full)
        runs.same(self, runs.results(os.path.join(self.folder, "onelattice")), runs.results(full), "skipped cells")

    @staticmethod
    def sound(x, t):
        """(rho - 1)/SMALL of the standing wave at places x."""
        return bessel(0, ROOT * x[:, 1]) * np.cos(2 * np.pi * x[:, 0]) * np.cos(np.hypot(ROOT, 2 * np.pi) * t)

    def errors(self, case, x, cells):
        """L1 errors of rho, over the amplitude: of all cells, beside the axis, and away from axis and wall."""
        harness.program("granularGas", "-case", case)
        result, r = harness.haff.Case(case), x[:, 1]
        error = np.abs((result.field("rho") - 1) / SMALL - self.sound(x, float(result.times[-1])))
        return np.array([error.mean(), error[r < 2 / cells].mean(), error[(r > 0.3) & (r < 0.6)].mean()])

    def wave(self, cells, engine):
        """The standing wave on boxes; engine triangles: on those, with CWENO3."""
        n, end = (cells // 2, cells, 1), 0.4
        steps = int(np.ceil(end * cells / 0.08))
        options = {"adjust": "no", "step": end / steps, "control": "runTime"}
        types = {"x": "cyclic", "yLow": "symmetryPlane", "yHigh": "wall"}
        if engine != "triangles":
            x = boxes.centres(n, (1.0, 1.0, 0.1))
            rho = 1 + SMALL * self.sound(x, 0)
            zero = np.zeros(len(rho))
            return self.errors(self.case(f"wave{engine}{cells}", n, rho, [zero] * 3, 1 / GAMMA + rho - 1, end, types, engine=engine,
                                         reconstruct="WENO5", **options), x, cells)
        case = os.path.join(self.folder, f"wave{cells}")
        triangles.make(case, 1.0, cells, os.path.join(os.environ["HAFF_BIN"], "gmshToCase"), cyclic="x",
                       patches="bottom { type symmetryPlane; } top { type wall; }")
        x = triangles.corners(harness.haff.Mesh(case + "/constant/polyMesh")).mean(axis=1)
        rho = 1 + SMALL * self.sound(x, 0)
        kinds = {"left": "cyclic", "right": "cyclic", "bottom": "symmetryPlane", "top": "wall", "back": "empty", "front": "empty"}
        boxes.write_case(case, kinds, rho, np.zeros((len(rho), 3)), 1 / GAMMA + rho - 1, end, eos="perfectGas", slip=["top"], **options)
        boxes.write_dictionary(case, "system", "meshDict", "axis { direction (1 0 0); }\n")
        runs.add(case, "system/fvSchemes", "polyReconstruct CWENO3;\n")
        return self.errors(case, x, cells)

    def test_order(self):
        """At least second order on lattices, and of CWENO3 on boxes and triangles as polyhedra, beside the axis and away from it."""
        for engine, least in (("lattice", 1.8), ("CWENO3", 1.9), ("triangles", 1.9)):
            with self.subTest(engine):
                cells = (16, 48) if engine == "triangles" else (16, 32)  # those of gmsh are not alike
                coarse, fine = (self.wave(n, engine) for n in cells)
                order = np.log(coarse / fine).min() / np.log(cells[1] / cells[0])
                self.assertGreater(order, least, f"errors {coarse} {fine}")

    def test_radial(self):
        """A lattice of radial cells gives what one of (axial, radial) cells gives that is the same all along."""
        cells = 40
        r = (np.arange(cells) + 0.5) / cells
        p, zero = np.where(r < 0.3, 10.0, 1.0), 0 * r
        line = self.run_case("line", (1, cells, 1), zero + 1, [zero, zero, zero], p, 0.1, {"yLow": "symmetryPlane", "yHigh": "wall"},
                             adjust="no", step=0.001)
        types = {"x": "cyclic", "yLow": "symmetryPlane", "yHigh": "wall"}
        wide = self.run_case("wide", (4, cells, 1), np.ones(4 * cells), [np.zeros(4 * cells)] * 3, np.repeat(p, 4), 0.1, types,
                             adjust="no", step=0.001)
        self.assertLess(np.abs(wide.field("rho").reshape(cells, 4) - line.field("rho")[:, None]).max(), 1e-13)

    def ball(self, cells, dim):
        """rho [z][r] of an octant with a hot ball at t = 0.15: about the axis, or in 3D beside the plane y = 0."""
        n = (cells, cells, 1) if dim == 2 else (cells,) * 3
        size = (1.0, 1.0, 0.1) if dim == 2 else (1.0, 1.0, 1.0)
        x = boxes.centres(n, size)
        zero, distance = 0 * x[:, 0], np.sqrt((x[:, :dim]**2).sum(axis=1))
        p = 1 + 4.5 * (1 - np.tanh((distance - 0.35) / 0.05))
        types = {a + side: "symmetryPlane" if side == "Low" else "wall" for a in "xyz"[:dim] for side in ("Low", "High")}
        case = self.case(f"ball{dim}{cells}", n, zero + 1, [zero] * 3, p, 0.15, types, size=size)
        if dim == 3:
            os.remove(os.path.join(case, "system", "meshDict"))
        harness.program("granularGas", "-case", case)
        rho = harness.haff.Case(case).field("rho").reshape(n[::-1])[0]  # 3D: z lowest; x is the axis, y the radius
        return rho.T

    def test_sphere(self):
        """A spherical blast of (axial, radial) cells is as good as one of as many cells a side in 3D, beside finer cells."""
        fine = self.ball(96, 2)

        def reference(z, r):
            i, k = (np.clip(q * 96 - 0.5, 0, 94.999).astype(int) for q in (z, r))
            a, b = z * 96 - 0.5 - i, r * 96 - 0.5 - k
            return (fine[i, k] * (1 - a) + fine[i + 1, k] * a) * (1 - b) + (fine[i, k + 1] * (1 - a) + fine[i + 1, k + 1] * a) * b

        errors, both = [], []
        for dim in (2, 3):
            both.append(self.ball(24, dim))
            x = (np.arange(24) + 0.5) / 24
            z, r = np.meshgrid(x, x, indexing="ij")
            away = np.sqrt(r**2 + (0 if dim == 2 else 0.5 / 24)**2)
            errors.append(np.abs(both[-1] - reference(z, away))[:20, :20].mean())
        self.assertLess(errors[0], 1.2 * errors[1], f"{errors}")
        self.assertLess(np.abs(both[0] - both[1])[:20, :20].mean(), errors[1])

    def rotation(self, cells, engine):
        """Rigid rotation in a pipe, p = 1 + r^2/2, after it has turned by 0.5 rad: change of the angular momentum, and L1 errors of rho, u_s."""
        n = (4, cells, 1)
        r, h = boxes.centres(n, (1.0, 1.0, 0.1))[:, 1], 1 / cells
        square = r**2 + h**2 / 4 * (engine != "lattice")  # means over r dr on polyhedra: of r^2, and of r
        mean = r + h**2 / (12 * r) * (engine != "lattice")
        p = 1 + square / 2 + (GAMMA - 1) / 2 * (square - mean**2)  # of a cell that has the energy of the rotation
        types = {"x": "cyclic", "yLow": "symmetryPlane", "yHigh": "wall"}
        result = self.run_case(f"swirl{engine}{cells}", n, np.ones(len(r)), [0 * r, 0 * r, mean], p, 0.5, types, engine=engine)
        weight = r * (r**2 + h**2 / 4) / mean
        rho, u = result.field("rho"), result.field("U")[:, 2]
        return (rho * u * weight).sum() / (mean * weight).sum() - 1, np.array([(np.abs(rho - 1) * r).mean(), (np.abs(u - mean) * r).mean()])

    def test_swirl(self):
        """Rigid rotation stays to second order, and keeps the angular momentum to round-off, on lattices and polyhedra."""
        for engine, least in (("lattice", 1.6), ("linear", 1.9), ("CWENO3", 1.9)):  # lattices mirror p at the wall
            with self.subTest(engine):
                (lost, coarse), (more, fine) = (self.rotation(cells, engine) for cells in (16, 32))
                self.assertLess(max(abs(lost), abs(more)), 1e-14)
                self.assertGreater(np.log2(coarse / fine).min(), least, f"errors {coarse} {fine}")

    def test_refused(self):
        """What cannot be: with file, line, cure."""
        x, rho, u, p = self.blast((8, 8, 1))
        rows = (("oblique", {"axis": "1 1 0"}, "lie along x, y or z"), ("across the plane", {"axis": "0 0 1"}, "in the plane of the mesh"),
                ("cyclic", {"types": {"x": "wall", "y": "cyclic"}}, "cyclic across the radius"),
                ("no symmetry plane", {"types": {**CAN, "yLow": "wall"}}, "type symmetryPlane"),
                ("line", {"axis": "0 1 0", "types": {"yLow": "symmetryPlane", "yHigh": "wall"}, "n": (1, 8, 1)}, "there is no radius"),
                ("solid", {"types": {a: "wall" for a in "xyz"}, "n": (2, 4, 8)}, "mesh half a section"),
                ("gravity", {"gravity": (0.0, -1.0, 0.0)}, "let it act along the axis"))
        for name, options, cure in rows:
            with self.subTest(name):
                n = options.pop("n", (8, 8, 1))
                cells = slice(int(np.prod(n)))
                self.refuses(self.case("no " + name, n, rho[cells], [part[cells] for part in u], p[cells], 0.1, **options), cure)
        for name, text, cure in (("across the axis", "origin (0 0.5 0);", "mesh the half"), ("below it", "origin (0 2 0);", "mirror it"),
                                 ("unknown key", "orign (0 0 0);", "'orign'")):
            with self.subTest(name):
                case = self.case("no " + name, (8, 8, 1), rho, u, p, 0.1)
                boxes.write_dictionary(case, "system", "meshDict", f"axis {{\n direction (1 0 0);\n {text}\n}}\n")
                self.refuses(case, cure)

    def refuses(self, case, cure):
        harness.refused(self, case, r"meshDict:\d+: ", cure)


if __name__ == "__main__":
    unittest.main()
