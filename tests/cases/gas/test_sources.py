# SPDX-License-Identifier: GPL-3.0-or-later
"""Sources by name, `sources (..)` of constant/granularProperties: a uniform gas follows their equations on both engines, the
budget books each under its own cause, mistakes are refused."""
import os
import shutil
import unittest

import numpy as np
from scipy.integrate import solve_ivp

from tests.cases import harness, runs
from tests.cases.harness import boxes
from tests.cases.runtime.test_energyBudget import ask
from studies.exact.eos import GoldshteinShapiro

RHO = 100.0
ENGINES = ("lattice", "polyhedral")
BOTH = "sources (linearDrag uniformHeating);\nlinearDragCoeffs { rate 2; velocity (1 0.5 0); }\nuniformHeatingCoeffs { rate 0.5; }\n"


def table(case):
    """{title: column} of energyBudget.dat, and the titles before those of momentum."""
    path = os.path.join(case.path, "postProcessing", "budget", "0", "energyBudget.dat")
    with open(path) as f:
        titles = [line for line in f if line.startswith("# Time")][0].split()[2:]
    columns = dict(zip(["t", *titles], case.table("budget", "energyBudget.dat").T))
    return columns, [name for name in titles if not name.startswith("momentum")]


class Sources(harness.Folder, unittest.TestCase):
    def box(self, name, sources, engine="lattice", flat=2, u=(0.3, -0.2, 0), T=1.0, e=1.0, step=0.01, end=1.0, interval=0.25):
        """A uniform gas in a periodic box of squares that has one cell along the axis `flat`."""
        path, n = os.path.join(self.folder, name), np.full(3, 8)
        n[flat] = 1
        u = np.tile(np.array(u), (64, 1))
        rho, p = np.full(64, RHO), GoldshteinShapiro(e).p(RHO, T)
        boxes.box_case(path, n, 0.1 * n, rho, u, np.full(64, p), end, types={a: "cyclic" for k, a in enumerate("xyz") if k != flat},
                       adjust="no", step=step, interval=interval, e=e, cooling="Haff" if e < 1 else "none")
        runs.add(path, "system/fvSchemes", f"meshEngine {engine};\n")
        runs.add(path, "constant/granularProperties", sources)
        ask(path)
        return path

    def follow(self, *arguments, **options):
        path = self.box(*arguments, **options)
        harness.program("granularGas", "-case", path)
        return harness.haff.Case(path)

    def close(self, b, titles, steps):
        """Round-off: of a uniform gas every cell is rounded alike, so that each half step may leave a bit of the largest entry."""
        causes = [name for name in titles[titles.index("cooling"):] if name != "residual"]
        scale = max(np.abs(b[name]).max() for name in ["energy", *causes])
        self.assertLess(np.abs(b["residual"]).max(), 2 * steps * 2.2e-16 * scale)
        total = b["energy"][0] + sum(b[name] for name in causes) - b["energy"]
        np.testing.assert_allclose(total, b["residual"], atol=1e-14 * scale, rtol=0)

    def test_heated_and_cooled(self):
        """dT/dt = h - B T^(3/2), to T* = (h/B)^(2/3): of second order in the step, and the same on both engines."""
        B = GoldshteinShapiro(0.9).cooling_rate(RHO)
        h = B * 2.0**1.5
        exact = solve_ivp(lambda t, T: h - B * T**1.5, (0, 20), [0.1], rtol=1e-12, atol=1e-12, dense_output=True).sol
        errors, found = {}, {}
        for engine in ENGINES:
            for step in (0.01, 0.005):
                case = self.follow(f"heated{engine}{step}", f"sources (uniformHeating); uniformHeatingCoeffs {{ rate {h!r}; }}\n",
                                   engine, u=(0, 0, 0), T=0.1, e=0.9, step=step, end=20, interval=1)
                times = case.times[1:]
                T = np.array([case.field("T", t) for t in times])
                self.assertEqual(np.ptp(T, axis=1).max(), 0)
                self.assertEqual(max(np.abs(case.field("U", t)).max() for t in times), 0)
                errors[engine, step] = np.abs(T[:, 0] / exact(np.array(times, float))[0] - 1).max()
                self.assertAlmostEqual(T[-1, 0], 2, delta=2 * errors[engine, step] + 1e-8)
                found[engine, step] = T[:, 0]
                b, titles = table(case)
                self.assertEqual(titles[-2:], ["residual", "uniformHeating"])
                self.close(b, titles, 20 / step)
                np.testing.assert_allclose(b["uniformHeating"], b["mass"][0] * 1.5 * h * (b["t"] - b["t"][0]), rtol=1e-12)
                self.assertAlmostEqual(b["uniformHeating"][-1] - b["uniformHeating"][-20], b["cooling"][-20] - b["cooling"][-1],
                                       delta=1e-5 * h * b["mass"][0])
            self.assertLess(errors[engine, 0.005], 1e-4)
            self.assertAlmostEqual(errors[engine, 0.01] / errors[engine, 0.005], 4, delta=0.2)
        np.testing.assert_allclose(found["lattice", 0.005], found["polyhedral", 0.005], rtol=1e-12)

    def test_dragged(self):
        """u - u_g falls as e^(-rate t), T as e^(-2 rate t), to round-off, also in the plane of x and z, and out of it where the wind
        blows along the missing axis."""
        for engine in ENGINES:
            for flat, wind, u in ((2, (1, 0.5, 0), (0.3, -0.2, 0)), (1, (1, 0, -0.5), (-0.3, 0, 0.2)), (0, (0.7, 0.5, 1), (0, -0.2, 0))):
                text = "sources (linearDrag); linearDragCoeffs { rate 2; velocity (%r %r %r); }\n" % wind
                case = self.follow(f"dragged{engine}{flat}", text, engine, flat, u)
                self.assertEqual(len(case.times), 5)
                for name in case.times[1:]:
                    t = float(name)
                    exact = np.array(wind) + (np.array(u) - wind) * np.exp(-2 * t)
                    np.testing.assert_allclose(case.field("U", name), np.tile(exact, (64, 1)), atol=1e-14, rtol=0)
                    np.testing.assert_allclose(case.field("T", name), np.exp(-4 * t), rtol=1e-13)
                b, titles = table(case)
                self.close(b, titles, 100)
                self.assertEqual(titles[-1], "linearDrag")
                np.testing.assert_allclose(b["linearDrag"], b["energy"] - b["energy"][0], atol=1e-13 * b["energy"][0])
                for k, axis in enumerate("xyz"):
                    if wind[k] != 0 or u[k] != 0:
                        pushed = b["mass"][0] * (np.array(wind) - u)[k] * -np.expm1(-2 * b["t"])
                        np.testing.assert_allclose(b["momentumSources_" + axis], pushed, atol=1e-13 * b["mass"][0])

    def test_dragged_to_rest(self):
        """After some 370 times of the drag e^(-2 rate t) is 0 in a double. T stays above 0 in every written time, each of which can be
        continued, to the same bits; the Mach number is no number above all others."""
        x, y = (np.arange(16) + 0.5) / 16, (np.arange(8) + 0.5) / 8
        rho = (100 * (1 + 0.5 * np.sin(6 * x)[None, :] * np.cos(6 * y)[:, None])).ravel()
        for engine in ENGINES:
            path = boxes.box_case(os.path.join(self.folder, f"rest{engine}"), (16, 8, 1), (2, 1, 0.1), rho, np.zeros((128, 3)),
                                  GoldshteinShapiro(1.0).p(rho, 1), 1.25, interval=0.25)
            runs.add(path, "system/fvSchemes", f"meshEngine {engine};\n")
            runs.add(path, "constant/granularProperties", "sources (linearDrag); linearDragCoeffs { rate 400; velocity (0 0 0); }\n")
            ask(path)
            harness.program("granularGas", "-case", path)
            whole = harness.haff.Case(path)
            self.assertEqual(len(whole.times), 6)
            b, titles = table(whole)
            self.close(b, titles, 100)
            with open(os.path.join(path, "postProcessing", "run", "0", "run.dat"), encoding="utf-8") as f:
                self.assertNotIn("inf", f.read())
            for last in whole.times[1:-1]:
                self.assertGreater(whole.field("T", last).min(), 0)
                part = shutil.copytree(path, f"{path}from{last}", ignore=lambda _, names: [n for n in names if n in whole.times and
                                                                                          float(n) > float(last)])
                harness.program("granularGas", "-case", part)
                for name in ("rho", "rhoU", "rhoE"):
                    np.testing.assert_array_equal(harness.haff.Case(part).field(name), whole.field(name))

    def test_cold_start(self):
        """Cold gas allows a long step, in which it would be heated a great deal before it moves: such a step is shortened, so that
        the wave that starts is that of small steps. Without that U is 14 % off."""
        n, end = 60, 0.5
        x = (np.arange(n) + 0.5) / n
        rho = 100 * (1 + 0.5 * np.sin(2 * np.pi * x))
        for engine in ENGINES:
            found = []
            for name, how in (("long", {}), ("short", {"adjust": "no", "step": 1e-3})):
                path = boxes.box_case(os.path.join(self.folder, f"cold{engine}{name}"), (n, 1, 1), (1, 0.1, 0.1), rho,
                                      np.zeros((n, 3)), GoldshteinShapiro(1.0).p(rho, 1e-6), end, types={"x": "cyclic"}, **how)
                runs.add(path, "system/fvSchemes", f"meshEngine {engine};\n")
                runs.add(path, "constant/granularProperties", "sources (uniformHeating); uniformHeatingCoeffs { rate 1; }\n")
                harness.program("granularGas", "-case", path)
                found.append(harness.haff.Case(path).field("U")[:, 0])
            np.testing.assert_allclose(found[0], found[1], atol=3e-3 * np.abs(found[1]).max(), rtol=0)

    def shake(self, path, **control):
        """Gives a case the gravity 10 along -y, and shakes it."""
        boxes.write_dictionary(path, "constant", "g", "dimensions [0 1 -2 0 0 0 0];\nvalue (0 -10 0);\n")
        boxes.write_dictionary(path, "constant", "shaking", "type sinusoidal; amplitude 2.2; frequency 37.3; phase 0.3;\n")
        harness.edit(path, "system/controlDict", **control)
        return path

    def falls(self, path, end):
        """T of a uniform gas that starts at T = 0.04 and falls is kept, and u is the integral of g(t), to the round-off of E."""
        harness.program("granularGas", "-case", path)
        case, w = harness.haff.Case(path), 2 * np.pi * 37.3
        u = -10 * (end + 2.2 * (np.sin(w * end + 0.3) - np.sin(0.3)) / w)
        np.testing.assert_allclose(case.field("T"), 0.04, rtol=1e-11)
        np.testing.assert_allclose(case.field("U"), np.outer(np.ones(len(case.centres)), (0, u, 0)), atol=1e-12)
        return case

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_shaken_fall(self):
        """On any cells, coarse ones too, where the speed of sound alone would let steps be as long as a period; and by any scheme."""
        def gas(at):
            return {"rho": np.ones(len(at)), "p": np.full(len(at), 0.04), "U": np.zeros((len(at), 3))}
        for mesh, dim, cells, stepper in (("lattice", 2, 10, "SSPRK3"), ("lattice", 2, 4, "SSPRK2"), ("lattice", 2, 4, "SSPRK43"),
                                          ("lattice", 2, 4, "SSPRK104"), ("polyhedral", 2, 4, "SSPRK3"), ("simplices", 2, 5, "SSPRK3"),
                                          ("simplices", 3, 5, "SSPRK3")):
            with self.subTest(f"{mesh} {dim} {stepper}"):
                path = runs.unit_box(os.path.join(self.folder, f"fall{mesh}{dim}{stepper}"), mesh, dim, cells, gas)
                harness.edit(path, "system/fvSchemes", timeScheme=stepper)
                self.falls(self.shake(path, endTime=0.1, writeInterval=0.1), 0.1)
        log = harness.program("granularGas", "-case", self.shake(path, endTime=0.2, writeInterval=0.1)).stdout
        self.assertIn("limited by: stroke", log)

    def test_shaken_layer(self):
        """A layer on a floor that is shaken: of second order in the step."""
        found = []
        y = (np.arange(24) + 0.5) / 24
        for step in (2e-3, 1e-3, 5e-4):
            path = boxes.box_case(os.path.join(self.folder, f"layer{step}"), (1, 24, 1), (0.1, 1, 0.1), np.exp(-2 * y), np.zeros((24, 3)),
                                  5 * np.exp(-2 * y), 0.1, slip=("yLow", "yHigh"), adjust="no", step=step, eos="perfectGas")
            harness.program("granularGas", "-case", self.shake(path))
            found.append(harness.haff.Case(path).field("U")[:, 1])
        self.assertGreater(np.abs(found[0] - found[1]).max() / np.abs(found[1] - found[2]).max(), 3.5)

    def test_budget_of_flow(self):
        """All sources at once in a gas that moves: the budget closes, the gas has the same bits with it, the tables are the
        same on two ranks."""
        for engine in ENGINES:
            found, tables = [], []
            for ranks, asked in ((1, False), (1, True), (2, True)):
                path = runs.make(os.path.join(self.folder, f"flow{engine}{ranks}{asked}"), (30, 30, 1), 0.01)
                runs.add(path, "system/fvSchemes", f"meshEngine {engine};\n")
                runs.add(path, "constant/granularProperties", BOTH)
                if asked:
                    ask(path)
                harness.program("granularGas", "-case", path, ranks=ranks)
                case = harness.haff.Case(path)
                found.append([case.field(name) for name in ("rho", "rhoU", "rhoE")])
                if asked:
                    tables.append(table(case))
            for other in found[1:]:
                for one, two in zip(found[0], other):
                    np.testing.assert_array_equal(one, two)
            b, titles = tables[0]
            self.close(b, titles, 300)
            self.assertEqual(titles[-3:], ["residual", "linearDrag", "uniformHeating"])
            for name in ("cooling", "gravity", "linearDrag", "uniformHeating"):
                self.assertGreater(np.abs(b[name]).max(), 0, name)
            for name in b:
                np.testing.assert_array_equal(b[name], tables[1][0][name])

    def test_printed(self):
        """checkCase says what is on."""
        done = harness.program("checkCase", "-case", self.box("printed", BOTH))
        self.assertRegex(done.stdout, r"sources +linearDrag\n +rate +2\n +velocity +\(1 0\.5 0\)\n +sources +uniformHeating\n +rate +0\.5\n")

    def test_refused(self):
        coeffs = "linearDragCoeffs { rate 2; }\n"
        for text, parts in (("sources (linearDrug);\n" + coeffs, ("'linearDrug'", "linearDrag, uniformHeating", "did you mean 'linearDrag'?")),
                            ("sources (gravity);\n", ("there is no 'gravity'",)),
                            ("sources (linearDrag);\n", ("linearDrag needs the dictionary  linearDragCoeffs { rate ..; }",)),
                            ("sources (linearDrag linearDrag);\n" + coeffs, ("linearDrag stands there twice",)),
                            ("sources (linearDrag);\nlinearDragCoeffs { rat 2; }\n", ("this line has 'rat': did you mean 'rate'?",)),
                            ("sources (linearDrag);\nlinearDragCoeffs { rate -2; }\n", ("rate is -2; it must be at least 0",)),
                            ("source (linearDrag);\n" + coeffs, ("did you mean 'sources'?",))):
            with self.subTest(text):
                path = self.box("refused%d" % abs(hash(text)), text)
                done = harness.program("granularGas", "-case", path, check=False)
                self.assertEqual(done.returncode, 1)
                for part in parts:
                    self.assertIn(part, done.stderr)
                self.assertIn("granularProperties:", done.stderr)

    def test_what_is_not_chosen_may_stay(self):
        path = self.box("stays", "sources (); linearDragCoeffs { rate -1; colour red; }\n", end=0.02, interval=0.02)
        harness.program("granularGas", "-case", path)

    def test_grains(self):
        """granularMD does not know them: it says so, and does not run without them."""
        case = harness.copy("coolingGas", self.folder)
        harness.mesh(case, 4)
        runs.add(case, "constant/granularProperties", BOTH)
        done = harness.program("granularMD", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"granularProperties:\d+: .*sources.*without linearDrag")


if __name__ == "__main__":
    unittest.main()
