# SPDX-License-Identifier: GPL-3.0-or-later
"""Containerfile: built where docker or podman works; elsewhere it is held line by line against .ci/setup and the packages of cpack,
so that neither drifts, and apt is asked for all that it installs."""
import os
import re
import shlex
import shutil
import subprocess
import unittest

from tests.cases import harness
from tests.install import outside
from tests.install.outside import call


def read(*parts):
    with open(os.path.join(harness.SOURCE, *parts), encoding="utf-8") as file:
        return file.read()


def instructions():
    """[[instruction, words]] of each stage of the Containerfile."""
    stages = []
    for line in re.sub(r"\\\n", " ", re.sub(r"(?m)^#.*\n", "", read("Containerfile"))).split("\n"):
        name, _, rest = line.partition(" ")
        if name == "FROM":
            stages.append([])
        if name:
            stages[-1].append((name, " ".join(rest.split())))
    return stages


def installed(stage):
    """The packages that apt-get installs in a stage, without options."""
    words = [shlex.split(part) for name, rest in stage if name == "RUN" for part in rest.split("&&")]
    return [w for line in words if line[:2] == ["apt-get", "install"] for w in line[2:] if not w.startswith("-")]


def listed(name):
    """Packages of a list of .ci/setup."""
    script = f'top=$1; . "$1/.ci/setup"; for entry in ${name}; do entry=${{entry#*:}}; echo "${{entry%%|*}}"; done'
    return call("sh", "-c", script, "sh", harness.SOURCE, cwd="/").split()


class Container(unittest.TestCase):
    def test_packages(self):
        """The build has what .ci/setup says that a build and cpack need, and what manual pages of the Python commands do; the rest is
        what haff recommends and is not in its Depends."""
        build, final = instructions()
        self.assertEqual(installed(build), listed("build_packages") + listed("pack_packages") + ["python3-numpy", "python3-matplotlib"])
        recommended = re.search(r'PROGRAMS_PACKAGE_RECOMMENDS "(.*)"', read(".ci", "install", "install.cmake"))[1].split(", ")
        self.assertEqual([os.path.basename(p).split("_")[0] for p in installed(final)], ["haff", "haff-implicit", *(p for p in recommended if p != "haff-implicit")])
        for name in listed("run_packages"):  # a case's Allrun finds all of them, or haff brings them, or only tests and builds want them
            brought = re.search(r'PROGRAMS_PACKAGE_DEPENDS "(.*)"', read(".ci", "install", "install.cmake"))[1].split(", ")
            self.assertIn(name, [*installed(final), *brought, *listed("build_packages"), "libcmocka-dev"])

    def test_lines(self):
        """Both stages are Debian 12, as the lists are; every instruction is one of these; files that are copied are there."""
        build, final = instructions()
        self.assertEqual([rest.split()[0] for stage in (build, final) for name, rest in stage if name == "FROM"], ["debian:12"] * 2)
        self.assertEqual([name for name, _ in build], ["FROM", "RUN", "COPY", "RUN", "RUN"])
        self.assertEqual([name for name, _ in final], ["FROM", "COPY", "RUN", "RUN", "WORKDIR", "CMD"])
        self.assertIn(("RUN", "granularGas -help && haff -version"), final)
        folder = re.search(r"cpack --config \S+ -B (\S+)", build[-1][1])[1]
        self.assertTrue(all(word.startswith(folder + "/") for word in final[1][1].split()[1:-1]))
        ignored = read(".dockerignore").split()
        self.assertEqual(ignored, [".git", "build*", "**/__pycache__"])

    @unittest.skipUnless(shutil.which("apt-get"), "no apt")
    def test_apt(self):
        """apt knows everything that both stages install by name."""
        if subprocess.run(["apt-cache", "show", "hello"], capture_output=True).returncode:
            self.skipTest("apt has no lists of packages: apt-get update")
        names = [p for stage in instructions() for p in installed(stage) if "/" not in p]
        call("apt-get", "install", "--simulate", "--no-install-recommends", *names, cwd="/")

    @unittest.skipUnless(outside.INSTALLS, "no build of CMake to compare with")
    def test_build(self):
        """The lines of the build configure this tree, in another folder."""
        build, _ = instructions()
        configure = next(rest for name, rest in build if rest.startswith("cmake -S")).split("&&")[0]
        with harness.tempfile.TemporaryDirectory(prefix="haff") as folder:
            words = [w.replace("/haff/build", folder) if "build" in w else w.replace("/haff", harness.SOURCE) for w in shlex.split(configure)]
            outside.keep_configuration(folder)
            call(*words, cwd=folder)
            self.assertTrue(os.path.exists(os.path.join(folder, "CPackConfig.cmake")))

    def test_image(self):
        """Where a daemon answers and has debian:12, the image is built."""
        for tool in ("podman", "docker"):
            if shutil.which(tool) and not subprocess.run([tool, "image", "inspect", "debian:12"], capture_output=True, timeout=60).returncode:
                isolation = ["--isolation", "chroot"] if tool == "podman" else []  # as makeContainer does
                subprocess.run([tool, "build", *isolation, "-f", "Containerfile", "."], cwd=harness.SOURCE, check=True, timeout=2400)
                return
        self.skipTest("neither podman nor docker works here with debian:12")


if __name__ == "__main__":
    unittest.main()
