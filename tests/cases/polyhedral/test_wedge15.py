# SPDX-License-Identifier: GPL-3.0-or-later
"""A dense granular gas over a 15 degree wedge on triangles: angle of the shock and state behind it against the exact ones."""
import unittest

import numpy as np

from tests.cases import harness

from studies.exact.eos import of_case  # noqa: E402
from studies.measured import shocks  # noqa: E402


class Wedge15(harness.Folder, unittest.TestCase):
    def test_exact(self):
        errors = {}
        for cells in (15, 30):
            case = self.short("wedge15", cells)
            time = case.times[-1]
            stream = shocks.upstream(case, of_case(case), time)
            self.assertAlmostEqual(stream.mach, 4, delta=1e-9)
            fit = shocks.straight_shock(case, stream, shocks.WEDGE, time)
            # half a cell over the 6 cm of the line
            self.assertLess(abs(fit.angle - stream.angle(shocks.WEDGE)), 0.5 * 10 / cells / 6)
            self.assertLess(abs(fit.offset), 0.5)
            self.assertLess(fit.scatter, 0.25)
            errors[cells] = shocks.wedge_error(case, stream, shocks.WEDGE, time)
            behind = shocks.behind_wedge(case, stream, shocks.WEDGE, time)
            self.assertLess(max(abs(behind.rho), abs(behind.p), abs(behind.mach)), 0.02 * 15 / cells)
        self.assertLess(errors[30], errors[15] / 2**0.7, "a shock converges at first order in the mean")
        self.compare(case, harness.entries("wedge15", cells=30))
        self.assertLess(np.degrees(abs(fit.angle - stream.angle(shocks.WEDGE))), 0.3)


if __name__ == "__main__":
    unittest.main()
