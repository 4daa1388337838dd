# SPDX-License-Identifier: GPL-3.0-or-later
"""haff fromOpenFOAM: whole cases through the command and the solver; what is refused, with its place; what is said of controlDict."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.openfoam import foam

import haff
from haff.case import entries
from studies.exact.eos import PerfectGas
from studies.exact.riemann import Riemann
from studies.made import rhocentral, twin

R = rhocentral.UNIVERSAL / 28.96
GAMMA = 1004.5 / (1004.5 - R)
SKEWED = foam.BLOCKS.replace("(5 1 -1)", "(5 1.5 -1)").replace("(5 1 1)", "(5 1.5 1)").replace("($n 1 1)", "(20 8 1)").replace(
    "(1 2 6 5)); }", "(1 2 6 5)); } floor { type wall; faces ((0 1 5 4)); } roof { type symmetryPlane; faces ((3 7 6 2)); }")
needs_foam = unittest.skipUnless(rhocentral.installed(), rhocentral.MISSING)


def command(*words):
    return harness.command("fromOpenFOAM", *words)


def command_beside(folder, *words):
    """In a folder whose programs come before others, by a Python of its own."""
    return subprocess.run([sys.executable, "-m", "haff", "fromOpenFOAM", *words], capture_output=True, text=True, timeout=120, cwd=folder,
                          env={**os.environ, "HAFF_BIN": harness.BIN, "PATH": folder + os.pathsep + os.environ["PATH"]})


class Converting(harness.Folder):
    def setUp(self):
        self.folder = tempfile.mkdtemp(dir=type(self).folder)

    def new(self):
        return os.path.join(self.folder, "haff")

    def converted(self, case, *said):
        """The new case; the lines that were said hold some words. checkCase has found it sound, for the command asks it."""
        done = command(case, self.new())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("checkCase finds sound", done.stdout)
        for words in said:
            self.assertIn(words, done.stdout)
        self.said = done.stdout
        return self.new()

    def refused(self, case, *words):
        done = command(case, self.new())
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertFalse(os.path.exists(self.new()), "a refused case leaves nothing")
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertNotIn("Traceback", done.stderr)


class Tube(Converting, unittest.TestCase):
    def test_state(self):
        """p and T in kelvin as rho and R T, set by setFieldsDict; blockMeshDict as it is; no folder of the source is touched."""
        case = foam.tube(self.folder)
        before = sorted(os.path.join(p, n) for p, _, names in os.walk(case) for n in names)
        new = self.converted(case, "boxToCell: set in 50 cells", "defaultFaces -> the patch frontAndBack of type empty", "system/blockMeshDict: 100 cells",
                             f"Cp 1004.5 -> gamma {GAMMA:.10g}", "dropped  system/controlDict:4: cycleWrite",
                             "took     constant/thermophysicalProperties:4: mu 0")
        self.assertEqual(sorted(os.path.join(p, n) for p, _, names in os.walk(case) for n in names), before)
        p, T = np.repeat((1e5, 1e4), 50), np.repeat((348.432, 278.746), 50)
        np.testing.assert_allclose(haff.read_field(os.path.join(new, "0.orig", "T"), 100), R * T, rtol=1e-14)
        np.testing.assert_allclose(haff.read_field(os.path.join(new, "0.orig", "rho"), 100), p / (R * T), rtol=1e-14)
        self.assertFalse(os.path.exists(os.path.join(new, "constant", "polyMesh")))
        with open(os.path.join(new, "fromOpenFOAM.txt"), encoding="utf-8") as f:
            self.assertIn("boxToCell: set in 50 cells", f.read())

    def test_run(self):
        """The solver runs it, to the exact solution."""
        new = self.converted(foam.tube(self.folder))
        harness.program("granularGas", "-case", new)
        done = haff.Case(new)
        sides = [(p / (R * T), 0.0, p) for p, T in ((1e5, 348.432), (1e4, 278.746))]
        exact = Riemann(PerfectGas(GAMMA), *sides).averages(np.linspace(-5, 5, 101), 0.0, 0.005)
        # measured on 100 cells; at the tutorial's end rho has 0.0055 on 100 cells, 0.0032 on 200, 0.0018 on 400
        for name, values, measured in (("rho", exact[0], 0.00536), ("p", exact[2], 0.0044)):
            error = np.abs(done.field(name) - values).mean() / np.ptp(values)
            self.assertLess(error, 1.3 * measured, name)
        np.testing.assert_allclose(done.field("p"), done.field("rho") * done.field("T"), rtol=1e-10)

    @needs_foam
    def test_beside_rhoCentralFoam(self):
        """OpenFOAM's own setFields and solver on the source. Both err by h to some power: on twice the cells they are nearer to each other."""
        apart = []
        for cells in (50, 100):
            folder = os.path.join(self.folder, str(cells))
            case = foam.tube(folder)
            foam.put(case, "system/blockMeshDict", foam.BLOCKS.replace("n 100", f"n {cells}"))
            self.assertEqual(command(case, os.path.join(folder, "haff")).returncode, 0)
            shutil.copytree(os.path.join(case, "0.orig"), os.path.join(case, "0"))
            for name in ("blockMesh", "setFields", "rhoCentralFoam"):
                done = subprocess.run([name, "-case", case], capture_output=True, text=True, env=rhocentral.ENVIRONMENT)
                self.assertEqual(done.returncode, 0, done.stdout[-1000:] + done.stderr[-1000:])
            harness.program("granularGas", "-case", os.path.join(folder, "haff"))
            ours, theirs = haff.Case(os.path.join(folder, "haff")), haff.Case(case)
            apart.append([np.abs(ours.field(name) - scale * theirs.field(name)).mean() / np.ptp(theirs.field(name) * scale)
                          for name, scale in (("p", 1), ("T", R))])
        self.assertTrue((np.array(apart[1]) < apart[0]).all(), apart)


class ThereAndBack(Converting, unittest.TestCase):
    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not there")
    def test_twins(self):
        """The twin for rhoCentralFoam of a case of ours, converted back: the same gas, cells and patches, to round-off."""
        for name, cells in (("sod", 50), ("wedge15Dilute", 10)):
            both = twin.Twin(os.path.join(harness.SOURCE, "cases", name), os.path.join(self.folder, name), harness.BIN, cells=cells)
            new = os.path.join(self.folder, name, "back")
            done = command(both.foam, new)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertAlmostEqual(entries.get(os.path.join(new, "constant", "granularProperties"), "perfectGasCoeffs/gamma"), both.gamma, places=10)
            states = []
            for case in (both.ours, new):
                entries.edit(os.path.join(case, "system", "controlDict"), {"+adjustTimeStep": "no", "deltaT": 1e-30, "stopAt": "writeNow",
                                                                             "+writePrecision": 17})
                harness.program("granularGas", "-case", case)
                done = haff.Case(case)
                states.append({(field, patch): done.field(field) if patch is None else done.patch_values(field, patch)
                               for field in ("rho", "U", "T", "p") for patch in (None, *done.mesh.patches)})
            for key, values in states[0].items():
                np.testing.assert_allclose(states[1][key], values, rtol=1e-12, atol=1e-12, err_msg=f"{name} {key}")


class Meshes(Converting, unittest.TestCase):
    @needs_foam
    def test_block_mesh(self):
        """What haff does not read goes through blockMesh; defaultFaces gets another name; the wall slips."""
        sides = foam.SIDES + " floor { type zeroGradient; } roof { type symmetryPlane; }"
        case = foam.write(self.folder, SKEWED, U=sides.replace("floor { type zeroGradient", "floor { type noSlip"), p=sides, T=sides)
        new = self.converted(case, "OpenFOAM's blockMesh -> constant/polyMesh", "defaultFaces -> the patch frontAndBack", "floor: U noSlip -> slip")
        with open(os.path.join(new, "constant", "polyMesh", "boundary"), encoding="latin-1") as f:
            self.assertNotIn("defaultFaces", f.read())
        entries.edit(os.path.join(new, "system", "controlDict"), {"endTime": 1e-4, "writeInterval": 1e-4})
        harness.program("granularGas", "-case", new)
        self.assertEqual(haff.Case(new).mesh.patches["floor"][0], "wall")

    @needs_foam
    def test_poly_mesh_binary_zipped(self):
        """A polyMesh with groups, fields in binary by setFields, zipped: the same numbers as from the dictionaries."""
        case = foam.tube(self.folder)
        foam.put(case, "system/controlDict", foam.CONTROL.replace("writeFormat ascii", "writeFormat binary"))
        shutil.copytree(os.path.join(case, "0.orig"), os.path.join(case, "0"))
        for name in ("blockMesh", "setFields"):
            subprocess.run([name, "-case", case], capture_output=True, check=True, env=rhocentral.ENVIRONMENT)
        subprocess.run(["gzip", os.path.join(case, "0", "T"), os.path.join(case, "constant", "polyMesh", "faces")], check=True)
        new = self.converted(case, "the mesh, as it is", "0 has values cell by cell already")
        np.testing.assert_allclose(haff.read_field(os.path.join(new, "0.orig", "T"), 100), R * np.repeat((348.432, 278.746), 50), rtol=1e-14)

    def test_corners(self):
        """A lattice less a part goes to the polyhedral engine, which heats the gas along walls behind such corners less; a box does not."""
        step = """scale 1; vertices ((0 0 0) (1 0 0) (2 0 0) (0 1 0) (1 1 0) (2 1 0) (0 2 0) (1 2 0) (2 2 0)
            (0 0 1) (1 0 1) (2 0 1) (0 1 1) (1 1 1) (2 1 1) (0 2 1) (1 2 1) (2 2 1));
            blocks ( BLOCKS ); boundary ( all { type patch; faces (FACES); } );"""
        hexes = [f"hex ({a} {a + 1} {a + 4} {a + 3} {a + 9} {a + 10} {a + 13} {a + 12}) (4 4 1) simpleGrading (1 1 1)" for a in (0, 3, 4, 1)]
        for number, faces in ((3, "(0 9 12 3) (3 12 15 6) (6 15 16 7) (7 16 17 8) (8 17 14 5) (5 14 13 4) (4 13 10 1) (1 10 9 0)"),
                              (4, "(0 9 12 3) (3 12 15 6) (6 15 16 7) (7 16 17 8) (8 17 14 5) (5 14 11 2) (2 11 10 1) (1 10 9 0)")):
            free = "all { type zeroGradient; }"
            folder = os.path.join(self.folder, str(number))
            case = foam.write(folder, step.replace("BLOCKS", " ".join(hexes[:number])).replace("FACES", faces), U=free, p=free, T=free)
            done = command(case, os.path.join(folder, "haff"))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("meshEngine polyhedral" in done.stdout, number == 3)

    def test_later_time(self):
        """A start from a time of a run: the folder keeps its name, and the solver goes on from it."""
        case = foam.write(self.folder)
        os.rename(os.path.join(case, "0"), os.path.join(case, "0.004"))
        foam.put(case, "system/controlDict", foam.CONTROL.replace("startFrom startTime", "startFrom latestTime"))
        new = self.converted(case, "-> 0.004/rho")
        harness.program("granularGas", "-case", new)
        self.assertEqual(haff.Case(new).times, ["0.004", "0.005"])

    def test_relative_path(self):
        """blockMesh gets the dictionaries of a case that is named from the folder above it."""
        foam.write(self.folder, SKEWED)
        with open(os.path.join(self.folder, "blockMesh"), "w") as f:
            f.write('#!/bin/sh\necho given: $(ls "$2/constant" "$2/system") >&2\nexit 1\n')
        os.chmod(f.name, 0o755)
        done = command_beside(self.folder, "foam", "haff")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertRegex(done.stderr, "blockMesh failed: given: .*/constant: thermophysicalProperties turbulenceProperties .*/system: blockMeshDict")

    def test_without_block_mesh(self):
        case = foam.write(self.folder, SKEWED)
        done = subprocess.run([sys.executable, "-m", "haff", "fromOpenFOAM", case, self.new()], capture_output=True, text=True,
                              env={"PATH": "/nowhere", "HAFF_BIN": harness.BIN, "PYTHONPATH": os.environ["PYTHONPATH"]})
        self.assertEqual(done.returncode, 1)
        self.assertIn("OpenFOAM's blockMesh is not there: run blockMesh in the case", done.stderr)


class Refusals(Converting, unittest.TestCase):
    def case(self, name="", old="", new=""):
        """The case with a text in a file replaced."""
        case = foam.write(self.folder)
        if name:
            path = os.path.join(case, name)
            with open(path, encoding="latin-1") as f:
                text = f.read()
            self.assertIn(old, text)
            with open(path, "w", encoding="latin-1") as f:
                f.write(text.replace(old, new))
        return case

    def test_gas(self):
        file = "constant/thermophysicalProperties"
        for old, new, words in (("equationOfState perfectGas", "equationOfState rhoConst", "equationOfState rhoConst: haff has p = rho R T"),
                                ("thermo hConst", "thermo janaf", "Cp must be constant"), ("pureMixture", "reactingMixture", "no mixture and no chemistry"),
                                ("Cp 1004.5", "Cp 200", "no gamma between 1 and 3"), ("molWeight 28.96; ", "", "there is no 'specie/molWeight'")):
            with self.subTest(words):
                self.refused(self.case(file, old, new), file + ":", words)

    def test_patches_and_fields(self):
        for name, old, new, words in (
                ("0/U", "type fixedValue", "type turbulentInlet", ("0/U:6", "turbulentInlet", "put one of these in its place")),
                ("0/p", "[1 -1 -2 0 0 0 0]", "[0 2 -2 0 0 0 0]", ("0/p:2", "incompressible")),
                ("0/p", "uniform 1e5", "uniform 0", ("p must be positive",)),
                ("0/T", "outlet {", "other {", ("T has no entry for patch outlet",)),
                ("0/U", "value $internalField", "value $there", ("0/U:6: macro '$there' names no entry",)),
                ("0/p", "type fixedValue; value $internalField", "type uniformFixedValue; uniformValue sine", ("table ((t v) ..)",)),
                ("0/p", "class volScalarField", "class \xff", ("0/p: its header is no text",)),
                ("system/blockMeshDict", "outlet { type patch;", "outlet { type cyclicAMI;", ("patch outlet has the type cyclicAMI", "fit one to one"))):
            with self.subTest(name + new):
                self.refused(self.case(name, old, new), *words)

    def test_runs(self):
        for name, old, new, words in (
                ("system/controlDict", "rhoCentralFoam", "icoFoam", ("system/controlDict:2: application icoFoam",)),
                ("system/fvSchemes", "default Euler", "default localEuler", ("ddtSchemes localEuler", "take Euler")),
                ("system/controlDict", "maxCo 0.2", "maxCo 0", ("system/controlDict:4: maxCo 0: it must be positive",)),
                ("system/fvSchemes", "Kurganov", "Roe", ("fluxScheme Roe: Kurganov or Tadmor",)),
                ("system/controlDict", "startTime 0", "startTime 3", ("neither 0 nor 0.orig", "startTime is 3"))):
            with self.subTest(new):
                self.refused(self.case(name, old, new), *words)
        case = self.case()
        os.rename(os.path.join(case, "0"), os.path.join(case, "processor0"))
        self.refused(case, "the case is decomposed", "run reconstructPar first")
        foam.put(self.case(), "constant/dynamicMeshDict", "dynamicFvMesh dynamicMotionSolverFvMesh;\n")
        self.refused(os.path.join(self.folder, "foam"), "the mesh moves")

    def test_folders(self):
        self.refused(os.path.join(self.folder, "nowhere"), "is no case directory")
        os.makedirs(os.path.join(self.new(), "0"))
        done = command(foam.write(self.folder), self.new())
        self.assertEqual((done.returncode, os.listdir(self.new())), (1, ["0"]))
        self.assertIn("nothing is overwritten", done.stderr)
        self.assertEqual(command(self.new()).returncode, 2)


class Dictionaries(Converting, unittest.TestCase):
    """controlDict, fvSchemes, function objects."""

    def case(self, control="", schemes=foam.SCHEMES):
        case = foam.write(self.folder)
        foam.put(case, "system/controlDict", control or foam.CONTROL)
        foam.put(case, "system/fvSchemes", schemes)
        return case

    def entry(self, path, file="controlDict"):
        return entries.get(os.path.join(self.new(), "system", file), path)

    def test_fixed_steps(self):
        """OpenFOAM reads neither maxCo nor maxDeltaT beside adjustTimeStep no, and takes no for what is not there."""
        control = foam.CONTROL.replace("adjustTimeStep yes; ", "").replace("maxDeltaT 1;", "maxDeltaT 1e-09;")
        self.converted(self.case(control), "deltaT 1e-06 of all steps, as adjustTimeStep is no", "dropped  system/controlDict:4: maxDeltaT 1e-09")
        self.assertEqual((self.entry("adjustTimeStep"), self.entry("deltaT")), ("no", 1e-6))
        with self.assertRaises(entries.EntryError):
            self.entry("maxDeltaT")

    def test_by_pressure(self):
        control = foam.CONTROL.replace("rhoCentralFoam", "sonicFoam").replace("adjustTimeStep yes; ", "")
        control = control.replace("adjustable; writeInterval 0.005", "timeStep; writeInterval 500")
        schemes = foam.SCHEMES.replace("fluxScheme Kurganov; ", "")
        self.converted(self.case(control, schemes), "sonicFoam goes by pressure", "-> adjustTimeStep yes, maxCo 1")
        self.assertEqual((self.entry("writeControl"), self.entry("writeInterval"), self.entry("maxCo")), ("adjustableRunTime", 5e-4, 1))

    def test_schemes(self):
        for limiter, reconstruct, poly in (("vanAlbada", "PHM", "linear"), ("upwind", "firstOrder", "firstOrder"), ("Minmod", "PHM", "linear")):
            with self.subTest(limiter):
                schemes = foam.SCHEMES.replace("vanLeerV", limiter).replace("vanLeer", limiter).replace("Kurganov", "Tadmor")
                self.converted(self.case(schemes=schemes), f"-> reconstruct {reconstruct} on a lattice, polyReconstruct {poly} on other meshes")
                self.assertEqual([self.entry(key, "fvSchemes") for key in ("fluxScheme", "reconstruct")], ["LaxFriedrichs", reconstruct])
                with self.assertRaises(entries.EntryError):  # the mesh is a lattice
                    self.entry("polyReconstruct", "fvSchemes")
                shutil.rmtree(self.new())

    def test_functions(self):
        functions = """functions
{
    points { type probes; libs (sampling); fields (p U k); probeLocations ((0 0 0) (1 0 0)); writeControl timeStep; writeInterval 10; wrong 3; }
    Mach   { type MachNo; libs (fieldFunctionObjects); writeControl writeTime; }
    far    { type probes; fields (p); probeLocations ((99 0 0)); writeControl timeStep; }
    own    { type coded; libs (utilityFunctionObjects); code #{ Info<< "x" << nl; #}; }
    #includeFunc residuals
}
"""
        self.converted(self.case(foam.CONTROL + functions), "functions/points: fields k", "functions/points/wrong",
                       "functions/Mach: type MachNo -> writeObjects of Ma", "functions/own: haff has no function object of type coded",
                       "#includeFunc residuals: OpenFOAM's template is not read", "dropped  system/controlDict:9: functions/far: ")
        self.assertEqual(self.entry("functions/points/fields"), "(p U)")
        self.assertEqual(re.findall(r"^    (\w+)$", self.entry("functions"), re.M), ["points", "Mach"])

    def test_slow_flow(self):
        """T in m^2/s^2 far above the square of the flow is meant here: no warning is left, as the case accepts it."""
        free = '".*" { type zeroGradient; }'
        case = foam.write(self.folder, U=free, p=free, T=free)
        foam.field(case, "U", free, "uniform (1 0 0)")
        self.converted(case, "acceptWarnings temperature")


if __name__ == "__main__":
    unittest.main()
