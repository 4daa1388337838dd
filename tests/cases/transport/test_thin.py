# SPDX-License-Identifier: GPL-3.0-or-later
"""Heat that goes with grad rho, beside gas that is far thinner than alphaMin: no cell gets more of it than it conducts."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes

THIN = 1e-6


class Thin(harness.Folder, unittest.TestCase):
    def hottest(self, engine):
        """T of disks at rest, half of them at alpha 0.02, the other half at THIN, in units of that of the start."""
        n = 24
        x = (np.arange(n) + 0.5) / n
        alpha = np.where(x < 0.5, 0.02, THIN)
        case = boxes.box_case(os.path.join(self.folder, engine), (n, 1, 1), (n, 1, 1), alpha / (np.pi / 4), np.zeros((n, 3)), np.ones(n), 2,
                              eos="TorquatoDisks", gamma=2.0, e=0.75, cooling="GarzoDufty", interval=0.25, slip=("xLow", "xHigh"))
        os.remove(os.path.join(case, "0", "p"))
        boxes.write_field(case, "T", np.ones(n), "xLow zeroGradient\nxHigh zeroGradient\nyEmpty empty\nzEmpty empty")
        harness.edit(case, "constant/granularProperties", diameter=1)
        runs.conduct(case)
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        return max(result.field("T", t).max() for t in result.times)

    def test_heat_of_grad_rho(self):
        """Where heat goes no way the law has T ~ rho^-m, m = cross*/heat* = 0.42 for thin disks of e = 0.75 (docs/physics.md 4.3), down to
        alphaMin = 1e-4, and below that a factor of exp(m) at most, as cross falls with rho. The jump of rho is that of the dense side: with it
        the first thin cell got 30 times the T of the gas."""
        most = (0.02 / 1e-4) ** 0.42 * np.exp(0.42)
        for engine in ("lattice", "polyhedral"):
            self.assertLess(self.hottest(engine), most, engine)


if __name__ == "__main__":
    unittest.main()
