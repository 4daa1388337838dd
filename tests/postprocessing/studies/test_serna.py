# SPDX-License-Identifier: GPL-3.0-or-later
"""haff serna: a variant runs and is measured, the table names a stop, tables go between their markers."""
import os
import re
import shutil
import tempfile
import unittest

from tests.cases import harness
from studies import serna
from studies.source import measured_by

PAGE = "a\n<!-- table x: made by haff serna -->\n{}<!-- end -->\nb\n"


class Variants(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="haff")
        cls.runs = serna.Runs(cls.folder)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_runs(self):
        """An entry of the variant reaches its file; the value is in the digits wanted; a time that was not reached is a stop."""
        case = self.runs("wall", 50, flux="Marquina", end=0.02)
        self.assertEqual(os.path.basename(case.path), "wall-fluxMarquina-end0.02-50")
        with open(os.path.join(case.path, "system", "fvSchemes")) as f:
            self.assertRegex(f.read(), r"fluxScheme\s+Marquina;")
        self.assertEqual(len(case.field("alpha", "0.02")), 50)
        self.assertIsNone(serna.stopped(case))
        self.assertEqual(serna.value(case, "maximum", 0.02, 3), f"{case.field('alpha', '0.02').max():.3f}")
        self.assertEqual(serna.limited(case, 0.02), 0)
        folder = os.path.join(case.path, "postProcessing", "limiter", "0")
        os.makedirs(folder)
        for times, said in ((900, r"^0\.\d{3}$"), (25000, r"^noise, limited 2e\+04 times$")):
            with open(os.path.join(folder, "limiter.dat"), "w") as f:
                f.write(f"# Time step cells\n0.01 1 {times - 400}\n0.02 2 400\n")
            self.assertEqual([serna.limited(case, time) for time in (0.005, 0.01, 0.02)], [0, times - 400, times])
            self.assertRegex(serna.value(case, "maximum", 0.02, 3), said)
        shutil.rmtree(folder)
        other = self.runs("wall", 50, end=0.02)
        self.assertNotEqual(serna.value(case, "maximum", 0.02, 9), serna.value(other, "maximum", 0.02, 9))

    def test_a_stop_is_told(self):
        """A run that ended before its time, by what its log says."""
        case = self.runs("wall", 50, end=0.01)
        harness.edit(case.path, "system/controlDict", endTime="0.05")
        with open(os.path.join(case.path, "log.granularGas"), "a") as f:
            f.write("error: inelastic collapse at t = 0.0123, (9.99 0 0)\n")
        self.assertEqual(serna.value(case, "maximum", 0.03, 3), "stops at 0.0123")
        self.assertRegex(serna.value(case, "maximum", 0.01, 3), r"^0\.\d{3}$")


class Tables(unittest.TestCase):
    def test_markdown(self):
        self.assertEqual(serna.markdown([["a", "b", ""], ["1", "", ""]]), "| a | b | |\n|---|---|---|\n| 1 | | |\n")

    def test_between_markers(self):
        found = serna.written(PAGE.format("old\n"), {"x": [["a"], ["1"]]}, "when")
        self.assertEqual(found, PAGE.format("when\n\n| a |\n|---|\n| 1 |\n"))
        with self.assertRaisesRegex(ValueError, "no marker of the table y"):
            serna.written(PAGE, {"y": [["a"]]}, "when")

    def test_reports_have_the_markers(self):
        """Every table of the studies has its place: the names stand in the reports, each once, above a line that tells when."""
        names = {"serna.md": "step stepGrids stepMach wall blasts blastElastic blastDense layer layerCycles".split(), "marquinaStability.md": ["cure"]}
        for report, wanted in names.items():
            with open(os.path.join(serna.REPORTS, report)) as f:
                text = f.read()
            self.assertEqual(sorted(re.findall(r"<!-- table (\w+): made by haff serna -->\nMeasured at [0-9a-f]{8}, ", text)), sorted(wanted), report)

    def test_line(self):
        self.assertRegex(measured_by("haff serna"), r"^Measured at [0-9a-f]{8}, 20\d\d-\d\d-\d\d: `haff serna`\.$")


if __name__ == "__main__":
    unittest.main()
