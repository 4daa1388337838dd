# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables in READMEs of cases and in reports: each is written by a command, or says what measured it and when, or has no number of haff."""
import glob
import importlib.machinery
import importlib.util
import json
import os
import re
import subprocess
import tempfile
import unittest

from tests.cases import harness
from tests.cases.harness import expected

SCRIPT = os.path.join(harness.SOURCE, "docs", "makeTables")
STANDS_BELOW = (
    r"<!-- table \w+: made by docs/makeTables -->",
    r"Measured at [0-9a-f]{7,40}, 20\d\d-[01]\d-[0-3]\d: `[^`]+`\.",
    r"<!-- table: given -->",
)
WHOLE = {"postprocessing/reports/stress.md": "tests/stress/report.py", "postprocessing/reports/faults.md": "tests/faults/table"}  # page: what writes all of it


def script():
    """docs/makeTables as a module."""
    loader = importlib.machinery.SourceFileLoader("makeTables", SCRIPT)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("makeTables", loader))
    loader.exec_module(module)
    return module


def tables(text):
    """(number of the line, the last line above that is not empty) of each table with a head: the table without one lists what is set."""
    lines = text.split("\n")
    for n in range(len(lines) - 1):
        if re.match(r"\|.*\w", lines[n]) and re.fullmatch(r"\|(\s*:?-+:?\s*\|)+", lines[n + 1].strip()):
            yield n + 1, next((line for line in reversed(lines[:n]) if line.strip()), "")


def unmarked(text):
    return [n for n, above in tables(text) if not any(re.fullmatch(line, above) for line in STANDS_BELOW)]


class Pages(unittest.TestCase):
    def test_every_table_says_where_it_is_from(self):
        """No table stands without such a line."""
        for page in glob.glob("cases/*/README.md", root_dir=harness.SOURCE) + glob.glob("postprocessing/reports/*.md", root_dir=harness.SOURCE):
            with open(os.path.join(harness.SOURCE, page), encoding="utf-8") as f:
                lines = unmarked(f.read())
            with self.subTest(page):
                if page in WHOLE:
                    self.assertTrue(os.path.exists(os.path.join(harness.SOURCE, WHOLE[page])))
                else:
                    self.assertEqual(lines, [], f"tables without a line that says where they are from: lines {lines}; see tests/README.md")

    def test_are_what_the_command_writes(self):
        done = subprocess.run([SCRIPT, "-check"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"run docs/makeTables\n{done.stdout}{done.stderr}")

    def test_lines_that_count(self):
        table = "| a | b |\n|---|---:|\n| 1 | 2 |\n"
        for line, counts in (("<!-- table x: made by docs/makeTables -->", True), ("<!-- table: given -->", True), ("text", False), ("", False),
                             ("Measured at 1c7b618d, 2026-11-27: `haff run cases/sod`.", True), ("Measured at 1c7b618d: `haff run cases/sod`.", False),
                             ("Measured at HEAD, 2026-11-27: `haff run cases/sod`.", False)):
            self.assertEqual(unmarked(f"{line}\n{table}") == [], counts, line)
            self.assertEqual(unmarked(f"{line}\n\n{table}") == [], counts, line)
        self.assertEqual(unmarked(f"<!-- table: given -->\n{table}\n{table}"), [6], "one line is for one table")


class Made(unittest.TestCase):
    """A case of two variants, one of which stopped."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="haff")
        self.addCleanup(folder.cleanup)
        self.path, self.made = os.path.join(folder.name, "case"), script()
        os.makedirs(self.path)
        entry = {"quantity": "maximum", "field": "T", "time": [1, 2], "tolerance": 0.01}
        expected.save(self.path, {"full": [{"quantity": "minimum", "field": "T", "time": 1, "value": 3, "tolerance": 1, "measured": 3.14159},
            {"quantity": "minimum", "field": "T", "time": 1, "folder": "copy", "value": 2, "tolerance": 1, "measured": 2.71828}], "variants": [
            {"name": "coarse", "full": [{**entry, "measured": [1.234, 2.344]}]},
            {"name": "fine", "full": [{**entry, "time": [1], "measured": [1.5]}, {"quantity": "last time", "tolerance": 0.1, "measured": 1.61}]},
            {"name": "new", "full": [entry]}]})
        self.table = {"head": ["", "1", "2"], "columns": [{"time": 1}, {"time": 2}],
                      "each": {"quantity": "maximum", "field": "T", "format": "{:.2f}"}, "rows": [{"cells": ["c"], "of": "coarse"}]}

    def rows(self, *rows, **others):
        return self.made.made(self.path, {**self.table, **others, "rows": list(rows)}).split("\n")[2:-1]

    def test_cells(self):
        """A number is described by the cell, else its row, else its column, else the table."""
        self.assertEqual(self.made.made(self.path, self.table), "| | 1 | 2 |\n|---|---|---|\n| c | 1.23 | 2.34 |\n")
        self.assertEqual(self.rows(["a", "", "b"]), ["| a | | b |"])
        self.assertEqual(self.rows({"cells": ["c", {"time": 2, "format": "{:.1f}"}, ""], "of": "coarse"}), ["| c | 2.3 | |"])
        self.assertEqual(self.rows({"cells": ["c", "", {"time": [1, 2], "scale": 10, "format": "{:.1f} K"}], "of": "coarse"}), ["| c | | 12.3 K, 23.4 K |"])
        self.assertEqual(self.rows({"cells": ["c", {"of": "full", "quantity": "minimum", "format": "{:.4f}"}, ""]}), ["| c | 3.1416 | |"])
        self.assertEqual(self.rows({"cells": ["c", {"of": "full", "quantity": "minimum", "folder": "copy", "format": "{:.4f}"}, ""]}), ["| c | 2.7183 | |"])
        self.assertEqual(self.rows({"cells": ["c", {"of": "fine", "order": "coarse", "format": "{:.1f}"}, ""]}), ["| c | -0.3 | |"], "log2(1.234/1.5)")
        self.assertEqual(self.rows({"cells": ["c"], "of": "coarse", "scale": 0.01, "format": "{:.2e}"}), ["| c | 1.23e-2 | 2.34e-2 |"])
        self.assertEqual(self.rows({"cells": ["c"], "of": "coarse"}, columns=[{"time": 1, "format": "{:.1f}"}, {"time": 2}]), ["| c | 1.2 | 2.34 |"])
        self.assertEqual(self.rows({"cells": ["c"], "of": "case/coarse"}), ["| c | 1.23 | 2.34 |"])
        with self.assertRaisesRegex(FileNotFoundError, "other/expected.json is not there"):
            self.rows({"cells": ["c"], "of": "other/coarse"})
        stop = {"quantity": "last time", "format": "stops at {:.1f}"}
        self.assertEqual(self.rows({"cells": ["c"], "of": "fine"}, otherwise=stop), ["| c | 1.50 | stops at 1.6 |"])

    def test_refused(self):
        for row, why in (({"of": "fine"}, "fine has no maximum T at t = 2"), ({"of": "finer"}, "no variant 'finer'"), ({"of": "new"}, "of new was not measured"),
                         ({"cells": ["c", {"of": "fine", "order": "coarse"}, ""]}, "more digits than its tolerance of 0.0213"),
                         ({"of": "coarse", "format": "{:.3f}"}, "more digits than its tolerance of 0.01"),
                         ({"of": "coarse", "format": "{:.3e}", "scale": 0.01}, "more digits than")):
            with self.assertRaisesRegex(ValueError, why):
                self.rows({"cells": ["c"], **row})

    def test_places(self):
        """The README changes between the lines of the table alone; a table without a place, and a place without one, are refused."""
        def page(text, tables):
            with open(os.path.join(self.path, "README.md"), "w") as f:
                f.write(text)
            with open(os.path.join(self.path, "tables.json"), "w") as f:
                json.dump(tables, f)
            return self.made.written(self.path)
        place = "a\n<!-- table x: made by docs/makeTables -->\n{}<!-- end -->\nb\n"
        old, new = page(place.format("| old |\n"), {"x": self.table})
        self.assertEqual((old, new), (place.format("| old |\n"), place.format(self.made.made(self.path, self.table))))
        for text, tables_ in (("a", {"x": self.table}), (place, {}), (place + place, {"x": self.table})):
            with self.assertRaisesRegex(ValueError, "has places for the tables"):
                page(text, tables_)


if __name__ == "__main__":
    unittest.main()
