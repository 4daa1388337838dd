# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that the user guide quotes from reports."""
import os
import re
import unittest

from tests.cases import harness


def text(*path):
    with open(os.path.join(harness.SOURCE, *path), encoding="utf-8") as f:
        return f.read()


class Numbers(unittest.TestCase):
    def test_stress(self):
        """The guide says how many of the random problems ran to their end, were stopped, ended with a stated cause and failed, as the
        report's row of all problems with the default schemes does."""
        report = text("postprocessing", "reports", "stress.md")
        head = re.search(r"^\| problem \|.*$", report, re.M).group().split("|")
        row = re.search(r"^\| \*\*all\*\* \|.*$", report, re.M).group().split("|")
        found = {name.strip(): value.strip() for name, value in zip(head, row)}
        sentence = re.search(r"random problems,.*?stress\.md", text("docs", "userGuide.md"), re.S).group()
        for name in ("ran to their end", "stopped at the bound of steps", "ended with a stated cause"):
            self.assertIn(found[name], sentence, f"docs/userGuide.md quotes another share of problems {name} than stress.md has")
        self.assertIn(f"{found['failed']} failed", sentence)


if __name__ == "__main__":
    unittest.main()
