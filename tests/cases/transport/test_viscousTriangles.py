# SPDX-License-Identifier: GPL-3.0-or-later
"""Viscous stress and heat conduction on gmsh's triangles through the programs: the channels of cases/poiseuilleDisks and
cases/couetteDisks, against the solutions of their ordinary differential equations."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.transport import channels

from studies.exact import disks  # noqa: E402

FIELDS = [("T", None, 1), ("alpha", None, 1), ("p", None, 1), ("U", 0, 1)]


@unittest.skipUnless(runs.shutil.which("gmsh"), "gmsh is not installed")
class ViscousTriangles(harness.Folder, unittest.TestCase):
    def channel(self, name, cells, change=None, **control):
        case = harness.copy(name, self.folder)
        if change:
            change(case)
        with open(os.path.join(case, "mesh.geo")) as f:
            boxes = f.read()
        triangles = boxes.replace("Transfinite Surface {1};\nRecombine Surface {1};\n", "")
        self.assertNotEqual(triangles, boxes)
        with open(os.path.join(case, "mesh.geo"), "w") as f:
            f.write(triangles)
        harness.mesh(case, cells)
        return case, harness.run(case, **control)

    def errors(self, name, solution, both, **control):
        """Of the fields on two meshes; of p in cells nearer to a wall than a side, the same in all of them: no zigzag."""
        fields, walls, flow = [], [], None
        for cells in both:
            case, result = self.channel(name, cells, **control)
            flow, y = flow or solution(case), result.centres[:, 1]
            fields.append([disks.error(result, flow, *field) for field in FIELDS])
            off = (result.field("p", result.times[-1]) / flow(y, "p") - 1)[np.minimum(y, flow.height - y) < flow.height / cells]
            walls.append(np.abs(off).mean())
            self.assertLess(walls[-1], 1.1 * abs(off.mean()), f"{name}: p at walls")
        return np.array(fields), np.array(walls)

    def test_poiseuille(self):
        errors, walls = self.errors("poiseuilleDisks", disks.poiseuille, (12, 24), maxCo=0.8)
        self.assertLess(errors[1].max(), 3e-3, f"errors {errors}")  # on squares of the same side 4e-3
        order = np.log2(errors[0] / errors[1])
        self.assertGreater(order[2:].min(), 1.8, f"orders {order}")
        self.assertGreater(order[1:].min(), 1.5, f"orders {order}")  # T: small and of both signs
        self.assertGreater(np.log2(walls[0] / walls[1]), 1.3, f"p at walls {walls}")

    def test_couette(self):
        """Walls that move carry along what the cells at them make of rho."""
        errors, walls = self.errors("couetteDisks", disks.couette, (12, 24), maxCo=0.8)
        order = np.log2(errors[0] / errors[1])
        self.assertGreater(order.min(), 1.5, f"orders {order}")
        self.assertGreater(np.log2(walls[0] / walls[1]), 1.8, f"p at walls {walls}")

    def test_friction(self):
        """Walls of Johnson & Jackson drag gas that slips along them."""
        errors, walls = self.errors("couetteDisks", disks.frictional, (12, 24), change=channels.friction, maxCo=0.8,
                                    endTime=800, writeInterval=800)
        order = np.log2(errors[0] / errors[1])
        self.assertGreater(order.min(), 1.7, f"orders {order}")
        self.assertLess(errors[1].max(), 2e-4, f"errors {errors}")
        self.assertGreater(np.log2(walls[0] / walls[1]), 1.5, f"p at walls {walls}")


if __name__ == "__main__":
    unittest.main()
