# SPDX-License-Identifier: GPL-3.0-or-later
"""A short wedge run opened by others: checkMesh, foamToVTK, VTK's OpenFOAM reader, meshio; names and values of arrays."""
import glob
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness

FIELDS = ("rho", "alpha", "U", "T", "p")


class Tools(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.path = harness.copy("wedge", cls.folder)
        harness.mesh(cls.path, 40)
        harness.edit(cls.path, "system/controlDict", endTime=0.004, writeInterval=0.002)
        harness.program("granularGas", "-case", cls.path)
        cls.case = harness.haff.Case(cls.path)
        cls.values = {name: cls.case.field(name) for name in FIELDS}

    def openfoam(self, name, *arguments):
        if not shutil.which(name):
            self.skipTest("OpenFOAM is not installed")
        environment = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
        done = subprocess.run([name, "-case", self.path, *arguments], capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])
        return done.stdout

    def test_check_mesh(self):
        text = self.openfoam("checkMesh")
        self.assertIn("Mesh OK.", text)
        self.assertIn("Mesh has 2 solution (non-empty) directions (1 1 0)", text)
        self.assertIn("cells:            1200", text)

    def test_foam_to_vtk(self):
        import meshio
        self.openfoam("foamToVTK", "-latestTime", "-name", "fromOpenFOAM")
        (path,) = glob.glob(os.path.join(self.path, "fromOpenFOAM", "*", "internal.vtu"))
        read = meshio.read(path)
        for name in FIELDS:
            got = np.concatenate(read.cell_data[name])
            np.testing.assert_allclose(got, self.values[name], rtol=1e-6, err_msg=name)

    def test_vtk_openfoam_reader(self):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        foam = os.path.join(self.path, "case.foam")
        open(foam, "w").close()
        reader = vtk.vtkOpenFOAMReader()
        reader.SetFileName(foam)
        reader.UpdateInformation()
        times = vtk_to_numpy(reader.GetTimeValues())
        np.testing.assert_allclose(times[times > 0], (0.002, 0.004))
        reader.SetTimeValue(0.004)
        reader.EnableAllCellArrays()
        reader.Update()
        data = reader.GetOutput().GetBlock(0).GetCellData()
        names = {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())}
        self.assertLessEqual(set(FIELDS), names)
        for name in FIELDS:
            np.testing.assert_allclose(vtk_to_numpy(data.GetArray(name)), self.values[name], rtol=2e-7, err_msg=name)

    def ours(self, ending, *options):
        """Every time is listed in the series; values to the bit. Returns the bytes of the last file."""
        import json
        import meshio
        harness.program("caseToVTK", self.path, *options)
        (series,) = glob.glob(os.path.join(self.path, "VTK", f"*{ending}.series"))
        with open(series) as f:
            files = json.load(f)["files"]
        self.assertEqual([entry["time"] for entry in files], [0, 0.002, 0.004])
        path = os.path.join(os.path.dirname(series), files[-1]["name"])
        read = meshio.read(path)
        self.assertEqual([(block.type, len(block.data)) for block in read.cells], [("hexahedron", 1200)])
        for name in FIELDS:
            np.testing.assert_array_equal(np.squeeze(read.cell_data[name][0]), self.values[name], err_msg=name)
        centre = read.points[read.cells[0].data].mean(axis=1)
        np.testing.assert_allclose(centre, self.case.centres, atol=1e-12)
        return os.path.getsize(path)

    def test_our_vtk(self):
        """caseToVTK writes legacy and XML files, and the latter are less than half as large."""
        self.assertLess(self.ours(".vtu", "-vtu"), 0.5 * self.ours(".vtk"))

    def test_gmsh_to_foam(self):
        """OpenFOAM's own converter makes the same cells of the same file (made three-dimensional by gmsh)."""
        if not shutil.which("gmshToFoam"):
            self.skipTest("OpenFOAM is not installed")
        geo, msh = os.path.join(self.folder, "box.geo"), os.path.join(self.folder, "box.msh")
        with open(os.path.join(self.path, "mesh.geo")) as f:
            text = f.read().split("Physical")[0]
        with open(geo, "w") as f:
            f.write(text + "out[] = Extrude {0, 0, 1} { Surface{1:3}; Layers{2}; Recombine; };\n"
                    'Physical Volume("gas") = {1:3};\nPhysical Surface("back") = {1:3};\n'
                    'all[] = CombinedBoundary{ Volume{1:3}; };\nall[] -= {1, 2, 3, -1, -2, -3};\nPhysical Surface("wall") = {all[]};\n')
        subprocess.run(["gmsh", "-3", "-v", "2", "-setnumber", "N", "12", "-format", "msh2", geo, "-o", msh], check=True,
                       capture_output=True)
        meshes = []
        for command in ((os.path.join(harness.BIN, "gmshToCase"), msh, "-case"), ("gmshToFoam", msh, "-case")):
            target = os.path.join(self.folder, os.path.basename(command[0]))
            shutil.copytree(os.path.join(self.path, "system"), os.path.join(target, "system"))
            done = subprocess.run([*command, target], capture_output=True, text=True,
                                  env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
            self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr)
            meshes.append(harness.haff.Case(target))
        sizes = [{name: count for name, (_, _, count) in m.mesh.patches.items() if count} for m in meshes]
        self.assertEqual(*sizes)
        ordered = [m.centres[np.lexsort(np.round(m.centres, 6).T)] for m in meshes]
        np.testing.assert_allclose(*ordered, atol=1e-9)
        self.assertAlmostEqual(meshes[0].volumes.sum() / meshes[1].volumes.sum(), 1, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
