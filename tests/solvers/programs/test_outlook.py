# SPDX-License-Identifier: GPL-3.0-or-later
"""What checkCase and the log of a run foretell: narrow cells, steps without number, and ranks without work."""
import os
import re
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs

CELLS = 10  # 0.1 wide


class Outlook(harness.Folder, unittest.TestCase):
    def make(self, name, end, **options):
        return runs.make(os.path.join(self.folder, name), (CELLS, 1, 1), end, e=1.0, cooling="none", **options)

    def narrow(self, name, width):
        """A line of cells of which one is `width` wide, and the next as much wider."""
        case = self.make(name, 1.0)
        path = os.path.join(case, "constant", "polyMesh", "points")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(re.sub(r"\(0\.5\d* ", f"({0.4 + width!r} ", text))
        runs.add(case, "system/fvSchemes", "polyReconstruct CWENO3;\n")
        return case

    def test_narrow_cells(self):
        """V/A below 1e-6 of the median is warned of by checkCase, below 1e-12 refused by all programs. On a line V/A is half of the
        width: empty faces do not count."""
        even = harness.program("checkCase", self.narrow("even", 1e-4)).stdout
        self.assertNotIn("narrowCell", even)
        self.assertIn("The case can be run", even)
        said = harness.program("checkCase", self.narrow("narrow", 5e-8)).stdout
        found = re.search(r"warning: .*constant/polyMesh: cell 4 at \(0.4 0.05 0.05\) has V/A = (\S+) m, (\S+) of the median", said)
        self.assertAlmostEqual(float(found.group(1)), 2.5e-8, delta=1e-10)
        self.assertAlmostEqual(float(found.group(2)), 5e-7, delta=1e-9)
        self.assertRegex(said, "The case can be run, with \\d+ warnings: .*\\bnarrowCell ")
        case = self.narrow("flat", 5e-14)
        for command in (["checkCase", case], ["granularGas", "-case", case]):
            done = harness.program(*command, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, r"cell 4 at \(0.4, 0.05, 0.05\) has V/A = 2.5\S*e-14 m, 5\S*e-13 of the median(.|\n)*make the mesh even")

    def log_until(self, case, wanted, ranks=1):
        """The log of a run up to a line, where the run is stopped."""
        command = [os.path.join(harness.BIN, "mpirun"), "-np", str(ranks), os.path.join(harness.BIN, "granularGas"), "-case", case]
        run, seen = subprocess.Popen(command, stdout=subprocess.PIPE, text=True), []
        for line in run.stdout:
            seen.append(line)
            if re.search(wanted, line):
                break
        run.terminate()
        rest = run.communicate(timeout=60)[0]
        return "".join(seen), rest

    NOTE = r"    note: (\S+) steps from t = (\S+) to endTime (\S+) at deltaT = (\S+) s(, \S+ times as many as the first step foretold)?\n" \
           r"      deltaT is limited by: Courant, cell at \(\S+ \S+ \S+\) with alpha = \S+, T = \S+, c = \S+\n      (.*)\n"

    def test_idle_ranks(self):
        """More ranks than tiles, or than blocks of polyhedra, are warned of with both numbers, by a run and by its check; -strict refuses them."""
        for engine, part in (("lattice", "tile of at most 60 cells a side"), ("polyhedral", "block of some 500 cells")):
            case = self.make(engine, 0.01)
            runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
            runs.add(case, "system/controlDict", "acceptWarnings (unusedScheme);\n")
            self.assertNotIn("idleRanks", harness.program("granularGas", "-case", case, "-dry-run").stdout)
            for words, code in ((["-dry-run"], 0), ([], 0), (["-strict", "-dry-run"], 1)):
                done = harness.program("granularGas", "-case", case, *words, ranks=3, check=False)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                self.assertRegex(done.stdout + done.stderr, f"constant/polyMesh: the mesh of 10 cells is dealt to the ranks in 1 {part}: "
                                 "2 of 3 ranks have nothing to do; give  -np 1  at most")
                self.assertEqual((done.stdout + done.stderr).count("2 of 3 ranks"), 1)

    def test_far_too_many_ranks(self):
        """mpirun refuses a thousand ranks for each processor before it starts them; so does every rank that another mpirun has started,
        but one of them alone says so. Ranks on other machines are not counted."""
        many = str(1000 * os.cpu_count())
        case = self.make("many", 0.01)
        gas = os.path.join(harness.BIN, "granularGas")
        started = lambda *words: subprocess.run([os.path.join(harness.BIN, "mpirun"), *words, gas, "-case", case], capture_output=True, text=True)
        for words in (("-np", many), ("--bind-to", "none", "-n", many)):
            done = started(*words)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertRegex(done.stderr, f"^error: mpirun -np {many}: more than 64 ranks for each of the \\d+ processors .* say  -np {os.cpu_count()};")
        self.assertNotIn("more than 64", started("-np", many, "-hostfile", os.path.join(self.folder, "none")).stderr)
        for rank, said in ((0, f"error: -np {many}: this machine has "), (5, "")):
            alone = {**os.environ, "OMPI_COMM_WORLD_LOCAL_SIZE": many, "OMPI_COMM_WORLD_RANK": str(rank)}
            done = subprocess.run([gas, "-case", case], capture_output=True, text=True, env=alone)
            self.assertEqual(done.returncode, 1)
            self.assertTrue(done.stderr.startswith(said) and bool(done.stderr) == bool(said), done.stderr)
        self.assertEqual(sorted(os.listdir(case)), ["0", "constant", "system"])

    def test_mpirun_of_another_haff(self):
        """The mpirun of another version is passed over where PATH has both: each would call the other one for ever."""
        own, other = os.path.join(harness.BIN, "mpirun"), os.path.join(self.folder, "mpirun")
        with open(own, encoding="utf-8") as file, open(other, "w", encoding="utf-8") as copy:
            copy.write(file.read() + "# of another version\n")
        os.chmod(other, 0o755)
        path = {**os.environ, "PATH": ":".join((self.folder, harness.BIN, os.environ["PATH"]))}
        for first in (own, other):
            done = subprocess.run([first, "-np", "2", os.path.join(harness.BIN, "granularGas"), "-version"], capture_output=True, text=True, env=path, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_more_ranks_than_processors(self):
        """The log says so, once; as many ranks as processors are not spoken of."""
        case, n = self.make("crowded", 0.01), os.cpu_count()
        for ranks, said in ((n, []), (n + 1, [f"{n + 1} ranks share {n} processor"])):
            done = harness.program("granularGas", "-case", case, "-dry-run", ranks=ranks)
            self.assertEqual(re.findall(r"^\d+ ranks share \d+ processor", done.stdout, re.M), said)

    def test_the_first_step(self):
        """A first step that foretells more than a million is spoken of by checkCase and in the log, in the same words."""
        said = harness.program("checkCase", self.make("short", 100.0)).stdout
        self.assertNotIn("note:", said)
        said = re.search(self.NOTE, harness.program("checkCase", self.make("long", 2e4)).stdout)
        self.assertGreater(float(said.group(1)), 1e6)
        for ranks in (1, 2):
            case = self.make(f"long{ranks}", 2e4)
            log, rest = self.log_until(case, "larger cells there", ranks)
            self.assertEqual(re.search(self.NOTE, log).group(), said.group())
            self.assertNotIn("note:", rest)

    def test_steps_without_end(self):
        """More than 1e7 steps are a warning, of checkCase and of a run, with the line of endTime and what limits the step, in place of the note."""
        case = self.make("endless", 1e6)
        wanted = r"warning: .*/system/controlDict:\d+: endTime 1e\+06 is (\S+) steps away at deltaT = \S+ s, which is limited by Courant, cell at " \
                 r"\(.*lower endTime.* \[manySteps\]"
        said = harness.program("checkCase", case).stdout
        self.assertGreater(float(re.search(wanted, said.replace("\n", " "))[1]), 1e7)
        self.assertNotIn("note:", said)
        log, rest = self.log_until(case, "^Time = ")
        self.assertRegex(log.replace("\n", " "), wanted)
        self.assertNotIn("note:", log + rest)

    def test_a_step_that_falls(self):
        """A gas that is heated: when more than 1000 times as many steps are left as at first, the log says so, once."""
        case = self.make("heated", 100.0)
        harness.edit(case, "constant/granularProperties", cooling="none; sources (uniformHeating); uniformHeatingCoeffs { rate 1e12; }")
        self.assertNotIn("note:", harness.program("checkCase", case).stdout)
        log, rest = self.log_until(case, "larger cells there")
        found = re.search(self.NOTE, log)
        self.assertAlmostEqual(float(re.search(r"[\d.e+]+", found.group(5)).group()), 1000, delta=20)
        self.assertNotIn("note:", rest)

    def test_time_stands_still(self):
        """An inlet that gives a dense alpha and leaves U and T free feeds a gas of elastic spheres without end: T grows, and dt falls
        below the last digits of t. The run says so then, with what feeds it, instead of going on."""
        n, packing = 40, np.pi / 6 * 0.1**3
        case = os.path.join(self.folder, "inlet")
        boxes, rest = harness.boxes, "xHigh zeroGradient\nyEmpty empty\nzEmpty empty"
        harness.box_case(case, (n, 1, 1), (4.0, 0.1, 0.1), np.full(n, 0.3 / packing), np.zeros((n, 3)), np.full(n, 1e3), 10.0,
                         eos="TorquatoSpheres", e=1.0, cooling="none")
        os.remove(case + "/0/rho")
        os.remove(case + "/0/p")
        boxes.write_field(case, "alpha", np.full(n, 0.3), "xLow fixedValue; value uniform 0.6398\n" + rest)
        boxes.write_field(case, "T", np.full(n, 1.0), "xLow zeroGradient\n" + rest)
        boxes.write_field(case, "U", np.zeros((n, 3)), "xLow zeroGradient\n" + rest)
        runs.add(case, "system/fvSchemes", "commonCoeffs { shocks off; expansions off; contacts off; }\n")  # with these rules it creeps before
        done = harness.program("granularGas", "-case", case, check=False, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"time stands still at t = \S+ a step of \S+ s is less than some last digits of t(.|\n)*"
                                      r"a boundary gives the density and leaves T free")
        self.assertEqual(runs.times(case)[-1], re.findall("    written: (.*)", done.stdout)[-1])


if __name__ == "__main__":
    unittest.main()
