# SPDX-License-Identifier: GPL-3.0-or-later
"""postProcessing/run/START/run.dat, the log as a table; and the changes of mass and energy, which count from the start of the
case, after restarts, too."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.grains import test_particles
from tests.cases.segregation import mixtures

CONTROL = "system/controlDict"
GAS = ("Time step dt limiter Courant alphaMin alphaMax magUMin magUMax TMin TMax MaMin MaMax mass momentum_x momentum_y "
       "momentum_z energy massChange energyChange limitedFaces limitedCells rejectedSteps flooredCells filledCells computed "
       "bedSteps bedCells newtonIterations linearIterations clockTime cpuTime").split()
GRAINS = ("Time step dt limiter Courant T kinetic potential lost energyChange collisions wallCollisions elastic events momentum_x "
          "momentum_y momentum_z clockTime cpuTime").split()
SMALL = "Time step dt limiter Courant phiMin phiMax small smallChange solves iterations boundedFaces rejectedSteps clockTime cpuTime".split()


def path_of(case, start="0"):
    return os.path.join(case, "postProcessing", "run", start, "run.dat")


def table(case, start="0"):
    """Column names, and the rows as lists of words."""
    with open(path_of(case, start)) as f:
        head, *rows = (line.rstrip("\n").split("\t") for line in f)
    assert head[0].startswith("# ")
    return [head[0][2:], *head[1:]], rows


def column(case, name, start="0"):
    head, rows = table(case, start)
    return np.array([float(row[head.index(name)]) for row in rows])


class RunTable(harness.Folder, unittest.TestCase):
    def made(self, name, end=0.02, table="everyStep", **options):
        case = runs.make(os.path.join(self.folder, name), (24, 18, 1), end, **options)
        runs.add(case, CONTROL, f"runTable {table};\n" if table else "")
        return case

    def test_every_step(self):
        """A row for the start and each step, with the numbers of the written fields, the same on two ranks but for the seconds."""
        case, other = self.made("one"), self.made("two")
        harness.program("granularGas", "-case", case)
        harness.program("granularGas", "-case", other, ranks=2)
        head, rows = table(case)
        self.assertEqual(head, GAS)
        self.assertTrue(all(len(row) == len(GAS) for row in rows))
        self.assertEqual([row[:-2] for row in rows], [row[:-2] for row in table(other)[1]])
        self.assertEqual([int(row[1]) for row in rows], list(range(len(rows))))
        np.testing.assert_allclose(np.diff(column(case, "Time")), column(case, "dt")[1:], rtol=1e-9, atol=1e-15)
        self.assertEqual([row[3] for row in rows][:3], ["start", "deltaT_of_the_first_step", "Courant"])
        self.assertIn(rows[-1][3], ("write_time", "endTime"))
        for name in ("clockTime", "cpuTime"):
            self.assertTrue((np.diff(column(case, name)) >= 0).all())
        result = harness.haff.Case(case)
        speed = np.linalg.norm(result.field("U", "0.02"), axis=1)
        at = {"alpha": result.field("alpha", "0.02"), "T": result.field("T", "0.02"), "magU": speed}
        for name, values in at.items():
            self.assertAlmostEqual(column(case, name + "Min")[-1] / values.min(), 1, delta=1e-12)
            self.assertAlmostEqual(column(case, name + "Max")[-1] / values.max(), 1, delta=1e-12)
        volume = result.volumes
        for name, field in (("mass", "rho"), ("energy", "rhoE")):
            self.assertAlmostEqual(column(case, name)[-1] / (volume * result.field(field, "0.02")).sum(), 1, delta=1e-12)
        momentum = (volume[:, None] * result.field("rhoU", "0.02")).sum(axis=0)
        np.testing.assert_allclose([column(case, "momentum_" + k)[-1] for k in "xyz"], momentum, rtol=1e-11)

    def test_printed_steps(self):
        """Without a word in controlDict the rows are those of the log; `none` writes no table."""
        case, off = self.made("printed", table=None), self.made("off", table="none")
        runs.add(case, CONTROL, "logInterval 5;\n")
        log = harness.program("granularGas", "-case", case).stdout
        printed = [int(n) for n in re.findall(r"^Time = \S+  step (\d+)", log, flags=re.M)]
        self.assertTrue(any(n % 5 for n in printed[3:]), "the end prints, too")
        self.assertEqual(column(case, "step").tolist(), [0, *printed])
        said = re.findall(r"energy \S+ \(change (\S+)\)", log)
        self.assertEqual(said, [f"{v:+.2e}" for v in column(case, "energyChange")[1:]])
        harness.program("granularGas", "-case", off)
        self.assertFalse(os.path.exists(os.path.join(off, "postProcessing")))

    def test_seconds(self):
        """The log ends with the seconds of each part of the steps; together they are those of the run."""
        log = harness.program("granularGas", "-case", self.made("seconds")).stdout
        lines, end = re.search(r"^Seconds of the clock, rank 0\n((?: {4}.* %\n)+)end at time .* steps in (\S+) s", log, flags=re.M).groups()
        parts = dict(re.findall(r"^ {4}(.*?) +([\d.]+) s +[\d.]+ %$", lines, flags=re.M))
        self.assertLessEqual({"sources", "stages", "output"}, set(parts))
        self.assertNotIn("bed", parts)
        total = sum(float(v) for v in parts.values())
        # each number is rounded to 0.01 s
        self.assertAlmostEqual(total, float(end), delta=0.005 * (len(parts) + 1) + 0.01)
        shares = [float(v) for v in re.findall(r"([\d.]+) %$", lines, flags=re.M)]
        self.assertAlmostEqual(sum(shares), 100, delta=0.05 * len(shares) + 1e-9)

    def test_parts(self):
        """runTableParts adds a column of seconds for each part of the steps, which grow; other columns stay as they are."""
        case = self.made("parts")
        runs.add(case, CONTROL, "runTableParts yes;\n")
        harness.program("granularGas", "-case", case)
        head, rows = table(case)
        self.assertEqual(head[:len(GAS)], GAS)
        self.assertLessEqual({"seconds_sources", "seconds_stages", "seconds_border_of_the_bed"}, set(head[len(GAS):]))
        self.assertTrue(all(len(row) == len(head) for row in rows))
        spent = sum(column(case, name) for name in head[len(GAS):])
        self.assertTrue((np.diff(spent) >= 0).all())
        self.assertLessEqual(spent[-1], column(case, "clockTime")[-1] + 0.0005 * len(head))

    def test_restart(self):
        """The rows of a stopped run and of the run after it are those of one that went through, also the changes since the
        start of the case, except what is counted for each run."""
        case = self.made("through", interval=0.01)
        harness.program("granularGas", "-case", case)
        part = runs.until(case, case + "_part", "0.01")
        harness.program("granularGas", "-case", part, ranks=2)
        runs.same(self, runs.contents(case + "/0.02"), runs.contents(part + "/0.02"))
        head, whole = table(case)
        again, rest = table(part, "0.01")
        self.assertEqual(head, again)
        keep = [i for i, name in enumerate(head) if name not in ("computed", "clockTime", "cpuTime")]
        rows = [[row[i] for i in keep] for row in whole[-len(rest):]]
        self.assertEqual([[row[i] for i in keep] for row in rest[1:]], rows[1:])
        self.assertEqual((rest[0][0], rest[0][1], rest[0][3]), (rows[0][0], rows[0][1], "start"))
        self.assertEqual(rest[0][5:20], rows[0][5:20])
        self.assertLess(column(part, "energyChange", "0.01")[0], -0.01)

    def test_heated(self):
        """Gas that starts almost without energy and falls: the change stays below 1, where that relative to the start is 1e10."""
        case = os.path.join(self.folder, "cold")
        n, size = np.array((1, 30, 1)), np.array((0.1, 3, 0.1))
        ones = np.ones(30)
        harness.box_case(case, n, size, 100 * ones, np.zeros((30, 3)), 1e-9 * ones, 0.05, gravity=(0, -20.0, 0), e=0.9, cooling="Haff")
        log = harness.program("granularGas", "-case", case).stdout
        change, energy = column(case, "energyChange"), column(case, "energy")
        self.assertGreater(energy[-1] / energy[0], 1e9)
        self.assertTrue(((change >= 0) & (change < 1)).all())
        np.testing.assert_allclose(change, 1 - energy[0] / energy, rtol=1e-12, atol=1e-15)
        self.assertIn("(change +1.00e+00)", log)

    def test_bad_totals(self):
        case = self.made("bad", interval=0.01)
        harness.program("granularGas", "-case", case)
        harness.edit(case, CONTROL, endTime=0.03)
        os.remove(case + "/0.02/uniform/checksums")
        harness.edit(case, "0.02/uniform/totals", energy=-1)
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"0\.02/uniform/totals:\d+: .*not negative")

    def test_not_writable(self):
        """A table that cannot be opened ends the run with its name, as any other."""
        case = self.made("full")
        os.makedirs(os.path.dirname(path_of(case)))
        os.symlink("/dev/full", path_of(case))
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("postProcessing/run/0/run.dat", done.stderr)

    def test_grains(self):
        case = test_particles.make(os.path.join(self.folder, "grains"), end=2)
        runs.add(case, CONTROL, "runTable everyStep;\n")
        test_particles.solve(case)
        head, rows = table(case)
        self.assertEqual(head, GRAINS)
        self.assertTrue((np.diff(column(case, "collisions")) >= 0).all())
        self.assertGreater(column(case, "collisions")[-1], 0)
        self.assertLess(abs(column(case, "energyChange")).max(), 1e-9)
        self.assertTrue((column(case, "Courant") == 0).all())


class SmallGrains(mixtures.Mixture, unittest.TestCase):
    def test_restart(self):
        """The content of small grains drifts by round-off, counted from the start of the case."""
        case = self.case("segregationLinear", 51, {"value": 0.02}, endTime=0.1, deltaT=1e-3, writeInterval=0.05)
        runs.add(case, CONTROL, "runTable everyStep;\n")
        self.run_case(case)
        part = runs.until(case, case + "_part", "0.05")
        self.run_case(part)
        self.assertEqual(table(case)[0], SMALL)
        values = harness.haff.Case(case).field("phi", "0.1")
        self.assertAlmostEqual(column(case, "phiMin")[-1], values.min(), 12)
        self.assertAlmostEqual(column(case, "phiMax")[-1], values.max(), 12)
        change = column(case, "smallChange")
        self.assertLess(abs(change).max(), 1e-13)
        self.assertTrue((change[-50:] == column(part, "smallChange", "0.05")[1:]).all())


if __name__ == "__main__":
    unittest.main()
