# SPDX-License-Identifier: GPL-3.0-or-later
"""How studies/checks/grainCases.py measures grains at a time of expected.json."""
import os
import tempfile
import unittest
from unittest import mock

import numpy as np

from tests.cases import harness

from haff.runs import expected
from studies.checks import grainCases


class Measures(unittest.TestCase):
    def test_share(self):
        """One grain of four stands at x < 0 at 20; expected.json says the time as a number, its folder is `20`."""
        x = {"20": np.array([[-1, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])}
        with tempfile.TemporaryDirectory() as top, mock.patch.dict(expected.QUANTITIES, grainCases.QUANTITIES), \
                mock.patch.object(grainCases.grains, "places", side_effect=lambda case, time: x[time]):
            for name in ("system", "0", "20"):
                os.makedirs(os.path.join(top, name))
            entry = {"quantity": "share of the grains at x < 0", "time": 20}
            self.assertEqual(expected.measure(harness.haff.Case(top), entry), 0.25)


if __name__ == "__main__":
    unittest.main()
