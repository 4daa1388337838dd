"""The isentropic vortex on gmsh's triangles through the programs, from expressions: cell averages at the start, and the
order of the whole, which values at the cells' centres would take down to two."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
import triangles

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


if __name__ == "__main__":
    unittest.main()
