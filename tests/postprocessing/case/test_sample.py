# SPDX-License-Identifier: GPL-3.0-or-later
"""Values at points, along lines and in slices of any mesh; values on patches; units. On lattices, sheared and warped boxes, simplices."""
import os
import re
import shutil
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes
from tests.cases.harness import haff

from haff.case.foam import FormatError  # noqa: E402

SLOPE = np.array([[1.0, -2.0, 3.0], [0.5, 4.0, -1.0]])
SQUARE = """h = 1/12; Point(1) = {0, 0, 0, h}; Point(2) = {1, 0, 0, h}; Point(3) = {1, 1, 0, h}; Point(4) = {0, 1, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Physical Curve("around") = {1:4}; Physical Surface("gas") = {1};
"""
CUBE = """SetFactory("OpenCASCADE"); Box(1) = {0, 0, 0, 1, 1, 1}; Mesh.MeshSizeMax = 1/6; Mesh.MeshSizeMin = 1/6;
Physical Surface("around") = {1:6}; Physical Volume("gas") = {1};
"""


class Temporary(unittest.TestCase):
    def setUp(self):
        self._temporary = tempfile.TemporaryDirectory(prefix="haff")
        self.folder = self._temporary.name

    def tearDown(self):
        self._temporary.cleanup()

    def box(self, n, size=(1.0, 1.0, 1.0), name="box", **others):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.join(path, "system"), exist_ok=True)
        boxes.write_mesh(path, n, size, **others)
        return haff.Case(path)

    def moved(self, n, move, **others):
        """A box whose points [..][3] are moved to move(points): no lattice."""
        case = self.box(n, **others)
        case.mesh.points[:] = move(case.mesh.points)
        self.assertIsNone(case.lattice())
        return case

    def simplices(self, text):
        case = os.path.join(self.folder, "simplices")
        os.makedirs(os.path.join(case, "system"))
        with open(case + "/mesh.geo", "w") as f:
            f.write(text)
        harness.mesh(case, 1)
        return haff.Case(case)


class Sampling(Temporary):
    def warp(self, points):
        """Moves the inner points of the unit cube of 6^3 boxes by up to 0.15 of a box: faces are no longer flat."""
        inner = ((points > 1e-9) & (points < 1 - 1e-9)).all(axis=1)
        return points + inner[:, None] * np.random.default_rng(2).uniform(-0.15, 0.15, points.shape) / 6

    def meshes(self):
        """(name, case, points in it)."""
        inside = np.random.default_rng(5).random((3000, 3))
        yield "line", self.box((9, 1, 1), name="line"), inside
        yield "plane", self.box((7, 5, 1), name="plane"), inside
        yield "solid", self.box((6, 5, 4), name="solid"), inside
        shear = np.array([[1, 0, 0], [0.5, 1, 0], [0, 0, 1]])
        yield "sheared", self.moved((7, 5, 1), lambda p: p @ shear, name="sheared"), inside @ shear
        yield "graded", self.moved((12, 9, 4), lambda p: p**3 @ shear, name="graded"), inside**3 @ shear
        yield "warped", self.moved((6, 6, 6), self.warp, name="warped"), inside
        if shutil.which("gmsh"):
            yield "triangles", self.simplices(SQUARE), inside
            shutil.rmtree(os.path.join(self.folder, "simplices"))
            yield "tetrahedra", self.simplices(CUBE), inside

    def test_linear_fields(self):
        """Order 2 is exact for them at any point, up to the walls; every point of the mesh has a cell, none outside has one."""
        for name, case, points in self.meshes():
            with self.subTest(name):
                np.testing.assert_array_equal(case.cells_at(case.centres), np.arange(case.mesh.cells))
                along = SLOPE.copy()
                along[:, case.finder.empty_axes] = 0
                found = case.finder.values(case.centres @ along.T + 7, points, order=2)
                np.testing.assert_allclose(found, points @ along.T + 7, rtol=0, atol=1e-12)
                first = case.finder.values(case.centres @ along[0], points, order=1)
                np.testing.assert_array_equal(first, (case.centres @ along[0])[case.cells_at(points)])
                outside = np.array(points)
                outside[:, 0] += 2 + np.ptp(points[:, 0])
                self.assertTrue((case.cells_at(outside) == -1).all())
                self.assertTrue(np.isnan(case.finder.values(case.centres, outside, order=2)).all())

    def test_containing_cells(self):
        """Sheared and cubed boxes hold the points that were sheared and cubed with them; in any order of the points."""
        n, inside = np.array((12, 9, 4)), np.random.default_rng(6).random((20000, 3))
        shear = np.array([[1, 0, 0], [0.5, 1, 0], [0.2, 0, 1]])
        case = self.moved(n, lambda p: p**3 @ shear)
        i, j, k = (inside * n).astype(int).T
        found = case.cells_at(inside**3 @ shear)
        np.testing.assert_array_equal(found, i + n[0] * (j + n[1] * k))
        np.testing.assert_array_equal(case.cells_at((inside**3 @ shear)[::-1])[::-1], found)
        corner = np.array([case.mesh.points.min(axis=0), case.mesh.points.max(axis=0), case.mesh.points[7]])
        self.assertTrue((case.cells_at(corner) >= 0).all())

    def test_holes_and_narrow_ways(self):
        """Beside holes, also where a cell has one neighbour only, linear fields stay exact; holes hold no points."""
        hole = np.zeros(24, bool)
        hole[[6, 7, 8, 10, 13, 15]] = True  # of 6 x 4: places 12 and 14 have one neighbour each
        for case in (self.box((6, 4, 1), hole=hole), self.moved((6, 4, 1), lambda p: p @ [[1, 0, 0], [0.3, 1, 0], [0, 0, 1]], hole=hole)):
            linear = case.centres[:, :2] @ SLOPE[0, :2]
            points = case.centres + np.random.default_rng(3).uniform(-0.05, 0.05, case.centres.shape)
            np.testing.assert_allclose(case.finder.values(linear, points, 2), points[:, :2] @ SLOPE[0, :2], atol=1e-13)
        gone = self.box((6, 4, 1), name="whole").centres[hole]
        self.assertTrue((self.box((6, 4, 1), hole=hole).cells_at(gone) == -1).all())

    def test_order(self):
        """Errors of a smooth field fall by 2 and by 4 with half the cells' size: measured 2.0 and 4.1."""
        points, errors = np.random.default_rng(4).random((2000, 3)), []
        wave = lambda x: np.sin(3 * x[:, 0] + 2 * x[:, 1])
        for n in (32, 64):
            case = self.box((n, n, 1), name=f"n{n}")
            errors.append([np.abs(case.finder.values(wave(case.centres), points, k) - wave(points)).mean() for k in (1, 2)])
        ratio = np.array(errors[0]) / errors[1]
        np.testing.assert_allclose(ratio, (2, 4), rtol=0.1)

    def test_fields_and_lines(self):
        case = self.box((8, 5, 1), (1.6, 1.0, 0.1))
        U, T = case.centres @ np.array([[1, 0, 0], [2, 1, 0], [0, 0, 0]]), case.centres[:, 0]
        for time, factor in (("0.5", 1), ("2", 3)):
            boxes.write_field(case.path, "U", factor * U, time=time)
            boxes.write_field(case.path, "T", factor * T, time=time)
        points = [[0.3, 0.6, 9], [0.1, 0.1, 0.0]]
        np.testing.assert_allclose(case.sample("T", points, order=2), [0.9, 0.3], rtol=1e-13)
        both = case.sample(["T", "U"], points, time=0.4, order=2)
        np.testing.assert_allclose(both["U"], [[1.5, 0.6, 0], [0.3, 0.1, 0]], atol=1e-13)
        line = case.sample_line("T", (0.2, 0.5, 0), (1.8, 0.5, 0), 5, time="0.5")
        np.testing.assert_allclose(line["distance"], [0, 0.4, 0.8, 1.2, 1.6], rtol=1e-15)
        np.testing.assert_allclose(line["T"], [0.2, 0.6, 1.0, 1.4, np.nan], rtol=1e-13)
        self.assertEqual(case.fields("2"), ["T", "U"])

    def test_slices(self):
        """Of a lattice across an axis the cells themselves; elsewhere pixels; linear fields exact in both."""
        case = self.box((6, 5, 4))
        linear = case.centres @ SLOPE[0]
        boxes.write_field(case.path, "T", linear, time="1")
        found = case.slice("T", "y", 0.5)
        np.testing.assert_array_equal(found["T"], case.lattice().raster(linear)[:, 2, :])
        np.testing.assert_allclose(found.points[1, 2], [2.5 / 6, 0.5, 1.5 / 4], rtol=1e-14)
        for axis in range(3):
            cells = np.moveaxis(np.arange(120).reshape(4, 5, 6), 2 - axis, 0)
            edges = case.lattice().edges[axis]
            for at, layer in ((edges[0], 0), (edges[1], 1), (edges[-2], -1), (edges[-1], -1), (np.nextafter(edges[2], 0), 1)):  # a plane on an edge: above it
                np.testing.assert_array_equal(case.slice("T", "xyz"[axis], at).cells, cells[layer], f"{axis} {at}")
            for at in (np.nextafter(edges[-1], 2), np.nextafter(edges[0], -1), 1.5, -7):
                self.assertTrue((case.slice("T", "xyz"[axis], at).cells == -1).all(), (axis, at))
        for normal, at in (((1, 1, 0.3), (0.5, 0.4, 0.6)), ((0, 0, -2), -0.4)):
            found = case.slice(["T"], normal, at, pixels=50, order=2)
            inside = (found.points > 0).all(axis=2) & (found.points < 1).all(axis=2)
            np.testing.assert_array_equal(np.isnan(found["T"]), ~inside)
            np.testing.assert_allclose(found["T"][inside], found.points[inside] @ SLOPE[0], atol=1e-13)
        flat = self.moved((6, 5, 1), lambda p: p @ [[1, 0, 0], [0.5, 1, 0], [0, 0, 1]], name="flat").slice(pixels=90)
        self.assertEqual(flat.cells.shape, (60, 90))
        self.assertAlmostEqual((flat.cells >= 0).mean(), 2 / 3, 2)

    def test_refusals(self):
        case = self.box((3, 3, 1))
        boxes.write_field(case.path, "T", np.ones(9), time="1")
        for what, message in ((lambda: case.sample("T", [[0, 0]]), "shape"), (lambda: case.sample("T", [[0, 0, 0]], order=3), "order is 3"),
                              (lambda: case.slice("T", "w"), "normal 'w'"), (lambda: case.slice("T", (0, 0, 0)), "no direction")):
            with self.assertRaisesRegex(ValueError, message):
                what()
        with self.assertRaises(FileNotFoundError):
            case.sample("rho", [[0, 0, 0]])
        with self.assertRaisesRegex(FileNotFoundError, "no times"):
            self.box((2, 1, 1), name="new").sample("T", [[0, 0, 0]])


class Patches(Temporary):
    def write(self, case, name, kind, boundary, values):
        os.makedirs(os.path.join(case.path, "1"), exist_ok=True)
        rows = "\n".join("(%r %r %r)" % tuple(v) if np.ndim(v) else repr(v) for v in values.tolist())
        text = (boxes.header(f"vol{kind.capitalize()}Field", name) + "dimensions [0 1 -1 0 0 0 0];\n"
                f"internalField nonuniform List<{kind}>\n{len(values)}\n(\n{rows}\n)\n;\nboundaryField\n{{\n").encode()
        with open(os.path.join(case.path, "1", name), "wb") as f:
            f.write(text + (boundary if isinstance(boundary, bytes) else boundary.encode()) + b"}\n")

    def test_values(self):
        case = self.box((2, 3, 1))
        T, U = np.arange(6.0), np.arange(18.0).reshape(6, 3)
        self.write(case, "T", "scalar", """xLow { type fixedValue; value uniform 4; } // a comment }
            xHigh { type calculated; table { values ((0 1) (2 3)); } value nonuniform List<scalar> 3(7 8 9); }
            "y.*" { type zeroGradient; value uniform 100; } zEmpty { type empty; }\n""", T)
        self.write(case, "U", "vector", """".*" { type noSlip; } "x.*" { type slip; } yLow { type inletOutlet; value uniform (1 2 3); }
            zEmpty { type empty; }\n""", U)
        for name, patch, expected in (("T", "xLow", [4, 4, 4]), ("T", "xHigh", [7, 8, 9]), ("T", "yLow", [0, 1]), ("T", "yHigh", [4, 5]),
                                      ("T", "zEmpty", []), ("U", "yLow", [[1, 2, 3]] * 2), ("U", "yHigh", [[0, 0, 0]] * 2),
                                      ("U", "xHigh", [[0, 4, 5], [0, 10, 11], [0, 16, 17]])):
            np.testing.assert_array_equal(case.patch_values(name, patch, 1), expected, err_msg=f"{name} {patch}")
        with self.assertRaisesRegex(KeyError, "has no patch .*patches: "):
            case.patch_values("T", "wall")

    def test_binary_values(self):
        """Bytes that look like brackets and words are passed by the length of their list."""
        case, text = self.box((2, 3, 1)), np.frombuffer(b'} value ;{type x;"/* b}]', np.float64)
        self.assertEqual(len(text), 3)
        self.write(case, "T", "scalar", "", np.arange(6.0))
        path = os.path.join(case.path, "1", "T")
        raw = (b"xLow { type calculated; value nonuniform List<scalar> 3(" + text.tobytes() + b"); } xHigh { type a; value $internalField; }\n"
               b"\"y.*\" { type b; } zEmpty { type empty; }\n}\n")
        with open(path, "rb") as f:
            head = f.read().split(b"internalField")[0].replace(b"ascii;", b'binary; arch "LSB;label=32;scalar=64";')
        with open(path, "wb") as f:
            f.write(head + b"internalField nonuniform List<scalar> 6(" + np.arange(6.0).tobytes() + b");\nboundaryField\n{\n" + raw)
        self.assertEqual(case.patch_values("T", "xLow").tobytes(), text.tobytes())
        np.testing.assert_array_equal(case.patch_values("T", "xHigh"), [1, 3, 5])

    def test_refusals(self):
        case = self.box((2, 3, 1))
        self.write(case, "T", "scalar", "xLow { type calculated; value nonuniform List<scalar> 2(7 8); }\n", np.arange(6.0))
        with self.assertRaisesRegex(FormatError, "2 values on 3 faces of patch xLow"):
            case.patch_values("T", "xLow")
        with self.assertRaisesRegex(KeyError, "no entry for the patch 'xHigh'"):
            case.patch_values("T", "xHigh")
        with open(os.path.join(case.path, "1", "T"), "a") as f:
            f.truncate(f.tell() - 5)
        with self.assertRaisesRegex(FormatError, "not closed"):
            case.patch_values("T", "xLow")

    def test_of_a_run(self):
        """What granularGas writes: a wall that slips, an inlet, an outlet."""
        case = self.box((5, 4, 1), (0.5, 0.4, 0.1)).path
        at = boxes.centres((5, 4, 1), (0.5, 0.4, 0.1))
        harness.box_case(case, (5, 4, 1), (0.5, 0.4, 0.1), 1 + at[:, 0], np.tile((0.2, 0.1, 0), (20, 1)), 1 + at[:, 1], 1e-3, slip=("yLow", "yHigh"))
        harness.program("granularGas", "-case", case)
        result = haff.Case(case)
        U = result.field("U")
        np.testing.assert_array_equal(result.patch_values("U", "yLow"), U[:5] * [1, 0, 0])
        np.testing.assert_array_equal(result.patch_values("p", "xHigh"), result.field("p")[4::5])
        self.assertEqual([result.unit(name) for name in ("U", "alpha", "rho", "p")], ["m/s", "", "kg/m^3", "kg/m/s^2"])


class Units(Temporary):
    def test_of_the_case(self):
        case = self.box((2, 1, 1))
        for name in ("U", "rho", "T"):
            boxes.write_field(case.path, name, np.ones((2, 3)) if name == "U" else np.ones(2), time="0")
        names = lambda: [haff.Case(case.path).unit(name) for name in ("U", "rho", "T")]
        self.assertEqual(names(), ["m/s", "kg/m^3", "m^2/s^2"])
        with open(os.path.join(case.path, "system", "units"), "w") as f:
            f.write('length cm; // of grains\nmass ""; time ms;\n')
        self.assertEqual(names(), ["cm/ms", "1/cm^3", "cm^2/ms^2"])
        with open(os.path.join(case.path, "system", "units"), "w") as f:
            f.write("lenght cm;")
        with self.assertRaisesRegex(ValueError, re.escape(os.path.join("system", "units")) + ": lenght is none of"):
            names()


if __name__ == "__main__":
    unittest.main()
