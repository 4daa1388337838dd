# SPDX-License-Identifier: GPL-3.0-or-later
"""The function objects forces and forceCoeffs, and the columns of momentum of energyBudget: what leaves the gas through patches is
what the state has lost, to round-off, by whatever way a step goes; against exact pressures, stresses and weights."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.gas import test_dense, test_limiter, test_uniformAxes
from tests.cases.harness import boxes
from tests.cases.polyhedral import test_acoustics

from studies.exact import disks, obliqueShock  # noqa: E402
from studies.exact.eos import PerfectGas, of_case  # noqa: E402
from studies.measured import shocks  # noqa: E402

CAUSES = ("Gravity", "Walls", "Flow", "Sources", "Floors")
BUDGET = "budget { type energyBudget; }\n"
WALLS = 'all { type forces; patches (".*"); CofR (0.1 0.2 0.3); }\n'
COEFFS = ("coeffs { type forceCoeffs; patches (yLow); CofR (0 0 0); magUInf 2; rhoInf 3; lRef 0.5; Aref 0.25; dragDir (0 2 0); "
          "liftDir (1 0 0); pitchAxis (0 0 1); pRef 10; }\n")


def ask(case, *functions):
    """Gives a case these function objects in place of its own."""
    path = os.path.join(case, "system", "controlDict")
    with open(path) as f:
        text = f.read().split("functions\n{")[0]
    with open(path, "w") as f:
        f.write(text + "functions\n{\n" + "".join(functions) + "}\n")
    return case


def columns(case, function, file, start="0"):
    """Title -> column of a table of scalars."""
    with open(os.path.join(case, "postProcessing", function, start, file)) as f:
        lines = f.read().splitlines()
    names = next(line for line in reversed(lines) if line.startswith("# Time"))[2:].split()
    return dict(zip(names, np.loadtxt(lines, ndmin=2).T))


def momentum(case):
    """Axis -> its columns of energyBudget, "" for the momentum itself; the times; the scale of momentum, sqrt(2 m E)."""
    table = columns(case, "budget", "energyBudget.dat")
    found = {axis: {name: table[f"momentum{name}_{axis}"] for name in ("", "Residual", *CAUSES)}
             for axis in "xyz" if f"momentum_{axis}" in table}
    return found, table["Time"], np.sqrt(2 * (table["mass"] * table["energy"]).max())


class Forces(harness.Folder, unittest.TestCase):
    gmsh, shear, layer = (getattr(test_acoustics.Acoustics, name) for name in ("gmsh", "shear", "layer"))
    bed, block = test_acoustics.Acoustics.bed, test_acoustics.Acoustics.block

    def shot(self, engine):
        """Lumps that fly apart in a gas on the density floor: steps are limited and repeated."""
        case = test_limiter.Limiter.shot(self, "shot" + engine, engine, 0.006, courant=1.0)
        runs.add(case, "system/fvSolution", "limits { alphaFloor 5e-9; }\n")
        return case

    def bubble(self, name, n, engine="lattice", **options):
        case = runs.make(os.path.join(self.folder, name + engine), n, 0.01, **options)
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        return case

    def shipped(self, name, cells, option="N", **control):
        case = harness.copy(name, self.folder)
        harness.mesh(case, cells, option)
        harness.edit(case, "system/controlDict", **control)
        return case

    def sinking(self, cls, end):
        """A bed of a shipped case, with implicit acoustics."""
        test = cls()
        test.folder = self.folder
        return test.make("implicit", end)

    def close(self, case, more=""):
        """Runs the case, with more function objects; returns its budget and its log."""
        log = harness.program("granularGas", "-case", ask(case, BUDGET, WALLS, more)).stdout
        found, times, scale = momentum(case)
        force = harness.haff.Case(case).table("all", "force.dat")
        np.testing.assert_array_equal(force[:, 0], times[1:])
        np.testing.assert_allclose(force[:, 1:4], force[:, 4:7] + force[:, 7:10], rtol=1e-14, atol=1e-14 * np.abs(force[:, 1:]).max())
        for axis, b in found.items():
            most = max(scale, *(np.abs(b[name]).max() for name in CAUSES))
            self.assertLess(np.abs(b["Residual"]).max(), 2e-14 * most, axis)
            self.assertLess(np.abs(b[""][0] + sum(b[name] for name in CAUSES) - b[""] - b["Residual"]).max(), 1e-14 * most)
            # times are written with 12 digits
            taken = np.cumsum(force[:, 1 + "xyz".index(axis)] * np.diff(times))
            self.assertLess(np.abs(taken + (b["Walls"] + b["Flow"])[1:]).max(), 1e-11 * most, axis)
        return found, log

    def test_any_step(self):
        """Both engines in one to three dimensions, with and without transport; a step in the corner."""
        for engine in ("lattice", "polyhedral"):
            for name, n, options in (("plane", (24, 18, 1), {}), ("line", (1, 30, 1), {}), ("solid", (8, 10, 6), {"viscous": True}),
                                     ("hole", (24, 18, 1), {"hole": True}), ("viscous", (20, 16, 1), {"viscous": True})):
                with self.subTest(engine=engine, name=name):
                    found, _ = self.close(self.bubble(name, n, engine, **options))
                    self.assertEqual(len(found), sum(k > 1 for k in n))
                    self.assertGreater(np.abs(found["y"]["Walls"]).max(), 1e-3 * np.abs(found["y"]["Gravity"]).max())

    @unittest.skipUnless(os.path.exists(os.path.join(harness.BIN, "haffimplicit.so")), "built without PETSc")
    def test_implicit_diffusion(self):
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                case = self.bubble("implicit", (20, 16, 1), engine, viscous=True)
                runs.add(case, "system/fvSolution", "diffusion { type implicit; }\n")
                self.close(case)

    def test_floors(self):
        """The density floor gives mass, and with it momentum; steps are limited and rejected."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                found, log = self.close(self.shot(engine))
                self.assertRegex(log, "limited: (.|\n)*rejected: ")
                self.assertGreater(np.abs(found["x"]["Floors"]).max(), 0)

    def test_sources(self):
        """Drag by a gas that moves, and a thermostat that heats so much that the first step is rejected, beside gravity."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                case = self.bubble("sources", (12, 10, 1), engine)
                runs.add(case, "constant/granularProperties", "sources (uniformHeating linearDrag); uniformHeatingCoeffs { rate 1e7; }\n"
                         "linearDragCoeffs { rate 30; velocity (1 2 0); }\n")
                found, log = self.close(case)
                self.assertIn("rejected:", log)
                for axis in "xy":
                    self.assertGreater(np.abs(found[axis]["Sources"]).max(), 0.01 * np.abs(found[axis]["Walls"]).max())

    def test_beds(self):
        """Implicit acoustics beside stages of the rest; on triangles gas that settledLayer lays has its own balance."""
        for make in (lambda: self.sinking(test_dense.Heap, 0.03), lambda: self.sinking(test_dense.SettlingColumn, 0.05),
                     lambda: self.block("block", end=0.6), lambda: self.bed("rest", "sheared", 0.2, "dense 0.6; gain 1;", T=5.0)):
            case = make()
            with self.subTest(os.path.basename(case)):
                found, log = self.close(case)
                self.assertIn("implicit acoustics", log)
                self.assertGreater(np.abs(found["y"]["Walls"]).max(), 0.1 * np.abs(found["y"]["Gravity"]).max())

    def test_open_patches(self):
        """Streams past bodies, on cyclic meshes, and a patch that gives mass in time."""
        for name, cells, control in (("cylinder", 8, {"endTime": 0.2}), ("wedge15", 15, {"endTime": 0.1}), ("wedgeTriangles", 16, {"endTime": 0.05}),
                                     ("pulsedInlet", 16, {})):
            with self.subTest(name):
                patches = "wall symmetry" if name == "cylinder" else "wall"
                body = "" if name == "pulsedInlet" else f"body {{ type forces; patches ({patches}); CofR (0 0 0); }}\n"
                case = self.shipped(name, cells, **control)
                found, _ = self.close(case, body)
                self.assertGreater(np.abs(found["x"]["Flow"]).max(), 0)
                if body:  # drag and lift are what the walls have taken
                    force, dt = harness.haff.Case(case).table("body", "force.dat"), np.diff(columns(case, "budget", "energyBudget.dat")["Time"])
                    for k, axis in enumerate("xy", 1):
                        walls = found[axis]["Walls"][1:]
                        np.testing.assert_allclose(np.cumsum(force[:, k] * dt), -walls, atol=1e-11 * np.abs(walls).max(), rtol=0)

    def test_shaken(self):
        """Cells that fall freely, cooling, transport, shaking."""
        found, _ = self.close(self.shipped("faraday", 8, "L", endTime=0.04))
        self.assertGreater(np.abs(found["y"]["Gravity"]).max(), 0)

    def test_uniform_axes(self):
        """Cells that stand for many, components beyond the mesh: the table and its bits are those of a run of all cells."""
        names = {}
        for skip in ("yes", "no"):
            case = test_uniformAxes.UniformAxes.make(self, "uniform" + skip, fast=True)
            runs.add(case, "system/fvSolution", f"skipUniformAxes {skip};\n")
            found, log = self.close(case)
            self.assertEqual("uniform along" in log, skip == "yes")
            self.assertIn("limited:", log)
            self.assertEqual(sorted(found), ["x", "y", "z"])
            names[skip] = runs.contents(os.path.join(case, "postProcessing", "all"))
        runs.same(self, names["yes"], names["no"])

    def test_bits_of_the_gas(self):
        """They are those of a run without, also where uniform cells are left out."""
        for engine in ("lattice", "polyhedral"):
            for viscous in (False, True):
                fields = []
                for functions in ((), (WALLS, COEFFS)):
                    case = ask(self.bubble(f"bits{viscous}{len(functions)}", (40, 40, 1), engine, viscous=viscous), *functions)
                    harness.program("granularGas", "-case", case)
                    fields.append({k: v for k, v in runs.results(case).items() if not k.startswith("postProcessing")})
                runs.same(self, *fields)

    def test_ranks_and_restart(self):
        """The same rows on two ranks, and after a restart; one row a step, none at the start."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                case = ask(self.bubble("whole", (24, 18, 1), engine, viscous=True, interval=0.005), WALLS, COEFFS)
                pair, again = case + "_2", case + "_again"
                shutil.copytree(case, pair)
                harness.program("granularGas", "-case", case)
                harness.program("granularGas", "-case", pair, ranks=2)
                runs.same(self, runs.results(case), runs.results(pair))
                runs.until(case, again, 0.005)
                harness.program("granularGas", "-case", again)
                for function, file in (("all", "force.dat"), ("all", "moment.dat"), ("coeffs", "coefficient.dat")):
                    whole, rest = (harness.haff.Case(c).table(function, file) for c in (case, again))
                    self.assertGreater(len(rest), 2)
                    np.testing.assert_array_equal(whole[whole[:, 0] > 0.005], rest)

    def test_moments_and_coefficients(self):
        """A moment about another point differs by its lever; coefficients are forces and moments by their own axes."""
        one = 'one { type forces; patches (yLow); CofR (0 0 0); pRef 10; }\n'
        two = 'two { type forces; patches ("y.*"); CofR (1 -2 3); }\nlow { type forces; patches (yLow); CofR (0 0 0); }\n'
        high = 'high { type forces; patches (yHigh); CofR (0 0 0); }\n'
        case = ask(self.bubble("moments", (10, 8, 6), viscous=True), one, two, high, COEFFS)
        harness.program("granularGas", "-case", case)
        table = {name: [harness.haff.Case(case).table(name, file)[:, 1:] for file in ("force.dat", "moment.dat")]
                 for name in ("one", "two", "low", "high")}
        for i in range(3):  # total, pressure, viscous
            part = slice(3 * i, 3 * i + 3)
            force, moment = (table["low"][k][:, part] + table["high"][k][:, part] for k in (0, 1))
            np.testing.assert_allclose(table["two"][0][:, part], force, rtol=1e-12)
            np.testing.assert_allclose(table["two"][1][:, part], moment - np.cross((1, -2, 3), force), rtol=1e-12, atol=1e-10 * np.abs(moment).max())
        force, moment = (table["one"][k][:, :3] for k in (0, 1))
        low, area = table["low"][0][:, :3], 1.0 * 0.6
        np.testing.assert_allclose(force, low + (0, 10 * area, 0), rtol=1e-13)
        c = columns(case, "coeffs", "coefficient.dat")
        per = 1 / (0.5 * 3 * 2**2 * 0.25)
        frame = {"d": (0, 1, 0), "s": (0, 0, 1), "l": (1, 0, 0)}  # drag, side = lift x drag, lift
        for name, turn in (("d", "Roll"), ("s", "Pitch"), ("l", "Yaw")):
            np.testing.assert_allclose(c["C" + name], per * force @ frame[name], rtol=1e-13)
            np.testing.assert_allclose(c["Cm" + turn], per / 0.5 * moment @ frame[name], rtol=1e-12)
        for name, turn in (("Cd", "Roll"), ("Cs", "Yaw"), ("Cl", "Pitch")):
            np.testing.assert_allclose(c[name + "(f)"], 0.5 * c[name] + c["Cm" + turn], rtol=1e-12)
            np.testing.assert_allclose(c[name + "(r)"], 0.5 * c[name] - c["Cm" + turn], rtol=1e-12)

    def ramp(self, cells, engine):
        """A perfect gas flows at Mach 4 and 15 degrees onto a floor. Returns the force on it over the exact one."""
        theta, n, size = np.radians(15), (2 * cells, cells, 1), (1.0, 0.5, 0.1)
        stream = obliqueShock.ObliqueShock(PerfectGas(), 1.0, 0.6, 4.0)
        u = stream.speed * np.array([np.cos(theta), -np.sin(theta), 0])
        values = {"rho": np.full(2 * cells**2, 1.0), "p": np.full(2 * cells**2, 0.6), "U": np.tile(u, (2 * cells**2, 1))}
        case = harness.box_case(os.path.join(self.folder, f"ramp{engine}{cells}"), n, size, values["rho"], values["U"], values["p"], 2.0,
                                e=1.0, cooling="none", eos="perfectGas")
        for name, uniform in (("rho", "1"), ("p", "0.6"), ("U", "(%.17g %.17g 0)" % tuple(u[:2]))):
            boxes.write_field(case, name, values[name], f'"(xLow|yHigh)" fixedValue; value uniform {uniform}\nxHigh zeroGradient\n'
                              f'yLow {"slip" if name == "U" else "zeroGradient"}\nzEmpty empty')
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        harness.program("granularGas", "-case", ask(case, "floor { type forces; patches (yLow); CofR (0 0 0); }\n"))
        force = harness.haff.Case(case).table("floor", "force.dat")[-1]
        np.testing.assert_array_equal(force[[1, 3, 7, 8, 9]], 0)
        return force[2] / (-0.1 * stream.behind(stream.angle(theta)).p)

    def test_oblique_shock(self):
        """The exact pressure behind it; the error is that of the tip of the shock, of first order."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                error = np.abs([self.ramp(cells, engine) - 1 for cells in (10, 20)])
                self.assertLess(error[0], 4e-3)
                self.assertLess(error[1], error[0] / 1.8)

    def test_wedge(self):
        """The shipped wedge in an elastic dense gas, on triangles: the flat wall ahead of it and the ramp."""
        case = ask(self.shipped("wedge15", 15), "wedge { type forces; patches (wall); CofR (0 0 0); }\n")
        result = harness.run(case)
        stream = shocks.upstream(result, of_case(result), result.times[-1])
        p = stream.behind(stream.angle(shocks.WEDGE)).p
        exact = np.ptp(result.mesh.points[:, 2]) * np.array([10 * p * np.tan(shocks.WEDGE), -10 * p - stream.p])
        np.testing.assert_allclose(result.table("wedge", "force.dat")[-1, 1:3], exact, rtol=1e-3)

    def test_couette(self):
        """The stress that the reference says, of second order; on both walls, and by both engines."""
        for engine in ("lattice", "polyhedral"):
            errors = []
            for cells in (8, 16):
                case = self.shipped("couetteDisks", cells, maxCo=0.4)
                runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
                ask(case, *(f"{name} {{ type forces; patches ({name}); CofR (0 0 0); }}\n" for name in ("lid", "floor")))
                result = harness.run(case)
                lid, floor = (result.table(name, "force.dat")[-1] for name in ("lid", "floor"))
                np.testing.assert_allclose(lid[7], -floor[7], rtol=1e-4)
                self.assertEqual(lid[4], 0)
                stress = disks.couette(case).solution.sol(10)[4] * result.volumes.sum() / 20
                errors.append(abs(lid[7] / -stress - 1))
            with self.subTest(engine):
                self.assertLess(errors[1], 1e-3)
                self.assertLess(errors[1], errors[0] / 3.4)

    def test_poiseuille(self):
        """Both walls together carry what gravity pulls along them."""
        case = ask(self.shipped("poiseuilleDisks", 16), 'walls { type forces; patches ("(lid|floor)"); CofR (0 0 0); }\n')
        result = harness.run(case)
        pull = 0.1 * result.field("rho") @ result.volumes
        force = result.table("walls", "force.dat")[-1]
        self.assertAlmostEqual(force[7], pull, delta=1e-5 * pull)

    def weight(self, mesh, n):
        """A settled layer: the force on floor and lid, and its moment about the origin, over those of its weight at half the box."""
        functions = 'walls { type forces; patches ("y.*"); CofR (0 0 0); }\n'
        case = ask(self.layer(f"weight{mesh}{n[0]}", mesh, "linear", steps=5, dt=5e-4, n=n), functions)
        result = harness.run(case)
        with open(os.path.join(case, "constant", "g")) as f:
            g = float(f.read().split("(")[-1].split()[1])
        weight = g * result.field("rho") @ result.volumes
        return result.table("walls", "force.dat")[:, 2] / weight, result.table("walls", "moment.dat")[:, 3] / (4.0 * weight)

    def test_weight(self):
        """It stands on its floor: to round-off on a lattice, of second order where cells do not lie in layers."""
        for ratio in self.weight("lattice", (16, 20, 1)):
            np.testing.assert_allclose(ratio, 1, rtol=1e-12)
        coarse, fine = (np.abs(np.array(self.weight("sheared", n))[:, -1] - 1) for n in ((8, 10, 1), (16, 20, 1)))
        self.assertLess(coarse.max(), 2e-3)
        self.assertLess((fine / coarse).max(), 0.35)

    def test_heading(self):
        """The files are those of OpenFOAM."""
        case = ask(self.bubble("heading", (6, 6, 1)), WALLS)
        harness.program("granularGas", "-case", case)
        for file, title in (("force.dat", "Force"), ("moment.dat", "Moment")):
            with open(os.path.join(case, "postProcessing", "all", "0", file)) as f:
                lines = f.read().splitlines()
            self.assertEqual(lines[0], "# " + title)
            self.assertEqual(lines[1], "# CofR        : (0.1 0.2 0.3)")
            self.assertEqual(lines[2], "# thickness   : 0.1")  # that of boxes in a plane
            self.assertEqual(lines[3].split(), "# Time (total_x total_y total_z) (pressure_x pressure_y pressure_z) (viscous_x viscous_y "
                             "viscous_z)".split())


if __name__ == "__main__":
    unittest.main()
