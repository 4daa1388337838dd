# SPDX-License-Identifier: GPL-3.0-or-later
"""frictionalSlip: a packed layer slides on a wall as a block does, rests where the wall holds it, and is taken along by a wall that moves."""
import math
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import haff
from haff.case import entries

G, ANGLE = 9.81, math.radians(18)
SLOPE = f"({G * math.sin(ANGLE):.9g} {-G * math.cos(ANGLE):.9g} 0)"


@unittest.skipUnless(shutil.which("gmsh"), "gmsh is not there")
class WallFriction(harness.Folder, unittest.TestCase):
    def run_layer(self, floor, gravity, end, interval):
        """cases/chute on that floor: times, and the mean velocity along the floor; the velocities of packed cells at the end."""
        case = harness.copy("chute", self.folder)
        msh = os.path.join(case, "mesh.msh")
        subprocess.run(["gmsh", "-3", "-v", "2", os.path.join(case, "mesh.geo"), "-o", msh], check=True, capture_output=True)
        harness.program("gmshToCase", msh, "-case", case)
        entries.edit(os.path.join(case, "constant", "g"), {"value": gravity})
        entries.edit(os.path.join(case, "0.orig", "U"), {"boundaryField": {"floor": f"{{ type frictionalSlip; {floor} }}"}})
        entries.edit(os.path.join(case, "system", "controlDict"), {"endTime": end, "writeInterval": interval})
        harness.program("granularGas", "-case", case)
        made = haff.Case(case)
        mean = [float((made.field("alpha", t) @ made.field("U", t)[:, 0]) / made.field("alpha", t).sum()) for t in made.times]
        return np.array([float(t) for t in made.times]), np.array(mean), made.field("U")[made.field("alpha") > 0.5, 0]

    def test_slides(self):
        """Coulomb: du/dt = g (sin theta - muWall cos theta), and the layer, whose own mu is larger, moves as one."""
        t, u, packed = self.run_layer("muWall 0.2;", SLOPE, 0.3, 0.1)
        self.assertAlmostEqual((u[3] - u[1]) / (t[3] - t[1]), G * (math.sin(ANGLE) - 0.2 * math.cos(ANGLE)), delta=0.012)
        self.assertLess(np.ptp(packed), 1e-3)

    def test_rests(self):
        """tan theta = 0.325 is below muWall: nothing slides."""
        _, _, packed = self.run_layer("muWall 0.35;", SLOPE, 0.3, 0.1)
        self.assertLess(np.abs(packed).max(), 2e-3)

    def test_moving_wall(self):
        """It drags with muWall g until the layer has its velocity; the wall starts at rest, by a table."""
        t, u, packed = self.run_layer("muWall 0.2; U table ((0 (0 0 0)) (0.001 (0.1 0 0)));", f"(0 {-G} 0)", 0.12, 0.02)
        self.assertAlmostEqual((u[2] - u[1]) / (t[2] - t[1]), 0.2 * G, delta=0.1)
        np.testing.assert_allclose(packed, 0.1, rtol=0.03)


if __name__ == "__main__":
    unittest.main()
