# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK files in pieces and XML files of all cells: VTK reads them as it reads the one legacy file of a run on one rank."""
import json
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.runtime import test_blockMesh as meshes

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    raise unittest.SkipTest("the Python module vtk is not installed")

FIELDS = ("rho", "U", "p", "vorticity")
WHOLE = "whole { type vtk; fields (%s); writeControl writeTime; } " % " ".join(FIELDS)
XML = WHOLE.replace("whole {", "xml { legacy no;")
PIECES = "pieces { type vtk; pieces yes; fields (%s); writeControl writeTime; }" % " ".join(FIELDS)


def cells(reader, path):
    """Centres of the cells, their volumes and fields, by the places of the centres."""
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    centres, sizes = vtk.vtkCellCenters(), vtk.vtkCellSizeFilter()
    for f in (centres, sizes):
        f.SetInputData(grid)
        f.Update()
    x = vtk_to_numpy(centres.GetOutput().GetPoints().GetData())
    order = np.lexsort(np.round(x, 9).T)
    data = {name: vtk_to_numpy(grid.GetCellData().GetArray(name))[order] for name in FIELDS}
    return x[order], vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))[order], data


class Pieces(harness.Folder, unittest.TestCase):
    def compare(self, name, make, ranks):
        case = make(os.path.join(self.folder, name))
        runs.add(case, "system/controlDict", "functions { " + WHOLE + XML + PIECES + " }\n")
        harness.edit(case, "system/controlDict", endTime=0.01, writeInterval=0.005)
        harness.program("granularGas", "-case", case, ranks=ranks)
        folder = os.path.join(case, "VTK")
        with open(os.path.join(folder, f"{name}.pvtu.series")) as f:
            files = json.load(f)["files"]
        self.assertEqual([entry["time"] for entry in files], [0.0, 0.005, 0.01])
        for entry in files:
            self.assertTrue(entry["name"].endswith(".pvtu"))
            one = cells(vtk.vtkUnstructuredGridReader(), os.path.join(folder, entry["name"].replace(".pvtu", ".vtk")))
            all_pieces = cells(vtk.vtkXMLPUnstructuredGridReader(), os.path.join(folder, entry["name"]))
            xml = cells(vtk.vtkXMLUnstructuredGridReader(), os.path.join(folder, entry["name"].replace(".pvtu", ".vtu")))
            for a, b in zip(xml[:2] + tuple(xml[2].values()), one[:2] + tuple(one[2].values())):
                np.testing.assert_array_equal(a, b)
            np.testing.assert_allclose(all_pieces[0], one[0], rtol=0, atol=1e-12)
            np.testing.assert_allclose(all_pieces[1], one[1], rtol=1e-9)  # and not negative: no cell is inside out
            self.assertGreater(all_pieces[1].min(), 0)
            for field in FIELDS:
                np.testing.assert_array_equal(all_pieces[2][field], one[2][field], field)
        pieces = [n for n in os.listdir(os.path.join(folder, f"{name}_0.01")) if n.endswith(".vtu")]
        self.assertLessEqual(len(pieces), ranks)
        self.assertGreater(len(pieces), ranks > 1)
        with open(os.path.join(folder, f"{name}_0.01.vtu"), "rb") as f:
            return f.read()

    def test_a_step(self):
        """Also: the compressed file of all cells has the same bytes on any number of ranks."""
        one, three = (self.compare(f"step{ranks}", lambda path: meshes.channel(path), ranks) for ranks in (1, 3))
        self.assertTrue(one == three)

    def test_a_room(self):
        self.compare("room", lambda path: meshes.room(path, (44, 18, 16)), 2)

    def test_axes_in_odd_order(self):
        """A 2D mesh in x and z, whose third axis of cells is y."""
        def make(path):
            text = meshes.BOX % (12, 1, 9)
            text = text.replace("type cyclic; neighbourPatch back;", "type empty;").replace("type cyclic; neighbourPatch front;", "type empty;")
            case = meshes.room(path, (12, 1, 9))
            harness.boxes.write_dictionary(case, "system", "blockMeshDict", text)
            for name in ("rho", "p", "U"):
                file = os.path.join(case, "0.orig", name)
                with open(file) as f:
                    fields = f.read()
                with open(file, "w") as f:
                    f.write(fields.replace('"front|back" { type cyclic; }', '"front|back" { type empty; }').replace('"0.5"', '"0"'))
            return case
        self.compare("flat", make, 1)

    def test_refusals(self):
        rows = (("ascii", PIECES.replace("pieces yes", "pieces yes; writeFormat ascii"), "", "pieces are binary"),
                ("xml", XML.replace("legacy no;", "legacy no; writeFormat ascii;"), "", "files of  legacy no;  are binary"),
                ("polyhedra", PIECES, "meshEngine polyhedral;\n", "pieces.*they are for lattices"))
        for name, function, schemes, said in rows:
            case = meshes.channel(os.path.join(self.folder, name))
            runs.add(case, "system/controlDict", "functions { " + function + " }\n")
            runs.add(case, "system/fvSchemes", schemes)
            done = harness.program("granularGas", "-case", case, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, said)


if __name__ == "__main__":
    unittest.main()
