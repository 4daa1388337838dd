# SPDX-License-Identifier: GPL-3.0-or-later
"""What controlDict says about writing, stopping and starting, seen in the folders of small runs; the log's figures."""
import os
import re
import shutil
import subprocess
import time
import unittest

import numpy as np

from tests.cases import harness, runs
from studies.exact.eos import of_case

GAS = os.path.join(harness.BIN, "granularGas")
CONTROL = "system/controlDict"


class Control(harness.Folder, unittest.TestCase):
    def make(self, name, n=(60, 1, 1), end=0.02, **options):
        return runs.make(os.path.join(self.folder, name), n, end, **options)

    def run_case(self, case, **control):
        if control:
            harness.edit(case, CONTROL, **control)
        return harness.program("granularGas", "-case", case).stdout

    def stamp(self, case, name):
        with open(os.path.join(case, name, "uniform", "time")) as f:
            text = f.read()
        return {k: float(re.search(rf"^{k} +([^;]+);", text, re.M).group(1)) for k in ("value", "index", "deltaT")}

    def test_time_step(self):
        case = self.make("steps", adjust="no", step=1e-3, control="timeStep", interval=4)
        self.run_case(case)
        self.assertEqual(runs.times(case), ["0", "0.004", "0.008", "0.012", "0.016", "0.02"])
        self.assertEqual(self.stamp(case, "0.012"), {"value": np.cumsum(np.full(12, 1e-3))[-1], "index": 12, "deltaT": 1e-3})

    def test_run_time_and_adjustable(self):
        """runTime: the first step beyond each multiple; adjustable: on it, and endTime though it is none."""
        case = self.make("runTime", adjust="no", step=3e-4, control="runTime", interval=1e-3, end=3.2e-3)
        self.run_case(case)
        self.assertEqual(runs.times(case), ["0", "0.0012", "0.0021", "0.003", "0.0032"])
        case = self.make("adjustable", interval=1e-3, end=3.2e-3)
        self.run_case(case)
        self.assertEqual(runs.times(case), ["0", "0.001", "0.002", "0.003", "0.0032"])
        self.assertEqual(self.stamp(case, "0.003")["value"], 3 * 1e-3)

    def test_clocks(self):
        """A write each fifth of a second of clock or processor time."""
        for kind in ("clockTime", "cpuTime"):
            case = self.make(kind, n=(80, 60, 1), end=1e3, control=kind, interval=0.2)
            begin = time.monotonic()
            run = subprocess.Popen([GAS, "-case", case], stdout=subprocess.PIPE, text=True)
            written = 0
            for line in run.stdout:
                written += line.startswith("    written")
                if written == 6:
                    break
            run.terminate()
            written += len(re.findall("^    written", run.communicate(timeout=60)[0], re.M))
            with self.subTest(kind):
                self.assertLessEqual(written - 2, (time.monotonic() - begin) / 0.2)  # without the last, which the signal makes
                self.assertEqual(len(runs.times(case)), written + 1)

    def test_purge(self):
        case = self.make("purge", adjust="no", step=1e-3, control="timeStep", interval=2)
        runs.add(case, CONTROL, "purgeWrite 3; writeProcessors yes;\n")
        self.run_case(case)
        self.assertEqual(runs.times(case), ["0", "0.016", "0.018", "0.02"])
        self.assertEqual(runs.times(case + "/processor0"), ["0.016", "0.018", "0.02"])

    def test_start_and_stop(self):
        case = self.make("start", interval=5e-3)
        self.run_case(case)
        names = runs.times(case)
        whole = runs.contents(os.path.join(case, "0.02"))
        for start, keyword in ((0, "firstTime"), (0.01, "startTime"), (0.01, "latestTime")):
            with self.subTest(keyword):
                part = runs.until(case, case + keyword, 0.01)
                text = self.run_case(part, startFrom=keyword, startTime=start)
                self.assertIn(f"from time {start:g} ", text)
                self.assertEqual(runs.times(part), names)
                runs.same(self, whole, runs.contents(os.path.join(part, "0.02")))
        self.assertIn("nothing to do", self.run_case(case, startFrom="latestTime"))
        part = runs.until(case, case + "no", 0.01)
        self.run_case(part, stopAt="noWriteNow")
        self.assertEqual(runs.times(part), ["0", "0.005", "0.01"])
        self.run_case(part, stopAt="writeNow")
        self.assertEqual(len(runs.times(part)), 4)
        self.assertEqual(self.stamp(part, runs.times(part)[-1])["index"], self.stamp(part, "0.01")["index"] + 1)

    def test_names_are_told_apart(self):
        """Steps smaller than the last digit of the names get more digits, and a restart goes on with them."""
        case = self.make("names", adjust="no", step=1e-6, control="timeStep", interval=1, end=1.000006, format="ascii")
        os.rename(case + "/0", case + "/1")
        harness.edit(case, CONTROL, startTime=1, timePrecision=3)
        text = self.run_case(case)
        self.assertIn("timePrecision 3 would give two times the name of one; it is now 7", text)
        names = ["1"] + ["1.00000%d" % k for k in range(1, 7)]
        self.assertEqual(runs.times(case), names)
        part = runs.until(case, case + "_part", "1.000003")
        self.run_case(part)
        self.assertEqual(runs.times(part), names)
        runs.same(self, runs.contents(case + "/1.000006"), runs.contents(part + "/1.000006"))
        fixed = self.make("fixed", adjust="no", step=1e-3, control="timeStep", interval=5)
        self.run_case(fixed, timeFormat="fixed", timePrecision=3)
        self.assertEqual(runs.times(fixed), ["0", "0.005", "0.010", "0.015", "0.020"])

    def test_modified_while_it_runs(self):
        """A wrong controlDict gives a message and is ignored, a new maxCo is used, a nearer endTime ends the run there."""
        case = self.make("modified", n=(40, 30, 1), end=1e3, e=1.0, cooling="none")
        harness.edit(case, CONTROL, runTimeModifiable="yes")
        run = subprocess.Popen([GAS, "-case", case], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        seen = []

        def read(until):
            for line in run.stdout:
                seen.append(line)
                if re.search(until, line):
                    return line
            self.fail(f"no line {until}:\n{''.join(seen[-20:])}{run.stderr.read()}")

        read(r"Courant 0\.5000")
        harness.edit(case, CONTROL, maxCo=7)
        read("has changed but is wrong")
        harness.edit(case, CONTROL, maxCo=0.25)
        read("read again")
        first, second = (float(re.search(r"Time = (\S+)", read(r"Courant 0\.2500")).group(1)) for _ in range(2))
        end = round(second + 2 * (second - first), 6)  # entries come once a second, the file is read after half of one
        harness.edit(case, CONTROL, endTime=end)
        read(f"end at time {end}:")
        self.assertEqual(run.wait(60), 0)
        self.assertIn("maxCo", run.stderr.read())
        run.stdout.close()
        run.stderr.close()
        self.assertEqual(runs.times(case)[-1], str(end))

    @unittest.skipUnless(shutil.which("foamToVTK"), "OpenFOAM is not installed")
    def test_ascii_for_openfoam(self):
        import meshio
        case = self.make("ascii", n=(40, 30, 1), hole=True, format="ascii", digits=8, compression="on")
        self.run_case(case)
        done = subprocess.run(["foamToVTK", "-case", case, "-latestTime", "-name", "VTK_of"], capture_output=True, text=True,
                              env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
        self.assertEqual(done.returncode, 0, done.stdout[-1000:] + done.stderr[-1000:])
        (folder,) = [f for f, _, names in os.walk(case + "/VTK_of") if "internal.vtu" in names]
        read = meshio.read(os.path.join(folder, "internal.vtu"))
        for name in runs.FIELDS:
            np.testing.assert_allclose(np.concatenate(read.cell_data[name]), harness.haff.Case(case).field(name, "0.02"),
                                       rtol=1e-6, err_msg=name)

    def test_log(self):
        """Totals and drift of the log against the written fields; what limits the step, and where; time left."""
        case = self.make("log", n=(40, 30, 1), end=0.05, interval=0.025, e=1.0, cooling="none")
        text = self.run_case(case)
        result = harness.haff.Case(case)
        rho, rho_u, energy = (result.field(f, "0.05").T * 1e-3 for f in ("rho", "rhoU", "rhoE"))
        last = text[text.index("Time = 0.05 "):]
        mass, drift = map(float, re.search(r"mass (\S+) \(drift (\S+)\)", last).groups())
        self.assertAlmostEqual(mass / rho.sum(), 1, delta=1e-9)
        self.assertLess(abs(drift), 1e-13)
        momentum = [float(v) for v in re.search(r"momentum \(([^)]*)\)", last).group(1).split()]
        np.testing.assert_allclose(momentum, rho_u.sum(axis=1)[:2], rtol=1e-5)
        total, change = map(float, re.search(r"energy (\S+) \(change (\S+)\)", last).groups())
        self.assertAlmostEqual(total / energy.sum(), 1, delta=1e-9)
        start = (result.field("rho", "0") * (result.field("U", "0") ** 2).sum(axis=1) / 2).sum() * 1e-3
        start += 1.5 * (result.field("p", "0") / of_case(result).p(result.field("rho", "0"), 1.0)
                        * result.field("rho", "0")).sum() * 1e-3
        self.assertAlmostEqual(change, (energy.sum() - start) / max(energy.sum(), start), delta=0.006 * abs(change))  # three digits are printed
        self.assertRegex(text, r"deltaT = \S+ \(limited by: Courant, cell at \(\d\S* \d\S* \d\S*\) with alpha = \d\S*, T = \d\S*, c = \d\S*\)  Courant 0\.5000")
        self.assertRegex(text, r"limited by: (write time|endTime)")
        self.assertRegex(text, r"ETA \d")
        self.assertRegex("\n".join(text.splitlines()[-2:]), r"^end at time 0\.05: \d+ steps in .*\n1 warning: fewGrains$")


if __name__ == "__main__":
    unittest.main()
