"""Steady flows of disks with viscosity and heat conduction between two walls, against the solution of their ordinary
differential equations (postprocessing/disks.py)."""
import unittest

import numpy as np

from tests.cases import harness

import disks  # noqa: E402  (the harness knows where)


class SteadyFlows(harness.Folder, unittest.TestCase):
    def errors(self, name, cells, reference, fields, granular=None, control=None):
        """Mean errors on each of the grids; the orders between them."""
        found = []
        for n in cells:
            case = harness.copy(name, self.folder)
            harness.edit(case, "constant/granularProperties", **(granular or {}))
            harness.mesh(case, n)
            result = harness.run(case, **(control or {}))
            flow = reference(case)
            found.append([disks.error(result, flow, *field) for field in fields])
        found = np.array(found)
        return found, np.log2(found[:-1] / found[1:])

    def test_heated_walls(self):
        """Second order without cooling. With it the splitting costs a little of that at the walls."""
        for e, least, largest in ((1, 1.95, 1.5e-4), (0.95, 1.75, 5e-4)):
            with self.subTest(restitution=e):
                errors, order = self.errors("heatedWalls", (20, 40), disks.heated_walls, (("T",), ("alpha",), ("p",)),
                                            {"restitution": e}, {"maxCo": 0.4} if e == 1 else None)
                self.assertGreater(order.min(), least)
                self.assertLess(errors[-1].max(), largest)

    def test_poiseuille(self):
        fields = [(name, None, 1) for name in ("T", "alpha", "p")] + [("U", 0, 1)]
        errors, order = self.errors("poiseuilleDisks", (16, 32), disks.poiseuille, fields)
        self.assertGreater(order.min(), 1.75)
        self.assertLess(errors[-1].max(), 3e-3)


if __name__ == "__main__":
    unittest.main()
