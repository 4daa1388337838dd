# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs on real case folders: bad input, restart, stopping, function objects."""
import hashlib
import os
import shutil
import signal
import subprocess
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes

CELLS, SIZE = 8, (1.0, 0.1, 0.1)
CONTROL, PROPERTIES, SCHEMES = "system/controlDict", "constant/granularProperties", "system/fvSchemes"
BOUNDARY = "constant/polyMesh/boundary"


def small(path, **options):
    """A box of CELLS cells with gas at rest: a case that runs in no time."""
    rho, p = np.full(CELLS, 50.0), np.full(CELLS, 2000.0)
    harness.box_case(path, (CELLS, 1, 1), SIZE, rho, np.zeros((CELLS, 3)), p, 1e-3, **options)
    return path


def contents(path):
    found = {}
    for folder, _, files in os.walk(path):
        for name in files:
            full = os.path.join(folder, name)
            with open(full, "rb") as f:
                found[os.path.relpath(full, path)] = hashlib.sha256(f.read()).hexdigest()
    return found


def replace(old, new):
    return lambda text: text.replace(old, new, 1)


def append(more):
    return lambda text: text + "\n" + more


# file, change of its text, what the message must hold besides the file's name
BAD = [
    (CONTROL, append("maxC0 0.2;"), "maxC0", "did you mean"),
    (CONTROL, replace("maxCo 0.5", "maxCo 7"), "maxCo", "7"),
    (CONTROL, replace("maxCo 0.5", "maxCo half"), "maxCo", "half"),
    (CONTROL, replace("maxCo 0.5", "maxCo nan"), "maxCo", "nan"),
    (CONTROL, replace("endTime 0.001;", "endTime 0.001"), "';'"),
    (CONTROL, replace("endTime 0.001;", ""), "endTime"),
    (CONTROL, replace("endTime 0.001;", "endTime [0 1 0 0 0 0 0] 0.001;"), "endTime"),
    (CONTROL, replace("startFrom latestTime", "startFrom lastTime"), "latestTime"),
    (CONTROL, replace("startFrom latestTime; startTime 0", "startFrom startTime; startTime 3e-4"), "no such time"),
    (CONTROL, replace("writeFormat binary", "writeFormat hex"), "ascii"),
    (CONTROL, replace("writePrecision 17", "writePrecision 99"), "writePrecision"),
    (CONTROL, replace("adjustTimeStep yes", "adjustTimeStep perhaps"), "perhaps"),
    (CONTROL, append("functions { f { type probes; fields (alpha); probeLocations ((5 0 0)); } }"), "outside"),
    (CONTROL, append("functions { f { type probe; fields (alpha); } }"), "probes"),
    (CONTROL, append("functions { f { type fieldMinMax; fields (alfa); } }"), "alpha"),
    (CONTROL, append("functions { f { type fieldMinMax; fields (alpha); writeIntervall 2; } }"), "writeInterval"),
    (CONTROL, append("functions { f { type volFieldValue; fields (rho); operation average; } }"), "volAverage"),
    (CONTROL, append("functions { f { type sets; fields (rho); sets { a { type uniform; axis x; start (0 0 0); "
                     "end (1 0 0); nPoints 1; } } } }"), "nPoints"),
    (CONTROL, append("}"), "}"),
    (CONTROL, append("a { b 1;"), "a"),
    (CONTROL, append("#include \"nowhere\""), "nowhere"),
    (CONTROL, append("x $undefined;"), "undefined"),
    (CONTROL, append("x #eval{ 2*(3 };"), ")"),
    (CONTROL, append("x #codeStream { };"), "codeStream"),
    (PROPERTIES, replace("restitution 1.0", "restitution 1.2"), "restitution", "1.2"),
    (PROPERTIES, replace("restitution 1.0", "restitutoin 1.0"), "restitution"),
    (PROPERTIES, replace("diameter 0.1", "diameter -0.1"), "diameter"),
    (PROPERTIES, replace("diameter 0.1", "diameter [1 0 0 0 0 0 0] 0.1"), "diameter"),
    (PROPERTIES, replace("equationOfState GoldshteinShapiro", "equationOfState GoldsteinShapiro"), "GoldshteinShapiro"),
    (PROPERTIES, replace("gamma 1.6666666666666667", "gamma 0.5"), "gamma"),
    (PROPERTIES, replace("cooling none", "cooling haff"), "Haff"),
    (SCHEMES, replace("fluxScheme common", "fluxScheme Kurganov"), "Marquina"),
    (SCHEMES, replace("reconstruct PHM", "reconstruct WENO"), "WENO5"),
    ("0/rho", replace("[1 -3 0 0 0 0 0]", "[1 -2 0 0 0 0 0]"), "[1 -3 0 0 0 0 0]"),
    ("0/rho", replace("\n50\n", "\nnan\n"), "nan"),
    ("0/rho", replace("\n50\n", "\n-50\n"), "-50", "cell 0"),
    ("0/rho", replace("\n50\n", "\n5e5\n"), "rho"),
    ("0/rho", replace("\n50\n", "\n"), "8"),
    ("0/rho", replace("xHigh { type zeroGradient; }", ""), "xHigh"),
    ("0/rho", replace("xHigh {", "xHihg {"), "xHigh"),
    ("0/rho", replace("xHigh { type zeroGradient; }", "xHigh { type zeroGradiant; }"), "zeroGradient"),
    ("0/rho", replace("xHigh { type zeroGradient; }", "xHigh { type empty; }"), "empty"),
    ("0/rho", replace("xHigh { type zeroGradient; }", "xHigh { type noSlip; }"), "noSlip"),
    ("0/rho", replace("xHigh { type zeroGradient; }", "xHigh { type fixedValue; }"), "value"),
    ("0/rho", replace("xHigh { type zeroGradient; }", "xHigh { type fixedValue; value uniform -2; }"), "-2"),
    ("0/rho", replace("yEmpty { type empty; }", "yEmpty { type zeroGradient; }"), "empty"),
    ("0/rho", append('expression "x +";'), "expression"),
    ("0/rho", append('expression "log(x - 1)";'), "expression"),
    ("0/rho", append('expression ("1" "2" "3");'), "expression"),
    ("0/p", replace("\n2000\n", "\n0\n"), "greater than 0"),
    ("0/U", replace("(0 0 0)", "(0 0)"), "expected a number"),
    ("0/U", replace("List<vector>", "List<scalar>"), "vector"),
    (BOUNDARY, replace("nFaces 1;", "nFaces 2;"), "startFace"),
    (BOUNDARY, replace("type empty;", "type patch;"), "yEmpty"),
    ("constant/polyMesh/owner", replace("\n0\n", "\n99\n"), "99"),
    ("constant/polyMesh/faces", replace("4(", "4(9999 "), "faces"),
    ("constant/polyMesh/points", replace("(0 0 0)", "(0 0 inf)"), "inf"),
]


class BadInput(harness.Folder, unittest.TestCase):
    def refused(self, case, file, *parts):
        before = contents(case)
        for command in (("granularGas", "-case", case), ("checkCase", case)):
            done = harness.program(*command, check=False, timeout=60)
            self.assertEqual(done.returncode, 1, f"{command[0]}: {done.stdout[-300:]}{done.stderr}")
            for part in (os.path.basename(file), *parts):
                self.assertIn(part, done.stderr)
        self.assertEqual(contents(case), before, "the case was changed")
        return done.stderr

    def test_files(self):
        good = small(os.path.join(self.folder, "good"))
        for number, (file, change, *parts) in enumerate(BAD):
            with self.subTest(number=number, file=file, parts=parts):
                case = shutil.copytree(good, os.path.join(self.folder, f"bad{number}"))
                path = os.path.join(case, file)
                with open(path) as f:
                    text = f.read()
                changed = change(text)
                self.assertNotEqual(text, changed)
                with open(path, "w") as f:
                    f.write(changed)
                message = self.refused(case, file, *parts)
                if file in (CONTROL, PROPERTIES, SCHEMES) and "missing" not in message:
                    self.assertRegex(message, r":\d+: ")

    def test_missing_and_doubled_files(self):
        good = small(os.path.join(self.folder, "files"))
        for name in ("0/U", "0/rho", "0/p", CONTROL, SCHEMES, PROPERTIES, "constant/polyMesh/points"):
            with self.subTest(name):
                case = shutil.copytree(good, os.path.join(self.folder, "without"))
                os.remove(os.path.join(case, name))
                self.refused(case, name)
                shutil.rmtree(case)
        boxes.write_field(good, "alpha", np.full(CELLS, 0.1))
        self.refused(good, "rho", "alpha")

    def test_options(self):
        for arguments in (["-cas", "x"], ["-np"], ["-np", "0"], ["-case", "/nowhere"]):
            done = harness.program("granularGas", *arguments, check=False)
            self.assertEqual(done.returncode, 1, done.stderr)
        for option in ("-help", "-listModels", "-listBCs"):
            self.assertTrue(harness.program("granularGas", option).stdout)
        self.assertIn("Marquina", harness.program("granularGas", "-listModels").stdout)
        self.assertIn("inletOutlet", harness.program("granularGas", "-listBCs").stdout)


class Running(harness.Folder, unittest.TestCase):
    def control(self, case, **entries):
        harness.edit(case, CONTROL, **entries)

    def add(self, case, text):
        with open(os.path.join(case, CONTROL), "a") as f:
            f.write(text)

    @unittest.skipUnless(shutil.which("readelf"), "readelf is not installed")
    def test_libraries(self):
        """A program never looks for libraries in the current folder, which an empty part of its path would mean."""
        for name in ("granularGas", "checkCase"):
            said = subprocess.run(["readelf", "-d", os.path.join(harness.BIN, name)], check=True, capture_output=True, text=True).stdout
            self.assertIn("(NEEDED)", said)
            self.assertNotRegex(said, r"(RPATH|RUNPATH).*(\[:|::|:\]|\[\])")

    def test_dry_run_writes_nothing(self):
        case = small(os.path.join(self.folder, "dry"))
        before = contents(case)
        for command in (("granularGas", "-case", case, "-dry-run"), ("checkCase", case)):
            done = harness.program(*command)
            self.assertIn("lattice, 1D", done.stdout)
            self.assertIn("The case can be run", done.stdout)
        self.assertEqual(contents(case), before)

    def test_silent_schemes(self):
        """An empty fvSchemes and no maxCo: what the README and -listModels name."""
        case = small(os.path.join(self.folder, "silent"))
        with open(os.path.join(case, SCHEMES), "w") as f:
            f.write(boxes.header("dictionary", "fvSchemes", "system"))
        with open(os.path.join(case, CONTROL)) as f:
            text = f.read().replace("maxCo 0.5;", "")
        with open(os.path.join(case, CONTROL), "w") as f:
            f.write(text)
        said = harness.program("checkCase", case).stdout
        listed = harness.program("granularGas", "-listModels").stdout
        for key, name in (("fluxScheme", "common"), ("reconstruct", "WPENO5"), ("timeScheme", "SSPRK43")):
            self.assertRegex(said, rf"{key} +{name}\n")
            self.assertRegex(listed, rf"fvSchemes: {key}\n(  .*\n)*  {name} .*\(default\)\n")
        for part in listed.split("system/fvSchemes: "):
            self.assertLessEqual(part.count("(default)"), 1)
        self.assertRegex(said, r"maxCo +1 +default")

    def test_ascii_compressed_restart(self):
        """Restart to the bit from ascii with few digits, compressed: the conserved fields carry all of them."""
        case = small(os.path.join(self.folder, "ascii"), slip=("xLow",))
        boxes.write_field(case, "p", 2000 + 100 * np.arange(CELLS), "xLow zeroGradient\nxHigh zeroGradient\n"
                          "yEmpty empty\nzEmpty empty")
        self.control(case, endTime=2e-3, writeInterval=1e-3, writeFormat="ascii", writePrecision=6,
                     writeCompression="on")
        part = shutil.copytree(case, case + "_part")
        harness.program("granularGas", "-case", case)
        self.control(part, endTime=1e-3)
        harness.program("granularGas", "-case", part)
        self.control(part, endTime=2e-3)
        harness.program("granularGas", "-case", part)
        names = sorted(os.listdir(os.path.join(case, "0.002")))
        self.assertIn("rhoE.gz", names)
        for name in names:
            if name != "uniform":
                a, b = (subprocess.run(["zcat", os.path.join(c, "0.002", name)], capture_output=True, check=True).stdout
                        for c in (case, part))
                self.assertEqual(a, b, name)

    def test_changed_field_of_a_written_time_is_not_ignored(self):
        case = small(os.path.join(self.folder, "changed"))
        self.control(case, writeFormat="ascii")
        harness.program("granularGas", "-case", case)
        path = os.path.join(case, "0.001", "T")
        with open(path) as f:
            text = f.read()
        value = text.split("(\n", 1)[1].split("\n", 1)[0]
        with open(path, "w") as f:
            f.write(text.replace(value, "9", 1))
        self.control(case, endTime=2e-3)
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("on purpose, remove", done.stderr)
        os.remove(os.path.join(case, "0.001", "uniform", "checksums"))
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("remove rhoU and rhoE", done.stderr)

    def test_signal_and_run_time_modification(self):
        case = small(os.path.join(self.folder, "signal"))
        self.control(case, endTime=1e9, writeInterval=1e9, runTimeModifiable="yes")
        for way in ("signal", "stopAt"):
            with self.subTest(way):
                run = subprocess.Popen([os.path.join(harness.BIN, "granularGas"), "-case", case], stdout=subprocess.PIPE,
                                       stderr=subprocess.STDOUT, text=True)
                for line in run.stdout:
                    if line.startswith("Time ="):
                        break
                if way == "signal":
                    run.send_signal(signal.SIGTERM)
                else:
                    self.control(case, stopAt="writeNow")
                text, _ = run.communicate(timeout=30)
                self.assertEqual(run.returncode, 0, text[-500:])
                self.assertIn("stopped as asked", text)
        self.assertEqual(len(harness.haff.Case(case).times), 3)
        self.assertFalse([name for name in os.listdir(case) if name.startswith(".")])

    def test_purge_and_function_objects(self):
        case = small(os.path.join(self.folder, "functions"))
        self.control(case, writeInterval=1e-4)
        self.add(case, """purgeWrite 2;
functions
{
    pr { type probes; fields (alpha U); probeLocations ((0.31 0.05 0.05) (9 0 0)); allowOutside yes; }
    mm { type fieldMinMax; fields (T U); writeControl writeTime; }
    mass { type volFieldValue; fields (rho); operation volIntegrate; regionType all; }
    cl { type sets; setFormat raw; fields (rho U); writeControl writeTime;
         sets ( a { type uniform; axis x; start (0 0.05 0.05); end (1 0.05 0.05); nPoints 9; } ); }
    vtk { type vtk; fields (T U); writeControl writeTime; }
}
""")
        harness.program("granularGas", "-case", case)
        self.assertEqual(sorted(t for t in os.listdir(case) if t.startswith("0.0")), ["0.0009", "0.001"])
        with open(os.path.join(case, "postProcessing", "pr", "0", "alpha")) as f:
            lines = f.read().splitlines()
        self.assertEqual(lines[0], "# Probe 0 (0.31 0.05 0.05)")
        self.assertEqual(float(lines[-1].split()[0]), 1e-3)
        self.assertEqual(float(lines[-1].split()[2]), -1e300)
        self.assertAlmostEqual(float(lines[-1].split()[1]), np.pi * 50 * 0.1**3 / 6, 10)
        with open(os.path.join(case, "postProcessing", "mass", "0", "volFieldValue.dat")) as f:
            self.assertAlmostEqual(float(f.read().split()[-1]), 50 * 0.01, 12)
        line = np.loadtxt(os.path.join(case, "postProcessing", "cl", "0.001", "a_rho.xy"))
        np.testing.assert_allclose(line, np.stack([np.linspace(0, 1, 9), np.full(9, 50.0)], axis=1))
        self.assertTrue(os.path.exists(os.path.join(case, "postProcessing", "cl", "0.001", "a_U.xy")))
        with open(os.path.join(case, "postProcessing", "mm", "0", "fieldMinMax.dat")) as f:
            self.assertEqual(len(f.read().splitlines()), 2 + 2 * 11)
        self.assertEqual(len([n for n in os.listdir(os.path.join(case, "VTK")) if n.endswith(".vtk")]), 11)

    def test_general_mesh(self):
        """Prisms and tetrahedra: converted, checked, run, read by VTK."""
        import vtk
        for shape, extrude, points in (("prism", "Layers{2}; Recombine;", 6), ("tetra", "", 4)):
            case = small(os.path.join(self.folder, shape))
            geo = os.path.join(case, "m.geo")
            with open(geo, "w") as f:
                f.write('SetFactory("OpenCASCADE"); Rectangle(1) = {0, 0, 0, 1, 1}; Mesh.MeshSizeMax = 0.4;\n'
                        "Extrude {0, 0, 0.5} { Surface{1}; %s }\n" % extrude +
                        'Physical Volume("gas") = {1}; b[] = Boundary{ Volume{1}; }; Physical Surface("wall") = {b[]};\n')
            subprocess.run(["gmsh", "-3", "-v", "1", geo, "-o", case + "/m.msh"], check=True, capture_output=True)
            harness.program("gmshToCase", case + "/m.msh", "-case", case)
            cells = harness.haff.Mesh(os.path.join(case, "constant", "polyMesh")).cells
            for name, values in (("rho", np.full(cells, 50.0)), ("p", np.full(cells, 2000.0)), ("U", np.zeros((cells, 3)))):
                boxes.write_field(case, name, values, "wall " + ("slip" if name == "U" else "zeroGradient"))
            self.assertIn("no lattice", harness.program("checkCase", case).stdout)
            with open(os.path.join(case, SCHEMES), "a") as f:
                f.write("polyReconstruct linear;\n")
            harness.program("granularGas", "-case", case)
            np.testing.assert_allclose(harness.haff.Case(case).field("rho"), 50, rtol=1e-12)
            for option in ([], ["-ascii"]):
                harness.program("caseToVTK", case, "-fields", "rho,U", *option)
                reader = vtk.vtkUnstructuredGridReader()
                reader.SetFileName(os.path.join(case, "VTK", shape + "_0.vtk"))
                reader.ReadAllScalarsOn()
                sizes = vtk.vtkCellSizeFilter()
                sizes.SetInputConnection(reader.GetOutputPort())
                sizes.Update()
                grid = sizes.GetOutput()
                self.assertEqual({grid.GetCell(i).GetNumberOfPoints() for i in range(cells)}, {points})
                volume = [grid.GetCellData().GetArray("Volume").GetValue(i) for i in range(cells)]
                self.assertAlmostEqual(sum(volume), 0.5, 12)
                self.assertGreater(min(volume), 0)

    def test_boundary_values_survive_a_restart(self):
        """fixedValue of p and inletOutlet of U are written so that the next start reads the same rules."""
        case = small(os.path.join(self.folder, "rules"))
        for name, value in (("p", "fixedValue; value uniform 2500"), ("U", "inletOutlet; inletValue uniform (1 0 0)")):
            path = os.path.join(case, "0", name)
            with open(path) as f:
                text = f.read()
            with open(path, "w") as f:
                f.write(text.replace("xLow { type zeroGradient; }", f"xLow {{ type {value}; }}"))
        part = shutil.copytree(case, case + "_part")
        self.control(case, endTime=2e-3)
        harness.program("granularGas", "-case", case)
        harness.program("granularGas", "-case", part)
        self.control(part, endTime=2e-3)
        harness.program("granularGas", "-case", part)
        a, b = (harness.haff.Case(c).field("T") for c in (case, part))
        self.assertTrue((a == b).all())
        self.assertGreater(np.ptp(a), 0)


if __name__ == "__main__":
    unittest.main()
