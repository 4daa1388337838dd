# SPDX-License-Identifier: GPL-3.0-or-later
"""A cooling gas of disks with viscosity and heat conduction: Haff's law, and the linear theory of its waves
(postprocessing/studies/exact/disks.py)."""
import os
import unittest

import numpy as np

from tests.cases import harness

from studies.exact import disks  # noqa: E402

NU, E, FAINT = 0.2, 0.9, 1e-6


class CoolingDisks(harness.Folder, unittest.TestCase):
    def test_haff(self):
        """Without waves: exact."""
        case = harness.copy("coolingDisks", self.folder)
        harness.mesh(case, 8)
        for name, uniform in (("alpha", NU), ("U", "(0 0 0)")):
            path = os.path.join(case, "0.orig", name)
            with open(path) as f:
                lines = [line for line in f if not line.startswith("expression")]
            with open(path, "w") as f:
                f.writelines(lines)
        result = harness.run(case, endTime=200, writeInterval=200)
        np.testing.assert_allclose(result.field("T"), disks.Disks(E).cooled(NU, 1, 200), rtol=1e-12)

    def waves(self, n, length, end):
        """A wave of velocity across itself, one of density: their largest errors over the largest values in theory."""
        gas = disks.Disks(E)
        theory, k, x = disks.Cooling(gas, NU), 2 * np.pi / length, (np.tile(np.arange(n), 4) + 0.5) * length / n
        ones, faint = np.ones(4 * n), FAINT * np.cos(k * x)
        path = harness.box_case(os.path.join(self.folder, f"{length}in{n}"), (n, 4, 1), (length, 4 * length / n, 1.0),
                                NU / gas.per * (1 + faint), np.outer(faint, (0, 1, 0)), ones, end, e=E, cooling="Haff",
                                eos="TorquatoDisks", gamma=2.0, types={"x": "cyclic", "y": "cyclic"}, reconstruct="WPENO5",
                                courant=0.4)
        os.remove(os.path.join(path, "0", "p"))
        harness.boxes.write_field(path, "T", ones, '"[xy].*" cyclic\nzEmpty empty')
        harness.edit(path, "constant/granularProperties", transport="JenkinsRichman", diameter=1)
        harness.program("granularGas", "-case", path)
        case, T = harness.haff.Case(path), gas.cooled(NU, 1, end)
        shape = np.exp(1j * k * x)
        rho, u, heat = (np.real(q * shape) for q in theory.along(k, (1, 0, 0), end))
        v = np.exp(theory.across(k) * theory.tau(end)) * np.cos(k * x)
        found = (case.field("rho") / NU * gas.per - 1, case.field("U")[:, 0] / np.sqrt(T), case.field("T") / T - 1,
                 case.field("U")[:, 1] / np.sqrt(T))
        return np.array([np.abs(a / FAINT - b).max() / np.abs(b).max() for a, b in zip(found, (rho, u, heat, v))])

    def test_waves(self):
        """To second order, whether vortices and clusters grow or not. The waves of two lengths: 40, where vortices
        grow and clusters do not, and 80, where both do."""
        vortices, clusters = 2 * np.pi / np.array(disks.Cooling(disks.Disks(E), NU).thresholds())
        self.assertTrue(vortices < 40 < clusters < 80)
        for length in (40, 80):
            with self.subTest(length=length):
                coarse, fine = (self.waves(n, length, 60) for n in (24, 48))
                self.assertLess(fine.max(), 0.02)
                self.assertGreater(np.log2(coarse / fine).min(), 1.9, f"{coarse} {fine}")


if __name__ == "__main__":
    unittest.main()
