# SPDX-License-Identifier: GPL-3.0-or-later
"""Allrun and its shell code with stand-ins for the programs: what is made once, what is made again, what it says."""
import json
import os
import re
import shutil
import stat
import subprocess
import tempfile
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..")))
CASES = sorted(n for n in os.listdir(os.path.join(SOURCE, "cases")) if os.path.isdir(os.path.join(SOURCE, "cases", n)))


def script(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w") as f:
        f.write("#!/bin/sh\n" + text)
    os.chmod(path, 0o755)


class Setup(unittest.TestCase):
    def setUp(self):
        """A copy of the scripts and two cases, with programs that only note that they were called, and a package that starts at once."""
        self.top = os.path.join(os.path.realpath(tempfile.mkdtemp(prefix="haff")), "a folder")
        ignore = shutil.ignore_patterns("[1-9]*", "0", "0.[0-9]*", "*.msh", "polyMesh", "postProcessing", "VTK", "e0.*", "*.png")
        for name in ("wall", "blast"):
            shutil.copytree(os.path.join(SOURCE, "cases", name), os.path.join(self.top, "cases", name), ignore=ignore)
            with open(os.path.join(self.top, "cases", name, "figure.py"), "w") as f:
                f.write(f"print('{name}.png')\n")
        shutil.copytree(os.path.join(SOURCE, ".ci"), os.path.join(self.top, ".ci"))
        os.makedirs(os.path.join(self.top, "at once", "haff"))
        with open(os.path.join(self.top, "at once", "haff", "__main__.py"), "w") as f:
            f.write("import runpy, sys\nsys.exit('haff report: none') if sys.argv[1] == 'report' else runpy.run_path(sys.argv[2] + '/figure.py')\n")
        os.symlink("at once", os.path.join(self.top, "postprocessing"))
        shutil.copy(os.path.join(SOURCE, "Allrun"), self.top)
        self.calls = os.path.join(self.top, "calls")
        note = f'echo "$(basename "$0")" >>"{self.calls}"\n'
        fake = os.path.join(self.top, "build", "bin")
        script(os.path.join(fake, "gmsh"), note + 'while [ "$1" != -o ]; do shift; done; : >"$2"\n')
        script(os.path.join(fake, "gmshToCase"), note + 'mkdir -p "$3/constant/polyMesh"; : >"$3/constant/polyMesh/boundary"\n')
        script(os.path.join(fake, "granularGas"),
               note + 'mkdir "$2/$(sed -n "s/^endTime *\\([^;]*\\);.*/\\1/p" "$2/system/controlDict")"\n')

    def package(self, path):
        """The package itself takes a second to start."""
        os.remove(os.path.join(self.top, "postprocessing"))
        os.symlink(path, os.path.join(self.top, "postprocessing"))

    def tearDown(self):
        shutil.rmtree(os.path.dirname(self.top))

    def run_case(self, name, **environment):
        """The case's Allrun: programs called, and what it printed."""
        open(self.calls, "w").close()
        done = subprocess.run([os.path.join(self.top, "cases", name, "Allrun")], capture_output=True, text=True, env={**os.environ, **environment})
        with open(self.calls) as f:
            return f.read().split(), done

    def touch(self, *path):
        os.utime(os.path.join(self.top, "cases", *path))

    def test_made_once(self):
        calls, done = self.run_case("wall")
        self.assertEqual(calls, ["gmsh", "gmshToCase", "granularGas"], done.stderr)
        self.assertEqual(done.stdout, "wall.png\n")
        self.assertIn("haff report: ", done.stderr)  # the figure comes all the same
        calls, done = self.run_case("wall", HAFF_REPORT="no")
        self.assertEqual((calls, done.stdout, done.returncode), ([], "wall.png\n", 0))
        self.assertNotIn("haff report: ", done.stderr)
        self.assertIn("Allclean", done.stderr)
        self.touch("wall", "system", "fvSchemes")
        self.assertEqual(self.run_case("wall")[0], ["granularGas"])
        self.touch("wall", "mesh.geo")
        self.assertEqual(self.run_case("wall")[0], ["gmsh", "gmshToCase", "granularGas"])
        before = set(os.listdir(os.path.join(SOURCE, "cases", "wall")))
        subprocess.run([os.path.join(self.top, "cases", "wall", "Allclean")], check=True)
        self.assertLessEqual(set(os.listdir(os.path.join(self.top, "cases", "wall"))), before)
        self.assertFalse(os.path.exists(os.path.join(self.top, "cases", "wall", "constant", "polyMesh")))

    def test_variants(self):
        calls, done = self.run_case("blast")
        self.assertEqual(calls, ["gmsh", "gmshToCase", "granularGas"] * 3, done.stderr)
        for e in ("0.7", "0.2"):
            with open(os.path.join(self.top, "cases", "blast", "e" + e, "constant", "granularProperties")) as f:
                self.assertIn(f"restitution {e};", f.read())
        self.assertEqual(self.run_case("blast")[0], [])

    def test_failures(self):
        script(os.path.join(self.top, "build", "bin", "granularGas"), "echo no good >&2; exit 1\n")
        _, done = self.run_case("blast")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no good", done.stderr)
        self.assertEqual(done.stdout, "")
        script(os.path.join(self.top, "build", "bin", "gmshToCase"), "echo bad mesh; exit 1\n")
        self.touch("blast", "mesh.geo")
        _, done = self.run_case("blast")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("bad mesh", done.stderr)

    def packages(self):
        """Stand-ins that have all packages, and a build that is made at once."""
        for name, text in (("cmake", "echo cmake speaks\n"), ("dpkg-query", "echo install ok installed\n"), ("mpicc", "")):
            script(os.path.join(self.top, "build", "bin", name), text)

    def test_plan(self):
        """A stranger sees five lines and the picture's path; the rest is in logs; -v shows all; a failure shows the end of the log."""
        self.packages()
        self.package(os.path.join(SOURCE, "postprocessing"))
        show = lambda *options: subprocess.run([os.path.join(self.top, "Allrun"), *options, "wall"], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        done = show()
        self.assertRegex(done.stderr, r"^haff: 1/5 packages.*\nhaff: 2/5 build, .*build/log\nhaff: 3/5 mesh .*\n"
                                      r"haff: 4/5 run, about [\d.]+ s; log: .*/log.granularGas\nhaff: 5/5 picture and report\nhaff report: .* has no times with fields: .*\n$")
        self.assertEqual((done.returncode, done.stdout), (0, "wall.png\n"))
        self.assertNotIn("speaks", done.stderr)
        self.package("at once")
        with open(os.path.join(self.top, "build", "log")) as f:
            self.assertIn("cmake speaks", f.read())
        self.assertIn("cmake speaks", show("-v").stderr)
        script(os.path.join(self.top, "build", "bin", "cmake"), "seq 100; echo no compiler; exit 1\n")
        done = show()
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"(?s)99\n100\nno compiler\nhaff: .* failed, see above\n$")
        self.assertNotIn("\n60\n", done.stderr)

    def test_words(self):
        """Words behind the case go to its Allrun, options of theirs, too; a case that reads none says so."""
        self.packages()
        show = lambda *words: subprocess.run([os.path.join(self.top, "Allrun"), *words], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        done = show("wall", "fig9")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("takes no words: fig9", done.stderr)
        script(os.path.join(self.top, "cases", "wall", "Allrun"), 'echo "words ${1:-none} $# $ranks"\n')
        self.assertEqual(show("-np", "3", "wall", "table", "-rows", "5").stdout, "words table 3 3\n")
        self.assertEqual(show("wall").stdout, "words none 0 \n")

    def test_missing_packages(self):
        """Without root and sudo: one line to run, exit code 1."""
        fake = os.path.join(self.top, "fake")
        for name, text in (("id", "echo 1000\n"), ("sudo", "exit 1\n"), ("dpkg-query", "exit 1\n")):
            script(os.path.join(fake, name), text)
        # the programs come first in PATH: the stand-ins for system commands go there
        for name in os.listdir(fake):
            shutil.copy(os.path.join(fake, name), os.path.join(self.top, "build", "bin"))
        done = subprocess.run([os.path.join(self.top, "Allrun"), "wall"], capture_output=True, text=True,
                              stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"run:  apt-get update && apt-get install -y \S* *.*libp4est-dev")
        self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_command_line(self):
        for arguments, text in ((["nonsense"], "blast wall"), (["-np", "two"], "number of ranks"), (["-x"], "usage")):
            done = subprocess.run([os.path.join(self.top, "Allrun"), *arguments], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn(text, done.stderr)

    def test_tests(self):
        """Alltest builds what is out of date and hands its options to ctest, whose exit code it has; -long adds the long tests."""
        shutil.copy(os.path.join(SOURCE, "Alltest"), self.top)
        with open(os.path.join(self.top, ".ci", "setup")) as f:
            wanted = re.search(r"build_packages=.*?\n\n", f.read(), re.S).group()
        fake = os.path.join(self.top, "build", "bin")
        for name in {entry.split(":")[0] for entry in re.findall(r"[\w-]+:[\w-]+", wanted)} - {"gmsh"}:
            script(os.path.join(fake, name), f'echo "{name} $*" >>"{self.calls}"\n')
        script(os.path.join(fake, "dpkg-query"), "echo install ok installed\n")
        script(os.path.join(fake, "ctest"), f'echo "ctest $*" >>"{self.calls}"; exit 3\n')
        for words, more in (([], ""), (["-long"], "-C Long ")):
            open(self.calls, "w").close()
            done = subprocess.run([os.path.join(self.top, "Alltest"), *words, "-L", "unit"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 3, done.stderr)
            with open(self.calls) as f:
                configured, built, tested = f.read().splitlines()
            self.assertRegex(configured, r"^cmake -S .* -B ")
            self.assertRegex(built, r"^cmake --build ")
            self.assertEqual(tested, f"ctest --output-on-failure --parallel {len(os.sched_getaffinity(0)) + 1} {more}-L unit")

    def test_every_case_is_whole(self):
        for name in CASES:
            folder = os.path.join(SOURCE, "cases", name)
            with open(os.path.join(folder, "system", "controlDict")) as f:
                mixture = "granularSegregation;" in f.read()
            for file in ("README.md", "mesh.geo", "expected.json", "figure.py", "Allrun", "Allclean", "0.orig/phi" if mixture else "0.orig/U",
                         "constant/segregationProperties" if mixture else "constant/granularProperties",
                         "system/controlDict", "system/fvSchemes", "system/fvSolution"):
                self.assertTrue(os.path.exists(os.path.join(folder, file)), f"{name}/{file}")
            for file in ("Allrun", "Allclean"):
                self.assertTrue(os.stat(os.path.join(folder, file)).st_mode & stat.S_IXUSR)
            with open(os.path.join(folder, "expected.json")) as f:
                expected = json.load(f)
            self.assertGreater(expected["seconds"], 0)
            self.assertTrue(expected["full"], name)
            for part in ("full", "short"):
                for entry in expected.get(part, []):
                    with self.subTest(f"{name}: {entry['quantity']}"):
                        self.assertGreater(entry["tolerance"], 0)
                        self.assertTrue(entry["source"])


if __name__ == "__main__":
    unittest.main()
