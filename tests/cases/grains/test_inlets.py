# SPDX-License-Identifier: GPL-3.0-or-later
"""granularMD with patches through which grains come in: the state behind them, counts and balances, values that change in time, restarts to the bit, errors."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.grains import test_particles as hard
from tests.cases.grains.test_mixtures import species

NAMES = {"alpha": "%g", "U": "(%g 0 0)", "T": "%g"}


def give(case, patch, **rules):
    """Sets the rules of a patch: the words between the braces."""
    for name, rule in rules.items():
        harness.dictionary.edit(os.path.join(case, "0", name), {f"boundaryField/{patch}": f"{{ {rule}; }}"})


def gas(alpha, U, T):
    return {name: f"type fixedValue; value uniform {NAMES[name] % value}" for name, value in (("alpha", alpha), ("U", U), ("T", T))}


def channel(case, alpha, U, T=1, inside=None, closed=False, cells=(8, 4, 1), size=(80.0, 40.0, 1.0), samples=4000, **options):
    """Grains of diameter 1 that come in at xLow, and leave at xHigh, or come in there, too; the start is that gas."""
    across = {"y": "cyclic", "z": "cyclic"} if not closed else {"y": "wall", "z": "wall"}
    hard.make(case, cells=cells, size=size, types={"x": "patch", **across}, alpha=alpha if inside is None else inside, T=T,
              **{"e": 1, "particles": f"coarseGraining {{ samples {samples}; }}\n", **options})
    harness.dictionary.edit(os.path.join(case, "0", "U"), {"internalField": f"uniform ({U} 0 0)"})
    give(case, "xLow", **gas(alpha, U, T))
    give(case, "xHigh", **(dict.fromkeys(NAMES, "type zeroGradient") if U > 0 else gas(alpha, U, T)))
    return case


def counts(case):
    """Rows of grains.dat, and the column of each title."""
    found = harness.haff.Case(case)
    with open(os.path.join(case, "postProcessing", "grains", "0", "grains.dat")) as f:
        names = [line for line in f if line.startswith("# Time")][0].split()[1:]
    return found.table("grains", "grains.dat"), {name: i for i, name in enumerate(names)}


class Inlets(harness.Folder, unittest.TestCase):
    def case(self, name, *arguments, **options):
        return channel(os.path.join(self.folder, name), *arguments, **options)

    def state(self, case, time):
        found = harness.haff.Case(case)
        return {name: found.field(name, time) for name in ("alpha", "U", "T")}

    def test_fast(self):
        """Behind an inlet of a fast stream stand its alpha, U and T, each within 1 %; without the impacts by grains beyond it T would be 2 % too high, and U 1.7 % too low."""
        hard.solve(case := self.case("fast", 0.1, 4, end=4000, interval=4000))
        found = self.state(case, "4000")
        self.assertAlmostEqual(found["alpha"].mean() / 0.1, 1, delta=0.01)
        self.assertAlmostEqual(found["U"][:, 0].mean() / 4, 1, delta=0.01)
        self.assertAlmostEqual(found["T"].mean(), 1, delta=0.01)

    def test_rest(self):
        """Between two inlets of dense gas at rest: its alpha and T; without those impacts alpha would be 26 % too low."""
        hard.solve(case := self.case("rest", 0.2, 0, end=800, interval=800, cells=(4, 2, 1), size=(40.0, 20.0, 1.0)))
        found = self.state(case, "800")
        self.assertAlmostEqual(found["alpha"].mean() / 0.2, 1, delta=0.03)
        self.assertAlmostEqual(found["T"].mean(), 1, delta=0.05)

    def test_spheres(self):
        """Of spheres in a duct of four walls: the flux, numbers and energy balance."""
        case = self.case("spheres", 0.05, 3, closed=True, cells=(4, 2, 2), size=(16.0, 8.0, 8.0), end=400, interval=400, samples=400)
        harness.edit(case, "constant/granularProperties", equationOfState="TorquatoSpheres")
        said = hard.solve(case)
        rows, at = counts(case)
        came, left = rows[-1, at["came_xLow"]], rows[-1, at["left_xLow"]] + rows[-1, at["left_xHigh"]]
        there = re.search(r"(\d+) grains are there; (\d+) have come in, (\d+) have left, 0 found no room", said[said.rindex("grains are there") - 20:])
        first = int(re.search(r"(\d+) spheres, packing", said)[1])
        self.assertEqual([int(n) for n in there.groups()], [first + came - left, came, left])
        wanted = 0.05 / (np.pi / 6) * 8 * 8 * 400 * 3.0004  # the mean of v > 0 is 3.0004
        self.assertAlmostEqual(came, wanted, delta=4 * np.sqrt(wanted))
        self.assertLess(abs(float(re.findall(r"balance ([-+\d.e]+)", said)[-1])), 1e-11)

    def test_kinds(self):
        """A mixture comes in with its own fractions, not those of the start: behind the inlet stand alpha, U and T of each kind, T in inverse proportion to mass."""
        d, m, x = np.array([1, 0.5]), np.array([2, 0.4]), np.array([1, 3])
        particles = "coarseGraining { samples 2000; }\n" + species(d, m, more=("", "inlets { xLow 3; }"))
        said = hard.solve(case := self.case("kinds", 0.1, 4, e=1, end=1000, interval=1000, particles=particles))
        self.assertLess(abs(float(re.findall(r"balance ([-+\d.e]+)", said)[-1])), 1e-11)
        found = harness.haff.Case(case)
        for k, name in enumerate(("one", "two")):
            alpha = 0.1 * x[k] * d[k] ** 2 / np.sum(x * d**2)
            self.assertAlmostEqual(found.field(f"alpha.{name}", "1000").mean() / alpha, 1, delta=0.03)
            self.assertAlmostEqual(found.field(f"U.{name}", "1000")[:, 0].mean() / 4, 1, delta=0.01)
            self.assertAlmostEqual(found.field(f"T.{name}", "1000").mean() * m[k] / np.average(m, weights=x), 1, delta=0.02)

    def test_table(self):
        """A stream that ends at t = 10, by a table, and one whose rate follows an expression."""
        hard.solve(case := self.case("table", 0.05, 4, end=20, interval=20, samples=1, size=(80.0, 400.0, 1.0)))
        whole = counts(case)[0][-1, counts(case)[1]["came_xLow"]]
        case = self.case("part", 0.05, 4, end=20, interval=20, samples=1, size=(80.0, 400.0, 1.0))
        give(case, "xLow", alpha="type uniformFixedValue; uniformValue table ((0 0.05) (9.999 0.05) (10 0) (100 0))")
        hard.solve(case)
        part = counts(case)[0][-1, counts(case)[1]["came_xLow"]]
        n = 0.05 / (np.pi / 4) * 400 * 4
        self.assertAlmostEqual(whole, 20 * n, delta=4 * np.sqrt(20 * n))
        self.assertAlmostEqual(part, 10 * n, delta=4 * np.sqrt(10 * n))
        case = self.case("wave", 0.05, 4, end=20, interval=10, samples=1, size=(80.0, 400.0, 1.0))
        give(case, "xLow", alpha='type exprFixedValue; valueExpr "0.05*(1 + 0.5*sin(2*pi()*time()/20))"; value uniform 0.05')
        hard.solve(case)
        rows, at = counts(case)
        for time, part in ((10, 10 + 10 / np.pi), (20, 20)):
            came = rows[np.argmin(abs(rows[:, 0] - time)), at["came_xLow"]]
            self.assertAlmostEqual(came, part * n, delta=4 * np.sqrt(part * n), msg=f"until {time}")

    def test_restart(self):
        """A run in two parts has the bits of one, also where numbers for more grains are made in the second; of one kind, and of two."""
        self.check_restart("one", 0.1)
        case = self.check_restart("mixture", 0.07, species((1, 0.6), (2, 0.5)))
        harness.edit(case, "system/controlDict", endTime=32.001, writeInterval=0.001)
        harness.edit(case, "constant/granularProperties", thresholdSpeed=0.02)
        before = hard.grains.read(harness.haff.Case(case), "32")
        self.assertIn("have changed, so counts and averages begin anew", hard.solve(case))  # numbers go by kind again
        after = hard.grains.read(harness.haff.Case(case), "32.001")
        for k in (0, 1):
            self.assertEqual(np.sum(before["species"] == k), np.sum(after["species"] == k))

    def check_restart(self, name, alpha, particles=""):
        options = {"inside": 0.01, "end": 32, "interval": 8, "closed": True, "e": 0.9, "threshold": 0.01, "g": (0.5, -0.2, 0)}
        one = self.case(name, alpha, 2, particles="coarseGraining { samples 10; }\n" + particles, **options)
        give(one, "xLow", U='type exprFixedValue; valueExpr "vector(2 + 0.5*sin(time()), 0, 0)"; value uniform (2 0 0)')
        two = shutil.copytree(one, os.path.join(self.folder, name + " in parts"))
        start = int(re.search(r"(\d+) disks, packing", hard.solve(one))[1])
        harness.edit(two, "system/controlDict", endTime=8)
        hard.solve(two)
        harness.edit(two, "system/controlDict", endTime=32)
        self.assertIn("to the bit", hard.solve(two))
        first, last = (len(hard.grains.read(harness.haff.Case(one), t)["x"]) for t in ("8", "32"))
        numbers = start + start // 4 + 64  # those at the start
        self.assertTrue(first < numbers < last, f"{first} < {numbers} < {last}")
        for time in ("16", "32"):
            a, b = hard.results(one, time), hard.results(two, time)
            self.assertEqual(a.keys(), b.keys())
            for name in a:
                if name != "uniform/provenance":
                    self.assertEqual(a[name], b[name], f"{time}/{name}")
        return two

    def test_refused(self):
        """An inlet lacks alpha or T; a flow rate says no velocity of grains."""
        for n, (changed, text) in enumerate((
                ({"alpha": "type zeroGradient"}, r"0/U:\d+: patch xLow: type is fixedValue, so that grains come in there, and alpha says not how"),
                ({"T": "type zeroGradient"}, r"and T says not how: give it on that patch"),
                ({"U": "type flowRateInletVelocity; volumetricFlowRate 1; value uniform (0 0 0)"}, r"patch xLow: type is flowRateInletVelocity; allowed are slip, .* fixedValue"))):
            case = self.case(f"refused {n}", 0.05, 4, end=1, interval=1, samples=1)
            give(case, "xLow", **changed)
            done = harness.program("granularMD", "-case", case, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, text)
        for inlets, text in (("{ xLow 0; }", r"particleProperties:\d+: species: no kind has a fraction above 0 at patch xLow"),
                             ("{ xLow -1; }", r"a fraction is not negative"), ("{ left 1; }", r"left")):
            case = self.case(inlets, 0.05, 4, end=1, interval=1, particles=species((1, 0.5), (1, 1), more=["inlets " + inlets] * 2))
            done = harness.program("granularMD", "-case", case, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, text)


if __name__ == "__main__":
    unittest.main()
