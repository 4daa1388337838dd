# SPDX-License-Identifier: GPL-3.0-or-later
"""haff turn: axisymmetric meshes turned about their axis. References: volumes of bodies cut by planes, read by VTK; vectors at known angles."""
import os
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes, haff
from tests.cases.polyhedral import test_wedgeMesh
from tests.postprocessing.plot import cases
from tests.postprocessing.plot.test_commands import call

from haff.plot import turn

N, SIZE = (6, 4, 1), (1.2, 0.8, 0.1)


def read(path):
    """Volumes, and arrays of the cells by their names, of a file of VTK."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    reader, sizes = vtk.vtkUnstructuredGridReader(), vtk.vtkCellSizeFilter()
    reader.SetFileName(path)
    reader.ReadAllScalarsOn()
    reader.ReadAllVectorsOn()
    sizes.SetInputConnection(reader.GetOutputPort())
    sizes.Update()
    data = sizes.GetOutput().GetCellData()
    found = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
    return found["Volume"], found


def around(sectors, angle=360.0):
    """The volume of such sectors over that of the full turn."""
    return sectors * np.sin(np.radians(angle) / sectors) / (2 * np.pi)


class Turned(harness.Folder, unittest.TestCase):
    def plane(self, name, origin=0.0, axis="1 0 0"):
        path = os.path.join(self.folder, name)
        at = cases.box(path, N, SIZE)
        boxes.write_dictionary(path, "system", "meshDict", f"axis {{ origin (0 {origin!r} 0); direction ({axis}); }}\n")
        cases.fields(path, "1", T=at[:, 1], U=np.tile((1.0, 2.0, 3.0), (len(at), 1)))
        return path, at

    def test_volumes(self):
        """A can, and a tube of three quarters: volumes of all cells, which are positive, and the value of its cell in each."""
        for origin, angle in ((0.0, 360.0), (-0.5, 270.0)):
            with self.subTest(origin=origin):
                path, at = self.plane(f"can{angle:g}", origin)
                (file,) = turn.turn(haff.Case(path), ["T"], sectors=12, angle=angle)
                volumes, found = read(file)
                exact = 2 * np.pi * (at[:, 1] - origin) * np.prod(SIZE[:2]) / len(at) * around(12, angle)
                np.testing.assert_allclose(volumes.reshape(12, -1).sum(axis=0), exact[turn.Body(haff.Case(path)).cell], rtol=1e-12)
                np.testing.assert_allclose(found["T"].reshape(12, -1), np.tile(at[turn.Body(haff.Case(path)).cell, 1], (12, 1)))

    def test_vectors(self):
        """Axial, radial and swirl components turn with their sector; those of an axis along y, too."""
        path, at = self.plane("vectors")
        body = turn.Body(haff.Case(path))
        U = np.array([[1.0, 2.0, 3.0]])
        np.testing.assert_allclose(body.vector(U, [0, np.pi / 2, np.pi])[:, 0], [[1, 2, 3], [1, -3, 2], [1, -2, -3]], atol=1e-14)
        path, at = self.plane("upright", axis="0 1 0")
        body = turn.Body(haff.Case(path))
        np.testing.assert_allclose(body.vector(U, [np.pi / 2])[0], [[-3, 2, 1]], atol=1e-14)

    def test_wedge(self):
        """OpenFOAM's wedge, collapsed or hollow: the same body as of the plane mesh."""
        for hollow in (0.0, 0.2):
            with self.subTest(hollow=hollow):
                case = test_wedgeMesh.Wedges.case(self, f"wedge{hollow}", hollow)
                self.assertTrue(turn.turn(haff.Case(case), ["rho"], "0", sectors=8))
                volumes, _ = read(os.path.join(case, "VTK", f"wedge{hollow}-turned_0.vtk"))
                size = test_wedgeMesh.SIZE
                self.assertAlmostEqual(volumes.sum() / (np.pi * size[0] * ((size[1] + hollow)**2 - hollow**2) * around(8)), 1, delta=1e-10)
                self.assertGreater(volumes.min(), 0)

    def test_command(self):
        """All times with a series; what is no body of revolution ends with one message."""
        path, _ = self.plane("times")
        cases.fields(path, "2", T=np.zeros(np.prod(N)))
        done = call("turn", path, "-time", "all", "-n", "6")
        self.assertEqual([os.path.basename(line) for line in done.stdout.split()], ["times-turned.vtk.series", "times-turned_1.vtk", "times-turned_2.vtk"])
        plain = os.path.join(self.folder, "plain")
        cases.box(plain, N, SIZE)
        for words, says in (([plain], "no body of revolution"), ([path, "-angle", "400"], "at most 360"), ([path, "-n", "2"], "three sectors")):
            done = call("turn", *words)
            self.assertIn(done.returncode, (1, 2))
            self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()
