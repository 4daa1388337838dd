# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases in the elastic limit, short: their expected.json. Against rhoCentralFoam: tests/postprocessing/studies/test_crossCheck.py."""
import os
import unittest

import numpy as np

from tests.cases import harness


class Elastic(harness.Folder, unittest.TestCase):
    def test_expected(self):
        for name, cells in (("sod", 100), ("vortex", 80), ("riemann2D", 50), ("wedgeElastic", 40), ("forwardStep", 30)):
            with self.subTest(name):
                self.compare(self.short(name, cells), harness.entries(name, cells=cells))

    def vortex(self, smooth, ranks=1):
        """rho of the vortex at the end, and at the start, which is the exact solution."""
        case = harness.copy("vortex", self.folder)
        harness.mesh(case, 60)
        with open(os.path.join(case, "system", "fvSchemes"), "a", encoding="utf-8") as file:
            file.write(f"commonCoeffs {{ smooth {smooth}; }}\n")
        done = harness.run(case, ranks=ranks)
        return done.field("rho"), done.field("rho", 0)

    def test_smooth_faces(self):
        """The linear flux of smooth faces: less error, and the same bits on two ranks."""
        plain, exact = self.vortex("no")
        smooth, _ = self.vortex("yes")
        self.assertLess(np.abs(smooth - exact).mean(), 0.7 * np.abs(plain - exact).mean())
        self.assertTrue((self.vortex("yes", ranks=2)[0] == smooth).all())


if __name__ == "__main__":
    unittest.main()
