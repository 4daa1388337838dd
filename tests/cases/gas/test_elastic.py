# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases in the elastic limit, short: their expected.json. Against rhoCentralFoam: tests/postprocessing/studies/test_crossCheck.py."""
import unittest

from tests.cases import harness


class Elastic(harness.Folder, unittest.TestCase):
    def test_expected(self):
        for name, cells in (("sod", 100), ("vortex", 80), ("riemann2D", 50), ("wedgeElastic", 40), ("forwardStep", 30)):
            with self.subTest(name):
                self.compare(self.short(name, cells), harness.entries(name, cells=cells))


if __name__ == "__main__":
    unittest.main()
