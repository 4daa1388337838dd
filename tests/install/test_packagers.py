# SPDX-License-Identifier: GPL-3.0-or-later
"""The packages for conda and Spack in .ci/install: they name what CMakeLists.txt looks for, in the version of the project. Neither conda
nor Spack is needed: the recipe of conda is rendered as conda-build does it, and the package of Spack runs with a stand-in for Spack."""
import importlib.util
import os
import re
import subprocess
import sys
import types
import unittest
import unittest.mock

from tests.cases import harness
from tests.install import outside

try:
    import jinja2
    import yaml
except ImportError:
    jinja2 = None

INSTALL = os.path.join(harness.SOURCE, ".ci", "install")
# What CMakeLists.txt looks for: its names at conda-forge and in Spack. None: it comes with the compiler, or only tests want it.
NEEDS = {"MPI": ("openmpi-mpicc", "mpi"), "ZLIB": ("zlib", "zlib-api"), "p4est": ("p4est", "p4est"), "sc": ("libsc", "p4est"), "metis": ("metis", "metis"),
         "lapacke": ("liblapacke", "netlib-lapack"), "deflate": ("libdeflate", "libdeflate"), "PkgConfig": ("pkg-config", "pkgconfig"),
         "PETSc": ("petsc", "petsc"), "Threads": None, "cmocka": None}


def read(*parts):
    with open(os.path.join(harness.SOURCE, *parts), encoding="utf-8") as file:
        return file.read()


def looked_for():
    """Packages and libraries that CMakeLists.txt looks for."""
    text = read("CMakeLists.txt")
    listed = re.findall(r"foreach\(lib ([^)]*)\)\n\s*find_library", text)[0].split()
    return {*re.findall(r"find_package\((\w+)", text), *re.findall(r"pkg_check_modules\(.* (\w+)\)", text), *listed,
            *re.findall(r"find_library\(\w+ NAMES (\w+)\)", text)}


def needed(column):
    return {names[column] for names in NEEDS.values() if names}


def of_python(prefix):
    """What the Python package needs, from pyproject.toml."""
    return {prefix + name for name in re.findall(r'"(\w+)"', re.search(r"^dependencies = \[(.*)\]", read("postprocessing", "pyproject.toml"), re.M)[1])}


def cmake_version():
    return re.search(r"cmake_minimum_required\(VERSION ([\d.]+)\)", read("CMakeLists.txt"))[1]


class Lists(unittest.TestCase):
    def test_all_are_known(self):
        """Whatever else CMakeLists.txt looks for wants a row above, and so a package of conda and Spack."""
        self.assertEqual(looked_for(), set(NEEDS))


@unittest.skipUnless(jinja2, "no jinja2 or yaml")
class Conda(harness.Folder, unittest.TestCase):
    def recipe(self):
        text = jinja2.Environment(undefined=jinja2.StrictUndefined).from_string(read(".ci", "install", "conda", "meta.yaml"))
        lines = text.render(compiler=lambda of: f"compiler_{of}", stdlib=lambda of: f"stdlib_{of}").split("\n")
        return yaml.safe_load("\n".join(line for line in lines if not line.endswith("# [not linux]")))

    def names(self, kind):
        return {line.split()[0].replace("matplotlib-base", "matplotlib") for line in self.recipe()["requirements"][kind]}

    def test_recipe(self):
        recipe = self.recipe()
        self.assertEqual((recipe["package"]["name"], str(recipe["package"]["version"])), ("haff", outside.VERSION))
        self.assertEqual(os.path.realpath(os.path.join(INSTALL, "conda", recipe["source"]["path"])), os.path.realpath(harness.SOURCE))
        self.assertTrue(os.path.exists(os.path.join(harness.SOURCE, recipe["about"]["license_file"])))
        self.assertNotIn("skip", recipe["build"])  # on Linux
        self.assertEqual(self.names("build"), {"compiler_c", "stdlib_c", "cmake", "make", "pkg-config"})
        self.assertIn(f"cmake >={cmake_version()}", recipe["requirements"]["build"])
        self.assertEqual(self.names("host"), needed(0) - {"pkg-config"} | of_python("") | {"python"})
        self.assertEqual(self.names("run"), of_python("") | {"python", "openmpi"})
        asked = re.search(r'requires-python = "(.*)"', read("postprocessing", "pyproject.toml"))[1]
        self.assertIn(f"python {asked}", recipe["requirements"]["run"])

    def test_commands(self):
        """The commands with which conda-build tests its package do so here."""
        path = f"{harness.BIN}:/usr/bin:/bin"
        for command in self.recipe()["test"]["commands"]:
            done = subprocess.run(command.split(), cwd=self.folder, capture_output=True, text=True, env={**os.environ, "PATH": path})
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")

    def test_build(self):
        """build.sh calls CMake three times, and the command haff starts with the Python of conda. cmake only shows its arguments here."""
        for name in ("postprocessing/bin/haff", ".ci/install/install.cmake", "bin/cmake"):
            os.makedirs(os.path.dirname(os.path.join(self.folder, name)), exist_ok=True)
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write('#!/bin/sh\necho "cmake $*"\n' if name == "bin/cmake" else read(name))
        os.chmod(os.path.join(self.folder, "bin", "cmake"), 0o755)
        said = outside.call("bash", os.path.join(INSTALL, "conda", "build.sh"), cwd=self.folder, path=os.path.join(self.folder, "bin"),
                            PREFIX="/there", PYTHON="/there/bin/python", CPU_COUNT="2", CMAKE_ARGS="-DGIVEN=1").splitlines()
        self.assertEqual([line.split()[1] for line in said], ["-DGIVEN=1", "--build", "--install"])
        self.assertTrue({"-DBUILD_TESTING=OFF", "-DCMAKE_INSTALL_PREFIX=/there"} <= set(said[0].split()))
        for name in ("postprocessing/bin/haff", ".ci/install/install.cmake"):
            with open(os.path.join(self.folder, name), encoding="utf-8") as file:
                text = file.read()
            self.assertIn("/there/bin/python", text)
            self.assertNotIn("/usr/bin/python3", text)


class Spec:
    """A stand-in for the spec of an installation: variants that are on."""

    def __init__(self, *on):
        self.on = on

    def satisfies(self, text):
        return (text[1:] in self.on) == (text[0] == "+")

    def __getitem__(self, name):
        return types.SimpleNamespace(command=types.SimpleNamespace(path=f"/there/bin/{name}"))


class Condition:
    """`with when("+variant"):`, which Spack takes for all that stands below."""

    def __init__(self, now, text):
        self.now, self.text = now, text

    def __enter__(self):
        self.now.append(self.text)

    def __exit__(self, *_):
        self.now.pop()


class Spack(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """The package, read with directives that note what they are given."""
        cls.noted, cls.filtered, now = {}, [], []

        def directive(kind):
            return lambda first, **more: cls.noted.setdefault(kind, []).append((first, {"when": "".join(now), **more}))

        api = types.ModuleType("spack.package")
        for kind in ("license", "version", "variant", "depends_on"):
            setattr(api, kind, directive(kind))
        api.when = lambda text: Condition(now, text)
        api.run_after = lambda phase: lambda function: function
        api.filter_file = lambda *words, **_: cls.filtered.append(words)
        cmake = types.ModuleType("spack_repo.builtin.build_systems.cmake")
        cmake.CMakePackage = type("CMakePackage", (), {"define": lambda self, name, value: f"-D{name}={'ON' if value else 'OFF'}"})
        with unittest.mock.patch.dict(sys.modules, {"spack": types.ModuleType("spack"), "spack.package": api, cmake.__name__: cmake,
                                                    **{cmake.__name__.rsplit(".", n)[0]: types.ModuleType("") for n in (1, 2, 3)}}):
            of = importlib.util.spec_from_file_location("package", os.path.join(INSTALL, "spack", "spack_repo", "haff", "packages", "haff", "package.py"))
            module = importlib.util.module_from_spec(of)
            of.loader.exec_module(module)
        cls.package = module.Haff

    def names(self, when):
        return {re.match(r"[a-z0-9-]+", text)[0] for text, more in self.noted["depends_on"] if more["when"] == when}

    def test_package(self):
        self.assertEqual([text for text, _ in self.noted["version"]], [outside.VERSION])
        self.assertIn(f"spack dev-build haff@{outside.VERSION}\n", read("docs", "install.md"))
        self.assertEqual({text for text, _ in self.noted["variant"]}, {"petsc", "python"})
        optional = {"petsc", "pkgconfig"}
        self.assertEqual(self.names(""), needed(1) - optional | {"c", "cmake"})
        self.assertEqual(self.names("+petsc"), optional)
        self.assertEqual(self.names("+python"), of_python("py-") | {"python"})
        self.assertIn(f"cmake@{cmake_version()}:", [text for text, _ in self.noted["depends_on"]])
        namespace = re.search(r"namespace: (\w+)", read(".ci", "install", "spack", "spack_repo", "haff", "repo.yaml"))[1]
        self.assertEqual(namespace, "haff")  # as its folder, which Spack asks for

    def test_arguments(self):
        """Without petsc CMake does not find what it would find PETSc with; CMakeLists.txt uses it for nothing else."""
        self.assertEqual(re.findall(r"pkg_check_modules\((\w+)", read("CMakeLists.txt")), ["PETSC"])
        package = self.package()
        for on, switch in ((("petsc", "python"), "OFF"), ((), "ON")):
            package.spec = Spec(*on)
            self.assertEqual(package.cmake_args(), ["-DBUILD_TESTING=OFF", f"-DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig={switch}"])

    def test_python(self):
        """The first line of the installed command becomes that of Spack's Python."""
        package = self.package()
        package.prefix = types.SimpleNamespace(bin=types.SimpleNamespace(haff="/there/bin/haff"))
        for on in ((), ("python",)):
            package.spec = Spec(*on)
            package.choose_python()
        (old, new, path), = self.filtered
        self.assertEqual(read("postprocessing", "bin", "haff").split("\n")[0], old)
        self.assertEqual((new, path), ("#!/there/bin/python", "/there/bin/haff"))


if __name__ == "__main__":
    unittest.main()
