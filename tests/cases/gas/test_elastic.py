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

    def vortex(self, smooth, **options):
        case = harness.copy("vortex", self.folder)
        harness.mesh(case, 60)
        with open(os.path.join(case, "system", "fvSchemes"), "a", encoding="utf-8") as file:
            file.write(f"commonCoeffs {{ smooth {smooth}; }}\n")
        return harness.run(case, **options)

    def test_smooth_faces(self):
        """The linear flux of smooth faces: less error at the end, where the vortex is what it was, and the same bits on two ranks."""
        plain, smooth = (self.vortex(word) for word in ("no", "yes"))
        error = [np.abs(case.field("rho") - case.field("rho", 0)).mean() for case in (smooth, plain)]
        self.assertLess(error[0], 0.7 * error[1])
        self.assertTrue((self.vortex("yes", ranks=2, endTime=2.5).field("rho") == smooth.field("rho", 2.5)).all())


if __name__ == "__main__":
    unittest.main()
