# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for flow about a wedge."""
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.plot import cases
from studies.checks import wedges


class Wedges(unittest.TestCase):
    def test_asymmetry(self):
        """About the line y = 10 - x: a field that mirrors itself has none; one cell that is off by a tenth of the greatest value has that."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            x, y, z = cases.box(folder, (5, 5, 1), (10, 10, 1)).T
            for time, more in (("1", 0), ("2", 1)):
                rho, U = x - y + 10, np.stack((x, y - 10, 0 * z), axis=1)
                rho[3] += 0.1 * 18 * more
                U[3, 0] += 0.1 * 9 * more
                cases.fields(folder, time, rho=rho, U=U)
            case = harness.haff.Case(folder)
            for field in ("rho", "U"):
                for time, value in ((1, 0), (2, 0.1)):
                    self.assertAlmostEqual(wedges.asymmetry(case, field, str(time)), value, 12, field)


if __name__ == "__main__":
    unittest.main()
