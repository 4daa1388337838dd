# SPDX-License-Identifier: GPL-3.0-or-later
"""Oblique shocks against the perfect gas's closed forms, the jump conditions and their limits."""
import unittest

import numpy as np

from studies.exact.eos import GoldshteinShapiro, PerfectGas, isentrope
from studies.exact.obliqueShock import ObliqueShock, enthalpy, stagnation


def stream(nu, mach, e=1.0, T=2.0):
    gas = GoldshteinShapiro(e)
    rho = gas.rho(nu)
    return ObliqueShock(gas, rho, gas.p(rho, T), mach)


class Perfect(unittest.TestCase):
    def test_closed_forms(self):
        """The theta-beta-M relation, the jumps of rho and p and the angle of detachment (NACA report 1135)."""
        for g in (1.4, 5 / 3, 2.0):
            for mach in (1.2, 3.0, 12.0):
                shock = ObliqueShock(PerfectGas(g), 1.3, 0.7, mach)
                beta = np.linspace(shock.mach_angle + 0.01, np.pi / 2 - 0.001, 23)
                m2 = (mach * np.sin(beta)) ** 2
                theta = np.arctan(2 / np.tan(beta) * (m2 - 1) / (mach**2 * (g + np.cos(2 * beta)) + 2))
                state = shock.behind(beta)
                np.testing.assert_allclose(shock.deflection(beta), theta, rtol=0, atol=1e-12)
                np.testing.assert_allclose(state.rho / 1.3, (g + 1) * m2 / ((g - 1) * m2 + 2), rtol=1e-12)
                np.testing.assert_allclose(state.p / 0.7, 1 + 2 * g / (g + 1) * (m2 - 1), rtol=1e-12)
                root = np.sqrt((g + 1) * ((g + 1) * mach**4 + 8 * (g - 1) * mach**2 + 16))
                top = np.arcsin(np.sqrt(((g + 1) * mach**2 - 4 + root) / (4 * g * mach**2)))
                self.assertAlmostEqual(shock.detachment()[1], top, delta=1e-6)

    def test_table(self):
        shock = ObliqueShock(PerfectGas(1.4), 1.0, 1.0, 3.0)
        self.assertAlmostEqual(np.degrees(shock.angle(np.radians(15))), 32.24, delta=0.005)
        self.assertAlmostEqual(np.degrees(shock.detachment()[0]), 34.07, delta=0.005)
        self.assertAlmostEqual(float(shock.behind(np.pi / 2).mach), 0.47519, delta=5e-6)
        rho, p, T = stagnation(PerfectGas(1.4), 1.0, 1.0, 3 * np.sqrt(1.4))
        for value, known in ((T, 2.8), (p, 2.8**3.5), (rho, 2.8**2.5)):
            self.assertAlmostEqual(value / known, 1, delta=1e-12)


class Granular(unittest.TestCase):
    def test_jump_conditions(self):
        """Mass, both momenta, energy through the shock, from the states and the deflection alone; both branches."""
        for nu, mach, e in ((0.1, 3.5, 1.0), (0.01, 8.0, 1.0), (0.4, 2.0, 1.0), (0.2, 3.0, 0.8)):
            shock = stream(nu, mach, e)
            theta = shock.detachment()[0] * np.array([0.1, 0.5, 0.95])
            for strong in (False, True):
                beta = shock.angle(theta, strong)
                np.testing.assert_allclose(shock.deflection(beta), theta, rtol=0, atol=1e-13)
                s = shock.behind(beta)
                fluxes = []
                for rho, p, speed, to_shock in ((shock.rho, shock.p, shock.speed, beta), (s.rho, s.p, s.speed, beta - theta)):
                    un, ut = speed * np.sin(to_shock), speed * np.cos(to_shock)
                    T = shock.eos.T(rho, p)
                    fluxes.append((rho * un, p + rho * un**2, rho * un * ut, enthalpy(shock.eos, rho, T) + (un**2 + ut**2) / 2))
                np.testing.assert_allclose(*fluxes, rtol=1e-12)
                self.assertTrue(np.all(s.p > shock.p))

    def test_branches(self):
        shock = stream(0.1, 3.5)
        greatest, top = shock.detachment()
        theta = greatest * np.linspace(0.05, 0.999, 9)
        weak, strong = shock.angle(theta), shock.angle(theta, strong=True)
        self.assertTrue(np.all(np.diff(weak) > 0) and np.all(np.diff(strong) < 0) and np.all(weak < top) and np.all(top < strong))
        self.assertTrue(np.all(shock.behind(strong).mach < 1))
        with self.assertRaises(ValueError):
            shock.angle(1.001 * greatest)
        with self.assertRaises(ValueError):
            stream(0.1, 0.9)

    def test_mach_wave(self):
        """As theta -> 0 the shock becomes the Mach wave: beta - mu -> theta GG/2 M^2/(M^2 - 1), GG the fundamental derivative."""
        shock = stream(0.1, 3.5)
        theta = 1e-3 / 2.0 ** np.arange(5)
        excess = shock.angle(theta) - shock.mach_angle
        np.testing.assert_allclose(excess[:-1] / excess[1:], 2, rtol=2e-3)
        GG, m2 = shock.eos.fundamental_derivative(0.1), shock.mach**2
        self.assertAlmostEqual(2 * excess[-1] / theta[-1] - excess[-2] / theta[-2], GG / 2 * m2 / (m2 - 1), delta=1e-4)

    def test_dilute_limit(self):
        """The difference to the perfect gas's angle and density falls in proportion to the volume fraction."""
        perfect = ObliqueShock(PerfectGas(), 1.0, 1.0, 3.5)
        known = perfect.angle(np.radians(15))
        ratio = perfect.behind(known).rho
        off = []
        for nu in (1e-5, 5e-6):
            shock = stream(nu, 3.5)
            beta = shock.angle(np.radians(15))
            off.append((beta - known, shock.behind(beta).rho / shock.rho - ratio))
        self.assertTrue(np.all(np.abs(off) < 1e-3))
        np.testing.assert_allclose(np.divide(*off), 2, rtol=1e-3)

    def test_stagnation(self):
        """Energy is kept, and dT/drho on the way is the isentrope's: from a half-way state the same end is reached."""
        gas = GoldshteinShapiro(0.9)
        rho, T, speed = gas.rho(0.2), 3.0, 6.0
        r, p, temperature = stagnation(gas, rho, T, speed)
        self.assertAlmostEqual(enthalpy(gas, r, temperature) / (enthalpy(gas, rho, T) + speed**2 / 2), 1, delta=1e-13)
        self.assertEqual(p, gas.p(r, temperature))
        middle = (rho + r) / 2
        h = 1e-4 * rho
        Tm = float(isentrope(gas, rho, T, middle)[0])
        slope = (isentrope(gas, rho, T, middle + h)[0] - isentrope(gas, rho, T, middle - h)[0]) / (2 * h)
        self.assertAlmostEqual(slope / ((gas.gamma - 1) * gas.A(middle) * Tm / middle), 1, delta=1e-6)
        speed2 = 2 * (enthalpy(gas, rho, T) + speed**2 / 2 - enthalpy(gas, middle, Tm))
        np.testing.assert_allclose(stagnation(gas, middle, Tm, np.sqrt(speed2)), (r, p, temperature), rtol=1e-11)


if __name__ == "__main__":
    unittest.main()
