# SPDX-License-Identifier: GPL-3.0-or-later
"""granularDEM through the real program, with LAMMPS: single impacts beside an independent integration, rolling, energy, restarts to the
bit, joints of walls, walls of triangles, fields against grains and contacts, errors. Without lmp all is skipped but the errors of the case."""
import os
import re
import shutil
import subprocess
import sys
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.grains import test_particles as hard
from tests.cases.grains import test_walls as rooms
from tests.cases.harness import boxes

from haff.case import grains  # noqa: E402

LAMMPS = shutil.which("lmp")
MISSING = "the program lmp is not installed (Debian: apt-get install lammps)"
D = 1e-3
RHO = 2600.0
MASS = RHO * np.pi / 6 * D**3
E, NU, A = 5e9, 0.3, 5e-8
STIFF = E / (2 * (1 - NU**2))
VISCOUS = f"type hertz; youngsModulus {E}; poissonsRatio {NU}; dissipation {A};"
WALLS = {"x": "cyclic", "y": "wall", "z": "cyclic"}

HOPPER = """Point(1) = {0, 0, 0, 2}; Point(2) = {4, 0, 0, 2}; Point(3) = {10, 8, 0, 2}; Point(4) = {10, 16, 0, 2}; Point(5) = {-6, 16, 0, 2}; Point(6) = {-6, 8, 0, 2};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1:6}; Plane Surface(1) = {1};
Physical Curve("walls") = {1:6}; Physical Surface("gas") = {1};
"""


def make(case, contact, cells=(8, 8, 8), size=(8e-3, 8e-3, 8e-3), wall="slip", positions=None, U=None, spin=None, more="", **options):
    """Spheres of 1 mm in a box; walls at the ends of axes that are not cyclic."""
    options = {"types": WALLS, "alpha": 0.01, "T": 0, "e": 1, "format": "ascii", **options}
    hard.make(case, cells=cells, size=size, particles=f"contact {{ {contact} }}\n{more}", **options)
    harness.edit(case, "system/controlDict", application="granularDEM")
    harness.edit(case, "constant/granularProperties", grain=f"{{ diameter {D}; mass {MASS:.17g}; restitution {options['e']}; }}")
    if wall != "slip":
        path = os.path.join(case, "0", "U")
        with open(path) as f:
            text = f.read().replace("type slip", f"type {wall}")
        with open(path, "w") as f:
            f.write(text)
    if positions is not None:
        hard.cloud(case, [(*x, 0) for x in positions], [tuple(u) for u in U])
        if spin is not None:
            with open(os.path.join(case, "0", "lagrangian", "grains", "omega"), "w") as f:
                f.write(boxes.header("vectorField", "omega", "0/lagrangian/grains") + f"{len(spin)}\n(\n" + "\n".join("(%.17g %.17g %.17g)" % tuple(w) for w in spin) + "\n)\n")
    return case


def solve(case, *more):
    return harness.program("granularDEM", "-case", case, *more).stdout


def end(case, time):
    cloud = grains.read(harness.haff.Case(case), time)
    order = np.argsort(cloud["id"])
    return {key: value[order] for key, value in cloud.items()}


def table(case):
    """Rows of grains.dat, and the column of each title."""
    path = os.path.join(case, "postProcessing", "grains", "0", "grains.dat")
    with open(path) as f:
        names = [line for line in f if line.startswith("# Time")][0].split()[1:]
    return np.loadtxt(path), {name: i for i, name in enumerate(names)}


def duration(radius, mass, speed):
    return 2.87 * (mass**2 / (radius * STIFF**2 * speed)) ** 0.2


def restitution(radius, mass, speed, steps=4000):
    """e of a viscoelastic impact, by the classical Runge-Kutta scheme for the overlap."""
    K = 4 / 3 * STIFF * np.sqrt(radius)

    def rate(y):
        d = max(y[0], 0.0)
        return np.array([y[1], -K * (d**1.5 + 1.5 * A * np.sqrt(d) * y[1]) / mass])
    h, y = duration(radius, mass, speed) / steps, np.array([0.0, speed])
    while True:
        k1 = rate(y)
        k2 = rate(y + h / 2 * k1)
        k3 = rate(y + h / 2 * k2)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3))
        if y[0] <= 0:
            return -y[1] / speed


# A room with a floor and a lid that are no rectangles
PRISM = """Point(1) = {0, 0, 0, 4}; Point(2) = {10, 0, 0, 4}; Point(3) = {0, 0, 10, 4};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 1};
Curve Loop(1) = {1:3}; Plane Surface(1) = {1};
all[] = Extrude {0, 8, 0} { Surface{1}; };
Physical Surface("floor") = {1}; Physical Surface("lid") = {all[0]}; Physical Surface("sides") = {all[2], all[3], all[4]}; Physical Volume("gas") = {all[1]};
"""
# Stands for a LAMMPS with fix surface/global, which no package has: it runs the LAMMPS that is installed, and replaces that fix by the planes of PRISM.
STAND_IN = """#!{python}
import subprocess, sys
if sys.argv[1] == "-h":
    print("Large-scale Atomic/Molecular Massively Parallel Simulator - 4 Jul 2026\\n\\ngranular  wall/gran  wall/gran/region  {style}")
    sys.exit()
child = subprocess.Popen(["{lammps}", *sys.argv[1:]], stdin=subprocess.PIPE, text=True, bufsize=1)
fix = ""
for line in iter(sys.stdin.readline, ""):
    if fix or line.startswith("fix surface "):
        fix += line
        if line.endswith("&\\n"):
            continue
        law = fix.split(" granular ")[1].split(" &")[0].strip()
        planes = ("0 0 0 0 1 0", "0 8 0 0 -1 0", "0 0 0 1 0 0", "0 0 0 0 0 1", "10 0 0 -1 0 -1")
        line = "".join(f"region plane{{i}} plane {{p}} units box\\n" for i, p in enumerate(planes))
        line += "region room intersect 5 plane0 plane1 plane2 plane3 plane4\\nfix surface all wall/gran/region granular " + law + " region room\\n"
        fix = ""
    child.stdin.write(line)
child.stdin.close()
sys.exit(child.wait())
"""


class Triangles(harness.Folder, unittest.TestCase):
    """Walls that are no rectangles, by fix surface/global of LAMMPS: the commands as its documentation has them (4 Jul 2026)."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.room = os.path.join(cls.folder, "room")
        rooms.make(cls.room, PRISM, dim=3, end=1, interval=0.5, g=-1, particles="contact { type linear; stiffness 1e4; restitution 0.3; friction 0.5; impactSpeed 0.1; }\nwalls { lid { friction 0.4; } }\n")
        harness.edit(cls.room, "system/controlDict", application="granularDEM")
        hard.cloud(cls.room, [(3, 0.4, 3, 0)], [(0, 0, 0)])

    def prism(self, name, style="surface/global", U=None):
        case = shutil.copytree(self.room, os.path.join(self.folder, name))
        if U:
            harness.edit(case, "0/U", boundaryField="{ " + U + ' ".*" { type slip; } }')
        programs = os.path.join(self.folder, f"programs {name}")
        os.makedirs(programs)
        with open(os.path.join(programs, "lmp"), "w") as f:
            f.write(STAND_IN.format(python=sys.executable, lammps=LAMMPS, style=style))
        os.chmod(f.name, 0o755)
        path = os.environ["PATH"]
        os.environ["PATH"] = programs + os.pathsep + path
        try:
            done = harness.program("granularDEM", "-case", case, check=False)
        finally:
            os.environ["PATH"] = path
        return case, done

    def test_refused(self):
        _, done = self.prism("refused", style="")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"patch floor: a flat wall is no rectangle; .* Other walls need fix surface/global of LAMMPS \(package GRANSURF, in 4 Jul 2026 and later\), which this lmp \(4 Jul 2026\) lacks")

        for name, U, said in (("moves", "lid { type translatingWallVelocity; U (1 0 0); }", "patch lid: it moves, and walls of the mesh are no rectangles"),
                              ("leans", "sides { type zeroGradient; }", "patch sides: grains leave there, and it lies on no side of the box around the mesh")):
            _, done = self.prism(name, U=U)
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr)

    @unittest.skipUnless(LAMMPS, MISSING)
    def test_commands(self):
        case, done = self.prism("commands")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"lid +triangles, friction 0.4\n")
        with open(os.path.join(case, "dem", "in.lammps")) as f:
            text = f.read()
        loss = -np.log(0.3)
        damper = 2 * loss * np.sqrt(1e4 / (np.pi**2 + loss**2))
        found = text[text.index("fix before"):text.index("variable gravity")].splitlines()
        names = ("floor", "lid", "sides")
        order = sorted(names, key=list(harness.haff.Case(case).mesh.patches).index)
        self.assertEqual(found[:2], ["fix before all store/force", "fix surface all surface/global &"])
        self.assertEqual(found[2:5], [f'    input stl {i + 1} 1 "{case}/dem/wall{i}.stl" &' for i in range(3)])
        for i, line in enumerate(found[5:8]):
            tangent = "linear_history 2857.142857 0 0.40000000000000002" if order[i] == "lid" else "linear_nohistory 0 0"
            words = re.sub(r"(2857\.142857)\d*", r"\1", line).split(" ")
            self.assertAlmostEqual(float(words.pop(10)), damper, delta=1e-9 * damper)
            self.assertEqual(" ".join(words), f"    model 1 {i + 1} granular hooke 10000 tangential {tangent} damping velocity{' &' if i < 2 else ''}")
        self.assertEqual(found[8:], ["fix after all store/force"])
        self.triangles(case, order)
        self.forces(case)

    def triangles(self, case, order):
        """The files have the area of the patches, and together they are closed: corners that triangles share have the same text."""
        areas, sides = {"floor": 50, "lid": 50, "sides": 8 * (20 + 10 * np.sqrt(2))}, {}
        for i, name in enumerate(order):
            with open(os.path.join(case, "dem", f"wall{i}.stl")) as f:
                corners = [line.split()[1:] for line in f if line.startswith("vertex")]
            x = np.array(corners, dtype=float).reshape(-1, 3, 3)
            self.assertAlmostEqual(np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1).sum() / 2, areas[name], delta=1e-9)
            for j in range(0, len(corners), 3):
                for a, b in ((0, 1), (1, 2), (2, 0)):
                    key = tuple(sorted((tuple(corners[j + a]), tuple(corners[j + b]))))
                    sides[key] = sides.get(key, 0) + 1
        self.assertEqual(set(sides.values()), {2})

    def forces(self, case):
        """A grain at rest presses on the floor with its weight, which fix store/force gives, and bends the spring of that contact."""
        rows, column = table(case)
        last = rows[-1]
        for name, i in column.items():
            if name.startswith("force"):
                self.assertAlmostEqual(last[i], -1 if "floor_y" in name else 0, delta=1e-6, msg=name)
        self.assertEqual(last[column["contacts"]], 1)
        self.assertAlmostEqual(last[column["normalSpring"]], 0.5 / 1e4, delta=1e-9)


@unittest.skipUnless(LAMMPS, MISSING)
class Impacts(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def head_on(self, name, contact, impacts, more=""):
        """e of pairs, and of spheres on the wall yLow or yHigh, all in one run. impacts: (kind, speed)."""
        speeds = [speed for _, speed in impacts]
        time = duration(D / 2, MASS, min(speeds))
        if "stiffness" in contact:
            time = np.pi * np.sqrt(MASS / float(re.search(r"stiffness ([\d.e]+)", contact)[1]))
        stop, x, u = float("%.6g" % (2 * time)), [], []
        for k, (kind, speed) in enumerate(impacts):
            z = (0.75 + 1.5 * k) * D
            if kind == "pair":
                x += [(3e-3, 4e-3, z), (3e-3 + D + 1e-9, 4e-3, z)]
                u += [(speed / 2, 0, 0), (-speed / 2, 0, 0)]
            else:
                x.append((4e-3, D / 2 + 1e-9 if kind == "yLow" else 8e-3 - D / 2 - 1e-9, z))
                u.append((0, -speed if kind == "yLow" else speed, 0))
        case = make(self.path(name), f"{contact} impactSpeed {max(speeds)}; timeStepFraction 0.0025;", positions=x, U=u, end=stop, interval=stop, more=more)
        solve(case)
        after, found = iter(end(case, harness.haff.Case(case).times[-1])["U"]), []
        for kind, speed in impacts:
            first = next(after)
            found.append((next(after)[0] - first[0] if kind == "pair" else abs(first[1])) / speed)
        return found

    def test_viscoelastic(self):
        """Finding L1: walls by hertz/material would be off by 2.5e-3 to 4e-3."""
        known = {("pair", 0.1): 0.979875, ("pair", 1): 0.968329, ("yLow", 0.01): 0.988885, ("yLow", 0.1): 0.982453, ("yLow", 1): 0.972360}
        for ((kind, speed), value), e in zip(known.items(), self.head_on("viscous", VISCOUS, known)):
            exact = restitution(*((D / 4, MASS / 2) if kind == "pair" else (D / 2, MASS)), speed)
            self.assertAlmostEqual(exact, value, delta=2e-6)
            self.assertAlmostEqual(e, exact, delta=1e-4, msg=f"{kind}, {speed} m/s")

    def test_restitution(self):
        """Finding L2: LAMMPS's own coefficient gives 0.928 in place of 0.9. Of a wall its own one counts."""
        hertz, linear = f"type hertz; youngsModulus {E};", "type linear; stiffness 1e5;"
        for n, (contact, e, own) in enumerate(((hertz, 0.9, 0.3), (hertz, 0.5, 0.9), (linear, 0.7, 0.5), (hertz, 1, 0.5))):
            found = self.head_on(f"given {n}", f"{contact} restitution {e};", [(kind, 0.3) for kind in ("pair", "yLow", "yHigh")],
                                 f"walls {{ yLow {{ restitution {own}; }} }}\n")
            np.testing.assert_allclose(found, (e, own, e), rtol=0, atol=1e-3, err_msg=contact)

    def test_written_before(self):
        """LAMMPS changes the coefficient of a wall with Tsuji's damper whenever it is set up: after two written times e would be 0.6."""
        case = make(self.path("written"), f"type hertz; youngsModulus {E}; restitution 0.5; impactSpeed 0.3; timeStepFraction 0.0025;",
                    positions=[(4e-3, D / 2 + 3e-6, 4e-3)], U=[(0, -0.3, 0)], end=4e-5, interval=4e-6)
        solve(case)
        self.assertAlmostEqual(end(case, "4e-05")["U"][0, 1] / 0.3, 0.5, delta=1e-3)

    def test_oblique(self):
        """On a wall at 1 m/s, mu 0.5: normal and tangential speed and spin, by an integration with h = 1e-9 s of another program."""
        known = {20: (0.914036, 0.233131, 0.272222), 45: (0.688851, 0.408419, 0.746720), 70: (0.334368, 0.609164, 0.826321), 85: (0.085667, 0.909783, 0.216030)}
        a = np.radians(list(known))
        case = make(self.path("oblique"), VISCOUS + "friction 0.5; tangentialStiffness 1e5; tangentialDamping 0.5; impactSpeed 1; timeStepFraction 0.0025;", wall="noSlip",
                    positions=[(4e-3, D / 2 + 1e-9, (1 + 2 * k) * D) for k in range(len(a))], U=np.stack([np.sin(a), -np.cos(a), 0 * a], axis=1), end=6e-5, interval=6e-5)
        solve(case)
        after = end(case, "6e-05")
        found = np.stack([after["U"][:, 1], after["U"][:, 0], -after["omega"][:, 2] * D / 2], axis=1)
        np.testing.assert_allclose(np.abs(found), list(known.values()), atol=1e-4, err_msg=f"{list(known)} degrees")

    def test_rolling(self):
        """A sphere that slides with friction on a plate slows down by mu g until it rolls at 5/7 of its speed."""
        v, mu, g = 0.1, 0.5, 9.81
        stiff = "type linear; stiffness 200; restitution 0.5;"
        rest = D / 2 - MASS * g / 200
        stop = 2 * v / (7 * mu * g)
        case = make(self.path("rolling"), f"{stiff} friction {mu}; tangentialDamping 0.5; impactSpeed 0.1; timeStepFraction 0.002;", wall="noSlip", positions=[(4e-3, rest, 4e-3)], U=[(v, 0, 0)], g=(0, -g, 0),
                    end=float("%.6g" % (2.5 * stop)), interval=float("%.6g" % (0.5 * stop)))
        solve(case)
        times = harness.haff.Case(case).times[1:]
        slow = end(case, times[0])
        self.assertAlmostEqual(slow["U"][0, 0] / (v - mu * g * float(times[0])), 1, delta=1e-4)
        last = end(case, times[-1])
        self.assertAlmostEqual(last["U"][0, 0] / (5 / 7 * v), 1, delta=1e-4)
        self.assertAlmostEqual(-last["omega"][0, 2] * D / 2 / last["U"][0, 0], 1, delta=1e-3)

    def test_moving_wall(self):
        """A sphere that lies on a plate in motion is dragged along until it rolls at 2/7 of the plate's speed; the plate's work is what it gets and loses."""
        v, mu, g, k = 0.1, 0.5, 9.81, 200
        stop = 2 * v / (7 * mu * g)
        case = make(self.path("moving"), f"type linear; stiffness {k}; restitution 0.5; friction {mu}; tangentialDamping 0.5; impactSpeed 0.1; timeStepFraction 0.005;",
                    wall=f"translatingWallVelocity; U ({v} 0 0); value uniform ({v} 0 0)", positions=[(4e-3, D / 2 - MASS * g / k, 4e-3)], U=[(0, 0, 0)],
                    g=(0, -g, 0), end=float("%.6g" % (2.5 * stop)), interval=float("%.6g" % (0.5 * stop)), more="coarseGraining { samples 400; }")
        solve(case)
        times = harness.haff.Case(case).times[1:]
        self.assertAlmostEqual(end(case, times[0])["U"][0, 0] / (mu * g * float(times[0])), 1, delta=1e-3)
        self.assertAlmostEqual(end(case, times[-1])["U"][0, 0] / (2 / 7 * v), 1, delta=1e-3)
        row, at = table(case)
        has = sum(row[-1, at[key]] for key in ("kinetic", "spin", "potential", "normalSpring", "tangentSpring")) - row[0, at["potential"]]
        lost = sum(row[-1, at[key]] for key in ("lostNormal", "lostTangential", "lostFriction"))
        self.assertAlmostEqual((has + lost) / row[-1, at["wallWork"]], 1, delta=0.02)

    def test_joint(self):
        """Finding L3: two patches of one plane that meet are one wall; a sphere on their joint feels it once."""
        case = make(self.path("joint"), f"type hertz; youngsModulus {E}; restitution 0.9; impactSpeed 1;", positions=[(4.02e-3, D / 2 + 1e-9, 4e-3)], U=[(0, -1, 0)], end=6e-5, interval=6e-5)
        path = os.path.join(case, "constant", "polyMesh", "boundary")
        with open(path) as f:
            text = f.read()
        first = int(re.search(r"yLow\s*\{[^}]*startFace\s+(\d+)", text)[1])
        found = re.search(r"yLow\s*\{([^}]*)\}", text)
        half = re.sub(r"nFaces\s+64", "nFaces 32", found[0])
        other = re.sub(rf"startFace\s+{first}", f"startFace {first + 32}", half).replace("yLow", "yMore")
        count = int(re.search(r"^(\d+)\s*\(", text, re.M)[1])
        text = re.sub(rf"^{count}(\s*\()", rf"{count + 1}\1", text, flags=re.M).replace(found[0], half + "\n" + other)
        with open(path, "w") as f:
            f.write(text)
        for name in ("alpha", "T", "U"):
            harness.dictionary.edit(os.path.join(case, "0", name), {"+boundaryField/yMore": "{ type %s; }" % ("slip" if name == "U" else "zeroGradient")})
        solve(case)
        u = end(case, "6e-05")["U"][0]
        self.assertAlmostEqual(u[1], 0.9, delta=1e-3)
        self.assertLess(abs(u[0]) + abs(u[2]), 1e-9)

    def test_border(self):
        """A ridge across a cyclic axis: the ground beside it is two rectangles, which go on beyond the border of space and end at the ridge.
        A sphere that crosses the border while it touches the ground feels a plane; one on the ridge feels its top alone."""
        case = make(self.path("border"), f"type hertz; youngsModulus {E}; restitution 0.9; impactSpeed 1;", cells=(9, 8, 8), size=(9e-3, 8e-3, 8e-3),
                    positions=[(1e-9, D / 2 + 1e-9, 4e-3), (4.5e-3, 3e-3 + D / 2 + 1e-9, 4e-3)], U=[(-0.5, -1, 0), (0, -1, 0)], end=6e-5, interval=6e-5)
        x, y = np.arange(9)[None, None, :], np.arange(8)[None, :, None]
        hole = np.broadcast_to((x >= 3) & (x < 6) & (y < 3), (8, 8, 9)).ravel()
        boxes.write_mesh(case, (9, 8, 8), (9e-3, 8e-3, 8e-3), WALLS, hole=hole, hole_patch="ridge")
        for name in ("alpha", "T", "U"):
            harness.dictionary.edit(os.path.join(case, "0", name), {"+boundaryField/ridge": "{ type %s; }" % ("slip" if name == "U" else "zeroGradient")})
        solve(case)
        ground, ridge = end(case, "6e-05")["U"]
        self.assertAlmostEqual(ground[1], 0.9, delta=1e-3)
        self.assertAlmostEqual(ridge[1], 0.9, delta=1e-3)
        self.assertLess(abs(ground[0] + 0.5) + abs(ground[2]) + abs(ridge[0]) + abs(ridge[2]), 1e-9)


@unittest.skipUnless(LAMMPS, MISSING)
class Beds(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def bed(self, name, fraction=0.04, **options):
        """A bed of 150 rough spheres that settles, in half as many steps as usual."""
        more = options.pop("more", "")
        options = {"types": {"x": "wall", "y": "wall", "z": "cyclic"}, **options}
        return make(self.path(name), "type linear; stiffness 200; restitution 0.6; friction 0.5; tangentialDamping 0.5; " + f"timeStepFraction {fraction};", wall="noSlip", alpha=0.2,
                    T=1e-3, g=(1, -9.81, 0), more=f"N 150; seed 4;\n{more}", **options)

    def same(self, one, other, at):
        a, b = (end(case, at) for case in (one, other))
        for key in ("x", "U", "omega"):
            self.assertTrue(np.array_equal(a[key], b[key]), f"{key} at {at}: {np.abs(a[key] - b[key]).max()}")

    def test_restart(self):
        """To the bit at written times, with the springs of contacts and of walls: without these, 1e-5 m after 0.02 s."""
        whole, parts, bare = (self.bed(n, end=0.06, interval=0.02) for n in ("whole", "parts", "bare"))
        self.assertIn("put in place at random", solve(whole))
        for stop in (0.02, 0.04, 0.06):
            harness.edit(parts, "system/controlDict", endTime=stop)
            self.assertIn("to the bit" if stop > 0.02 else "put in place", solve(parts))
        self.same(whole, parts, "0.06")
        for field in ("alpha", "U", "T", "p"):
            self.assertTrue(np.array_equal(harness.haff.Case(whole).field(field, "0.06"), harness.haff.Case(parts).field(field, "0.06")), field)
        shutil.copytree(os.path.join(whole, "0.04"), os.path.join(bare, "0.04"))
        shutil.rmtree(os.path.join(bare, "0"))
        os.remove(os.path.join(bare, "0.04", "uniform", "lammps"))
        os.remove(os.path.join(bare, "0.04", "uniform", "checksums"))
        solve(bare)
        self.assertGreater(np.abs(end(whole, "0.06")["x"] - end(bare, "0.06")["x"]).max(), 1e-8)

    def test_samples(self):
        """Looking at the grains does not move them: more samples, the same steps."""
        few, many = (self.bed(n, end=0.03, interval=0.03, more="coarseGraining { samples %d; window %g; }" % how) for n, how in (("few", (1, 0.015)), ("many", (2, 0.03))))
        for case in (few, many):  # samples at 7.5 and 22.5 ms
            solve(case)
        self.same(few, many, "0.03")

    def test_budget(self):
        """With samples as dense as the steps of contacts, what dampers and friction took closes the energy to the order of the step."""
        case = self.bed("budget", 0.02, end=0.02, interval=0.02, more="coarseGraining { samples 2000; }")
        solve(case)
        rows, column = table(case)
        at = {name: rows[:, i] for name, i in column.items()}
        has = sum(at[k] for k in ("kinetic", "spin", "potential", "normalSpring", "tangentSpring"))
        lost = sum(at[k] for k in ("lostNormal", "lostTangential", "lostFriction"))
        self.assertTrue(all(at[k][-1] > 0 for k in ("lostNormal", "lostTangential", "lostFriction")))
        self.assertLess(np.abs(has + lost - has[0])[-1] / lost[-1], 0.02)

    def test_fields(self):
        """The mass of all grains in means over time, and the weight of the bed on the floor. At a moment: by the virial theorem the vertical stress
        of a bed at rest, summed over all cells, is the sum of weight times height; p is a third of the trace, and the mean spin that of the grains."""
        case = self.bed("fields", end=0.3, interval=0.1, more="coarseGraining { window 0.1; samples 20; }", types=WALLS)
        harness.edit(case, "constant/g", value="(0 -9.81 0)")
        solve(case)
        self.assertAlmostEqual(float(np.sum(harness.haff.Case(case).field("rho", "0.3"))) * 1e-9 / (150 * MASS), 1, places=9)
        rows, column = table(case)
        upwards = [i for n, i in column.items() if n.startswith("force") and n.endswith("_y")]
        force = np.sum(rows[rows[:, 0] > 0.2][:, upwards], axis=1)
        self.assertAlmostEqual(float(np.mean(force)) / (-150 * MASS * 9.81), 1, delta=0.002)
        harness.edit(case, "constant/particleProperties", window=100)
        harness.edit(case, "system/controlDict", endTime=0.4)
        solve(case)
        found, cloud = harness.haff.Case(case), end(case, "0.4")
        along = found.field("pComponents", "0.4")
        np.testing.assert_allclose(found.field("p", "0.4"), along.mean(axis=1), rtol=1e-4, atol=1e-9)
        self.assertAlmostEqual(1e-9 * along[:, 1].sum() / (MASS * 9.81 * cloud["x"][:, 1].sum()), 1, delta=2e-3)
        self.assertLess(np.abs(found.field("pShear", "0.4").sum(axis=0)).max(), 0.2 * along[:, 1].sum())
        cells = np.floor(cloud["x"] * 1e3 + 1e-9).astype(int)
        own = cells[:, 0] + 8 * (cells[:, 1] + 8 * cells[:, 2])
        mean = np.array([cloud["omega"][own == i].mean(axis=0) if (own == i).any() else np.zeros(3) for i in range(512)])
        np.testing.assert_allclose(found.field("omega", "0.4"), mean, rtol=1e-5, atol=1e-7)

    def test_elastic(self):
        """Elastic spheres in a box: the energy of motion between impacts is that of the start, the momentum of a periodic box stays."""
        case = make(self.path("elastic"), f"type hertz; youngsModulus {E}; restitution 1; timeStepFraction 0.02;", more="N 100; seed 2;\n", alpha=0.1, T=0.02,
                    types={"x": "cyclic", "y": "cyclic", "z": "cyclic"}, end=0.02, interval=0.02)
        solve(case)
        rows, at = table(case)
        with_springs = rows[:, at["kinetic"]] + rows[:, at["spin"]] + rows[:, at["normalSpring"]]
        self.assertLess(np.abs(with_springs / with_springs[0] - 1).max(), 1e-3)
        self.assertLess(np.abs(rows[:, at["momentum_x"]:at["momentum_z"] + 1]).max(), 1e-12 * np.sqrt(2 * MASS * 100 * with_springs[0]))

    def test_hard_limit(self):
        """The same start and e, stiffer and stiffer: the cooling tends to that of hard spheres like E^(-2/5); with 1e8 Pa to 1 %."""
        cooled, rate = {}, {}
        for name, young in (("hard", 1e8), ("soft", 1e6), ("stiff", 1e8)):
            case = make(self.path(name), f"type hertz; youngsModulus {young}; restitution 0.8;", cells=(8, 8, 8), size=(0.02, 0.02, 0.02), e=0.8, T=0.01, alpha=0.2,
                        types={"x": "cyclic", "y": "cyclic", "z": "cyclic"}, end=0.01, interval=0.01, more="N 3000; seed 7; coarseGraining { samples 4; }\n")
            if name == "hard":
                harness.edit(case, "system/controlDict", application="granularMD", **{"+maxDeltaT": 0.00125})  # a row of the table at each sample
                harness.program("granularMD", "-case", case)
            else:
                solve(case)
            rows, at = table(case)
            cooled[name] = np.log(0.01 / np.interp(0.00875, rows[:, 0], rows[:, at["T"]]))
        for name in ("soft", "stiff"):
            rate[name] = cooled[name] / cooled["hard"]
        print("cooling over that of hard spheres", rate)
        self.assertLess(rate["soft"], 0.97)
        self.assertLess(abs(rate["stiff"] - 1), 0.01, rate)

    def test_outlet(self):
        """Grains that fall out of an open box are taken away and counted; the run goes on without any, and again from a time without any."""
        case = make(self.path("outlet"), "type linear; stiffness 200; restitution 0.6;", wall="zeroGradient", alpha=0.1, T=1e-4, g=(0, -9.81, 0), more="N 40; seed 4;\n",
                    end=0.06, interval=0.02)
        solve(case)
        rows, at = table(case)
        counts = rows[:, at["grains"]]
        self.assertEqual((counts[0], counts[-1]), (40, 0))
        self.assertTrue(np.all(np.diff(counts) <= 0))
        harness.edit(case, "system/controlDict", endTime=0.08)
        solve(case)
        self.assertEqual(float(harness.haff.Case(case).field("rho", "0.08").max()), 0)

    def test_hopper(self):
        """Leaning walls on a mesh of triangles: all grains stay among them, the fields hold their mass, and a restart has the same bits."""
        whole, parts = (os.path.join(self.folder, name) for name in ("hopper whole", "hopper parts"))
        rooms.make(whole, HOPPER, end=2, interval=1, g=-1, particles="contact { type linear; stiffness 1e4; restitution 0.8; friction 0.5; }\n")
        harness.edit(whole, "system/controlDict", application="granularDEM")
        shutil.copytree(whole, parts)
        self.assertRegex(solve(whole), r"rectangle, normal \(0.8 -0.6 \S+\), friction 0")
        found = harness.haff.Case(whole)
        cloud = grains.read(found, "2")
        x, y = cloud["x"][:, :2].T
        self.assertGreater(np.min([y, 0.6 * y - 0.8 * (x - 4), 0.6 * y + 0.8 * x, 10 - x, x + 6, 16 - y]), 0.4 - 6 * (1 / 1e4)**0.5)  # m: the overlap of an impact at 6 m/s
        depth = np.ptp(found.mesh.points[:, 2])
        self.assertAlmostEqual(np.sum(found.field("alpha", "2") * found.volumes) / depth, len(x) * np.pi / 4 * 0.8**2, delta=1e-9)
        harness.edit(parts, "system/controlDict", endTime=1)
        solve(parts)
        harness.edit(parts, "system/controlDict", endTime=2)
        solve(parts)
        for key, value in end(whole, "2").items():
            np.testing.assert_array_equal(value, end(parts, "2")[key], err_msg=key)

    def test_hopper_opens(self):
        """Grains fall out of the hopper's floor, a side of the box around the mesh, and are counted; through a leaning wall they may not."""
        for floor, others in ((1, "2:6"), (2, "1, 3:6")):
            case = os.path.join(self.folder, f"hopper {floor}")
            geo = HOPPER.replace('("walls") = {1:6}', f'("walls") = {{{others}}}; Physical Curve("outlet") = {{{floor}}}')
            rooms.make(case, geo, end=4, interval=4, g=-1, particles="contact { type linear; stiffness 1e4; restitution 0.8; friction 0.5; }\n")
            harness.edit(case, "system/controlDict", application="granularDEM")
            harness.edit(case, "0/U", boundaryField='{ outlet { type zeroGradient; } "front|back" { type empty; } ".*" { type slip; } }')
            done = harness.program("granularDEM", "-case", case, check=False)
            if floor == 2:
                self.assertIn("patch outlet: grains leave there, and it lies on no side of the box around the mesh; let it lie on one", done.stderr)
                continue
            self.assertEqual(done.returncode, 0, done.stderr)
            rows, column = table(case)
            self.assertTrue((np.diff(rows[:, column["grains"]]) <= 0).all())
            self.assertLess(rows[-1, column["grains"]], rows[0, column["grains"]] - 10)
            x = grains.read(harness.haff.Case(case), "4")["x"]
            self.assertTrue(0 < len(x) <= rows[-1, column["grains"]])
            self.assertGreaterEqual(x[:, 1].min(), 0)

    def test_ranks(self):
        """On two ranks LAMMPS adds in another order: the same motion to round-off for some impacts."""
        one, two = (self.bed(n, end=0.005, interval=0.005) for n in ("one rank", "two ranks"))
        solve(one)
        self.assertIn("moved by LAMMPS on 2 ranks", solve(two, "-np", "2"))
        self.assertLess(np.abs(end(one, "0.005")["x"] - end(two, "0.005")["x"]).max(), 1e-9)
        with open(os.path.join(one, "dem", "in.lammps")) as f:  # the commands that a run leaves are those of LAMMPS itself
            text = f.read()
        self.assertRegex(text, r"fix wall\d all wall/gran granular hooke \S+ \S+ tangential linear_history")
        self.assertIn("pair_coeff * * hooke", text)


class Errors(harness.Folder, unittest.TestCase):
    def refused(self, pattern, contact="type hertz; youngsModulus 5e9;", check=True, wall="slip", **options):
        name = os.path.join(self.folder, f"case {len(os.listdir(self.folder))}")
        done = harness.program("checkCase", make(name, contact, wall=wall, T=1e-3, **options), check=False)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertRegex(done.stderr, pattern)

    def test_contact(self):
        self.refused(r"particleProperties:\d+: .*youngsModulus", "type hertz; friction 0.5;")
        self.refused(r"particleProperties:\d+: keyword 'stiffness' is not used", "type hertz; youngsModulus 5e9; stiffness 100;")
        self.refused(r"restitution is given, too; remove one of them", VISCOUS + "restitution 0.9;")
        self.refused(r"allows 0.12 .. 1", "type hertz; youngsModulus 5e9; restitution 0.1;")
        self.refused(r"timeStepFraction is 0.1; allowed is 0 .. 0.0666667", "type hertz; youngsModulus 5e9; timeStepFraction 0.1;")
        self.refused(r"with  tangential mindlin;  it follows from youngsModulus", "type hertz; youngsModulus 5e9; tangential mindlin; tangentialStiffness 1;")
        self.refused(r"grain 1 at .* overlaps a wall of patch yLow", positions=[(4e-3, 1e-4, 4e-3)], U=[(0, 0, 0)])

    def test_walls(self):
        self.refused(r"patch yLow: type is fixedValue; granularDEM has walls", wall="fixedValue; value uniform (0 1 0)")
        self.refused(r"wide along its cyclic axis x; it must be 3 diameters", cells=(4, 4, 4), size=(2e-3, 8e-3, 8e-3))

    def test_warnings(self):
        case = make(os.path.join(self.folder, "warnings"), "type linear; stiffness 0.1; timeStepFraction 0.05;", T=1e-3, alpha=0.3, g=(0, -9.81, 0))
        harness.edit(case, "constant/granularProperties", grain=f"{{ diameter {D}; mass {MASS:.17g}; restitution 0.9; thresholdSpeed 1e-4; }}")
        said = harness.program("checkCase", case).stdout
        for name in ("longContactStep", "softGrains", "softThreshold"):
            self.assertIn(f"[{name}]", said)

    @unittest.skipUnless(LAMMPS, MISSING)
    def test_overlap(self):
        case = make(os.path.join(self.folder, "overlap"), "type hertz; youngsModulus 5e9; impactSpeed 1;", positions=[(4e-3, 4e-3, 4e-3), (4.5e-3, 4e-3, 4e-3)], U=2 * [(0, 0, 0)])
        done = harness.program("granularDEM", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "grains 1 and 2 overlap by 0.5 diameters at the start")

    @unittest.skipUnless(LAMMPS, MISSING)
    def test_paths(self):
        """A path is no command of LAMMPS: it opens the file of that name, or the run is refused before it begins."""
        case = make(os.path.join(self.folder, "a b$x ${y} $(1) #&'"), VISCOUS + "impactSpeed 1;", positions=[(4e-3, 4e-3, 4e-3)], U=[(0.1, 0, 0)], end=1e-4, interval=1e-4)
        solve(case)
        self.assertTrue(os.path.isfile(os.path.join(case, "0.0001", "uniform", "lammps")))
        shutil.rmtree(os.path.join(case, "0.0001"))
        for sign in ('"', "\n", "%", "*", "\u201c", "\u00e9"):
            before, case = case, os.path.join(self.folder, f"x{sign} shell touch found")
            os.rename(before, case)
            done = harness.program("granularDEM", "-case", case, check=False)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertRegex(done.stderr, r"LAMMPS cannot open a path with .* start granularDEM in the folder of the case, or rename the folder")
        subprocess.run([os.path.join(harness.BIN, "granularDEM")], cwd=case, check=True, capture_output=True)

    def test_missing(self):
        """Without lmp a case can be checked, with a warning; a run says which package is missing."""
        case = make(os.path.join(self.folder, "missing"), "type hertz; youngsModulus 5e9;", T=1e-3)
        path = os.environ["PATH"]
        os.environ["PATH"] = harness.BIN
        try:
            self.assertIn("[noLammps]", harness.program("checkCase", case).stdout)
            done = harness.program("granularDEM", "-case", case, check=False)
        finally:
            os.environ["PATH"] = path
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, "lmp was not found in PATH: on Debian, run  apt-get install lammps")


if __name__ == "__main__":
    unittest.main()
