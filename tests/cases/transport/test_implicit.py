# SPDX-License-Identifier: GPL-3.0-or-later
"""Implicit diffusion through granularGas."""
import os
import re
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.transport import test_disks

MODULE = "haffimplicit.so"


@unittest.skipUnless(os.path.exists(os.path.join(harness.BIN, MODULE)), "built without PETSc")
class Implicit(harness.Folder, unittest.TestCase):
    box, run_box, shear = test_disks.Viscous.box, test_disks.Viscous.run_box, test_disks.Viscous.shear

    def test_shear_wave(self):
        coarse, _ = self.shear("coarse", 16, diffusion="implicit")
        fine, log = self.shear("fine", 32, diffusion="implicit")
        self.assertLess(fine, 4e-3)
        self.assertGreater(np.log2(coarse / fine), 1.8)
        self.assertIn("stages of viscous stress", log)
        self.assertIn("diffusion              implicit", log)

    def test_heat(self):
        """Closed box: energy stays; near RKL2; the same bits after a restart, on two ranks the same to the tolerance."""
        n = (24, 18, 1)
        x, y, _ = harness.boxes.centres(n, (1.0, 0.75, 0.1)).T
        rho = test_disks.density(0.1 + 0.3 * y)
        u = np.stack([3 * np.sin(3 * y + x), np.cos(5 * x), 0 * x], axis=1)
        T = 1 + 20 * np.exp(-30 * ((x - 0.3)**2 + (y - 0.3)**2))
        options = {"types": {}, "slip": ("xLow", "xHigh", "yLow", "yHigh"), "interval": 0.01}
        case, log = self.run_box("whole", n, rho, u, T, 0.02, diffusion="implicit", **options)
        drifts = re.findall(r"\(drift (\S+)\)", log)
        self.assertGreater(len(drifts), 2)
        for drift in drifts:
            self.assertLess(abs(float(drift)), 1e-13)
        other, _ = self.run_box("RKL2", n, rho, u, T, 0.02, diffusion="RKL2", **options)
        again = self.box("again", n, rho, u, T, 0.02, diffusion="implicit", **options)
        for end in (0.01, 0.02):
            harness.edit(again, "system/controlDict", endTime=end)
            harness.program("granularGas", "-case", again)
        ranks = self.box("ranks", n, rho, u, T, 0.02, diffusion="implicit", **options)
        harness.program("granularGas", "-case", ranks, ranks=2)
        for field in ("rho", "rhoU", "rhoE"):
            whole = case.field(field)
            np.testing.assert_array_equal(harness.haff.Case(again).field(field), whole)
            np.testing.assert_allclose(harness.haff.Case(ranks).field(field), whole, rtol=0, atol=1e-5 * np.abs(whole).max())
            np.testing.assert_allclose(other.field(field), whole, rtol=0, atol=3e-3 * np.abs(whole).max())

    def test_without_module(self):
        """A program that was built without PETSc names the entry, the package and what else there is."""
        program = shutil.copy(os.path.join(harness.BIN, "granularGas"), self.folder)
        case = self.box("case", (4, 4, 1), np.full(16, test_disks.density(0.3)), np.zeros((16, 3)), np.ones(16), 0.01,
                        diffusion="implicit")
        done = subprocess.run([program, "-case", case], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        path = os.path.join(case, "system", "fvSolution")
        with open(path) as f:
            line = 1 + next(i for i, text in enumerate(f) if "implicit" in text)
        self.assertIn(f"{path}:{line}: ", done.stderr)
        self.assertIn("petsc-dev", done.stderr)
        self.assertIn("or choose RKJ2", done.stderr)
        harness.edit(case, "system/fvSolution", type="RKJ2")
        subprocess.run([program, "-case", case], capture_output=True, check=True, timeout=60)


if __name__ == "__main__":
    unittest.main()
