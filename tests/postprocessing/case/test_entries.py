# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries of dictionaries by their path: read, set, made, removed, and everything else in the file stays."""
import os
import shutil
import tempfile
import unittest

from tests.cases.harness import SOURCE, haff
from haff.case import entries

TEXT = """/* grain { restitution 5; } */
FoamFile { version 2.0; format ascii; class dictionary; object p; }
// restitution 3;
grain { diameter 0.1; mass 1; restitution   0.97; } // of glass; not of steel
schemes
{
    div(rhoPhi,U)   Gauss linear;   // a name with brackets
    "(left|right)"  { type fixedValue; value uniform (1 0 -2.5e-3); }
    expr  "a; b { c";
}
list ((0 1) (2 3)
      (4 5));
empty;
#remove nothing
twice 1;
twice 2;
nested { a { b 1; } }
"""


class Entries(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="haff")
        self.path = os.path.join(self.folder, "p")
        with open(self.path, "w") as f:
            f.write(TEXT)

    def tearDown(self):
        shutil.rmtree(self.folder)

    def text(self):
        with open(self.path) as f:
            return f.read()

    def check(self, changes, old, new):
        entries.edit(self.path, changes)
        self.assertIn(old, TEXT)
        self.assertEqual(self.text(), TEXT.replace(old, new))

    def test_read(self):
        for path, value in (("grain/restitution", 0.97), ("schemes/div(rhoPhi,U)", "Gauss linear"), ("list", [[0, 1], [2, 3], [4, 5]]),
                            ("schemes/(left|right)/value", "uniform (1 0 -2.5e-3)"), ("schemes/expr", "a; b { c"), ("twice", 2),
                            ("nested/a", " b 1; "), ("empty", ""), (("nested", "a", "b"), 1)):
            with self.subTest(path):
                self.assertEqual(entries.get(self.path, path), value)

    def test_set(self):
        self.check({"grain/restitution": 0.1 + 0.2}, "restitution   0.97", "restitution   0.30000000000000004")

    def test_values(self):
        for value, text in ((True, "yes"), (3, "3"), ((1, 0.5, -2), "(1 0.5 -2)"), ("uniform 4", "uniform 4"), ([[1, 2], [3, 4]], "((1 2) (3 4))")):
            self.assertEqual(entries.as_text(value), text)

    def test_the_last_of_two_counts(self):
        self.check({"twice": 7}, "twice 2;", "twice 7;")

    def test_nested_values(self):
        self.check({"schemes": {"(left|right)": {"type": "zeroGradient"}}}, "type fixedValue", "type zeroGradient")

    def test_empty_gets_a_value(self):
        self.check({"empty": "no more"}, "empty;", "empty no more;")

    def test_lists_of_several_lines(self):
        self.check({"list": [[9]]}, "((0 1) (2 3)\n      (4 5))", "((9))")

    def test_removed(self):
        self.check({"schemes/div(rhoPhi,U)": None, "grain/mass": None, "twice": None, "nested": None},
                   TEXT, TEXT.replace("    div(rhoPhi,U)   Gauss linear;   // a name with brackets\n", "    // a name with brackets\n")
                   .replace("mass 1; ", "").replace("twice 2;\n", "").replace("nested { a { b 1; } }\n", ""))

    def test_made(self):
        self.check({"+grain/thresholdSpeed": 0.1}, "0.97; }", "0.97; thresholdSpeed 0.1; }")
        self.assertEqual(entries.get(self.path, "grain/thresholdSpeed"), 0.1)
        entries.edit(self.path, {"+schemes/more": 1, "+fresh/deep/x": 2, "+nested/a/c": 3, "+grain/mass": 5, "+schemes/(a|b)": "none"})
        for path, value in (("schemes/more", 1), ("fresh/deep/x", 2), ("nested/a/c", 3), ("grain/mass", 5), ("schemes/(a|b)", "none")):
            self.assertEqual(entries.get(self.path, path), value)

    def test_unknown_entries(self):
        for path, near in (("grain/restitutoin", "grain/restitution"), ("restitution", "grain/restitution"), ("schemes/exprs", "schemes/expr")):
            with self.assertRaises(entries.EntryError) as caught:
                entries.edit(self.path, {"twice": 3, path: 1})
            self.assertIn(self.path, str(caught.exception))
            self.assertIn(f"did you mean '{near}'", str(caught.exception))
        self.assertEqual(self.text(), TEXT)  # not even what could be set

    def test_anywhere(self):
        entries.edit(self.path, {"restitution": 0.5, "b": 4}, anywhere=True)
        self.assertEqual(self.text(), TEXT.replace("0.97", "0.5").replace("b 1", "b 4"))

    def test_no_dictionary(self):
        for text, line, what in (("a 1;\nb { c 2;\n", 2, "not closed"), ("a 1;\n}\n", 2, "closes nothing"), ("a 1\n", 1, "';'"), ("a 1;\n\n( b )\n", 3, "name of an entry")):
            with self.assertRaisesRegex(entries.EntryError, f"d:{line}: .*{what}"):
                entries.parse(text, "d")

    def test_files(self):
        with self.assertRaisesRegex(FileNotFoundError, "did you mean p"):
            entries.edit(self.path + "p", {"twice": 1})
        os.makedirs(os.path.join(self.folder, "b"))
        with self.assertRaises(FileNotFoundError):
            entries.edit_case(self.folder, {"p": {"twice": 1}, "b/q": {"x": 1}})
        self.assertEqual(self.text(), TEXT)
        entries.edit_case(self.folder, {"p": {"twice": 1}})
        self.assertEqual(entries.get(self.path, "twice"), 1)

    def test_every_shipped_dictionary_is_read(self):
        """Each entry of each dictionary of the cases can be set to its own value, and the file stays as it is."""
        files = 0
        for folder, _, names in os.walk(os.path.join(SOURCE, "cases")):
            for name in names:
                if os.path.basename(folder) in ("system", "constant", "0.orig"):
                    with open(os.path.join(folder, name), encoding="latin-1", newline="") as f:
                        text = f.read()
                    for entry in entries.parse(text, name):
                        if not entry.is_dictionary and entry is entries.last(entries.parse(text, name), entry.path):
                            self.assertEqual(entries.changed(text, name, entry.path, text[slice(*entry.value)]), text)
                    files += 1
        self.assertGreater(files, 200)

    def test_drop(self):
        path = os.path.join(self.folder, "controlDict")
        shutil.copy(os.path.join(SOURCE, "cases", "sod", "system", "controlDict"), path)
        self.assertEqual(entries.drop(path, "vtk"), 1)
        self.assertEqual(entries.drop(path, "vtk"), 0)
        self.assertEqual(entries.get(path, "functions/mass/type"), "volFieldValue")
        with self.assertRaises(entries.EntryError):
            entries.get(path, "functions/vtk/type")


if __name__ == "__main__":
    unittest.main()
