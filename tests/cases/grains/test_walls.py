# SPDX-License-Identifier: GPL-3.0-or-later
"""granularMD among walls of any shape: rooms of triangles and tetrahedra, and a lattice with a step."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.grains.test_particles import CONTROL, PROPERTIES, results, solve
from tests.cases.harness import boxes, haff
from tests.cases.runtime.test_forces import columns

from haff.case import grains  # noqa: E402

# A room of 20 x 16 with a disk of radius 3, drawn as a polygon, in it
ROOM = """Point(1) = {0, 0, 0, 2}; Point(2) = {20, 0, 0, 2}; Point(3) = {20, 16, 0, 2}; Point(4) = {0, 16, 0, 2};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Point(5) = {9, 7, 0, 1}; Point(6) = {12, 7, 0, 1}; Point(7) = {6, 7, 0, 1};
Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 6};
Curve Loop(1) = {1:4}; Curve Loop(2) = {5, 6};
Plane Surface(1) = {1, 2};
Physical Curve("walls") = {1:4}; Physical Curve("disk") = {5, 6}; Physical Surface("gas") = {1};
"""
# A funnel: a cylinder of radius 4 on a cone on a cylinder of radius 2
FUNNEL = """SetFactory("OpenCASCADE");
Cone(1) = {0, 0, 0, 0, 4, 0, 2, 4}; Cylinder(2) = {0, 4, 0, 0, 5, 0, 4}; Cylinder(3) = {0, -2, 0, 0, 2, 0, 2};
BooleanUnion(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Mesh.MeshSizeMax = 1.6; Mesh.MeshSizeMin = 1;
Physical Volume("gas") = {4}; Physical Surface("walls") = Surface{:};
"""


# A room with a hole in its right side
HOLE = """Point(1) = {0, 0, 0, 2}; Point(2) = {20, 0, 0, 2}; Point(3) = {20, 16, 0, 2}; Point(4) = {0, 16, 0, 2};
Point(5) = {20, 6, 0, 2}; Point(6) = {20, 10, 0, 2};
Line(1) = {1, 2}; Line(2) = {2, 5}; Line(3) = {5, 6}; Line(4) = {6, 3}; Line(5) = {3, 4}; Line(6) = {4, 1};
Curve Loop(1) = {1:6}; Plane Surface(1) = {1};
Physical Curve("walls") = {1, 2, 4, 5, 6}; Physical Curve("hole") = {3}; Physical Surface("gas") = {1};
"""


def rules(wall, dim):
    return "boundaryField { %s\".*\" { type %s; } }\n" % ('"front|back" { type empty; } ' if dim == 2 else "", wall)


def make(case, geo=None, alpha=0.3, e=1, threshold=0, end=1, interval=1, g=None, more="", particles=None, dim=2, d=0.8):
    """Grains of diameter d and mass 1 at T = 1; the mesh by gmsh, or what the folder has already."""
    os.makedirs(case, exist_ok=True)
    files = {"system/controlDict": ("dictionary", CONTROL.format(end=end, interval=interval, format="binary") + more),
             "constant/granularProperties": ("dictionary", PROPERTIES.format(e=e, threshold=threshold).replace("diameter 1", f"diameter {d}")),
             "0/alpha": ("volScalarField", f"dimensions [0 0 0 0 0 0 0];\ninternalField uniform {alpha};\n" + rules("zeroGradient", dim)),
             "0/T": ("volScalarField", "dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 1;\n" + rules("zeroGradient", dim)),
             "0/U": ("volVectorField", "dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (0 0 0);\n" + rules("slip", dim))}
    if dim == 3:
        files["constant/granularProperties"] = ("dictionary", files["constant/granularProperties"][1].replace("GoldshteinShapiro", "TorquatoSpheres"))
    if particles:
        files["constant/particleProperties"] = ("dictionary", particles)
    if g:
        files["constant/g"] = ("uniformDimensionedVectorField", "dimensions [0 1 -2 0 0 0 0];\nvalue (0 %g 0);\n" % g)
    for path, (kind, text) in files.items():
        folder, name = os.path.split(path)
        os.makedirs(os.path.join(case, folder), exist_ok=True)
        with open(os.path.join(case, path), "w") as f:
            f.write(boxes.header(kind, name, folder) + text)
    if geo:
        with open(os.path.join(case, "mesh.geo"), "w") as f:
            f.write(geo)
        harness.mesh(case, 0, option="unused")
    return case


class Walls(harness.Folder, unittest.TestCase):
    def case(self, name, *arguments, **options):
        return make(os.path.join(self.folder, name), *arguments, **options)

    def test_room(self):
        """Mass and momentum to round-off; the pressure in the middle is that of the equation of state."""
        forces = "functions { force { type forces; patches (walls disk); CofR (0 0 0); } }\n"
        case = self.case("room", ROOM, end=600, interval=600, more=forces, particles="coarseGraining { samples 400; }\n")
        log = solve(case)
        self.assertIn("56 facets", log)
        found, d = haff.Case(case), 0.8
        cloud = grains.read(found, "600")
        alpha, volume = found.field("alpha", "600"), found.volumes / np.ptp(found.mesh.points[:, 2])
        self.assertAlmostEqual(np.sum(alpha * volume), len(cloud["x"]) * np.pi / 4 * d**2, delta=1e-9)
        self.assertGreaterEqual(np.hypot(*(cloud["x"][:, :2] - (9, 7)).T).min(), 3 * np.cos(np.pi / 20) + d / 2 - 1e-12)
        rows = columns(case, "grains", "grains.dat")
        for axis in "xy":
            given = rows[f"impulse_walls_{axis}"] + rows[f"impulse_disk_{axis}"]
            np.testing.assert_allclose(rows[f"momentum_{axis}"] - rows[f"momentum_{axis}"][0], -given, atol=1e-10)
        depth, dt = np.ptp(found.mesh.points[:, 2]), np.diff(rows["Time"])
        force = runs_table(case, "force", "force.dat")
        np.testing.assert_allclose(force[:, 1] * dt / depth, np.diff(rows["impulse_walls_x"] + rows["impulse_disk_x"]), atol=1e-9)
        x = found.centres
        away = np.minimum.reduce([x[:, 0], 20 - x[:, 0], x[:, 1], 16 - x[:, 1], np.hypot(x[:, 0] - 9, x[:, 1] - 7) - 3]) > 2
        nu = np.sum((alpha * volume)[away]) / np.sum(volume[away])
        p = np.sum((found.field("p", "600") * volume)[away]) / np.sum(volume[away])
        henderson = nu / (np.pi / 4 * d**2) * (1 + nu**2 / 8) / (1 - nu)**2  # of T = 1
        self.assertAlmostEqual(p / henderson, 1, delta=0.01)

    def test_restart(self):
        """Stops anywhere leave no trace; another mesh under a saved state is refused."""
        options = {"alpha": 0.4, "e": 0.9, "threshold": 0.01, "g": -0.5, "interval": 1, "particles": "walls { disk { restitution 0.7; } }\n"}
        whole = self.case("whole", ROOM, end=2, **options)
        parts = self.case("parts", ROOM, end=0.3, **options)
        solve(whole)
        for end in (0.3, 1.13, 2):
            harness.edit(parts, "system/controlDict", endTime=end)
            self.assertRegex(solve(parts), r"as time \S+ has them, to the bit\n|put in place")
        for at in ("1", "2"):
            runs.same(self, results(whole, at), results(parts, at), at)
        with open(os.path.join(parts, "mesh.geo"), "w") as f:
            f.write(ROOM.replace("{9, 7,", "{9, 7.1,").replace("{12, 7,", "{12, 7.1,").replace("{6, 7,", "{6, 7.1,"))
        harness.mesh(parts, 0, option="unused")
        harness.edit(parts, "system/controlDict", endTime=3)
        done = harness.program("granularMD", "-case", parts, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("the walls of the mesh have changed since", done.stderr)
        harness.program("caseToVTK", whole)

    def test_kernels(self):
        """Kernels on triangles change no grain; what all cells have is the same, and fields vary less from cell to cell."""
        rho, momentum, spread = {}, {}, {}
        for kernel in ("cell", "Heaviside", "Gaussian"):
            solve(case := self.case(kernel, ROOM, end=1, particles=f"coarseGraining {{ kernel {kernel}; width 1.5; samples 5; }}\n"))
            found = haff.Case(case)
            volume, cell = found.volumes, found.field("rho", "1")
            rho[kernel], spread[kernel] = np.sum(cell * volume), cell.std()
            momentum[kernel] = (found.field("U", "1") * (cell * volume)[:, None]).sum(axis=0)
            np.testing.assert_allclose(rho[kernel], rho["cell"], rtol=1e-11)
            np.testing.assert_allclose(momentum[kernel], momentum["cell"], atol=1e-11 * rho["cell"])
        self.assertLess(max(spread["Heaviside"], spread["Gaussian"]), 0.5 * spread["cell"])

    def test_funnel(self):
        """A dense start among tetrahedra, under gravity and shaken: the grains stay in the funnel."""
        case = self.case("funnel", FUNNEL, alpha=0.5, e=0.8, threshold=0.05, g=-1, end=1, interval=0.5, dim=3)
        with open(os.path.join(case, "constant", "shaking"), "w") as f:
            f.write(boxes.header("dictionary", "shaking", "constant") + "type sinusoidal;\namplitude 2;\nfrequency 1;\n")
        self.assertIn("grown by", solve(case))
        for time in ("0.5", "1"):
            x = grains.read(haff.Case(case), time)["x"]
            r, y = np.hypot(x[:, 0], x[:, 2]), x[:, 1]
            self.assertGreaterEqual(min(y.min() + 2, 9 - y.max()), 0.4 * (1 - 1e-9))
            cone = np.sqrt(0.5**2 + 1)  # radius 2 + y/2
            room = np.where(y < 0, 2 - r, np.where(y > 4, 4 - r, (2 + y / 2 - r) / cone))
            self.assertGreater(room[(y < -0.2) | (y > 0.2)].min(), 0.4 * (1 - 1e-9))

    def test_hole(self):
        """Grains that never meet leave through a hole when straight lines between the walls lead there. Restarts to the bit; momentum and
        energy with what has left."""
        options = {"alpha": 0.01, "end": 20, "interval": 2, "particles": "N 3000;\n", "d": 1e-7}
        case, parts = (self.case(name, HOLE, **options) for name in ("hole", "holeParts"))
        for folder in (case, parts):
            path = os.path.join(folder, "0", "U")
            with open(path) as f:
                text = f.read()
            with open(path, "w") as f:
                f.write(text.replace('".*" {', 'hole { type zeroGradient; } ".*" {'))
        log = solve(case)
        self.assertLess(max(abs(float(b)) for b in re.findall(r"balance (\S+)\)", log)), 1e-13)
        rows = columns(case, "grains", "grains.dat")
        early, late = (grains.read(haff.Case(case), t) for t in ("2", "20"))
        self.assertEqual(rows["collisions"][-1], 0)
        self.assertEqual(3000 - len(late["x"]), rows["left_hole"][-1])
        leaves = [leaves_by_hole(x, u, 18) for x, u in zip(early["x"], early["U"])]
        self.assertGreater(sum(leaves), 100)
        np.testing.assert_array_equal(early["id"][~np.array(leaves)], late["id"])
        for axis in "xy":
            given = rows[f"impulse_walls_{axis}"] + rows[f"impulse_hole_{axis}"]
            np.testing.assert_allclose(rows[f"momentum_{axis}"] - rows[f"momentum_{axis}"][0], -given, atol=1e-9)
        for end in (3.7, 20):
            harness.edit(parts, "system/controlDict", endTime=end)
            solve(parts)
        runs.same(self, results(case, "20"), results(parts, "20"))

    def test_step(self):
        """A lattice with a step: its corner is a wall like the others."""
        case = os.path.join(self.folder, "step")
        at = boxes.centres((8, 8, 1), (16, 16, 1))
        boxes.write_mesh(case, (8, 8, 1), (16, 16, 1), {"x": "wall", "y": "wall"}, hole=np.all(at[:, :2] < 4, axis=1))
        make(case, end=20, interval=20)
        for name in ("alpha", "T", "U"):
            path = os.path.join(case, "0", name)
            with open(path) as f:
                text = f.read().replace("front|back", "zEmpty")
            with open(path, "w") as f:
                f.write(text)
        solve(case)
        x = grains.read(haff.Case(case), "20")["x"][:, :2]
        self.assertGreaterEqual(np.hypot(*np.maximum(x - 4, 0).T)[(x < 4.4).all(axis=1)].min(initial=1), 0.4 - 1e-12)
        self.assertFalse(((x < 4) & (x[:, ::-1] < 4.4 - 1e-12)).all(axis=1).any())

    def test_refused(self):
        case = self.case("refused", ROOM)
        for file, change, text in (
                ("0/U", ("slip", "fixedValue; value uniform (1 0 0)"), r"0/U:\d+: patch walls: type is fixedValue, so that grains come in there, and alpha says not how"),
                ("constant/particleProperties", (None, "coarseGraining { kernel Gaussian; width 30; }\n"), "the width of the kernel is 30 m; it must be positive and at most the box"),
                ("constant/particleProperties", (None, "N 500;\n"), "N 500\n  the grains jam at a packing fraction")):
            wrong = shutil.copytree(case, os.path.join(self.folder, "wrong"))
            path = os.path.join(wrong, file)
            if change[0]:
                with open(path) as f:
                    old = f.read()
                new = old.replace(*change)
            else:
                new = boxes.header("dictionary", os.path.basename(file), "constant") + change[1]
            with open(path, "w") as f:
                f.write(new)
            done = harness.program("granularMD", "-case", wrong, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, text)
            shutil.rmtree(wrong)


def leaves_by_hole(x, u, t):
    """Does a point come to the hole of the room within t? Its way is straight in a room that is mirrored at the walls."""
    at = (20 - x[0]) / u[0] if u[0] > 0 else (20 + x[0]) / -u[0]
    while at < t:
        y = (x[1] + u[1] * at) % 32
        if 6 < min(y, 32 - y) < 10:
            return True
        at += 40 / abs(u[0])
    return False


def runs_table(case, function, file):
    """Rows of numbers of a table with brackets."""
    with open(os.path.join(case, "postProcessing", function, "0", file)) as f:
        return np.array([line.replace("(", " ").replace(")", " ").split() for line in f if not line.startswith("#")], float)


if __name__ == "__main__":
    unittest.main()
