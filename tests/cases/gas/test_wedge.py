# SPDX-License-Identifier: GPL-3.0-or-later
"""The step at 100 cells a side, dilute and dense: maximum, upstream Mach number, mirror symmetry."""
import unittest

from tests.cases import harness


class Wedge(harness.Folder, unittest.TestCase):
    def test_dilute(self):
        self.compare(self.short("wedge", 100), harness.entries("wedge"))

    def test_dense(self):
        self.compare(self.short("wedgeDense", 100), harness.entries("wedgeDense"))


if __name__ == "__main__":
    unittest.main()
