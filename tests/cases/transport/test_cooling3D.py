# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres that cool in a periodic cube: the shipped case in fewer cells, and faint waves beside linear theory (postprocessing/studies/exact/disks.py)."""
import os
import unittest

import numpy as np

from tests.cases import harness

from studies.exact import disks, garzoDufty

NU, E, FAINT = 0.1, 0.8, 1e-6


class Cooling3D(harness.Folder, unittest.TestCase):
    def test_expected(self):
        """Among others: twice Haff's law when 190,986 spheres have it, to 15 %."""
        self.compare(self.short("cooling3D", 20, endTime=1500), harness.entries("cooling3D"))

    def waves(self, n, length, end):
        """A wave along x of velocity across itself and of density: the largest errors over the largest values in theory."""
        gas = garzoDufty.Grains(3, E)
        theory, k, x = disks.Cooling(gas, NU), 2 * np.pi / length, (np.tile(np.arange(n), 16) + 0.5) * length / n
        ones, faint, side = np.ones(16 * n), FAINT * np.cos(k * x), 4 * length / n
        path = harness.box_case(os.path.join(self.folder, f"{length}in{n}"), (n, 4, 4), (length, side, side), NU / gas.per * (1 + faint),
                                np.outer(faint, (0, 0.6, 0.8)), ones, end, e=E, cooling="GarzoDufty", eos="TorquatoSpheres",
                                types={a: "cyclic" for a in "xyz"}, reconstruct="WPENO5", courant=0.4)
        os.remove(os.path.join(path, "0", "p"))
        harness.boxes.write_field(path, "T", ones, '".*" cyclic')
        harness.edit(path, "constant/granularProperties", transport="GarzoDufty", diameter=1)
        harness.program("granularGas", "-case", path)
        case, T = harness.haff.Case(path), gas.cooled(NU, 1, end)
        u = case.field("U") / np.sqrt(T)
        rho, along, heat = (np.real(q * np.exp(1j * k * x)) for q in theory.along(k, (1, 0, 0), end))
        pairs = ((case.field("rho") / NU * gas.per - 1, rho), (u[:, 0], along), (case.field("T") / T - 1, heat),
                 (u[:, 1:] @ (0.6, 0.8), np.exp(theory.across(k) * theory.tau(end)) * np.cos(k * x)))
        return np.array([np.abs(a / FAINT - b).max() / np.abs(b).max() for a, b in pairs])

    def test_waves(self):
        """To second order, of a length of which vortices grow and clusters do not, and of one of which both do."""
        vortices, clusters = 2 * np.pi / np.array(disks.Cooling(garzoDufty.Grains(3, E), NU).thresholds())
        self.assertTrue(vortices < 28 < clusters < 56)
        for length in (28, 56):
            with self.subTest(length=length):
                coarse, fine = (self.waves(n, length, 30) for n in (24, 48))
                self.assertLess(fine.max(), 0.02)
                self.assertGreater(np.log2(coarse / fine).min(), 1.8, f"{coarse} {fine}")


if __name__ == "__main__":
    unittest.main()
