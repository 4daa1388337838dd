# SPDX-License-Identifier: GPL-3.0-or-later
"""What users of OpenFOAM bring along is taken as OpenFOAM takes it: old names, groups of patches, function objects in files, folders
that its programs make."""
import os
import unittest

from tests.cases import harness
from tests.solvers.programs import bad_case

CONTROL = "system/controlDict"


class Case(harness.Folder, unittest.TestCase):
    def make(self, name):
        """6 x 4 cells with an inlet, a wall, a cyclic pair, two empty sides."""
        case = os.path.join(self.folder, name)
        bad_case.write(case)
        return case

    def write(self, case, file, text):
        os.makedirs(os.path.dirname(os.path.join(case, file)), exist_ok=True)
        with open(os.path.join(case, file), "w") as f:
            f.write(text)

    def replace(self, case, file, old, new):
        with open(os.path.join(case, file)) as f:
            text = f.read()
        self.assertIn(old, text)
        self.write(case, file, text.replace(old, new))

    def rows(self, case, path):
        """Lines of a table without its head."""
        with open(os.path.join(case, "postProcessing", path)) as f:
            return [line for line in f if not line.startswith("#")]


class Control(Case):
    def test_old_names(self):
        """outputControl and outputInterval are writeControl and writeInterval, unless those are there."""
        case = self.make("old")
        self.replace(case, CONTROL, "writeControl timeStep;\n        writeInterval 1;", "outputControl timeStep; outputInterval 2;")
        self.replace(case, CONTROL, "type fieldMinMax;", "type fieldMinMax; outputInterval 2; writeControl timeStep; writeInterval 1;")
        harness.program("granularGas", "-case", case)
        self.assertEqual(len(self.rows(case, "points/0/alpha")), 2)  # 0 and the second of two steps
        self.assertEqual(len(self.rows(case, "extremes/0/fieldMinMax.dat")), 3)

    def test_ignored(self):
        """Keywords of controlDict that are for OpenFOAM alone."""
        case = self.make("ignored")
        with open(os.path.join(case, CONTROL), "a") as f:
            f.write("cycleWrite 0; userTime { type real; } solver fluid; beginTime 0; fileHandler collated; maxAlphaCo 0.5;\n")
        harness.program("checkCase", case)

    def test_function_in_a_file(self):
        """#includeFunc NAME is the function object NAME whose dictionary is system/NAME."""
        case = self.make("file")
        self.write(case, "system/low", "type fieldMinMax; fields (rho); log false;\n")
        self.replace(case, CONTROL, "functions\n{", "functions\n{\n    #includeFunc low\n")
        self.assertNotIn("passedOver", harness.program("granularGas", "-case", case).stdout)
        self.assertEqual(len(self.rows(case, "low/0/fieldMinMax.dat")), 3)

    def test_parallel(self):
        """mpirun has started the ranks: -parallel says nothing new."""
        case = self.make("parallel")
        harness.program("granularGas", "-case", case, "-parallel", ranks=2)
        self.assertTrue(os.path.isdir(case + "/0.002"))


if __name__ == "__main__":
    unittest.main()
