# SPDX-License-Identifier: GPL-3.0-or-later
"""Every case that is shipped, meshed small and run, opened by others: the OpenFOAM readers of VTK and of ParaView (vtkPOpenFOAMReader),
VTK's reader of legacy files. Each case that brings something new to their files is opened by OpenFOAM, too (checkMesh, foamToVTK), and its
parts of two ranks by all of them and by reconstructPar."""
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
SIZE = {"blastCold": 80, "blastRound": 80, "heap2D": 80, "hopper": 80, "pile": 80, "jet": 12, "cone": 40, "wedge15": 40, "wedge15Dilute": 40, "wedgeDisks": 40, "wedgeMD": 40, "wedgeTriangles": 50, "cylinder": 16, "cylinderDisks": 16, "sphere3D": 14, "forwardStep": 30, "riemann2D": 80,
        "vortex": 80, "wedge": 40, "wedgeDense": 40, "wedgeElastic": 40, "segregationChute": 60, "segregationWedge": 40,
        "faraday": 260, "faradaySweep": 260, "coolingDisks": 80, "cooling3D": 33, "columnCollapse": 24, "heapPoured": 2, "silo": 1, "drum": 12, "jetOnPlate": 1, "demon": 40,
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

    def small(self, name):
        """A copy, and the option of its mesh.geo."""
        case = harness.copy(name, self.folder)
        runs.add(case, "system/controlDict", "stopAt writeNow;\n")
        with open(case + "/mesh.geo") as f:
            option = re.search(r"DefineConstant\[ (\w+) =", f.read())[1]
        return case, {option: SIZE.get(name, LINE)}

    @staticmethod
    def mesh_features(case):
        """What a reader meets in a mesh: dimensions, kinds of cells and patches."""
        mesh = case.mesh
        corners, faces = np.diff(mesh.face_start), np.bincount(np.concatenate((mesh.owner, mesh.neighbour)))
        return {("dimensions", (np.ptp(case.centres, axis=0) > 1e-9).sum()), ("faces", *np.unique(corners)), ("cells", *np.unique(faces)),
                *(("patch", kind) for kind, _, _ in mesh.patches.values())}

    @staticmethod
    def features(case, time):
        """What a reader meets in the fields: their classes with the types of their patches."""
        found = set()
        for base, _, names in os.walk(os.path.join(case.path, time)):
            for name in names:
                with open(os.path.join(base, name), "rb") as f:
                    text = f.read()
                kind, at = re.search(rb"class +(\w+);", text)[1], text.find(b"boundaryField")
                found |= {kind, *((kind, word) for word in re.findall(rb"type +(\w+);|value +(\w+)", text[at:] if at >= 0 else b""))}
        return found

    def readers(self, case, time, values, decomposed=False):
        """VTK's reader and ParaView's; decomposed: ParaView's of the parts of the ranks."""
        import vtk
        for kind in (vtk.vtkPOpenFOAMReader,) if decomposed else (vtk.vtkOpenFOAMReader, vtk.vtkPOpenFOAMReader):
            reader = kind()
            if kind is vtk.vtkPOpenFOAMReader:
                reader.SetController(vtk.vtkDummyController())
                reader.SetCaseType(0 if decomposed else 1)
            reader.SetFileName(os.path.join(case, "case.foam"))
            found = arrays(reader, time)
            for field, known in values.items():
                got = found[field]
                if decomposed:  # the cells of one part after those of the other
                    got, known = np.sort(got, axis=0), np.sort(known, axis=0)
                np.testing.assert_allclose(got, known, rtol=2e-7, atol=1e-30, err_msg=f"{kind.__name__} {field}")

    def legacy(self, case, values):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        harness.program("caseToVTK", case.path, "-fields", ",".join(values[case.times[0]]))
        for time, known in values.items():
            reader = vtk.vtkUnstructuredGridReader()
            reader.SetFileName(os.path.join(case.path, "VTK", f"{os.path.basename(case.path)}_{time}.vtk"))
            reader.ReadAllScalarsOn()
            reader.ReadAllVectorsOn()
            reader.Update()
            data = reader.GetOutput().GetCellData()
            for field in known:
                np.testing.assert_array_equal(vtk_to_numpy(data.GetArray(field)), known[field], err_msg=field)

    def tools(self, case):
        self.openfoam("foamToVTK", case.path, "-name", "fromOpenFOAM")
        self.assertEqual(len(glob.glob(os.path.join(case.path, "fromOpenFOAM", "*", "internal.vtu"))), len(case.times))

    def parts(self, case, solver, values):
        """The same run on two ranks, whose case is returned; reconstructPar puts the same fields together from the parts."""
        pair = shutil.copytree(case.path, case.path + "_pair", ignore=lambda folder, _: case.times if folder == case.path else ())
        runs.add(pair, "system/controlDict", "writeProcessors yes;\n")
        harness.program(solver, "-case", pair, ranks=2)
        if solver == "granularGas":
            self.assertTrue(os.path.isdir(pair + "/processor1"), "both ranks have cells")
        for time, known in values.items():
            self.readers(pair, time, known, decomposed=True)
        time = case.times[-1]
        for field in values[time]:
            os.remove(os.path.join(pair, time, field))
        self.openfoam("reconstructPar", pair, "-latestTime")
        for field, known in values[time].items():
            np.testing.assert_array_equal(haff.Case(pair).field(field, time), known, err_msg=field)
        return pair

    @unittest.skipUnless(shutil.which("reconstructPar"), "OpenFOAM is not installed")
    def test_every_case(self):
        cases, seen = shipped(), set()
        self.assertGreater(len(cases), 20)
        small = {name: self.small(name) for name in cases}
        harness.meshes(dict(small.values()))
        for name, solver in cases.items():
            with self.subTest(name):
                path, _ = small[name]
                if name == "segregationWedge":  # carried by a gas, as its Allrun makes it
                    os.rename(self.short("wedge", 20).path, path + "/gas")
                harness.program(solver, "-case", path)
                case = haff.Case(path)
                start, time = case.times
                self.assertEqual(float(start), 0)
                self.assertGreater(float(time), 0)
                fields = [f for f in ("rho", "alpha", "U", "T", "p", "phi") if os.path.isfile(os.path.join(path, time, f))]
                self.assertTrue(fields)
                values = {t: {f: case.field(f, t) for f in fields} for t in (start, time)}
                for t in (start, time):
                    self.readers(path, t, values[t])
                self.legacy(case, values)
                meshes, fields = self.mesh_features(case), self.features(case, time)
                if (meshes | fields) - seen:
                    self.tools(case)
                    pair = self.parts(case, solver, values)
                if meshes - seen:
                    for folder in (path, *glob.glob(pair + "/processor*")):
                        self.assertIn("Mesh OK.", self.openfoam("checkMesh", folder))
                seen |= meshes | fields


if __name__ == "__main__":
    unittest.main()
