# SPDX-License-Identifier: GPL-3.0-or-later
"""granularMD through the real program: restarts to the bit, balances, fields against the grains, shaking, clouds, VTK, errors."""
import importlib.util
import os
import re
import shutil
import signal
import subprocess
import time
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from tests.solvers.programs.bad_rows import Row
from tests.solvers.programs.test_bad_input import snapshot

from haff.case import grains  # noqa: E402

CONTROL = """application granularMD;
startFrom latestTime;
endTime {end};
writeControl adjustableRunTime;
writeInterval {interval};
writeFormat {format};
writePrecision 17;
timePrecision 12;
runTimeModifiable no;
"""
PROPERTIES = """grain
{{
    diameter 1;
    mass 1;
    restitution {e};
    thresholdSpeed {threshold};
}}
equationOfState GoldshteinShapiro;
TorquatoDisksCoeffs {{ }}
JenkinsRichmanCoeffs {{ }}
cooling Haff;
transport none;
"""
PERIODIC = {"x": "cyclic", "y": "cyclic", "z": "cyclic"}
OPENFOAM = "/usr/share/openfoam"
VTK = importlib.util.find_spec("vtkmodules")  # the whole of vtk takes a second to import


def points(path):
    """The POLYDATA of a file, by VTK."""
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    reader = vtkXMLUnstructuredGridReader() if path.endswith(".vtu") else vtkPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def values(data, name):
    array = data.GetPointData().GetArray(name)
    return np.array([array.GetTuple(i) for i in range(data.GetNumberOfPoints())]).squeeze()


def rules(names, types, wall):
    entry = "    {0}\n    {{\n        type {1};\n    }}\n"
    kind = {n: "empty" if n.endswith("Empty") else types.get(n[0], "patch") for n in names}
    return "boundaryField\n{\n" + "".join(entry.format(n, kind[n] if kind[n] in ("empty", "cyclic") else wall) for n in names) + "}\n"


def make(case, cells=(8, 8, 1), size=(16.0, 16.0, 1.0), types=PERIODIC, alpha=0.3, T=1, e=0.9, threshold=0, end=1,
         interval=0.5, format="binary", g=None, shaking=None, particles=None, control=""):
    """Grains of diameter and mass 1 in a box; walls at the ends of axes that are not cyclic."""
    boxes.write_mesh(case, cells, size, {a: t for a, t in types.items() if cells["xyz".index(a)] > 1})
    names = [n for a, k in zip("xyz", cells) for n in ([a + "Empty"] if k == 1 else [a + "Low", a + "High"])]
    scalar, vector = rules(names, types, "zeroGradient"), rules(names, types, "slip")
    files = {"system/controlDict": ("dictionary", CONTROL.format(end=end, interval=interval, format=format) + control),
             "constant/granularProperties": ("dictionary", PROPERTIES.format(e=e, threshold=threshold)),
             "0/alpha": ("volScalarField", f"dimensions [0 0 0 0 0 0 0];\ninternalField uniform {alpha};\n" + scalar),
             "0/T": ("volScalarField", f"dimensions [0 2 -2 0 0 0 0];\ninternalField uniform {T};\n" + scalar),
             "0/U": ("volVectorField", "dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (0 0 0);\n" + vector)}
    if particles:
        files["constant/particleProperties"] = ("dictionary", particles)
    if g:
        files["constant/g"] = ("uniformDimensionedVectorField", "dimensions [0 1 -2 0 0 0 0];\nvalue (%g %g %g);\n" % g)
    if shaking:
        files["constant/shaking"] = ("dictionary", shaking)
    for path, (kind, text) in files.items():
        folder, name = os.path.split(path)
        os.makedirs(os.path.join(case, folder), exist_ok=True)
        with open(os.path.join(case, path), "w") as f:
            f.write(boxes.header(kind, name, folder) + text)
    return case


def cloud(case, positions, U=None):
    """The user's own grains at time 0: rows x, y, z, cell."""
    folder = os.path.join(case, "0", "lagrangian", "grains")
    os.makedirs(folder)
    for name, kind, rows in (("positions", "Cloud<passiveParticle>", ["(%.17g %.17g %.17g) %d" % tuple(r) for r in positions]),
                             ("U", "vectorField", U and ["(%.17g %.17g %.17g)" % tuple(r) for r in U])):
        if rows:
            with open(os.path.join(folder, name), "w") as f:
                f.write(boxes.header(kind, name, "0/lagrangian/grains") + f"{len(rows)}\n(\n" + "\n".join(rows) + "\n)\n")
    return case


def by_steps(case, steps):
    """The run ends at the first write, after that number of steps; there is no endTime."""
    harness.edit(case, "system/controlDict", writeControl="timeStep", writeInterval=steps)
    path = os.path.join(case, "system", "controlDict")
    with open(path) as f:
        text = re.sub(r"endTime .*\n", "stopAt nextWrite;\n", f.read())
    with open(path, "w") as f:
        f.write(text)


def solve(case, **options):
    return harness.program("granularMD", "-case", case, **options).stdout


def results(case, name):
    """All of a time but what tells how it was come to."""
    return {k: v for k, v in runs.contents(os.path.join(case, name)).items() if k not in ("uniform/time", "uniform/checksums")}


LAYER = {"alpha": 0.4, "g": (0, -1, 0), "types": {"x": "cyclic", "y": "wall"}, "threshold": 0.01, "interval": 0.5,
         "shaking": "type sinusoidal;\namplitude 2;\nfrequency 0.3;\n"}


class Particles(harness.Folder, unittest.TestCase):
    def case(self, name, **options):
        return make(os.path.join(self.folder, name), **options)

    def test_restart(self):
        """Stops anywhere, also in the middle of a window of averages, leave no trace."""
        for name, more in (("cell", "window 0.3; samples 7;"), ("Gaussian", "kernel Gaussian; window 0.2;"), ("Heaviside", "kernel Heaviside; width 1.5;")):
            options = {**LAYER, "particles": "coarseGraining { %s }\n" % more}
            whole = self.case("whole" + name, end=2, **options)
            parts = self.case("parts" + name, end=0.11, **options)
            solve(whole)
            for end in (0.11, 0.3123, 0.9, 1.31, 2):
                harness.edit(parts, "system/controlDict", endTime=end)
                self.assertRegex(solve(parts), r"as time \S+ has them, to the bit\n|put in place")
            for at in ("0.5", "1", "2"):
                runs.same(self, results(whole, at), results(parts, at), f"{name}, {at}")

    def test_shear(self):
        """A sheared box: restarts to the bit, the balance with the work of its ends; what cannot be sheared is refused."""
        options = {"alpha": 0.3, "e": 0.9, "particles": "shearRate 0.8;\n"}
        whole, parts = self.case("sheared", end=2, **options), self.case("shearedParts", end=0.3, **options)
        balance = re.findall(r"lost \S+ \(balance (\S+)\)", solve(whole))
        self.assertLess(max(abs(float(b)) for b in balance), 1e-13)
        for end in (0.3, 1.23, 2):
            harness.edit(parts, "system/controlDict", endTime=end)
            solve(parts)
        for at in ("0.5", "2"):
            runs.same(self, results(whole, at), results(parts, at), at)
        harness.edit(parts, "constant/particleProperties", shearRate=0.9)
        harness.edit(parts, "system/controlDict", endTime=3)
        done = harness.program("granularMD", "-case", parts, check=False)
        self.assertIn("the shearRate was 0.8 and is 0.9 now", done.stderr)
        walled = self.case("shearedWalls", **options | {"types": {"x": "cyclic", "y": "wall"}})
        done = harness.program("granularMD", "-case", walled, check=False)
        self.assertRegex(done.stderr, r"particleProperties:\d+: .*cyclic along all axes; along y it is not")

    def test_killed(self):
        """SIGTERM writes and stops; SIGKILL loses what was not written; both runs go on to the same end."""
        whole, parts = (self.case(n, e=1, T=1, end=40, interval=10, particles="N 120;\n") for n in ("unbroken", "killed"))
        solve(whole)
        for sign in (signal.SIGTERM, signal.SIGKILL):
            p = subprocess.Popen([os.path.join(harness.BIN, "granularMD"), "-case", parts], stdout=subprocess.PIPE, text=True)
            for line in p.stdout:
                if line.startswith("Time = "):
                    p.send_signal(sign)
                    break
            p.stdout.read()
            p.stdout.close()
            self.assertEqual(p.wait(), 0 if sign == signal.SIGTERM else -signal.SIGKILL)
        solve(parts)
        runs.same(self, results(whole, "40"), results(parts, "40"))

    def test_balances(self):
        """The log gives the energy lost in impacts to round-off; momentum stays; elastic grains keep all energy."""
        for dim in (2, 3):
            for e in (1, 0.8):
                cells, size = ((8, 8, 1), (16.0, 16.0, 1.0)) if dim == 2 else ((5, 5, 5), (8.0, 8.0, 8.0))
                case = self.case(f"balance{dim}{e}", cells=cells, size=size, e=e, end=5, interval=5)
                said = solve(case)
                self.assertLess(max(abs(float(v)) for v in re.findall(r"balance ([-+.e\d]+)\)", said)), 1e-13)
                a, b = (grains.read(harness.haff.Case(case), t) for t in ("5", "5"))
                n = len(a["x"])
                energy = 0.5 * np.sum(b["U"] ** 2)
                self.assertLess(np.abs(np.sum(b["U"], axis=0)).max(), 1e-12 * n)
                kinetic, lost = (float(v) for v in re.findall(r"kinetic ([-.e\d]+) .* lost ([-.e\d]+)", said)[-1])
                self.assertAlmostEqual(energy / kinetic, 1, delta=1e-9)
                self.assertAlmostEqual((energy + lost) / (dim * n / 2), 1, delta=1e-9)  # T = 1 at the start, exactly
                self.assertLess(abs(lost), 1e-12 * energy) if e == 1 else self.assertGreater(lost, 0.1 * energy)
                self.assertGreater(int(re.findall(r"collisions (\d+)", said)[-1]), n)

    def test_fields(self):
        """Fields of a moment are those of the cloud that is written with them, cell by cell."""
        case = self.case("moment", control="functions { m { type volFieldValue; fields (rho); operation volIntegrate; } }\n",
                         cells=(5, 4, 1), size=(20.0, 16.0, 1.0), end=1, interval=1, particles="coarseGraining { window 10; }\n")
        solve(case)
        found = harness.haff.Case(case)
        c, n = grains.read(found, "1"), found.mesh.cells
        alpha, rho, U, T, p = (found.field(f, "1") for f in ("alpha", "rho", "U", "T", "p"))
        np.testing.assert_array_equal(c["cell"], np.floor(c["x"][:, 0] / 4) + 5 * np.floor(c["x"][:, 1] / 4))
        count = np.bincount(c["cell"], minlength=n)
        np.testing.assert_allclose(rho, count / 16, rtol=1e-14)
        np.testing.assert_allclose(alpha, np.pi / 4 * rho, rtol=1e-14)
        for i in range(n):
            u = c["U"][c["cell"] == i]
            np.testing.assert_allclose(U[i], u.mean(axis=0), atol=1e-14)
            self.assertAlmostEqual(T[i], np.sum((u - u.mean(axis=0)) ** 2) / (2 * len(u)), delta=1e-13)
        np.testing.assert_allclose(p, rho * T, rtol=1e-13)
        mass = found.table("m", "volFieldValue.dat")
        np.testing.assert_allclose(mass[:, 1], len(c["x"]), rtol=1e-14)

    def test_windows(self):
        """Means over a window hold all mass and p its impacts: p V = N T + impulses over time, Enskog's within its noise."""
        case = self.case("window", e=1, alpha=0.2, cells=(4, 4, 1), size=(40.0, 40.0, 1.0), end=30, interval=30,
                         particles="coarseGraining { samples 200; }\n")
        solve(case)
        found = harness.haff.Case(case)
        n, p = len(grains.read(found, "30")["x"]), found.field("p", "30").mean()
        self.assertAlmostEqual(found.field("rho", "30").mean() * 1600, n, delta=1e-10 * n)
        nu = n * np.pi / 4 / 1600
        chi = (1 - 7 * nu / 16) / (1 - nu) ** 2
        self.assertAlmostEqual(p / (n / 1600 * (1 + 2 * nu * chi)), 1, delta=0.03)

    def test_shaking(self):
        """Grains at rest in the box frame fall as g (1 + amplitude cos(2 pi f t + phase)) says, exactly."""
        A, f, phase = 2, 0.7, 0.4
        case = self.case("falling", alpha=0.01, T=0, e=1, cells=(4, 50, 1), size=(4.0, 100.0, 1.0), g=(0, -1, 0), end=1,
                         types={"x": "cyclic", "y": "wall"}, shaking=f"type sinusoidal;\namplitude {A};\nfrequency {f};\nphase {phase};\n")
        solve(case)
        one, two = (grains.read(harness.haff.Case(case), t) for t in ("0.5", "1"))
        w = 2 * np.pi * f

        def fallen(t):
            return -(t * t / 2 - A / w**2 * (np.cos(w * t + phase) - np.cos(phase)) - A / w * t * np.sin(phase))
        np.testing.assert_allclose(two["x"][:, 1] - one["x"][:, 1], fallen(1) - fallen(0.5), atol=1e-12)
        np.testing.assert_allclose(two["U"][:, 1], -(1 + A / w * (np.sin(w + phase) - np.sin(phase))), atol=1e-12)

    def test_ramp(self):
        """Refused: the plate of grains moves by a formula of one amplitude."""
        case = self.case("ramp", **{**LAYER, "shaking": "type sinusoidal;\namplitude table ((0 2) (1 3));\nfrequency 1;\n"}, end=3)
        done = harness.program("granularMD", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"constant/shaking:\d+: key 'amplitude' .* constant amplitude")

    def test_warnings(self):
        """Of numbers that are hardly meant, as of a gas: restitution without effect, a density for a mass, gravity, shaking."""
        box = {"types": {"x": "cyclic", "y": "wall"}, "g": (0, -1, 0), "interval": 1}
        shaking = "type sinusoidal;\namplitude {};\nfrequency {};\n"
        for name, options, warned in (
                ("threshold", {"threshold": 100}, "elasticGrains"), ("sound", {"threshold": 0.01}, None), ("up", {"g": (0, 1, 0)}, "upwardGravity"),
                ("faint", {"shaking": shaking.format(0.5, 0.3)}, "faintShaking"), ("omega", {"shaking": shaking.format(3, 12.566)}, "faintShaking"),
                ("shaken", {"shaking": shaking.format(3, 0.3)}, None)):
            with self.subTest(name):
                case = self.case(name, **{**box, **options}, control="acceptWarnings (otherShape);\n")
                said = harness.program("checkCase", case).stdout
                self.assertEqual(re.findall(r"^warning: .* \[(\w+)\]$", said, re.M), [warned] if warned else [])
                if name == "shaken":
                    self.assertRegex(said, r"plate +moves by \+-0.8443 m, at most 1.592 m/s and 3 m/s\^2\n")
        case = self.case("metal", **box)
        harness.edit(case, "constant/granularProperties", mass=2e5)
        self.assertIn("[heavyGrains]", harness.program("checkCase", case).stdout)

    def test_momentum(self):
        """Of a shaken layer: what gravity in the frame of the box gives, less what the walls take, is what the grains have."""
        A, f, phase = 2, 0.3, 0.9
        case = self.case("layer", **{**LAYER, "shaking": f"type sinusoidal;\namplitude {A};\nfrequency {f};\nphase {phase};\n"},
                         end=3, control="maxDeltaT 0.1;\n")
        solve(case)
        rows, n = harness.haff.Case(case).table("grains", "grains.dat"), len(grains.read(harness.haff.Case(case), "3")["x"])
        t, momentum, low, high = rows[:, 0], rows[:, 10], rows[:, 11], rows[:, 12]
        w = 2 * np.pi * f
        given = -n * (t + A / w * (np.sin(w * t + phase) - np.sin(phase)))
        self.assertEqual(len(t), 31)
        self.assertGreater(low[-1], 0.5 * n)
        np.testing.assert_allclose(momentum, given + low - high, atol=1e-11 * n)
        np.testing.assert_allclose(momentum[-1], np.sum(grains.read(harness.haff.Case(case), "3")["U"][:, 1]), atol=1e-11 * n)

    def test_collapse(self):
        """Without a threshold a layer at rest collapses, and the log says what to do."""
        case = self.case("collapse", e=0.6, g=(0, -1, 0), types={"x": "cyclic", "y": "wall"}, T=0, size=(8.0, 40.0, 1.0), alpha=0.2,
                         control="logInterval 1;\n")
        by_steps(case, 12)
        self.assertRegex(solve(case), r"warning: .*granularProperties:\d+: .* inelastic collapse[^\n]*thresholdSpeed.*\[collapse\]")

    def test_one_word(self):
        """The case of a gas becomes one of grains by the word of `application`: the same fields, mesh, mass and, after two
        impacts per grain, temperature."""
        gas = self.case("gas", alpha=0.1, cells=(6, 6, 1), size=(60.0, 60.0, 1.0), e=0.9, end=10, interval=5)
        harness.edit(gas, "constant/granularProperties", equationOfState="TorquatoDisks")
        for name in ("fvSchemes", "fvSolution"):
            boxes.write_dictionary(gas, "system", name, "")
        particles = shutil.copytree(gas, os.path.join(self.folder, "grains"))
        harness.edit(gas, "system/controlDict", application="granularGas")
        self.assertIn("this is granularGas", harness.program("granularGas", "-case", particles, check=False).stderr)
        harness.program("granularGas", "-case", gas)
        solve(particles)
        a, b = harness.haff.Case(gas), harness.haff.Case(particles)
        for name in ("alpha", "rho", "U", "T", "p"):
            self.assertEqual(a.field(name, "10").shape, b.field(name, "10").shape)
        n = 0.1 * 3600 / (np.pi / 4)
        self.assertLess(abs(a.field("alpha", "10").mean() - b.field("alpha", "10").mean()), 0.1 * 0.51 / n)
        T = b.table("grains", "grains.dat")
        self.assertAlmostEqual(T[-1, 5] / a.field("T", "10").mean(), 1, delta=0.06)  # the scatter of 460 grains over seeds is 0.015
        self.assertLess(T[-1, 5], 0.7)

    def test_own_cloud(self):
        """Grains that the user puts into 0/lagrangian/grains: two that meet head on, one that hits a wall."""
        case = self.case("own", types={"x": "wall", "y": "wall"}, e=0.5, end=4, interval=2,
                         particles="walls { xLow { restitution 0.25; } }\n")
        cloud(case, [(5, 5, 0.5, 0), (8, 5, 0.5, 0), (2, 12, 0.5, 0)], [(1, 0, 0), (-1, 0, 0), (-1, 0, 0)])
        said = solve(case)
        self.assertIn("3 disks", said)
        c = grains.read(harness.haff.Case(case), "2")
        np.testing.assert_allclose(c["x"][:, :2], [(5.5, 5), (7.5, 5), (0.625, 12)], atol=1e-14)
        np.testing.assert_allclose(c["U"][:, :2], [(-0.5, 0), (0.5, 0), (0.25, 0)], atol=1e-14)

    def test_changed_law(self):
        """A restart with other grains or gravity predicts anew and says so; one with other averages keeps its grains."""
        case = self.case("changed", e=1, end=1, interval=1)
        solve(case)
        here = grains.read(harness.haff.Case(case), "1")
        harness.edit(case, "constant/granularProperties", restitution=0.9)
        harness.edit(case, "system/controlDict", endTime=2)
        said = solve(case)
        self.assertIn("grain.restitution 1 -> 0.9", said)
        self.assertIn("have changed", said)
        energy = [0.5 * np.sum(c["U"] ** 2) for c in (here, grains.read(harness.haff.Case(case), "2"))]
        lost = float(re.findall(r"lost ([-.e\d]+)", said)[-1])
        self.assertAlmostEqual(energy[1] + lost, energy[0], delta=1e-9 * energy[0])
        harness.edit(case, "system/controlDict", endTime=3, writeInterval=0.5)  # the window, too
        self.assertRegex(solve(case), r"as time 2 has them, to the bit; .*averages begin anew")

    def test_formats(self):
        """ascii, compressed and binary times hold the same numbers; each can be started from."""
        found = {}
        for format, more in (("binary", ""), ("ascii", ""), ("ascii", "writeCompression on;\n")):
            case = self.case("format" + format + more[:5], format=format, control=more, **LAYER)
            solve(case)
            harness.edit(case, "system/controlDict", endTime=1.5)
            solve(case)
            result = harness.haff.Case(case)
            found[format + more[:5]] = [result.field(f, "1.5") for f in ("rho", "U", "T", "p")] + list(grains.read(result, "1.5").values())
        for other in ("ascii", "asciiwrite"):
            for a, b in zip(found["binary"], found[other]):
                np.testing.assert_array_equal(a, b)

    def test_vtk(self):
        """The cloud from the function object and from caseToVTK, read by VTK."""
        if not VTK:
            self.skipTest("VTK's Python module is not there")
        case = self.case("pictures", control="functions { pictures { type vtk; writeControl writeTime; } }\n", end=1)
        solve(case)
        c = grains.read(harness.haff.Case(case), "1")
        for ascii in (None, [], ["-ascii"], ["-vtu"]):
            if ascii is not None:
                shutil.rmtree(os.path.join(case, "VTK"))
                harness.program("caseToVTK", case, *ascii)
            ending = ".vtu" if ascii == ["-vtu"] else ".vtk"
            data = points(os.path.join(case, "VTK", "pictures-grains_1" + ending))
            n = data.GetNumberOfPoints()
            self.assertEqual((n, data.GetNumberOfCells()), (len(c["x"]), len(c["x"])))
            np.testing.assert_array_equal([data.GetPoint(i) for i in range(n)], c["x"])
            for name in ("U", "d", "id"):
                np.testing.assert_array_equal(values(data, name), c[name].astype(float))
            for series, times in (("pictures", 3), ("pictures-grains", 2 if ascii is not None else 3)):
                with open(os.path.join(case, "VTK", series + ending + ".series")) as f:
                    self.assertEqual(f.read().count('"time"'), times, series)

    def test_openfoam(self):
        """foamToVTK reads fields and cloud, in every format."""
        if not shutil.which("foamToVTK"):
            self.skipTest("OpenFOAM is not there")
        for format in ("ascii", "binary"):
            case = self.case("foam" + format, format=format, end=0.5, control="deltaT 0.01;\n")
            for name in ("fvSchemes", "fvSolution"):
                boxes.write_dictionary(case, "system", name, "divSchemes { } gradSchemes { } laplacianSchemes { }\n")
            solve(case)
            done = subprocess.run(["foamToVTK", "-case", case], capture_output=True, text=True, cwd=case,
                                  env={**os.environ, "WM_PROJECT_DIR": OPENFOAM})
            self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])
            written = [os.path.join(base, n) for base, _, names in os.walk(os.path.join(case, "VTK")) for n in names if "grains" in base + n]
            self.assertTrue(any(n.endswith(".vtp") for n in written), done.stdout[-3000:])

    def test_paraview(self):
        """The reader that ParaView uses finds fields and grains."""
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkIOGeometry import vtkOpenFOAMReader
        except ImportError:
            self.skipTest("VTK's Python module is not there")
        for format in ("ascii", "binary"):
            case = self.case("view" + format, format=format, control="deltaT 0.5;\n")
            solve(case)
            with open(case + "/case.foam", "w"):
                pass
            reader = vtkOpenFOAMReader()
            reader.SetFileName(case + "/case.foam")
            reader.UpdateInformation()
            reader.EnableAllCellArrays(), reader.EnableAllLagrangianArrays(), reader.EnableAllPatchArrays()
            reader.SetTimeValue(1), reader.Update()
            blocks = reader.GetOutput()
            cells, points = blocks.GetBlock(0).GetCellData(), blocks.GetBlock(blocks.GetNumberOfBlocks() - 1).GetBlock(0)
            found = harness.haff.Case(case)
            c = grains.read(found, "1")
            np.testing.assert_allclose(vtk_to_numpy(cells.GetArray("alpha")), found.field("alpha", "1"), rtol=2e-7)
            np.testing.assert_allclose(vtk_to_numpy(points.GetPoints().GetData()), c["x"], rtol=2e-7)
            np.testing.assert_allclose(vtk_to_numpy(points.GetPointData().GetArray("U")), c["U"], rtol=2e-7)

    def test_shipped(self):
        """OpenFOAM's tools do not open a case without these."""
        cases = os.path.join(harness.SOURCE, "cases")
        for name in sorted(os.listdir(cases)):
            path = os.path.join(cases, name, "system", "controlDict")
            if not os.path.isfile(path):
                continue
            with open(path) as f:
                text = f.read()
            if "granularMD;" in text:
                self.assertRegex(text, r"(?m)^deltaT +\S+;", path)
                self.assertTrue(all(os.path.isfile(os.path.join(cases, name, "system", f)) for f in ("fvSchemes", "fvSolution")), name)

    def test_step_without_end(self):
        """stopAt nextWrite without endTime, steps counted; few grains that never meet."""
        case = self.case("rest", T=0, alpha=0.02)
        by_steps(case, 5)
        self.assertIn("stopped as asked at time 5", solve(case))


class BadInput(harness.Folder, unittest.TestCase):
    """Each mistake is named with file and line; the exit code is 1 and the case stays as it was."""
    ROWS = [
        Row("gas", ("system/controlDict", "application granularMD;", "application granularGas;"), "this is granularMD", "run granularGas"),
        Row("processors", ("system/controlDict", "writePrecision 17;", "writeProcessors yes;"), "one rank"),
        Row("unknown key", ("constant/particleProperties", "seed 3;", "sead 3;"), "not used", "seed"),
        Row("unknown wall", ("constant/particleProperties", "yLow", "yLo"), "not used", "yLow"),
        Row("not a wall", ("constant/particleProperties", "yLow", "xLow"), "is no wall", "cyclic"),
        Row("restitution of a wall", ("constant/particleProperties", "restitution 0.5;", "restitution 1.5;"), "0 .. 1"),
        Row("kernel", ("constant/particleProperties", "kernel cell;", "kernel Gauss;"), "Gaussian", "Heaviside"),
        Row("samples", ("constant/particleProperties", "samples 10;", "samples 0;"), "samples"),
        Row("window", ("constant/particleProperties", "window 0.1;", "window -0.1;"), "window"),
        Row("windows without end", ("constant/particleProperties", "window 0.1;", "window 1e-50;"), "more than 1e+12 samples", "unit"),
        Row("frequency of no phase", ("constant/shaking", "frequency 0.3;", "frequency 1e50;"), "rad at endTime", "lower frequency", at=""),
        Row("too many", ("constant/particleProperties", "N 100;", "N 400;"), "N 400", "fit"),
        Row("point grains", ("constant/granularProperties", "diameter 1;", "diameter 0;"), "greater than 0"),
        Row("unknown property", ("constant/granularProperties", "cooling Haff;", "coolin Haff;"), "not used", "cooling"),
        Row("open top", ("0/U", "yHigh\n    {\n        type slip;", "yHigh\n    {\n        type fixedValue;\n        value uniform (0 -1 0);"),
            "patch yHigh", "grains come in there, and alpha says not how", "fixedValue", at="type fixedValue;"),
        Row("rough wall", ("0/U", "yLow\n    {\n        type slip;", "yLow\n    {\n        type noSlip;"), "smooth", at="type noSlip;"),
        Row("thermal wall", ("0/T", "yLow\n    {\n        type zeroGradient;", "yLow\n    {\n        type fixedValue;\n        value uniform 1;"),
            "zeroGradient", "give no heat", at="type fixedValue;"),
        Row("packed", ("0/alpha", "uniform 0.3", "uniform 0.95"), "cell 0", "0.9069"),
        Row("negative", ("0/T", "uniform 1", "uniform -1"), "0 or greater"),
        Row("flow out of the plane", ("0/U", "uniform (0 0 0)", "uniform (0 0 1)"), "its z component must be 0"),
        Row("falling for ever", ("constant/g", "(0 -1 0)", "(1 -1 0)"), "its x component", "cyclic"),
        Row("no temperature", lambda case: os.remove(os.path.join(case, "0/T")), "0/T", "temperature"),
        Row("no density", lambda case: os.remove(os.path.join(case, "0/alpha")), "neither rho nor alpha"),
        Row("no velocity", lambda case: os.remove(os.path.join(case, "0/U")), "0/U", "walls"),
        Row("one axis", lambda case: make(case, cells=(8, 1, 1), g=(0, 0, 0)), "two solved axes", base="free"),
        Row("overlap", lambda case: cloud(case, [(5, 5, 0.5, 0), (5.5, 5, 0.5, 0)]), "positions", "overlap", base="free"),
        Row("outside", lambda case: cloud(case, [(5, 15.9, 0.5, 0), (5, 5, 0.5, 0)]), "positions", "15.9", base="free"),
        Row("narrow", lambda case: make(case, cells=(8, 8, 1), size=(2.5, 16.0, 1.0), types={"x": "cyclic", "y": "wall"}, g=(0, 0, 0)),
            "2.5 m", "periodic", "3 m", base="free"),
        Row("kernel too wide", ("constant/particleProperties", "kernel cell;", "kernel Gaussian;\nwidth 100;"),
            "width", where="constant/particleProperties", at=""),
        Row("other N", lambda case: cloud(case, [(5, 5, 0.5, 0)]), "holds 1 grains", where="constant/particleProperties", at="N 100;"),
        Row("cell", lambda case: cloud(case, [(5, 5, 0.5, 64)]), "from 0 to 63", where="0/lagrangian/grains/positions",
            at="(5 5 0.5) 64", base="free"),
        Row("velocities", lambda case: cloud(case, [(5, 5, 0.5, 0), (8, 5, 0.5, 0)], [(1, 0, 0)]), "1 values", "2 grains", base="free"),
    ]
    PARTICLES = "N 100;\nseed 3;\nwalls\n{\n    yLow\n    {\n        restitution 0.5;\n    }\n}\ncoarseGraining\n{\n    kernel cell;\n    window 0.1;\n    samples 10;\n}\n"

    def test_rows(self):
        options = {**LAYER, "alpha": 0.3, "format": "ascii"}
        bases = {"box": make(os.path.join(self.folder, "box"), particles=self.PARTICLES, **options),
                 "free": make(os.path.join(self.folder, "free"), **options)}
        for base in bases.values():
            harness.program("checkCase", base)
        for i, row in enumerate(self.ROWS):
            with self.subTest(row.name):
                case = shutil.copytree(bases[row.base], os.path.join(self.folder, f"row{i}"))
                place, before = row.spoil(case), None
                before = snapshot(case)
                for command in (["granularMD", "-case", case], ["checkCase", case]):
                    if row.name == "gas" and command[0] == "checkCase":
                        continue
                    done = harness.program(*command, check=False, timeout=60)
                    self.assertEqual(done.returncode, 1, done.stdout[-500:] + done.stderr)
                    self.assertEqual(done.stderr.count("error: "), 1)
                    for text in (*row.says, *([place] if place else [])):
                        self.assertIn(text, done.stderr)
                    self.assertEqual(snapshot(case), before)

    def test_flow_out_of_any_plane(self):
        """U along the axis of a plane case is refused, whichever axis that is; along the others it is not."""
        for k, axis in enumerate("xyz"):
            shape = lambda inside, thin, k=k: tuple(thin if j == k else inside for j in range(3))
            case = make(os.path.join(self.folder, axis), cells=shape(8, 1), size=shape(16.0, 1.0), types={a: "cyclic" for a in "xyz" if a != axis}, format="ascii")
            harness.edit(case, "0/U", internalField="uniform (%g %g %g)" % shape(1, 0))
            harness.program("checkCase", case)
            harness.edit(case, "0/U", internalField="uniform (%g %g %g)" % shape(0, 1))
            done = harness.program("checkCase", case, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"its {axis} component must be 0", done.stderr)

    def test_meshes(self):
        """A side of two kinds of wall."""
        case = make(os.path.join(self.folder, "sides"), types={"x": "cyclic", "y": "wall"}, particles="walls { half { restitution 0.5; } }\n")
        path = os.path.join(case, "constant", "polyMesh", "boundary")
        with open(path) as f:
            text = f.read()
        start = int(re.search(r"yLow .* startFace (\d+)", text)[1])
        text = text.replace("\n5\n(", "\n6\n(").replace(f"yLow {{ type wall; nFaces 8; startFace {start};",
                                                        f"yLow {{ type wall; nFaces 4; startFace {start}; }}\n    half {{ type wall; nFaces 4; startFace {start + 4};")
        with open(path, "w") as f:
            f.write(text)
        for name in ("alpha", "T", "U"):
            path = os.path.join(case, "0", name)
            with open(path) as f:
                text = f.read().replace("boundaryField\n{\n", "boundaryField\n{\n    half { type %s; }\n" % ("slip" if name == "U" else "zeroGradient"))
            with open(path, "w") as f:
                f.write(text)
        harness.edit(case, "constant/particleProperties", restitution=1)
        self.assertNotIn("facets", harness.program("checkCase", case).stdout)
        harness.edit(case, "constant/particleProperties", restitution=0.5)
        self.assertRegex(solve(case), r"walls +16 facets\n *yLow +restitution 1\n *half +restitution 0.5\n")

    def test_ranks(self):
        case = make(os.path.join(self.folder, "ranks"))
        done = harness.program("granularMD", "-case", case, ranks=2, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("one rank"), 1, done.stderr)

    def test_damage(self):
        """A state that was cut or changed on the disk is no start, with checksums or without."""
        case = make(os.path.join(self.folder, "damage"), end=0.5)
        solve(case)
        harness.edit(case, "system/controlDict", endTime=1)
        path = os.path.join(case, "0.5", "uniform", "grains")
        with open(path, "rb") as f:
            whole = f.read()
        for bad in (whole[:-100], whole[:300], whole[:1000] + b"\xff" * 9 + whole[1009:]):
            with open(path, "wb") as f:
                f.write(bad)
            done = harness.program("granularMD", "-case", case, check=False)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("uniform/grains", done.stderr)
        os.remove(os.path.join(case, "0.5", "uniform", "checksums"))
        for bad in (whole[:-100], whole[:300], whole[:-1] + b"x"):
            with open(path, "wb") as f:
                f.write(bad)
            done = harness.program("granularMD", "-case", case, check=False)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("uniform/grains", done.stderr)


if __name__ == "__main__":
    unittest.main()
