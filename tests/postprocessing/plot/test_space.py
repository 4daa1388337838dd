# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as flat shapes: sections, cuts, lines, surfaces. Areas, lengths and places are known; every kind of mesh is cut."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.plot import cases

from haff.plot import labels, solid, views
from haff.plot.canvas import Canvas, FINE, View
from haff.plot.quantity import CannotDraw, Quantity
from haff.plot.space import Section

GMSH = shutil.which("gmsh")


def area(section):
    """The area of all polygons, by the formula of Gauss."""
    total = 0.0
    for p in section.shapes:
        total += 0.5 * abs(np.sum(p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1)))
    return total


def length(lines):
    return float(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum())


class Lattices(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def test_flat_with_a_hole(self):
        """12 x 10 cells with a block of 3 x 2 left out: its place is empty, its outline is a wall, the rest is not."""
        n, size = (12, 10, 1), (1.2, 1.0, 0.1)
        hole = np.zeros(n[::-1], bool)
        hole[0, 4:6, 5:8] = True
        at = cases.box(self.path("hole"), n, size, hole=hole.ravel(), hole_patch="body")
        flat = cases.space(self.path("hole")).flat()
        self.assertEqual(flat.names, ("x", "y"))
        x = flat.image(at[:, 0])
        np.testing.assert_array_equal(np.isnan(x), hole[0])
        np.testing.assert_allclose(x[0], np.arange(12) * 0.1 + 0.05)
        self.assertAlmostEqual(length(flat.walls), 2 * (0.3 + 0.2))
        self.assertAlmostEqual(length(flat.rims), 2 * (1.2 + 1.0))
        self.assertTrue(((flat.walls[..., 0] > 0.49) & (flat.walls[..., 0] < 0.81)).all())

    def test_axes(self):
        """A case in x and z is drawn in x and z; one with a few cells across is a column."""
        cases.box(self.path("xz"), (6, 1, 7), (1, 1, 2))
        space = cases.space(self.path("xz"))
        self.assertEqual((space.axes, space.flat().names, space.column), ((0, 2), ("x", "z"), None))
        at = cases.box(self.path("column"), (2, 9, 2), (1, 9, 1), {"x": "cyclic", "z": "cyclic"})
        space = cases.space(self.path("column"))
        self.assertEqual((space.dim, space.column), (3, 1))
        y, means = space.along(1)
        np.testing.assert_allclose(y, np.arange(9) + 0.5)
        np.testing.assert_allclose(means(at[:, 1] ** 2 + at[:, 0]), y**2 + 0.5)

    def test_mirrored(self):
        """The image beyond a line at the end of the mesh, or below it with a gap; its cells are those of the mesh. A hole is mirrored, too."""
        n, size = (12, 10, 1), (1.2, 1.0, 0.1)
        hole = np.zeros(n[::-1], bool)
        hole[0, 4:6, 5:8] = True
        at = cases.box(self.path("mirrored"), n, size, hole=hole.ravel(), hole_patch="body")
        flat = cases.space(self.path("mirrored")).flat()
        both = flat.mirrored("y", 0.0)
        y = both.image(at[:, 1])
        self.assertEqual((y.shape, both.low[1], both.high[1]), ((20, 12), -1.0, 1.0))
        np.testing.assert_array_equal(y, y[::-1])
        np.testing.assert_array_equal(np.isnan(y[10:]), hole[0])
        self.assertAlmostEqual(length(both.walls), 2 * length(flat.walls))
        self.assertAlmostEqual(length(both.rims), 2 * (2.0 + 1.2), msg="the line itself is no end")
        gap = flat.mirrored("x", -0.5)
        self.assertEqual(gap.image(at[:, 0]).shape, (10, 25))
        self.assertTrue(np.isnan(gap.image(at[:, 0])[:, 12]).all())
        np.testing.assert_allclose(gap.edges[0][[0, 12, 13, 25]], (-2.2, -1.0, 0.0, 1.2), atol=1e-12)
        for name, place, says in (("y", 0.5, "the mesh lies on both sides"), ("z", 0.0, "has the coordinates x and y")):
            with self.assertRaisesRegex(CannotDraw, says):
                flat.mirrored(name, place)

    def test_cuts(self):
        """A layer of a lattice has its own values; a slanted plane through a cube has the area of its exact polygon."""
        at = cases.box(self.path("cube"), (8, 6, 5), (0.8, 0.6, 0.5), {"y": "wall"})
        space = cases.space(self.path("cube"))
        for axis, (h, v) in enumerate(((2, 1), (0, 2), (0, 1))):
            section = space.cut(np.eye(3)[axis], (0.33, 0.33, 0.33))
            self.assertEqual(section.names, ("xyz"[h], "xyz"[v]))
            self.assertEqual(section.raster.shape, ((8, 6, 5)[v], (8, 6, 5)[h]))
            for k, values in ((axis, 0.35), (h, np.broadcast_to((section.edges[0][1:] + section.edges[0][:-1]) / 2, section.raster.shape))):
                np.testing.assert_allclose(section.image(at[:, k]), values)
        self.assertAlmostEqual(length(space.cut((0, 0, 1), (0, 0, 0.2)).walls), 2 * 0.8)
        slanted = space.cut((1, 1, 0), (0.301, 0.3, 0.1))
        chord = np.hypot(0.6, 0.6)  # from (0.601, 0) to (0.001, 0.6)
        self.assertAlmostEqual(area(slanted), chord * 0.5, places=9)
        with self.assertRaisesRegex(CannotDraw, "lies outside the mesh"):
            space.cut((1, 0, 0), (0.9, 0, 0))
        with self.assertRaisesRegex(CannotDraw, "does not cut"):
            space.cut((1, 1, 0), (3, 3, 0))

    def test_cuts_at_the_ends(self):
        """A plane in the first or the last layer, or on the end of the mesh, shows that layer."""
        at = cases.box(self.path("ends"), (8, 6, 5), (0.8, 0.6, 0.5))
        space = cases.space(self.path("ends"))
        for axis, end in enumerate((0.8, 0.6, 0.5)):
            for where, layer in ((0, 0.05), (0.03, 0.05), (end - 0.05, end - 0.05), (end, end - 0.05)):
                image = space.cut(np.eye(3)[axis], np.full(3, where)).image(at[:, axis])
                np.testing.assert_allclose(image, layer, err_msg=f"{'xyz'[axis]} = {where}")

    def test_planes_of_a_page(self):
        """Without a wish the planes go through the centre of the middle cell, wherever the field differs."""
        at = cases.box(self.path("planes"), (8, 6, 5), (0.8, 0.6, 0.5))
        found = views.inside(cases.space(self.path("planes")), (at[:, 0] < 0.2) * 1.0)
        np.testing.assert_allclose(found, (0.45, 0.35, 0.25))

    def test_line(self):
        """Along a line each cell stands once, in the middle of its part; holes are left out."""
        hole = np.zeros((1, 4, 10), bool)
        hole[0, :, 4:6] = True
        at = cases.box(self.path("line"), (10, 4, 1), (1.0, 0.4, 0.1), hole=hole.ravel())
        space = cases.space(self.path("line"))
        s, cells = space.line((0, 0.15, 0.05), (1, 0.15, 0.05))
        np.testing.assert_allclose(s, [0.05, 0.15, 0.25, 0.35, 0.65, 0.75, 0.85, 0.95])
        np.testing.assert_allclose(at[cells, 0], s)
        np.testing.assert_allclose(at[cells, 1], 0.15)
        with self.assertRaisesRegex(CannotDraw, "does not meet the mesh"):
            space.line((0, 2, 0.05), (1, 2, 0.05))

    def test_surface_of_a_ball(self):
        """r = 0.35 on 24^3 cells: an area within 1 % of a sphere's, corners at r within h^2, normals along r."""
        at = cases.box(self.path("ball"), (24, 24, 24), (1, 1, 1)) - 0.5
        space = cases.space(self.path("ball"))
        r = np.linalg.norm(at, axis=1)
        corners, normals = solid.isosurface(space, r, 0.35)
        corners = corners - 0.5
        size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
        self.assertAlmostEqual(size / (4 * np.pi * 0.35**2), 1, delta=0.01)
        away = np.linalg.norm(corners, axis=2)
        self.assertLess(np.abs(away - 0.35).max(), (1 / 24) ** 2)
        self.assertGreater(np.abs(np.einsum("ijk,ijk->ij", normals, corners) / away).min(), 0.97)
        self.assertEqual(len(solid.isosurface(space, r, 9.0)[0]), 0)

    def test_no_mesh(self):
        cases.control(self.path("none"))
        with self.assertRaisesRegex(FileNotFoundError, "has no mesh .*gmshToCase"):
            cases.space(self.path("none"))


@unittest.skipUnless(GMSH, "gmsh is not installed")
class Polyhedra(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.wedge, cls.wedge_at = cases.meshed(cls.folder, "wedge15", 8)
        cls.sphere, cls.sphere_at = cases.meshed(cls.folder, "sphere3D", 6)

    def test_triangles(self):
        """Each cell is one triangle; together they fill the domain, which its ends close."""
        space = cases.space(self.wedge)
        self.assertEqual(space.axes, (0, 1))
        flat = space.flat()
        self.assertEqual(sorted(flat.cells), list(range(space.mesh.cells)))
        self.assertAlmostEqual(area(flat) * space.size[2], space.case.volumes.sum(), places=9)
        ends = np.concatenate((flat.walls, flat.rims))
        _, count = np.unique(np.round(ends.reshape(-1, 2), 9), axis=0, return_counts=True)
        self.assertEqual(set(count), {2})
        self.assertGreater(length(flat.walls), 5)
        middles = np.array([p.mean(axis=0) for p in flat.shapes])
        np.testing.assert_allclose(middles, self.wedge_at[flat.cells, :2], atol=1e-9)
        both = flat.mirrored("y", float(flat.low[1]))
        self.assertAlmostEqual(area(both), 2 * area(flat))
        np.testing.assert_array_equal(both.cells, np.tile(flat.cells, 2))

    def test_cut_of_tetrahedra(self):
        """The cut by x = -12 of the gas about a sphere: its polygons fill what its walls and other ends enclose."""
        space = cases.space(self.sphere)
        section = space.cut((1, 0, 0), (-12, 0, 0))
        self.assertTrue(set(section.ends) <= {3, 4})
        self.assertEqual(len(set(section.cells)), len(section.cells))
        ends = np.concatenate((section.walls, section.rims))
        _, count = np.unique(np.round(ends.reshape(-1, 2), 7), axis=0, return_counts=True)
        self.assertEqual(set(count), {2})  # the ends close around the polygons
        turned = 0.5 * abs(ring(chain(ends)))
        self.assertAlmostEqual(area(section), turned, delta=1e-6 * turned)

    def test_planes_of_a_page(self):
        """Without a wish the planes meet at the centroid of the cells whose values differ from the median, but for 1e-4 of the size."""
        space = cases.space(self.sphere)
        low, high = space.low, space.high
        some = (self.sphere_at < low + 0.4 * (high - low)).all(axis=1)
        self.assertTrue(0 < some.sum() < len(some) / 2)
        volume = space.case.volumes[some]
        found = views.inside(space, 3 + 2.0 * some)
        np.testing.assert_array_less(abs(found - volume @ self.sphere_at[some] / volume.sum()), 1.2e-4 * (high - low))
        np.testing.assert_array_less(abs(views.inside(space, np.full(len(some), 3.0)) - (low + high) / 2), 1.2e-4 * (high - low))

    def test_line_through_tetrahedra(self):
        """The middles of the parts lie in their cells, and the parts follow one another."""
        space = cases.space(self.sphere)
        a, b = np.array([-24.0, 3.0, 2.0]), np.array([-1.0, 14.0, 3.0])
        s, cells = space.line(a, b)
        self.assertGreater(len(cells), 5)
        self.assertTrue((np.diff(s) > 0).all())
        places = a + s[:, None] * (b - a) / np.linalg.norm(b - a)
        centre, normal = space.mesh.face_geometry()
        inner = len(space.mesh.neighbour)
        for place, cell in zip(places, cells):
            own, other = np.flatnonzero(space.mesh.owner == cell), np.flatnonzero(space.mesh.neighbour == cell)
            self.assertLess(max(np.einsum("ij,ij->i", normal[own], place - centre[own])), 1e-9)
            self.assertGreater(min(np.einsum("ij,ij->i", normal[other], place - centre[other]), default=1), -1e-9)
        self.assertGreater(inner, 0)

    def test_surface_in_tetrahedra(self):
        """The surface of a distance lies within a cell's width of where it should, and nowhere else."""
        space = cases.space(self.sphere)
        r = np.linalg.norm(self.sphere_at, axis=1)
        corners, _ = solid.isosurface(space, r, 14.0)
        away = np.linalg.norm(corners.reshape(-1, 3), axis=1)
        self.assertGreater(len(corners), 50)
        self.assertLess(np.abs(away.mean() - 14), 0.5)
        self.assertLess(np.abs(away - 14).max(), np.cbrt(6 * space.case.volumes.max()))


def chain(lines):
    """Lines as one closed ring of points."""
    left = [tuple(map(tuple, np.round(line, 7))) for line in lines]
    points = [left[0][0], left[0][1]]
    left.pop(0)
    while left:
        k = next(k for k, line in enumerate(left) if points[-1] in line)
        a, b = left.pop(k)
        points.append(b if a == points[-1] else a)
    return np.array(points[:-1])


def ring(p):
    return np.sum(p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1))


class Colours(unittest.TestCase):
    def test_span(self):
        """The span of a picture, not that of the values, says whether a map of colours has two signs."""
        quantity = Quantity("q", "", (), np.array([1.0, 2.0]), {})
        self.assertNotEqual(quantity.colours(), labels.SIGNED)
        self.assertEqual(quantity.colours((-1.0, 1.0)), labels.SIGNED)


class Sections(unittest.TestCase):
    def test_corners_that_round_off_parts_are_one_place(self):
        """Two triangles share an edge, whose corners differ by round-off: four places, and two cells around each shared one."""
        corners = np.array([[0, 0], [1, 0], [0, 1], [1 + 1e-13, 1e-13], [1, 1], [-1e-13, 1 - 1e-13]])
        section = Section(("x", "y"), None, None, corners=corners, ends=np.array([3, 3]), cells=np.array([0, 1]))
        places, triangles, around, _ = section.triangles()
        self.assertEqual((len(places), len(triangles)), (4, 2))
        self.assertEqual(sorted(np.bincount(around)), [1, 1, 2, 2])


class Images(unittest.TestCase):
    """The canvas: sizes in pixels, and what is nearer hides what is behind."""

    def setUp(self):
        self.view = View((0, 0, 0), (1, 1, 1), azimuth=0, height=0)  # along -z, x to the right, y up
        self.canvas = Canvas(self.view, (200, 200), margin=0)

    def test_triangle(self):
        corners = np.array([[[0.1, 0.1, 0.5], [0.9, 0.1, 0.5], [0.1, 0.9, 0.5]]])
        self.canvas.triangles(corners, np.broadcast_to([0.0, 0, 1], (1, 3, 3)), (1.0, 0, 0), shaded=False)
        image = self.canvas.image()
        self.assertAlmostEqual(image[..., 3].sum(), 0.32 * 200**2, delta=0.01 * 200**2)
        self.assertEqual(image[150, 50].tolist(), [1, 0, 0, 1])
        self.assertEqual(image[50, 150, 3], 0)

    def test_the_nearer_sphere_is_seen(self):
        colours = np.array([[1.0, 0, 0], [0, 0, 1.0]])
        self.canvas.spheres(np.array([[0.5, 0.5, 0.2], [0.5, 0.5, 0.8]]), np.array([0.4, 0.1]), colours)
        image = self.canvas.image()
        self.assertGreater(image[100, 100, 2], 2 * image[100, 100, 0])
        self.assertGreater(image[100, 160, 0], 2 * image[100, 160, 2])
        self.assertAlmostEqual(image[..., 3].sum(), np.pi * 80**2, delta=0.02 * np.pi * 80**2)

    def test_lines_behind_surfaces_are_hidden(self):
        corners = np.array([[[0.0, 0, 0.5], [1, 0, 0.5], [0, 1, 0.5]]])
        self.canvas.triangles(corners, np.broadcast_to([0.0, 0, 1], (1, 3, 3)), (1.0, 1.0, 1.0), shaded=False)
        for z, seen in ((0.2, False), (0.8, True)):
            self.canvas.lines(np.array([[[0.1, 0.2, z], [0.5, 0.2, z]]]), (0.0, 0.0, 0.0))
            self.assertEqual(bool(self.canvas.image()[160, 60, 0] < 0.6), seen)
        self.assertEqual(FINE, 2)


if __name__ == "__main__":
    unittest.main()
