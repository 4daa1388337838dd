# SPDX-License-Identifier: GPL-3.0-or-later
"""What users of OpenFOAM bring along is taken as OpenFOAM takes it: old names, groups of patches, function objects in files, folders
that its programs make."""
import os
import re
import shutil
import subprocess
import unittest

from tests.cases import harness, runs
from tests.solvers.programs import bad_case

CONTROL = "system/controlDict"
BOUNDARY = "constant/polyMesh/boundary"
FOAM = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
BOX = """vertices ((0 0 0) (6 0 0) (6 4 0) (0 4 0) (0 0 1) (6 0 1) (6 4 1) (0 4 1));
blocks (hex (0 1 2 3 4 5 6 7) (6 4 1) simpleGrading (1 1 1));
boundary
(
    xLow { type patch; inGroups (open); faces ((0 4 7 3)); }
    xHigh { type wall; inGroups (solid); faces ((1 2 6 5)); }
    yLow { type cyclic; neighbourPatch yHigh; faces ((0 1 5 4)); }
    yHigh { type cyclic; neighbourPatch yLow; faces ((3 7 6 2)); }
    zEmpty { type empty; faces ((0 3 2 1) (4 5 6 7)); }
);
"""


class Case(harness.Folder, unittest.TestCase):
    def make(self, name):
        """6 x 4 cells with an inlet, a wall, a cyclic pair, two empty sides."""
        case = os.path.join(self.folder, name)
        bad_case.write(case)
        return case

    def write(self, case, file, text):
        os.makedirs(os.path.dirname(os.path.join(case, file)), exist_ok=True)
        with open(os.path.join(case, file), "w") as f:
            f.write(text)

    def replace(self, case, file, old, new):
        with open(os.path.join(case, file)) as f:
            text = f.read()
        self.assertIn(old, text)
        self.write(case, file, text.replace(old, new))

    def rows(self, case, path):
        """Lines of a table without its head."""
        with open(os.path.join(case, "postProcessing", path)) as f:
            return [line for line in f if not line.startswith("#")]


class Control(Case):
    def test_old_names(self):
        """outputControl and outputInterval are writeControl and writeInterval, unless those are there."""
        case = self.make("old")
        self.replace(case, CONTROL, "writeControl timeStep;\n        writeInterval 1;", "outputControl timeStep; outputInterval 2;")
        self.replace(case, CONTROL, "type fieldMinMax;", "type fieldMinMax; outputInterval 2; writeControl timeStep; writeInterval 1;")
        harness.program("granularGas", "-case", case)
        self.assertEqual(len(self.rows(case, "points/0/alpha")), 2)  # 0 and the second of two steps
        self.assertEqual(len(self.rows(case, "extremes/0/fieldMinMax.dat")), 3)

    def test_window(self):
        """timeStart and timeEnd, both included, of what is written at times."""
        case = self.make("window")
        self.replace(case, CONTROL, "type probes;", "type probes; timeStart 0.001; timeEnd 0.0015;")
        self.replace(case, CONTROL, "type fieldMinMax;", "type fieldMinMax; timeEnd 0.001;")
        harness.program("granularGas", "-case", case)
        self.assertEqual([row.split()[0] for row in self.rows(case, "points/0/alpha")], ["0.001"])
        self.assertEqual([row.split()[0] for row in self.rows(case, "extremes/0/fieldMinMax.dat")], ["0", "0.001"])

    def test_ignored(self):
        """Keywords of controlDict that are for OpenFOAM alone."""
        case = self.make("ignored")
        with open(os.path.join(case, CONTROL), "a") as f:
            f.write("cycleWrite 0; userTime { type real; } solver fluid; beginTime 0; fileHandler collated; maxAlphaCo 0.5;\n")
        harness.program("checkCase", case)

    def test_function_in_a_file(self):
        """#includeFunc NAME is the function object NAME whose dictionary is system/NAME."""
        case = self.make("file")
        self.write(case, "system/low", "type fieldMinMax; fields (rho); log false;\n")
        self.replace(case, CONTROL, "functions\n{", "functions\n{\n    #includeFunc low\n")
        self.assertNotIn("passedOver", harness.program("granularGas", "-case", case).stdout)
        self.assertEqual(len(self.rows(case, "low/0/fieldMinMax.dat")), 3)

    def test_parallel(self):
        """mpirun has started the ranks: -parallel says nothing new."""
        case = self.make("parallel")
        harness.program("granularGas", "-case", case, "-parallel", ranks=2)
        self.assertTrue(os.path.isdir(case + "/0.002"))


class Starts(Case):
    def make(self, name):
        """The case with 0.orig and a copy of it, 0, to which OpenFOAM's programs have written."""
        case = super().make(name)
        shutil.copytree(case + "/0", case + "/0.orig")
        return case

    def change(self, case, file, when):
        """Sets alpha to 0.3, and the time of the change, seconds from now."""
        path = os.path.join(case, file)
        with open(path) as f:
            text = f.read()
        self.write(case, file, text.replace(bad_case.LIST, "uniform 0.3;\n"))
        os.utime(path, (os.path.getmtime(path) + when,) * 2)

    def first(self, case):
        return harness.haff.Case(case).field("alpha", "0.001").max()

    def test_newer(self):
        case = self.make("newer")
        self.change(case, "0/alpha", 10)
        with open(case + "/0/alpha", "rb") as f:
            text = f.read()
        said = harness.program("granularGas", "-case", case, ranks=2).stdout
        self.assertRegex(said, r"warning: .*/0: it is the start, and not 0.orig.*\[newerStart\]")
        self.assertGreater(self.first(case), 0.28)
        with open(case + "/0/alpha", "rb") as f:
            self.assertEqual(f.read(), text)  # and it stays as it is

    def test_older_or_lacking(self):
        """What a run would lose silently is refused, as ever."""
        for name, spoil, says in (("older", lambda case: self.change(case, "0.orig/alpha", 10), "which is older"),
                                  ("lacking", lambda case: os.remove(case + "/0/T"), "which lacks T")):
            case = self.make(name)
            spoil(case)
            done = harness.program("granularGas", "-case", case, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, "0.orig is there, too.*" + says)
        case = self.make("afresh")
        self.change(case, "0/alpha", 10)
        done = harness.program("initialFields", case, check=False)
        self.assertIn("a 0 that no run wrote", done.stderr)

    def test_written_stays(self):
        """A 0 that a run wrote is made again."""
        case = super().make("written")
        os.rename(case + "/0", case + "/0.orig")
        harness.program("granularGas", "-case", case)
        shutil.rmtree(case + "/0.001")
        shutil.rmtree(case + "/0.002")
        self.assertNotIn("newerStart", harness.program("granularGas", "-case", case).stdout)

    def test_mapped(self):
        """The fields of a written time as mapFields leaves them: without uniform/, and no more those of one state."""
        case = super().make("mapped")
        harness.program("granularGas", "-case", case)
        shutil.rmtree(case + "/0")
        shutil.copytree(case + "/0.001", case + "/0", ignore=lambda *_: ["uniform"])
        for name in ("0.001", "0.002"):
            shutil.rmtree(os.path.join(case, name))
        with open(case + "/0/rhoE") as f:
            text = f.read()
        self.write(case, "0/rhoE", re.sub(r"\n[0-9.e+]+\n\)", "\n12345\n)", text, count=1))  # it does not count
        said = harness.program("granularGas", "-case", case).stdout
        self.assertRegex(said, r"warning: .*/0/rho:1: .*mapFields.*\[newerStart\]")

    @unittest.skipUnless(shutil.which("setFields"), "OpenFOAM is not there")
    def test_set_fields(self):
        case = self.make("setFields")
        self.write(case, "system/setFieldsDict", harness.boxes.header("dictionary", "setFieldsDict", "system") +
                   "regions ( boxToCell { box (0 0 0) (3 4 1); fieldValues ( volScalarFieldValue alpha 0.4 ); } );\n")
        with open(case + "/system/fvSchemes", "a") as f:
            f.write("laplacianSchemes { }\n")
        subprocess.run(["setFields", "-case", case], check=True, capture_output=True, env=FOAM)
        self.assertIn("newerStart", harness.program("granularGas", "-case", case).stdout)
        self.assertGreater(self.first(case), 0.35)


class Digits(Case):
    def test_lattice_of_few_digits(self):
        """Points with the six digits that blockMesh writes by itself: a lattice on any ranks, as it is with all digits."""
        case = runs.make(os.path.join(self.folder, "digits"), (60, 7, 1), 0.002)
        path = case + "/constant/polyMesh/points"
        with open(path) as f:
            head, points = f.read().split("\n(\n")
        points = re.sub(r"[-+.0-9e]+", lambda x: "%.6g" % (float(x[0]) / 7), points)  # cells 1/70 long
        self.write(case, "constant/polyMesh/points", head + "\n(\n" + points)
        runs.add(case, "system/fvSchemes", "meshEngine lattice;\n")
        other = shutil.copytree(case, case + "3")
        harness.program("granularGas", "-case", case)
        harness.program("granularGas", "-case", other, ranks=3)
        runs.same(self, runs.results(case), runs.results(other))


class Patches(Case):
    INLET = {"alpha": "type fixedValue; value uniform 0.2;", "T": "type fixedValue; value uniform 25;",
             "U": "type fixedValue; value uniform (1 0.5 0);"}
    WALL = {"alpha": "type zeroGradient;", "T": "type slip;", "U": "type slip;"}

    def boundary(self, case, text):
        """Gives all fields these entries; INLET and WALL stand for those of the field."""
        for name in ("alpha", "T", "U"):
            with open(os.path.join(case, "0", name)) as f:
                head = f.read().split("boundaryField")[0]
            entries = text.replace("INLET", self.INLET[name]).replace("WALL", self.WALL[name])
            self.write(case, f"0/{name}", head + "boundaryField\n{\n" + entries + "\n}\n")

    def results(self, case):
        harness.program("granularGas", "-case", case)
        found = {}
        for name in ("alpha", "U", "T"):
            with open(os.path.join(case, "0.002", name), "rb") as f:
                found[name] = f.read()
        return found

    def test_groups(self):
        """A name comes first, then the last group in the file, then a pattern; `empty` patches need no entry: as in OpenFOAM. An entry
        without an effect may stand there."""
        plain = self.results(self.make("plain"))
        for name, text in {
            "types": '".*" { type zeroGradient; } wall { WALL } cyclic { type cyclic; } xLow { INLET }',
            "own": 'open { INLET } "x.*" { type zeroGradient; } solid { WALL } "y.*" { type cyclic; }',
            "last": 'xLow { INLET } wall { type zeroGradient; } solid { WALL } cyclic { type cyclic; }',
            "spare": '#includeEtc "caseDicts/setConstraintTypes"\n xLow { INLET } xHigh { WALL } wall { type noSlip; } "xH.*" { WALL } '
                     'processor { type processor; }',
        }.items():
            with self.subTest(name):
                case = self.make(name)
                self.replace(case, BOUNDARY, "type patch;", "type patch; inGroups 1(open);")
                self.replace(case, BOUNDARY, "type wall;", "type wall; inGroups List<word> 2(wall solid);")
                self.boundary(case, text)
                self.assertEqual(self.results(case), plain)
        case = self.make("blocks")
        shutil.rmtree(case + "/constant/polyMesh")
        self.write(case, "system/blockMeshDict", BOX)
        self.boundary(case, "open { INLET } solid { WALL } cyclic { type cyclic; }")
        self.assertEqual(sorted(self.results(case)), sorted(plain))

    def test_wrong_groups(self):
        for name, text, says in (("none", "xLow { INLET } solit { WALL } cyclic { type cyclic; }", "'solit' fits no patch"),
                                 ("type", "xLow { INLET } wall { WALL } cyclic { type slip; }", "type cyclic in")):
            with self.subTest(name):
                case = self.make("wrong" + name)
                self.boundary(case, text)
                done = harness.program("checkCase", case, check=False)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertIn(says, done.stderr)

    def test_forces_on_groups(self):
        """`patches (wall)` of function objects: a patch of that name, else the group."""
        case = self.make("forces")
        self.replace(case, CONTROL, "functions\n{", "functions\n{\n    named { type forces; patches (xHigh); CofR (0 0 0); }"
                     "\n    group { type forces; patches (wall); CofR (0 0 0); }")
        harness.program("granularGas", "-case", case)
        table = os.listdir(case + "/postProcessing/named/0")[0]
        self.assertEqual(self.rows(case, "named/0/" + table), self.rows(case, "group/0/" + table))

    def test_groups_are_kept(self):
        """processorN/constant/polyMesh/boundary has the groups, too."""
        case = self.make("parts")
        self.replace(case, BOUNDARY, "type wall;", "type wall; inGroups 1(solid);")
        with open(os.path.join(case, CONTROL), "a") as f:
            f.write("writeProcessors yes;\n")
        harness.program("granularGas", "-case", case, ranks=2)
        with open(case + "/processor0/constant/polyMesh/boundary") as f:
            self.assertIn("inGroups        2(solid wall);", f.read())

    def test_default_faces(self):
        """What blockMesh makes of sides that belong to no patch: `empty` ones are taken, others with entries of their own."""
        plain = self.make("sides")
        expected = self.results(plain)
        case = self.make("empty")
        self.replace(case, BOUNDARY, "zEmpty", "defaultFaces")
        self.boundary(case, "xLow { INLET } xHigh { WALL } cyclic { type cyclic; }")
        self.assertEqual([v.replace(b"defaultFaces", b"zEmpty") for v in self.results(case).values()], list(expected.values()))
        for name, text, taken in (("pattern", 'xLow { INLET } ".*" { WALL } cyclic { type cyclic; }', False),
                                  ("own", 'xLow { INLET } defaultFaces { WALL } cyclic { type cyclic; }', True)):
            case = self.make("wall" + name)
            self.replace(case, BOUNDARY, "xHigh", "defaultFaces")
            self.boundary(case, text)
            done = harness.program("checkCase", case, check=False)
            self.assertEqual(done.returncode, 0 if taken else 1, done.stdout + done.stderr)
            if not taken:
                self.assertIn("'defaultFaces' holds 4 faces that belong to no named patch", done.stderr)

    def test_hint(self):
        """For a blockMeshDict whose empty sides are no `empty` patches the message says to make them so; likewise for a wall."""
        for name, gone, says in (("plane", r"    zEmpty.*\n", "defaultPatch { name frontAndBack; type empty; }"),
                                 ("wall", r"    xHigh.*\n", "defaultPatch { name walls; type wall; }")):
            case = self.make("hint" + name)
            shutil.rmtree(case + "/constant/polyMesh")
            self.write(case, "system/blockMeshDict", re.sub(gone, "", BOX))
            self.assertIn(says, harness.program("checkCase", case, check=False).stderr)

    @unittest.skipUnless(shutil.which("blockMesh"), "OpenFOAM is not there")
    def test_block_mesh(self):
        """A plane as OpenFOAM's tutorials have it, by its own blockMesh."""
        case = self.make("blockMesh")
        shutil.rmtree(case + "/constant/polyMesh")
        self.write(case, "system/blockMeshDict", harness.boxes.header("dictionary", "blockMeshDict", "system") + re.sub(r"    zEmpty.*\n", "", BOX))
        subprocess.run(["blockMesh", "-case", case], check=True, capture_output=True, env=FOAM)
        self.boundary(case, "open { INLET } solid { WALL } cyclic { type cyclic; } defaultFaces { type empty; }")
        harness.program("granularGas", "-case", case)


class Thickness(Case):
    def test_thickness(self):
        """meshDict gives a plane its depth, on which force.dat has the forces, as it says."""
        forces = {}
        for depth in (1, 0.25):
            case = self.make(f"depth{depth}")
            self.write(case, "system/meshDict", f"thickness {depth}; patches {{ ends {{ type wall; }} }}\n")
            self.write(case, "mesh.msh", bad_case.MSH2)
            shutil.rmtree(case + "/constant/polyMesh")
            harness.program("gmshToCase", case + "/mesh.msh", "-case", case)
            for name, kind in (("alpha", "uniform 0.2"), ("T", "uniform 25"), ("U", "uniform (0 0 0)")):
                with open(os.path.join(case, "0", name)) as f:
                    head = f.read().split("internalField")[0]
                wall = "slip" if name == "U" else "zeroGradient"
                self.write(case, f"0/{name}", head + f'internalField {kind};\nboundaryField {{ "ends|sides" {{ type {wall}; }} }}\n')
            shutil.rmtree(case + "/constant/shaking", ignore_errors=True)
            self.write(case, CONTROL, bad_case.CONTROL.split("functions")[0] + "functions { ends { type forces; patches (sides); CofR (0 0 0); } }\n")
            harness.program("granularGas", "-case", case)
            with open(case + "/postProcessing/ends/0/force.dat") as f:
                self.assertIn(f"# thickness   : {depth}\n", f.read())
            forces[depth] = float(re.search(r"\(\S+ (\S+)", self.rows(case, "ends/0/force.dat")[-1])[1])
        self.assertNotEqual(forces[1], 0)
        self.assertAlmostEqual(forces[0.25] / forces[1], 0.25, places=12)


if __name__ == "__main__":
    unittest.main()
