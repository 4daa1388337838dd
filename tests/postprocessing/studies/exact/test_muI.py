# SPDX-License-Identifier: GPL-3.0-or-later
"""The law of Jop, Forterre & Pouliquen: Bagnold's flow without side walls, what side walls take of it, where nothing flows."""
import unittest

import numpy as np

from tests.cases import harness
from studies.exact import muI


class Layers(unittest.TestCase):
    def test_bagnold_balances_gravity(self):
        """mu at the constant inertial number of the closed form is tan(slope), and the velocity is the integral of its shear rate."""
        slope, depth = 27.0, 22.5
        y = np.linspace(0, depth, 200001)
        pressure = muI.PACKING * np.cos(np.radians(slope)) * (depth - y)
        number = muI.I_0 * (np.tan(np.radians(slope)) - muI.MU_S) / (muI.MU_2 - np.tan(np.radians(slope)))
        shear = number * np.sqrt(pressure)
        np.testing.assert_allclose(muI.viscosity(shear[:-1], pressure[:-1]) * shear[:-1] / pressure[:-1], np.tan(np.radians(slope)), rtol=1e-12)
        velocity = np.concatenate([[0], np.cumsum((shear[1:] + shear[:-1]) / 2 * np.diff(y))])
        np.testing.assert_allclose(muI.bagnold(slope, depth), (velocity[-1], np.trapz(velocity, y)), rtol=1e-6)

    def test_silbert(self):
        """V* goes as depth^1.5, Q* as depth^2.5."""
        np.testing.assert_allclose(np.divide(muI.bagnold(25, 40), muI.bagnold(25, 10)), (8, 32), rtol=1e-12)

    def test_where_nothing_flows(self):
        self.assertEqual(muI.bagnold(20, 22.5), (0, 0))
        with self.assertRaisesRegex(ValueError, "no steady flow"):
            muI.channel(33, 22.5, 48)

    def test_wide_channel(self):
        """Far from its walls the channel has the closed form's velocity, within the first order of a shear rate that goes as the root of the depth at the surface."""
        exact = muI.bagnold(27, 10)[0]
        errors = [abs(muI.channel(27, 10, 1e6, cells)[0] / exact - 1) for cells in (8, 16)]
        self.assertLess(errors[1], 0.02)
        self.assertLess(errors[1], 0.6 * errors[0])

    def test_narrow_channel(self):
        """Walls hold the layer back, the more the nearer they are; below the angle of rest it creeps at no more than the shear rate at which viscosities end."""
        flows = [muI.channel(27, 22.5, width, 20)[1] for width in (200, 48, 24)]
        self.assertGreater(muI.bagnold(27, 22.5)[1], flows[0])
        self.assertGreater(flows[0], 3 * flows[1])
        self.assertGreater(flows[1], 3 * flows[2])
        self.assertLess(muI.channel(20.5, 22.5, 24, 20)[0], muI.FLAT * 22.5)

    def test_command(self):
        done = harness.command("muI", "-slope", "25", "-cells", "16")
        self.assertEqual(done.returncode, 0, done.stderr)
        velocity, flow = muI.bagnold(25, 22.5)
        self.assertIn(f"without side walls: V* {velocity:.2f}, Q* {flow:.1f}\n", done.stdout)
        self.assertRegex(done.stdout, r"^between rough side walls: V\* \d+\.\d\d, Q\* \d")


if __name__ == "__main__":
    unittest.main()
