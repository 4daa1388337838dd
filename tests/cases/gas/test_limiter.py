# SPDX-License-Identifier: GPL-3.0-or-later
"""What keeps states admissible, and what a run says of it: log, postProcessing/limiter, the field `limited`."""
import os
import random
import re
import shutil
import signal
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes

CONTROL = "system/controlDict"
N, SIZE = (48, 36, 1), (4.8, 3.6, 0.1)


class Limiter(harness.Folder, unittest.TestCase):
    def shot(self, name, engine, end, mach=80, **options):
        """Dense lumps fly at high Mach numbers through a near vacuum, collide and hit walls."""
        at = boxes.centres(N, SIZE)
        lump = sum(((np.abs(at[:, 0] - x) < 0.6) & (np.abs(at[:, 1] - y) < 0.7)) for x, y in ((1.2, 1.8), (3.6, 2.0))) > 0
        rho, T = np.where(lump, 800.0, 1e-5), 1.0 + np.sin(3 * at[:, 0]) * np.cos(2 * at[:, 1]) / 2
        u = np.outer(np.where(lump, np.where(at[:, 0] < 2.4, mach, -mach), 0), (1, 0.1, 0))
        nu = rho * np.pi / 6 * 1e-3
        x = (nu / 0.65) ** (4 * 0.65 / 3)
        p = rho * T * (1 + 2 * (1 + 0.9) * nu / (1 - x))
        case = harness.box_case(os.path.join(self.folder, name), N, SIZE, rho, u, p, end, e=0.9, cooling="Haff",
                                slip=("xLow", "xHigh", "yLow", "yHigh"), interval=end / 2, **options)
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        return case

    def table(self, case):
        return np.loadtxt(os.path.join(case, "postProcessing", "limiter", "0", "limiter.dat"), ndmin=2)

    def test_what_is_said(self):
        """Log, table and field tell the same; the bits are those of two ranks and of a restart; mass stays."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                end = 0.01
                case = self.shot(engine, engine, end)
                pair = shutil.copytree(case, case + "_ranks")
                log = harness.program("granularGas", "-case", case).stdout
                result, table = harness.haff.Case(case), self.table(case)
                self.assertGreater(table[:, 2].sum(), 0)
                self.assertEqual(result.field("limited").sum(), table[:, 2].sum())
                self.assertTrue((table[:, 3] <= 4 * table[:, 2]).all())
                said = re.findall(r"limited: .*\(in all (\d+) faces, (\d+) cells\)", log)[-1]
                self.assertEqual((int(said[0]), int(said[1])), (table[:, 3].sum(), table[:, 2].sum()))
                rejected = re.findall(r"rejected: .*\(in all (\d+)\)", log) or ["0"]
                self.assertEqual(int(rejected[-1]), table[:, 4].sum())
                at = table[table[:, 2] > 0, 7:9]
                cells = np.round(at / 0.1 - 0.5).astype(int) @ (1, N[0])
                self.assertTrue((result.field("limited")[cells] > 0).all())
                mass = result.field("rho").sum() / result.field("rho", "0").sum() - 1
                self.assertLess(abs(mass), 1e-12)
                harness.program("granularGas", "-case", pair, ranks=2)
                runs.same(self, runs.results(case), runs.results(pair))
                again = runs.until(case, case + "_again", end / 2)
                harness.program("granularGas", "-case", again)
                runs.same(self, runs.contents(case + "/0.01"), runs.contents(again + "/0.01"))

    def rows(self, case):
        """Of all starts, without heads."""
        folder = os.path.join(case, "postProcessing", "limiter")
        starts = sorted(os.listdir(folder), key=float) if os.path.isdir(folder) else []
        found = []
        for start in starts:
            with open(os.path.join(folder, start, "limiter.dat")) as f:
                found += [line for line in f if line[0] != "#"]
        return found

    def test_interrupts(self):
        """With transport, on both engines, one with a density floor: stopped and taken up six times, on one and two
        ranks, at times written and in between: the rows, the field and the counts are those of a run that went through."""
        chance = random.Random(3)
        for engine, floor in (("polyhedral", False), ("lattice", True)):
            with self.subTest(engine, floor=floor):
                fast = engine == "polyhedral"
                end = 0.0005 if fast else 0.004
                case = self.shot(f"interrupts_{engine}{floor}", engine, end, mach=2000 if fast else 80)
                runs.conduct(case)
                harness.edit(case, CONTROL, writeInterval=end / 4)
                runs.add(case, CONTROL, "stopAt endTime; logInterval 1;\n")
                if floor:
                    runs.add(case, "system/fvSolution", "limits { alphaFloor 1e-9; }\n")
                part = shutil.copytree(case, case + "_part")
                harness.program("granularGas", "-case", case)
                steps = len(self.rows(case))
                self.assertGreater(steps, 3)
                for k in range(6):
                    harness.edit(part, CONTROL, stopAt="nextWrite" if k % 2 else "endTime")
                    if k % 2:
                        harness.program("granularGas", "-case", part, ranks=1 + k // 2 % 2)
                    else:
                        self.stopped(part, chance.randrange(1, 6))
                harness.edit(part, CONTROL, stopAt="endTime")
                harness.program("granularGas", "-case", part)
                self.assertGreater(len(os.listdir(os.path.join(part, "postProcessing", "limiter"))), 1)
                self.assertEqual(self.rows(case), self.rows(part))
                for name in runs.times(case)[1:]:
                    runs.same(self, runs.contents(os.path.join(case, name)), runs.contents(os.path.join(part, name)), name)

    def stopped(self, case, steps):
        """A run that stops after a given number of steps."""
        going = subprocess.Popen([os.path.join(harness.BIN, "granularGas"), "-case", case], stdout=subprocess.PIPE, text=True)
        for line in going.stdout:
            steps -= line.startswith("Time =")
            if not steps:
                going.send_signal(signal.SIGTERM)
                break
        going.communicate(timeout=60)
        self.assertEqual(going.returncode, 0)

    def test_burst(self):
        """A disk of gas bursts into next to nothing. Rusanov on 320 x 320 cells, has u up to 25.1 and T up to 191."""
        n, size = (80, 80, 1), (2.0, 2.0, 0.025)
        at = boxes.centres(n, size) - 1
        rho = np.where(np.hypot(at[:, 0], at[:, 1]) < 0.3, 600.0, 2e-6)
        for reconstruct in ("PHM", "WPENO5"):
            case = harness.box_case(os.path.join(self.folder, reconstruct), n, size, rho, np.zeros((6400, 3)), 20 * rho, 0.05, eos="perfectGas",
                                    reconstruct=reconstruct)
            runs.add(case, CONTROL, "runTable everyStep;\n")
            harness.program("granularGas", "-case", case)
            table = harness.haff.Case(case).table("run", frame=True)
            self.assertLess(table["magUMax"].max(), 1.25 * 25.1, reconstruct)
            self.assertLess(table["TMax"].max(), 1.25 * 191, reconstruct)

    def test_density_floor(self):
        """Lumps fly apart in a gas on the floor: told, counted, the same on two ranks and after a restart."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                end, floor = 0.006, 5e-9
                case = self.shot(engine + "Floor", engine, end)
                above = shutil.copytree(case, case + "_above")
                runs.add(case, "system/fvSolution", f"limits {{ alphaFloor {floor}; }}\n")
                pair = shutil.copytree(case, case + "_ranks")
                log = harness.program("granularGas", "-case", case).stdout
                result, table = harness.haff.Case(case), self.table(case)
                self.assertGreaterEqual(result.field("rho").min(), floor / (np.pi / 6 * 1e-3) * (1 - 1e-12))
                said = re.findall(r"density floor: .*\(in all (\d+), \+(\S+), \+(\S+)\)", log)[-1]
                self.assertEqual(int(said[0]), table[:, 10].sum())
                for i in (1, 2):
                    self.assertAlmostEqual(float(said[i]) / table[:, 10 + i].sum(), 1, delta=1e-2)
                gained = (result.field("rho").sum() - result.field("rho", "0").sum()) * 1e-3
                whole = result.field("rho").sum() * 1e-3
                self.assertLess(abs(gained - table[:, 11].sum()), 1e-12 * whole)
                harness.program("granularGas", "-case", pair, ranks=2)
                runs.same(self, runs.results(case), runs.results(pair))
                again = runs.until(case, case + "_again", end / 2)
                harness.program("granularGas", "-case", again)
                runs.same(self, runs.contents(os.path.join(case, str(end))), runs.contents(os.path.join(again, str(end))))
                runs.add(above, "system/fvSolution", "limits { alphaFloor 1e-8; }\n")
                self.assertIn("alphaFloor", harness.program("granularGas", "-case", above, check=False).stderr)

    def test_smooth_flow_says_nothing(self):
        case = runs.make(os.path.join(self.folder, "calm"), (40, 30, 1), 0.01)
        log = harness.program("granularGas", "-case", case).stdout
        self.assertNotRegex(log, "limited:|rejected|floor")
        self.assertEqual(os.listdir(os.path.join(case, "postProcessing")), ["run"])
        self.assertFalse(os.path.exists(os.path.join(case, "0.01", "limited")))

    def test_round_off_floor(self):
        """A beam at Mach 4e6 cools until its internal energy is lost in the total: raised, counted and told."""
        size = (48e3, 36e3, 1e3)
        at = boxes.centres(N, size)
        u = np.outer(np.full(len(at), 3e6), (1, 0, 0))
        rho = np.where(at[:, 0] < 24e3, 800.0, 700.0)
        kinetic = 0.5 * rho * (u ** 2).sum(axis=1)
        T = 1.05e-13 * kinetic / rho / 1.5
        nu = rho * np.pi / 6 * 1e-3
        p = rho * T * (1 + 2 * nu / (1 - (nu / 0.65) ** (4 * 0.65 / 3)))
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                case = harness.box_case(os.path.join(self.folder, engine + "floor"), N, size, rho, u, p, 5e-3, e=0.0,
                                        cooling="Haff")
                runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
                log = harness.program("granularGas", "-case", case).stdout
                table = self.table(case)
                floored, energy = table[:, 5].sum(), table[:, 6].sum()
                self.assertGreater(floored, 0)
                said = re.findall(r"round-off floor: .*\(in all (\d+), \+(\S+)\)", log)[-1]
                self.assertEqual(int(said[0]), floored)
                self.assertAlmostEqual(float(said[1]) / energy, 1, delta=1e-2)
                self.assertGreater(energy, 0)
                self.assertLess(energy, 2.1e-13 * floored * kinetic.max() * 1e9)
                self.assertGreater(harness.haff.Case(case).field("T").min(), 0.9 * T.min())
                if engine == "polyhedral":
                    continue
                whole = shutil.copytree(case, case + "_whole", ignore=shutil.ignore_patterns("0.[0-9]*", "postProcessing"))
                runs.add(whole, "system/fvSolution", "skipUniform no;\n")
                harness.program("granularGas", "-case", whole)
                runs.same(self, runs.results(case), runs.results(whole))


if __name__ == "__main__":
    unittest.main()
