# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in Python: lattices are recognised, whatever the numbers of their cells, and nothing else is; geometry chunk by chunk."""
import os
import tempfile
import unittest

import numpy as np

from tests.cases.harness import boxes
from tests.cases.harness import haff
from haff.case import lattice, mesh


class Meshes(unittest.TestCase):
    n, size = (7, 5, 3), (1.4, 0.5, 0.9)

    def setUp(self):
        self._temporary = tempfile.TemporaryDirectory(prefix="haff")
        self.path = self._temporary.name
        os.makedirs(os.path.join(self.path, "system"))

    def tearDown(self):
        self._temporary.cleanup()

    def box(self, n=None, hole=None, **others):
        boxes.write_mesh(self.path, n or self.n, self.size, hole=hole, **others)
        return haff.Case(self.path)

    def holes(self):
        hole = np.zeros(np.prod(self.n), bool)
        hole[[0, 20, 52, 104]] = True
        return hole

    def renumbered(self, case, seed=3):
        """Cells in any order, as gmsh numbers them."""
        new = np.random.default_rng(seed).permutation(case.mesh.cells)
        case.mesh.owner, case.mesh.neighbour = new[case.mesh.owner], new[case.mesh.neighbour]
        return new

    def test_lattice_of_boxes(self):
        hole = self.holes()
        for binary in (False, True):
            case = self.box(hole=hole, binary=binary)
            found = case.lattice()
            self.assertEqual(found.shape, self.n)
            for edges, k, length in zip(found.edges, self.n, self.size):
                np.testing.assert_allclose(edges, np.linspace(0, length, k + 1), atol=1e-15)
            np.testing.assert_array_equal(found.index, np.flatnonzero(~hole))
            np.testing.assert_allclose(case.centres, boxes.centres(self.n, self.size)[~hole], atol=1e-15)
            self.assertTrue(found.equal and not found.full and not found.ordered)
        self.assertTrue(self.box().lattice().ordered)

    def test_one_and_two_dimensions(self):
        for n in ((6, 1, 1), (1, 4, 1), (1, 3, 4), (1, 1, 1)):
            with self.subTest(n):
                case = self.box(n)
                self.assertEqual(case.lattice().shape, n)
                np.testing.assert_allclose(case.centres, boxes.centres(n, self.size), atol=1e-15)
                np.testing.assert_allclose(case.volumes, np.prod(self.size) / np.prod(n), rtol=1e-13)

    def test_numbers_of_cells_do_not_matter(self):
        """Every cell keeps its place, and centres and volumes are those of the faces."""
        hole = self.holes()
        case = self.box(hole=hole)
        centres, new = case.mesh.cell_geometry()[0], None
        new = self.renumbered(case)
        found = case.lattice()
        np.testing.assert_array_equal(found.index[new], np.flatnonzero(~hole))
        np.testing.assert_allclose(case.centres[new], centres, atol=1e-15)
        values = np.random.default_rng(1).normal(size=len(new))
        raster = found.raster(values)
        self.assertEqual(raster.shape, self.n[::-1])
        i, j, k = found.ijk.T
        np.testing.assert_array_equal(raster[k, j, i], values)
        self.assertEqual(np.isnan(raster).sum(), hole.sum())
        np.testing.assert_array_equal(found.cells()[k, j, i], np.arange(len(new)))
        self.assertEqual(found.raster(np.stack([values] * 3, 1)).shape, (*self.n[::-1], 3))

    def test_faces_may_begin_at_any_corner(self):
        case = self.box()
        faces = case.mesh.face_points.reshape(-1, 4)
        for f, face in enumerate(faces):
            faces[f] = np.roll(face, f % 4)
        self.assertTrue(case.lattice().ordered)

    def test_unequal_cells(self):
        """Straight lines at any distance are a lattice, which is not `equal`; volumes are those of the faces."""
        case = self.box()
        case.mesh.points[:, 0] **= 2
        found = case.lattice()
        self.assertFalse(found.equal)
        centres, volumes = case.mesh.cell_geometry()
        np.testing.assert_allclose(case.volumes, volumes, rtol=1e-12)
        np.testing.assert_allclose(case.centres, centres, atol=1e-14)
        self.renumbered(case)
        again = haff.case.lattice.recognise(case.mesh)
        np.testing.assert_allclose(again.volumes(), case.mesh.cell_geometry()[1], rtol=1e-12)

    def test_find(self):
        hole = self.holes()
        case = self.box(hole=hole)
        found = case.lattice()
        np.testing.assert_array_equal(found.find(case.centres), np.arange(case.mesh.cells))
        outside = np.array([[-1e-9, 0.2, 0.2], [1.5, 0.2, 0.2], [0.3, 0.6, 0.2], [0.3, 0.2, -1], boxes.centres(self.n, self.size)[20]])
        self.assertEqual(found.find(outside).tolist(), [-1] * 5)
        self.assertEqual(self.box().lattice().find(np.array([self.size])).tolist(), [np.prod(self.n) - 1])  # the far corner

    def test_no_lattice(self):
        def sheared(m):
            m.points[:, 0] += 0.1 * m.points[:, 1]

        def dented(m):
            m.points[100, 1] += 1e-4

        def mixed_up(m):
            m.owner[[5, 9]] = m.owner[[9, 5]]

        def turned(m):
            m.face_points[40:44] = m.face_points[40:44][::-1].copy()

        for change in (sheared, dented, mixed_up, turned):
            with self.subTest(change.__name__):
                case = self.box()
                change(case.mesh)
                self.assertIsNone(lattice.recognise(case.mesh))
        case = self.box()
        dented(case.mesh)
        np.testing.assert_array_equal(case.centres, case.mesh.cell_geometry()[0])

    def test_refined_cell_is_no_lattice(self):
        """A cell cut in two beside one that is not: its faces are no unit squares."""
        case = self.box((2, 2, 1))
        m = case.mesh
        m.points[:, 1][m.points[:, 0] > 1] *= 0.5
        self.assertIsNone(lattice.recognise(m))

    def test_recognition_leaves_no_memory(self):
        case = self.box(binary=True)
        self.assertIsNotNone(case.lattice())
        self.assertFalse({"points", "owner", "neighbour", "_faces"} & set(case.mesh.__dict__))
        self.assertEqual(case.mesh.points.shape, (8 * 6 * 4, 3))
        case.mesh.release()
        self.assertEqual(len(case.mesh.owner), len(case.mesh.face_start) - 1)

    def test_chunks(self):
        """Geometry and lattices are the same whatever the length of the chunks."""
        case = self.box(hole=self.holes())
        case.mesh.points[:, 0] += 0.3 * case.mesh.points[:, 1] ** 2
        whole, keep = case.mesh.cell_geometry(), (mesh.CHUNK, lattice.CHUNK)
        try:
            mesh.CHUNK, lattice.CHUNK = 7, 11
            parts = case.mesh.cell_geometry()
            np.testing.assert_allclose(parts[0], whole[0], atol=1e-14)
            np.testing.assert_allclose(parts[1], whole[1], rtol=1e-13)
            case = self.box(hole=self.holes())
            self.renumbered(case)
            self.assertIsNotNone(case.lattice())
        finally:
            mesh.CHUNK, lattice.CHUNK = keep

    def test_faces_of_any_number_of_points(self):
        """A cube with one corner cut off: three pentagons, three squares, a triangle; 1/48 of the volume is missing."""
        write = lambda name, kind, text: boxes.write_dictionary(self.path, "constant/polyMesh", name, text)
        points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, .5), (1, .5, 1), (.5, 1, 1)]
        faces = [(0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 6, 3), (1, 2, 7, 8, 5), (3, 6, 9, 7, 2), (4, 5, 8, 9, 6), (7, 9, 8)]
        write("points", "vectorField", f"{len(points)}\n(\n" + "\n".join("(%g %g %g)" % p for p in points) + "\n)\n")
        write("faces", "faceList", f"{len(faces)} // of any kind\n(\n" + "\n".join(f"{len(f)}({' '.join(map(str, f))})" for f in faces) + "\n)\n")
        write("owner", "labelList", "7{0}\n")
        write("neighbour", "labelList", "0()\n")
        write("boundary", "polyBoundaryMesh", "1 ( all { type patch; nFaces 7; startFace 0; } )")
        case = haff.Case(self.path)
        self.assertIsNone(case.lattice())
        self.assertAlmostEqual(case.volumes[0], 1 - 1 / 48, places=14)
        moved = (0.5 - (1 - 0.125) / 48) / (1 - 1 / 48)  # the cut-off corner's centre is at 1 - 1/8
        np.testing.assert_allclose(case.centres[0], moved, atol=1e-14)


if __name__ == "__main__":
    unittest.main()
