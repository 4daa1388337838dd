# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/userGuide.md beside the programs: its examples are read by checkCase or run, and its tables and words are those of the programs."""
import glob
import os
import re
import shutil
import subprocess
import textwrap
import unittest

from tests.cases import harness
from tests.cases.harness import boxes
from tests.postprocessing.runs.test_run import tube

GUIDE = os.path.join(harness.SOURCE, "docs", "userGuide.md")
HEAD = 'FoamFile {{ version 2.0; format ascii; class {0}; location "{1}"; object {2}; }}\n'
FIELDS = {"alpha": ("volScalarField", "[0 0 0 0 0 0 0]", "0.3"), "T": ("volScalarField", "[0 2 -2 0 0 0 0]", "1"),
          "U": ("volVectorField", "[0 1 -1 0 0 0 0]", "(0 0 0)")}
# Words of the guide that no program knows: names that stand for the user's own, and OpenFOAM's and the papers' terms.
OWN = set("mean rough feed inlet outlet lid myCase rhoCentralFoam reconstructPar checkMesh foamToVTK decomposePar mpirun front back gmsh phiE residual massResidual repeated written "
          "massFlow flow blockMesh olderVersion box figure computed taskset points positions UMean UPrime2Mean frictionStress momentumResidual_x image flux scaling report turn Allrun alphaError UError grainsError".split())


def guide():
    with open(GUIDE, encoding="utf-8") as f:
        return f.read()


def blocks(text):
    """The indented blocks of a page, without the indent."""
    return [textwrap.dedent(found).strip("\n") for found in re.findall(r"(?:^ {4}[^\n]*\n|^\n(?= {4}))+", text, re.M)]


def block(word):
    """The one block that holds `word`."""
    found = [b for b in blocks(guide()) if word in b]
    assert len(found) == 1, f"{len(found)} blocks hold {word}"
    return found[0]


def listed(option):
    return harness.program("granularGas", option).stdout


class Examples(harness.Folder, unittest.TestCase):
    def case(self, entries=(), properties="", control="", start=None, transport=False, types=None):
        """A box of 8 x 6 cells: entries {(field, patch): text}, start: {field: text in place of internalField}."""
        path = os.path.join(self.folder, f"{self._testMethodName}{len(os.listdir(self.folder))}")
        kinds = boxes.write_mesh(path, (8, 6, 1), (0.8, 0.6, 0.1), types)
        for name, (kind, dimensions, value) in FIELDS.items():
            rules = {patch: f"type {t};" if t in ("empty", "cyclic") else "type zeroGradient;" for patch, t in kinds.items()}
            rules.update({patch: text for (field, patch), text in dict(entries).items() if field == name})
            body = (start or {}).get(name, f"internalField uniform {value};")
            text = HEAD.format(kind, "0", name) + f"dimensions {dimensions};\n{body}\nboundaryField\n{{\n"
            text += "".join(f"    {patch} {{ {rule} }}\n" for patch, rule in rules.items()) + "}\n"
            os.makedirs(os.path.join(path, "0.orig"), exist_ok=True)
            with open(os.path.join(path, "0.orig", name), "w") as f:
                f.write(text)
        model = "grain { diameter 1e-3; restitution 0.9; } equationOfState TorquatoDisks; cooling Haff;\n"
        boxes.write_dictionary(path, "constant", "granularProperties", properties or model + ("transport JenkinsRichman;\n" if transport else ""))
        boxes.write_dictionary(path, "constant", "g", "dimensions [0 1 -2 0 0 0 0]; value (0 -9.81 0);\n")
        boxes.write_dictionary(path, "system", "controlDict", "application granularGas; endTime 0.001; writeControl adjustableRunTime; writeInterval 0.001;\n"
                               "acceptWarnings (rarefied fewGrains largeGrains temperature);\n" + control)
        boxes.write_dictionary(path, "system", "fvSchemes", "")
        boxes.write_dictionary(path, "system", "fvSolution", "acoustics { type explicit; }\n")
        return path

    def sound(self, case):
        harness.program("checkCase", case)

    def test_starts(self):
        layer, waves = (re.sub(r"//.*", "", line) for line in block("settledLayer {").splitlines())
        layer = layer.replace("depth 6", "depth 60")  # of this box, whose cells are a hundred grains wide
        self.sound(self.case(start={"alpha": f"{layer}\n{waves}"}, types={"x": "cyclic"}, entries={("U", "yLow"): "type slip;"}))

    def test_values_that_change(self):
        lines = dict(re.match(r"(\w+) +\{ (.*?) \}(?=$| *//)", line).groups() if "//" not in line else
                     re.match(r"(\w+) +\{ (.*?) \} +//", line).groups() for line in block("uniformFixedValue").splitlines()[2:])
        first, second = (re.match(r"inlet +\{ (.*) \} +//", line).group(1) for line in block("uniformFixedValue").splitlines()[:2])
        still = {("alpha", "xLow"): "type fixedValue; value uniform 0.3;", ("T", "xLow"): "type fixedValue; value uniform 1;",
                 ("U", "xLow"): "type fixedValue; value uniform (1 0 0);"}
        for name, entries in {"T of inlet": {("T", "xLow"): first}, "U of inlet": {("U", "xLow"): second}, "feed": {("U", "xLow"): lines["feed"]},
                              "outlet": {("T", "xHigh"): lines["outlet"]}, "lid": {("U", "yHigh"): lines["lid"]}}.items():
            with self.subTest(name):
                case = self.case({**still, **entries}, transport=name == "lid", types={"yHigh": "wall"} if name == "lid" else None)
                if name != "lid":
                    harness.program("granularGas", "-case", case)
                else:
                    self.sound(case)

    def test_models(self):
        properties = re.sub(r"//.*", "", block("equationOfState TorquatoSpheres"))
        coefficients = re.search(r"`(GarzoDuftyCoeffs \{.*?\})`", guide()).group(1)
        sources = re.sub(r"//.*", "", block("sources (linearDrag"))
        self.sound(self.case(properties=f"{properties}\n{coefficients}\n{sources}\n"))

    def test_function_objects(self):
        text = block("functions\n").replace("(wall)", "(yLow)").replace("name outlet", "name xHigh")
        case = self.case(control=text, types={"yLow": "wall"}, entries={("U", "yLow"): "type slip;"})
        harness.program("granularGas", "-case", case)
        made = set(os.listdir(os.path.join(case, "postProcessing")))
        self.assertGreaterEqual(made, {"forces", "drag", "out", "budget", "run"})
        self.assertIn("UMean", os.listdir(os.path.join(case, "0.001")))

    def test_python(self):
        """The lines of Python, on a small case in place of the shipped ones."""
        case, other = (tube(os.path.join(self.folder, n)) for n in ("tube", "other"))
        harness.program("granularGas", "-case", other)
        text = block("import haff").replace("cases/bouncingBedMD", other).replace("cases/bouncingBed", case).replace("cases/wedge", case)
        text = re.sub(r'folder="(\w)', lambda found: f'folder="{self.folder}/{found.group(1)}', text)
        harness.program("granularGas", "-case", case)
        said = {}
        exec(compile(text, GUIDE, "exec"), said)
        self.assertEqual(len(said["table"]), 3)
        self.assertEqual(len(said["alpha"]), len(said["x"]))

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not there")
    def test_mesh_to_run(self):
        """The line that makes a mesh, checks and runs, on the reference's example."""
        line = block("gmsh -3 mesh.geo")
        case = os.path.join(self.folder, "line")
        shutil.copytree(os.path.join(harness.SOURCE, "docs", "examples", "gas"), case)
        shutil.copy(os.path.join(harness.SOURCE, "docs", "examples", "mesh.geo"), case)
        harness.edit(case, "system/controlDict", endTime="1e-4")
        done = subprocess.run(["sh", "-c", line], cwd=case, capture_output=True, text=True,
                              env={**os.environ, "PATH": harness.BIN + ":" + os.environ["PATH"]}, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])


class Words(unittest.TestCase):
    def test_function_objects(self):
        """The table of function objects has every type, and no other."""
        table = re.search(r"^\| type \| gives \|\n(.*?)\n\n", guide(), re.S | re.M).group(1)
        said = {word for row in table.splitlines()[1:] for word in re.findall(r"`(\w+)`", row.split("|")[1])}
        known = re.search(r"^system/controlDict: functions\n(.*?)^  fields:", listed("-listModels"), re.S | re.M).group(1)
        self.assertEqual(said, set(re.findall(r"^  (\w+)", known, re.M)))

    def test_patches(self):
        """Every type of patch is spoken of."""
        for name in re.findall(r"^  (\w+)", listed("-listBCs"), re.M):
            if name != "calculated":
                self.assertIn(f"`{name}`", guide(), name)

    def test_programs(self):
        """The table of programs has all that lie in solvers/programs, and each knows -help."""
        table = re.search(r"^\| program \| does \|\n(.*?)\n\n", guide(), re.S | re.M).group(1)
        said = {word for row in table.splitlines()[1:] for word in re.findall(r"`(\w+)", row.split("|")[1])}
        mains = {os.path.basename(p)[:-2] for p in glob.glob(os.path.join(harness.SOURCE, "solvers/programs/*.c")) if re.search(r"^int main\(", open(p).read(), re.M)}
        self.assertEqual(mains - said, set())
        for name in said:
            self.assertTrue(harness.program(name, "-help").stdout, name)

    def test_words(self):
        """Words in `code` are keywords, values, programs or files: the reference, the programs' own words or this tree has them."""
        with open(os.path.join(harness.SOURCE, "docs", "reference.md"), encoding="utf-8") as f:
            known = set(re.findall(r"\w+", f.read())) | OWN | set(os.listdir(os.path.join(harness.SOURCE, "cases"))) | set(os.listdir(harness.BIN))
        text = "\n".join(line for line in guide().splitlines() if not line.startswith("    "))
        said = {word for code in re.findall(r"`([^`]+)`", text) for word in re.findall(r"(?<![\w./-])[A-Za-z]\w+(?![\w/]|\.\w)", code)}
        self.assertEqual(sorted(said - known - {word for word in said if word.isupper()}), [])


if __name__ == "__main__":
    unittest.main()
