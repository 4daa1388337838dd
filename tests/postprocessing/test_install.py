# SPDX-License-Identifier: GPL-3.0-or-later
"""haff installed by CMake and by pip, each in a folder of its own, works without the source tree and without network."""
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import unittest

from tests.cases import harness, runs
from tests.postprocessing.runs.test_run import tube

BUILD = os.path.dirname(harness.BIN)
PROGRAMS = "granularGas granularSegregation granularMD gmshToCase checkCase initialFields caseToVTK mpirun".split()
COMMANDS = {"haffPlot": "plotCase", "haffMovie": "movie", "haffLog": "log"}  # and their modules in haff.plot
# Runs the case of its argument on two ranks and says where all lies; its error has file and line.
SCRIPT = """import os, sys
import haff, haff.paths
print(haff.__file__)
print(haff.paths.program("granularGas"))
case = haff.run(sys.argv[1], folder=sys.argv[1] + "Copy", ranks=2)
print(case.times[-1])
try:
    haff.run(sys.argv[1], {"constant/granularProperties": {"grain/restitution": 7}})
except haff.RunError as error:
    print(os.path.basename(error.file), error.line)
"""


def outside(path=""):
    """An environment that knows nothing of the source tree and the build; `path` first in PATH."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(("HAFF", "PYTHON", "PIP", "VIRTUAL"))}
    return {**env, "PATH": ":".join([path] * bool(path) + ["/usr/local/bin", "/usr/bin", "/bin"]), "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1",
            "MPLBACKEND": "Agg"}


def call(*command, cwd, path="", code=0):
    done = subprocess.run(command, capture_output=True, text=True, cwd=cwd, env=outside(path), timeout=300)
    if done.returncode != code:
        raise AssertionError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


class Commands:
    """What holds for either installation: self.bin holds the commands."""

    def test_commands(self):
        self.assertIn("haff COMMAND -help", call(os.path.join(self.bin, "haff"), "-help", cwd=self.folder))
        self.assertIn("FILE:ENTRY=VALUES", call(os.path.join(self.bin, "haff"), "sweep", "-help", cwd=self.folder))

    def test_pictures(self):
        for name, module in COMMANDS.items():
            with self.subTest(name):
                self.assertTrue(os.access(os.path.join(self.bin, name), os.X_OK))
                if not importlib.util.find_spec(f"haff.plot.{module}"):
                    self.skipTest(f"there is no haff.plot.{module} to call")
                self.assertIn(f"usage: {name}", call(os.path.join(self.bin, name), "-help", cwd=self.folder))


@unittest.skipUnless(os.path.exists(os.path.join(BUILD, "cmake_install.cmake")) and shutil.which("cmake"), "no build of CMake to install")
class ByCMake(Commands, harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.prefix = os.path.join(cls.folder, "prefix")
        cls.bin = os.path.join(cls.prefix, "bin")
        call("cmake", "--install", BUILD, "--prefix", cls.prefix, cwd=cls.folder)

    def test_programs(self):
        """All programs are there, and the module for implicit diffusion beside them if the build has it; the package is whole."""
        have = set(os.listdir(self.bin))
        self.assertEqual(set(PROGRAMS) - have, set())
        self.assertEqual("haffimplicit.so" in have, os.path.exists(os.path.join(harness.BIN, "haffimplicit.so")))
        of = lambda folder: {k for k in runs.contents(folder) if k.endswith(".py")}
        self.assertEqual(of(os.path.join(self.prefix, "lib/haff/python/haff")), of(os.path.join(harness.SOURCE, "postprocessing/haff")))

    def test_case(self):
        """An installed granularGas runs a case; with implicit diffusion, too, whose module it finds beside itself."""
        cases = [runs.make(os.path.join(self.folder, "plain"), (24, 1, 1), 0.002)]
        if os.path.exists(os.path.join(harness.BIN, "haffimplicit.so")):
            cases.append(runs.make(os.path.join(self.folder, "implicit"), (24, 1, 1), 0.002, viscous=True))
            runs.add(cases[1], "system/fvSolution", "diffusion { type implicit; }\n")
        for case in cases:
            with self.subTest(case):
                self.assertIn("end at time 0.002", call(os.path.join(self.bin, "granularGas"), "-case", case, cwd=self.folder))

    def test_package(self):
        """Python finds package and programs of the prefix, and runs on two ranks with its mpirun."""
        script, case = os.path.join(self.folder, "script.py"), tube(os.path.join(self.folder, "tube"))
        with open(script, "w") as f:
            f.write(f"import sys\nsys.path.insert(0, {os.path.join(self.prefix, 'lib/haff/python')!r})\n" + SCRIPT)
        said = call(sys.executable, script, case, cwd=self.folder).splitlines()
        self.assertEqual(said[:3], [os.path.join(self.prefix, "lib/haff/python/haff/__init__.py"), os.path.join(self.bin, "granularGas"), "0.05"])
        self.assertRegex(said[3], r"^granularProperties \d+$")
        self.assertIn("restitution=0.8", call(os.path.join(self.bin, "haff"), "run", case, "constant/granularProperties:grain/restitution=0.8", cwd=self.folder))


def missing():
    for module in ("pip", "setuptools", "venv", "ensurepip", "wheel"):
        if not importlib.util.find_spec(module):
            return module
    return None


@unittest.skipIf(missing(), f"python3-{'venv' if missing() == 'ensurepip' else missing()} is not there")
class ByPip(Commands, harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        source, cls.venv = (os.path.join(cls.folder, n) for n in ("postprocessing", "venv"))
        shutil.copytree(os.path.join(harness.SOURCE, "postprocessing"), source, ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
        cls.bin = os.path.join(cls.venv, "bin")
        call("/usr/bin/python3", "-m", "venv", "--system-site-packages", cls.venv, cwd=cls.folder)
        call(os.path.join(cls.bin, "pip"), "install", "--no-build-isolation", "--no-deps", "./postprocessing", cwd=cls.folder)
        shutil.rmtree(source)

    def test_package(self):
        """The package lies in the venv, with all that it needs, and finds programs in PATH."""
        script, case = os.path.join(self.folder, "script.py"), tube(os.path.join(self.folder, "tube"))
        with open(script, "w") as f:
            f.write(SCRIPT)
        said = call(os.path.join(self.bin, "python"), script, case, cwd=self.folder, path=harness.BIN).splitlines()
        self.assertTrue(said[0].startswith(self.venv + os.sep), said)
        self.assertEqual(said[1:3], [os.path.join(harness.BIN, "granularGas"), "0.05"])

    def test_no_programs(self):
        """Without programs the error says what to do."""
        code = "import haff.paths; haff.paths.program('gmshToCaseOfNobody')"
        done = subprocess.run([os.path.join(self.bin, "python"), "-c", code], capture_output=True, text=True, cwd=self.folder, env=outside())
        self.assertRegex(done.stderr, "FileNotFoundError: .*build haff .*HAFF_BIN")


class Version(unittest.TestCase):
    def test_version(self):
        """CMake and the package have one version."""
        read = lambda name, pattern: re.search(pattern, open(os.path.join(harness.SOURCE, name)).read(), re.M)[1]
        self.assertEqual(read("CMakeLists.txt", r"^project\(haff VERSION ([\d.]+)"), read("postprocessing/pyproject.toml", r'^version = "(.*)"'))


if __name__ == "__main__":
    unittest.main()
