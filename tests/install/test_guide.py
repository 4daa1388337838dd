# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/install.md: every command in it is run, from top to bottom in one shell, in a home of its own; its packages are those of
.ci/setup, its options those of CMakeLists.txt."""
import os
import re
import shutil
import subprocess
import unittest

from tests.cases import harness
from tests.install import outside
from tests.install.test_container import listed

# What a command is called with here instead, so that the test neither builds everything anew nor installs packages: (pattern, what
# takes its place). Each row fits a line of the page.
TAMED = ((r"^(cmake -S \.) -B build (.*)", r"\1 -B fresh \2"),
         (r"^cmake --build build( .*)", r"cmake --build fresh\1 --target help"),
         (r"^python3 -m venv (.*)", r"python3 -m venv --without-pip \1"),  # to unpack another pip takes longer than all that it does
         (r"^\S+/bin/pip (.*)", r"python3 -m pip --python ~/venv \1"),
         (r"^cpack .*", r"\g<0> -D CPACK_CMAKE_GENERATOR=Ninja"),
         (r"^apt-get install", "apt-get install --simulate"),
         (r"^(podman .*)", r"if podman image inspect debian:12 >/dev/null 2>&1; then \1; fi"))
NEEDS = "cmake cpack dpkg-shlibdeps apt-get man pkg-config".split()


def page():
    with open(os.path.join(harness.SOURCE, "docs", "install.md"), encoding="utf-8") as file:
        return file.read()


class Guide(harness.Folder, unittest.TestCase):
    @unittest.skipUnless(outside.INSTALLS and all(map(shutil.which, NEEDS)), f"no build of CMake to install, or not all of {' '.join(NEEDS)}")
    @unittest.skipIf(outside.INSTALLS and outside.cached("HAFF_SANITIZE") == "ON", "libraries with sanitizers want a program with them")
    def test_commands(self):
        """Each ends with exit code 0. `build` is the build of the tests."""
        tree, home = os.path.join(self.folder, "tree"), os.path.join(self.folder, "home")
        os.mkdir(tree), os.mkdir(home)
        for name in os.listdir(harness.SOURCE):
            if name in ("docs", "postprocessing"):
                shutil.copytree(os.path.join(harness.SOURCE, name), os.path.join(tree, name), ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
            elif not name.startswith("build"):
                os.symlink(os.path.join(harness.SOURCE, name), os.path.join(tree, name))
        os.symlink(outside.BUILD, os.path.join(tree, "build"))
        outside.keep_configuration(os.path.join(tree, "fresh"), tree)
        lines = [line for block in re.findall(r"^```sh\n(.*?)^```", page(), re.M | re.S) for line in block.splitlines()]
        self.assertGreater(len(lines), 15)
        for pattern, _ in TAMED:
            self.assertTrue(any(re.search(pattern, line) for line in lines), pattern)
        script = ["set -ex"]
        for line in lines:
            for pattern, instead in TAMED:
                line = re.sub(pattern, instead, line)
            script.append(line)
        done = subprocess.run(["bash", "-c", "\n".join(script)], cwd=tree, capture_output=True, text=True, timeout=600,
                              env={**outside.environment(), "HOME": home, "MANPAGER": "cat"})
        self.assertEqual(0, done.returncode, done.stdout[-3000:] + done.stderr[-3000:])
        self.assertEqual(done.stdout.count("0.9775 0.0300"), 2)  # the end of the tube, computed twice
        self.assertIn("Solves the hydrodynamics of a granular gas", re.sub(r"\s+", " ", done.stdout))
        if kept := os.environ.get("HAFF_PACKAGES"):  # CTest lets test_debian look at these
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(os.path.join(tree, "packages"), kept, ignore=shutil.ignore_patterns("_CPack_Packages"))

    def test_lists(self):
        """Packages and options are those that there are."""
        self.assertIn("\n    " + " ".join(listed("build_packages")) + "\n", page())
        with open(os.path.join(harness.SOURCE, "CMakeLists.txt"), encoding="utf-8") as file:
            options = [(a or c, b or d) for a, b, c, d in re.findall(r'^option\((\w+) ".*" (ON|OFF)\)|^set\((HAFF_\w+) (OFF) CACHE STRING', file.read(), re.M)]
        self.assertEqual(options, re.findall(r"^\| `(BUILD_TESTING|HAFF_\w+)` \| `(ON|OFF)`", page(), re.M))


if __name__ == "__main__":
    unittest.main()
