# SPDX-License-Identifier: GPL-3.0-or-later
"""libhaff from a prefix, for programs in C: docs/library is built by find_package and by pkg-config, and computes what granularGas
does."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes
from tests.install import outside
from tests.install.outside import BUILD, call

PLAIN = not any(outside.cached(name) == "ON" for name in ("HAFF_SANITIZE", "HAFF_FUZZ")) if outside.INSTALLS else False
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


@unittest.skipUnless(PLAIN and shutil.which("cmake"), "no build of CMake to install, or one with sanitizers")
class Library(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """The prefix is moved after the installation; the example is copied, so that nothing but the prefix is within its reach."""
        super().setUpClass()
        cls.prefix, cls.example = os.path.join(cls.folder, "prefix"), os.path.join(cls.folder, "library")
        call("cmake", "--install", BUILD, "--prefix", os.path.join(cls.folder, "first"), "--component", "library", cwd=cls.folder)
        shutil.move(os.path.join(cls.folder, "first"), cls.prefix)
        shutil.copytree(os.path.join(harness.SOURCE, "docs", "library"), cls.example)

    def by_cmake(self):
        """The example by find_package; returns the path of its program."""
        folder = os.path.join(self.folder, "by_cmake")
        if not os.path.exists(os.path.join(folder, "sod")):
            call("cmake", "-S", self.example, "-B", folder, "-DCMAKE_PREFIX_PATH=" + self.prefix, "-DCMAKE_C_FLAGS=-Wall -Wextra -Wpedantic -Werror", cwd=self.folder)
            call("cmake", "--build", folder, cwd=self.folder)
        return os.path.join(folder, "sod")

    def profile(self, said):
        return np.array([line.split() for line in said.splitlines()], float)

    def test_ways(self):
        """find_package and pkg-config lead to programs that print the same, also on two ranks."""
        ours = {"PKG_CONFIG_PATH": os.path.join(self.prefix, "lib", "pkgconfig")}
        self.assertEqual(outside.VERSION, call("pkg-config", "--modversion", "haff", cwd=self.folder, **ours).strip())
        flags = call("pkg-config", "--cflags", "--libs", "haff", cwd=self.folder, **ours).split()
        call("gcc", "-std=c11", "sod.c", *flags, "-o", "sod", cwd=self.example)
        said = call(os.path.join(self.example, "sod"), cwd=self.folder)
        self.assertEqual(len(self.profile(said)), 20)
        self.assertEqual(said, call(self.by_cmake(), cwd=self.folder))
        self.assertEqual(said, call("mpirun", "--oversubscribe", "-np", "2", self.by_cmake(), cwd=self.folder, **MPI))

    def test_same_as_granularGas(self):
        """The densities are those of granularGas on such a case, to the digits that are printed."""
        case, cells = os.path.join(self.folder, "case"), 200
        x, alpha = (np.arange(cells) + 0.5) / cells, np.where(np.arange(cells) < cells // 2, 0.3, 0.03)
        boxes.box_case(case, (cells, 1, 1), (1.0, 0.1, 0.1), alpha * 6 / (np.pi * 0.01**3), np.zeros((cells, 3)), alpha, 0.1, e=0.97, cooling="Haff",
                       reconstruct="WENO5", flux="common", step=1.0)
        harness.edit(case, "constant/granularProperties", diameter=0.01)
        with open(os.path.join(case, "system", "fvSchemes"), "a") as f:  # the example gives the flux no parameters
            f.write("commonCoeffs { shocks off; expansions off; contacts off; smooth off; }\n")
        os.remove(os.path.join(case, "0", "p"))
        boxes.write_field(case, "T", np.ones(cells), '".*Empty" empty\n"x.*" zeroGradient')
        harness.program("granularGas", "-case", case)
        expected = harness.haff.Case(case).field("alpha", "0.1")
        printed = self.profile(call(self.by_cmake(), cwd=self.folder))
        np.testing.assert_allclose(printed[:, 0], x[5::10], rtol=0, atol=1e-4)
        np.testing.assert_allclose(printed[:, 1], expected[5::10], rtol=0, atol=6e-7)  # six digits are printed
        self.assertGreater(np.ptp(printed[5:15, 1]), 0.2)

    def test_version(self):
        """Another minor version is refused."""
        with open(os.path.join(self.example, "CMakeLists.txt"), encoding="utf-8") as file:
            text = file.read()
        other = os.path.join(self.folder, "other")
        os.mkdir(other)
        major, minor, _ = outside.VERSION.split(".")
        self.assertIn(f"find_package(haff {major}.{minor} REQUIRED)", text)
        with open(os.path.join(other, "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write(text.replace(f"haff {major}.{minor}", f"haff {major}.{int(minor) + 1}"))
        said = call("cmake", "-S", other, "-B", os.path.join(other, "build"), "-DCMAKE_PREFIX_PATH=" + self.prefix, cwd=other, code=1)
        self.assertRegex(" ".join(said.split()), rf"version: {outside.VERSION}")


if __name__ == "__main__":
    unittest.main()
