# SPDX-License-Identifier: GPL-3.0-or-later
"""checkCase -fix: it shows what it would write, and writes that alone with -write; what is not certain stays."""
import os
import shutil
import tempfile
import unittest

from tests.cases import harness
from tests.solvers.programs import bad_case
from tests.solvers.programs.bad_rows import CONTROL, GRAVITY, PROPERTIES, SCHEMES, SHAKING, append, both, rename, replace, write
from tests.solvers.programs.test_bad_input import snapshot

# The mistake; the file, and its line before and after.
CURES = {
    "a key": (replace(CONTROL, "maxCo 0.5;", "maxC0 0.5;"), CONTROL, "maxC0 0.5;", "maxCo 0.5;"),
    "a key that must be there": (replace(CONTROL, "endTime 0.002;", "endtime 0.002;"), CONTROL, "endtime 0.002;", "endTime 0.002;"),
    "a key in a dictionary": (replace(PROPERTIES, "    restitution 0.9;", "    restitutoin 0.9;"), PROPERTIES, "    restitutoin 0.9;",
                              "    restitution 0.9;"),
    "a model": (replace(SCHEMES, "fluxScheme common;", "fluxScheme comon; // the flux"), SCHEMES, "fluxScheme comon; // the flux",
                "fluxScheme common; // the flux"),
    "a function object": (replace(CONTROL, "type fieldMinMax;", "type fieldMinMac;"), CONTROL,
                          "    extremes { type fieldMinMac; fields (p); log false; }", "    extremes { type fieldMinMax; fields (p); log false; }"),
    "a field of one": (replace(CONTROL, "fields (alpha U);", "fields (alfa U);"), CONTROL, "        fields (alfa U);", "        fields (alpha U);"),
    "a type of a patch": (replace("0/T", "type slip;", "type slipp;"), "0/T", "        type slipp;", "        type slip;"),
    "a letter and its neighbour": (replace(CONTROL, "endTime 0.002;", "enTdime 0.002;"), CONTROL, "enTdime 0.002;", "endTime 0.002;"),
    "a class": (replace("0/U", "volVectorField", "volScalarField"), "0/U", "    class       volScalarField;", "    class       volVectorField;"),
    "an object": (replace(SCHEMES, "object      fvSchemes;", "object      fvSolution;"), SCHEMES, "    object      fvSolution;",
                  "    object      fvSchemes;"),
    "a largest step of fixed ones": (replace(CONTROL, "maxDeltaT 1;", "maxDeltaT 1e-6; // of no use"), CONTROL, "maxDeltaT 1e-6; // of no use",
                                     " // of no use"),
    "a function object behind the end": (
        replace(CONTROL, "writeControl timeStep;\n        writeInterval 1;", "writeControl runTime;\n        writeInterval 7;"), CONTROL,
        "        writeInterval 7;", "        writeInterval 0.0002;"),
    "a write behind the end": (replace(CONTROL, "writeInterval 0.001;", "writeInterval 1;"), CONTROL, "writeInterval 1;", "writeInterval 0.0002;"),
}


class Fix(harness.Folder, unittest.TestCase):
    def case(self, spoil):
        case = os.path.join(tempfile.mkdtemp(dir=self.folder), "case")
        bad_case.write(case)
        spoil(case)
        return case

    def check(self, *words):
        done = harness.program("checkCase", *words, check=False)
        self.assertNotRegex(done.stderr, r"\.[ch]:\d|Sanitizer|runtime error")
        return done

    def test_lines(self):
        """Each is shown with its line before and after, and nothing is written; -write changes that line alone, and the case is sound."""
        for name, (spoil, file, before, after) in CURES.items():
            with self.subTest(name):
                case = self.case(spoil)
                with open(os.path.join(case, file)) as f:
                    text = f.read()
                was = snapshot(case)
                place = f"  {case}/{file}:{1 + text[:text.index(before)].count(chr(10))}:\n    - {before}\n    + {after}\n"
                said = self.check("-fix", case).stdout
                self.assertIn(place, said)
                self.assertIn(f"Nothing was written;  checkCase -fix -write {case}  makes this change", said)
                self.assertEqual(snapshot(case), was)
                done = self.check(case, "-fix", "-write")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(place, done.stdout)
                self.assertIn("1 change made.", done.stdout)
                self.assertIn("The case is sound.", done.stdout)
                with open(os.path.join(case, file)) as f:
                    self.assertEqual(f.read(), text.replace(before, after, 1))
                self.assertEqual({k for k, _ in set(snapshot(case).items()) ^ set(was.items())}, {file})

    def test_names(self):
        for wrong, right in (("constant/shakng", SHAKING), ("constant/gravity", GRAVITY), ("system/shaking", SHAKING)):
            with self.subTest(wrong):
                case = self.case(rename(right, wrong) if right == SHAKING else both(lambda c: os.remove(os.path.join(c, SHAKING)), rename(right, wrong)))
                was = snapshot(case)
                said = self.check("-fix", case).stdout
                self.assertIn(f"    - {case}/{wrong}\n    + {case}/{right}\n", said)
                self.assertEqual(snapshot(case), was)
                self.assertIn("The case is sound.", self.check("-fix", "-write", case).stdout)
                self.assertEqual(snapshot(case), {right if k == wrong else k: v for k, v in was.items()})

    def test_missing(self):
        """A file without which nothing can be read is found under its other name."""
        for wrong, right in (("constant/granularPropertis", PROPERTIES), ("constant/granularProps", PROPERTIES), ("0/alfa", "0/alpha"), ("system/fvshemes", SCHEMES)):
            with self.subTest(wrong):
                done = self.check("-fix", "-write", self.case(rename(right, wrong)))
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn("The case is sound.", done.stdout)

    def test_error_and_name(self):
        """A misnamed file does not hide the word that the error behind it asks for."""
        case = self.case(both(rename(GRAVITY, "constant/gravity"), CURES["a key in a dictionary"][0]))
        said = self.check("-fix", case).stdout
        self.assertIn(f"    + {case}/{GRAVITY}\n", said)
        self.assertIn("    +     restitution 0.9;\n", said)
        self.assertIn("makes these changes, and looks for more behind the error.", said)

    def test_all(self):
        """-write goes on behind each error, until nothing is left."""
        case = self.case(both(*(CURES[name][0] for name in ("a key", "a model", "a type of a patch", "a class", "a write behind the end")),
                              rename(SHAKING, "constant/Shaking")))
        done = self.check("-fix", "-write", case)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("The case is sound.", done.stdout)
        other = self.case(lambda c: None)
        harness.edit(other, CONTROL, writeInterval="0.0002")
        for file in (CONTROL, SHAKING, "0/T", "0/U"):
            with open(os.path.join(case, file)) as a, open(os.path.join(other, file)) as b:
                self.assertEqual(a.read(), b.read())

    def test_left_alone(self):
        """What is uncertain, accepted, a link or zipped is not changed."""
        def link(case):
            shutil.move(os.path.join(case, CONTROL), self.folder + "/elsewhere")
            os.symlink(self.folder + "/elsewhere", os.path.join(case, CONTROL))

        for name, spoil, says in (
                ("a word that is like none", replace(SCHEMES, "fluxScheme common;", "fluxScheme Kurganov;"), "Nothing"),
                ("a word that is as like two", replace(SCHEMES, "timeScheme SSPRK3;", "timeScheme SSPRK34;"), "Nothing"),
                ("an amplitude in metres", replace(SHAKING, "amplitude 3;", "amplitude 0.01;"), "Nothing"),
                ("a file beside the one that counts", write("constant/shakng", ""), "Nothing"),
                ("what is accepted", both(CURES["an object"][0], append(CONTROL, "acceptWarnings (wrongHeader);\n")), "Nothing"),
                ("a link", both(CURES["a key"][0], link), "Nothing")):
            with self.subTest(name):
                case = self.case(spoil)
                was = snapshot(case)
                self.assertIn(says, self.check("-fix", "-write", case).stdout)
                self.assertEqual(snapshot(case), was)

    def test_words(self):
        case = self.case(lambda c: None)
        said = self.check("-fix", case)
        self.assertEqual((said.returncode, said.stdout), (0, "The case is sound.\nNothing here has a cure that is certain.\n"))
        self.assertIn("say  -fix -write", self.check("-write", case).stderr)
        self.assertIn("unknown argument '-fix'", harness.program("initialFields", "-fix", case, check=False).stderr)


if __name__ == "__main__":
    unittest.main()
