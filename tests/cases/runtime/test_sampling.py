# SPDX-License-Identifier: GPL-3.0-or-later
"""Values along lines, at points and on surfaces: linear fields are exact on boxes and simplices, beside walls as inside; VTK reads the files;
the same bytes on any number of ranks."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.runtime.test_forces import ask

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    vtk = None

MESHES = [(mesh, dim) for mesh in ("lattice", "simplices") for dim in (2, 3)]
LINE = ("line { type sets; writeControl writeTime; fields (rho U p); interpolationScheme %s;\n"
        "       sets { a { type uniform; axis xyz; start (0.001 0.3 0.01); end (0.999 0.72 0.01); nPoints 41; } } }\n")
PROBES = "probe { type probes; fields (rho U); interpolationScheme %s; probeLocations ((0.001 0.002 0.05) (0.998 0.997 0.03) (0.4 0.61 0.02)); }\n"
SURFACES = """cuts { type surfaces; surfaceFormat vtk; writeFormat %s; fields (rho U p); interpolate true; surfaces (
    cut { type cuttingPlane; planeType pointAndNormal; pointAndNormalDict { point (0.52 0.4 0.05); normal (1 0.6 0); } }
    cells { type cuttingPlane; planeType pointAndNormal; pointAndNormalDict { point (0.52 0.4 0.05); normal (2 0 0); } interpolate false; }
    iso { type isoSurface; isoField rho; isoValue 3.1; }
    none { type isoSurface; isoField rho; isoValue 300; }
    ); }
"""


def flow(at, dim):
    """rho, u, p linear in the solved coordinates."""
    x, y, z = at.T * np.array([[1], [1], [dim - 2]])
    u = np.stack([1 + x - 2 * y + z, 0.5 * x + y, (dim - 2) * (0.3 - x + 2 * z)], axis=1)
    return 2 + x + 0.8 * y + 0.5 * z, u, 3 - x + 2 * y - 0.7 * z


def polygons(path):
    """Points, lists of corners, arrays at points, arrays in polygons of a file of VTK, as VTK's reader sees them."""
    reader = vtk.vtkPolyDataReader()
    reader.SetFileName(path)
    reader.ReadAllScalarsOn()
    reader.Update()
    data = reader.GetOutput()
    points = vtk_to_numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() else np.zeros((0, 3))
    faces = []
    for i in range(data.GetNumberOfCells()):
        ids = data.GetCell(i).GetPointIds()
        faces.append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
    arrays = [{a.GetArrayName(i): vtk_to_numpy(a.GetArray(i)) for i in range(a.GetNumberOfArrays())} for a in (data.GetPointData(), data.GetCellData())]
    return points, faces, *arrays


def area(points, faces):
    """Vector of the area of polygons."""
    return sum((0.5 * np.cross(points[f] - points[f[0]], np.roll(points[f], -1, axis=0) - points[f[0]]).sum(0) for f in faces), np.zeros(3))


class Sampling(harness.Folder, unittest.TestCase):
    def laid(self, mesh, dim, cells, fields=flow):
        """A case with the flow in the cells of a unit square or cube."""
        case = os.path.join(self.folder, f"{self.id().split('.')[-1]}{mesh}{dim}{cells}")
        if mesh == "simplices" and not shutil.which("gmsh"):
            self.skipTest("no gmsh")
        return runs.unit_box(case, mesh, dim, cells, lambda at: dict(zip(("rho", "U", "p"), fields(at, dim))))

    def start(self, case, ranks=1):
        harness.program("granularGas", "-case", case, ranks=ranks)
        return case + "/postProcessing"

    def test_lines_and_probes(self):
        for mesh, dim in MESHES:
            with self.subTest(f"{mesh} {dim}"):
                results = self.start(ask(self.laid(mesh, dim, 7), LINE % "cellPoint", PROBES % "cellPoint"))
                table, vectors = (np.loadtxt(f"{results}/line/0/a_{name}.xy") for name in ("rho_p", "U"))
                self.assertEqual(len(table), 41)
                rho, u, p = flow(table[:, :3], dim)
                for found, wanted in ((table[:, 3], rho), (table[:, 4], p), (vectors[:, 3:], u)):
                    np.testing.assert_allclose(found, wanted, atol=2e-9)
                at = np.array([[0.001, 0.002, 0.05], [0.998, 0.997, 0.03], [0.4, 0.61, 0.02]])
                rho, u, _ = flow(at, dim)
                rows = np.loadtxt(f"{results}/probe/0/rho", ndmin=2)
                np.testing.assert_allclose(rows[0, 1:], rho, atol=2e-9)
                with open(f"{results}/probe/0/U") as f:
                    row = [line for line in f if not line.startswith("#")][0]
                np.testing.assert_allclose(np.array(row.replace("(", " ").replace(")", " ").split()[1:], float).reshape(3, 3), u, atol=2e-9)

    def test_values_of_cells(self):
        """cell and no word at all are the values of the cells."""
        case = self.laid("lattice", 2, 7)
        said = self.start(ask(case, LINE % "cell", PROBES % "cell"))
        usual = shutil.copytree(case, case + "_usual", ignore=shutil.ignore_patterns("postProcessing", "1e-09"))
        usual = self.start(ask(usual, *(text.replace("interpolationScheme %s;", "") for text in (LINE, PROBES))))
        runs.same(self, runs.contents(said), runs.contents(usual))
        table = np.loadtxt(said + "/line/0/a_rho_p.xy")
        np.testing.assert_allclose(table[:, 3], flow((np.floor(7 * table[:, :3]) + 0.5) / 7, 2)[0], rtol=1e-11)

    def test_second_order(self):
        """The error along a line falls as the square of the cells' size, on boxes and triangles."""
        def smooth(at, dim):
            rho, u, p = flow(at, dim)
            return rho + 0.5 * np.sin(3 * at[:, 0]) * np.cos(2 * at[:, 1]), u, p

        for mesh in ("lattice", "simplices"):
            error = []
            for cells in (12, 48):
                table = np.loadtxt(self.start(ask(self.laid(mesh, 2, cells, smooth), LINE % "cellPoint")) + "/line/0/a_rho_p.xy")
                error.append(np.sqrt(np.mean((table[:, 3] - smooth(table[:, :3], 2)[0]) ** 2)))
            self.assertGreater(np.log(error[0] / error[1]) / np.log(4), 1.8, (mesh, error))

    @unittest.skipUnless(vtk, "no vtk")
    def test_surfaces(self):
        for mesh, dim in MESHES:
            with self.subTest(f"{mesh} {dim}"):
                case = ask(self.laid(mesh, dim, 7), SURFACES % "binary")
                results, normal, thick = self.start(case) + "/cuts/0/", np.array([1, 0.6, 0]), 1 if dim == 3 else np.ptp(harness.haff.Case(case).mesh.points[:, 2])
                points, faces, at, inside = polygons(results + "cut.vtk")
                self.assertFalse(inside)
                np.testing.assert_allclose((points - [0.52, 0.4, 0.05]) @ normal, 0, atol=1e-9)
                # from y = 0 to 1 the line goes from x = 0.76 to 0.16
                np.testing.assert_allclose(area(points, faces), thick * normal, atol=1e-8)
                self.fits(points, at, dim)
                points, faces, at, inside = polygons(results + "cells.vtk")
                self.assertFalse(at)
                np.testing.assert_allclose(area(points, faces), thick * np.array([1, 0, 0]), atol=1e-8)
                known = {round(value, 9) for value in flow(harness.haff.Case(case).centres, dim)[0]}
                self.assertLessEqual({round(value, 9) for value in inside["rho"]}, known)
                points, faces, at, _ = polygons(results + "iso.vtk")
                self.assertGreater(len(faces), 7)
                np.testing.assert_allclose(at["rho"], 3.1, atol=1e-9)
                self.fits(points, at, dim)
                grad = np.array([1, 0.8, 0.5 if dim == 3 else 0])
                np.testing.assert_allclose(np.cross(area(points, faces), grad), 0, atol=1e-8)
                self.assertLess(area(points, faces) @ grad, 0)
                for part, size in zip(polygons(results + "none.vtk"), (0, 0, 0, 0)):
                    self.assertTrue(len(part) == size or isinstance(part, dict))

    def fits(self, points, at, dim):
        for name, wanted in zip(("rho", "U", "p"), flow(points, dim)):
            np.testing.assert_allclose(at[name], wanted, atol=2e-9, err_msg=name)

    def test_ranks(self):
        """The same bytes on one and two ranks, at all times, in binary and ascii, whether the surfaces are a list or a dictionary."""
        for mesh, dim in (("lattice", 3), ("simplices", 2)):
            case = ask(self.laid(mesh, dim, 6), LINE % "cellPoint", PROBES % "cellPoint", SURFACES % "binary", (SURFACES % "ascii").replace("cuts", "text"))
            harness.edit(case, "system/controlDict", endTime=0.02, writeInterval=0.01)
            pair = shutil.copytree(case, case + "_2")
            one, two = self.start(case), self.start(pair, ranks=2)
            runs.same(self, runs.contents(one), runs.contents(two))
            again = shutil.copytree(pair, case + "_3", ignore=shutil.ignore_patterns("postProcessing", "0.0*"))
            with open(again + "/system/controlDict") as f:
                text = f.read()
            with open(again + "/system/controlDict", "w") as f:
                f.write(text.replace("surfaces (", "surfaces {").replace("    ); }", "    } }"))
            runs.same(self, runs.contents(one), runs.contents(self.start(again)))
            self.assertGreater(len(os.listdir(one + "/cuts")), 1)
            if vtk:
                for name in ("cut", "cells", "iso", "none"):
                    binary, ascii_ = (polygons(f"{one}/{kind}/0/{name}.vtk") for kind in ("cuts", "text"))
                    np.testing.assert_array_equal(binary[0], ascii_[0])
                    self.assertEqual(binary[1], ascii_[1])


if __name__ == "__main__":
    unittest.main()
