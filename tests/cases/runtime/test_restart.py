# SPDX-License-Identifier: GPL-3.0-or-later
"""Stops and restarts give the bytes of a run that went through; faults in test_faults.py."""
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

import numpy as np

from tests.cases import harness, runs

GAS = os.path.join(harness.BIN, "granularGas")
CONTROL = "system/controlDict"


def start(case, stderr=subprocess.STDOUT):
    return subprocess.Popen([GAS, "-case", case], stdout=subprocess.PIPE, stderr=stderr, text=True)


class Restart(harness.Folder, unittest.TestCase):
    def through(self, name, n=(60, 40, 1), end=0.04, **options):
        case = runs.make(os.path.join(self.folder, name), n, end, **options)
        harness.program("granularGas", "-case", case)
        return case

    def continued(self, case, **control):
        """The same run taken up at every written time but the last, on one and two ranks in turn."""
        names = runs.times(case)
        self.assertGreater(len(names), 3)
        for k, name in enumerate(names[1:-1]):
            with self.subTest(os.path.basename(case), start=name):
                part = runs.until(case, f"{case}_{k}", name)
                if control:
                    harness.edit(part, CONTROL, **control)
                harness.program("granularGas", "-case", part, ranks=1 + k % 2)
                self.assertEqual(runs.times(part), names)
                for later in names[k + 2:]:
                    runs.same(self, runs.contents(os.path.join(case, later)), runs.contents(os.path.join(part, later)), later)

    def test_adjustable(self):
        self.continued(self.through("adjustable", interval=0.01))

    def test_time_step_ascii(self):
        """Six digits in the files, all of them in the conserved fields; compressed; a hole."""
        self.continued(self.through("ascii", hole=True, interval=12, control="timeStep", format="ascii", digits=6,
                                    compression="on"))

    def test_run_time_fixed_step(self):
        self.continued(self.through("fixed", n=(20, 16, 12), end=0.02, interval=0.005, control="runTime", adjust="no",
                                    step=2e-4))

    def test_spheres(self):
        """Spheres with transport and all its terms, between walls that hold them."""
        self.continued(self.through("spheres", n=(20, 16, 12), end=0.02, interval=0.005, viscous=True))

    def test_ramp(self):
        """Shaken with an amplitude that has knots between and at the times written."""
        case = runs.make(os.path.join(self.folder, "ramp"), (30, 20, 1), 0.04, interval=0.01)
        harness.write_dictionary(case, "constant", "shaking", "type sinusoidal; frequency 60; phase 1;\n"
                                 "amplitude table ((0.004 50) (0.013 0) (0.02 30) (0.035 10));\n")
        harness.program("granularGas", "-case", case)
        self.continued(case)

    def test_other_digits(self):
        """Written with 6 digits, taken up with 17: the conserved fields are the state, whatever U and T were cut to."""
        case = self.through("digits", n=(60, 1, 1), interval=0.01, format="ascii", digits=3)
        part = runs.until(case, case + "_part", "0.02")
        for c in (case, part):
            harness.edit(c, CONTROL, endTime=0.06, writePrecision=17)
            harness.program("granularGas", "-case", c)
        runs.same(self, runs.contents(case + "/0.06"), runs.contents(part + "/0.06"))

    def test_boundary_values(self):
        """Nonuniform values on a patch keep all their digits in an ascii file of 6."""
        case = runs.make(os.path.join(self.folder, "patch"), (40, 30, 1), 0.02, interval=0.005, format="ascii", digits=6)
        values = "\n".join("%.17g" % (2000 + 100 * np.sin(k)) for k in range(30))
        for name, rule in (("p", f"type fixedValue; value nonuniform List<scalar>\n30\n(\n{values}\n);"), ("U", "type zeroGradient;")):
            path = os.path.join(case, "0", name)
            with open(path) as f:
                text = f.read()
            with open(path, "w") as f:
                f.write(text.replace("boundaryField\n{", "boundaryField\n{\n    xLow { %s }" % rule))
        harness.program("granularGas", "-case", case)
        self.continued(case)

    def test_next_write(self):
        """stopAt nextWrite, again and again, makes the same times."""
        case = self.through("next", n=(60, 1, 1), interval=0.01)
        part = runs.until(case, case + "_part", "0")
        harness.edit(part, CONTROL, stopAt="nextWrite")
        for name in runs.times(case)[1:]:
            harness.program("granularGas", "-case", part)
            self.assertEqual(runs.times(part)[-1], name)
            runs.same(self, runs.contents(os.path.join(case, name)), runs.contents(os.path.join(part, name)))

    def test_signals(self):
        """SIGTERM at any moment (also with a pipe without a reader): exit code 0, and the end is the same."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        case = self.through("signals", n=(100, 80, 1), end=0.3, interval=0.3, hole=True)
        work = (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before) / 60  # eight of them leave most of the run
        part = runs.until(case, case + "_part", "0")
        for number in (signal.SIGTERM, signal.SIGUSR1, signal.SIGINT, signal.SIGTERM) * 2:
            run = start(part)
            for line in run.stdout:
                if line.startswith("Time ="):
                    break
            harness.await_work([run.pid], random.random() * work)
            run.send_signal(number)
            run.stdout.close()
            self.assertEqual(run.wait(60), 0)
        self.assertGreater(len(runs.times(part)), 5)
        self.assertNotIn("0.3", runs.times(part))
        harness.program("granularGas", "-case", part)
        self.assertEqual(runs.hidden(part), [])
        for name in runs.times(part):
            if float(name):
                runs.complete(self, part, name)
        runs.same(self, runs.contents(case + "/0.3"), runs.contents(part + "/0.3"))

    def test_signal_to_ranks(self):
        """A wish to stop, sent to mpirun once or often, to it alone or by Ctrl-C to its whole group, reaches the ranks, which
        write before they go: exit code 0, and nothing is left behind."""
        mpirun = os.path.join(harness.BIN, "mpirun")
        for k, (number, how, command) in enumerate((
                (signal.SIGTERM, os.kill, (mpirun, "-np", "2", GAS)), (signal.SIGINT, os.killpg, (mpirun, "-np", "2", GAS)),
                (signal.SIGHUP, os.kill, (GAS, "-np", "2")), (signal.SIGTERM, self.often, (mpirun, "-np", "3", GAS)))):
            with self.subTest(number=number, how=how.__name__):
                case = runs.make(os.path.join(self.folder, f"ranks{k}"), (100, 80, 1), 100.0)
                run = subprocess.Popen([*command, "-case", case], stdout=subprocess.PIPE, text=True, start_new_session=True)
                for line in run.stdout:
                    if line.startswith("Time ="):
                        break
                how(run.pid, number)
                text = run.communicate(timeout=60)[0]
                self.assertEqual(run.returncode, 0, text)
                (_, last) = runs.times(case)
                runs.complete(self, case, last)
                self.assertRegex(text, rf"written: {last}\nstopped as asked .*\nSeconds of the clock, rank 0\n(?:    .*\n)+end at time")
                self.assertEqual(runs.hidden(case), [])

    @staticmethod
    def often(pid, number):
        for _ in range(10):
            os.kill(pid, number)
            time.sleep(0.01)

    def test_mpirun_passes_on(self):
        """The exit code of a run that fails, and of programs that are not haff's; the death of the script ends the ranks."""
        mpirun = os.path.join(harness.BIN, "mpirun")
        self.assertEqual(subprocess.run([mpirun, "-np", "2", GAS, "-case", "/nowhere"], capture_output=True).returncode, 1)
        self.assertEqual(subprocess.run([mpirun, "-np", "1", "sh", "-c", "exit 7"], capture_output=True).returncode, 7)
        case = runs.make(os.path.join(self.folder, "orphans"), (100, 80, 1), 100.0)
        run = subprocess.Popen([mpirun, "-np", "2", GAS, "-case", case], stdout=subprocess.PIPE, text=True)
        for line in run.stdout:
            if line.startswith("Time ="):
                break
        run.kill()
        run.communicate(timeout=60)  # the pipe is closed when the ranks have gone

    def test_signal_within_a_step(self):
        """SIGTERM in a step of a hundred thousand stages of diffusion (grains far larger than cells): the step is dropped, on all
        ranks, and the state at its start is written. The end of the step would be seconds away."""
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                n, packing = (120, 100, 1), np.pi / 6 * 5000.0**3
                case = runs.make(os.path.join(self.folder, f"within{ranks}"), n, 10.0, viscous=True)
                harness.edit(case, "constant/granularProperties", transport="GarzoDufty; GarzoDuftyCoeffs { zetaU none; }")
                text = runs.contents(case)["constant/granularProperties"].decode().replace("diameter 0.1", "diameter 5000")
                with open(os.path.join(case, "constant", "granularProperties"), "w") as f:
                    f.write(text)
                for name in ("rho", "p"):
                    values = np.full(n[0] * n[1], (0.1 if name == "rho" else 1.0) / packing)
                    harness.boxes.write_field(case, name, values, '".*" zeroGradient\nzEmpty empty')
                runs.add(case, "system/fvSolution", "diffusion { type explicit; }\n")
                run = subprocess.Popen([os.path.join(harness.BIN, "mpirun"), "-np", str(ranks), GAS, "-case", case],
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                for line in run.stdout:
                    if line.startswith("    wall"):
                        break
                harness.await_work(harness.processes("granularGas", case), 0.3)
                run.send_signal(signal.SIGTERM)
                text = run.communicate(timeout=60)[0]
                self.assertIn("stopped as asked at time 1e-06, within a step from there", text)
                self.assertEqual(runs.times(case), ["0", "1e-06"])
                runs.complete(self, case, "1e-06")

    def test_tables(self):
        """The tables of a restarted run stand in a folder of its start time and go on where the others stopped."""
        case = self.through("tables", n=(60, 40, 1), interval=0.01, tables=True)
        part = runs.until(case, case + "_part", "0.02")
        harness.program("granularGas", "-case", part, ranks=2)
        whole, rest = (runs.contents(os.path.join(c, "postProcessing")) for c in (case, part))
        self.assertEqual({k.split("/")[1] for k in rest}, {"0.02", "0.03", "0.04"})
        for name in ("points/{}/alpha", "points/{}/U", "extreme/{}/fieldMinMax.dat", "mass/{}/volFieldValue.dat", "mean/{}/volFieldValue.dat"):
            a, b = whole[name.format("0")].splitlines(), rest[name.format("0.02")].splitlines()
            head = sum(line.startswith(b"#") for line in a)
            self.assertEqual(a[:head], b[:head])
            a, b = (([line for line in t[head:] if float(line.split()[0]) > 0.02]) for t in (a, b))
            self.assertGreater(len(a), 4)
            self.assertEqual(a, b, name)
        for time_name in ("0.03", "0.04"):
            for file in ("a_rho.xy", "a_U.xy"):
                name = f"line/{time_name}/{file}"
                self.assertEqual(whole[name], rest[name])


class Leftovers(harness.Folder, unittest.TestCase):
    def writer(self, name, n=(40, 30, 1), end=0.1, **options):
        """A case that writes at every step."""
        return runs.make(os.path.join(self.folder, name), n, end, adjust="no", step=2e-4, control="timeStep", interval=1, **options)

    def test_leftovers(self):
        """What a kill can leave between two renames: the old folder is put back, half-written ones go."""
        case = self.writer("left")
        harness.edit(case, CONTROL, stopAt="nextWrite")
        harness.program("granularGas", "-case", case)
        whole = runs.contents(case + "/0.0002")
        shutil.copytree(case + "/0.0002", case + "/.0.0004.tmp")
        os.remove(case + "/.0.0004.tmp/rhoE")
        os.rename(case + "/0.0002", case + "/.0.0002.old")
        shutil.copytree(case + "/.0.0002.old", case + "/.0.0002.tmp")
        os.mkdir(case + "/.git")
        harness.program("granularGas", "-case", case)
        self.assertIn("0.0004", runs.times(case))
        runs.same(self, whole, runs.contents(case + "/0.0002"))
        self.assertEqual(runs.hidden(case), [".git"])

    def test_collapse(self):
        """Gas falls on a wall until it packs: message, exit code 2, a last state that can be read and taken up."""
        case = harness.copy("wall", self.folder)
        harness.mesh(case, 50)
        harness.drop_vtk(case)
        harness.edit(case, CONTROL, endTime=1, writeInterval=0.1, writeFormat="ascii", writePrecision=6)
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"inelastic collapse at t = 0\.2\d+, \(9\.\d+ \d")
        names = runs.times(case)
        self.assertEqual(names[:3], ["0", "0.1", "0.2"])
        self.assertEqual(len(names), 4)
        runs.complete(self, case, names[-1])
        alpha = harness.haff.Case(case).field("rho", names[-1]) * np.pi * 0.1**3 / 6
        self.assertTrue(0.64 < alpha.max() < 0.65)
        harness.program("checkCase", case)
        harness.program("caseToVTK", case)
        before = runs.contents(os.path.join(case, names[-1]))
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertEqual(runs.times(case), names)
        runs.same(self, before, runs.contents(os.path.join(case, names[-1])))
        self.assertRegex(harness.program("granularGas", "-help").stdout, r"2 the gas\s+left the admissible states")


if __name__ == "__main__":
    unittest.main()
