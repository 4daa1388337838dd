# SPDX-License-Identifier: GPL-3.0-or-later
"""The step of cases/wedge on triangles: nears the lattice's fine runs as the lattice itself does."""
import unittest

from tests.cases import harness
from studies.checks.wedges import reference_error


class WedgeTriangles(harness.Folder, unittest.TestCase):
    def test_lattice(self):
        errors = []
        for cells in (25, 50):
            case = self.short("wedgeTriangles", cells)
            errors.append(reference_error(case, "rho", case.times[-1]))
        self.assertLess(errors[1], errors[0] / 2**0.7)
        self.compare(case, harness.entries("wedgeTriangles", cells=50))


if __name__ == "__main__":
    unittest.main()
