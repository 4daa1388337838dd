"""Viscous stress and heat conduction on gmsh's triangles through the programs: the channel of cases/poiseuilleDisks, against
the solution of its ordinary differential equations."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs

import disks  # noqa: E402  (the harness knows where)

FIELDS = [("T", None, 1), ("alpha", None, 1), ("p", None, 1), ("U", 0, 1)]


@unittest.skipUnless(runs.shutil.which("gmsh"), "gmsh is not installed")
class ViscousTriangles(harness.Folder, unittest.TestCase):
    def channel(self, cells, **control):
        case = harness.copy("poiseuilleDisks", self.folder)
        with open(os.path.join(case, "mesh.geo")) as f:
            boxes = f.read()
        triangles = boxes.replace("Transfinite Surface {1};\nRecombine Surface {1};\n", "")
        self.assertNotEqual(triangles, boxes)
        with open(os.path.join(case, "mesh.geo"), "w") as f:
            f.write(triangles)
        harness.mesh(case, cells)
        return case, harness.run(case, **control)

    @staticmethod
    def at_walls(result, flow, side):
        """Mean error of p in cells nearer to a wall than a side, absolute and with its sign, over p."""
        y = result.centres[:, 1]
        error = (result.field("p", result.times[-1]) - flow(y, "p"))[np.minimum(y, flow.height - y) < side] / flow(0, "p")
        return np.abs(error).mean(), error.mean()

    def test_poiseuille(self):
        errors, walls = [], []
        for cells in (12, 24):
            case, result = self.channel(cells)
            flow = disks.poiseuille(case)
            errors.append([disks.error(result, flow, *field) for field in FIELDS])
            walls.append(self.at_walls(result, flow, flow.height / cells))
        errors = np.array(errors)
        self.assertLess(errors[1].max(), 3e-3, f"errors {errors}")  # on squares of the same side 4e-3
        order = np.log2(errors[0] / errors[1])
        self.assertGreater(order[2:].min(), 1.8, f"orders {order}")
        self.assertGreater(order[1:].min(), 1.5, f"orders {order}")  # T: small and of both signs
        size, mean = np.array(walls).T
        self.assertGreater(np.log2(size[0] / size[1]), 1.3, f"p at walls {walls}")
        self.assertLess(size[1], 1.1 * abs(mean[1]), f"p at walls {walls}")  # the same in all of them, no zigzag


if __name__ == "__main__":
    unittest.main()
