# SPDX-License-Identifier: GPL-3.0-or-later
"""haffVersion of system/controlDict: what the programs say of a case that was written for an older or a newer haff."""
import glob
import os
import re
import shutil
import subprocess
import tempfile
import unittest

from tests.cases import harness
from tests.solvers.programs import bad_case

OWN = re.search(r"^project\(haff VERSION (\d+)\.(\d+)", open(os.path.join(harness.SOURCE, "CMakeLists.txt")).read(), re.M)
MAJOR, MINOR = int(OWN[1]), int(OWN[2])


class Version(harness.Folder, unittest.TestCase):
    def check(self, version, properties=(), solution="", *options, schemes=""):
        """What checkCase says of the box of bad_case, with a version, entries set and text added to fvSolution."""
        case = os.path.join(tempfile.mkdtemp(dir=self.folder), "case")
        bad_case.write(case)
        path = os.path.join(case, "system", "controlDict")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("startFrom", f"haffVersion {version};\nstartFrom", 1) if version else text)
        if properties:
            harness.dictionary.edit(os.path.join(case, "constant", "granularProperties"), dict(properties))
        with open(os.path.join(case, "system", "fvSolution"), "a") as f:
            f.write(solution)
        path_of_schemes = os.path.join(case, "system", "fvSchemes")
        with open(path_of_schemes) as f:
            text = f.read()
        with open(path_of_schemes, "w") as f:
            f.write(text.replace("fluxScheme common;", schemes))
        done = subprocess.run([os.path.join(harness.BIN, "checkCase"), case, *options], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr.replace(case, "CASE"), path

    THRESHOLD = (("+grain/thresholdSpeed", 1e-3),)

    def test_own_and_none(self):
        for version in (None, f"{MAJOR}.{MINOR}", f"{MAJOR}.{MINOR}.9", f'"{MAJOR}.{MINOR}"'):
            code, said, wrong, _ = self.check(version, self.THRESHOLD)
            self.assertEqual((code, wrong), (0, ""), version)
            self.assertIn("The case is sound.", said)

    def test_newer(self):
        """A newer minor or major version is refused, with the line and the cure; 0.10 is not 0.1."""
        for version in (f"{MAJOR}.{MINOR + 1}", f"{MAJOR + 1}.0", f"{MAJOR + 1}.0.3", f"{MAJOR}.{MINOR}0"):
            code, _, wrong, _ = self.check(version)
            self.assertEqual(code, 1)
            self.assertIn(f"CASE/system/controlDict:10: key 'haffVersion' is {version}; the case was written for a newer haff", wrong)
            self.assertIn(f"get haff {'.'.join(version.split('.')[:2])}", wrong)

    def test_newer_comes_first(self):
        """A newer case may have keywords that are not known: the version is what is said of it."""
        self.assertIn("newer haff", self.check(f"{MAJOR}.{MINOR + 1}; unheardOf 1")[2])

    def test_no_version(self):
        for version in ("two", "2", "0.2 b", "0.2b", "0.2.1.1", "-1.0", "(0.2)", "[0 1 0 0 0 0 0] 0.2"):
            code, _, wrong, _ = self.check(version)
            self.assertEqual(code, 1, version)
            self.assertIn("expected the version of haff that the case was written for: 0.2", wrong)

    def test_older(self):
        """A warning where an entry is left out whose default has changed, and where that matters to the case."""
        rows = {"acoustics": (self.THRESHOLD, "acoustics { type explicit; }"),
                "diffusion": ((("+transport", "GarzoDufty"), ("cooling", "GarzoDufty")), "diffusion { type RKL2; }"),
                "TorquatoDisksCoeffs { tangent": ((("equationOfState", "TorquatoDisks"),), None)}
        for name, (properties, entry) in rows.items():
            with self.subTest(name):
                code, said, _, path = self.check("0.1", properties)
                found = re.findall(r"^warning: (.*) \[olderVersion\]$", said, re.M)
                self.assertEqual((code, len(found)), (0, 1), said[-1500:])
                self.assertTrue(found[0].startswith(f"{path}:10: the case was written for haff 0.1, and since 0.2 "), found)
                self.assertIn(f"say  {name} ", found[0])
                self.assertIn("haffVersion 0.2;", found[0])
                self.assertNotIn("olderVersion", self.check("0.2", properties)[1])
                code, _, wrong, _ = self.check("0.1", properties, "", "-strict")
                self.assertEqual(code, 1)
                self.assertIn("-strict: warning olderVersion", wrong)
                if entry:
                    self.assertIn(entry, found[0])
                    self.assertNotIn("olderVersion", self.check("0.1", properties, entry)[1])
                else:
                    named = (*properties, ("+TorquatoDisksCoeffs/tangent", "yes"))
                    self.assertNotIn("olderVersion", self.check("0.1", named)[1])

    def test_older_flux(self):
        """The log of a case with the flux `common` lists its rules for single faces."""
        found = re.findall(r"^warning: (.*) \[olderVersion\]$", self.check("0.1", schemes="fluxScheme common;")[1], re.M)
        rules, fronts = "commonCoeffs { shocks off; expansions off; contacts off; }", "commonCoeffs { fronts off; }"
        self.assertEqual([[off in text for off in (rules, fronts)] for text in found], [[True, False], [False, True]])
        found = re.findall(r"^warning: (.*) \[olderVersion\]$", self.check("0.2", schemes="fluxScheme common;")[1], re.M)
        self.assertEqual([fronts in text for text in found], [True])
        self.assertNotIn("olderVersion", self.check("0.1", schemes="fluxScheme common;" + rules)[1])

    def test_older_and_indifferent(self):
        """Nothing is said where none of that matters."""
        self.assertIn("The case is sound.", self.check("0.1")[1])
        self.assertIn("The case is sound.", self.check("0.1", (("+transport", "none"),))[1])

    def test_grains(self):
        """granularMD has no acoustics, whatever thresholdSpeed its grains have."""
        case = os.path.join(tempfile.mkdtemp(dir=self.folder), "grains")
        shutil.copytree(os.path.join(harness.SOURCE, "docs", "examples", "grains"), case)
        harness.boxes.write_mesh(case, (40, 20, 1), (0.08, 0.04, 0.002), {"x": "cyclic"})
        for field in ("alpha", "U", "T"):
            path = os.path.join(case, "0.orig", field)
            with open(path) as f:
                text = f.read()
            for old, new in (("left|right", "xLow|xHigh"), ("front|back", "zEmpty"), ("floor", "yLow"), ("lid ", "yHigh ")):
                text = text.replace(old, new)
            with open(path, "w") as f:
                f.write(text)
        harness.dictionary.edit(os.path.join(case, "constant", "particleProperties"), {"walls": None})
        harness.edit(case, "system/controlDict", haffVersion="0.1")
        self.assertNotIn("olderVersion", harness.program("checkCase", case).stdout)

    def test_shipped_cases_say_theirs(self):
        files = glob.glob(os.path.join(harness.SOURCE, "cases", "*", "system", "controlDict")) \
            + glob.glob(os.path.join(harness.SOURCE, "docs", "examples", "*", "system", "controlDict"))
        self.assertGreater(len(files), 40)
        for path in files:
            self.assertRegex(open(path).read(), rf"(?m)^haffVersion +{MAJOR}\.{MINOR};", path)


if __name__ == "__main__":
    unittest.main()
