# SPDX-License-Identifier: GPL-3.0-or-later
"""Implicit acoustics of dense cells on lattices: rest across their border, the bits of the explicit scheme until a cell is dense and on any
number of ranks, restarts, bounds and budgets in one to three dimensions, and what is refused."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.gas import test_layers

EXPLICIT, IMPLICIT = "acoustics { type explicit; }\n", "acoustics { type implicit; }\n"
SLIP = ("xLow", "xHigh", "yLow", "yHigh", "zLow", "zHigh")
LIMIT = 0.65  # alphaMax of GoldshteinShapiro


class Acoustics(harness.Folder, unittest.TestCase):
    def block(self, name, n, end, acoustics=IMPLICIT, interval=None, e=0.9, threshold=0.03, alpha=0.55, p=1e-3, **options):
        """A block of gas of given alpha and p over rho falls in a corner of a box of walls and breaks; gravity 10 along -y."""
        case = os.path.join(self.folder, name)
        size = tuple(0.25 * k for k in n)
        at = harness.boxes.centres(n, size)
        inside = (at[:, 0] <= 0.5 * size[0]) & (at[:, 1] < 0.7 * size[1]) & (at[:, 2] <= 0.6 * size[2])
        rho = np.where(inside, alpha, 1e-4) / (np.pi / 6 * 0.1 ** 3)
        options = {"eos": "GoldshteinShapiro", "reconstruct": "WPENO5", **options}
        harness.box_case(case, n, size, rho, np.zeros((len(at), 3)), p * rho, end, gravity=(0.0, -10.0, 0.0), slip=SLIP, e=e,
                         cooling="none" if e == 1 else "Haff", interval=interval or end, **options)
        harness.edit(case, "constant/granularProperties", diameter=0.1)
        with open(os.path.join(case, "constant", "granularProperties")) as f:
            text = f.read()
        with open(os.path.join(case, "constant", "granularProperties"), "w") as f:
            f.write(re.sub(r"grain\s*\{", f"grain {{ thresholdSpeed {threshold}; ", text))
        self.solution(case, acoustics)
        return case

    def solution(self, case, text):
        harness.write_dictionary(case, "system", "fvSolution", text)

    def run_case(self, case, ranks=1):
        done = harness.program("granularGas", "-case", case, ranks=ranks)
        return harness.haff.Case(case), done.stdout

    def same(self, a, b, time):
        for name in ("rho", "rhoU", "rhoE"):
            np.testing.assert_array_equal(a.field(name, time), b.field(name, time))

    def test_rest_across_the_border(self):
        """A layer, cold and packed below, warm above: the bed and the rest keep still, with steps far beyond those of sound."""
        case = test_layers.Layers.case(self, "rest", "settledLayer { depth 8; packing 0.6; background 1e-30; }", n=(1, 40, 1),
                                       size=(0.5, 10.0, 0.5), T="y < 4 ? 0.05 : 60", eos="TorquatoSpheres", end=2.0)
        self.solution(case, IMPLICIT)
        harness.edit(case, "system/controlDict", deltaT=1e-3)
        start, log = self.run_case(case)
        self.assertIn("implicit acoustics", log)
        self.assertGreater(start.field("alpha").max(), 0.95 * 0.64)
        self.assertLess(np.abs(start.field("U")).max(), 1e-11 * np.sqrt(60))
        steps = int(re.findall(r"(\d+) steps in", log)[-1])
        self.assertGreater(steps, 500)  # each of them could move it

    def test_explicit_until_a_cell_is_dense(self):
        explicit, _ = self.run_case(self.block("explicit", (24, 16, 1), 0.2, EXPLICIT, interval=0.05))
        implicit, log = self.run_case(self.block("implicit", (24, 16, 1), 0.2, interval=0.05))
        self.assertIn("implicit acoustics", log)
        self.same(explicit, implicit, "0.05")
        self.assertGreater(explicit.field("alpha", "0.05").max(), 0.551)
        self.assertNotEqual(list(explicit.field("rho")), list(implicit.field("rho")))

    def test_default(self):
        """Nobody asks: steps are implicit once the bed is cold, with the same bits by the word `automatic` and after a restart on two ranks."""
        options = {"interval": 0.2, "threshold": 0.3, "courant": 1.0}
        whole, log = self.run_case(self.block("tacit", (24, 16, 1), 1.0, "", **options))
        self.assertRegex(log, r"acoustics +automatic")
        self.assertIn("implicit acoustics", log)
        plain = self.run_case(self.block("plain", (24, 16, 1), 1.0, EXPLICIT, **options))[1]
        steps, more = (int(re.findall(r"(\d+) steps in", text)[-1]) for text in (log, plain))
        self.assertLess(1.5 * steps, more)
        self.same(whole, self.run_case(self.block("named", (24, 16, 1), 1.0, "acoustics { type automatic; }\n", **options))[0], "1")
        self.same(whole, self.run_case(runs.until(whole.path, whole.path + "_two", 0.8), 2)[0], "1")

    def test_default_of_gas_that_is_not_cold(self):
        """The default has the bits of explicit steps in elastic gas, in gas that may collapse and in hot dense gas; `implicit` has not."""
        for name, end, options in (("elastic", 0.2, {"alpha": 0.62, "e": 1}), ("collapsing", 0.02, {"threshold": 0, "alpha": 0.62, "p": 1e3}),
                                   ("hot", 2e-3, {"alpha": 0.62, "p": 1e3}), ("nearlyElastic", 2e-3, {"alpha": 0.62, "p": 1e3, "e": 0.999}),
                                   ("perfect", 0.2, {"eos": "perfectGas", "e": 1})):
            words = ("", EXPLICIT) if name == "perfect" else ("", EXPLICIT, IMPLICIT)
            with self.subTest(name):
                results = [self.run_case(self.block(name + str(i), (24, 16, 1), end, text, **options)) for i, text in enumerate(words)]
                self.same(results[0][0], results[1][0], f"{end:g}")
                self.assertEqual(["implicit acoustics" in log for _, log in results], [False, False, True][:len(words)])

    def test_says_why_not(self):
        """Dense gas whose steps stay explicit: the log says once which bound forbids implicit ones, with its cell, and the same on two ranks."""
        note = (r"note: gas is dense, but the last 100 steps had no implicit acoustics\. Such a step would be limited by: ([a-z ]+)"
                r"(?:, cell at \(\S+ \S+ \S+\) with alpha = (\S+), T = (\S+), c = (\S+))?\n +to (\S+) explicit steps, and `gain` of `acoustics` asks for (\S+)\n +\w")
        for name, ranks, cause, text, end, options in (
                ("whyHot", (1, 2), "cooling of the bed", "", 0.2, {"alpha": 0.62, "p": 1e3}),
                ("whySoft", (1,), "free fall", "acoustics { type implicit; implicitCoeffs { gain 50; } }\n", 0.3, {"alpha": 0.62, "p": 10, "threshold": 3})):
            with self.subTest(name):
                logs = [self.run_case(self.block(f"{name}{count}", (70, 14, 1), end, text, courant=1.0, **options), count)[1] for count in ranks]
                found = [re.findall(note, log) for log in logs]
                self.assertEqual([len(x) for x in found], [1] * len(ranks), logs[0][-3000:])
                self.assertEqual(found[0], found[-1])
                said, alpha, T, c, steps, gain = found[0][0]
                self.assertEqual(said, cause)
                self.assertLess(float(steps), float(gain))
                if cause == "cooling of the bed":
                    self.assertGreater(float(alpha), 0.9 * LIMIT)
                    self.assertGreater(float(c), np.sqrt(5 / 3 * float(T)))

    def test_bits_on_ranks_and_over_restarts(self):
        """Two tiles side by side, with the bed across their border; uniform gas skipped or not."""
        whole, log = self.run_case(self.block("whole", (70, 14, 1), 0.24, interval=0.02))
        self.assertGreater(sum(map(int, re.findall(r"implicit acoustics: (\d+) steps", log))), 60)
        self.same(whole, self.run_case(self.block("all", (70, 14, 1), 0.24, IMPLICIT + "skipUniform no;\n", interval=0.02))[0], "0.24")
        for begin, ranks in (("0.2", 2), ("0.22", 3)):
            self.same(whole, self.run_case(runs.until(whole.path, f"{whole.path}_{ranks}", begin), ranks)[0], "0.24")

    def test_bounds_and_budget(self):
        """In one, two and three dimensions: packing is a bound, no mass is lost, and energy comes from named causes."""
        for n, end in (((1, 40, 1), 0.8), ((24, 16, 1), 0.5), ((12, 14, 10), 0.25)):
            with self.subTest(n):
                case = self.block("budget" + "x".join(map(str, n)), n, end)
                with open(os.path.join(case, "system", "controlDict"), "a") as f:
                    f.write("functions { energy { type energyBudget; } }\n")
                mass = harness.haff.Case(case).field("rho", "0").sum()
                result, log = self.run_case(case)
                self.assertIn("implicit acoustics", log)
                self.assertLess(result.field("alpha").max(), LIMIT)
                self.assertGreater(result.field("alpha").max(), 0.95 * LIMIT)
                self.assertGreater(result.field("T").min(), 0)
                self.assertAlmostEqual(result.field("rho").sum() / mass, 1, delta=1e-12)
                rejected = re.findall(r"rejected: .*in all (\d+)", log)
                steps = int(re.findall(r"(\d+) steps in", log)[-1])
                self.assertLessEqual(int(rejected[-1]) if rejected else 0, 1 + 0.05 * steps)

    def test_refused(self):
        for name, text, options, says in (
                ("perfect", IMPLICIT, {"eos": "perfectGas"}, "has no alphaMax"),
                ("word", "acoustics { type implict; }\n", {}, "implicit"),
                ("range", "acoustics { type implicit; implicitCoeffs { dense 2; } }\n", {}, "dense")):
            with self.subTest(name):
                done = harness.program("granularGas", "-case", self.block(name, (8, 8, 1), 0.1, text, **options), check=False)
                self.assertEqual(done.returncode, 1)
                self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()
