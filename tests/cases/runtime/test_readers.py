# SPDX-License-Identifier: GPL-3.0-or-later
"""Every case that is shipped, meshed small and run on two ranks, opened by others: checkMesh and foamToVTK, reconstructPar on
the parts of the ranks, the OpenFOAM readers of VTK and of ParaView (vtkPOpenFOAMReader), VTK's reader of legacy files."""
import glob
import os
import re
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs

haff = harness.haff
SOLVERS = ("granularGas", "granularSegregation")
SIZE = {"blastRound": 80, "jet": 12, "cone": 40, "wedge15": 40, "wedge15Dilute": 40, "wedgeDisks": 40, "wedgeMD": 40, "wedgeTriangles": 50, "cylinder": 16, "cylinderDisks": 16, "sphere3D": 14, "forwardStep": 30, "riemann2D": 80,
        "vortex": 80, "wedge": 40, "wedgeDense": 40, "wedgeElastic": 40, "segregationChute": 60, "segregationWedge": 40,
        "faraday": 260, "faradaySweep": 260, "coolingDisks": 80, "cooling3D": 40, "columnCollapse": 24, "heapPoured": 2, "silo": 1, "drum": 12, "jetOnPlate": 1, "demon": 40,
        "tiltedBox": 2, "jetOnPile": 2, "columnRound": 24, "siloRound": 3}  # for two ranks to have cells
LINE = 120


def shipped():
    cases = os.path.join(harness.SOURCE, "cases")
    found = {}
    for name in sorted(os.listdir(cases)):
        path = os.path.join(cases, name, "system", "controlDict")
        if os.path.isfile(path):
            with open(path) as f:
                found[name] = re.search(r"^application\s+(\w+);", f.read(), re.M)[1]
    return {name: solver for name, solver in found.items() if solver in SOLVERS}


def arrays(reader, time):
    """The cells' arrays that an OpenFOAM reader finds at a time: name -> values."""
    from vtk.util.numpy_support import vtk_to_numpy
    reader.UpdateInformation()
    assert np.isclose(vtk_to_numpy(reader.GetTimeValues()), float(time)).any()
    reader.SetTimeValue(float(time))
    reader.EnableAllCellArrays()
    reader.Update()
    block = reader.GetOutput().GetBlock(0)
    data = block.GetCellData()
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


class Readers(harness.Folder, unittest.TestCase):
    def openfoam(self, name, case, *arguments):
        done = subprocess.run([name, "-case", case, *arguments], capture_output=True, text=True, cwd=case,
                              env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
        self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])
        return done.stdout

    def run_small(self, name, solver):
        case = harness.copy(name, self.folder)
        with open(case + "/mesh.geo") as f:
            option = re.search(r"DefineConstant\[ (\w+) =", f.read())[1]
        harness.mesh(case, SIZE.get(name, LINE), option)
        if name == "segregationWedge":  # carried by a gas, as its Allrun makes it
            os.rename(self.short("wedge", 20).path, case + "/gas")
        runs.add(case, "system/controlDict", "stopAt writeNow; writeProcessors yes;\n")
        harness.program(solver, "-case", case, ranks=2)
        return haff.Case(case)

    def readers(self, case, time, values):
        """VTK's reader and ParaView's, which takes the parts of the ranks, too."""
        import vtk
        foam = os.path.join(case.path, "case.foam")
        kinds = [("VTK", vtk.vtkOpenFOAMReader(), False)]
        for decomposed in (False, True):
            reader = vtk.vtkPOpenFOAMReader()
            reader.SetController(vtk.vtkDummyController())
            reader.SetCaseType(0 if decomposed else 1)
            kinds.append(("ParaView", reader, decomposed))
        for kind, reader, decomposed in kinds:
            reader.SetFileName(foam)
            found = arrays(reader, time)
            for field, known in values.items():
                got = found[field]
                if decomposed:  # the cells of one part after those of the other
                    got, known = np.sort(got, axis=0), np.sort(known, axis=0)
                np.testing.assert_allclose(got, known, rtol=2e-7, atol=1e-30, err_msg=f"{kind} {field}")

    def legacy(self, case, time, values):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        harness.program("caseToVTK", case.path, "-time", time, "-fields", ",".join(values))
        reader = vtk.vtkUnstructuredGridReader()
        reader.SetFileName(os.path.join(case.path, "VTK", f"{os.path.basename(case.path)}_{time}.vtk"))
        reader.ReadAllScalarsOn()
        reader.ReadAllVectorsOn()
        reader.Update()
        data = reader.GetOutput().GetCellData()
        for field, known in values.items():
            np.testing.assert_array_equal(vtk_to_numpy(data.GetArray(field)), known, err_msg=field)

    def tools(self, case, time, values):
        """checkMesh, foamToVTK; and reconstructPar puts the same fields together from the parts."""
        for folder in [case.path, *glob.glob(case.path + "/processor*")]:
            self.assertIn("Mesh OK.", self.openfoam("checkMesh", folder))
        self.openfoam("foamToVTK", case.path, "-name", "fromOpenFOAM")
        self.assertEqual(len(glob.glob(os.path.join(case.path, "fromOpenFOAM", "*", "internal.vtu"))), len(case.times))
        for field in values:
            os.remove(os.path.join(case.path, time, field))
        self.openfoam("reconstructPar", case.path, "-latestTime")
        for field, known in values.items():
            np.testing.assert_array_equal(case.field(field, time), known, err_msg=field)

    @unittest.skipUnless(shutil.which("reconstructPar"), "OpenFOAM is not installed")
    def test_every_case(self):
        cases = shipped()
        self.assertGreater(len(cases), 20)
        for name, solver in cases.items():
            with self.subTest(name):
                case = self.run_small(name, solver)
                start, time = case.times
                self.assertEqual(float(start), 0)
                self.assertGreater(float(time), 0)
                if solver == "granularGas":
                    self.assertTrue(os.path.isdir(case.path + "/processor1"), "both ranks have cells")
                fields = [f for f in ("rho", "alpha", "U", "T", "p", "phi") if os.path.isfile(os.path.join(case.path, time, f))]
                self.assertTrue(fields)
                values = {f: case.field(f, time) for f in fields}
                for t in (start, time):
                    found = {f: case.field(f, t) for f in fields}
                    self.readers(case, t, found)
                    self.legacy(case, t, found)
                self.tools(case, time, values)


if __name__ == "__main__":
    unittest.main()
