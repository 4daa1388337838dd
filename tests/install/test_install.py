# SPDX-License-Identifier: GPL-3.0-or-later
"""haff installed by CMake and by pip, each in a folder of its own, works without the source tree and without network."""
import functools
import glob
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import unittest

from tests.cases import harness, runs
from tests.install import outside
from tests.install.outside import BUILD, COMMANDS, LIBRARIES, MODULE, PROGRAMS, call
from tests.postprocessing.report import made
from tests.postprocessing.runs.test_run import tube

# Runs the case of its argument on two ranks and says where all lies; its error has file and line; steps a copy in its own process.
SCRIPT = """import os, shutil, sys
import haff, haff.paths
print(haff.__file__)
print(haff.paths.program("granularGas"))
case = haff.run(sys.argv[1], folder=sys.argv[1] + "Copy", ranks=2)
print(case.times[-1])
try:
    haff.run(sys.argv[1], {"constant/granularProperties": {"grain/restitution": 7}})
except haff.RunError as error:
    print(os.path.basename(error.file), error.line)
with haff.Gas(shutil.copytree(sys.argv[1], sys.argv[1] + "Stepped")) as gas:
    gas.advance(0.015)
    print(gas.time)
"""


class Commands:
    """What holds for either installation: self.bin holds the commands."""

    @classmethod
    @functools.cache
    def help(cls):
        return call(os.path.join(cls.bin, "haff"), "-help", cwd=cls.folder)

    def test_commands(self):
        self.assertIn("haff COMMAND -help", self.help())
        self.assertIn("FILE:ENTRY=VALUES", call(os.path.join(self.bin, "haff"), "sweep", "-help", cwd=self.folder))

    def test_studies(self):
        """The studies are not installed; a command of theirs says what it needs."""
        self.assertNotIn("serna", self.help())
        self.assertEqual(call(os.path.join(self.bin, "haff"), "muI", cwd=self.folder, code=1),
                         "haff muI: this needs the studies, a part of the source tree of haff that is not installed: set HAFF_SOURCE to the folder of that tree\n")

    def test_whole(self):
        """The package is that of the source tree, with all that a report needs."""
        of = lambda folder: {k for k in runs.contents(folder) if k.endswith((".py", ".js", ".css", ".txt"))}
        self.assertEqual(of(self.package()), of(os.path.join(harness.SOURCE, "postprocessing/haff")))


def options_of(folder, program):
    """Options of a program: those that it names when it is given another one."""
    said = call(os.path.join(folder, program), "-noSuchOption", cwd="/", code=1)
    return set(re.findall(r" (-\w[\w-]*)", said.split("known are")[1].split("(more")[0]))


@unittest.skipUnless(outside.INSTALLS and shutil.which("cmake"), "no build of CMake to install")
class ByCMake(Commands, harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """The prefix is moved after the installation: all else here happens in its new place."""
        super().setUpClass()
        first, cls.prefix = os.path.join(cls.folder, "first"), os.path.join(cls.folder, "moved", "prefix")
        cls.bin = os.path.join(cls.prefix, "bin")
        cls.said = call("cmake", "--install", BUILD, "--prefix", first, cwd=cls.folder)
        os.mkdir(os.path.dirname(cls.prefix))
        shutil.move(first, cls.prefix)

    def package(self):
        return os.path.join(self.prefix, "lib/haff/python/haff")

    def test_report(self):
        """The page has all that it needs: its look, its script, the library of plots."""
        case = made.gas(os.path.join(self.folder, "reported"))
        path = call(os.path.join(self.bin, "haff"), "report", case, cwd=self.folder).strip()
        with open(path, encoding="utf-8") as f:
            text = f.read()
        for part in ("uPlot=function", ".timebar {", 'getElementById("timebar")', "The MIT License"):
            self.assertIn(part, text)

    def test_programs(self):
        """All programs are there, and the module for implicit diffusion if the build has it. No mpirun hides that of the system. Nothing names
        the tree or the build."""
        self.assertEqual(set(PROGRAMS + COMMANDS), set(os.listdir(self.bin)))
        have = set(os.listdir(os.path.join(self.prefix, "lib", "haff")))
        self.assertEqual({"mpirun", "python", *LIBRARIES}, have)
        self.assertEqual([], outside.traces(self.prefix))

    def test_source(self):
        """The studies are had by HAFF_SOURCE."""
        command = os.path.join(self.bin, "haff")
        self.assertIn("this needs the studies", call(command, "figure", os.path.join(harness.SOURCE, "cases", "cylinder"), cwd=self.folder, code=1))
        self.assertIn("p* = 12.544", call(command, "riemann", cwd=self.folder, HAFF_SOURCE=harness.SOURCE))
        self.assertIn("serna", call(command, "-help", cwd=self.folder, HAFF_SOURCE=harness.SOURCE))

    def test_case(self):
        """An installed granularGas runs a case, also by a link to it and on two ranks; with implicit diffusion, too, whose module it
        finds."""
        link = os.path.join(self.folder, "linked")
        os.symlink(os.path.join(self.bin, "granularGas"), link)
        cases = [runs.make(os.path.join(self.folder, "plain"), (24, 1, 1), 0.002)]
        if MODULE:
            cases.append(runs.make(os.path.join(self.folder, "implicit"), (24, 1, 1), 0.002, viscous=True))
            runs.add(cases[1], "system/fvSolution", "diffusion { type implicit; }\n")
        for case in cases:
            for name, words in (("granularGas", ()), ("linked", ()), ("granularGas", ("-np", "2"))):
                with self.subTest(case, name=name, words=words):
                    copy = shutil.copytree(case, case + name + "".join(words))
                    path = link if name == "linked" else os.path.join(self.bin, name)
                    self.assertIn("end at time 0.002", call(path, "-case", copy, *words, cwd=self.folder))

    def test_package(self):
        """Python finds package and programs of the prefix, and runs on two ranks with its mpirun."""
        script, case = os.path.join(self.folder, "script.py"), tube(os.path.join(self.folder, "tube"))
        with open(script, "w") as f:
            f.write(f"import sys\nsys.path.insert(0, {os.path.join(self.prefix, 'lib/haff/python')!r})\n" + SCRIPT)
        said = call(sys.executable, script, case, cwd=self.folder).splitlines()
        self.assertEqual(said[:3], [os.path.join(self.prefix, "lib/haff/python/haff/__init__.py"), os.path.join(self.bin, "granularGas"), "0.05"])
        self.assertRegex(said[3], r"^granularProperties \d+$")
        self.assertEqual(said[4], "0.015")
        self.assertIn("restitution=0.8", call(os.path.join(self.bin, "haff"), "run", case, "constant/granularProperties:grain/restitution=0.8", cwd=self.folder))

    def test_version(self):
        """-version of each program and command, each by the name it is called by: version, git, compiler with flags, PETSc, the licence; `haff COMMAND`, too."""
        number = re.escape(outside.VERSION)
        for name in [*PROGRAMS, *COMMANDS, "haff sweep", "haff figure"]:
            with self.subTest(name):
                said = call(os.path.join(self.bin, name.split()[0]), *name.split()[1:], "-version" if name in PROGRAMS else "--version", cwd=self.folder)
                self.assertRegex(said, rf"^{name} {number}\b")
                self.assertRegex(said, rf" {number} \(git \w[^)]*\)")
                self.assertRegex(said, r"\ncompiler  (gcc|clang) \d.* -O")
                self.assertIn("\nPETSc     " + ("yes" if MODULE else "no"), said)
                self.assertRegex(said, r"(?s)GPL-3.0-or-later.*NO WARRANTY")
        for name in PROGRAMS:
            self.assertIn("did you mean '-version'", call(os.path.join(self.bin, name), "-versoin", cwd=self.folder, code=1))
            self.assertIn("-version", call(os.path.join(self.bin, name), "-help", cwd=self.folder))

    def test_manuals(self):
        """Each program and command has a manual page with all of its options, in which groff finds no fault."""
        folder = os.path.join(self.prefix, "share/man/man1")
        listed = re.findall(r"^  (\w+)  ", self.help(), re.M)
        pages = {*PROGRAMS, *COMMANDS, *("haff-" + c for c in listed if "haff" + c not in COMMANDS)}
        self.assertEqual({p + ".1" for p in pages}, set(os.listdir(folder)))
        for page in sorted(pages):
            path = os.path.join(folder, page + ".1")
            with self.subTest(page), open(path, encoding="utf-8") as file:
                text = re.sub(r"\\f[BR]", "", file.read().replace("\\-", "-"))
                self.assertRegex(text, rf"(?m)^\.SH NAME\n{page} - \w.{{8}}")
                for option in options_of(self.bin, page) if page in PROGRAMS else ["-help", "-slice"] * (page == "haffPlot"):
                    self.assertRegex(text, rf"\W{option}\b")
            if shutil.which("groff"):
                done = subprocess.run(["groff", "-man", "-ww", "-z", "-Tutf8", path], capture_output=True, text=True)
                self.assertEqual((0, ""), (done.returncode, done.stderr), page)

    def test_completion(self):
        """bash offers the options that a program knows and no others, keywords, commands, and folders, but none inside a case."""
        tube(os.path.join(self.folder, "cases", "tube"))
        folder = os.path.join(self.prefix, "share/bash-completion/completions")
        self.assertEqual(set(PROGRAMS + COMMANDS), set(os.listdir(folder)))

        def offered(*words):
            script = f'. {folder}/{words[0]}; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _haff; printf "%s\\n" "${{COMPREPLY[@]}}"'
            return set(call("bash", "-c", script, "bash", *words, cwd=self.folder, path=self.bin).split())

        for program in PROGRAMS:
            self.assertEqual(offered(program, "-"), options_of(self.bin, program), program)
        self.assertEqual(offered("checkCase", "-s"), {"-strict"})
        self.assertEqual(offered("granularGas", "-keywords", "timeSch"), {"timeScheme"})
        self.assertEqual(offered("gmshToCase", "-keywords", "pat"), {"patches"})
        self.assertEqual(offered("haff", "sw"), {"sweep"})
        self.assertGreater(offered("haffPlot", "cases/tube", "-"), {"-slice", "-contours", "-help", "-version"})
        self.assertGreaterEqual(offered("haff", "sweep", "-"), {"-help", "-version"})
        self.assertEqual(offered("granularGas", "-case", "ca"), {"cases"})
        self.assertEqual(offered("granularGas", "-case", "cases/"), {"cases/tube"})
        self.assertEqual(offered("granularGas", "-case", "cases/tube/"), set())

    def test_editors(self):
        """What docs/makeEditors writes from the programs of the build."""
        call("/usr/bin/python3", "-B", os.path.join(harness.SOURCE, "docs", "makeEditors"), "made", cwd=self.folder, HAFF_BIN=harness.BIN)
        made = outside.texts(os.path.join(self.folder, "made"))
        self.assertLess({"vim/syntax/haff.vim", "vscode/package.json"}, set(made))
        self.assertEqual(made, outside.texts(os.path.join(self.prefix, "share/haff/editors")))

    def test_documents(self):
        """README, licence and every page of docs; a link of a page to another one holds."""
        folder = os.path.join(self.prefix, "share/doc/haff")
        pages = ["README.md", "CHANGELOG.md", "LICENSE", *(os.path.relpath(p, harness.SOURCE) for p in glob.glob(os.path.join(harness.SOURCE, "docs", "**", "*.md"), recursive=True) if "/examples/" not in p)]
        for page in pages:
            with self.subTest(page), open(os.path.join(folder, page), encoding="utf-8") as file:
                for link in re.findall(r"\]\(([\w/.-]+\.md)[#)]", file.read()):
                    if not re.match(r"(\.\./)*(cases|postprocessing|tests|mesh|libcore|solvers)/", link) and "CONTRIBUTING" not in link:
                        self.assertTrue(os.path.exists(os.path.join(folder, os.path.dirname(page), link)), link)

    def test_headers(self):
        """Each header that is installed is whole: it compiles alone, by the path by which ours include it; none is private."""
        folder = os.path.join(self.prefix, "include/haff")
        headers = outside.texts(folder)
        self.assertTrue({"libcore/gas/gas.h", "libcore/models/eos.h", "mesh/lattice/lattice.h", "solvers/programs/run.h"} <= set(headers))
        self.assertFalse([path for path in headers if re.search("_private|_parts|^libcore/(lattice|polyhedral)/", path)])
        begun = {found[1].decode() for text in headers.values() if (found := re.search(rb'#include (?:"(.+)"|<)', text)) and found[1]}  # compiled by what begins with them
        call("gcc", "-std=c11", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-x", "c", "-I", folder,
             *(os.path.join(folder, path) for path in sorted(set(headers) - begun)), cwd=self.folder)


@unittest.skipUnless(outside.INSTALLS and shutil.which("cmake"), "no build of CMake to compare with")
class Configuring(harness.Folder, unittest.TestCase):
    def configure(self, *options, code=0):
        """Configures in a new folder on a system that has no cmocka: all libraries of its folder are hidden, the others known from the build."""
        folder = os.path.join(self.folder, "hidden")
        if not os.path.exists(folder):
            outside.keep_configuration(folder)
        hidden = os.path.dirname(outside.cached("cmocka_LIBRARY"))
        said = call("cmake", "-S", harness.SOURCE, "-B", folder, "-Ucmocka_LIBRARY", f"-DCMAKE_SYSTEM_IGNORE_PATH={hidden};{hidden.removeprefix('/usr')}", *options,
                    cwd=self.folder, code=code)
        return folder, said

    def test_without_cmocka(self):
        """Without tests cmocka is not asked for, and there is nothing to build but programs and libraries; with them it is named."""
        self.assertRegex(self.configure(code=1)[1], r"cmocka was not found.*\n? *.*libcmocka-dev(.|\n)*-DBUILD_TESTING=OFF")
        folder, _ = self.configure("-DBUILD_TESTING=OFF")
        with open(os.path.join(folder, "CMakeFiles", "TargetDirectories.txt"), encoding="utf-8") as file:
            targets = set(re.findall(r"(?m)/(\w+)\.dir$", file.read()))
        self.assertTrue(set(PROGRAMS) | {"haffmesh", "haffcore", "haffcase"} <= targets)
        self.assertEqual([], [t for t in targets if re.search("test_|bench|stress|replay|bits|faulty", t)])

    def test_warnings(self):
        """Warnings are no errors to a user of whatever compiler; they are to ./Alltest, also in a build that another command made."""
        folder = os.path.join(self.folder, "plain")
        outside.keep_configuration(folder)
        call("cmake", "-S", harness.SOURCE, "-B", folder, "-DBUILD_TESTING=OFF", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", cwd=self.folder)
        with open(os.path.join(folder, "compile_commands.json"), encoding="utf-8") as file:
            self.assertNotIn("-Werror", file.read())
        top, fake = os.path.join(self.folder, "tree"), os.path.join(self.folder, "fake")
        for path in (top, fake, os.path.join(top, ".ci"), os.path.join(top, "build")):
            os.mkdir(path)
        shutil.copy(os.path.join(harness.SOURCE, ".ci", "setup"), os.path.join(top, ".ci"))
        with open(os.path.join(fake, "cmake"), "w", encoding="utf-8") as file:
            file.write('#!/bin/sh\necho "cmake $*"\n')
        os.chmod(os.path.join(fake, "cmake"), 0o755)
        build = lambda *words: call("sh", "-c", 'top=$1; shift; verbose=1; . "$top/.ci/setup"; PATH=$0:$PATH; build "$@" 2>&1', fake, top, *words, cwd=top)
        self.assertNotIn("HAFF_WERROR", build("granularGas"))
        for kept, again in (("OFF", True), ("ON", False)):
            with open(os.path.join(top, "build", "CMakeCache.txt"), "w", encoding="utf-8") as file:
                file.write(f"HAFF_WERROR:BOOL={kept}\n")
            open(os.path.join(top, "build", "Makefile"), "w").close()
            self.assertEqual(again, "-DHAFF_WERROR=ON" in build("-strict"), kept)
            self.assertNotIn("cmake -S", build("granularGas"))
        with open(os.path.join(harness.SOURCE, "Alltest"), encoding="utf-8") as file:
            self.assertRegex(file.read(), r"(?m)^build -strict$")


def missing():
    for module in ("pip", "setuptools", "venv", "wheel"):
        if not importlib.util.find_spec(module):
            return module
    return None


@unittest.skipIf(missing(), f"python3-{missing()} is not there")
class ByPip(Commands, harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        source, cls.venv = (os.path.join(cls.folder, n) for n in ("postprocessing", "venv"))
        shutil.copytree(os.path.join(harness.SOURCE, "postprocessing"), source, ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
        cls.bin = os.path.join(cls.venv, "bin")
        # with the pip of the system: to unpack another one takes longer than the installation
        call("/usr/bin/python3", "-m", "venv", "--without-pip", "--system-site-packages", cls.venv, cwd=cls.folder)
        call("/usr/bin/python3", "-m", "pip", "--python", cls.venv, "install", "--no-build-isolation", "--no-deps", "./postprocessing", cwd=cls.folder)
        shutil.rmtree(source)

    def package(self):
        return glob.glob(os.path.join(self.venv, "lib/python3*/site-packages/haff"))[0]

    def test_package(self):
        """The package lies in the venv, with all that it needs, and finds programs in PATH."""
        script, case = os.path.join(self.folder, "script.py"), tube(os.path.join(self.folder, "tube"))
        with open(script, "w") as f:
            f.write(SCRIPT)
        said = call(os.path.join(self.bin, "python"), script, case, cwd=self.folder, path=harness.BIN).splitlines()
        self.assertTrue(said[0].startswith(self.venv + os.sep), said)
        self.assertEqual(said[1:3], [os.path.join(harness.BIN, "granularGas"), "0.05"])

    def test_version(self):
        """CMake and the package have one version, also where no program is."""
        code = "import importlib.metadata; print(importlib.metadata.version('haff'))"
        self.assertEqual(outside.VERSION, call(os.path.join(self.bin, "python"), "-c", code, cwd=self.folder).strip())
        said = call(os.path.join(self.bin, "haff"), "-version", cwd=self.folder, HAFF_BIN=self.folder)
        self.assertRegex(said, rf"(?s)^haff {re.escape(outside.VERSION)}\n.*programs  none .*GPL-3.0-or-later.*NO WARRANTY")

    def test_pictures(self):
        for name in COMMANDS[1:]:
            with self.subTest(name):
                self.assertTrue(os.access(os.path.join(self.bin, name), os.X_OK))
                self.assertIn(f"usage: {name}", call(os.path.join(self.bin, name), "-help", cwd=self.folder))

    def test_no_programs(self):
        """Without programs the error says what to do."""
        code = "import haff.paths; haff.paths.program('gmshToCaseOfNobody')"
        done = subprocess.run([os.path.join(self.bin, "python"), "-c", code], capture_output=True, text=True, cwd=self.folder, env=outside.environment())
        self.assertRegex(done.stderr, "FileNotFoundError: .*build haff .*HAFF_BIN")


if __name__ == "__main__":
    unittest.main()
