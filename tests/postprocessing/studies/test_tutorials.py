# SPDX-License-Identifier: GPL-3.0-or-later
"""haff tutorials: a tutorial of our own in a folder like that of openfoam-examples, by both programs; what is missing is said."""
import os
import re
import shutil
import subprocess
import sys
import unittest

from tests.cases import harness
from tests.postprocessing.openfoam import foam

from studies import tutorials
from studies.made import rhocentral, twin

needs_foam = unittest.skipUnless(rhocentral.installed(), f"{rhocentral.MISSING}: no comparison")


def command(*words):
    return harness.command("tutorials", *words)


class Tutorials(harness.Folder, unittest.TestCase):
    def examples(self):
        target = os.path.join(self.folder, "examples", "compressible", "rhoCentralFoam", "shockTube")
        if not os.path.exists(target):
            case = foam.tube(self.folder)
            foam.put(case, "system/blockMeshDict", foam.BLOCKS.replace("$n", "100"))
            shutil.copytree(case, target)
            subprocess.run(["gzip", os.path.join(target, "system", "blockMeshDict")], check=True)
        return os.path.join(self.folder, "examples")

    @needs_foam
    def test_shock_tube(self):
        """Both are nearer to the exact solution on twice the cells, and to each other."""
        done = command(os.path.join(self.folder, "out"), "shockTube", "-from", self.examples())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(os.path.join(self.folder, "out", "tutorials.md"), encoding="utf-8") as f:
            rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in f.read().splitlines()[2:]]
        self.assertEqual([row[1] for row in rows], ["100 (as shipped)", "200", "400"])
        number = lambda text: float(re.match(r"[\d.]+", text)[0])
        for column in (3, 4, 5, 6, 7, 8):
            values = [number(row[column]) for row in rows]
            self.assertEqual(values, sorted(values, reverse=True), column)

    def test_cells(self):
        path = os.path.join(self.folder, "blocks")
        with open(path, "w", encoding="latin-1") as f:
            f.write("blocks ( hex (0 1 2 3 4 5 6 7) (48 16 1) simpleGrading (1 1 1)\n hex (1 2 3 4 5 6 7 8) ( 5 64 1 ) simpleGrading (1 1 1) );\n")
        tutorials.more_cells(path, 0.5)
        with open(path, encoding="latin-1") as f:
            self.assertEqual(re.findall(r"\) \((\d+ \d+ \d+)\) simple", f.read()), ["24 8 1", "2 32 1"])
        with open(path, "w", encoding="latin-1") as f:
            f.write("blocks ( hex (0 1 2 3 4 5 6 7) ($n 16 1) simpleGrading (1 1 1) );\n")
        with self.assertRaisesRegex(twin.Refused, "no numbers of cells"):
            tutorials.more_cells(path, 2)

    def test_without_openfoam(self):
        done = subprocess.run([sys.executable, "-m", "haff", "tutorials", self.folder], capture_output=True, text=True,
                              env={"PATH": "/nowhere", "PYTHONPATH": os.environ["PYTHONPATH"], "HAFF_BIN": harness.BIN})
        self.assertEqual(done.returncode, 77)
        self.assertIn("rhoCentralFoam (package openfoam) is not installed", done.stdout)
        self.assertEqual(command(self.folder, "cavity").returncode, 2)
        if rhocentral.installed():
            done = command(self.folder, "-from", os.path.join(self.folder, "nothing"))
            self.assertEqual(done.returncode, 77)
            self.assertIn("openfoam-examples", done.stdout)


if __name__ == "__main__":
    unittest.main()
