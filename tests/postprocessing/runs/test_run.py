# SPDX-License-Identifier: GPL-3.0-or-later
"""haff.run: copies with other entries and their meshes, what is never touched, errors with file and line, stops."""
import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes, dictionary, haff

PROPERTIES = "constant/granularProperties"
gmsh = unittest.skipUnless(shutil.which("gmsh"), "gmsh is not there")


def tube(path, end=0.05, cells=40, **options):
    """A gas that cools and streams, in a periodic tube of 1 m."""
    x = boxes.centres((cells, 1, 1), (1.0, 0.1, 0.1))[:, 0]
    u = np.stack([np.sin(2 * np.pi * x), 0 * x, 0 * x], axis=1)
    return harness.box_case(path, (cells, 1, 1), (1.0, 0.1, 0.1), 1 + 0.3 * np.cos(2 * np.pi * x), u, 0 * x + 1, end, types={"x": "cyclic"},
                            cooling="Haff", e=0.9, **options)


class Copies(harness.Folder, unittest.TestCase):
    def setUp(self):
        self.case = tube(os.path.join(self.folder, self._testMethodName))
        self.before = runs.contents(self.case)

    def unchanged(self):
        self.assertEqual(runs.contents(self.case), self.before)

    def test_entries(self):
        """The copy runs with the entries given; the case keeps its bytes; the same call only returns the copy."""
        case = haff.run(self.case, {PROPERTIES: {"grain/restitution": 0.8}})
        self.assertEqual(case.path, self.case + "-restitution=0.8")
        self.assertEqual(case.times, ["0", "0.05"])
        self.assertEqual(dictionary.get(case.path + "/" + PROPERTIES, "grain/restitution"), 0.8)
        other = haff.run(haff.Case(self.case), folder=os.path.join(self.folder, "deep", "plain"))
        self.assertLess(case.field("T").mean(), other.field("T").mean())  # it cools more
        self.unchanged()
        stamp = os.stat(case.path + "/log.granularGas").st_mtime_ns
        again = haff.run(self.case, {PROPERTIES: {"grain": {"restitution": "0.80"}}})
        self.assertEqual((again.path, os.stat(again.path + "/log.granularGas").st_mtime_ns), (case.path, stamp))

    def test_ranks(self):
        """On two ranks the same bits."""
        one, two = (haff.run(self.case, folder=self.case + str(n), ranks=n) for n in (1, 2))
        runs.same(self, runs.results(one.path), runs.results(two.path))
        self.assertRegex(open(two.path + "/log.granularGas").read(), r"2 ranks")

    def test_in_place(self):
        """Without changes and folder the case runs where it is."""
        self.assertEqual(haff.run(self.case).path, self.case)
        self.assertEqual(haff.Case(self.case).times, ["0", "0.05"])
        with self.assertRaisesRegex(ValueError, "a copy would overwrite"):
            haff.run(self.case, {PROPERTIES: {"grain/restitution": 0.8}}, folder=self.case)

    def test_results_stay_behind(self):
        """A copy of a case that has run starts anew: with 0.orig, with 0, and with the folder of startTime."""
        for name, keep, control in (("orig", "0.orig", {}), ("plain", "0", {}), ("late", "0.05", {"startFrom": "startTime", "startTime": 0.05, "endTime": 0.08})):
            with self.subTest(name):
                base = shutil.copytree(self.case, self.case + name)
                if keep == "0.orig":
                    os.rename(base + "/0", base + "/0.orig")
                haff.run(base)
                os.makedirs(base + "/VTK")
                dictionary.edit(base + "/system/controlDict", control)
                shutil.copytree(self.case, base + "/another")  # a case of its own
                case = haff.run(base, {PROPERTIES: {"grain/restitution": 0.8}})
                self.assertEqual(case.times, ["0", "0.05"] if not control else ["0.05", "0.08"])
                self.assertTrue(os.path.isdir(os.path.join(case.path, keep)))
                self.assertFalse(os.path.exists(case.path + "/VTK") or os.path.exists(case.path + "/another"))
                self.assertNotIn("nothing to do", open(case.path + "/log.granularGas").read())

    def test_other_runs_are_kept(self):
        """A folder that holds something else is refused, and keeps its bytes; so is one of a case that has changed since."""
        copy = self.case + "copy"
        haff.run(self.case, {PROPERTIES: {"grain/restitution": 0.8}}, folder=copy)
        there = runs.contents(copy)
        with self.assertRaisesRegex(haff.ChangedCase, "restitution': '0.8'.*not .*'0.7'.*name another folder"):
            haff.run(self.case, {PROPERTIES: {"grain/restitution": 0.7}}, folder=copy)
        dictionary.edit(self.case + "/" + PROPERTIES, {"grain/mass": 2})
        with self.assertRaisesRegex(haff.ChangedCase, "granularProperties has changed since"):
            haff.run(self.case, {PROPERTIES: {"grain/restitution": 0.8}}, folder=copy)
        self.assertEqual(runs.contents(copy), there)
        os.makedirs(self.case + "mine/notes")
        with self.assertRaisesRegex(haff.ChangedCase, "is no run of"):
            haff.run(self.case, folder=self.case + "mine")
        self.assertEqual(os.listdir(self.case + "mine"), ["notes"])

    @gmsh
    def test_mesh(self):
        """mesh.geo is meshed where there is no mesh, with its numbers; numbers that it does not know are refused."""
        case = harness.copy("sod", self.folder)
        harness.drop_vtk(case)
        short = {"system/controlDict": {"endTime": 0.01, "writeInterval": 0.01}}
        self.assertEqual(haff.run(case, short).mesh.cells, 400)
        fine = haff.run(case, short, mesh={"N": 20})
        self.assertEqual((fine.mesh.cells, os.path.basename(fine.path)), (20, "sod-endTime=0.01,writeInterval=0.01,N=20"))
        self.assertFalse(os.path.exists(case + "/constant/polyMesh"))
        harness.mesh(case, 30)
        self.assertEqual(haff.run(case, short, folder=case + "30").mesh.cells, 30)  # the mesh that stands there
        self.assertEqual(haff.run(case, short, mesh={"N": 12}).mesh.cells, 12)
        for mesh, why in (({"M": 3}, "no number 'M'.*has: N"), ({"N": 3}, "allowed by mesh.geo: Min 8"), ({"N": "x"}, "is no number")):
            with self.assertRaisesRegex(ValueError, why):
                haff.run(case, mesh=mesh)

    @gmsh
    def test_mesh_errors(self):
        case = harness.copy("sod", self.folder)
        with open(case + "/mesh.geo", "a") as f:
            f.write("Nonsense(;\n")
        with self.assertRaisesRegex(haff.RunError, r"mesh\.geo.*syntax error") as caught:
            haff.run(case, folder=case + "1")
        self.assertEqual((caught.exception.program, caught.exception.log), ("gmsh", case + "1/log.gmsh"))

    def test_our_errors(self):
        """An error of a program has its text, file and line, exit code and log."""
        with self.assertRaises(haff.RunError) as caught:
            haff.run(self.case, {PROPERTIES: {"equationOfState": "perfctGas"}})
        error, file = caught.exception, self.case + "-equationOfState=perfctGas/" + PROPERTIES
        with open(file) as f:
            line = next(n for n, text in enumerate(f, 1) if text.startswith("equationOfState"))
        self.assertEqual((error.file, error.line, error.code, error.program), (file, line, 1, "granularGas"))
        self.assertEqual(error.log, os.path.join(os.path.dirname(os.path.dirname(file)), "log.granularGas"))
        self.assertTrue(error.message.startswith(f"{file}:{line}: key 'equationOfState' is perfctGas; allowed are:"), error.message)
        self.assertIn("did you mean 'perfectGas'?", str(error))
        self.unchanged()

    def test_error_in_place(self):
        dictionary.edit(self.case + "/system/controlDict", {"maxCo": -1})
        with self.assertRaisesRegex(haff.RunError, r"system/controlDict:\d+: maxCo is -1; allowed is"):
            haff.run(self.case)

    def test_wrong_changes(self):
        """Entries and files that are not there are errors before anything is made."""
        for changes, kind, why in (({PROPERTIES: {"grain/restitutio": 1}}, haff.EntryError, "did you mean 'grain/restitution'"),
                                   ({"constant/granularPropertis": {"a": 1}}, FileNotFoundError, "did you mean constant/granularProperties"),
                                   ({"../x": {"a": 1}}, ValueError, "no file of the case"), ({PROPERTIES: 3}, TypeError, "a dictionary")):
            with self.subTest(str(changes)), self.assertRaisesRegex(kind, why):
                haff.run(self.case, changes, folder=self.case + "new")
            self.assertFalse(os.path.exists(self.case + "new"))
        with self.assertRaisesRegex(FileNotFoundError, "no case directory"):
            haff.run(self.folder)

    def test_corrected(self):
        """A copy whose run has written nothing gives way to one with other entries."""
        folder = self.case + "one"
        with self.assertRaises(haff.RunError):
            haff.run(self.case, {PROPERTIES: {"grain/restitution": 7}}, folder=folder)
        case = haff.run(self.case, {PROPERTIES: {"grain/restitution": 0.7}}, folder=folder)
        self.assertEqual(dictionary.get(folder + "/" + PROPERTIES, "grain/restitution"), 0.7)
        self.assertEqual(case.times, ["0", "0.05"])

    def test_state(self):
        """A gas that leaves the admissible states: exit code 2."""
        with self.assertRaises(haff.RunError) as caught:
            haff.run(self.case, {"system/controlDict": {"+minDeltaT": 1}})
        self.assertEqual((caught.exception.code, caught.exception.line), (2, None))
        self.assertIn("less than is allowed", caught.exception.message)

    def test_command(self):
        """haff run prints the folder; its errors are one text and the exit code of the program."""
        go = lambda *words: harness.command("run", self.case, *words)
        done = go(PROPERTIES + ":grain/restitution=0.8")
        self.assertEqual((done.returncode, os.path.abspath(done.stdout.strip())), (0, self.case + "-restitution=0.8"), done.stderr)
        wrong = go(PROPERTIES + ":grain/restitution=8")
        self.assertEqual(wrong.returncode, 1)
        self.assertRegex(wrong.stderr, r"^error: .*/granularProperties:\d+: .*restitution.*\n  granularGas ended with exit code 1")
        self.assertRegex(go("restitution=8").stderr, "needed: FILE:ENTRY=VALUE")


class Stops(harness.Folder, unittest.TestCase):
    """A run that is stopped has written its state and goes on from there."""

    def setUp(self):
        self.case = tube(os.path.join(self.folder, self._testMethodName), end=2000.0)
        self.copy, self.changes = self.case + "copy", {PROPERTIES: {"grain/restitution": 1}}

    def begun(self):
        """Waits until the run has made steps, and returns the time that it has logged."""
        log = self.copy + "/log.granularGas"
        for _ in range(1200):
            if os.path.exists(log) and "step 3" in open(log).read():
                return
            time.sleep(0.05)
        self.fail("the run did not start")

    def finish(self):
        """The run goes on from where it was stopped, with an end that it reaches."""
        [t] = [t for t in haff.Case(self.copy).times if float(t) > 0]
        dictionary.edit(self.copy + "/system/controlDict", {"endTime": float(t) + 0.01, "startFrom": "startTime"})
        case = haff.run(self.case, self.changes, folder=self.copy)
        self.assertEqual(case.times[:2], ["0", t])
        self.assertAlmostEqual(float(case.times[-1]), float(t) + 0.01, places=9)
        with open(self.copy + "/log.granularGas") as f:
            parts = f.read().split("end at time")
        self.assertEqual(len(parts), 3)
        self.assertGreater(float(re.search(r"^Time = (\S+)", parts[1], re.M)[1]), float(t))  # not again from 0

    def test_ctrl_c(self):
        def interrupt():
            with contextlib.suppress(AssertionError):
                self.begun()
            os.kill(os.getpid(), signal.SIGINT)
        was = signal.signal(signal.SIGINT, signal.default_int_handler)
        thread = threading.Thread(target=interrupt)
        thread.start()
        try:
            with self.assertRaises(KeyboardInterrupt):
                haff.run(self.case, self.changes, folder=self.copy)
        finally:
            thread.join()
            signal.signal(signal.SIGINT, was)
        self.assertIn("stopped as asked", open(self.copy + "/log.granularGas").read())
        self.finish()

    def test_killed_caller(self):
        """Python is killed: the run that it has started writes its state, and the next call waits for that."""
        code = f"import haff; haff.run({self.case!r}, {self.changes!r}, folder={self.copy!r}, ranks=2)"
        caller = subprocess.Popen([sys.executable, "-c", code])
        self.begun()
        caller.kill()
        caller.wait()
        for _ in range(600):
            if "end at time" in open(self.copy + "/log.granularGas").read():
                break
            time.sleep(0.05)
        self.finish()

    def test_stopped_by_another(self):
        def stop():
            with contextlib.suppress(AssertionError):
                self.begun()
            [pid] = [int(p) for p in os.listdir("/proc") if p.isdigit() and self.copy.encode() in command_of(p)]
            os.kill(pid, signal.SIGTERM)
        thread = threading.Thread(target=stop)
        thread.start()
        with self.assertRaisesRegex(InterruptedError, "the same call goes on from there"):
            haff.run(self.case, self.changes, folder=self.copy)
        thread.join()
        self.finish()


def command_of(pid):
    with contextlib.suppress(OSError), open(f"/proc/{pid}/cmdline", "rb") as f:
        return f.read()
    return b""


if __name__ == "__main__":
    unittest.main()
