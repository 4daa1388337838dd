# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/papers.md: what docs/makePapers makes, with a row for every figure of the four papers, and commands that are there."""
import importlib.machinery
import importlib.util
import os
import re
import subprocess
import unittest

from tests.cases import harness
from haff.__main__ import ALL

TOP = harness.SOURCE
FIGURES = {"serna": 8, "carrillo": 8, "shakeri": 8, "christov": 4}  # of each paper


def script():
    """docs/makePapers as a module."""
    loader = importlib.machinery.SourceFileLoader("makePapers", os.path.join(TOP, "docs", "makePapers"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("makePapers", loader))
    loader.exec_module(module)
    return module


def text(*path):
    with open(os.path.join(TOP, *path), encoding="utf-8") as f:
        return f.read()


def figures(name):
    """Numbers of the figures that the first cell of a row names: Fig. 2; Figs 3 bottom, 4."""
    named = re.search(r"Figs? ?\.? (.*)", name)
    return {int(n) for n in re.findall(r"\d+", named[1])} if named else set()


def words_of(case):
    """The words that the Allrun of a case reads; None where it hands all to a program."""
    script = text("cases", case, "Allrun")
    if '"$@"' in script and "case ${1:" not in script:
        return None
    return set(re.findall(r"[\w.]+", " ".join(re.findall(r"^([\w.| ]+)\)", script, re.M) + re.findall(r'"\$\{1:-\}" != (\w+)', script))))


def wrong(command):
    """What is wrong with a command of the page, or ""."""
    program, *words = command.split()
    if program == "./Allrun":
        if not os.path.isfile(os.path.join(TOP, "cases", words[0], "Allrun")):
            return f"there is no case {words[0]}"
        known = words_of(words[0])
        return f"the Allrun of {words[0]} does not read {words[1]}" if len(words) > 1 and known is not None and words[1] not in known else ""
    if program == "build/bin/haff":
        return "" if words[0] in ALL else f"haff has no command {words[0]}"
    return "" if os.access(os.path.join(TOP, program), os.X_OK) else f"there is no program {program}"


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = script()
        cls.papers = {rows.__name__: rows() for _, _, rows in cls.made.PAPERS}

    def test_is_up_to_date(self):
        made = subprocess.run([os.path.join(TOP, "docs", "makePapers"), "-print"], capture_output=True, text=True)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(text("docs", "papers.md"), made.stdout, "run docs/makePapers")

    def test_every_figure_has_a_row(self):
        self.assertEqual(set(self.papers), set(FIGURES))
        for name, count in FIGURES.items():
            found = set().union(*(figures(row.name) for row in self.papers[name]))
            self.assertEqual(found, set(range(1, count + 1)), name)
        self.assertTrue({"Table 1", "movies"} <= {row.name for row in self.papers["carrillo"]})
        self.assertEqual(len(re.findall(r"^\| \d+ \| \d\.\d+ \|", text("docs", "papers.md"), re.M)), 22, "rows of Table 1")

    def test_commands(self):
        """Each row has one, but for sketches; its case or program is there, and reads the word. So is each command in a sentence."""
        commands = [row.command for rows in self.papers.values() for row in rows if row.ours != "sketches"]
        self.assertNotIn("—", commands)
        commands += re.findall(r"`((?:\./Allrun|build/bin/haff) \w[^`]*)`", text("docs", "papers.md"))
        self.assertEqual([f"{c}: {wrong(c)}" for c in commands if c != "./Allrun CASE" and wrong(c)], [])

    def test_wrong_commands_are_found(self):
        for command in ("./Allrun nothing", "./Allrun faraday fig3", "./Allrun wedge fig7", "build/bin/haff nothing", "docs/makeNothing"):
            self.assertTrue(wrong(command), command)
        for command in ("./Allrun faraday fig6", "./Allrun pile e07", "./Allrun sedimentation box", "./Allrun faradaySweep -rows 5"):
            self.assertEqual(wrong(command), "", command)

    def test_cells(self):
        """Every row says what the figure shows, and gives a reason where the paper's number differs from ours."""
        for name, rows in self.papers.items():
            for row in rows:
                with self.subTest(f"{name} {row.name} {row.shows}"):
                    self.assertTrue(row.shows and row.ours and row.theirs)

    def test_what_is_not_there(self):
        for call in (lambda: self.made.measured("wedge", "maximum of nothing"), lambda: self.made.told("wedge", "nothing"),
                     lambda: self.made.cell(("cases", "kink", "README.md"), "nothing", "801", "max"), lambda: self.made.cell(("cases", "kink", "README.md"), "nodes", "7", "max")):
            with self.assertRaisesRegex(SystemExit, "docs/makePapers: "):
                call()


if __name__ == "__main__":
    unittest.main()
