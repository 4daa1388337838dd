# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/benchmarks.md: what docs/makeBenchmarks makes of benchmarks.json and expected.json; each verdict is that of its numbers."""
import importlib.machinery
import importlib.util
import os
import subprocess
import unittest

from tests.cases import harness

DOCS = os.path.join(harness.SOURCE, "docs")
CASES = os.path.join(harness.SOURCE, "cases")
SPEC = {"case": "faraday", "quantity": "wavelength", "what": "wavelength", "source": "Table 1", "sure": "printed"}  # 42.857


def script():
    """docs/makeBenchmarks as a module."""
    loader = importlib.machinery.SourceFileLoader("makeBenchmarks", os.path.join(DOCS, "makeBenchmarks"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("makeBenchmarks", loader))
    loader.exec_module(module)
    return module


class Page(unittest.TestCase):
    def test_is_up_to_date(self):
        made = subprocess.run([os.path.join(DOCS, "makeBenchmarks"), "-print"], capture_output=True, text=True)
        self.assertEqual(made.returncode, 0, made.stderr)
        with open(os.path.join(DOCS, "benchmarks.md"), encoding="utf-8") as f:
            page = f.read()
        with open(os.path.join(harness.SOURCE, "README.md"), encoding="utf-8") as f:
            table = f.read().partition("<!-- benchmarks: made by docs/makeBenchmarks -->\n")[2].partition("<!-- end -->")[0]
        self.assertEqual(page + table, made.stdout, "run docs/makeBenchmarks")

    def test_benchmarks(self):
        """Each has a number of its own, cases that run, a picture, and at least one number; a case takes two minutes at most."""
        made = script()
        known = made.load()
        numbers = [b["number"] for b, _ in known]
        self.assertEqual(sorted(set(numbers)), numbers)
        self.assertLessEqual(set(numbers), set(range(1, 16)))
        # three, and the collapse of a column: at a = 7 its front scatters by a cell, across the end of the band
        self.assertLessEqual(sum(not all(r.inside for r in rows) for _, rows in known), 4, "benchmarks outside")
        for b, rows in known:
            with self.subTest(b["title"]):
                self.assertTrue(rows)
                self.assertTrue(os.path.isfile(os.path.join(CASES, b["picture"])))
                self.assertTrue(os.path.isfile(os.path.join(harness.SOURCE, made.small(b))), "run docs/makeBenchmarks -small")
                for name in b["cases"]:
                    self.assertTrue(os.access(os.path.join(CASES, name, "Allrun"), os.X_OK))
                    self.assertLessEqual(made.expected.read(os.path.join(CASES, name))["seconds"], 120)
                self.assertLessEqual({r.case for r in rows}, set(b["cases"]))


class Verdict(unittest.TestCase):
    def test_of_numbers(self):
        compared = script().compared
        self.assertTrue(compared({**SPEC, "reference": 39, "band": 4}).inside)
        row = compared({**SPEC, "reference": 39, "band": 3, "why": "another wave"})
        self.assertEqual((row.inside, row.why), (False, "another wave"))
        self.assertEqual(compared({**SPEC, "reference": 39, "band": 4, "why": "not needed"}).why, "")
        self.assertEqual(compared({**SPEC, "scale": 2}).reference, 78, "that of expected.json")

    def test_beside_another_case(self):
        row = script().compared({**SPEC, "time": 8, "scale": 2, "reference": {"case": "faradayMD", "time": 20}, "band": 11})
        self.assertAlmostEqual(row.reference, 75)

    def test_refused(self):
        compared = script().compared
        for change, why in (({"reference": 39, "band": 3}, "lies outside of 39"), ({"quantity": "wave"}, "0 entries of full"), ({"of": "told", "quantity": "wavelength, L = 150"}, "2 entries of told"),
                            ({"case": "silo", "quantity": "outflow over a span"}, "2 entries of full")):
            with self.assertRaisesRegex(SystemExit, why):
                compared({**SPEC, **change})


if __name__ == "__main__":
    unittest.main()
