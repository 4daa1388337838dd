# SPDX-License-Identifier: GPL-3.0-or-later
"""1, 2, 4 ranks, and more ranks than tiles: every byte the same. processorN folders against OpenFOAM and VTK."""
import glob
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs

haff = harness.haff


class Ranks(harness.Folder, unittest.TestCase):
    def compare(self, name, n, ranks, **options):
        case = runs.make(os.path.join(self.folder, name), n, 0.01, interval=0.005, tables=True, **options)
        copies = {r: shutil.copytree(case, f"{case}_ranks{r}/{name}") for r in ranks}
        harness.program("granularGas", "-case", case)
        reference = runs.results(case)
        self.assertIn("postProcessing/points/0/alpha", reference)
        self.assertIn(f"VTK/{name}.vtk.series", reference)
        for count, copy in copies.items():
            with self.subTest(name, ranks=count):
                if count == 2:
                    harness.program("granularGas", "-np", "2", "-case", copy)
                else:
                    harness.program("granularGas", "-case", copy, ranks=count)
                with open(os.path.join(copy, "0.01", "uniform", "provenance")) as f:
                    self.assertRegex(f.read(), rf"ranks\s+{count};")
                runs.same(self, reference, runs.results(copy))

    def test_one_dimension(self):
        self.compare("line", (200, 1, 1), (4,))

    def test_two_dimensions(self):
        self.compare("step", (130, 100, 1), (4,), hole=True)
        self.compare("round", (1, 90, 70), (2,), types={"y": "cyclic"}, format="ascii")

    def test_three_dimensions(self):
        self.compare("block", (36, 24, 20), (4,), hole=True)
        self.compare("spheres", (30, 24, 16), (2,), hole=True, viscous=True)

    def test_more_ranks_than_tiles(self):
        self.compare("few", (40, 1, 1), (3,))

    def test_wedge(self):
        """The shipped case at 96 cells a side, a quarter of the way."""
        case = harness.copy("wedge", self.folder)
        harness.mesh(case, 96)
        harness.drop_vtk(case)
        harness.edit(case, "system/controlDict", endTime=0.01, writeInterval=0.01)
        copy = shutil.copytree(case, case + "_ranks")
        harness.program("granularGas", "-case", case)
        harness.program("granularGas", "-case", copy, ranks=4)
        runs.same(self, runs.results(case), runs.results(copy))


class Alone(harness.Folder, unittest.TestCase):
    """A process that no launcher has started is alone, and starts no MPI."""

    def test_start_without_mpi(self):
        """The table of messages is written where MPI ends."""
        case = runs.make(os.path.join(self.folder, "alone"), (40, 1, 1), 0.01)
        table = os.path.join(self.folder, "messages.csv")
        counted = {**os.environ, "LD_PRELOAD": os.path.join(harness.BIN, "haffmessages.so"), "HAFF_MESSAGES": table}
        solver = [os.path.join(harness.BIN, "granularGas"), "-case", case]
        subprocess.run(solver, env=counted, check=True, capture_output=True)
        self.assertFalse(os.path.exists(table))
        shutil.rmtree(os.path.join(case, "0.01"))
        subprocess.run([os.path.join(harness.BIN, "mpirun"), "-np", "1", *solver], env=counted, check=True, capture_output=True)
        self.assertTrue(os.path.exists(table))

    def test_unknown_launcher(self):
        """Two processes whose environment tells of no launcher are two runs of one case, of which the lock refuses one."""
        case = runs.make(os.path.join(self.folder, "unknown"), (200, 90, 1), 1e3)
        named = ("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_LOCAL_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE")
        silent = [word for name in named for word in ("-u", name)]
        solver = [os.path.join(harness.BIN, "granularGas"), "-case", case]  # mpirun ends the other process when the lock refuses one
        done = subprocess.run(["mpirun", "-np", "2", "env", *silent, *solver], capture_output=True, text=True, timeout=300)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(done.stderr.count("another run"), 1, done.stderr)


@unittest.skipUnless(shutil.which("decomposePar"), "OpenFOAM is not installed")
class Processors(harness.Folder, unittest.TestCase):
    """A periodic box with nonuniform values on a patch, on three ranks."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.case = runs.make(os.path.join(cls.folder, "case"), (130, 70, 1), 0.004, interval=0.002,
                             types={"x": "cyclic"})
        path = os.path.join(cls.case, "0", "p")
        with open(path) as f:
            text = f.read()
        (faces,) = [count for name, (_, _, count) in haff.Mesh(cls.case + "/constant/polyMesh").patches.items() if name == "yHigh"]
        cls.values = 2000 + np.arange(faces) / 7
        values = "\n".join("%.17g" % v for v in cls.values)
        with open(path, "w") as f:
            f.write(text.replace("boundaryField\n{", "boundaryField\n{\n    yHigh { type fixedValue; value nonuniform "
                                 f"List<scalar>\n{faces}\n(\n{values}\n); }}"))
        path = os.path.join(cls.case, "0", "U")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("boundaryField\n{", "boundaryField\n{\n    yHigh { type zeroGradient; }"))
        cls.step = runs.make(os.path.join(cls.folder, "step"), (130, 70, 1), 0.004, hole=True, format="ascii", compression="on")
        for case in (cls.case, cls.step):
            runs.add(case, "system/controlDict", "writeProcessors yes;\n")
            harness.program("granularGas", "-case", case, ranks=3)
        cls.parts = sorted(glob.glob(cls.case + "/processor*"))

    def openfoam(self, name, case, *arguments):
        done = subprocess.run([name, "-case", case, *arguments], capture_output=True, text=True,
                              env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
        self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])
        return done.stdout

    @staticmethod
    def labels(*path):
        f = haff.FoamFile(os.path.join(*path))
        return f.numbers(0, 1, f.label)[0]

    def test_the_same_as_decomposePar(self):
        """Told the part of each cell, it makes the same meshes, addressing and patches."""
        self.assertGreater(self.compare(self.case), 0, "no periodic patch was cut: the test should")
        self.compare(self.step)

    def compare(self, case):
        other = shutil.copytree(case, case + "_other", ignore=shutil.ignore_patterns("processor*"))
        parts = sorted(glob.glob(case + "/processor*"))
        self.assertEqual(len(parts), 3)
        cells = [self.labels(p, "constant/polyMesh/cellProcAddressing") for p in parts]
        part = np.full(sum(map(len, cells)), -1)
        for k, which in enumerate(cells):
            part[which] = k
        self.assertTrue((part >= 0).all())
        with open(other + "/constant/parts", "w") as f:
            f.write(harness.boxes.header("labelList", "parts", "constant") + f"{len(part)}\n(\n" + "\n".join(map(str, part)) + "\n)\n")
        harness.write_dictionary(other, "system", "decomposeParDict",
                                 'numberOfSubdomains 3; method manual; manualCoeffs { dataFile "parts"; }\n')
        self.openfoam("decomposePar", other, "-time", "0.004")
        cyclic = 0
        for p in parts:
            mine, theirs = p + "/constant/polyMesh", os.path.join(other, os.path.basename(p), "constant/polyMesh")
            for name in ("owner", "neighbour", "cellProcAddressing", "faceProcAddressing", "pointProcAddressing", "boundaryProcAddressing"):
                np.testing.assert_array_equal(self.labels(mine, name), self.labels(theirs, name), err_msg=f"{p} {name}")
            a, b = haff.Mesh(mine), haff.Mesh(theirs)
            np.testing.assert_allclose(a.points, b.points, rtol=1e-5)  # decomposePar writes points with few digits
            self.assertEqual(a.patches, b.patches)
            cyclic += sum(kind == "processorCyclic" for kind, _, _ in a.patches.values())
            self.assertIn("Mesh OK.", self.openfoam("checkMesh", p))
        return cyclic

    def test_reconstructPar(self):
        """OpenFOAM puts every field together again, patches included, and a run goes on from it; only the log's changes count from
        there, as uniform/totals is not in the parts."""
        other = shutil.copytree(self.case, self.case + "_again")
        for time in ("0.002", "0.004"):
            shutil.rmtree(os.path.join(other, time))
        self.openfoam("reconstructPar", other)
        for time in ("0.002", "0.004"):
            for field in runs.FIELDS:
                a, b = (haff.Case(c).field(field, time) for c in (self.case, other))
                np.testing.assert_array_equal(a, b, err_msg=f"{time}/{field}")
        for case in (self.case, other):
            copy = shutil.copytree(case, case + "_on", ignore=shutil.ignore_patterns("processor*"))
            harness.edit(copy, "system/controlDict", endTime=0.006, writeProcessors="no")
            harness.program("granularGas", "-case", copy)
        but = ("provenance", "totals", "checksums")
        runs.same(self, *(runs.contents(f"{c}_on/0.006", ignore=but) for c in (self.case, other)))

    def test_vtk_reads_decomposed(self):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        path = os.path.join(self.case, "case.foam")
        open(path, "w").close()
        reader = vtk.vtkPOpenFOAMReader()
        reader.SetController(vtk.vtkDummyController())
        reader.SetFileName(path)
        reader.SetCaseType(0)
        reader.UpdateInformation()
        reader.EnableAllCellArrays()
        np.testing.assert_allclose(vtk_to_numpy(reader.GetTimeValues()), (0.002, 0.004))
        reader.SetTimeValue(0.004)
        reader.Update()
        self.assertEqual(reader.GetOutput().GetNumberOfCells(), haff.Case(self.case).mesh.cells)
        for p in self.parts:
            mesh = haff.Mesh(p + "/constant/polyMesh")
            cells = self.labels(p, "constant/polyMesh/cellProcAddressing")
            for field in ("T", "U"):
                np.testing.assert_array_equal(haff.read_field(f"{p}/0.004/{field}", mesh.cells),
                                              haff.Case(self.case).field(field, "0.004")[cells])

    def test_another_decomposition_is_refused(self):
        copy = shutil.copytree(self.case, self.case + "_two")
        harness.edit(copy, "system/controlDict", endTime=0.006)
        before = runs.contents(copy)
        done = harness.program("granularGas", "-case", copy, ranks=2, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("remove the processor folders", done.stderr)
        runs.same(self, before, runs.contents(copy))
        harness.program("granularGas", "-case", copy, ranks=3)
        self.assertTrue(os.path.exists(copy + "/processor2/0.006/rhoE"))


if __name__ == "__main__":
    unittest.main()
