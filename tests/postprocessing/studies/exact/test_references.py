# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python references against values that were made without them: oracles, Sod's tube, conservation, the equations."""
import csv
import os
import unittest

import numpy as np

from studies.exact.eos import GoldshteinShapiro, PerfectGas, isentrope
from studies.exact.riemann import BLAST, Riemann
from studies.exact.simpleWave import SETTINGS, SimpleWave

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..")))
ORACLES = os.path.join(SOURCE, "tests", "oracles")


class Gas(unittest.TestCase):
    def test_oracle(self):
        with open(os.path.join(ORACLES, "gs_eos.csv")) as f:
            rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(f)]
        self.assertGreater(len(rows), 20)
        for row in rows:
            gas, nu = GoldshteinShapiro(row["e"]), row["nu"]
            for name, value in (("G", gas.G(nu)), ("A", gas.A(gas.rho(nu))), ("rho_dA_drho", gas.rho_dA(gas.rho(nu))),
                                ("cs_at_T1", gas.c(gas.rho(nu), 1.0)), ("gamma_A", gas.adiabatic_exponent(nu)),
                                ("Grueneisen", gas.grueneisen(nu)),
                                ("fundamental_derivative", gas.fundamental_derivative(nu))):
                # up to three powers of 1/(1 - x), each with two roundings of x
                self.assertAlmostEqual(value / row[name], 1, delta=1e-14 + 1.4e-15 / (1 - gas.x(nu)), msg=f"{name} {row}")

    def test_cooling(self):
        with open(os.path.join(ORACLES, "hcs.csv")) as f:
            rows = [row for row in csv.DictReader(f) if row["model"].startswith("GS")]
        self.assertTrue(rows)
        for row in rows:
            gas = GoldshteinShapiro(float(row["e"]))
            T = gas.cooled(gas.rho(float(row["phi"])), float(row["T0"]), float(row["t"]))
            self.assertAlmostEqual(T / float(row["T"]), 1, delta=1e-12)

    def test_isentrope(self):
        """Perfect gas: T ~ rho^(gamma-1), the integral of c/rho is 2c/(gamma-1); dense gas: dp/drho = c^2."""
        gas = PerfectGas(1.4)
        T, integral = isentrope(gas, 1.0, 1.0, np.array([0.1, 0.5, 2.0]))
        np.testing.assert_allclose(T, np.array([0.1, 0.5, 2.0]) ** 0.4, rtol=1e-14)
        np.testing.assert_allclose(integral, 5 * (gas.c(1.0, T) - gas.c(1.0, 1.0)), rtol=1e-13)
        gas = GoldshteinShapiro(0.9)
        rho, h = gas.rho(np.array([0.05, 0.3, 0.5])), 1e-3
        p = [gas.p(r, isentrope(gas, gas.rho(0.2), 2.0, r)[0]) for r in (rho - h, rho + h)]
        c = gas.c(rho, isentrope(gas, gas.rho(0.2), 2.0, rho)[0])
        np.testing.assert_allclose((p[1] - p[0]) / (2 * h), c**2, rtol=1e-6)


class RiemannProblem(unittest.TestCase):
    def test_sod(self):
        s = Riemann(PerfectGas(1.4), (1, 0, 1), (0.125, 0, 0.1))
        for value, known in ((s.p, 0.30313), (s.u, 0.92745), (s.left.rho, 0.42632), (s.right.rho, 0.26557)):
            self.assertAlmostEqual(value, known, delta=6e-6)  # Toro, Riemann Solvers, table 4.2
        # inside the fan a perfect gas has u = 2/(gamma+1) (c0 + x/t)
        xi = np.linspace(s.left.head, s.left.tail, 7)[1:-1]
        np.testing.assert_allclose(s.sample(xi)[1], (np.sqrt(1.4) + xi) / 1.2, rtol=1e-12)

    def test_blast(self):
        gas = GoldshteinShapiro(1.0)
        s = Riemann(gas, *BLAST)
        for value, known, digits in ((s.p, 12.5442, 5e-5), (s.u, 0.392465, 5e-7), (gas.nu(s.left.rho), 0.043208, 5e-7),
                                     (gas.nu(s.right.rho), 0.073380, 5e-7), (s.left.speed, 0.034866, 5e-7),
                                     (s.right.speed, 0.610151, 5e-7)):
            self.assertAlmostEqual(value, known, delta=digits)

    def test_jump_conditions(self):
        """Mass, momentum and energy across both shocks, from speeds and states alone, for several restitutions."""
        for e in (0.2, 0.9, 1.0):
            gas = GoldshteinShapiro(e)
            s = Riemann(gas, *BLAST)
            for wave in (s.left, s.right):
                jumps = []
                for rho, u, p in ((wave.rho0, wave.u0, wave.p0), (wave.rho, s.u, s.p)):
                    E = rho * gas.T(rho, p) * 1.5 + rho * u * u / 2
                    U, F = np.array([rho, rho * u, E]), np.array([rho * u, rho * u * u + p, (E + p) * u])
                    jumps.append(F - wave.speed * U)
                np.testing.assert_allclose(jumps[0], jumps[1], rtol=1e-11, atol=1e-11)

    def test_mirror(self):
        """Exchange of left and right mirrors the solution; dense states with two rarefactions too."""
        gas = GoldshteinShapiro(0.9)
        for left, right in (BLAST, ((300.0, -1.0, 500.0), (500.0, 1.0, 3000.0))):
            a = Riemann(gas, left, right)
            b = Riemann(gas, (right[0], -right[1], right[2]), (left[0], -left[1], left[2]))
            xi = np.linspace(-20, 20, 41) + 0.03
            np.testing.assert_allclose(a.sample(xi), b.sample(-xi) * np.array([[1], [-1], [1]]), rtol=1e-9, atol=1e-9)

    def test_averages_conserve(self):
        """The integral over a wide interval changes by the fluxes at its ends."""
        gas = GoldshteinShapiro(1.0)
        rho, _, _ = Riemann(gas, *BLAST).averages(np.linspace(0, 10, 131), 5, 5.48)
        mass = 5 * (44.5 + 50) + 44.5 * 0.698 * 5.48
        self.assertAlmostEqual(rho.sum() * 10 / 130 / mass, 1, delta=1e-12)

    def test_vacuum_is_refused(self):
        with self.assertRaises(ValueError):
            Riemann(PerfectGas(1.4), (1, -50, 1), (1, 50, 1))


class Wave(unittest.TestCase):
    def test_settings(self):
        gas = GoldshteinShapiro(1.0)
        x = np.linspace(0, 1, 400)
        for name, velocity in SETTINGS.items():
            wave = SimpleWave(gas, velocity=velocity)
            u, T = wave.state(wave.density(x)[0])
            c = gas.c(wave.density(x)[0], T)
            speeds = {"supersonic": u - c, "subsonic": u, "sonic": u + c}[name]
            self.assertEqual(name == "supersonic", bool(speeds.min() * speeds.max() > 0))

    def test_solves_the_equations(self):
        """Residual of mass, momentum and energy by sixth-order differences of the point values in x and t."""
        gas = GoldshteinShapiro(1.0)
        wave = SimpleWave(gas, velocity=0.4)
        t, x, h = 0.3 * wave.breaking_time, np.linspace(0, 1, 23), 2e-3

        def conserved_and_flux(x, t):
            rho, u, p = wave.at(x, t)
            E = 1.5 * rho * gas.T(rho, p) + rho * u * u / 2
            return np.array([rho, rho * u, E]), np.array([rho * u, rho * u * u + p, (E + p) * u])

        weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
        in_t = sum(w * (conserved_and_flux(x, t + k * h / 5)[0] - conserved_and_flux(x, t - k * h / 5)[0])
                   for k, w in weights) / (h / 5)
        in_x = sum(w * (conserved_and_flux(x + k * h, t)[1] - conserved_and_flux(x - k * h, t)[1])
                   for k, w in weights) / h
        np.testing.assert_allclose(in_t + in_x, 0, atol=1e-7 * abs(in_x).max())

    def test_mass_and_feet(self):
        wave = SimpleWave(GoldshteinShapiro(1.0), velocity=0.0)
        x = (np.arange(256) + 0.5) / 256
        for part in (0.0, 0.3, 0.8):
            t = part * wave.breaking_time
            foot = wave.foot(x, t)
            np.testing.assert_allclose(foot + wave.speed(foot) * t, x, atol=2e-15)
        self.assertAlmostEqual(wave.at(x, 0.3 * wave.breaking_time)[0].mean() / wave.rho0, 1, delta=1e-13)

    def test_breaking_time(self):
        wave = SimpleWave(GoldshteinShapiro(1.0))
        s = np.linspace(0, 1, 20001)
        slope = np.gradient(wave.speed(s), s)
        self.assertAlmostEqual(wave.breaking_time * -slope.min(), 1, delta=1e-5)
        with self.assertRaises(ValueError):
            wave.at(s, wave.breaking_time)


if __name__ == "__main__":
    unittest.main()
