"""The package and its commands run from where they are installed, by pip and by CMake, without the source tree and without a network."""
import os
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from tests.cases.harness import BIN, SOURCE, boxes

PYTHON = "/usr/bin/python3"
COMMANDS = ("haff", "haffPlot", "haffMovie", "haffLog")
PACKAGE = os.path.join(SOURCE, "postprocessing", "haff")
OURS = ("HAFF_", "PYTHON", "PIP_")  # what would lead to the source tree or to a network


def modules(folder):
    """Paths of the package's files below a folder."""
    return {os.path.relpath(os.path.join(at, name), folder) for at, _, names in os.walk(folder) for name in names if name.endswith(".py")}


class Installed:
    @classmethod
    def setUpClass(cls):
        cls._temporary = tempfile.TemporaryDirectory(prefix="haff")
        cls.folder = cls._temporary.name
        cls.environment = {k: v for k, v in os.environ.items() if not k.startswith(OURS)}
        cls.environment |= {"PIP_NO_INDEX": "1", "PYTHONDONTWRITEBYTECODE": "1", "MPLCONFIGDIR": cls.folder}
        cls.install()

    @classmethod
    def tearDownClass(cls):
        cls._temporary.cleanup()

    @classmethod
    def call(cls, *words, check=True):
        done = subprocess.run(words, capture_output=True, text=True, cwd=cls.folder, env=cls.environment)
        if check and done.returncode:
            raise AssertionError(f"{' '.join(words)}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done

    def command(self, name, *words, check=True):
        return self.call(os.path.join(self.bin, name), *words, check=check)

    def test_all_modules_are_there(self):
        self.assertEqual(modules(self.package), modules(PACKAGE))

    def test_commands(self):
        for name in COMMANDS:
            with self.subTest(name):
                text = self.command(name, "-help").stdout
                self.assertIn(f"usage: {name} " if name != "haff" else "haff COMMAND -help", text)

    def test_a_case_is_read_and_compared(self):
        """What a command does, it does with the installed package; the start of the picture of a case is that of a PNG."""
        case = os.path.join(self.folder, "case")
        os.makedirs(os.path.join(case, "system"), exist_ok=True)
        boxes.write_mesh(case, (8, 1, 1), (1, 0.1, 0.1))
        boxes.write_field(case, "T", np.linspace(1, 2, 8), time="1")
        words = self.command("haff", "compare", case, case, "-o", "same.png").stdout.splitlines()[1].split()
        self.assertEqual(words[:3], ["1", "T", "0"])
        with open(os.path.join(self.folder, "same.png"), "rb") as f:
            self.assertEqual(f.read(4), b"\x89PNG")

    def test_what_the_source_tree_has_is_asked_for(self):
        """A shipped case is not there: the error says which variable names its folder."""
        done = self.call(*self.python, "-c", "from haff import paths; paths.of_source('cases', 'sod')", check=False)
        self.assertRegex(done.stderr, "FileNotFoundError: .* set HAFF_SOURCE")

    def test_programs_are_found(self):
        """Those in bin of the same prefix; without them the error says what to do."""
        ask = ("-c", "from haff import paths; print(paths.program('granularGas'))")
        there = os.path.join(self.bin, "granularGas")
        self.environment["PATH"], keep = "/usr/bin:/bin", self.environment["PATH"]
        try:
            self.assertRegex(self.call(*self.python, *ask, check=False).stderr, "FileNotFoundError: .*granularGas is not there: .*HAFF_BIN")
            os.symlink(os.path.join(BIN, "granularGas"), there)
            self.assertEqual(os.path.realpath(self.call(*self.python, *ask).stdout.strip()), os.path.realpath(there))
        finally:
            self.environment["PATH"] = keep
            if os.path.lexists(there):
                os.remove(there)


@unittest.skipUnless(shutil.which("python3", path="/usr/bin"), "there is no /usr/bin/python3")
class ByPip(Installed, unittest.TestCase):
    """pip install --no-build-isolation --no-deps in a venv that sees the system's numpy; of a copy, as it builds in place."""

    @classmethod
    def install(cls):
        for module in ("pip", "setuptools", "wheel"):
            if subprocess.run([PYTHON, "-c", f"import {module}"], capture_output=True).returncode:
                raise unittest.SkipTest(f"python3-{module} is not installed")
        copy, venv = os.path.join(cls.folder, "postprocessing"), os.path.join(cls.folder, "venv")
        shutil.copytree(os.path.join(SOURCE, "postprocessing"), copy, ignore=shutil.ignore_patterns("__pycache__", "reports", "references", "build", "*.egg-info"))
        cls.call(PYTHON, "-m", "venv", "--system-site-packages", "--without-pip", venv)
        cls.bin = os.path.join(venv, "bin")
        cls.python = (os.path.join(cls.bin, "python3"),)
        cls.call(*cls.python, "-m", "pip", "install", "--no-build-isolation", "--no-deps", copy)
        shutil.rmtree(copy)
        cls.package = os.path.dirname(cls.call(*cls.python, "-c", "import haff; print(haff.__file__)").stdout.strip())

    def test_it_is_the_one_in_the_venv(self):
        self.assertTrue(self.package.startswith(os.path.join(self.folder, "venv")), self.package)


@unittest.skipUnless(shutil.which("cmake"), "CMake is not installed")
class ByCMake(Installed, unittest.TestCase):
    """cmake --install of the tree that is tested."""

    @classmethod
    def install(cls):
        build = os.path.dirname(BIN)
        if not os.path.exists(os.path.join(build, "cmake_install.cmake")):
            raise unittest.SkipTest(f"{build} was not made by CMake")
        first, prefix = os.path.join(cls.folder, "first"), os.path.join(cls.folder, "prefix")
        cls.call("cmake", "--install", build, "--prefix", first)
        os.rename(first, prefix)  # it runs from wherever it is moved
        cls.bin, cls.package = os.path.join(prefix, "bin"), os.path.join(prefix, "share", "haff", "python", "haff")
        cls.python = ("env", f"PYTHONPATH={os.path.dirname(cls.package)}", PYTHON)

    def test_nothing_else_is_in_the_package(self):
        names = {name for _, _, files in os.walk(self.package) for name in files}
        self.assertFalse({name for name in names if not name.endswith(".py")})


if __name__ == "__main__":
    unittest.main()
