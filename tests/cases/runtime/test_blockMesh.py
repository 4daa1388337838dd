# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from system/blockMeshDict without a polyMesh: OpenFOAM's blockMesh numbers cells and faces as the programs do, runs have
the bits that they have on blockMesh's polyMesh, and what is no union of equal boxes is refused by name."""
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes, haff
from tests.install import outside

FOAM = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}

# A step in a channel: three blocks of cells 1/16 x 1/32 x 1/8; the second has its own axes turned, (y, z, x).
STEP = """
ny 16; half 12;
scale #eval{ 1.0/8 };
vertices
(
    (0 0 0) (6 0 0) (12 0 0) (0 4 0) (6 4 0) (12 4 0) (0 8 0) (6 8 0)
    (0 0 1) (6 0 1) (12 0 1) (0 4 1) (6 4 1) (12 4 1) (0 8 1) (6 8 1)
);
blocks
(
    hex (0 1 4 3 8 9 12 11) ($half $ny 1) simpleGrading (1 1 1)
    hex (1 4 12 9 2 5 13 10) ($ny 1 $half) simpleGrading (1 1 1)
    hex (3 4 7 6 11 12 15 14) rest ($half $ny 1) edgeGrading (1 1 1 1 1 1 1 1 1 1 1 1)
);
edges ();
boundary
(
    outlet { type patch; faces ((2 5 13 10)); }
    inlet  { type patch; faces ((3 11 14 6) (0 8 11 3)); }
    sides  { type empty; faces ((0 3 4 1) (1 2 5 4) (3 6 7 4) (8 9 12 11) (9 12 13 10) (11 12 15 14)); }
);
defaultPatch { name walls; type wall; }
mergePatchPairs ();
"""
BOX = """
vertices ((0 0 0) (2 0 0) (2 1 0) (0 1 0) (0 0 1) (2 0 1) (2 1 1) (0 1 1));
blocks (hex (0 1 2 3 4 5 6 7) (%d %d %d) simpleGrading (1 1 1));
boundary
(
    front { type cyclic; neighbourPatch back; faces ((0 1 5 4)); }
    ends  { type wall; faces ((0 4 7 3) (1 2 6 5)); }
    back  { type cyclic; neighbourPatch front; faces ((3 7 6 2)); }
    floor { type wall; faces ((0 3 2 1)); }
    lid   { type symmetryPlane; faces ((4 5 6 7)); }
);
"""
RULES = {"U": "inlet { type fixedValue; value uniform (1 0 0); } outlet { type zeroGradient; } walls { type slip; }",
         "": 'inlet { type fixedValue; value uniform %s; } "outlet|walls" { type zeroGradient; }'}


def field(case, name, expression, rules, time="0.orig"):
    kind = "Vector" if name == "U" else "Scalar"
    text = f"({' '.join(expression)})" if name == "U" else expression
    path = os.path.join(case, time, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w") as f:
        f.write(boxes.header(f"vol{kind}Field", name, time)
                + f"dimensions {boxes.DIMENSIONS[name]};\nexpression {text};\nboundaryField {{ {rules} }}\n")


def channel(case, mesh=STEP, **options):
    """Gas that streams in and falls, on the step."""
    options = {"e": 0.9, "cooling": "Haff", "gravity": (0.5, -2.0, 0.0), **options}
    boxes.write_case(case, {}, np.ones(1), np.ones((1, 3)), np.ones(1), 0.02, **options)
    shutil.rmtree(os.path.join(case, "0"))
    boxes.write_dictionary(case, "system", "blockMeshDict", mesh)
    runs.add(case, "system/fvSchemes", "divSchemes { } gradSchemes { } laplacianSchemes { }\n")
    field(case, "rho", '"100 + 20*cos(9*x)*sin(7*y)"', (RULES[""] + "sides { type empty; }") % 100)
    field(case, "p", '"100 + 300*pos(0.02 - (x - 0.4)^2 - (y - 0.3)^2)"', (RULES[""] + "sides { type empty; }") % 100)
    field(case, "U", ('"1 + sin(5*y)"', '"0.1*x"', '"0"'), RULES["U"] + "sides { type empty; }")
    return case


def room(case, n=(16, 8, 8)):
    """Cooling gas between walls, periodic along y."""
    boxes.write_case(case, {}, np.ones(1), np.ones((1, 3)), np.ones(1), 0.02, e=0.9, cooling="Haff", gravity=(0.0, 0.0, -3.0))
    shutil.rmtree(os.path.join(case, "0"))
    boxes.write_dictionary(case, "system", "blockMeshDict", BOX % n)
    rules = '"front|back" { type cyclic; } "ends|floor" { type %s; } lid { type symmetryPlane; }'
    field(case, "rho", '"100 + 20*cos(3*x + 2*pi*y)"', rules % "zeroGradient")
    field(case, "p", '"100 + 50*sin(x*z)"', rules % "zeroGradient")
    field(case, "U", ('"sin(3*x)"', '"0.5"', '"-z*(1 - z)"'), rules % "slip")
    return case


def block_mesh(case, unit=2.0**-10):
    """blockMesh's polyMesh, its points rounded to what the dictionary says: multiples of a unit."""
    done = subprocess.run(["blockMesh", "-case", case], capture_output=True, text=True, env=FOAM)
    if done.returncode:
        raise AssertionError(done.stdout + done.stderr)
    folder = os.path.join(case, "constant", "polyMesh")
    points = haff.Mesh(folder).points
    with open(os.path.join(folder, "points"), "wb") as f:
        f.write(boxes.header("vectorField", "points", binary=True).encode() + boxes.raw(np.round(points / unit) * unit, "<f8"))


def openfoam(program, case):
    return subprocess.run([program, "-case", case], capture_output=True, text=True, env=FOAM)


class BlockMesh(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def need(self, program):
        if not shutil.which(program):
            self.skipTest(f"{program} is not installed: apt-get install openfoam")

    def compare(self, make, name, **options):
        """The bits of all that a run writes: from the dictionary on one rank and on three, from the polyMesh on one and on two."""
        self.need("blockMesh")
        one, other = (make(self.path(f"{name}/{kind}/case"), **options) for kind in ("1", "polyMesh"))
        block_mesh(other)
        tables = """functions
            {
                mass { type volFieldValue; fields (rho U); operation volIntegrate; }
                most { type fieldMinMax; fields (T U); }
                cut  { type surfaceFieldValue; regionType sampledSurface; operation areaIntegrate; fields (rho);
                       sampledSurfaceDict { type plane; basePoint (0.3 0.3 0.06); normalVector (1 0.1 0); } }
                line { type sets; fields (rho U); writeControl writeTime; interpolationScheme cellPoint;
                       sets { a { type uniform; axis distance; start (0.1 0.1 0.06); end (0.6 0.4 0.06); nPoints 9; } } }
                flow { type surfaceFieldValue; regionType patch; name PATCH; operation sum; fields (p); }
                push { type forces; patches (PATCH); CofR (0 0 0); }
                vtk  { type vtk; fields (alpha U); writeControl writeTime; }
            }
            """.replace("PATCH", "walls" if make is channel else "floor")
        for case in (one, other):
            runs.add(case, "system/controlDict", tables)
        harness.program("granularGas", "-case", one)
        found = runs.results(one)
        harness.program("granularGas", "-case", other)
        runs.same(self, found, runs.results(other), "the polyMesh")
        for n, polymesh in ((2, True), (3, False)):
            more = make(self.path(f"{name}/{n}/case"), **options)
            if polymesh:
                block_mesh(more)
            runs.add(more, "system/controlDict", tables)
            harness.program("granularGas", "-case", more, ranks=n)
            runs.same(self, found, runs.results(more), f"{n} ranks{', the polyMesh' if polymesh else ''}")
        return one

    def test_a_step_has_the_bits_of_its_polyMesh(self):
        case = self.compare(channel, "step")
        self.assertFalse(os.path.exists(os.path.join(case, "constant", "polyMesh")))
        log = harness.program("granularGas", "-case", case, "-dry-run").stdout
        self.assertRegex(log, r"system/blockMeshDict: 3 blocks, 2\d+ faces")

    def test_a_room_has_the_bits_of_its_polyMesh(self):
        self.compare(room, "room")

    def test_a_run_goes_on_and_is_drawn(self):
        """A restart has the bits of the run that went through; polyhedra, parts of ranks and pictures work on the same file."""
        whole = channel(self.path("through/case"), interval=0.01)
        harness.program("granularGas", "-case", whole)
        half = runs.until(whole, self.path("half"), "0.01")
        harness.program("haffPlot", whole, "rho", "-o", self.path("rho.png"))
        self.assertGreater(os.path.getsize(self.path("rho.png")), 5000)
        harness.program("granularGas", "-case", half, ranks=3)
        runs.same(self, runs.contents(os.path.join(whole, "0.02")), runs.contents(os.path.join(half, "0.02")))
        poly = channel(self.path("poly/case"), meshEngine="polyhedral")
        harness.edit(poly, "system/fvSchemes", reconstruct="PHM; meshEngine polyhedral; polyReconstruct CWENO3")
        runs.add(poly, "system/controlDict", "writeProcessors yes;\n")
        harness.program("granularGas", "-case", poly, ranks=2)
        rho, other = (haff.Case(case).field("rho", "0.02") for case in (whole, poly))
        self.assertLess(np.abs(rho - other).mean(), 0.02 * rho.mean())
        self.assertTrue(os.path.exists(os.path.join(poly, "processor0", "constant", "polyMesh", "owner")))

    def test_openfoam_reads_what_is_written(self):
        """Fields written without a polyMesh belong to the cells of the one that blockMesh makes, and checkMesh accepts it."""
        self.need("blockMesh")
        case = channel(self.path("foam"))
        harness.program("granularGas", "-case", case)
        harness.program("caseToVTK", case)
        block_mesh(case)
        said = openfoam("checkMesh", case).stdout
        self.assertIn("Mesh OK.", said)
        kinds = {name: kind for name, (kind, _, _) in haff.Mesh(os.path.join(case, "constant", "polyMesh")).patches.items()}
        self.assertEqual(list(kinds.items()), [("outlet", "patch"), ("inlet", "patch"), ("sides", "empty"), ("walls", "wall")])
        done = openfoam("foamToVTK", case)
        self.assertEqual(done.returncode, 0, done.stdout[-500:] + done.stderr[-500:])
        read = haff.Case(case)
        x, y = read.centres[:, 0], read.centres[:, 1]
        self.assertLess(np.abs(read.field("rho", "0") - (100 + 20 * np.cos(9 * x) * np.sin(7 * y))).max(), 1e-11)

    def test_a_list_of_a_patch_has_blockMesh_s_order(self):
        """Values of a patch that follow an expression are written face by face as blockMesh numbers them, at sides of both turns."""
        self.need("blockMesh")
        case = room(self.path("list"))
        walls = 'ends { type fixedValue; value uniform 0; expression "sin(5*y) + 7*x*z"; } floor { type zeroGradient; }'
        boxes.write_dictionary(case, "constant", "granularProperties", boxes.PROPERTIES.format(**{**boxes.STANDARD, "e": 0.9}))
        harness.edit(case, "constant/granularProperties", transport="GarzoDufty", equationOfState="TorquatoSpheres")
        field(case, "T", '"2"', walls.replace("sin", "9 + sin") + ' "front|back" { type cyclic; } lid { type symmetryPlane; }')
        os.remove(os.path.join(case, "0.orig", "p"))
        field(case, "U", ('"0"', '"0"', '"0"'), '"ends|floor" { type noSlip; } "front|back" { type cyclic; } lid { type symmetryPlane; }')
        harness.program("initialFields", case)
        found = haff.Case(case).patch_values("T", "ends", "0")
        block_mesh(case)
        mesh = haff.Case(case).mesh
        _, first, count = mesh.patches["ends"]
        x, y, z = mesh.face_geometry(first, first + count)[0].T
        self.assertEqual(len(found), count)
        self.assertLess(np.abs(found - (9 + np.sin(5 * y) + 7 * x * z)).max(), 1e-12)

    def test_both_are_there(self):
        """The polyMesh counts; a dictionary that was changed after it is warned of."""
        self.need("blockMesh")
        case = channel(self.path("both"))
        block_mesh(case)
        boundary, said = (os.path.join(case, *path) for path in (("constant", "polyMesh", "boundary"), ("system", "blockMeshDict")))
        os.utime(said, (1e9, 1e9))
        done = harness.program("checkCase", case)
        self.assertNotIn("oldMesh", done.stdout)
        self.assertRegex(done.stdout, r"Mesh\n +\d+ points")
        os.utime(boundary, (1e9, 1e9))
        os.utime(said, (1e9 + 1, 1e9 + 1))
        self.assertRegex(harness.program("checkCase", case).stdout, r"warning: .*blockMeshDict: it was changed after .*\[oldMesh\]")
        self.assertEqual(harness.program("checkCase", case, "-strict", check=False).returncode, 1)

    def test_other_programs_read_it(self):
        """Each program on its example in the reference: sound as it is, and with the bits of blockMesh's polyMesh."""
        self.need("blockMesh")
        for name, program, changes in (("gas", "granularGas", {"endTime": 1e-4, "writeInterval": 1e-4}),
                                       ("grains", "granularMD", {"endTime": 0.002, "writeInterval": 0.002}),
                                       ("segregation", "granularSegregation", {"endTime": 0.1, "writeInterval": 0.1})):
            with self.subTest(program):
                found = []
                for mesh in ("dictionary", "polyMesh"):
                    case = self.path(f"{program}/{mesh}/case")
                    shutil.copytree(os.path.join(harness.SOURCE, "docs", "examples", name), case)
                    self.assertIn("The case is sound.", harness.program("checkCase", case).stdout)
                    path = os.path.join(case, "system", "blockMeshDict")
                    with open(path) as f:  # sizes that binary numbers hold
                        text = f.read().replace("scale 0.04;", "scale 0.0390625;")
                    with open(path, "w") as f:
                        f.write(text.replace("(40 20 1)", "(16 8 1)"))
                    harness.edit(case, "system/controlDict", **changes)
                    if mesh == "polyMesh":
                        block_mesh(case, 2.0**-16)
                    harness.program(program, "-case", case)
                    found.append(runs.results(case))
                runs.same(self, *found)


def peak(*command):
    """Bytes that a program has at most."""
    with open(os.devnull, "w") as nowhere:
        started = subprocess.Popen(command, stdout=nowhere)
        _, code, used = os.wait4(started.pid, 0)
    if code:
        raise AssertionError(f"{command}: exit code {code}")
    return used.ru_maxrss * 1024


@unittest.skipIf(outside.INSTALLS and outside.cached("HAFF_SANITIZE") == "ON", "sanitizers keep memory of their own")
class Memory(harness.Folder, unittest.TestCase):
    """What a cell takes, as the difference of two runs of which one has more cells: start, two steps, writing, restart."""

    def bytes_a_cell(self, name, sizes, make):
        most = []
        for n in sizes:
            case = make(os.path.join(self.folder, f"{name}{n}"), n)
            runs.add(case, "system/controlDict", "stopAt nextWrite; writeControl timeStep; writeInterval 2;\n")
            command = (os.path.join(harness.BIN, "granularGas"), "-case", case)
            most.append([peak(*command), peak(*command)])
        cells = [n**2 if name == "flat" else n**3 for n in sizes]
        return max((b - a) / (cells[1] - cells[0]) for a, b in zip(*most))

    @staticmethod
    def square(case, n):
        text = """vertices ((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 1) (1 0 1) (1 1 1) (0 1 1));
            blocks (hex (0 1 2 3 4 5 6 7) (%d %d 1) simpleGrading (1 1 1));
            boundary
            (
                inlet { type patch; faces ((0 4 7 3)); } outlet { type patch; faces ((1 2 6 5)); }
                walls { type wall; faces ((0 1 5 4) (3 7 6 2)); } sides { type empty; faces ((0 3 2 1) (4 5 6 7)); }
            );"""
        return channel(case, text % (n, n))

    def test_two_dimensions(self):
        self.assertLess(self.bytes_a_cell("flat", (240, 720), self.square), 311)

    def test_three_dimensions(self):
        self.assertLess(self.bytes_a_cell("solid", (24, 72), lambda case, n: room(case, (n, n, n))), 560)


class Refusals(harness.Folder, unittest.TestCase):
    """What is wrong is said with file, line and cure, and nothing is run."""
    # an entry, what is put in its place, and what is said of it: LINE is the line of the change
    ROWS = (
        ("simpleGrading (1 1 1)", "simpleGrading (1 2 1)", r":LINE: found '2'; all cells must be equal.*blockMesh makes a constant/polyMesh"),
        ("edgeGrading (1 1", "edgeGrading (1 3", r":LINE: found '3'; all cells"),
        ("($half $ny 1) edge", "($half 8 1) edge",
         r":LINE\n +block 2: 8 cells along y are 0.0625 m long, those of block 0 0.03125 m; .* give it 16 cells there"),
        ("8 9 12 11) ($half", "8 9 11 12) ($half", r":LINE\n +block 0: vertex 11 is no corner of a box along the axes"),
        ("hex (0 1 4 3 8 9 12 11)", "hex (3 4 1 0 11 12 9 8)", r":LINE\n +block 0: it is inside out; the vertices of a hex go round its floor"),
        ("hex (0 1 4 3", "hex (0 1 4 33", r":LINE: found '33'; vertices of a hex: whole numbers from 0 to 15, 8 of them"),
        ("hex (3", "prism (3", r":LINE: found 'prism'; blocks are  hex"),
        ("($half $ny 1) simple", "($half 0 1) simple", r":LINE: found '0'; cells along the edges"),
        ("edges ();", "edges (arc 0 1 (0.1 0.1 0));", r":LINE: found 'arc'; edges are not read: .*blockMesh makes"),
        ("mergePatchPairs ();", "mergePatchPairs ((inlet outlet));", r":LINE: found '\('; mergePatchPairs are not read"),
        ("(2 5 13 10)); }", "(2 5 13 10) (1 4 12 9)); }", r"patch 'outlet': the side \(1 4 12 9\) lies inside, between blocks 0 and 1"),
        ("(2 5 13 10)); }", "(2 5 13 11)); }", r"patch 'outlet': \(2 5 13 11\) are not the vertices of a side of a block"),
        ("(2 5 13 10)); }", "(2 5 13)); }", r":LINE: found '\)'; vertices of a face: whole numbers from 0 to 15, 4 of them"),
        ("type empty", "type wedge", r":LINE: key 'type' is wedge; allowed are: patch, wall, empty, symmetry, symmetryPlane, cyclic"),
        ("defaultPatch { name walls; type wall; }", "", r"'boundary' .* it leaves 64 faces to no patch .* defaultPatch \{"),
        ("name walls", "name inlet", r":LINE: key 'name' is inlet; `boundary` has a patch of that name, too"),
        ("edges ();", "edgs ();", r":LINE: keyword 'edgs' is not used; did you mean 'edges'"),
        ("scale #eval{ 1.0/8 };", "scale 0;", r":LINE: key 'scale' is 0; it must be above 0"),
        ("scale #eval{ 1.0/8 };", "scale 1e-300;", r"key 'vertices' .* all lie within 1e-60 m"),
        ("outlet { type patch;", "outlet { type cyclic; neighbourPatch inlet;", r"patch 'outlet': its neighbourPatch 'inlet' is no cyclic patch"),
    )

    def test_rows(self):
        case = channel(os.path.join(self.folder, "case"))
        path = os.path.join(case, "system", "blockMeshDict")
        for old, new, wanted in self.ROWS:
            with self.subTest(new):
                self.assertEqual(STEP.count(old) if "Grading (1 1 1)" not in old else 1, 1)
                boxes.write_dictionary(case, "system", "blockMeshDict", STEP.replace(old, new, 1))
                with open(path) as f:
                    line = f.read().split(new or "defaultPatch", 1)[0].count("\n") + 1
                done = harness.program("granularGas", "-case", case, check=False)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertRegex(done.stderr, "blockMeshDict" * (wanted[0] == ":") + wanted.replace("LINE", str(line)))
        self.assertEqual([name for name in os.listdir(case) if name[0].isdigit()], ["0.orig"])

    def test_neither_is_there(self):
        case = channel(os.path.join(self.folder, "none"))
        os.remove(os.path.join(case, "system", "blockMeshDict"))
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertRegex(done.stderr, "no mesh; make it with  gmshToCase .* or give system/blockMeshDict")
