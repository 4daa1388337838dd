# SPDX-License-Identifier: GPL-3.0-or-later
"""The isentropic vortex on gmsh's triangles through the programs, from expressions: cell averages at the start, and the
order of the whole, which values at the cells' centres would take down to two."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from studies.made import triangles

haff = harness.haff


def vortex(x, t=0.0):
    """rho, rho u, rho v, E of the vortex in cases/vortex, as its expressions give it at the start."""
    x = np.mod(x - t, 10) - 5
    swirl = 5 / (2 * np.pi) * np.exp((1 - (x**2).sum(axis=1)) / 2)
    T = 1 - swirl**2 / 7
    rho, u, v = T**2.5, 1 - swirl * x[:, 1], 1 + swirl * x[:, 0]
    return np.stack([rho, rho * u, rho * v, rho * T / 0.4 + rho * (u**2 + v**2) / 2], axis=1)


@unittest.skipUnless(runs.shutil.which("gmsh"), "gmsh is not installed")
class Triangles(harness.Folder, unittest.TestCase):
    def run_vortex(self, n, end, reconstruct="CWENO3", **control):
        case = harness.copy("vortex", self.folder)
        triangles.make(case, 10.0, n, os.path.join(harness.BIN, "gmshToCase"))
        runs.add(case, "system/fvSchemes", f"polyReconstruct {reconstruct};\n")
        return harness.run(case, endTime=end, writeInterval=end, maxCo=0.8, **control)

    def start(self, reconstruct):
        """Relative deviation of the conserved variables from their averages, after a step of no length."""
        case = self.run_vortex(20, 1e-12, reconstruct)
        rho, momentum, energy = (case.field(name) for name in ("rho", "rhoU", "rhoE"))
        found = np.column_stack([rho, momentum[:, :2], energy])
        wanted = triangles.means(case.mesh, vortex, 4)
        return np.abs(found - wanted).max(axis=0) / np.abs(wanted).max(axis=0)

    def test_start(self):
        self.assertLess(self.start("CWENO3").max(), 2e-5)  # the quadrature's own error
        self.assertGreater(self.start("linear").min(), 1e-3)  # values at the centres, which are as good there

    def test_order(self):
        errors = []
        for n in (40, 80):
            case = self.run_vortex(n, 1)
            known = triangles.means(case.mesh, lambda x: vortex(x, 1.0)[:, 0])
            errors.append((np.abs(case.field("rho") - known) * case.volumes).sum() / case.volumes.sum())
        self.assertGreater(np.log2(errors[0] / errors[1]), 2.7, f"errors {errors}")

    def test_noise_is_damped(self):
        """At the largest Courant numbers that are allowed."""
        mesh = os.path.join(self.folder, "noise")
        triangles.make(mesh, 1.0, 10, os.path.join(harness.BIN, "gmshToCase"))
        patches = {name: kind for name, (kind, _, _) in haff.Mesh(mesh + "/constant/polyMesh").patches.items()}
        cells = haff.Case(mesh).mesh.cells
        noise = 1 + 1e-6 * np.random.default_rng(3).uniform(-1, 1, (4, cells))
        for speed in (0.0, 1.0):
            for reconstruct in ("CWENO3", "linear"):
                for stepper, courant in (("SSPRK3", 1.0), ("SSPRK43", 2.0)):
                    case = os.path.join(self.folder, f"noise {speed} {reconstruct} {stepper}")
                    runs.shutil.copytree(mesh, case)
                    u = speed * np.column_stack([noise[2], 0.7 * noise[3], 0 * noise[0]])
                    harness.boxes.write_case(case, patches, noise[0], u, noise[1], 1e9, eos="perfectGas", gamma=1.4, stepper=stepper,
                                             courant=courant, control="timeStep", interval=300)
                    runs.add(case, "system/fvSchemes", f"polyReconstruct {reconstruct};\n")
                    runs.add(case, "system/controlDict", "stopAt nextWrite;\n")
                    harness.program("granularGas", "-case", case)
                    result = haff.Case(case)
                    with self.subTest(f"{speed:g} {reconstruct} {stepper}"):
                        self.assertLess(result.field("p").std() / noise[1].std(), 0.3)
                        self.assertLess(result.field("rho").std() / noise[0].std(), 1.5)  # at rest an entropy wave stays


if __name__ == "__main__":
    unittest.main()
