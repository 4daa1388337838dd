# SPDX-License-Identifier: GPL-3.0-or-later
"""A package for Spack 1.0, built from this tree:  spack repo add .ci/install/spack/spack_repo/haff && spack dev-build haff@0.3.0"""
from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Haff(CMakePackage):
    """Hydrodynamics of granular gases: the equations of rapid granular flow on lattices and polyhedral meshes, and event-driven grains."""

    license("GPL-3.0-or-later")
    version("0.3.0")  # a release has url and sha256, too

    variant("petsc", default=True, description="Implicit diffusion")
    variant("python", default=True, description="Packages that the commands haff, haffPlot, haffMovie, haffLog and newCase need")

    depends_on("c", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("pkgconfig", type="build", when="+petsc")
    depends_on("mpi", type=("build", "link", "run"))
    depends_on("p4est+mpi")  # with libsc
    depends_on("metis@5:~int64~real64")
    depends_on("netlib-lapack+lapacke")  # other packages of LAPACK have no library of the name lapacke
    depends_on("libdeflate")
    depends_on("zlib-api")
    depends_on("petsc+mpi~complex~int64", when="+petsc")
    with when("+python"):
        depends_on("python@3.9:", type=("build", "run"))
        depends_on("py-numpy", type=("build", "run"))
        depends_on("py-matplotlib", type=("build", "run"))

    def cmake_args(self):
        """CMakeLists.txt asks pkg-config for PETSc alone."""
        return [self.define("BUILD_TESTING", False), self.define("CMAKE_DISABLE_FIND_PACKAGE_PkgConfig", self.spec.satisfies("~petsc"))]

    @run_after("install")
    def choose_python(self):
        """The commands run with the Python of Spack, which sees its packages."""
        if self.spec.satisfies("+python"):
            filter_file("#!/usr/bin/python3", "#!" + self.spec["python"].command.path, self.prefix.bin.haff, string=True)
