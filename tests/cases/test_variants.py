# SPDX-License-Identifier: GPL-3.0-or-later
"""The variants of cases that are short, as Allcheck runs them: their expected.json."""
import unittest

from tests.cases import harness
from tests.cases.harness import expected

from studies.checks import checkCases

LONGEST = 5  # seconds of processor time that a short variant may take


class Short(harness.Folder, unittest.TestCase):
    def test_short_variants(self):
        copies = [copy for copy in checkCases.copies_in(self.folder) if isinstance(copy, checkCases.Variant) and copy.variant.get("short")]
        self.assertTrue(copies)
        for copy in copies:
            with self.subTest(copy.name):
                self.assertLess(copy.cost, LONGEST)
                self.assertEqual(copy.run(), "")
                for entry in copy.entries():
                    value, right, why = expected.judge(copy.path, entry)
                    self.assertTrue(right, f"{expected.describe(entry)}: {why or value}, expected {entry['value']:.9g} +- {entry['tolerance']:g}")


if __name__ == "__main__":
    unittest.main()
