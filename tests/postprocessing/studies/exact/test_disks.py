# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference solutions of steady flow between two walls: what they are solutions of, by other means than the solver's."""
import unittest

import numpy as np

from tests.cases import harness  # noqa: F401  (it knows where the module is)

from studies.exact import disks

HEIGHT, ALPHA = 20, 0.2


def integral(y, q):
    return np.diff(y) @ (0.5 * (q[1:] + q[:-1]))


class Walls(unittest.TestCase):
    """Walls of Johnson & Jackson that move against each other."""

    def setUp(self):
        self.gas = disks.Disks(0.9)
        self.low = {"u": -2, "specularity": 0.3, "restitution": 0.85}
        self.high = {"u": 1, "specularity": 0.6, "restitution": 0.95}
        self.flow = disks.Channel(self.gas, HEIGHT, ALPHA, self.low, self.high)

    def test_equations(self):
        """Differences of the solution on a fine grid obey the equations: they are of fourth order there."""
        y = np.linspace(0, HEIGHT, 4001)
        rho, T, u, p = (self.flow(y, name) for name in ("rho", "T", "u", "p"))
        np.testing.assert_allclose(p, rho * T * self.gas.A(rho * self.gas.per), rtol=1e-9)
        self.assertAlmostEqual(integral(y, rho) / (ALPHA / self.gas.per * HEIGHT), 1, places=6)

        def slope(q):
            return (8 * (q[3:-1] - q[1:-3]) - (q[4:] - q[:-4])) / (12 * (y[1] - y[0]))

        inner = slice(2, -2)
        mu, kappa = self.gas.shear(rho, T), self.gas.heat(rho, T)
        tau = mu[inner] * slope(u)
        np.testing.assert_allclose(tau, tau.mean(), rtol=1e-6)
        flux = np.zeros_like(T)
        flux[inner] = kappa[inner] * slope(T)
        residual = slope(flux)[2:-2] + (tau**2 / mu[inner] - self.gas.sink(rho, T)[inner])[2:-2]
        np.testing.assert_allclose(residual, 0, atol=1e-6 * self.gas.sink(rho, T).max())

    def test_balance(self):
        """What the walls do as work, impacts in the gas and with the walls take; both walls feel the same stress."""
        y = np.linspace(0, HEIGHT, 4001)
        taken = integral(y, self.gas.sink(self.flow(y, "rho"), self.flow(y, "T")))
        tau = self.flow(np.array([0, HEIGHT]), "tau")
        self.assertAlmostEqual(tau[0], tau[1], places=9)
        for at, wall, towards in ((0, self.low, -1), (HEIGHT, self.high, 1)):
            p, T, u = (float(self.flow(at, name)) for name in ("p", "T", "u"))
            hits = p / np.sqrt(2 * np.pi * T)  # mass of the grains that hit the wall, per area and time
            taken += (1 - wall["restitution"]**2) * hits * T
            self.assertAlmostEqual(tau[0] / (towards * wall["specularity"] * hits * (wall["u"] - u)), 1, places=8)
        self.assertAlmostEqual(tau[0] * (self.high["u"] - self.low["u"]) / taken, 1, places=6)

    def test_limits(self):
        """With much specularity the gas has the wall's velocity; with none a wall does not drag."""
        held = disks.Channel(self.gas, HEIGHT, ALPHA, {"T": 1, "u": -2}, {"T": 1, "u": 2})
        rough = disks.Channel(self.gas, HEIGHT, ALPHA, *({"T": 1, "u": u, "specularity": 1e7} for u in (-2, 2)))
        y = np.linspace(0, HEIGHT, 11)
        for name in ("u", "T", "p"):
            np.testing.assert_allclose(rough(y, name), held(y, name), rtol=1e-5, atol=1e-5)
        smooth = disks.Channel(self.gas, HEIGHT, ALPHA, {"T": 1, "u": 0}, {"T": 1, "u": 2, "specularity": 0})
        np.testing.assert_allclose(smooth(y, "u"), 0, atol=1e-9)

    def test_uniform(self):
        """Where friction and impacts balance in the gas, and at the walls, T and rho are uniform: in closed form."""
        rho, T, e = ALPHA / self.gas.per, 1.3, 0.8
        p, mu = rho * T * self.gas.A(ALPHA), self.gas.shear(rho, T)
        rate = np.sqrt(self.gas.sink(rho, T) / mu)
        phi = 2 * np.pi * (mu * rate / p) ** 2 / (1 - e * e)
        u = rate * HEIGHT / 2 + mu * rate * np.sqrt(2 * np.pi * T) / (phi * p)
        flow = disks.Channel(self.gas, HEIGHT, ALPHA, *({"u": v, "specularity": phi, "restitution": e} for v in (-u, u)))
        y = np.linspace(0, HEIGHT, 11)
        np.testing.assert_allclose(flow(y, "T"), T, rtol=1e-6)
        np.testing.assert_allclose(flow(y, "alpha"), ALPHA, rtol=1e-6)
        np.testing.assert_allclose(flow(y, "u"), rate * (y - HEIGHT / 2), atol=1e-6)


if __name__ == "__main__":
    unittest.main()
