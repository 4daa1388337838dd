# SPDX-License-Identifier: GPL-3.0-or-later
"""faradayDiagram: rows as cases, what stands, and the driver on a coarse template: done once, gone on, drawn."""
import csv
import os
import re
import shutil
import sys
import tempfile
import unittest

import numpy as np

from tests.cases import harness

import haff
from studies import faradayDiagram, faradayOnset, faradayRows


def options(*words):
    sys.argv, kept = ["faradayDiagram.py", "folder", *words], sys.argv
    try:
        return faradayDiagram.arguments()
    finally:
        sys.argv = kept


class Rows(unittest.TestCase):
    def test_numbers(self):
        self.assertEqual(faradayRows.numbers("3,7-9,1"), [3, 7, 8, 9, 1])
        self.assertEqual(len(faradayRows.paper()), 22)

    def test_accelerations(self):
        """A of the table gives its Gamma to 1 %; the plate of case (i) throws 7.65 high."""
        for row in faradayRows.paper().values():
            self.assertAlmostEqual(faradayRows.acceleration(row["A_diam"], row["f_Hz"]) / row["Gamma_printed"], 1, delta=0.01)
        self.assertAlmostEqual(faradayRows.throw(faradayRows.acceleration(5.57, 3.5), 3.5), (2 * np.pi * 3.5 * 5.57) ** 2 / 1962)

    def test_warm(self):
        """Rows near 2 g begin at 2.75 g, under a lid for that, and get as many cycles at their own less six."""
        rows, o = faradayRows.paper(), options()
        cold, warm = faradayDiagram.Row("f", 20, rows[20], o), faradayDiagram.Row("f", 6, rows[6], o)
        self.assertEqual((cold.warm, cold.cycles, cold.height, cold.cells), (0, 20, 60, 15000))
        self.assertEqual((warm.warm, warm.cycles), (12, 26))
        self.assertGreater(warm.height, 60)
        half = faradayDiagram.Row("f", 20, rows[20], options("-length", "0.5"))
        self.assertEqual((half.length, half.cells), (250, 7500))
        self.assertAlmostEqual(float(cold.shaking()), cold.own)
        knots = np.array([float(w) for w in re.findall(r"[\d.e+-]+", warm.shaking().replace("table", ""))]).reshape(-1, 2)
        np.testing.assert_allclose(knots, [[0, 2.75], [8 / 3, 2.75], [4, warm.own]])

    def test_state(self):
        good = {"flip": -0.9, "contrast": 100, "amplitude": 0.5, "growth": 1.0}
        self.assertEqual(faradayDiagram.state(good), "stands")
        self.assertEqual(faradayDiagram.state({**good, "amplitude": 1e-3, "growth": 1.2}), "grows")
        self.assertEqual(faradayDiagram.state({**good, "amplitude": 1e-3, "growth": 0.9}), "decays")
        self.assertEqual(faradayDiagram.state({**good, "flip": 0.3}), "none")
        self.assertEqual(faradayDiagram.state({**good, "contrast": 2}), "none")


class Driver(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="haff")
        self.template = os.path.join(self.folder, "template")
        faradayRows.copy(faradayDiagram.TEMPLATE, self.template)
        path = os.path.join(self.template, "mesh.geo")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:  # 25 x 15 cells
            f.write(text.replace("= L/W + 1", "= L/10 + 1").replace("= H + 1", "= H/2 + 1"))

    def tearDown(self):
        shutil.rmtree(self.folder)

    def sweep(self):
        command = ["faradayDiagram", os.path.join(self.template, "out"), "-rows", "7",
                   "-cycles", "4", "-last", "3", "-jobs", "1", "-keep", "-template", self.template, "-note", "test"]
        done = harness.command(*command)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(os.path.join(self.template, "out", "faradayDiagram.csv")) as f:
            return done.stdout, list(csv.DictReader(f))

    def test_row(self):
        said, first = self.sweep()
        self.assertIn("1 rows to run, 0 stand", said)
        self.assertEqual(len(first), 1)
        self.assertEqual((first[0]["row"], first[0]["paper"], first[0]["cells"], first[0]["cycles"]), ("7", "21.0", "3750", "4"))
        self.assertIn("timeScheme SSPRK43 maxCo 0.8 amplitude 1e-2 seed 1 last 3 test", first[0]["options"])
        out = os.path.join(self.template, "out")
        self.assertTrue(os.path.getsize(os.path.join(out, "faradayDiagram.png")) > 1000)
        said = self.sweep()[0]
        self.assertIn("0 rows to run, 1 stand", said)
        self.assertRegex(said, r"\| 7 \| 2.25 \| 6 \| 1.55 \| 250 \| 21 \+- 9 \| none \| (none|grows|decays|\*\*)")
        self.assertRegex(said, r"\| 8 \| 2.25 \| 5.5 \| 1.85 \| 300 \| 23 \+- 7 \| none \| not run \|")
        # stopped after the second cycle: goes on from there, to the same numbers
        os.remove(os.path.join(out, "faradayDiagram.csv"))
        for name in os.listdir(os.path.join(out, "row07")):
            if haff.is_time(name) and float(name) > 2.1 / 6:
                shutil.rmtree(os.path.join(out, "row07", name))
        said, second = self.sweep()
        with open(os.path.join(out, "row07", "log.granularGas")) as f:
            self.assertEqual(len(re.findall(r"^end at time", f.read(), re.M)), 2)
        for key in ("wavelength", "contrast", "flip", "amplitude", "growth", "meanHeight", "state"):
            self.assertEqual(first[0][key], second[0][key], key)


class Onset(unittest.TestCase):
    def test_line(self):
        rows = [{"Gamma": 2.0, "width": 2.0, "warm": 0.0, "A_sigma": a, "wave": w, "growth": g}
                for a, w, g in ((1.5, 20, 0.9), (1.5, 30, 0.8), (1.7, 20, 1.0), (1.7, 30, 1.1), (1.9, 30, 1.3))]
        line = faradayOnset.fastest(rows, 2.0, 2.0, 0.0)
        self.assertEqual(line, [(1.5, 0.9, 20), (1.7, 1.1, 30), (1.9, 1.3, 30)])
        self.assertAlmostEqual(faradayOnset.onset(line), 1.5 + 0.2 * np.log(1 / 0.9) / np.log(1.1 / 0.9))
        self.assertTrue(np.isnan(faradayOnset.onset(line[1:])))
        self.assertAlmostEqual(faradayRows.acceleration(1.85, faradayOnset.frequency(2.25, 1.85)), 2.25)

    def test_driver(self):
        """A wave high above the onset grows and turns over; its run stands in the table and is not done again."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            command = ["faradayOnset", folder, "-gamma", "2.75", "-A", "5.57",
                       "-waves", "38", "-cycles", "7", "-settle", "4", "-jobs", "1"]
            for n in range(2):
                done = harness.command(*command)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertNotIn("1/1", done.stdout)
            rows = faradayOnset.table(folder)
            self.assertEqual(len(rows), 1)
            self.assertLess(abs(rows[0]["growth"] - 1.65), 0.1)
            self.assertLess(rows[0]["flip"], -0.7)
            self.assertTrue(os.path.exists(os.path.join(folder, "faradayOnset.png")))


if __name__ == "__main__":
    unittest.main()
