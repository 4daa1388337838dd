# SPDX-License-Identifier: GPL-3.0-or-later
"""Grains that stick fall on a step in two dimensions and pack: the same bits on two ranks and without skipping."""
import os
import unittest

from tests.cases import harness, runs


class Packed(harness.Folder, unittest.TestCase):
    def wedge(self, ranks, skip):
        case = harness.copy("wedgeDense", self.folder)
        harness.mesh(case, 40)
        runs.add(case, "system/fvSolution", f"skipUniform {skip};\n")
        path = os.path.join(case, "constant", "granularProperties")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("restitution 0.97;", "restitution 0; thresholdSpeed 5;"))
        return harness.run(case, ranks=ranks, endTime=0.03, writeInterval=0.03)

    def test_same_bits(self):
        one, other = self.wedge(1, "yes"), self.wedge(2, "no")
        self.assertTrue(0.645 < one.field("alpha", 0.03).max() < 0.65)
        self.assertGreater(one.field("T", 0.03).min(), 25 / 80, "the threshold keeps T up, everywhere")
        for name in ("rho", "rhoU", "rhoE"):
            with open(os.path.join(one.path, "0.03", name), "rb") as a, open(os.path.join(other.path, "0.03", name), "rb") as b:
                self.assertEqual(a.read(), b.read(), name)


if __name__ == "__main__":
    unittest.main()
