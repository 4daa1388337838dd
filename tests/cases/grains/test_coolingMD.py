# SPDX-License-Identifier: GPL-3.0-or-later
"""Short forms of coolingDisksMD and cooling3DMD, smaller and until they begin to cluster."""
import unittest

import numpy as np

from tests.cases import harness

from studies.measured import clustering


class CoolingMD(harness.Folder, unittest.TestCase):
    def check(self, name, side, end):
        case = harness.copy(name, self.folder)
        path = f"{case}/mesh.geo"
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("L = {100,", f"L = {{{side},"))
        harness.mesh(case, 8)
        harness.edit(case, "system/controlDict", endTime=end, writeInterval=end, deltaT=end)
        harness.program("granularMD", "-case", case)
        self.compare(harness.haff.Case(case), harness.entries(name))
        box = clustering.Box(case)
        t, _, T = box.totals()
        over = T[-1] / box.haff(t[-1])
        self.assertTrue(1 < over < 1.1, f"{over} of Haff's law")  # coolingGas: grains cool the more slowly the less elastic they are
        rho, j = box.put(*box.cloud(box.case.times[-1]), 16)
        n, _, across, along = box.spectra(rho, j)
        first = n < 4.5
        weights = n[first] ** (box.d - 1)
        self.assertGreater(np.average(across[first], weights=weights), 2 * np.average(along[first], weights=weights))  # vortices come first
        np.testing.assert_allclose(rho.mean(), 1, rtol=1e-12)

    def test_disks(self):
        self.check("coolingDisksMD", 240, 40)

    def test_spheres(self):
        self.check("cooling3DMD", 48, 30)


if __name__ == "__main__":
    unittest.main()
