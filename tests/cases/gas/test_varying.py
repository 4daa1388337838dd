# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches whose values follow a rule, through the whole program: waves that enter, against the exact solution; mass that is given;
all forms over restarts, ranks, both mesh engines and the tools of others; what is skipped; values that go wrong on the way."""
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes

POLYHEDRAL = "meshEngine polyhedral; polyReconstruct {};\n"
SPEED, PRESSURE = 30.0, 900.0  # of a supersonic stream


def read(path):
    with open(path) as f:
        return f.read()


def cells(case, name, time=None):
    """What a field file says of the cells: its text up to the patches."""
    text = read(os.path.join(case, time or runs.times(case)[-1], name))
    return text[:text.index("boundaryField")]


class Waves(harness.Folder, unittest.TestCase):
    def wave(self, n, engine="", **options):
        """A wave of density in a stream that enters at x = 0; returns the mean and the largest error after it has crossed."""
        size, u, end = (1.0, 0.1, 0.1), SPEED, 1.3 / SPEED
        x, h, one = boxes.centres((n, 1, 1), size)[:, 0], 1.0 / n, np.ones(n)
        smooth = np.sinc(h) if engine else 1.0  # lattices hold values at centres, polyhedra averages

        def exact(t):
            return 100 * (1 + 0.3 * smooth * np.sin(2 * np.pi * (t * u - x)))
        case = harness.box_case(os.path.join(self.folder, f"wave{n}{len(os.listdir(self.folder))}"), (n, 1, 1), size, exact(0),
                                np.outer(one, (u, 0, 0)), PRESSURE * one, end, **options)
        rest = "\nxHigh zeroGradient\nyEmpty empty\nzEmpty empty"
        text = f'"100*(1 + 0.3*sin(2*pi*({u!r}*t - x)))"'
        boxes.write_field(case, "rho", exact(0), f"xLow fixedValue; value uniform 100; expression {text}" + rest)
        boxes.write_field(case, "U", np.outer(one, (u, 0, 0)), f"xLow fixedValue; value uniform ({u!r} 0 0)" + rest)
        boxes.write_field(case, "p", PRESSURE * one, f"xLow fixedValue; value uniform {PRESSURE!r}" + rest)
        if engine:
            runs.add(case, "system/fvSchemes", engine)
        harness.program("granularGas", "-case", case)
        error = np.abs(harness.haff.Case(case).field("rho") - exact(end))[x < 0.9] / 100  # the outlet has errors of its own
        return error.mean(), error.max()

    def test_order(self):
        """Second order in the mean and at the inlet, down to fine grids; with CWENO3 third order in the mean."""
        for least, most, engine, options in ((1.9, 5.3e-6, "", dict(reconstruct="WENO5")),
                                             (1.85, 5.9e-6, "", dict(reconstruct="WPENO5", stepper="SSPRK43", courant=1.0)),
                                             (2.9, 6.3e-7, POLYHEDRAL.format("CWENO3"), {}),
                                             (1.9, 1.7e-5, POLYHEDRAL.format("linear"), {})):
            with self.subTest(engine=engine, **options):
                errors = np.array([self.wave(n, engine, **options) for n in (200, 400)])
                order = np.log2(errors[0] / errors[1])
                self.assertGreater(order[0], least, errors)
                self.assertGreater(order[1], 1.85, errors)
                self.assertLess(errors[1, 0], most)  # 1.3 times the error measured

    def late(self, stepper, step):
        """rho at a time, by constant steps, of a stream whose density and pressure change as it enters."""
        n, size = 40, (1.0, 0.1, 0.1)
        one = np.ones(n)
        courant = {"SSPRK3": 1.0, "SSPRK43": 2.0, "SSPRK104": 3.0}[stepper]
        flux = "common; commonCoeffs { smooth no; }"  # steps must not change the scheme of a face
        case = harness.box_case(os.path.join(self.folder, f"{stepper}{step}"), (n, 1, 1), size, 100 * one,
                                np.outer(one, (SPEED, 0, 0)), PRESSURE * one, 0.016, reconstruct="WENO5", stepper=stepper, flux=flux,
                                courant=courant, adjust="no", step=step)
        rest = "\nxHigh zeroGradient\nyEmpty empty\nzEmpty empty"
        for name, value in (("rho", 100.0), ("p", PRESSURE)):
            boxes.write_field(case, name, value * one, f'xLow fixedValue; value uniform 1; expression "{value}*(1 + '
                              f'0.2*sin(200*t)^4)"' + rest)
        boxes.write_field(case, "U", np.outer(one, (SPEED, 0, 0)), f"xLow fixedValue; value uniform ({SPEED} 0 0)" + rest)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case).field("rho")

    def test_order_in_time(self):
        """Values at the times of the stages: the steppers of third order keep it in the mean, with the cells as they are."""
        exact = self.late("SSPRK104", 1.25e-5)
        for stepper in ("SSPRK3", "SSPRK43"):
            with self.subTest(stepper):
                error = [np.abs(self.late(stepper, step) - exact).mean() for step in (1e-4, 5e-5)]
                self.assertGreater(np.log2(error[0] / error[1]), 2.85)


class Pulses(harness.Folder, unittest.TestCase):
    def test_expected(self):
        """The shipped case on coarser grids."""
        for cells in (160, 320):
            with self.subTest(cells):
                self.compare(self.short("pulsedInlet", cells), harness.entries("pulsedInlet", cells=cells))


class Mass(harness.Folder, unittest.TestCase):
    def inflow(self, name, rate, engine="", end=0.2, ranks=1, rho=50.0, **options):
        n, size = (24, 8, 1), (1.2, 0.4, 0.1)
        one = np.ones(np.prod(n))
        case = harness.box_case(os.path.join(self.folder, name), n, size, rho * one, np.outer(one, (0, 0, 0)), one, end, **options)
        os.remove(case + "/0/p")
        for field, value, inlet, wall in (("rho", rho * one, "zeroGradient", "zeroGradient"),
                                          ("T", 10 * one, "fixedValue; value uniform 12", "zeroGradient"),
                                          ("U", np.outer(one, (0, 0, 0)), f"flowRateInletVelocity; {rate}; value uniform (0 0 0)", "slip")):
            boxes.write_field(case, field, value, f'xLow {inlet}\n"(xHigh|y.*)" {wall}\nzEmpty empty')
        runs.add(case, "system/fvSchemes", engine)
        runs.add(case, "system/controlDict", "functions { mass { type volFieldValue; fields (rho); operation volIntegrate; "
                 "writeControl timeStep; writeInterval 1; } }\n")
        harness.program("granularGas", "-case", case, ranks=ranks)
        return case, np.loadtxt(case + "/postProcessing/mass/0/volFieldValue.dat")

    def grown(self, table, given):
        """The mass has grown by what was given: at the end to round-off, before to the 12 digits that tables have of times."""
        gained = table[:, 1] - table[0, 1]
        self.assertLess(abs(gained[-1] - given[-1]), len(table) * 2e-16 * table[-1, 1])
        np.testing.assert_allclose(gained, given, rtol=1e-11, atol=len(table) * 2e-16 * table[-1, 1])

    def test_budget(self):
        """The mass grows by the rate times t at every step, to round-off of the sum, on both engines, into dense gas and thin;
        on two ranks with the same bits."""
        for engine, rho in (("", 50.0), ("", 1e-3), (POLYHEDRAL.format("CWENO3"), 50.0)):
            with self.subTest(engine=engine, rho=rho):
                name = f"steady{len(engine)}{rho}"
                case, table = self.inflow(name, "massFlowRate 0.6", engine, 0.2 if rho > 1 else 0.002, rho=rho)
                given = 0.6 * table[:, 0]
                self.assertGreater(len(table), 20)
                self.grown(table, given)
                if rho > 1:
                    other, _ = self.inflow(name + "ranks", "massFlowRate 0.6", engine, ranks=2)
                    runs.same(self, runs.results(case), runs.results(other))

    def test_table(self):
        """A rate linear in time, and one in pulses, shorter than a step: the integral is exact, as steps end at the knots."""
        _, table = self.inflow("ramp", "massFlowRate table ((0 0) (1 6))")
        self.grown(table, 3 * table[:, 0]**2)
        knots = np.array([(0, 0.2), (0.05, 0.2), (0.0501, 3), (0.07, 3), (0.0701, 0), (0.12, 0), (0.1501, 1), (1, 1)])
        _, table = self.inflow("pulses", "massFlowRate table (%s)" % " ".join("(%.17g %.17g)" % tuple(k) for k in knots))
        fine = np.sort(np.concatenate([table[:, 0], knots[knots[:, 0] < table[-1, 0], 0]]))
        rate = np.interp(fine, *knots.T)
        given = np.concatenate([[0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(fine))])
        self.grown(table, np.interp(table[:, 0], fine, given))
        self.assertLessEqual(np.abs(table[:, 0] - knots[1:-1, :1]).min(axis=1).max(), 1e-12)


class Forms(harness.Folder, unittest.TestCase):
    """Every form at once, in a box of spheres with transport between two walls, or with a given mass."""

    def case(self, name, engine="", mass=False, end=0.02, **options):
        n, size = (12, 8, 1), (1.2, 0.8, 0.1)
        one = np.ones(np.prod(n))
        case = harness.box_case(os.path.join(self.folder, name), n, size, 100 * one, np.outer(one, (1, 0, 0)), one, end,
                                types={"y": "wall"}, interval=0.01, format="ascii", digits=6, **runs.SPHERES, **options)
        runs.conduct(case)
        os.remove(case + "/0/p")
        rho = ['xLow fixedValue; value uniform 100; expression "100 + 20*sin(300*t)*y"',
               "xHigh uniformInletOutlet; uniformInletValue table ((0 50) (0.01 60)); value uniform 50", '"y.*" zeroGradient']
        heat = ["xLow uniformFixedValue; uniformValue table ((0 1) (0.01 2) (0.03 1)); value uniform 1",
                'xHigh inletOutlet; inletValue uniform 1; expression "1 + t"; value uniform 1',
                'yLow exprFixedValue; valueExpr "1 + 0.5*sqr(sin(100*time()))*pos().x()"; value uniform 1',
                "yHigh uniformFixedValue; uniformValue constant 1; value uniform 1"]
        flow = ['xLow exprFixedValue; valueExpr "(1 + 0.1*sin(9*time()))*vector(1, 0, 0)"; value uniform (1 0 0)',
                "xHigh zeroGradient", "yLow translatingWallVelocity; U table ((0 (0 0 0)) (1 (10 0 0))); value uniform (0 0 0)",
                'yHigh translatingWallVelocity; U (0 0 0); expression ("sin(100*t)*x" "0" "0"); value uniform (0 0 0)']
        if mass:
            flow[0] = "xLow flowRateInletVelocity; massFlowRate table ((0 8) (1 90)); rho rho; value uniform (0 0 0)"
        for field, values, rules in (("rho", 100 * one, rho), ("T", one, heat), ("U", np.outer(one, (1, 0, 0)), flow)):
            boxes.write_field(case, field, values, "\n".join(rules + ["zEmpty empty"]))
        runs.add(case, "system/fvSchemes", "divSchemes { } gradSchemes { } laplacianSchemes { }\n" + engine)
        return case

    def test_restart_and_ranks(self):
        """Stopped and taken up again, every form and either engine once on two ranks first: the bytes of a run that goes through, patches too."""
        for engine in ("", POLYHEDRAL.format("CWENO3")):
            for mass in (False, True):
                with self.subTest(engine=engine, mass=mass):
                    name = f"{len(engine)}{mass}"
                    through, part = self.case("through" + name, engine, mass), self.case("part" + name, engine, mass, end=0.01)
                    harness.program("granularGas", "-case", through)
                    harness.program("granularGas", "-case", part, ranks=1 + (mass == bool(engine)))
                    harness.edit(part, "system/controlDict", endTime=0.02)
                    harness.program("granularGas", "-case", part)
                    for time in ("0.01", "0.02"):
                        runs.same(self, runs.contents(os.path.join(through, time)), runs.contents(os.path.join(part, time)))
                    self.assertRegex(read(through + "/0.02/T"), r"type +uniformFixedValue;\s+uniformValue +table \(\(0 1\) \(0\.01\d* "
                                     r"2\) \(0\.0\d+ 1\)\);\s+value +uniform 1\.5;")
                    self.assertRegex(read(through + "/0.02/rho"), r'value +nonuniform[^;]*;\s+expression +"100 \+ 20\*sin\(300\*t\)\*y";')
                    self.assertRegex(read(through + "/0.02/U"), r'expression +\("sin\(100\*t\)\*x" "0" "0"\);')

    @unittest.skipUnless(shutil.which("foamToVTK"), "OpenFOAM is not installed")
    def test_tools(self):
        """OpenFOAM's tools and the readers of ParaView pass over every form, as given and as written, whole and in parts."""
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        for mass in (False, True):
            case = self.case(f"tools{mass}", mass=mass)
            runs.add(case, "system/controlDict", "writeProcessors yes;\n")
            boxes.write_dictionary(case, "system", "decomposeParDict", "numberOfSubdomains 2; method simple; "
                                   "simpleCoeffs { n (2 1 1); delta 0.001; }\n")
            harness.program("granularGas", "-case", case, ranks=2)
            fields = {name: harness.haff.Case(case).field(name) for name in ("rho", "U", "T")}
            self.openfoam(case, "foamToVTK")
            self.openfoam(case, "reconstructPar", "-latestTime")
            for name, values in fields.items():
                np.testing.assert_allclose(harness.haff.Case(case).field(name), values, rtol=1e-5, atol=1e-5)  # its six digits
            self.openfoam(case, "decomposePar", "-force", "-time", "0,0.02")
            open(case + "/case.foam", "w").close()
            for reader in (vtk.vtkOpenFOAMReader(), vtk.vtkPOpenFOAMReader()):
                reader.SetFileName(case + "/case.foam")
                reader.UpdateInformation()
                reader.SetTimeValue(0.02)
                reader.EnableAllCellArrays()
                reader.EnableAllPatchArrays()
                reader.Update()
                data = reader.GetOutput().GetBlock(0).GetCellData()
                for name, values in fields.items():
                    np.testing.assert_allclose(vtk_to_numpy(data.GetArray(name)), values, rtol=1e-5, atol=1e-5)
            harness.program("caseToVTK", case, "-time", "0.02", "-fields", "U,T")

    def openfoam(self, case, name, *arguments):
        done = subprocess.run([name, "-case", case, *arguments], capture_output=True, text=True, cwd=case,
                              env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
        self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])


class Streams(harness.Folder, unittest.TestCase):
    def stream(self, name, rules, end=0.02, types=None, n=(24, 12, 1), **options):
        """A stream into a box of uniform gas; rules of the inlet by field."""
        size = tuple(0.1 * k for k in n)
        one = np.ones(np.prod(n))
        case = harness.box_case(os.path.join(self.folder, name), n, size, 100 * one, np.outer(one, (30, 0, 0)), 900 * one, end,
                                types=types, **options)
        sides = "\nxHigh zeroGradient\nzEmpty empty\n" + ('"y.*" cyclic' if types else '"y.*" zeroGradient')
        given = {"rho": "fixedValue; value uniform 100", "U": "fixedValue; value uniform (30 0 0)",
                 "p": "fixedValue; value uniform 900", **rules}
        for field, values in (("rho", 100 * one), ("U", np.outer(one, (30, 0, 0))), ("p", 900 * one)):
            boxes.write_field(case, field, values, f"xLow {given[field]}" + sides)
        return case

    def result(self, case, **options):
        done = harness.program("granularGas", "-case", case, **options)
        return done.stdout, {f: harness.haff.Case(case).field(f) for f in ("rho", "U", "p")}

    def same(self, a, b):
        for field in a:
            np.testing.assert_array_equal(a[field], b[field], err_msg=field)

    def test_constants(self):
        """The same values in any form are the same bits; so is a profile by expression as by a list."""
        y = (np.arange(12) + 0.5) * 0.1
        profile = " ".join("(%.17g 0 0)" % (30 + v) for v in y)
        plain = {"rho": "fixedValue; value uniform 90", "U": f"fixedValue; value nonuniform List<vector> 12 ({profile})",
                 "p": "fixedValue; value uniform 800"}
        forms = {"rho": "uniformFixedValue; uniformValue 90", "U": 'exprFixedValue; valueExpr "vector(30 + pos().y(), 0, 0)"',
                 "p": 'fixedValue; value uniform 1; expression "800"'}
        tables = {"rho": "uniformInletOutlet; uniformInletValue table ((0 90))",
                  "U": 'fixedValue; value uniform (0 0 0); expression ("30 + y" "0" "0")', "p": 'exprFixedValue; valueExpr "800"'}
        known = self.result(self.stream("plain", plain))[1]
        for name, rules in (("forms", forms), ("tables", tables)):
            with self.subTest(name):
                found = self.result(self.stream(name, rules))[1]
                for field in known:  # centres of faces are round-off away from these
                    np.testing.assert_allclose(found[field], known[field], rtol=1e-13, atol=1e-13)

    def test_clamped(self):
        """A table is linear in between and constant outside, as `clamp`, the default of OpenFOAM."""
        for table, text in (("table ((0.005 90) (0.01 110))", "t < 0.005 ? 90 : t > 0.01 ? 110 : 90 + (t - 0.005)/0.005*20"),):
            steps = {"adjust": "no", "step": 2e-4}  # of one length, as else they would end at the knots
            a = self.result(self.stream("table", {"rho": f"uniformFixedValue; uniformValue {table}"}, **steps))[1]
            b = self.result(self.stream("text", {"rho": f'fixedValue; value uniform 1; expression "{text}"'}, **steps))[1]
            for field in a:
                np.testing.assert_allclose(a[field], b[field], rtol=1e-12, atol=1e-12)
        self.assertGreater(np.ptp(a["rho"]), 10)

    def test_uniform_cells_are_skipped(self):
        """A pulse into uniform gas: cells that it has not reached are left out, with the same bits."""
        pulse = {"rho": 'exprFixedValue; valueExpr "100 + 5*max(0, sin(300*time()))"'}
        results = []
        for skip in ("yes", "no"):
            case = self.stream("skip" + skip, pulse)
            runs.add(case, "system/fvSolution", f"skipUniform {skip};\n")
            results.append(self.result(case))
        self.same(results[0][1], results[1][1])
        self.assertRegex(results[0][0], r"[1-9]\d(\.\d+)? % of the cell updates were computed")
        self.assertGreater(np.ptp(results[0][1]["rho"]), 2)

    def test_given_mass_is_skipped(self):
        """The same with a given mass: beside the patch nothing is left out."""
        results = []
        for skip in ("yes", "no"):
            case = self.stream("fed" + skip, {"U": "flowRateInletVelocity; massFlowRate 361"})
            runs.add(case, "system/fvSolution", f"skipUniform {skip};\n")
            results.append(self.result(case))
        self.same(results[0][1], results[1][1])

    def test_uniform_axes(self):
        """Periodic along y, with an inlet that changes in time: one layer is computed. Where it changes along y, though not
        at the start, all is computed."""
        for text, along in (("100 + 9*sin(300*t)", True), ("100 + 9*sin(300*t*y)", False)):
            results = []
            for skip in ("yes", "no"):
                case = self.stream(f"axes{along}{skip}", {"rho": f'fixedValue; value uniform 1; expression "{text}"'}, types={"y": "cyclic"})
                runs.add(case, "system/fvSolution", f"skipUniformAxes {skip};\n")
                results.append(self.result(case))
            self.same(results[0][1], results[1][1])
            self.assertEqual("uniform along y" in results[0][0], along, results[0][0])
            self.assertGreater(np.ptp(results[0][1]["rho"]), 5)

    def test_values_that_go_wrong(self):
        """The run ends with the file, the line, the patch, the face and the time, and keeps the last good state."""
        for text, says in (("100 - 2e4*t", "gives -"), ("100/(t < 0.01)", "lie between"), ("100 + 1e6*t", "alphaMax")):
            case = self.stream(f"wrong{says.split()[-1]}{len(text)}", {"rho": f'fixedValue; value uniform 1; expression "{text}"'})
            done = harness.program("granularGas", "-case", case, check=False)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertRegex(done.stderr, r"0/rho:\d+: patch xLow: expression gives .* at the face at \(0 0\.05 0\.05\), t = 0\.0\d+; it must")
            self.assertIn(says, done.stderr)
            self.assertEqual(len(runs.times(case)), 2, "the last good state is written")

    def test_beds(self):
        """Dense gas with implicit acoustics behind an inlet that changes in time: a stop and other ranks change no bit."""
        results = []
        for name, end, ranks in (("through", 0.2, 1), ("part", 0.1, 2)):
            n, size = (24, 16, 1), (6.0, 4.0, 0.25)
            at = boxes.centres(n, size)
            rho = np.where(at[:, 1] < 2, 0.6, 1e-3) / (np.pi / 6 * 0.1**3)
            case = harness.box_case(os.path.join(self.folder, "bed" + name), n, size, rho, 0 * at, 1e-3 * rho, end,
                                    eos="TorquatoSpheres", e=0.9, cooling="Haff", gravity=(0.0, -10.0, 0.0), interval=0.1)
            os.remove(case + "/0/p")
            with open(case + "/constant/granularProperties") as f:
                text = f.read()
            with open(case + "/constant/granularProperties", "w") as f:
                f.write(text.replace("grain {", "grain { thresholdSpeed 0.03;"))
            inlet = 'inletOutlet; inletValue uniform 1; expression "%s"'
            for field, value, rule, wall in (("rho", rho, inlet % "(y < 2 ? 1000 : 2)*(1 + 0.1*sin(20*t)^2)", "zeroGradient"),
                                             ("T", 1e-3 + 0 * rho, inlet % "0.01*(1 + t)", "zeroGradient"),
                                             ("U", 0 * at, 'exprFixedValue; valueExpr "vector(0.2*sin(30*time()), 0, 0)"', "slip")):
                boxes.write_field(case, field, value, f'xLow {rule}\n"(xHigh|y.*)" {wall}\nzEmpty empty')
            runs.add(case, "system/fvSolution", "acoustics { type implicit; }\n")
            results.append((case, harness.program("granularGas", "-case", case, ranks=ranks).stdout))
        self.assertIn("implicit acoustics", results[0][1])
        harness.edit(case, "system/controlDict", endTime=0.2)
        harness.program("granularGas", "-case", case)
        runs.same(self, runs.contents(results[0][0] + "/0.2"), runs.contents(case + "/0.2"))

    def test_checks(self):
        """checkCase names what changes."""
        case = self.stream("named", {"rho": 'fixedValue; value uniform 1; expression "100 + t*y"'})
        self.assertIn("rho changes in time and from face to face (expression)", harness.program("checkCase", case).stdout)


if __name__ == "__main__":
    unittest.main()
