# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/tutorial.md by itself: its files and commands in an empty folder, with the programs in PATH and nothing else; then its numbers.
The reports that Allrun makes are left out: test_newCase.py looks at them."""
import os
import re
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from tests.cases import harness

PAGE = os.path.join(harness.SOURCE, "docs", "tutorial.md")
PICTURES = ["cylinder/postProcessing/figures/alpha-U-T-p.png", "layer/postProcessing/figures/alpha.png", "grains/postProcessing/figures/grains.png",
            "layer.gif", "block/postProcessing/figures/alpha.png", "block/shock.png"]
LARGEST = 150e3  # bytes of a picture in docs


def page():
    with open(PAGE, encoding="utf-8") as f:
        return f.read()


def steps():
    """("file", name, text) and ("run", "", commands) in the order of the page."""
    found = re.findall(r"(?:^File `([^`]+)`:\n\n)?^```(\w*)\n(.*?)^```$", page(), re.M | re.S)
    return [("file", name, text) if name else ("run", language, text) for name, language, text in found]


def claims():
    """(number, how far off it may be) of each bold number, in the order of the page."""
    return [tuple(map(float, pair)) for pair in re.findall(r"\*\*(-?[\d.]+) ± ([\d.]+)\*\*", page())]


class Tutorial(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if not shutil.which("gmsh"):
            raise unittest.SkipTest("gmsh is not there")
        cls.said = ""
        # no PYTHONPATH, no HAFF_BIN: what a user has
        env = {k: v for k, v in os.environ.items() if not k.startswith(("HAFF", "PYTHON"))}
        first = tempfile.mkdtemp(prefix="haff")
        cls.addClassCleanup(shutil.rmtree, first)
        with open(os.path.join(first, "haff"), "w", encoding="utf-8") as f:
            f.write(f'#!/bin/sh\n[ "$1" != report ] || exit 1\nexec {harness.BIN}/haff "$@"\n')
        os.chmod(os.path.join(first, "haff"), 0o755)
        env.update(PATH=f"{first}:{harness.BIN}:/usr/local/bin:/usr/bin:/bin", MPLBACKEND="Agg", HOME=cls.folder)
        for what, name, text in steps():
            if what == "file":
                with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as f:
                    f.write(text)
                continue
            done = subprocess.run(["sh", "-e", "-c", text], cwd=cls.folder, env=env, capture_output=True, text=True, timeout=900)
            cls.said += done.stdout
            if done.returncode:
                raise AssertionError(f"{text}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")

    def test_pictures(self):
        for name in PICTURES:
            self.assertGreater(os.path.getsize(os.path.join(self.folder, name)), 5000, name)

    def test_all_is_sound(self):
        """newCase found nothing to warn of, and every run came to its end."""
        self.assertNotIn("warning", self.said)
        self.assertEqual(self.said.count("which checkCase finds sound"), 4)
        self.assertEqual(len(re.findall(r"^end at time ", self.said, re.M)), 4)

    def test_wake_is_no_hotter_than_the_stream(self):
        """Behind the cylinder, where there is next to nothing, no gas is faster or hotter than an unsteady expansion of the stream can make it:
        (u + 2 c/(gamma - 1))^2/2 of energy at Mach 3 and u = 1. A cell on the wall had 400 times that T."""
        with open(os.path.join(self.folder, "cylinder", "postProcessing", "run", "0", "run.dat"), encoding="utf-8") as f:
            names = [name.strip() for name in f.readline()[1:].split("\t")]
            rows = np.array([[float(row[names.index(name)]) for name in ("magUMax", "TMax")] for row in (line.split("\t") for line in f)])
        most = 1 + 3 / 3
        self.assertLess(rows[:, 0].max(), most)
        self.assertLess(rows[:, 1].max(), 2 / 3 * most**2 / 2)

    def test_block_is_a_lattice(self):
        self.assertRegex(self.said, r"mesh +29000 cells, 3D, a lattice")

    def drag(self, case):
        return float(np.atleast_2d(harness.haff.Case(os.path.join(self.folder, case)).table("forces", "force.dat"))[-1][1])

    def measured(self):
        """What the bold numbers are of, in their order."""
        nose = harness.haff.Case(os.path.join(self.folder, "cylinder"))
        near = np.hypot(*(nose.centres[:, :2] - (-1, 0)).T) < 0.3
        waves = [float(x) for x in re.findall(r"^pattern: wavelength ([\d.]+)", self.said, re.M)]
        flips = [float(x) for x in re.findall(r"flip (-?[\d.]+)", self.said)]
        return [nose.field("alpha")[near].max(), self.drag("cylinder"), *waves, *flips, self.drag("block")]

    def test_numbers(self):
        found = self.measured()
        self.assertEqual(len(found), len(claims()))
        for value, (claim, error) in zip(found, claims()):
            with self.subTest(f"{claim} +- {error}"):
                self.assertLessEqual(abs(value - claim), error, f"the page says {claim} +- {error}; it is {value:.5g}")


class Page(unittest.TestCase):
    def test_pictures_are_small(self):
        names = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page())
        self.assertGreaterEqual(len(names), 3)
        for name in names:
            self.assertLess(os.path.getsize(os.path.join(harness.SOURCE, "docs", name)), LARGEST, name)

    def test_every_block_is_run(self):
        """A block is a file with its name, or commands: nothing stands there that no one tries."""
        self.assertEqual(page().count("```"), 2 * len(steps()))
        self.assertTrue(all(language == "sh" for what, language, _ in steps() if what == "run"))


if __name__ == "__main__":
    unittest.main()
