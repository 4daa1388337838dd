# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse and short forms of the cases settlingColumn, heap2D and hopper, with implicit acoustics: as many steps as the flow needs, the
centre of mass of explicit steps, mass, packing as a bound, and the same bits on two ranks, after a restart and under a budget."""
import os
import random
import re
import shutil
import signal
import subprocess
import time
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.runtime import test_energyBudget as audit

PACKING = 0.64
GAS = os.path.join(harness.BIN, "granularGas")


class Dense:
    """What holds for all of them. Each has: name, cells, end (s), most (steps of the implicit run), less (times fewer than explicit ones),
    near (m: of the centres of mass), closed (does no mass leave?); shipped: cells and end of its short entries."""

    def make(self, acoustics="implicit", end=None):
        case = harness.copy(self.name, self.folder)
        harness.mesh(case, self.cells)
        with open(case + "/system/fvSolution") as f:
            text = f.read()
        with open(case + "/system/fvSolution", "w") as f:
            f.write(re.sub(r"type \w+;", f"type {acoustics};", text, count=1))
        harness.edit(case, "system/controlDict", endTime=end or self.end, writeInterval=self.end / 10)
        return case

    def steps(self, case, ranks=1):
        """Runs it and returns its steps."""
        done = harness.program("granularGas", "-case", case, ranks=ranks)
        return int(re.search(r"^end at time .*: (\d+) steps", done.stdout, re.M).group(1))

    def centre(self, case):
        case = harness.haff.Case(case)
        mass = case.field("alpha", case.times[-1]) * case.volumes
        return mass @ case.centres / mass.sum()

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        test = cls()
        cls.case = test.make()
        cls.count = test.steps(cls.case)

    def test_expected(self):
        own = self.shipped == (self.cells, self.end)
        case = harness.haff.Case(self.case) if own else self.short(self.name, self.shipped[0], endTime=self.shipped[1])
        self.compare(case, harness.entries(self.name))

    def test_beside_explicit(self):
        """Fewer steps, and the gas lies where it does with explicit ones."""
        other = self.make("explicit")
        steps = self.steps(other)
        self.assertLess(self.count, self.most)
        self.assertGreater(steps, self.less * self.count)
        np.testing.assert_allclose(self.centre(self.case), self.centre(other), atol=self.near, rtol=0)

    def test_bounds(self):
        """Packed, but below packing; T > 0; no mass is lost where none can leave."""
        result, most, masses = harness.haff.Case(self.case), 0, []
        for t in result.times[1:]:
            alpha = result.field("alpha", t)
            most = max(most, alpha.max())
            masses.append(alpha @ result.volumes)
            self.assertGreater(min(alpha.min(), result.field("T", t).min()), 0)
        self.assertTrue(0.98 * PACKING < most < PACKING, most)
        if self.closed:
            self.assertLess(abs(masses[-1] / masses[0] - 1), 1e-12)
        else:
            self.assertLess(masses[-1], masses[0])

    def test_going_on(self):
        """From the last time but one on, by two ranks and under a budget, which closes: the bits of one rank that went through without."""
        late, last = runs.times(self.case)[-2:]
        other = runs.until(self.case, self.case + "_late", late)
        audit.ask(other)
        self.steps(other, ranks=2)
        runs.same(self, runs.contents(f"{self.case}/{last}"), {k: v for k, v in runs.contents(f"{other}/{last}").items() if "udget" not in k})
        b = audit.budget(harness.haff.Case(other))
        scale = max(np.abs(b[name]).max() for name in audit.COLUMNS[5:12])
        self.assertLess(np.abs(b["residual"]).max(), 1e-12 * scale)


class SettlingColumn(Dense, harness.Folder, unittest.TestCase):
    name, cells, end, most, less, near, closed = "settlingColumn", 16, 0.3, 450, 50, 2.5e-5, True
    shipped = 40, 3.91


class Heap(Dense, harness.Folder, unittest.TestCase):
    name, cells, end, most, less, near, closed = "heap2D", 32, 0.03, 320, 1.4, 6e-5, True
    shipped = 32, 0.03


class Hopper(Dense, harness.Folder, unittest.TestCase):
    name, cells, end, most, less, near, closed = "hopper", 24, 0.02, 105, 4, 2e-5, False
    shipped = 32, 0.06


class Dealt(harness.Folder, unittest.TestCase):
    """The bed of heap2D, which ranks deal among each other, also to those that have no cells of the mesh."""

    def killed(self, case, ranks):
        """Runs the case until 0.018 s are written, and kills one of its ranks in a later step."""
        run = subprocess.Popen([os.path.join(harness.BIN, "mpirun"), "-np", str(ranks), GAS, "-case", case], stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
        for line in run.stdout:
            if "written: 0.018" in line:
                break
        time.sleep(0.05 * random.random())
        pids = harness.processes("granularGas", case)
        self.assertEqual(len(pids), ranks)
        os.kill(random.choice(pids), signal.SIGKILL)
        run.communicate(timeout=60)
        self.assertNotEqual(run.returncode, 0)
        for later in runs.times(case):
            if float(later) > 0.018:
                shutil.rmtree(os.path.join(case, later))

    def test_killed_while_dealt(self):
        """A rank is killed; taken up from what was written, on as many ranks, the run has the bits of one rank that went on. All begin
        from 0.0175 s of that rank: the first implicit steps come later."""
        whole = harness.copy("heap2D", self.folder)
        harness.mesh(whole, 64)
        harness.edit(whole, "system/controlDict", endTime=0.0185, writeInterval=0.0005)
        log = harness.program("granularGas", "-case", whole).stdout
        self.assertGreater(sum(map(int, re.findall(r"implicit acoustics: (\d+) steps", log))), 8)
        for ranks in (2, 4):
            with self.subTest(ranks=ranks):
                case = runs.until(whole, f"{whole}_{ranks}", 0.0175)
                harness.edit(case, "system/controlDict", endTime=1)
                self.killed(case, ranks)
                harness.edit(case, "system/controlDict", endTime=0.0185)
                log = harness.program("granularGas", "-case", case, ranks=ranks).stdout
                self.assertIn("implicit acoustics", log)
                runs.same(self, runs.contents(whole + "/0.0185"), runs.contents(case + "/0.0185"))


if __name__ == "__main__":
    unittest.main()
