# SPDX-License-Identifier: GPL-3.0-or-later
"""Allcheck: cases in full in copies, beside their expected values; what is run again, and what fails."""
import json
import os
import re
import shutil
import subprocess
import unittest
from unittest import mock

from tests.cases import harness
from tests.cases.harness import expected

from haff import paths
from studies import faradayRows
from studies.checks import checkCases


class CheckCases(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """A repository with one case, `sod`, that draws no figure."""
        super().setUpClass()
        cls.top = os.path.join(cls.folder, "a folder")
        cls.case = os.path.join(cls.top, "cases", "sod")
        shutil.copytree(os.path.join(harness.SOURCE, "cases", "sod"), cls.case, ignore=shutil.ignore_patterns("[1-9]*", "0", "0.[0-9]*", "*.png", "polyMesh"))
        allrun = os.path.join(cls.case, "Allrun")
        with open(allrun) as f:
            text = f.read()
        with open(allrun, "w") as f:
            f.write(text.replace(' && draw "$case"', ""))
        shutil.copytree(os.path.join(harness.SOURCE, ".ci"), os.path.join(cls.top, ".ci"))
        os.symlink(os.path.join(harness.SOURCE, "postprocessing"), os.path.join(cls.top, "postprocessing"))
        os.makedirs(os.path.join(cls.top, "build"))
        os.symlink(harness.BIN, os.path.join(cls.top, "build", "bin"))

    def check(self, *arguments, code=0):
        with mock.patch.object(paths, "TOP", self.top), mock.patch.dict(os.environ):
            done = harness.command("checkCases", *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def expect(self, **entry):
        path = os.path.join(self.case, "expected.json")
        with open(path) as f:
            known = json.load(f)
        known["full"][0].update(entry)
        with open(path, "w") as f:
            json.dump(known, f)

    def spent(self):
        with open(os.path.join(self.top, "build", "check", "sod.json")) as f:
            return json.load(f)["seconds"]

    def test_runs(self):
        shutil.rmtree(os.path.join(self.top, "build", "check"), ignore_errors=True)  # of other tests
        self.assertIn("not run: sod", self.check("-within", "0"))
        self.assertFalse(os.path.exists(os.path.join(self.top, "build", "check", "cases")))
        out = self.check()
        self.assertEqual((out.count("  ok\n"), out.count("FAILED")), (2, 0), out)
        self.assertIn("1 of 1 cases", out)
        self.assertEqual(sorted(os.listdir(self.case)), sorted(set(os.listdir(self.case)) - {"0.2", "postProcessing"}))
        first = self.spent()
        self.check("sod")
        self.assertEqual(self.spent(), first)  # nothing has changed
        self.expect(value=1.2)
        self.assertRegex(self.check(code=1), r"maximum T at t = 0.2 +1\.14\d+ +1\.2 +\S+  FAILED")
        self.expect(value=1.1414, time=0.17)
        self.assertIn("time 0.17 was not written", self.check(code=1))
        self.assertEqual(self.spent(), first)  # other values need no other run
        self.expect(time=0.2)
        harness.edit(self.case, "system/controlDict", endTime=0.1)
        self.assertIn("time 0.2 was not written", self.check(code=1))
        harness.edit(self.case, "system/controlDict", endTime="soon")
        self.assertRegex(self.check(code=1), r"sod +Allrun ended with 1; see .*sod\.log +FAILED")
        harness.edit(self.case, "system/controlDict", endTime=0.2)
        self.check()

    def test_writes_down(self):
        """-record writes down what was measured and the seconds, and nothing else; without it Allcheck points at what is not that."""
        before = expected.read(self.case)
        expected.save(self.case, {**before, "seconds": 1000})
        self.expect(measured=1.5)
        self.assertRegex(self.check(), r"maximum T at t = 0.2 .* ok, but 1\.5 is written down \(-record\)\n")
        self.assertNotIn("written down (", self.check("-record"))
        after = expected.read(self.case)
        self.assertAlmostEqual(after["full"][0]["measured"], 1.1431, 4)
        self.assertEqual(after.pop("seconds"), float(f"{self.spent():.2g}"))
        del before["seconds"]
        for entry in before["full"] + after["full"]:
            del entry["measured"]
        self.assertEqual(after, before)

    def test_variants(self):
        """A variant runs as a copy of the case with its entries and grid; without -record a value that was never written down fails."""
        known = expected.read(self.case)
        entry = {"quantity": "maximum", "field": "T", "tolerance": 1e-4}
        known["variants"] = [{"name": "N=40", "mesh": {"N": 40}, "changes": {"system/controlDict": {"endTime": 0.1}}, "full": [{**entry, "time": [0, 0.1]}]}]
        expected.save(self.case, known)
        self.addCleanup(expected.save, self.case, {k: v for k, v in known.items() if k != "variants"})
        self.assertRegex(self.check("-list"), r"sod/N=40 +0 s +2 values")
        self.assertEqual(self.check("sod/N=40", code=1).count("FAILED"), 2)
        self.assertNotIn("sod  ", self.check("sod/N=40", "-record"))
        made = expected.read(self.case)["variants"][0]
        self.assertGreater(made["seconds"], 0)
        expected.save(self.case, {**known, "variants": [{**made, "seconds": 1000}]})
        self.check("sod/N=40", "-record")
        self.assertEqual(expected.read(self.case)["variants"][0], made)
        self.assertEqual(self.check("sod/N=40").count("  ok\n"), 2)
        copy = os.path.join(self.top, "build", "check", "variants", "sod-N=40", "sod")
        self.assertEqual((harness.haff.Case(copy).mesh.cells, harness.haff.Case(copy).times[-1]), (40, "0.1"))
        self.assertFalse(os.path.exists(os.path.join(copy, "VTK")))
        expected.save(self.case, {**known, "variants": [{**made, "named": True}]})
        self.assertRegex(self.check(), r"1 of 2 cases and variants .*\nnot run: sod/N=40 \(")
        self.assertIn("1 of 2 cases", self.check("sod/N=40"))
        self.assertRegex(self.check("-list"), r"sod/N=40 +\S+ s +2 values  if named\n")
        made["mesh"]["N"] = 50
        made["full"][0]["measured"][1] += 1e-2
        expected.save(self.case, {**known, "variants": [made]})
        self.assertRegex(self.check("sod/N=40", code=1), r"T at t = 0.1 .*FAILED")
        self.assertEqual(harness.haff.Case(copy).mesh.cells, 50, "another grid makes another run")
        expected.save(self.case, {**known, "variants": [made, {"name": "more", "full": [{**entry, "time": 0.2}]}]})
        self.assertIn("3 of 3 cases", self.check("sod/more", "sod", "-record"))
        self.assertEqual((expected.read(self.case)["variants"][1]["full"][0]["measured"], "seconds" in expected.read(self.case)["variants"][1]), (1.14313, False))
        self.assertFalse(os.path.exists(os.path.join(self.top, "build", "check", "variants", "sod-more")), "it is the run of the case")
        made["ends"] = 2
        expected.save(self.case, {**known, "variants": [made]})
        shutil.rmtree(copy)
        self.assertIn("the run reached its end, and did not stop with 2", self.check("sod/N=40", code=1))

    def test_words(self):
        """Allrun gets the words of expected.json; other words make another run."""
        allrun, known = os.path.join(self.case, "Allrun"), expected.read(self.case)
        shutil.copy(allrun, self.folder)
        self.addCleanup(shutil.copy, os.path.join(self.folder, "Allrun"), allrun)
        self.addCleanup(expected.save, self.case, known)
        with open(allrun, "w") as f:
            f.write('#!/bin/sh\necho "words: $@"\n')
        for words in ("-rows 1,2", "-rows 3"):
            expected.save(self.case, {**known, "words": words})
            self.check("sod", code=1)
            with open(os.path.join(self.top, "build", "check", "sod.log")) as f:
                self.assertEqual(f.read(), f"words: {words}\n")

    def test_families(self):
        """Cases that take files of each other run one after the other, all others at once; none is left out."""
        known = checkCases.copies_in(os.path.join(self.folder, "nothing"))
        families = [{copy.name for copy in copies} for copies in checkCases.families(known)]
        self.assertEqual(sorted(name for family in families for name in family), sorted(copy.name for copy in known))
        self.assertEqual([{"wedge", "wedgeDense", "segregationWedge"} <= family for family in families].count(True), 1)
        self.assertIn({"columnCollapse"}, families)

    def test_expected(self):
        """haff expected CASE: a line a value, exit code 1 if one is off."""
        case = harness.copy("sod", self.folder)
        harness.mesh(case, 40)
        harness.run(case)

        def ask():
            done = harness.command("expected", case)
            return done.returncode, done.stdout
        code, said = ask()
        self.assertEqual((code, said.count("ok  ")), (0, 2), said)
        known = expected.read(case)
        known["full"][0]["value"] = 1.2
        expected.save(case, known)
        code, said = ask()
        self.assertEqual(code, 1, said)
        self.assertRegex(said, r"^BAD maximum T at t = 0.2: 1\.14\d+, expected 1\.2 \+- 0\.003\nok  minimum rho")

    def test_files_of_the_tree_are_there(self):
        """What the package takes from the top of the tree is found from the copies, too."""
        self.check()
        with open(faradayRows.__file__, encoding="utf-8") as f:
            found = re.search(r'os\.path\.join\(TOP, "(\w+)", "(\w+)", "([\w.]+)"\)', f.read())
        os.makedirs(os.path.join(self.top, *found.groups()[:2]), exist_ok=True)
        shutil.copy(os.path.join(harness.SOURCE, *found.groups()), os.path.join(self.top, *found.groups()))
        self.assertTrue(os.path.isfile(os.path.join(self.top, "build", "check", *found.groups())), found.group())

    def test_command_line(self):
        self.assertIn("no case sodd; there are: sod", self.check("sodd", code=2))
        done = subprocess.run(["/usr/bin/python3", "-m", "haff", "checkCases", "-list"], capture_output=True, text=True, env={**os.environ, "HAFF_SOURCE": self.top})
        self.assertRegex(done.stdout, r"sod +[\d.]+ s +2 values")
        with mock.patch.dict(os.environ, HAFF_BIN=self.folder):
            self.assertIn("is not there: build haff", self.check(code=1))


if __name__ == "__main__":
    unittest.main()
