# SPDX-License-Identifier: GPL-3.0-or-later
"""The version names what was compiled: each build asks git anew, and compiles nothing but build.c for the answer."""
import os
import shutil
import subprocess
import tempfile
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..")))
LISTS = """cmake_minimum_required(VERSION 3.25)
project(haff VERSION 9.9 LANGUAGES C)
add_library(haffmesh STATIC mesh/base/build.c other.c)
add_executable(show show.c)
target_link_libraries(show haffmesh)
include_directories(${CMAKE_SOURCE_DIR})
"""


def run(*command, cwd):
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)}\n{done.stdout}\n{done.stderr}")
    return done.stdout.strip()


def block():
    """The lines of the real CMakeLists.txt that are about the version."""
    with open(os.path.join(SOURCE, "CMakeLists.txt"), encoding="utf-8") as file:
        text = file.read()
    first = text.index("# Each build asks git")
    return text[first:text.index("target_link_libraries(haffcase PUBLIC", first)]


class Version(unittest.TestCase):
    def setUp(self):
        self.tree = tempfile.mkdtemp(prefix="version")
        self.addCleanup(shutil.rmtree, self.tree)
        for name in ("mesh/base", ".ci"):
            os.makedirs(os.path.join(self.tree, name))
        for name in ("mesh/base/build.c", "mesh/base/build.h", ".ci/gitVersion.cmake"):
            shutil.copy(os.path.join(SOURCE, name), os.path.join(self.tree, name))
        self.write("CMakeLists.txt", LISTS + block())
        self.write("other.c", "int other(void);\nint other(void) { return 1; }\n")
        self.write("show.c", '#include <stdio.h>\n#include "mesh/base/build.h"\nint main(void) { puts(build_version()); }\n')
        self.write(".gitignore", "build\n")

    def write(self, name, text):
        with open(os.path.join(self.tree, name), "w", encoding="utf-8") as file:
            file.write(text)

    def git(self, *arguments):
        return run("git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments, cwd=self.tree)

    def built(self):
        """The version that the program says after a build, and what that build compiled."""
        log = run("cmake", "--build", "build", cwd=self.tree)
        return run("build/show", cwd=self.tree), sorted(line.split("/")[-1] for line in log.split("\n") if "Building C" in line)

    def test_builds_ask_git(self):
        self.git("init", "-q")
        self.git("add", "-A")
        self.git("commit", "-qm", "one")
        run("cmake", "-S", ".", "-B", "build", cwd=self.tree)
        first, _ = self.built()
        self.assertEqual(first, f"9.9 (git {self.git('describe', '--always')})")
        self.assertEqual(self.built(), (first, []))
        self.write("other.c", "int other(void);\nint other(void) { return 2; }\n")
        self.assertEqual(self.built(), (first.replace(")", "-dirty)"), ["build.c.o", "other.c.o"]))
        self.git("commit", "-qam", "two")
        second, compiled = self.built()
        self.assertEqual((second, compiled), (f"9.9 (git {self.git('describe', '--always')})", ["build.c.o"]))
        self.assertNotEqual(first, second)

    def test_a_tree_without_git(self):
        run("cmake", "-S", ".", "-B", "build", cwd=self.tree)
        self.assertEqual(self.built()[0], "9.9 (git unknown)")


if __name__ == "__main__":
    unittest.main()
