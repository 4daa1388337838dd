# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities that the gas carries, in whole runs: bits on ranks, after a restart and along uniform axes, patches that give them,
output by name, what is refused."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs

boxes = harness.boxes
CARRIED = "carried { dye { type passive; diffusivity 0.05; } mark { type passive; } phi { type segregation; velocity -2; diffusivity 0.01; } }\n"
NAMES = ("dye", "mark", "phi")
FUNCTIONS = """functions
{
    points  { type probes; fields (dye phi); probeLocations ((0.52 0.31 0.01)); }
    extreme { type fieldMinMax; fields (dye mark phi); writeControl timeStep; writeInterval 5; }
    total   { type volFieldValue; fields (dye mark phi); operation volAverage; writeControl writeTime; }
    mean    { type fieldAverage; fields { dye { mean on; base time; } } }
    wall    { type surfaceFieldValue; regionType patch; name xLow; operation areaAverage; fields (mark); writeControl timeStep; writeInterval 5; }
    pictures { type vtk; fields (dye phi); writeControl writeTime; }
}
"""


def field(case, name, values, rules=None, time="0"):
    boxes.DIMENSIONS[name] = "[0 0 0 0 0 0 0]"
    boxes.write_field(case, name, values, rules or '".*" zeroGradient\n"z.*" empty', time=time)


def make(path, n=(30, 16, 1), end=0.02, engine="lattice", **options):
    """A hot bubble in a gas that falls, a stripe of dye, and a mixture."""
    case = runs.make(path, n, end, **options)
    at = harness.haff.Case(case).centres
    runs.add(case, "constant/granularProperties", CARRIED)
    runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
    rules = "\n".join(['".*" zeroGradient'] + [f'"{a}.*" empty' for a, k in zip("xyz", n) if k == 1])
    for name, values in (("dye", np.where(np.abs(at[:, 0] - 1) < 0.3, 1.0, 0.0)), ("mark", 2 + np.sin(at[:, 0])),
                         ("phi", 0.5 + 0 * at[:, 0])):
        field(case, name, values, rules)
    return case


def total(case, name, time=None):
    result = harness.haff.Case(case)
    return np.sum(result.field("rho", time) * result.field(name, time))


class Runs(harness.Folder, unittest.TestCase):
    def test_ranks_and_restart(self):
        """Lattices in two and three dimensions, and polyhedra: the same files; sums and bounds are kept."""
        for name, n, engine in (("plane", (30, 16, 1), "lattice"), ("cube", (12, 8, 6), "lattice"), ("cells", (16, 10, 1), "polyhedral")):
            with self.subTest(name):
                case = make(os.path.join(self.folder, name), n, engine=engine, interval=0.01)
                other = shutil.copytree(case, case + "_ranks")
                harness.program("granularGas", "-case", case)
                harness.program("granularGas", "-case", other, ranks=2)
                runs.same(self, runs.results(case), runs.results(other))
                first, half, last = runs.times(case)
                part = runs.until(case, case + "_part", half)
                harness.program("granularGas", "-case", part)
                runs.same(self, runs.contents(os.path.join(case, last)), runs.contents(os.path.join(part, last)))
                result = harness.haff.Case(case)
                for q, low, high in (("dye", 0, 1), ("mark", 1, 3), ("phi", 0, 1)):
                    values = result.field(q, last)
                    self.assertGreater(np.ptp(values), 0.1)
                    self.assertTrue(low - 1e-12 <= values.min() and values.max() <= high + 1e-12, (q, values.min(), values.max()))
                    self.assertLess(abs(total(case, q, last) / total(case, q, first) - 1), 1e-12, q)

    def test_gas_is_the_same(self):
        """What it carries does not act on the gas."""
        case = make(os.path.join(self.folder, "with"))
        without = runs.make(os.path.join(self.folder, "without"), (30, 16, 1), 0.02)
        for each in (case, without):
            harness.program("granularGas", "-case", each)
        last = runs.times(case)[-1]
        one, two = (runs.contents(os.path.join(each, last)) for each in (case, without))
        for name in runs.FIELDS:
            self.assertEqual(one[name], two[name], name)

    def test_output(self):
        """Function objects know the names; what they write is what the files hold."""
        case = make(os.path.join(self.folder, "output"), (20, 10, 1))
        runs.add(case, "system/controlDict", FUNCTIONS)
        checked = harness.program("checkCase", "-case", case)
        self.assertNotIn("nothing reads", checked.stdout + checked.stderr)
        harness.program("granularGas", "-case", case)
        last = runs.times(case)[-1]
        table = np.loadtxt(os.path.join(case, "postProcessing/total/0/volFieldValue.dat"))
        for index, name in enumerate(NAMES):
            self.assertAlmostEqual(table[-1][1 + index], harness.haff.Case(case).field(name, last).mean(), delta=1e-12)
        self.assertTrue(os.path.exists(os.path.join(case, last, "dyeMean")))
        shown = runs.contents(os.path.join(case, "VTK"))
        self.assertTrue(any(b"dye" in text and b"phi" in text for text in shown.values()), shown.keys())

    def test_uniform_axis(self):
        """An axis along which the quantities vary is not left out; one along which they do not is."""
        for varies in (False, True):
            case = runs.make(os.path.join(self.folder, f"axis_{varies}"), (12, 10, 4), 0.01, types={"z": "cyclic"})
            at = harness.haff.Case(case).centres
            runs.add(case, "constant/granularProperties", "carried { dye { type passive; diffusivity 0.1; } }\n")
            field(case, "dye", np.sin(at[:, 0]) + (np.cos(5 * np.pi * at[:, 2]) if varies else 0), '".*" zeroGradient\n"z.*" cyclic')
            plain = shutil.copytree(case, case + "_plain")
            runs.add(plain, "system/fvSolution", "skipUniformAxes no;\n")
            for each in (case, plain):
                harness.program("granularGas", "-case", each)
            runs.same(self, runs.results(case), runs.results(plain))


class Inlet(harness.Folder, unittest.TestCase):
    def pipe(self, name, dye, end=0.05, engine="lattice", **quantity):
        n = (60, 1, 1)
        size = (3.0, 0.1, 0.1)
        one = np.ones(60)
        case = harness.box_case(os.path.join(self.folder, name), n, size, 50 * one, np.outer(one, (20.0, 0, 0)), 500 * one, end)
        rest = '\n"y.*" empty\n"z.*" empty'
        boxes.write_field(case, "U", np.outer(one, (20.0, 0, 0)), "xLow fixedValue; value uniform (20 0 0)\nxHigh zeroGradient" + rest)
        for k, value in (("rho", 50), ("p", 500)):
            boxes.write_field(case, k, value * one, f"xLow fixedValue; value uniform {value}\nxHigh zeroGradient" + rest)
        runs.add(case, "constant/granularProperties", "carried { dye { type passive; } }\n")
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        field(case, "dye", 0 * one, f"xLow {dye}\nxHigh inletOutlet; inletValue uniform 7" + rest)
        harness.program("granularGas", "-case", case)
        return case, harness.haff.Case(case).field("dye", runs.times(case)[-1])

    def test_given_values(self):
        """What is given on the inlet runs in with the gas; behind its front it has the value, ahead of it the start's."""
        for engine in ("lattice", "polyhedral"):
            case, dye = self.pipe(f"given_{engine}", "fixedValue; value uniform 0.25", engine=engine)
            self.assertTrue(np.all(np.abs(dye[:12] - 0.25) < 1e-3) and np.all(np.abs(dye[30:]) < 1e-3), dye)
            self.assertAlmostEqual(total(case, "dye"), 50 * 0.25 * 20 * 0.05 / 0.05, delta=0.01 * 250)

    def test_values_in_time(self):
        """A table: no dye before t = 0.025, then 1."""
        _, dye = self.pipe("table", "uniformFixedValue; uniformValue table ((0 0) (0.0249 0) (0.0251 1) (1 1))")
        self.assertTrue(np.all(dye[:7] > 0.98) and np.all(dye[14:] < 0.02), dye)
        self.assertAlmostEqual(dye.sum(), 10, delta=0.2)


class Beds(harness.Folder, unittest.TestCase):
    def test_settling(self):
        """Steps with implicit acoustics: sums, bounds, a uniform quantity, and the bits on two ranks and after a restart."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                case = harness.copy("heap2D", self.folder)
                harness.mesh(case, 24)
                runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
                runs.add(case, "constant/granularProperties", CARRIED.replace("0.05", "1e-4").replace("-2", "-0.05").replace("0.01", "1e-5"))
                harness.edit(case, "system/controlDict", endTime=0.03, writeInterval=0.015)
                at = harness.haff.Case(case).centres
                rules = '".*" zeroGradient\n"(front|back)" empty'
                for name, values in (("dye", np.where(at[:, 0] > np.median(at[:, 0]), 1.0, 0.0)), ("mark", 0.1 + 0 * at[:, 0]),
                                     ("phi", 0.5 + 0 * at[:, 0])):
                    field(case, name, values, rules, time="0.orig")
                other = shutil.copytree(case, case + "_ranks")
                said = harness.program("granularGas", "-case", case).stdout
                self.assertIn("implicit acoustics:", said)
                harness.program("granularGas", "-case", other, ranks=2)
                runs.same(self, runs.results(case), runs.results(other))
                first, half, last = runs.times(case)
                part = runs.until(case, case + "_part", half)
                harness.program("granularGas", "-case", part)
                runs.same(self, runs.contents(os.path.join(case, last)), runs.contents(os.path.join(part, last)))
                result = harness.haff.Case(case)
                self.assertEqual(np.ptp(result.field("mark", last)), 0)
                for q in ("dye", "phi"):
                    values = result.field(q, last)
                    self.assertTrue(-1e-12 <= values.min() and values.max() <= 1 + 1e-12, (q, values.min(), values.max()))
                    self.assertLess(abs(self.sum(result, q, last) / self.sum(result, q, first) - 1), 1e-11, q)

    def sum(self, result, name, time):
        return np.sum(result.field("rho", time) * result.field(name, time) * result.volumes)


class Mixture(harness.Folder, unittest.TestCase):
    def test_one_run_and_two(self):
        """From one time of the gas of segregationWedge on, for so short a time that the gas hardly changes: the mixture that the gas
        carries, and that of granularSegregation in the flow of that time."""
        gas = harness.copy("wedge", self.folder)
        harness.mesh(gas, 50)
        harness.edit(gas, "system/controlDict", endTime=0.03, writeInterval=0.03)
        harness.program("granularGas", "-case", gas)
        two = harness.copy("segregationWedge", os.path.dirname(gas))
        harness.mesh(two, 50)
        for entry in ("percolation", "velocity"):
            path = os.path.join(two, "constant/segregationProperties")
            with open(path) as f:
                text = f.read()
            with open(path, "w") as f:
                f.write(text.replace('case "gas"; time 0.0425;', f'case "{gas}"; time 0.03;'))
        harness.edit(two, "system/controlDict", endTime=0.002, deltaT=2e-5, writeInterval=0.002)
        harness.program("granularSegregation", "-case", two)
        at = harness.haff.Case(gas).centres
        runs.add(gas, "constant/granularProperties",
                 "carried { phi { type segregation; percolation kineticStress; q 0.2; rho 1910; diffusivity 0.5; } }\n")
        field(gas, "phi", np.full(len(at), 0.5), 'inlet fixedValue; value uniform 0.5\noutlet inletOutlet; inletValue uniform 0.5\n'
                                                 'wall zeroGradient\n".*" empty', time="0.03")
        os.remove(os.path.join(gas, "0.03/uniform/checksums"))
        harness.edit(gas, "system/controlDict", endTime=0.032, writeInterval=0.002)
        harness.program("granularGas", "-case", gas)
        one, other = harness.haff.Case(gas).field("phi", "0.032") - 0.5, harness.haff.Case(two).field("phi", "0.002") - 0.5
        self.assertGreater(np.corrcoef(one, other)[0, 1], 0.95)
        self.assertLess(np.abs(one - other).mean(), 0.35 * np.abs(other).mean())
        self.assertAlmostEqual(one.max(), other.max(), delta=0.15 * other.max())
        ahead = at[:, 0] + (10 - at[:, 1]) < 2  # where the stream comes in, all is uniform
        self.assertTrue(ahead.any() and np.all(one[ahead] == 0))


class Refused(harness.Folder, unittest.TestCase):
    def said(self, case):
        done = harness.program("checkCase", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        return done.stdout + done.stderr

    def test_messages(self):
        first = make(os.path.join(self.folder, "first"), (8, 6, 1))
        for k, (old, new, words) in enumerate((
                ("dye {", "T {", "field of that name"), ("mark {", "marc {", "marc: no such file"), ("type passive; }", "type pasive; }", "passive"),
                ("velocity -2", "velocty -2", "velocity"))):
            case = shutil.copytree(first, os.path.join(self.folder, f"bad{k}"))
            path = os.path.join(case, "constant/granularProperties")
            with open(path) as f:
                text = f.read()
            self.assertIn(old, text)
            with open(path, "w") as f:
                f.write(text.replace(old, new))
            self.assertIn(words, self.said(case))
        case = shutil.copytree(first, os.path.join(self.folder, "stiff"))
        harness.edit(case, "constant/granularProperties", diffusivity=1e9)
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("lower its diffusivity", done.stdout + done.stderr)
        case = shutil.copytree(first, os.path.join(self.folder, "rest"))
        os.remove(os.path.join(case, "constant/g"))
        self.assertIn("gravity", self.said(case))
        case = shutil.copytree(first, os.path.join(self.folder, "range"))
        field(case, "phi", np.full(48, 1.5))
        self.assertIn("between 0 and 1", self.said(case))


if __name__ == "__main__":
    unittest.main()
