# SPDX-License-Identifier: GPL-3.0-or-later
"""gmshToCase on gmsh's own files in all four formats: OpenFOAM's checkMesh accepts the result, and gmshToFoam makes the
same mesh up to ordering of the same ascii file."""
import itertools
import math
import os
import re
import shutil
import subprocess
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
BIN = os.environ["HAFF_BIN"]
FOAM = dict(os.environ, WM_PROJECT_DIR=os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam"))
FORMATS = [("msh22", []), ("msh22", ["-bin"]), ("msh41", []), ("msh41", ["-bin"])]


def run(*command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)


def numbers(text):
    return [float(x) for x in re.findall(r"[-+0-9.eE]+", text)]


def body(folder, name):
    with open(os.path.join(folder, name)) as f:
        text = re.sub(r"//.*|/\*.*?\*/", "", f.read())
    return text[text.index("}") + 1:]


class Mesh:
    """An ascii polyMesh, read independently of the C reader."""

    def __init__(self, case):
        folder = os.path.join(case, "constant", "polyMesh")
        v = numbers(body(folder, "points"))[1:]
        self.points = [tuple(v[i:i + 3]) for i in range(0, len(v), 3)]
        self.faces = [[int(x) for x in f.split()] for f in re.findall(r"\d+\(([\d ]+)\)", body(folder, "faces"))]
        self.owner = [int(x) for x in numbers(body(folder, "owner"))[1:]]
        self.neighbour = [int(x) for x in numbers(body(folder, "neighbour"))[1:]]
        self.patches = {}
        for name, entry in re.findall(r"([\w.-]+)\s*\{(.*?)\}", body(folder, "boundary"), re.S):
            entry = dict(re.findall(r"(\w+)\s+(.*?);", entry))
            self.patches[name] = (entry["type"], int(entry["startFace"]), int(entry["nFaces"]))
        self.ncells = max(self.owner + self.neighbour) + 1

    def number_like(self, other):
        """Renames the points by those of another mesh at the same places, to its 10 written digits."""
        bins = {}
        for i, p in enumerate(other.points):
            bins.setdefault(tuple(round(x * 1e4) for x in p), []).append(i)
        new = []
        for p in self.points:
            near = itertools.product(*[(math.floor(x * 1e4), math.floor(x * 1e4) + 1) for x in p])
            new.append([i for key in near for i in bins.get(key, []) if math.dist(p, other.points[i]) < 4e-9])
        if any(len(found) != 1 for found in new) or len({found[0] for found in new}) != len(other.points):
            raise AssertionError("the points differ")
        self.faces = [[new[p][0] for p in face] for face in self.faces]

    def face_key(self, f):
        return tuple(sorted(self.faces[f]))

    def cells(self):
        """Every cell as the set of its points, sorted: equal for equal meshes whatever the order."""
        sets = [set() for _ in range(self.ncells)]
        for cells in (self.owner, self.neighbour):
            for f, c in enumerate(cells):
                sets[c].update(self.faces[f])
        return sorted(tuple(sorted(s)) for s in sets)

    def area(self, f):
        p = [self.points[i] for i in self.faces[f]]
        total = [0.0, 0.0, 0.0]
        for a, b in zip(p[1:], p[2:]):
            u, v = [a[k] - p[0][k] for k in range(3)], [b[k] - p[0][k] for k in range(3)]
            for k in range(3):
                total[k] += 0.5 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3])
        return math.sqrt(sum(x * x for x in total))


@unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed: apt-get install gmsh")
class GmshToCase(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def gmsh(self, geo, dim, fmt="msh41", options=(), **constants):
        path = os.path.join(self.folder, "mesh.msh")
        sets = [x for name, value in constants.items() for x in ("-setnumber", name, str(value))]
        result = run("gmsh", "-%d" % dim, *sets, "-format", fmt, *options, os.path.join(HERE, geo), "-o", path)
        self.assertEqual(result.returncode, 0, result.stdout)
        return path

    def case(self, name="case"):
        case = os.path.join(self.folder, name)
        shutil.rmtree(case, ignore_errors=True)
        os.makedirs(os.path.join(case, "system"))
        contents = {"controlDict": "application haff; startFrom startTime; startTime 0; stopAt endTime; endTime 1; "
                                   "deltaT 1; writeControl timeStep; writeInterval 1;",
                    "fvSchemes": "divSchemes{} gradSchemes{} laplacianSchemes{}", "fvSolution": ""}
        for file, text in contents.items():
            with open(os.path.join(case, "system", file), "w") as f:
                f.write("FoamFile { version 2.0; format ascii; class dictionary; object %s; }\n%s\n" % (file, text))
        return case

    def convert(self, mesh, case, *options, code=0):
        result = run(os.path.join(BIN, "gmshToCase"), mesh, "-case", case, *options)
        self.assertEqual(result.returncode, code, result.stdout)
        return result.stdout

    def check(self, case):
        if not shutil.which("checkMesh"):
            self.skipTest("checkMesh is not installed: apt-get install openfoam")
        result = run("checkMesh", "-case", case, env=FOAM)
        self.assertIn("Mesh OK.", result.stdout)
        return result.stdout

    def test_step(self):
        for fmt, options in FORMATS:
            with self.subTest(fmt=fmt, options=options):
                case = self.case()
                said = self.convert(self.gmsh("step.geo", 2, fmt, options), case)
                self.assertIn("300 hexahedra", said)
                self.assertIn("lattice  yes: 2D, 20 x 20", said)
                mesh = Mesh(case)
                self.assertEqual({n: p[0::2] for n, p in mesh.patches.items()},
                                 {"inlet": ("patch", 20), "wallStep": ("wall", 20), "outlet": ("patch", 10),
                                  "bottom": ("patch", 10), "top": ("patch", 20), "back": ("empty", 300),
                                  "front": ("empty", 300)})
                self.assertIn("2 solution (non-empty) directions (1 1 0)", self.check(case))
                self.assertTrue(os.path.exists(os.path.join(case, "case.foam")))

    def test_write_formats(self):
        mesh = self.gmsh("step.geo", 2)
        for options in (["-binary"], ["-binary", "-compress"], ["-ascii", "-compress"], ["-ascii"]):
            with self.subTest(options=options):
                case = self.case()
                self.convert(mesh, case, *options)
                self.check(case)

    def test_triangles(self):
        case = self.case()
        said = self.convert(self.gmsh("step.geo", 2, T=1), case)
        self.assertRegex(said, r"lattice  no: cell \d+ at \(.*\) is no box")
        self.check(case)

    def test_3d_is_the_mesh_of_gmshToFoam(self):
        shapes = {0: {"prisms", "hexahedra"}, 1: {"tetrahedra"}, 2: {"tetrahedra", "pyramids", "hexahedra"}}
        for m, expected in shapes.items():
            for fmt, options in FORMATS:
                with self.subTest(M=m, fmt=fmt, options=options):
                    case = self.case()
                    path = self.gmsh("mixed.geo", 3, fmt, options, M=m)
                    said = self.convert(path, case)
                    self.assertEqual(set(re.findall("tetrahedra|pyramids|prisms|hexahedra|polyhedra", said)), expected)
                    self.check(case)
                    if not options:
                        self.compare_with_gmshToFoam(path, Mesh(case))

    def compare_with_gmshToFoam(self, path, ours):
        other = self.case("other")
        result = run("gmshToFoam", "-case", other, path, env=FOAM)
        self.assertEqual(result.returncode, 0, result.stdout)
        theirs = Mesh(other)
        areas = [theirs.area(f) for f in range(len(theirs.faces))]
        theirs.number_like(ours)
        self.assertEqual(len(ours.faces), len(theirs.faces))
        self.assertEqual(ours.cells(), theirs.cells())
        theirs.patches.pop("defaultFaces", None)
        self.assertEqual(set(ours.patches), set(theirs.patches))
        for name, (_, start, n) in ours.patches.items():
            _, their_start, their_n = theirs.patches[name]
            mine, other_faces = range(start, start + n), range(their_start, their_start + their_n)
            self.assertEqual(sorted(map(ours.face_key, mine)), sorted(map(theirs.face_key, other_faces)))
            self.assertAlmostEqual(sum(map(ours.area, mine)), sum(areas[f] for f in other_faces), places=7)

    def test_mesh_dict(self):
        case, mesh = self.case(), self.gmsh("periodic.geo", 2)
        path = os.path.join(case, "system", "meshDict")

        def convert(rules, code=0):
            with open(path, "w") as f:
                f.write("patches\n{\n%s\n}\n" % rules)
            return self.convert(mesh, case, code=code)

        half = "left { type cyclic; neighbourPatch right; }\nright { type cyclic; neighbourPatch left; }\n"
        convert(half + "top { type symmetryPlane; }")
        self.assertEqual({n: p[0] for n, p in Mesh(case).patches.items()},
                         {"bottom": "patch", "right": "cyclic", "top": "symmetryPlane", "left": "cyclic",
                          "back": "empty", "front": "empty"})
        self.assertIn("Coupled point location match (average 0) OK.", self.check(case))
        for rules, says in (("top { type symetry; }", "meshDict:3: type 'symetry' of patch 'top'; allowed are"),
                            ("tpo { type wall; }", "meshDict:3: the mesh has no patch 'tpo'"),
                            ("top { typ wall; }", "type"),
                            ("top { type wall; colour red; }", "'colour' is not used"),
                            (half.replace("left", "top"), "cyclic patch 'right' has 7 faces and 'top' has 10")):
            with self.subTest(rules=rules):
                self.assertIn(says, convert(rules, code=1))

    def test_names_of_walls(self):
        """A patch that sounds like a wall and is none is noted with the cure, unless meshDict says what it is."""
        mesh, case = self.gmsh("step.geo", 2, "msh22"), self.case()
        with open(mesh) as f:
            text = f.read()
        with open(mesh, "w") as f:
            f.write(text.replace('"wallStep"', '"Wall_step"').replace('"bottom"', '"floor"'))
        said = self.convert(mesh, case)
        for name in ("Wall_step", "floor"):
            self.assertEqual(Mesh(case).patches[name][0], "patch")
            self.assertRegex(said, r"note +patch %s sounds like a wall, .* patches \{ %s \{ type wall; \} \}" % (name, name))
        self.assertEqual(said.count("note "), 2)
        with open(os.path.join(case, "system", "meshDict"), "w") as f:
            f.write("patches { Wall_step { type wall; } floor { type patch; } }\n")
        self.assertNotIn("note ", self.convert(mesh, case))
        self.assertEqual(Mesh(case).patches["Wall_step"][0], "wall")

    def test_errors_leave_the_old_mesh(self):
        case = self.case()
        good = self.gmsh("step.geo", 2)
        self.convert(good, case)
        before = body(os.path.join(case, "constant", "polyMesh"), "points")
        with open(good, "rb") as f:
            data = f.read()
        with open(good, "wb") as f:
            f.write(data[:len(data) // 2])
        self.assertIn("mesh.msh", self.convert(good, case, code=1))
        self.assertEqual(body(os.path.join(case, "constant", "polyMesh"), "points"), before)
        self.assertIn("no such folder", self.convert(good, case + "/missing", code=1))
        self.assertIn("-bnary", self.convert(good, case, "-bnary", code=1))

    def test_two_layers_are_refused(self):
        geo = os.path.join(self.folder, "two.geo")
        with open(os.path.join(HERE, "step.geo")) as f:
            text = f.read().split("Physical")[0]
        with open(geo, "w") as f:
            f.write(text + "a[] = Extrude {0, 0, 0.1} { Surface{1}; Layers{2}; Recombine; };\n"
                    'Physical Volume("gas") = {a[1]}; Physical Surface("emptyBack") = {1};\n'
                    'Physical Surface("emptyFront") = {a[0]}; Physical Surface("rest") = {a[2], a[3], a[4], a[5]};\n')
        said = self.convert(self.gmsh(geo, 3), self.case(), code=1)
        self.assertIn("Layers{1}", said)
        self.assertIn("cell 0 at (", said)


if __name__ == "__main__":
    unittest.main()
