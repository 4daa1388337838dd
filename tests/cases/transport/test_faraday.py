# SPDX-License-Identifier: GPL-3.0-or-later
"""Short form of faraday: one wave in a box of 38, eight strokes of the plate."""
import os
import subprocess
import unittest

import numpy as np

from tests.cases import harness

from haff.layers import faraday


class Faraday(harness.Folder, unittest.TestCase):
    def test_one_wave(self):
        cycles, length = 7, 38
        case = harness.copy("faraday", self.folder)
        msh = os.path.join(case, "mesh.msh")
        subprocess.run(["gmsh", "-3", "-v", "2", "-setnumber", "L", str(length), os.path.join(case, "mesh.geo"), "-o", msh],
                       check=True, capture_output=True)
        harness.program("gmshToCase", msh, "-case", case)
        harness.edit(case, "0.orig/alpha", modes=1)
        case = harness.run(case, endTime=repr(cycles / 3.5), maxCo=0.4)
        layer = faraday.Layer(case)
        self.assertAlmostEqual(layer.amplitude, 5.57, places=12)
        mass = [case.field("alpha", time) @ case.volumes for time in case.times[1:]]
        np.testing.assert_allclose(mass, case.volumes.sum() / 60 * 6 * 0.82, rtol=1e-11)  # gmsh's points lie 1e-11 beside their places

        def centre(cycle):
            return layer.height(case.time(cycle / layer.frequency)).mean()
        # down at whole cycles, thrown up between them; the layer at rest lies at 3
        for cycle in (5, 6, 7):
            self.assertLess(abs(centre(cycle) - 5.05), 0.1)
            self.assertGreater(centre(cycle - 0.5), 8)
        # the wave turns over at every stroke and grows; 1.70 a cycle in the prototype and at smaller steps
        at, amplitudes = faraday.samples(layer, of="height")[0]
        wave = amplitudes[at >= 4, 1]
        self.assertTrue(((wave[1:] / wave[:-1]).real < 0).all())
        np.testing.assert_allclose(np.abs(np.angle(wave[1:] / wave[:-1])), np.pi, atol=0.01)
        self.assertLess(abs(np.sqrt(abs(wave[-1] / wave[-3])) - 1.70), 0.1)


if __name__ == "__main__":
    unittest.main()
