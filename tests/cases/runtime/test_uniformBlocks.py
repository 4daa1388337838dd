# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of cells that are uniform to the bit give one value to function objects; their tables and the log are those of all cells."""
import os
import unittest

from tests.cases import harness, runs

FIELDS = "(rho alpha U T p c Ma)"
READER = "    %s { type %s; fields %s; %s log false; }\n"
OPERATIONS = ("volIntegrate", "volAverage", "sum", "min", "max")
READERS = READER % ("ends", "fieldMinMax", FIELDS, "") + "".join(
    READER % (name, "volFieldValue", FIELDS, f"operation {name};") for name in OPERATIONS)


class UniformBlocks(harness.Folder, unittest.TestCase):
    def tables(self, skip, ranks=1):
        case = harness.copy("wedge", self.folder)
        harness.mesh(case, 120)
        control = os.path.join(case, "system", "controlDict")
        with open(control) as f:
            text = f.read()
        with open(control, "w") as f:
            f.write(text.replace("functions\n{\n", "logInterval 20;\nfunctions\n{\n" + READERS))
        runs.add(case, "system/fvSolution", f"skipUniform {skip};\n")
        harness.edit(case, "system/controlDict", endTime=0.02, writeInterval=0.01)
        said = harness.program("granularGas", "-case", case, ranks=ranks).stdout
        return said, runs.contents(os.path.join(case, "postProcessing")), [line for line in said.splitlines() if " .. " in line]

    def test_tables(self):
        """The wedge while half of its tiles are uniform: with and without skipping, on one and two ranks, byte for byte."""
        said, tables, ranges = self.tables("yes")
        self.assertRegex(said, r"\n\d(\.\d+)? % of the cell updates were computed")
        self.assertGreaterEqual(len(tables), 6)
        for skip, ranks in (("no", 1), ("yes", 2)):
            with self.subTest(skip=skip, ranks=ranks):
                _, others, there = self.tables(skip, ranks)
                self.assertEqual(sorted(tables), sorted(others))
                for name in tables:
                    self.assertEqual(tables[name], others[name], name)
                self.assertEqual(ranges, there)


if __name__ == "__main__":
    unittest.main()
