# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/validation.md: what docs/makeValidation makes of expected.json, READMEs and reports, with every case in it and a reason for
every number that is off."""
import importlib.machinery
import importlib.util
import os
import re
import subprocess
import unittest

from tests.cases import harness
from tests.cases.harness import expected

DOCS = os.path.join(harness.SOURCE, "docs")
CASES = os.path.join(harness.SOURCE, "cases")
NAMES = sorted(n for n in os.listdir(CASES) if os.path.isdir(os.path.join(CASES, n, "system")))


def script():
    """docs/makeValidation as a module."""
    loader = importlib.machinery.SourceFileLoader("makeValidation", os.path.join(DOCS, "makeValidation"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("makeValidation", loader))
    loader.exec_module(module)
    return module


def text(*path):
    with open(os.path.join(harness.SOURCE, *path), encoding="utf-8") as f:
        return f.read()


class Page(unittest.TestCase):
    def test_is_up_to_date(self):
        made = subprocess.run([os.path.join(DOCS, "makeValidation"), "-print"], capture_output=True, text=True)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(text("docs", "validation.md"), made.stdout, "run docs/makeValidation")

    def test_cases(self):
        """Each case is in it with all its entries, or is named with the reason why it has no expected values."""
        page, reasons = text("docs", "validation.md"), script().WITHOUT
        for name in NAMES:
            with self.subTest(name):
                if not os.path.isfile(os.path.join(CASES, name, "expected.json")):
                    self.assertTrue(reasons[name])
                    self.assertIn(f"- `{name}`: {reasons[name]}", page)
                    continue
                known = expected.read(os.path.join(CASES, name))
                rows = len(known["full"]) + len(known.get("told", [])) + sum(len(entry.get("beside", [])) for entry in known["full"])
                self.assertGreaterEqual(page.count(f"| [{name}](../cases/{name}) |"), rows)
        self.assertEqual([name for name in reasons if name not in NAMES or os.path.isfile(os.path.join(CASES, name, "expected.json"))], [])

    def test_reports(self):
        """Each report is linked with its headline."""
        page = text("docs", "validation.md")
        for name in (n for n in os.listdir(os.path.join(harness.SOURCE, "postprocessing", "reports")) if n.endswith(".md")):
            self.assertRegex(page, rf"- \[`{name}`\]\(\.\./postprocessing/reports/{name}\), .+: \*.{{20,}}\*\.", name)

    def test_rows(self):
        """Every kind of comparison is there, and what is off has a reason."""
        made = script()
        rows = made.of_cases() + made.of_table_1() + made.of_pressures() + made.of_cross_check() + made.of_times() + made.of_reports()
        self.assertEqual({r.kind for r in rows}, set(expected.KINDS))
        self.assertEqual([r.quantity for r in rows if r.bad and not r.why], [])
        self.assertTrue(any(r.bad for r in rows))

    def test_what_is_off_needs_a_reason(self):
        row = script().row
        self.assertFalse(row("exact", "x", "", "q", "1.009", "1", "law").bad)
        self.assertTrue(row("exact", "x", "", "q", "1.02", "1", "law", why="noise").bad)
        self.assertFalse(row("paper", "x", "", "q", "1.02", "1", "law", "0.05", limit=0.05).bad)
        for limit, why in ((None, ""), (0.01, "")):
            with self.assertRaisesRegex(SystemExit, "x, q: 1.02 beside 1 needs"):
                row("exact", "x", "", "q", "1.02", "1", "law", why=why, limit=limit)


class Told(unittest.TestCase):
    def test_stands_in_the_readme(self):
        """The numbers of `told` are printed in the case's README."""
        for name in NAMES:
            readme = text("cases", name, "README.md")
            for entry in expected.read(os.path.join(CASES, name)).get("told", []):
                with self.subTest(f"{name}: {entry['quantity']}"):
                    self.assertIn(entry["kind"], expected.KINDS)
                    for key in ("haff", "reference", "allowed"):
                        if key == "reference" and re.fullmatch(r"[012]", entry[key]):
                            continue  # a difference is compared with 0, a ratio with 1, an order with 2
                        self.assertTrue(re.search(rf"(?<![\d.]){re.escape(entry.get(key, ''))}(?!\d)", readme), entry.get(key))


if __name__ == "__main__":
    unittest.main()
