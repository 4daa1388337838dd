# SPDX-License-Identifier: GPL-3.0-or-later
"""General meshes through the programs: triangles, prisms, tetrahedra, hexahedra by gmsh, and polyhedra, each with what a
lattice must show: free stream, conservation, the same bytes on any number of ranks and after a restart, output that
VTK and OpenFOAM read. A lattice as a general mesh gives the lattice engine's result to the order of both."""
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from studies.exact.eos import GoldshteinShapiro

haff = harness.haff

# The surface of a plate, 1.2 by 0.8, with a hole in it.
PLATE = """SetFactory("OpenCASCADE"); Rectangle(1) = {0, 0, 0, 1.2, 0.8}; Disk(2) = {0.7, 0.45, 0, 0.2};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; }; Mesh.MeshSizeMax = %g; Mesh.MeshSizeMin = %g;
"""
FLAT = PLATE + """b[] = Boundary{ Surface{3}; }; Physical Curve("wall") = {b[]}; Physical Surface("gas") = {3};
"""
QUADS = PLATE + """Recombine Surface{3};
b[] = Boundary{ Surface{3}; }; Physical Curve("wall") = {b[]}; Physical Surface("gas") = {3};
"""
DEEP = PLATE + """Extrude {0, 0, 0.3} { Surface{3}; %s } b[] = Boundary{ Volume{1}; };
Physical Volume("gas") = {1}; Physical Surface("wall") = {b[]};
"""
MESHES = {  # text, VTK's cell type
    "triangles": (FLAT % (0.06, 0.06), 13),
    "quads": (QUADS % (0.06, 0.06), None),
    "tets": (DEEP % (0.14, 0.14, ""), 10),
    "prisms": (DEEP % (0.12, 0.12, "Layers{3}; Recombine;"), 13),
}
MANY = {"triangles": FLAT % (0.028, 0.028), "tets": DEEP % (0.09, 0.09, "")}  # cells: several blocks


def openfoam(test, name, case, *arguments):
    done = subprocess.run([name, "-case", case, *arguments], capture_output=True, text=True, cwd=case,  # polyDualMesh leaves files there
                          env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
    test.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])
    return done.stdout


def write_fields(case, rho, p, u, wall):
    """wall: the rule of U on every patch that is not empty."""
    patches = haff.Mesh(case + "/constant/polyMesh").patches
    for name, values in (("rho", rho), ("p", p), ("U", u)):
        rules = [f"{k} {'empty' if kind == 'empty' else wall if name == 'U' else 'zeroGradient'}"
                 for k, (kind, _, _) in patches.items()]
        boxes.write_field(case, name, values, "\n".join(rules))


def make(case, geo, end, uniform=False, tables=False, **options):
    """A hot bubble in a moving gas among slip walls; or uniform flow through open ones."""
    one = np.ones(1)
    harness.box_case(case, (1, 1, 1), (1, 1, 1), one, np.zeros((1, 3)), one, end, **options)
    with open(case + "/mesh.geo", "w") as f:
        f.write(geo.replace('"wall"', '"side"') if uniform else geo)  # by that name its patch would be of type wall
    harness.mesh(case, 0, option="unused")
    os.remove(case + "/mesh.msh")
    at = haff.Case(case).centres
    away = (at[:, 0] - 0.25) ** 2 + (at[:, 1] - 0.4) ** 2
    rho, p = 100 + 20 * np.cos(3 * at[:, 0]), np.where(away < 0.02, 20000.0, 2000.0)
    u = np.stack([2 * np.sin(at[:, 0] + at[:, 1]), 3 * at[:, 0], 0 * rho], axis=1)
    if uniform:
        rho, p, u = np.full(len(at), 37.3), np.full(len(at), 1234.5), np.tile([3.1, -1.7, 2.3 if "Extrude" in geo else 0.0], (len(at), 1))
    write_fields(case, rho, p, u, "zeroGradient" if uniform else "slip")
    runs.add(case, "system/fvSchemes", "divSchemes { } gradSchemes { } laplacianSchemes { }\n")
    if tables:
        runs.add(case, "system/controlDict", runs.TABLES.format("0.11 0.12 0.01", "1.1 0.7 0.01"))
    return case


def totals(case, time):
    """Mass and energy."""
    volume = haff.Case(case).volumes
    return np.array([(haff.Case(case).field(name, time) * volume).sum() for name in ("rho", "rhoE")])


class General(harness.Folder, unittest.TestCase):
    def case(self, name, mesh, end, **options):
        return make(os.path.join(self.folder, name), MESHES[mesh][0], end, **options)

    def stream(self, mesh, reconstruct, viscous=False):
        case = self.case(f"stream_{mesh}_{reconstruct}{viscous}", mesh, 0.02, uniform=True,
                         **({**runs.SPHERES, "cooling": "none"} if viscous else {}))
        if viscous:
            runs.conduct(case)
        runs.add(case, "system/fvSchemes", f"polyReconstruct {reconstruct};\n")
        harness.program("granularGas", "-case", case)
        result = haff.Case(case)
        self.assertGreater(result.mesh.cells, 150)
        np.testing.assert_allclose(result.field("rho"), 37.3, rtol=1e-12)
        np.testing.assert_allclose(result.field("p"), 1234.5, rtol=1e-11)
        self.assertLess(np.abs(result.field("U") - result.field("U", "0")).max(), 1e-11)

    def test_free_stream(self):
        for mesh in MESHES:
            for reconstruct in ("linear", "CWENO3"):
                with self.subTest(mesh, reconstruct=reconstruct):
                    self.stream(mesh, reconstruct)
        self.stream("tets", "CWENO3", viscous=True)

    def test_closed_box(self):
        """Slip walls, no cooling: mass and energy stay to round-off, while the gas moves."""
        for mesh in MESHES:
            with self.subTest(mesh):
                case = self.case("closed_" + mesh, mesh, 0.02, interval=0.01)
                harness.program("granularGas", "-case", case)
                first, last = totals(case, "0.01"), totals(case, "0.02")
                np.testing.assert_allclose(last, first, rtol=1e-13)
                result = haff.Case(case)
                self.assertGreater(np.abs(result.field("rho", "0.02") - result.field("rho", "0.01")).max(), 1)
                mass = (result.field("rho", "0") * result.volumes).sum()
                self.assertLess(abs(last[0] / mass - 1), 1e-13)

    def test_ranks_and_restarts(self):
        """Every byte that is written, function objects too, on 3 ranks as on one; and from a time on one rank, from another on 2."""
        for mesh in ("triangles", "viscous tets"):
            options = runs.SPHERES if mesh.startswith("viscous") else {"e": 0.9, "cooling": "Haff"}
            case = make(os.path.join(self.folder, "ranks_" + mesh.replace(" ", "_")), MANY[mesh.split()[-1]], 0.0009, interval=0.0003,
                        tables=True, **options)
            if options is runs.SPHERES:
                runs.conduct(case)
            copy = shutil.copytree(case, f"{case}_on3/{os.path.basename(case)}")
            harness.program("granularGas", "-case", case)
            reference = runs.results(case)
            self.assertIn("postProcessing/points/0/alpha", reference)
            self.assertIn("postProcessing/line/0.0009/a_rho.xy", reference)
            self.assertGreater(haff.Case(case).mesh.cells, 1500)
            with self.subTest(mesh, ranks=3):
                harness.program("granularGas", "-case", copy, ranks=3)
                runs.same(self, reference, runs.results(copy))
            names = runs.times(case)
            for k, name in enumerate(names[1:-1]):
                with self.subTest(mesh, start=name):
                    part = runs.until(case, f"{case}_from{k}", name)
                    harness.program("granularGas", "-case", part, ranks=1 + k % 2)
                    for later in names[k + 2:]:
                        runs.same(self, *(runs.contents(os.path.join(c, later)) for c in (case, part)))

    def test_wake(self):
        """A hole in a stream of Mach 3: gas leaves its lee, and the wall behind it, to next to nothing. No cell there gets more energy than an
        unsteady expansion of the stream can give, (u + 2 c/(gamma - 1))^2/2 (it had five times that), and ranks share the polynomials of
        such cells to the bit."""
        u, c, gamma = 1.0, 1 / 3, 5 / 3
        case = self.case("wake", "triangles", 0.24, interval=0.03)
        at = haff.Case(case).centres
        rho = np.ones(len(at))
        write_fields(case, rho, GoldshteinShapiro(1.0).p(rho, c * c / gamma), np.tile([u, 0, 0], (len(at), 1)), "slip")
        copy = shutil.copytree(case, f"{case}_on2/{os.path.basename(case)}")
        harness.program("granularGas", "-case", case)
        result = haff.Case(case)
        self.assertEqual(len(result.times), 9)
        most = (u + 2 * c / (gamma - 1)) ** 2 / 2
        for time in result.times[1:]:
            self.assertLess((result.field("rhoE", time) / result.field("rho", time)).max(), most, time)
        self.assertLess(result.field("rho").min(), 0.02)
        harness.program("granularGas", "-case", copy, ranks=2)
        runs.same(self, runs.results(case), runs.results(copy))

    def test_tables(self):
        """Probes take the cell that holds the point; integrals and averages weigh with the volumes."""
        case = self.case("tables", "triangles", 0.002, tables=True)
        harness.program("granularGas", "-case", case)
        result = haff.Case(case)
        near = ((result.centres[:, :2] - (0.11, 0.12)) ** 2).sum(axis=1).argmin()
        self.assertEqual(result.table("points", "alpha")[-1][1], float("%.12g" % result.field("alpha")[near]))
        rho, p, volume = result.field("rho"), result.field("p"), result.volumes
        self.assertAlmostEqual(result.table("mass", "volFieldValue.dat")[-1][1] / (rho * volume).sum(), 1, 13)
        self.assertAlmostEqual(result.table("mean", "volFieldValue.dat")[0][1] / ((result.field("p", "0") * volume).sum() / volume.sum()), 1, 13)
        line = np.loadtxt(case + "/postProcessing/line/0.002/a_rho.xy")
        x, y = np.linspace(0.11, 1.1, 31), np.linspace(0.12, 0.7, 31)
        away = np.hypot(x - 0.7, y - 0.45)
        self.assertTrue((away > 0.2).sum() <= len(line) <= (away > 0.19).sum(), "points in the hole are left out, the others not")
        self.assertTrue(set(line[:, 1]) <= {float("%.12g" % v) for v in rho})


class Engines(harness.Folder, unittest.TestCase):
    def wave(self, n, engine):
        """A smooth wave in a periodic box of n x n: point values of rho on the lattice, means of the cells else."""
        case, one = os.path.join(self.folder, f"{engine}{n}"), np.ones(n * n)
        harness.box_case(case, (n, n, 1), (1.0, 1.0, 1.0 / n), one, one[:, None] * [[0, 0, 0]], one, 0.02,
                         types={"x": "cyclic", "y": "cyclic"}, reconstruct="WENO5")
        x, y = "2*pi*x", "2*pi*y"
        for name, text in (("rho", f'"50 + 5*sin({x})*cos({y})"'), ("p", f'"2000 + 100*cos({x} + {y})"'),
                           ("U", f'("sin({y})" "cos({x})" "0")')):
            path = os.path.join(case, "0", name)
            with open(path, "rb") as f:
                data = f.read()
            start, end = data.index(b"internalField"), data.index(b"boundaryField")
            with open(path, "wb") as f:
                f.write(data[:start] + f"internalField expression; expression {text};\n".encode() + data[end:])
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        harness.program("granularGas", "-case", case)
        return haff.Case(case).field("rho").reshape(n, n)

    def test_smooth(self):
        """The engines differ by the error of the third-order one, means by (h^2/24) times the Laplacian from values."""
        difference = []
        for n in (16, 32, 64):
            value, mean = self.wave(n, "lattice"), self.wave(n, "polyhedral")
            around = sum(np.roll(value, shift, axis) for axis in (0, 1) for shift in (-1, 1))
            difference.append(np.abs(mean - value - (around - 4 * value) / 24).mean())
        orders = np.log2(np.divide(difference[:-1], difference[1:]))
        self.assertGreater(difference[-1], 0)
        self.assertGreater(orders[-1], 2.7, f"differences {difference}")

    def test_wedge(self):
        """With shocks the difference shrinks, too: by 0.53, as walls of a lattice know the weight of the gas, an error of first order on
        polyhedra, which know it in a settledLayer only."""
        difference = []
        for n in (24, 96):
            results = []
            for engine in ("lattice", "polyhedral"):
                case = harness.copy("wedge", self.folder)
                harness.mesh(case, n)
                runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
                results.append(harness.run(case, endTime=0.0425, writeInterval=0.0425).field("rho"))
            difference.append(np.abs(results[0] - results[1]).mean() / results[0].mean())
        self.assertLess(difference[0], 0.1)
        self.assertLess(difference[1], 0.6 * difference[0], f"{difference}")


class Words(harness.Folder, unittest.TestCase):
    """What the programs say of a mesh, and what they refuse."""

    def test_report(self):
        case = make(self.folder + "/triangles", MESHES["triangles"][0], 0.002)
        cells = haff.Case(case).mesh.cells
        before = runs.contents(case)
        for said in (harness.program("checkCase", case).stdout, harness.program("granularGas", "-dry-run", "-case", case).stdout):
            self.assertRegex(said, rf"polyhedral, 2D: {cells} prisms; \d+ blocks?\n +no lattice: cell \d+ at .* is no box")
            self.assertRegex(said, r"meshEngine +polyhedral\n +polyReconstruct +CWENO3\n")
            self.assertNotRegex(said, r"\n +reconstruct ")
            self.assertIn("The case ", said)
        self.assertEqual(runs.contents(case), before)
        runs.add(case, "system/fvSchemes", "polyReconstruct linear;\n")
        self.assertRegex(harness.program("granularGas", "-case", case).stdout, r"polyReconstruct +linear\n")
        with open(case + "/0.002/uniform/provenance") as f:
            self.assertRegex(f.read(), r"meshEngine +polyhedral;\npolyReconstruct linear;")

    def test_lattice_asked(self):
        case = make(self.folder + "/asked", MESHES["triangles"][0], 0.002)
        runs.add(case, "system/fvSchemes", "meshEngine lattice;\n")
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"fvSchemes:\d+: .*no lattice of equal boxes: cell \d+ at .* is no box.*meshEngine polyhedral;")

    def test_lattice_as_polyhedra(self):
        case = runs.make(self.folder + "/box", (12, 10, 1), 0.01)
        self.assertRegex(harness.program("checkCase", case).stdout, r"lattice, 2D: .* \d+ tiles\n(.*\n)* +meshEngine +lattice\n +reconstruct +PHM\n")
        runs.add(case, "system/fvSchemes", "meshEngine polyhedral;\n")
        self.assertRegex(harness.program("checkCase", case).stdout, r"polyhedral, 2D: 120 hexahedra; 1 block\n +a lattice, but .*meshEngine polyhedral;")

    def test_misspelt(self):
        case = runs.make(self.folder + "/word", (12, 10, 1), 0.01)
        runs.add(case, "system/fvSchemes", "polyReconstruct CWENO5;\n")
        done = harness.program("checkCase", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "polyReconstruct.*CWENO3")

    def test_list(self):
        said = harness.program("granularGas", "-listModels").stdout
        self.assertRegex(said, r"meshEngine\n +lattice .*\n +polyhedral ")
        self.assertRegex(said, r"polyReconstruct\n( .*\n)* +CWENO3 .*\(default\)\n")


class Readers(harness.Folder, unittest.TestCase):
    def written(self, case, ending=".vtk"):
        """What VTK makes of a file."""
        import vtk
        reader = vtk.vtkXMLUnstructuredGridReader() if ending == ".vtu" else vtk.vtkUnstructuredGridReader()
        reader.SetFileName(os.path.join(case, "VTK", f"{os.path.basename(case)}_0.002{ending}"))
        sizes = vtk.vtkCellSizeFilter()
        sizes.SetInputConnection(reader.GetOutputPort())
        sizes.Update()
        return sizes.GetOutput()

    def check(self, case, kind):
        from vtk.util.numpy_support import vtk_to_numpy
        result, grid = haff.Case(case), self.written(case)
        types = {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}
        self.assertEqual(len(result.volumes), grid.GetNumberOfCells())
        self.assertTrue(kind is None or types == {kind}, types)
        data = grid.GetCellData()
        if types & {10, 12, 13, 14} == types:
            np.testing.assert_allclose(vtk_to_numpy(data.GetArray("Volume")), result.volumes, rtol=1e-9)
        np.testing.assert_array_equal(vtk_to_numpy(data.GetArray("alpha")), result.field("alpha"))
        self.check_xml(case, grid)

    def check_xml(self, case, legacy):
        """caseToVTK -vtu gives VTK the same cells, with the same faces, volumes and fields."""
        from vtk.util.numpy_support import vtk_to_numpy
        harness.program("caseToVTK", case, "-vtu")
        grid = self.written(case, ".vtu")
        self.assertEqual(grid.GetNumberOfCells(), legacy.GetNumberOfCells())
        for i in range(grid.GetNumberOfCells()):
            a, b = grid.GetCell(i), legacy.GetCell(i)
            self.assertEqual((a.GetCellType(), a.GetNumberOfFaces(), a.GetNumberOfPoints(), a.GetBounds()),
                             (b.GetCellType(), b.GetNumberOfFaces(), b.GetNumberOfPoints(), b.GetBounds()))
        volumes, other = (vtk_to_numpy(g.GetCellData().GetArray("Volume")) for g in (grid, legacy))
        np.testing.assert_allclose(volumes, other, rtol=1e-9)  # VTK cuts polyhedra by the order of their points
        for name in ("alpha", "U"):
            np.testing.assert_array_equal(*(vtk_to_numpy(g.GetCellData().GetArray(name)) for g in (grid, legacy)), err_msg=name)
        self.assertEqual(grid.GetFieldData().GetArray("TimeValue").GetValue(0), 0.002)

    def test_every_shape(self):
        for mesh, (geo, kind) in MESHES.items():
            with self.subTest(mesh):
                case = make(os.path.join(self.folder, mesh), geo, 0.002, tables=True)
                harness.program("granularGas", "-case", case)
                self.check(case, kind)
                by_us = runs.contents(case + "/VTK")
                shutil.rmtree(case + "/VTK")
                harness.program("caseToVTK", case, "-fields", "alpha,U", "-time", "0.002")
                self.assertEqual(by_us[mesh + "_0.002.vtk"], runs.contents(case + "/VTK")[mesh + "_0.002.vtk"])

    @unittest.skipUnless(shutil.which("foamToVTK"), "OpenFOAM is not installed")
    def test_openfoam(self):
        """checkMesh, foamToVTK; parts of two ranks, put together again by reconstructPar."""
        case = make(self.folder + "/foam", MANY["triangles"], 0.002)
        runs.add(case, "system/controlDict", "writeProcessors yes;\n")
        harness.program("granularGas", "-case", case, ranks=2)
        self.assertIn("Mesh OK.", openfoam(self, "checkMesh", case))
        for part in range(2):
            self.assertIn("Mesh OK.", openfoam(self, "checkMesh", f"{case}/processor{part}"))
        other = shutil.copytree(case, case + "_again")
        shutil.rmtree(other + "/0.002")
        openfoam(self, "reconstructPar", other)
        for field in runs.FIELDS:
            np.testing.assert_array_equal(*(haff.Case(c).field(field, "0.002") for c in (case, other)), err_msg=field)
        openfoam(self, "foamToVTK", case, "-time", "0.002")

    @unittest.skipUnless(shutil.which("polyDualMesh"), "OpenFOAM is not installed")
    def test_polyhedra(self):
        """The dual of tetrahedra: cells of any number of faces, faces of any number of corners."""
        case = make(self.folder + "/dual", MESHES["tets"][0], 0.002, uniform=True, tables=True)
        openfoam(self, "polyDualMesh", case, "60", "-overwrite")
        cells = haff.Case(case).mesh.cells
        write_fields(case, np.full(cells, 37.3), np.full(cells, 1234.5), np.tile([3.1, -1.7, 2.3], (cells, 1)), "zeroGradient")
        self.assertRegex(harness.program("checkCase", case).stdout, r"polyhedral, 3D: .*\d+ polyhedra; \d+ block")
        harness.program("granularGas", "-case", case)
        np.testing.assert_allclose(haff.Case(case).field("rho"), 37.3, rtol=1e-12)
        self.check(case, None)


if __name__ == "__main__":
    unittest.main()
