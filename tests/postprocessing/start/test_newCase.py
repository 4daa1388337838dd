# SPDX-License-Identifier: GPL-3.0-or-later
"""newCase: cases around geometries of many kinds are sound and run at once; what cannot be made is refused with the cure, and leaves nothing."""
import os
import re
import shutil
import subprocess
import types
import unittest
import unittest.mock

import numpy as np

from tests.cases import harness
from haff.case import entries
from haff.start import flow, geometry, newCase, patches

SQUARE = "".join(f"Point({k + 1}) = {{{x}, {y}, 0, 0.1}};\n" for k, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)))) + \
    "Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};\n"
GEOMETRIES = {
    "cylinder": """h = 0.3; Point(1) = {-3, -2, 0, h}; Point(2) = {4, -2, 0, h}; Point(3) = {4, 2, 0, h}; Point(4) = {-3, 2, 0, h};
        Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
        Point(5) = {0, 0, 0, h}; Point(6) = {1, 0, 0, h}; Point(7) = {-1, 0, 0, h}; Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 6};
        Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6}; Plane Surface(1) = {1, 2};
        Physical Curve("inlet") = {4}; Physical Curve("farField") = {1, 3}; Physical Curve("outlet") = {2}; Physical Curve("cylinder") = {5, 6};
        Physical Surface("gas") = {1};""",
    # the upper half of a body's front, whose inlet is an ellipse: the stream goes along the mirror
    "half": """h = 2; Point(1) = {0, 0, 0, h}; Point(2) = {-10, 0, 0, h}; Point(3) = {0, 10, 0, h}; Point(4) = {0, 45, 0, 2*h}; Point(5) = {-28, 0, 0, 2*h};
        Circle(1) = {2, 1, 3}; Line(2) = {3, 4}; Ellipse(3) = {4, 1, 4, 5}; Line(4) = {5, 2}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
        Physical Curve("inlet") = {3}; Physical Curve("outlet") = {2}; Physical Curve("noseOfTheBody") = {1}; Physical Curve("symmetry") = {4};
        Physical Surface("gas") = {1};""",
    "tetrahedra": """SetFactory("OpenCASCADE"); Box(1) = {0, 0, 0, 3, 1, 1}; Box(2) = {1, 0.3, 0, 0.4, 0.4, 0.4};
        BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; }; Mesh.MeshSizeMax = 0.25; e = 0.01;
        in[] = Surface In BoundingBox {-e, -e, -e, e, 1 + e, 1 + e}; out[] = Surface In BoundingBox {3 - e, -e, -e, 3 + e, 1 + e, 1 + e};
        all[] = Boundary{ Volume{3}; }; all[] -= {in[], out[]};
        Physical Surface("inlet") = in[]; Physical Surface("outlet") = out[]; Physical Surface("obstacleAndWalls") = all[]; Physical Volume("gas") = {3};""",
    "tube": """Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Line(1) = {1, 2}; Transfinite Curve {1} = 101;
        Physical Point("inlet") = {1}; Physical Point("end") = {2}; Physical Curve("gas") = {1};""",
    "unknown": SQUARE + 'Physical Curve("quux") = {1, 3}; Physical Curve("foo7") = {2, 4}; Physical Surface("gas") = {1};',
    "layer1": SQUARE.replace(", 0.1}", "}") + """Transfinite Curve{1:4} = 21; Transfinite Surface{1}; Recombine Surface{1};
        out[] = Extrude{0, 0, 0.1}{Surface{1}; Layers{1}; Recombine;}; Physical Volume("gas") = {out[1]};
        Physical Surface("frontAndBack") = {1, out[0]}; Physical Surface("periodicTop") = {out[4]}; Physical Surface("periodicBottom") = {out[2]};
        Physical Surface("inflow") = {out[5]}; Physical Surface("outflow") = {out[3]};""",
    "nogroup": SQUARE, "broken": "Point(1) = {0, 0, 0\n",
    "lonely": SQUARE + 'Physical Curve("periodicA") = {1}; Physical Curve("inlet") = {2:4}; Physical Surface("gas") = {1};',
}
# a funnel of triangles, 0.12 high, with a throat of 0.016 and a rod in its middle
FUNNEL = """h = 0.012; Point(1) = {-0.008, 0, 0, h}; Point(2) = {0.008, 0, 0, h}; Point(3) = {0.008, 0.02, 0, h}; Point(4) = {0.05, 0.07, 0, h};
    Point(5) = {0.05, 0.12, 0, h}; Point(6) = {-0.05, 0.12, 0, h}; Point(7) = {-0.05, 0.07, 0, h}; Point(8) = {-0.008, 0.02, 0, h}; Point(9) = {0.03, 0.03, 0, h};
    Point(10) = {-0.03, 0.03, 0, h}; Line(1) = {1, 2}; Line(2) = {2, 3}; Spline(3) = {3, 9, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 7};
    Spline(7) = {7, 10, 8}; Line(8) = {8, 1}; Point(20) = {0, 0.06, 0, h/2}; Point(21) = {0.008, 0.06, 0, h/2}; Point(22) = {-0.008, 0.06, 0, h/2};
    Circle(20) = {21, 20, 22}; Circle(21) = {22, 20, 21}; Curve Loop(1) = {1:8}; Curve Loop(2) = {20, 21}; Plane Surface(1) = {1, 2};
    Physical Curve("exit") = {1}; Physical Curve("funnelWall") = {2:4, 6:8}; Physical Curve("top") = {5}; Physical Curve("rodWall") = {20, 21};
    Physical Surface("grains") = {1};"""
GEOMETRIES["funnel"] = FUNNEL
# two sloped walls over a slot of 0.03
GEOMETRIES["slot"] = """h = 0.005; Point(1) = {-0.06, 0.1, 0, h}; Point(2) = {-0.06, 0.06, 0, h}; Point(3) = {-0.015, 0, 0, h}; Point(4) = {0.015, 0, 0, h};
    Point(5) = {0.06, 0.06, 0, h}; Point(6) = {0.06, 0.1, 0, h}; Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6};
    Line(6) = {6, 1}; Curve Loop(1) = {1:6}; Plane Surface(1) = {1}; Physical Curve("outlet") = {3}; Physical Curve("walls") = {1, 2, 4, 5};
    Physical Curve("top") = {6}; Physical Surface("grains") = {1};"""
GRAVITY = "-gravity 1 -diameter 1 -restitution 0.8 -shaking 2.5,0.1 -grains disks".split()
SPARE = "-box 40x32 -cells 20x16".split()


@unittest.skipUnless(shutil.which("gmsh"), "gmsh is not there")
class NewCase(harness.Folder, unittest.TestCase):
    def geo(self, name):
        path = os.path.join(self.folder, f"{name}.geo")
        with open(path, "w") as f:
            f.write(GEOMETRIES[name])
        return path

    def call(self, *words, code=0, cwd=None, gmsh=None):
        """gmsh: may it be called? It starts more slowly than all else, and newCase makes a box without it."""
        gmsh = "-box" not in words if gmsh is None else gmsh
        with unittest.mock.patch.dict(os.environ, PATH=os.environ["PATH"] if gmsh else self.programs):
            done = harness.command("newCase", *words, cwd=cwd or self.folder)
        self.assertEqual(done.returncode, code, done.stdout[-1500:] + done.stderr[-1500:])
        return done.stdout if code == 0 else done.stderr

    def new(self, *words):
        """A case that is sound, without a warning; its folder and what was said."""
        case = os.path.join(self.folder, f"case{len(os.listdir(self.folder))}")
        said = self.call(case, *words)
        self.assertIn("which checkCase finds sound", said)
        self.assertIn("The case is sound.", harness.program("checkCase", case, "-strict").stdout)
        return case, said

    def test_a_folder_with_a_space(self):
        """What newCase says to type can be typed."""
        said = self.call("my case", "-box", "1x1", "-cells", "10x10")
        self.assertIn("cd 'my case' && ./Allrun", said)
        self.assertTrue(os.path.isfile(os.path.join(self.folder, "my case", "Allrun")))

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.programs = os.path.join(cls.folder, "programs")  # all but haff
        os.mkdir(cls.programs)
        for name in set(os.listdir(harness.BIN)) - {"haff"}:
            os.symlink(os.path.join(harness.BIN, name), os.path.join(cls.programs, name))
        if shutil.which("lmp"):
            os.symlink(shutil.which("lmp"), os.path.join(cls.programs, "lmp"))
        cls.reporting = os.path.join(cls.folder, "reporting")  # a haff that says how it is called: a report takes some seconds
        os.mkdir(cls.reporting)
        with open(os.path.join(cls.reporting, "haff"), "w", encoding="utf-8") as f:
            f.write('#!/bin/sh\necho "$*"\n')
        os.chmod(f.name, 0o755)

    def run_case(self, case, share=1.0):
        """Runs a share of the time by Allrun, with nothing but PATH; the haff.Case. Without haff in PATH Allrun makes no report, which takes up to
        ten seconds."""
        control = os.path.join(case, "system", "controlDict")
        end = share * float(entries.get(control, "endTime"))
        entries.edit(control, {"endTime": f"{end:.12g}", "writeInterval": f"{end:.12g}"})
        env = {k: v for k, v in os.environ.items() if not k.startswith(("HAFF", "PYTHON"))}
        done = subprocess.run([os.path.join(case, "Allrun")], capture_output=True, text=True, cwd="/", env={**env, "PATH": f"{self.programs}:/usr/bin:/bin"})
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])
        self.assertNotIn("The report is", done.stdout)
        self.assertFalse(os.path.exists(os.path.join(case, "postProcessing", "report.html")))
        made = harness.haff.Case(case)
        self.assertAlmostEqual(float(made.times[-1]), end, delta=1e-6 * end)
        return made

    def allrun(self, case, haff):
        """Exit code of the case's Allrun with the haff of a folder in PATH, what it says, and the log that is there then."""
        env = {k: v for k, v in os.environ.items() if not k.startswith(("HAFF", "PYTHON"))}
        done = subprocess.run([os.path.join(case, "Allrun")], capture_output=True, text=True, cwd="/",
                              env={**env, "PATH": f"{haff}:{self.programs}:/usr/bin:/bin"})
        with open(os.path.join(case, "log.granularGas")) as f:
            return done.returncode, done.stdout, f.read()

    def test_a_run_that_has_ended(self):
        """Allrun leaves it and its log as they are; the message names what has changed since, and how to run it again; a later endTime goes on."""
        case, _ = self.new("-box", "1", "-cells", "20", "-end", "0.2")
        code, said, log = self.allrun(case, self.reporting)
        self.assertEqual(code, 0, said)
        self.assertIn("end at time 0.2: ", log)
        self.assertIn(f"The report is report {case}\n", said)
        code, said, now = self.allrun(case, self.programs)
        self.assertEqual((code, now, "nothing was run" in said), (0, log, True))
        grain = os.path.join(case, "constant", "granularProperties")
        with open(grain) as f:
            text = f.read()
        entries.edit(grain, {"grain/restitution": 0.7})
        code, said, now = self.allrun(case, self.reporting)
        self.assertEqual((code, now), (1, log))
        self.assertRegex(said, r"\n    constant/granularProperties: grain.restitution 0.9 -> 0.7\n.*\./Allclean && \./Allrun\n$")
        self.assertNotIn("The report is", said)
        with open(grain, "w") as f:
            f.write(text)
        os.utime(os.path.join(case, "0.orig", "T"))
        code, said, now = self.allrun(case, self.reporting)
        self.assertEqual((code, now), (1, log))
        self.assertIn("\n0.orig/T\n", said)
        entries.edit(os.path.join(case, "system", "controlDict"), {"endTime": 0.3})
        code, said, now = self.allrun(case, self.programs)
        self.assertEqual(code, 0, said)
        self.assertIn("end at time 0.3: ", now)
        subprocess.run([os.path.join(case, "Allclean")], check=True)
        self.assertFalse([n for n in os.listdir(case) if n.startswith("log")])

    def test_a_run_that_fails(self):
        """Its report is made all the same, and tells why it stopped."""
        case, _ = self.new("-box", "1", "-cells", "20", "-end", "0.2")
        self.allrun(case, self.programs)
        entries.edit(os.path.join(case, "system", "controlDict"), {"endTime": 0.3, "maxCo": -1})
        code, said, log = self.allrun(case, harness.BIN)
        self.assertEqual(code, 1)
        self.assertIn("The report is ", said)
        with open(os.path.join(case, "postProcessing", "report.html")) as f:
            self.assertRegex(f.read(), r"<strong>error</strong> [^<]*maxCo")

    def patch(self, case, field, name):
        return entries.get(os.path.join(case, "0.orig", field), f"boundaryField/{name}/type")

    def test_cylinder(self):
        case, said = self.new(self.geo("cylinder"), "-Mach", "4", "-speed", "10")
        made = self.run_case(case, 0.3)
        self.assertEqual([self.patch(case, "U", n) for n in ("inlet", "farField", "outlet", "cylinder", "front")],
                         ["fixedValue", "inletOutlet", "zeroGradient", "slip", "empty"])
        upstream = made.centres[:, 0] < -2.5
        Ma = np.sqrt((made.field("U", "0")[upstream] ** 2).sum(axis=1) / made.field("T", "0")[upstream]) / flow.sound_speed(0.05, 0.95, 3)
        np.testing.assert_allclose(Ma, 4, rtol=1e-3)
        self.assertGreater(made.table("forces", "force.dat")[-1][1], 0)  # the stream pushes the cylinder
        self.assertGreater(made.field("alpha").max(), 0.1)  # grains gather before it

    def test_Mach_is_the_solvers(self):
        """The T of a stream is that of which the solver says the same Mach number."""
        case, _ = self.new("-box", "1", "-cells", "50", "-patch", "left=inlet", "-patch", "right=outlet", "-Mach", "2.5", "-alpha", "0.3", "-restitution", "1")
        with open(os.path.join(case, "system", "controlDict")) as f:
            text = f.read().replace("functions\n{", "functions\n{\n    more { type writeObjects; fields (Ma); }")
        with open(os.path.join(case, "system", "controlDict"), "w") as f:
            f.write(text)
        np.testing.assert_allclose(self.run_case(case, 0.02).field("Ma"), 2.5, rtol=2e-4)

    def test_round(self):
        """A body of revolution: `axis`, a mirror on it; a mesh elsewhere, and what round flow has not, are refused."""
        case, said = self.new("-box", "2x1", "-cells", "12x6", "-round")
        self.assertRegex(said, r"patch\s+bottom\s+symmetry")
        with open(os.path.join(case, "system", "meshDict")) as f:
            self.assertIn("axis              { direction (1 0 0); }", f.read())
        for words, says in ((("-box", "1x1x1", "-cells", "4x4x4"), "must lie in the plane of x and y"),
                            (("-box", "1x1", "-cells", "8x8", "-gravity", "9.81"), "across the axis")):
            self.assertIn(says, self.call("none", *words, "-round", code=1))

    def test_mirror(self):
        """The stream goes along the mirror, whatever the shape of the inlet."""
        case, said = self.new(self.geo("half"))
        self.assertIn("velocity (1 0 0)", said)
        self.assertEqual(self.patch(case, "T", "symmetry"), "symmetryPlane")
        self.assertEqual(self.patch(case, "U", "noseOfTheBody"), "slip")
        self.run_case(case, 0.1)

    def test_tetrahedra(self):
        case, said = self.new(self.geo("tetrahedra"), "-transport")
        self.assertRegex(said, r"3D, polyhedra")
        self.assertEqual(self.patch(case, "U", "obstacleAndWalls"), "noSlip")
        self.assertEqual(self.patch(case, "T", "obstacleAndWalls"), "granularWall")
        self.run_case(case, 0.01)

    def test_tube(self):
        case, said = self.new(self.geo("tube"))
        self.assertRegex(said, r"100 cells, 1D, a lattice")
        self.assertGreater(self.run_case(case, 0.3).field("alpha").max(), 0.2)  # it is filled against its end

    def test_boxes(self):
        for box, cells, dim in (("2", "50", 1), ("1x2", "20x40", 2), ("1x1x1", "8x8x8", 3)):
            case, said = self.new("-box", box, "-cells", cells)
            self.assertRegex(said, rf"{dim}D, a lattice")
            made = self.run_case(case)
            self.assertLess(made.field("T").max(), 0.3)  # it has cooled
            self.assertEqual(sorted(k for k, (kind, _, _) in made.mesh.patches.items() if kind == "wall"),
                             sorted(["left", "right", "bottom", "top", "back", "front"][:2 * dim]))

    def test_soft_grains(self):
        """granularDEM: walls with friction, no thresholdSpeed, a spring whose fastest impact overlaps by a hundredth of a diameter."""
        case, _ = self.new("-box", "1x1x1", "-cells", "5x5x5", "-application", "granularDEM", "-gravity", "2", "-diameter", "0.1")
        with open(os.path.join(case, "constant", "particleProperties")) as f:
            spring = float(re.search(r"stiffness\s+([\d.e+]+);", f.read())[1])
        self.assertAlmostEqual(2 * np.sqrt(0.5 / spring) / (0.01 * 0.1), 1, delta=0.02)  # a fall by the height: 2 m/s
        with open(os.path.join(case, "0.orig", "U")) as f:
            self.assertIn("type noSlip", f.read())
        with open(os.path.join(case, "constant", "granularProperties")) as f:
            self.assertRegex(f.read(), r"thresholdSpeed\s+0;")

    def test_layer(self):
        """A shaken layer as gas and as grains has the same mass, to a grain, and jumps."""
        gas, _ = self.new(*SPARE, *GRAVITY, "-periodic", "left,right", "-transport", "-walls", "slip")
        grains, _ = self.new(*SPARE, *GRAVITY, "-periodic", "left,right", "-application", "granularMD")
        mass, heights = [], []
        for case in (gas, grains):
            made = self.run_case(case, 0.1)
            rho = made.field("rho", "0")
            mass.append((rho * made.volumes).sum() / (made.mesh.points[:, 2].max() - made.mesh.points[:, 2].min()))
            heights.append((made.field("rho") * made.volumes * made.centres[:, 1]).sum() / (made.field("rho") * made.volumes).sum())
        self.assertLess(abs(mass[0] - mass[1]), 1)
        self.assertTrue(all(2 < h < 16 for h in heights), heights)
        self.assertEqual(self.patch(gas, "U", "left"), "cyclic")

    def test_funnel(self):
        """What falls through a funnel of triangles takes implicit steps where it is dense, two thirds as many as explicit ones, and runs out as fast;
        the default of `acoustics`, which asks for more than a funnel has, says why it takes none."""
        case, _ = self.new(self.geo("funnel"), "-gravity", "9.81", "-diameter", "1e-3", "-end", "0.3")
        solution, grain = os.path.join(case, "system", "fvSolution"), os.path.join(case, "constant", "granularProperties")
        self.assertEqual([entries.get(solution, f"acoustics/{key}") for key in ("type", "automaticCoeffs/gain")], ["automatic", 2])
        self.assertEqual(entries.get(solution, "limits/alphaFloor"), 1e-6)
        self.assertAlmostEqual(entries.get(grain, "grain/thresholdSpeed"), np.sqrt(9.81 * 1e-3), delta=1e-3)
        entries.edit(os.path.join(case, "system", "fvSchemes"), {"polyReconstruct": "linear"})
        left, steps, logs = {}, {}, {}
        for word in ("written", "explicit", "default"):
            copy = f"{case}-{word}"
            shutil.copytree(case, copy)
            if word != "written":
                with open(os.path.join(copy, "system", "fvSolution"), "w") as f:
                    f.write({"explicit": "acoustics { type explicit; } ", "default": ""}[word] + "limits { alphaFloor 1e-6; }\n")
            made = self.run_case(copy)
            with open(os.path.join(copy, "log.granularGas")) as f:
                logs[word] = f.read()
            steps[word] = int(re.search(r"end at time .*: (\d+) steps", logs[word])[1])
            left[word] = [(made.field("rho", t) * made.volumes).sum() for t in ("0", made.times[-1])]
        self.assertLess(steps["written"], 0.7 * steps["explicit"])
        self.assertAlmostEqual((left["written"][1] - left["explicit"][1]) / left["explicit"][0], 0, delta=0.01)
        why = (r"note: gas is dense, but the last 100 steps had no implicit acoustics\. Such a step would be limited by: (?:thin gas|flow), cell at "
               r"\(\S+ \S+ \S+\) with alpha = 0\.\d+, T = \S+, c = \S+\n +to \d\S* explicit steps, and `gain` of `acoustics` asks for 8\n.*`gain`")
        self.assertEqual([len(re.findall(why, logs[word])) for word in ("written", "explicit", "default")], [0, 0, 1])

    def test_slot(self):
        """Packed gas over an outlet falls out of it and gets no energy there: under gravity there is a void outside."""
        case, _ = self.new(self.geo("slot"), "-gravity", "9.81", "-diameter", "1e-3", "-end", "0.16")
        self.assertEqual(entries.get(os.path.join(case, "0.orig", "alpha"), "boundaryField/outlet/value"), "uniform 1e-6")
        self.run_case(case)
        with open(os.path.join(case, "log.granularGas")) as f:
            log = f.read()
        mass, energy = np.array(re.findall(r"(?m)^ +mass (\S+) .* energy (\S+)", log), dtype=float).T
        self.assertTrue((np.diff(mass) < 0).all(), mass)
        self.assertLess(energy[1:].max(), energy[0])
        self.assertLess(mass[-1], 0.3 * mass[0])

    def packed(self, outlet, start, acoustics, *words):
        """Runs a case whose outlet is zeroGradient; its log. start: what gives alpha and T at the start, or None."""
        case = os.path.join(self.folder, f"packed{len(os.listdir(self.folder))}")
        self.call(case, *words)
        with open(os.path.join(case, "system", "fvSolution"), "w") as f:
            f.write(f"acoustics {{ type {acoustics} }} limits {{ alphaFloor 1e-6; }}\n")
        for field in ("alpha", "T"):
            path = os.path.join(case, "0.orig", field)
            with open(path) as f:
                text = re.sub(rf"(?m)^( +{outlet} +)\{{.*", r"\1{ type zeroGradient; }", f.read())
            with open(path, "w") as f:
                f.write(text if start is None else re.sub(r"(?m)^(internalField|expression).*", f"internalField uniform {start[field]};", text))
        return harness.program("granularGas", "-case", case).stdout

    def test_outlet_without_pressure(self):
        """Packed gas at an outlet that gives no pressure takes explicit steps: a funnel of triangles runs out as fast, a lattice says what to give."""
        logs = [self.packed("outlet", None, kind, self.geo("slot"), "-gravity", "9.81", "-diameter", "1e-3", "-end", "0.12")
                for kind in ("explicit;", "automatic; automaticCoeffs { gain 2; }")]
        left = [float(re.findall(r"(?m)^ +mass (\S+)", log)[-1]) for log in logs]
        self.assertAlmostEqual(left[1] / left[0], 1, delta=0.03)
        log = self.packed("bottom", {"alpha": 0.63, "T": 0.001}, "implicit; implicitCoeffs { gain 2; }", "-box", "0.008x0.04", "-cells", "8x40",
                          "-gravity", "9.81", "-diameter", "1e-3", "-patch", "bottom=outlet", "-end", "0.02")
        self.assertRegex(log, r"limited by: packed gas at an open patch without pressure\n.*\n.*fixedValue 1e-6 of alpha")
        self.assertNotIn("implicit acoustics:", log)

    def test_a_layer_in_no_box(self):
        """In a closed funnel with a rod, an expression lays the layer, for a settledLayer wants a box; nothing is lost."""
        case, said = self.new(self.geo("funnel"), "-gravity", "9.81", "-diameter", "2e-3", "-patch", "exit=wall")
        self.assertIn("a layer, 15 diameters deep", said)
        self.assertEqual(entries.get(os.path.join(case, "0.orig", "alpha"), "expression"), "y < 0.03 ? 0.6 : 1e-6")
        made = self.run_case(case, 0.003)
        mass = [(made.field("rho", t) * made.volumes).sum() for t in ("0", made.times[-1])]
        self.assertAlmostEqual(mass[1] / mass[0], 1, delta=1e-12)

    def test_rest(self):
        """A layer that nothing shakes stays where it is."""
        case, said = self.new("-box", "1x1", "-cells", "10x40", "-gravity", "9.81")
        self.assertIn("a layer", said)
        self.assertEqual(entries.get(os.path.join(case, "system", "fvSolution"), "acoustics/type"), "automatic")
        made = self.run_case(case, 0.3)
        heights = [(rho * made.volumes * made.centres[:, 1]).sum() / (rho * made.volumes).sum() for rho in (made.field("rho", "0"), made.field("rho"))]
        self.assertLess(abs(heights[1] - heights[0]), 0.02 * entries.get(os.path.join(case, "constant", "granularProperties"), "grain/diameter"))
        self.assertEqual(entries.get(os.path.join(case, "constant", "g"), "value"), [0, -9.81, 0])

    def test_friction(self):
        """A bed on a floor under gravity rubs, and newCase says so; without gravity, shaken, or of hard grains nothing rests."""
        floor = ["-box", "1x1", "-cells", "8x8", "-gravity", "9.81"]
        for words, rubs in (([], True), (["-shaking", "2.5,0.1"], False), (["-application", "granularMD"], False)):
            case, said = self.new(*floor, *words)
            with open(os.path.join(case, "constant", "granularProperties")) as f:
                self.assertEqual("friction" in f.read(), rubs)
            self.assertEqual("friction glass beads, friction { type muI; } in constant/granularProperties" in said, rubs)
        self.assertNotIn("friction", self.new("-box", "1x1", "-cells", "8x8")[1])

    def test_gravity(self):
        """A number is downwards whatever its sign, and the message says so; two numbers are a vector of the plane; upwards is warned of."""
        for words, value, says in (("-9.81", [0, -9.81, 0], r"gravity +\(0 -9.81 0\): the magnitude of -9.81, downwards"), ("9.81", [0, -9.81, 0], r"gravity +\(0 -9.81 0\)\n"),
                                   ("0,-9.81", [0, -9.81, 0], r"gravity +\(0 -9.81 0\)\n"), ("1,-2,0", [1, -2, 0], r"gravity +\(1 -2 0\)\n")):
            with self.subTest(words):
                case, said = self.new("-box", "1x1", "-cells", "8x8", "-gravity", words)
                self.assertRegex(said, says)
                self.assertEqual(entries.get(os.path.join(case, "constant", "g"), "value"), value)
        said = self.call("upwards", "-box", "1x1", "-cells", "8x8", "-gravity", "0,9.81")
        self.assertIn("[upwardGravity]", said)
        self.assertIn("to be run with warnings", said)

    def test_units(self):
        """rho counts grains, so nothing is in kg; lengths are in m or cm where gravity is the earth's, else without a label."""
        for g, length, time, rho in (("9.81", "m", "s", "1/m^3"), ("981", "cm", "s", "1/cm^3"), ("1", "", "", "")):
            with self.subTest(g):
                case = harness.haff.Case(self.new("-box", "1x1", "-cells", "8x8", "-gravity", g)[0])
                self.assertEqual(case.units, {"length": length, "mass": "", "time": time})
                harness.program("initialFields", case.path)
                self.assertEqual(harness.haff.Case(case.path).unit("rho"), rho)
        self.assertEqual(harness.haff.Case(self.new("-box", "1", "-cells", "20")[0]).units, {"length": "", "mass": "", "time": ""})

    def test_plate(self):
        """The message gives the amplitude A g/(2 pi f)^2; an end before the first stroke has times of its own; a stroke in metres is warned of."""
        _, said = self.new("-box", "40x32", "-cells", "20x8", *GRAVITY, "-end", "0.02")
        self.assertIn("cells are 2 x 4 wide", said)
        self.assertIn("shaken by 2.5 g at 0.1 strokes in a unit of time", said)
        self.assertIn("plate    moves by +-6.333, at most 3.979 fast, with 2.5 of acceleration", said)
        self.assertIn("end      0.02, written every 0.0005", said)
        self.assertIn("[faintShaking]", self.call("metres", "-box", "1x1", "-cells", "8x8", "-gravity", "9.81", "-shaking", "0.004,10"))

    def test_grains_in_space(self):
        self.run_case(self.new("-box", "1x1x1", "-cells", "5x5x5", "-application", "granularMD", "-diameter", "0.08")[0], 0.2)

    def test_unknown_names(self):
        """They are walls, and the message says so, with the cure; and a .msh is as good as a .geo."""
        geo = self.geo("unknown")
        with open(geo, "a") as f:
            f.write("\n")
        subprocess.run(["gmsh", "-3", "-v", "1", geo, "-o", geo.replace(".geo", ".msh")], check=True, capture_output=True)
        case, said = self.new(geo.replace(".geo", ".msh"))
        self.assertRegex(said, r"note +quux, foo7: if that is no wall, say  -patch quux=outlet")
        self.assertEqual(self.patch(case, "U", "quux"), "slip")
        with open(os.path.join(case, "0.orig", "U")) as f:
            self.assertRegex(f.read(), r"quux .*// a wall, for its name says nothing else")
        with open(os.path.join(case, "Allrun")) as f:
            self.assertNotIn("gmsh -3", f.read())
        self.assertNotIn("mesh.geo", os.listdir(case))
        case, said = self.new(geo, "-patch", "quux=outlet", "-patch", "foo7=inlet", "-speed", "2,0,0")
        self.assertEqual((self.patch(case, "U", "quux"), self.patch(case, "U", "foo7")), ("zeroGradient", "fixedValue"))
        self.assertNotIn("note", said)

    def test_one_layer_of_cells(self):
        """A mesh of one cell between front and back is one of two dimensions; periodic patches find each other."""
        case, said = self.new(self.geo("layer1"))
        self.assertRegex(said, r"400 cells, 2D, a lattice")
        kinds = {name: kind for name, (kind, _, _) in harness.haff.Case(case).mesh.patches.items()}
        self.assertEqual(kinds, {"frontAndBack": "empty", "periodicTop": "cyclic", "periodicBottom": "cyclic", "inflow": "patch", "outflow": "patch"})
        self.run_case(case, 0.3)

    def test_every_entry_is_explained(self):
        """An entry of a dictionary stands in its line with a comment; the file has a header; nothing is there that no one reads."""
        case, _ = self.new(*SPARE, *GRAVITY, "-periodic", "left,right", "-transport")
        for folder in ("0.orig", "constant", "system"):
            for name in os.listdir(os.path.join(case, folder)):
                path = os.path.join(case, folder, name)
                if os.path.isdir(path) or name in ("meshDict",):
                    continue
                with open(path) as f:
                    text = f.read()
                self.assertRegex(text, rf'^FoamFile\n\{{\n(.*\n)*?    object      {name};\n\}}\n', name)
                for line in text.split("\n}\n", 1)[1].splitlines():
                    if re.search(r"[;}]", line) and not re.match(r"//|\}|\w+Schemes \{\}", line.strip()):
                        self.assertIn(" // ", line, f"{name}: {line}")
        with open(os.path.join(case, "system", "controlDict")) as f:
            self.assertRegex(f.read(), r"\nmaxCo +1; +// largest Courant number")

    def test_version(self):
        case, _ = self.new("-box", "1", "-cells", "20")
        cmake = open(os.path.join(harness.SOURCE, "CMakeLists.txt")).read()
        self.assertEqual(entries.get(os.path.join(case, "system", "controlDict"), "haffVersion"), float(re.search(r"haff VERSION (\d+\.\d+)", cmake)[1]))

    def test_in_the_folder_of_the_mesh(self):
        """DIR may hold the mesh, which stays as it is; files that it merges come along."""
        folder = os.path.join(self.folder, "own")
        os.makedirs(os.path.join(self.folder, "parts"))
        os.mkdir(folder)
        with open(os.path.join(folder, "mesh.geo"), "w") as f:
            f.write(GEOMETRIES["tube"])
        self.assertIn("\n    ./Allrun\n", self.call(".", "mesh.geo", cwd=folder))
        with open(os.path.join(folder, "mesh.geo")) as f:
            self.assertEqual(f.read(), GEOMETRIES["tube"])
        with open(self.geo("unknown"), "a") as f:
            f.write("\n")  # without it gmsh 4.8 frees twice what it merges
        with open(os.path.join(self.folder, "merging.geo"), "w") as f:
            f.write('Merge "unknown.geo";\n')
        self.assertIn("unknown.geo", os.listdir(self.new(os.path.join(self.folder, "merging.geo"))[0]))

    def test_readme(self):
        """The line of README.md from newCase to haffPlot, as it stands, with a mesh of one's own; other tests look at the report of Allrun."""
        with open(os.path.join(harness.SOURCE, "README.md")) as f:
            line = re.search(r"^    (newCase .*)$", f.read(), re.M)[1]
        folder = os.path.join(self.folder, "readme")
        os.mkdir(folder)
        shutil.move(self.geo("layer1"), os.path.join(folder, "mesh.geo"))
        env = {k: v for k, v in os.environ.items() if not k.startswith(("HAFF", "PYTHON"))}
        done = subprocess.run(["sh", "-c", line], cwd=folder, capture_output=True, text=True, env={**env, "PATH": f"{self.programs}:/usr/bin:/bin", "MPLBACKEND": "Agg"})
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])
        self.assertIn("end at time 3:", done.stdout)
        self.assertTrue(os.path.isfile(os.path.join(folder, re.search(r"newCase (\w+)", line)[1], done.stdout.splitlines()[-1])), done.stdout)

    def test_nothing_is_overwritten(self):
        folder = os.path.join(self.folder, "taken")
        os.mkdir(folder)
        for name in ("notes.txt",):
            with open(os.path.join(folder, name), "w") as f:
                f.write("mine")
        self.assertIn("taken is not empty (it holds notes.txt)", self.call(folder, "-box", "1", code=1))
        self.assertEqual(os.listdir(folder), ["notes.txt"])
        self.assertIn("no folder", self.call(os.path.join(folder, "notes.txt"), "-box", "1", code=1))

    def test_refused(self):
        """With the cure; and nothing is left behind."""
        geo = {name: self.geo(name) for name in GEOMETRIES}
        wrong = [(1, [geo["nogroup"]], r'no physical groups; name the boundary with Physical Curve\("NAME"\)'), (1, [geo["broken"]], "gmsh cannot make a mesh .*\n.*line 1: syntax error"),
                 (1, [geo["tube"] + "x"], "no such file; did you mean tube.geo"), (1, [self.folder], "is a folder"), (1, [geo["lonely"]], "say which with  -periodic NAME,NAME"),
                 (1, ["-Mach", "2"], "no patch is an inlet.*-patch NAME=inlet"), (1, ["-shaking", "2,1"], "it wants  -gravity"), (1, ["-patch", "left=inlt"], "did you mean inlet"),
                 (1, ["-patch", "lft=inlet"], "did you mean left"), (1, ["-periodic", "left,rigt"], "no patch 'rigt'; there are left"), (1, ["-alpha", "0.7"], "between 0 and 0.64"),
                 (1, ["-restitution", "2"], "between 0 and 1"),
                 (1, ["-box", "1", "-application", "granularMD"], "two or three dimensions"), (1, ["-grains", "disks", "-box", "1x1x1", "-cells", "4x4x4"], "take spheres"),
                 (1, ["-application", "granularMD", "-grains", "spheres"], "leave out  -grains spheres"), (1, ["-gravity", "0,0,1"], "the mesh has no z"),
                 (2, ["-restitutoin", "1"], "did you mean -restitution"), (2, ["-box", "1x1", "-cells", "4"], "2 lengths and 1 numbers"), (2, ["-gravity", "down"], "a number, downwards, or a vector"),
                 (1, ["-box", "1x1x1", "-cells", "4x4x4", "-gravity", "0,-1"], "3 axes are solved; give a number, downwards, or X,Y,Z"),
                 (2, ["-cells", "99999999x99999999"], "1e\\+16 cells are too many for gmsh.*system/blockMeshDict"),
                 (2, [geo["tube"], "-box", "1"], "where no mesh is given"), (2, ["-speed", "1,2"], "a velocity as 1,0,0"), (2, ["-box", "0x1"], "one to three lengths"),
                 (2, ["-diameter", "1e300"], "from 1e-30 to 1e30"), (2, ["-speed", "1e300"], "from 1e-30 to 1e30"), (2, ["-box", "1e-300x1"], "one to three lengths"), (2, ["-end", "0"], "above 0"),
                 (1, ["-application", "granularMD", "-diameter", "1e-9"], "grains, more than can be computed")]
        for code, words, says in wrong:
            wants = words[0].startswith(self.folder) or "for gmsh" in says  # other boxes are made without gmsh, whose start takes longer
            with self.subTest(words):
                said = self.call("made", *words, code=code, gmsh=wants)
                self.assertRegex(said, says)
                self.assertNotRegex(said, "Traceback")
                self.assertFalse(os.path.exists(os.path.join(self.folder, "made")))

    def test_box_without_gmsh(self):
        """newCase writes the mesh of a box itself where gmsh is missing: cells and patches are those of gmsh's."""
        for box, cells in (("2", "6"), ("2x1", "6x4"), ("1x2x3", "2x3x4")):
            made = {}
            for folder in ("with", "without"):
                case = os.path.join(self.folder, box + folder)
                self.call(case, "-box", box, "-cells", cells, "-diameter", "0.05", gmsh=folder == "with")
                self.assertEqual(os.path.exists(os.path.join(case, "mesh.geo")), folder == "with")
                found = geometry.Geometry(case)
                made[folder] = (found.cells, found.axes, found.lattice, {(p.name, p.type, p.faces) for p in found.patches},
                                [round(float(x), 9) for p in sorted(found.patches, key=lambda p: p.name) for x in (*p.normal * p.area, *p.low)])
            self.assertEqual(made["with"], made["without"], box)

    def test_warnings_are_told(self):
        """A case that can run but is probably wrong is written, with checkCase's warning, its file and line."""
        said = self.call("coarse", "-box", "1x1", "-cells", "20x20", "-diameter", "0.3")
        self.assertRegex(said, r"warning: coarse/constant/granularProperties:\d+: .*\[largeGrains\]")
        self.assertIn("with warnings", said)


class Names(unittest.TestCase):
    def test_kinds(self):
        known = {"inlet": "inlet inlet_2 leftInlet INLET inflow in gasIn", "outlet": "outlet outlet2 Outflow exit rightOutlet", "open": "farField far_field open openTop freestream",
                 "wall": "wall walls upperWall floor lid left right_1 bottom sideWalls inletWall wallOutlet", "body": "cylinder cylinder1 theSphere obstacle step",
                 "symmetry": "symmetry symmetryPlane symmetryBottom mirror", "periodic": "periodicLeft cyclic1", "sides": "front back frontAndBack", None: "quux foo7 alpha inx"}
        for kind, names in known.items():
            for name in names.split():
                self.assertEqual(patches.kind_of(name), kind, name)

    def test_direction(self):
        """Against the inlet's normal, along the mirror."""
        patch = lambda name, kind, normal: types.SimpleNamespace(name=name, type=kind, normal=np.array(normal, float), area=1.0, plane=True)
        o = newCase.parse(["d"])
        found = types.SimpleNamespace(axes=[0, 1], patches=[patch("a", "patch", (0.6, -0.8, 0)), patch("b", "patch", (0, -1, 0))])
        made = flow.Flow.__new__(flow.Flow)
        made.o, made.geometry, made.kind = o, found, {"a": "inlet", "b": "outlet"}
        np.testing.assert_allclose(made.direction(), (-0.6, 0.8, 0))
        made.kind["b"] = "symmetry"
        np.testing.assert_allclose(made.direction(), (-1, 0, 0))

    def test_box_is_a_lattice_of_any_dimension(self):
        self.assertIn("Extrude {0, 0, D}", geometry.box([1, 2, 3], [4, 5, 6]))
        self.assertIn('Physical Point("left") = {1};', geometry.box([1], [4]))


if __name__ == "__main__":
    unittest.main()
