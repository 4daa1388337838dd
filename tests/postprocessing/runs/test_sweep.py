# SPDX-License-Identifier: GPL-3.0-or-later
"""haff.sweep: every combination once, stopped and killed and continued, failed runs as rows, other cases noticed."""
import csv
import os
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import haff
from tests.postprocessing.runs.test_run import PROPERTIES, gmsh, tube
from haff.runs import copies, sweepCase

E = "grain/restitution"


def table(folder):
    with open(os.path.join(folder, "sweep.csv"), newline="") as f:
        return list(csv.DictReader(f))


def quiet(*arguments, **named):
    return haff.sweep(*arguments, progress=False, **named)


class Tables(harness.Folder, unittest.TestCase):
    def setUp(self):
        self.case = tube(os.path.join(self.folder, self._testMethodName))
        self.out = self.case + "out"

    def test_combinations(self):
        """A row for each combination, with what was measured in a run of these entries; the case keeps its bytes."""
        before, grid = runs.contents(self.case), {PROPERTIES: {E: [0.8, 0.9]}, "system/controlDict": {"endTime": [0.02, 0.03], "writeInterval": 0.01}}
        found = quiet(self.case, grid, folder=self.out, measure=lambda case: {"T": case.field("T").mean(), "last": case.times[-1]})
        self.assertEqual(list(found["restitution"]), [0.8, 0.8, 0.9, 0.9])
        self.assertEqual(list(found["endTime"]), [0.02, 0.03] * 2)
        self.assertEqual(list(found["last"]), ["0.02", "0.03"] * 2)
        self.assertEqual((set(found["state"]), set(found["error"])), ({"done"}, {""}))
        alone = haff.run(self.case, {PROPERTIES: {E: 0.9}, "system/controlDict": {"endTime": 0.03, "writeInterval": 0.01}})
        self.assertEqual(found["T"][3], alone.field("T").mean())
        rows = table(self.out)
        self.assertEqual([float(r["T"]) for r in rows], list(found["T"]))
        self.assertEqual(list(rows[0]), ["restitution", "endTime", "writeInterval", "T", "last", "state", "seconds", "folder", "error"])
        self.assertEqual(runs.contents(self.case), before)

    def test_added_values(self):
        """What is finished is only measured; added values run."""
        quiet(self.case, {PROPERTIES: {E: [0.8, 0.9]}}, folder=self.out)
        stamps = {name: os.stat(f"{self.out}/{name}/log.granularGas").st_mtime_ns for name in ("restitution=0.8", "restitution=0.9")}
        found = quiet(self.case, {PROPERTIES: {E: [0.8, 0.85, 0.9]}}, folder=self.out, measure=lambda case: {"t": float(case.times[-1])})
        self.assertEqual((list(found["restitution"]), list(found["t"])), ([0.8, 0.85, 0.9], [0.05] * 3))
        for name, stamp in stamps.items():
            self.assertEqual(os.stat(f"{self.out}/{name}/log.granularGas").st_mtime_ns, stamp)

    def test_failed_rows(self):
        """A run that fails is a row with the program's words, file and line; of a failed measure with Python's."""
        def measure(case):
            return {"x": 1 / (len(case.times) - 2) if "0.9" in case.path else 5}
        found = quiet(self.case, {PROPERTIES: {E: [0.8, 0.9, 1.5]}}, folder=self.out, measure=measure)
        self.assertEqual(list(found["state"]), ["done", "failed", "failed"])
        self.assertEqual(found["x"][0], 5)
        self.assertTrue(np.isnan(found["x"][1:].astype(float)).all())
        self.assertIn("ZeroDivisionError", found["error"][1])
        self.assertRegex(found["error"][2], r"restitution=1\.5/constant/granularProperties:\d+: .*restitution is 1\.5")
        self.assertEqual([r["error"] for r in table(self.out)], list(found["error"]))
        self.assertIn("already: name it otherwise", quiet(self.case, {PROPERTIES: {E: [0.8]}}, folder=self.out, measure=lambda c: {"state": 1})["error"][0])

    def test_collapse_is_not_tried_again(self):
        grid = {"system/controlDict": {"+minDeltaT": [1e-9, 1]}}
        first, again = (quiet(self.case, grid, folder=self.out) for _ in range(2))
        self.assertEqual(list(first["state"]), ["done", "failed"])
        self.assertIn("less than is allowed", first["error"][1])
        self.assertEqual(list(again["error"]), list(first["error"]))
        with open(self.out + "/minDeltaT=1/log.granularGas") as f:
            self.assertEqual(f.read().count("\nerror: "), 1)

    @gmsh
    def test_meshes(self):
        case = harness.copy("sod", self.folder)
        harness.drop_vtk(case)
        found = quiet(case, {"system/controlDict": {"endTime": 0.01}}, mesh={"N": [10, 20]}, measure=lambda case: {"cells": case.mesh.cells})
        self.assertEqual((list(found["N"]), list(found["cells"])), ([10, 20], [10, 20]))
        self.assertTrue(os.path.exists(case + "-sweep/sweep.csv"))

    def test_other_cases(self):
        """The folder of another case, of the case as it was, and of no sweep at all."""
        quiet(self.case, {PROPERTIES: {E: [0.8]}}, folder=self.out)
        other = tube(self.case + "other", cells=30)
        with self.assertRaisesRegex(haff.ChangedCase, "test_other_cases as it was.*name another folder"):
            quiet(other, {PROPERTIES: {E: [0.8]}}, folder=self.out)
        os.remove(self.case + "/constant/granularProperties")
        with self.assertRaises(FileNotFoundError):
            quiet(self.case, {PROPERTIES: {E: [0.8]}}, folder=self.out)
        with self.assertRaisesRegex(haff.ChangedCase, "granularProperties is gone since then"):
            quiet(self.case, {"system/controlDict": {"endTime": [0.01]}}, folder=self.out)
        with self.assertRaisesRegex(haff.ChangedCase, "no folder of a sweep"):
            quiet(other, {PROPERTIES: {E: [0.8]}}, folder=self.case)
        with self.assertRaisesRegex(ValueError, "lies in the case"):
            quiet(other, {PROPERTIES: {E: [0.8]}}, folder=other + "/out")
        self.assertEqual([r["state"] for r in table(self.out)], ["done"])

    def test_wrong_choices(self):
        """Wrong entries, values and numbers are errors before anything runs."""
        for grid, kind, why in (({PROPERTIES: {"grain/restitutio": [1]}}, haff.EntryError, "did you mean"), ({PROPERTIES: {E: []}}, ValueError, "no values"),
                                ({PROPERTIES: {E: [1, "1.0"]}}, ValueError, "given twice")):
            with self.subTest(str(grid)), self.assertRaisesRegex(kind, why):
                quiet(self.case, grid, folder=self.out)
            self.assertFalse(os.path.exists(self.out))

    def test_names_of_folders(self):
        """Up to 100 letters a name says all of its values; behind that, and with letters of no file name, it ends in a digest."""
        self.assertEqual(copies.name_of({"restitution": 0.9, "N": 20}), "restitution=0.9,N=20")
        for letters, whole in ((98, True), (99, False)):
            name = copies.name_of({"a" * letters: 1})
            self.assertEqual((name == "a" * letters + "=1", len(name)), (whole, 100 if whole else 89))
        self.assertRegex(copies.name_of({"a/b": 1}), "^a_b=1-[0-9a-f]{8}$")

    def test_words(self):
        """Values of the command line: commas in brackets and quotes belong to a value."""
        self.assertEqual(sweepCase.values('1,0.5,(0 -9,8 0),"a,b",minmod'), [1, 0.5, "(0 -9,8 0)", '"a,b"', "minmod"])


class Stopped(harness.Folder, unittest.TestCase):
    """Twenty runs on two cores: stopped, killed, continued, complete."""

    LONG, VALUES = 4.0, [0.9 + 0.01 * k for k in range(10)]

    def begin(self):
        words = [f"{PROPERTIES}:{E}=" + ",".join(f"{v:.2f}" for v in self.VALUES), f"system/controlDict:endTime=0.05,{self.LONG}"]
        command = [sys.executable, "-m", "haff", "sweep", self.case, *words, "-folder", self.out, "-cores", "2", "-measure", self.script]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def wait_for(self, done):
        """Until that many runs are done and a long one is on its way."""
        for _ in range(2400):
            rows = table(self.out) if os.path.exists(self.out + "/sweep.csv") else []
            waiting = [r["folder"] for r in rows if r["state"] == "waiting"]
            if sum(r["state"] == "done" for r in rows) >= done and any(self.under_way(name) for name in waiting):
                return
            time.sleep(0.02)
        self.fail("the sweep does not go on")

    def under_way(self, name):
        path = os.path.join(self.out, name, "log.granularGas")
        return os.path.exists(path) and "step 3" in open(path).read().rpartition("Create")[2]

    def done(self):
        return [r["folder"] for r in table(self.out) if r["state"] == "done"]

    def test_twenty_runs(self):
        self.case, self.out, self.script = (os.path.join(self.folder, n) for n in ("tube", "out", "measure.py"))
        tube(self.case, cells=180)  # a long run takes long enough to be met on its way
        with open(self.script, "w") as f:
            f.write("def measure(case):\n    return {'T': case.field('T').mean()}\n")
        first = self.begin()
        self.wait_for(4)
        first.send_signal(signal.SIGINT)
        said = first.communicate(timeout=60)[1]
        self.assertEqual(first.returncode, 130, said)
        self.assertRegex(said, r"of 20 runs have ended.*\n(.*\n)*stopped; the same command goes on from there")
        at_stop = self.done()
        self.assertTrue(4 <= len(at_stop) < 20, at_stop)
        second = self.begin()
        self.wait_for(len(at_stop) + 4)
        second.kill()
        second.communicate()
        at_kill = self.done()
        self.assertGreater(len(at_kill), len(at_stop))
        third = self.begin()
        said = third.communicate(timeout=300)
        self.assertEqual(third.returncode, 0, said)
        self.complete(at_stop, at_kill)

    def complete(self, at_stop, at_kill):
        rows = table(self.out)
        self.assertEqual([(float(r["restitution"]), float(r["endTime"]), r["state"]) for r in rows],
                         [(round(v, 2), end, "done") for v in self.VALUES for end in (0.05, self.LONG)])
        starts = {r["folder"]: open(f"{self.out}/{r['folder']}/log.granularGas").read().count("end at time") for r in rows}
        self.assertEqual({n for n in starts if starts[n] > 1} & set(at_stop), set())  # those were not run again
        restarted = [r for r in rows if starts[r["folder"]] > 1]
        self.assertTrue(restarted)
        for r in restarted:
            with self.subTest(r["folder"]):
                alone = haff.run(self.case, {PROPERTIES: {E: r["restitution"]}, "system/controlDict": {"endTime": r["endTime"]}})
                self.assertEqual(float(r["T"]), alone.field("T").mean())


if __name__ == "__main__":
    unittest.main()
