# SPDX-License-Identifier: GPL-3.0-or-later
"""The measurements of shocks find what was put in: exact fields on a lattice, whose cells the shock cuts anywhere."""
import os
import tempfile
import unittest

import numpy as np

import haff
from haff.plot import cellmap
from studies.exact import bluntBody
from studies.exact.eos import GoldshteinShapiro
from studies.exact.obliqueShock import ObliqueShock
from studies.made import boxes
from studies.measured import shocks


class Shocks(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="haff")
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name
        self.eos = GoldshteinShapiro(1.0)
        rho = self.eos.rho(0.1)
        self.shock = ObliqueShock(self.eos, rho, self.eos.p(rho, 2.0), 4.0)

    def case(self, n, size, origin, inside, behind, **mesh):
        """The two states on a box: inside(points): behind the shock; cells cut by it hold the mean of 64 points."""
        boxes.write_mesh(self.folder, n, size, **mesh)
        points = os.path.join(self.folder, "constant", "polyMesh", "points")
        centre = boxes.centres(n, size)
        kept = ~mesh["hole"] if "hole" in mesh else np.ones(len(centre), bool)
        with open(points) as f:
            head, body = f.read().split("(\n", 1)
        xyz = np.array(body.replace("(", " ").replace(")", " ").split(), float).reshape(-1, 3) + (*origin, 0)
        with open(points, "w") as f:
            f.write(head + "(\n" + "\n".join("(%r %r %r)" % tuple(p) for p in xyz.tolist()) + "\n)\n")
        part = np.zeros(len(centre))
        for i in range(8):
            for j in range(8):
                step = np.array([(i + 0.5) / 8 - 0.5, (j + 0.5) / 8 - 0.5]) * np.array(size[:2]) / n[:2]
                part += inside(centre[:, :2] + origin + step) / 64
        s = self.shock
        mix = lambda a, b: (a + (b - a) * part)[kept]
        boxes.write_field(self.folder, "rho", mix(s.rho, behind.rho), '".*" zeroGradient')
        boxes.write_field(self.folder, "p", mix(s.p, behind.p), '".*" zeroGradient')
        boxes.write_field(self.folder, "U", np.outer(mix(s.speed, behind.speed), (1.0, 0, 0)), '".*" zeroGradient')
        boxes.write_dictionary(self.folder, "system", "controlDict", "")
        return haff.Case(self.folder)

    def test_wedge(self):
        theta = np.radians(15)
        beta = float(self.shock.angle(theta))
        behind = self.shock.behind(beta)
        case = self.case((44, 36, 1), (11.0, 9.0, 0.1), (-1.0, 0.0),
                         lambda at: (at[:, 0] > 0) & (np.arctan2(at[:, 1], at[:, 0]) < beta), behind)
        stream = shocks.upstream(case, self.eos)
        self.assertAlmostEqual(stream.mach, 4, delta=1e-12)
        fit = shocks.straight_shock(case, stream, theta)
        self.assertAlmostEqual(np.degrees(fit.angle), np.degrees(beta), delta=0.1)
        self.assertLess(abs(fit.offset), 0.1)
        self.assertLess(fit.scatter, 0.1)
        off = shocks.behind_wedge(case, stream, theta)
        for value in (off.rho, off.p, off.mach):
            self.assertAlmostEqual(value, 0, delta=1e-10)

    def test_stand_off(self):
        n, size = (30, 40, 1), (3.0, 4.0, 0.1)
        at = boxes.centres(n, size)[:, :2] - (3, 0)
        case = self.case(n, size, (-3.0, 0.0), lambda p: np.linalg.norm(p, axis=1) < 1.537, self.shock.behind(np.pi / 2),
                         hole=np.linalg.norm(at, axis=1) < 1, hole_patch="wall")
        radius = shocks.body_radius(case)
        self.assertAlmostEqual(radius, 1, delta=0.15)
        self.assertAlmostEqual((1 + shocks.stand_off(case, self.shock)) * radius, 1.537, delta=0.01)

    def test_billig(self):
        """Stand-off of a sphere and a cylinder at infinite Mach number, and the growth towards Mach 1."""
        self.assertEqual(shocks.billig(np.inf, "sphere"), 0.143)
        self.assertGreater(shocks.billig(2, "cylinder"), shocks.billig(3, "cylinder"))

    def test_euler(self):
        """At Mach 10 the Euler equations on a coarse polar grid have the fit to experiments; gas at rest stays so."""
        grid = bluntBody.Grid("cylinder", 10, 2.1, (12, 16))
        self.assertAlmostEqual(grid.run([3])[0], shocks.billig(10, "cylinder"), delta=0.02)  # a third of a cell
        for body in ("cylinder", "sphere"):
            grid = bluntBody.Grid(body, 0, 2.1, (12, 16))
            still = bluntBody.conserved(np.broadcast_to(grid.stream[:, None, None], (4, *grid.volume.shape)))
            np.testing.assert_allclose(grid.rate(still), 0, atol=1e-3)  # normals are those at the middle of a face: 4e-4 on this grid

    def test_spread(self):
        """Points over triangles: their means are the centroids, their second moments near the triangle's."""
        class Mesh:
            cells, patches = 2, {"back": ("empty", 0, 2)}
            points = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]], float)
            face_start, face_points, owner = np.array([0, 3, 6]), np.array([0, 1, 2, 1, 3, 2]), np.array([1, 0])
        at = cellmap.spread(Mesh)
        np.testing.assert_allclose(at.mean(axis=1), [[4 / 3, 2 / 3], [2 / 3, 1 / 3]], rtol=1e-14)
        self.assertEqual(at.shape, (2, 16, 2))
        self.assertAlmostEqual(at[0, :, 0].var() / (4 / 18), 1, delta=1 / 15)
        self.assertTrue(np.all(at[1] @ (0.5, 1) < 1))


if __name__ == "__main__":
    unittest.main()
