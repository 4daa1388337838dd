# SPDX-License-Identifier: GPL-3.0-or-later
"""No command ends in a traceback: each is called on shipped cases without a mesh, on small runs of every kind, and on damaged ones. It
ends with code 0, or with one message that names the file and is its own: the last resort of haff.command (`ended`) counts as a fault here."""
import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import unittest

from tests.cases import harness
from tests.postprocessing.report import made

from haff import __main__ as haff_main, command

STUDIES = "faradayDiagram faradayOnset workPrecision denseShocks scaling marquinaStability segregationPrecision figure1 riemann obliqueShock layer segregation checkCases serna muI".split()
PROGRAMS = ("checkCase", "initialFields", "caseToVTK")
LAST = "0.015"


def called(*words):
    """(exit code, stdout, stderr) of `haff WORDS`."""
    done = harness.command(*words)
    return done.returncode, done.stdout, done.stderr


def text(path):
    with open(path, "rb") as f:
        return f.read()


def write(path, data):
    with open(path, "wb") as f:
        f.write(data if isinstance(data, bytes) else data.encode())


def replaced(case, name, pattern, new):
    path = os.path.join(case, name)
    made, count = re.subn(pattern, new, text(path), 1, re.S)
    assert count, (name, pattern)
    write(path, made)


def cut(case, name, part):
    path = os.path.join(case, name)
    write(path, text(path)[:int(len(text(path)) * part)])


def as_folder(case, name):
    os.remove(os.path.join(case, name))
    os.mkdir(os.path.join(case, name))


def emptied(path):
    shutil.rmtree(path)
    os.mkdir(path)


def head_only(case, name):
    path = os.path.join(case, name)
    write(path, b"".join(line + b"\n" for line in text(path).split(b"\n") if line.startswith(b"#")))


DRAWING = ("Plot", "Movie", "contours")  # which take most of the time where nothing is wrong for them
DRAWN_BEFORE = ("Movie", "report", "faradayFigures")  # by Plot
ALPHA, RUN = f"{LAST}/alpha", "postProcessing/run/0/run.dat"
DAMAGES = {
    "no mesh": lambda c: shutil.rmtree(os.path.join(c, "constant/polyMesh")),
    "list of cells that ends": lambda c: cut(c, "constant/polyMesh/owner", 0.6),
    "point that is not there": lambda c: replaced(c, "constant/polyMesh/faces", rb"4\(\d+ ", b"4(9999 "),
    "patch beyond the faces": lambda c: replaced(c, "constant/polyMesh/boundary", rb"startFace\s+\d+", b"startFace 99999"),
    "empty points": lambda c: write(os.path.join(c, "constant/polyMesh/points"), ""),
    "folder for points": lambda c: as_folder(c, "constant/polyMesh/points"),
    "truncated field": lambda c: cut(c, ALPHA, 0.5),
    "field without its list": lambda c: cut(c, ALPHA, 0.1),
    "binary that is none": lambda c: replaced(c, ALPHA, rb"ascii", b"binary"),
    "too few values": lambda c: replaced(c, ALPHA, rb"\n16\n", b"\n15\n"),
    "not a number": lambda c: replaced(c, ALPHA, rb"\(\n[^\n]+\n", b"(\nnan\n"),
    "folder for a field": lambda c: as_folder(c, ALPHA),
    "no zip": lambda c: [os.remove(os.path.join(c, ALPHA)), write(os.path.join(c, ALPHA + ".gz"), b"\x1f\x8bnone")],
    "half-written last time": lambda c: [os.remove(os.path.join(c, LAST, name)) for name in ("T", "U", "p", "rho")],
    "empty last time": lambda c: emptied(os.path.join(c, LAST)),
    "empty folder": emptied,
    "no JSON": lambda c: [write(os.path.join(c, name), "{ none") for name in ("expected.json", "run.json")],
    "other JSON": lambda c: [write(os.path.join(c, name), "[]") for name in ("expected.json", "run.json")],
    "unknown quantity": lambda c: write(os.path.join(c, "expected.json"), '{"full": [{"quantity": "maxmum", "value": 1, "tolerance": 1}]}'),
    "table of a head": lambda c: head_only(c, RUN),
    "table of noise": lambda c: write(os.path.join(c, RUN), b"\xff\xfe\0 ( ( \n1 2\n"),
    "folder for a table": lambda c: as_folder(c, RUN),
    "folder for controlDict": lambda c: as_folder(c, "system/controlDict"),
    "noise for controlDict": lambda c: write(os.path.join(c, "system/controlDict"), bytes(range(256))),
    "gravity that ends": lambda c: write(os.path.join(c, "constant/g"), "FoamFile { version 2; }\nvalue ("),
    "shaking that ends": lambda c: write(os.path.join(c, "constant/shaking"), "FoamFile { version 2; }\nfrequency 3"),
    "no times": lambda c: [shutil.rmtree(os.path.join(c, name)) for name in os.listdir(c) if re.fullmatch(r"[\d.]+", name)],
}


class Messages(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if not shutil.which("gmsh"):
            raise unittest.SkipTest("gmsh is not installed")
        cls.sound = os.path.join(cls.folder, "sound")
        code, _, said = called("newCase", cls.sound, "-box", "2x1", "-cells", "8x2", "-periodic", "left,right", "-gravity", "9.81", "-end", LAST,
                               "-diameter", "0.05", "-shaking", "3,200")
        assert code == 0, said
        harness.edit(cls.sound, "system/controlDict", writeFormat="ascii", writeInterval=0.005)
        harness.program("granularGas", "-case", cls.sound)

    def calls(self, case, out):
        """The command lines of a case, small pictures."""
        at = lambda name: os.path.join(out, name)
        return [["Plot", case, "-o", at("p.png"), "-dpi", "20"], ["Plot", case, "alpha", "-line", "0,0.5,0:2,0.5,0", "-o", at("p.png"), "-dpi", "20"],
                ["Movie", case, "alpha", "-o", at("m.gif"), "-dpi", "20"], ["Log", case], ["figure", case],
                ["expected", case], ["turn", case], ["contours", case, "-o", at("c.png")], ["columns", case, at("c.csv"), "0.01"],
                ["columns", case, at("c.csv"), "0.25", "-from", "0"], ["faraday", case], ["faradayFigures", case, case, out],
                ["clustering", "table", case, out, "0.01"], ["clustering", "alike", case, case, "0.01"], ["compare", case, self.sound],
                ["compare", self.sound, case], ["newCase", case], ["newCase", case, "-box", "1"], ["crossCheck", case, "-h"], ["report", case, "-o", at("r.html"), "-frames", "1"],
                ["fromOpenFOAM", case, at("converted")]]

    def sound_ending(self, words, code, out, said, named):
        """Code 0, or one message that names something of the user's."""
        for sign in ("Traceback", "fault of haff", "does not hold what is wanted", "Errno", "NoneType"):
            self.assertNotIn(sign, said + out, words)
        if code:
            self.assertIn(code, (1, 2), (words, said))
            self.assertTrue(any(name in said + out for name in named), (words, said))
            self.assertLessEqual(len(said.strip().splitlines()), 8, said)

    def look(self, case, calls):
        for words in calls:
            with self.subTest(" ".join(words)), made.white() if words[0] in DRAWN_BEFORE else contextlib.nullcontext():
                self.sound_ending(words, *called(*words), (self.folder, os.path.basename(case), "usage", "the mesh"))

    def out(self):
        path = os.path.join(self.folder, "out")
        shutil.rmtree(path, ignore_errors=True)
        os.mkdir(path)
        return path

    def run_by_haff(self, case, out, swept):
        """haff run, which begins from the case or goes on in a copy, and haff sweep, whose runs begin likewise."""
        return [["run", case, "-folder", os.path.join(out, "run")], ["run", self.sound, "-folder", case],
                *([["sweep", case, "constant/granularProperties:grain/restitution=0.8", "-folder", os.path.join(out, "sweep"), "-quiet"]] if swept else [])]

    def test_damaged(self):
        for k, (name, damage) in enumerate(DAMAGES.items()):
            case = os.path.join(self.folder, name)
            shutil.copytree(self.sound, case)
            damage(case)
            out = self.out()
            drawn = re.search("mesh|cells|point|patch|field|binary|values|number|zip|time|empty", name)
            other = re.search("number|half-written", name)  # than the sound case's: what there is to be drawn
            with self.subTest(name), contextlib.nullcontext() if other else made.white():
                self.look(case, [words for words in self.calls(case, out) if drawn or words[0] not in DRAWING])
                if "table" in name:
                    self.look(case, [["Log", case, "-o", os.path.join(out, "log.png")]])
                for program in PROGRAMS:
                    done = harness.program(program, *([case] if program == "checkCase" else ["-case", case]), check=False)
                    self.sound_ending([program, name], done.returncode, done.stdout, done.stderr, (case,))
                if "table" not in name:  # of which a run reads none
                    self.look(case, self.run_by_haff(case, out, k % 3 == 0))

    def test_damaged_meshes_of_gmsh(self):
        with open(os.path.join(self.sound, "mesh.msh"), "rb") as f:
            msh = f.read()
        os.mkdir(os.path.join(self.folder, "of msh"))
        for k, data in enumerate((b"", msh[:len(msh) // 2], bytes(range(256)), None)):
            path = os.path.join(self.folder, f"damaged{k}.msh")
            os.mkdir(path) if data is None else write(path, data)
            with self.subTest(k):
                done = harness.program("gmshToCase", path, "-case", os.path.join(self.folder, "of msh"), check=False)
                self.assertEqual(done.returncode, 1)
                self.sound_ending(["gmshToCase", path], done.returncode, done.stdout, done.stderr, (path,))
                self.look(path, [["newCase", os.path.join(self.folder, "new"), path]])

    def test_shipped_without_a_mesh(self):
        """As they come: nothing was run. Those left out look at runs, or at the command line alone."""
        for name in sorted(name for name in os.listdir(os.path.join(harness.SOURCE, "cases")) if name[0] != "."):
            case = harness.copy(name, self.folder)
            calls = [words for words in self.calls(case, self.out()) if words[0] not in ("figure", "crossCheck", "clustering", "newCase")]
            with self.subTest(name):
                self.look(case, calls)

    def test_small_runs(self):
        """A line, a mixture, grains, polyhedra, after a few steps."""
        for name, cells, option in (("sod", 16, "N"), ("kink", 7, "M"), ("coolingDisksMD", 8, "N"), ("cylinder", 4, "N")):
            case = harness.copy(name, self.folder)
            if name == "coolingDisksMD":
                path = os.path.join(case, "mesh.geo")
                write(path, text(path).replace(b"L = 240", b"L = 40"))
            harness.mesh(case, cells, option)
            control = os.path.join(case, "system", "controlDict")
            write(control, text(control) + b"\nendTime 1e-4; writeControl runTime; writeInterval 1e-4;\n")
            harness.program(re.search(rb"application\s+(\w+)", text(control))[1].decode(), "-case", case)
            with self.subTest(name):
                self.look(case, self.calls(case, self.out()))

    def test_nothing_there(self):
        """Names of no case, and no names at all."""
        nowhere = os.path.join(self.folder, "nowhere")
        self.look(nowhere, self.calls(nowhere, self.out()) + [[name, nowhere, nowhere] for name in haff_main.COMMANDS if name not in STUDIES])
        for name in haff_main.ALL:
            with self.subTest(name):
                code, out, said = called(name, "-help")
                self.assertEqual((code, said), (0, ""))
                self.assertIn("Allcheck" if name == "checkCases" else name, out)
                if name not in STUDIES or name == "obliqueShock":
                    code, out, said = called(name)
                    self.assertEqual(code, 2, said)

    def test_last_resort(self):
        """What no check foresaw names the file that was read last; HAFF_TRACEBACK shows the place."""
        path = os.path.join(self.sound, "constant", "g")
        command.Reading.watch([self.sound])

        def work():
            with open(path) as f:
                return {}[f.read(1) and "value"]
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            self.assertEqual(command.ended("haff x", work), 1)
        self.assertIn(f"haff x: {path} does not hold what is wanted (KeyError: 'value'); checkCase", said.getvalue())
        os.environ["HAFF_TRACEBACK"] = "1"
        try:
            self.assertRaises(KeyError, command.ended, "haff x", work)
        finally:
            del os.environ["HAFF_TRACEBACK"]


class OtherPython(harness.Folder, unittest.TestCase):
    def test_without_numpy(self):
        """A Python without numpy says which has it, in one line."""
        code = "import importlib.util, sys; find = importlib.util.find_spec; importlib.util.find_spec = lambda n, *p: None if n == 'numpy' else find(n, *p); "
        command_line = code + "sys.argv = ['haffPlot', 'x']; from haff.__main__ import main; main()"
        done = subprocess.run([sys.executable, "-c", command_line], capture_output=True, text=True)
        self.assertEqual((done.returncode, len(done.stderr.strip().splitlines())), (1, 1), done.stderr)
        self.assertIn(f"haff: {sys.executable} has no numpy, which haff needs: ", done.stderr)
        self.assertIn("pip install numpy", done.stderr)
        done = subprocess.run([sys.executable, "-c", code + "import haff"], capture_output=True, text=True)
        self.assertIn("ImportError: " + sys.executable + " has no numpy", done.stderr)


if __name__ == "__main__":
    unittest.main()
