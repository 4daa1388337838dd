# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures of Garzo & Dufty (1999) for a gas of inelastic disks (d = 2) or spheres (d = 3), as in `transport GarzoDufty` and `cooling
GarzoDufty`; written from the formulas in d dimensions, not from the solver. Grain mass 1, T per unit mass.

    gas = garzoDufty.Grains(3, restitution=0.9)
    gas.heat(rho, T)                                    # q = -heat grad T - cross grad rho

They take the place of those of disks.Disks, whose contact value, pressure and flows they share.
"""
from math import gamma

import numpy as np
from scipy.integrate import solve_bvp

from haff.start import enskog
from studies.exact import disks


class Grains(disks.Disks):
    def __init__(self, d, restitution, diameter=1.0):
        self.d, self.e, self.sigma = d, restitution, diameter
        self.per = enskog.volume(d, diameter)  # packing per density
        self.packed = {2: 0.82, 3: 0.64}[d]

    def starred(self, nu):
        """bulk, shear, heat and cross in units of shear0, shear0, heat0 and heat0 T/rho; zeta0."""
        d, e, a2 = self.d, self.e, enskog.a2(self.e, self.d)
        chi, X, two = self.G(nu) / nu, self.G(nu), 2.0 ** (self.d - 2)
        zeta = (d + 2) / (4 * d) * (1 - e * e) * chi * (1 + 3 * a2 / 16)
        of_shear = 3 / (4 * d) * chi * (1 + e) * (1 - e + 2 * d / 3) * (1 - a2 / 32)
        of_heat = (1 + e) / d * chi * ((d - 1) / 2 + 3 / 16 * (d + 8) * (1 - e) + (4 + 5 * d - 3 * (4 - d) * e) * a2 / 512)
        bulk = 32 * two * two / (np.pi * (d + 2)) * nu * X * (1 + e) * (1 - a2 / 16)
        shear = (1 - two / (d + 2) * (1 + e) * (1 - 3 * e) * X) / (of_shear - zeta / 2)
        shear = shear * (1 + 2 * two / (d + 2) * (1 + e) * X) + d / (d + 2) * bulk
        moves = 1 + 3 * two / (d + 2) * (1 + e) * X
        kinetic = (d - 1) / d * (1 + 2 * a2 + 3 * two / (2 * (d + 2)) * X * (1 + e)**2 * (2 * e - 1 + (1 + e) * a2)) / (of_heat - 2 * zeta)
        heat = kinetic * moves + 32 * two * two * (d - 1) / (np.pi * (d + 2)**2) * nu * X * (1 + e) * (1 + 7 * a2 / 16)
        b = self.slope(nu)  # 1 + L
        cross = (b * zeta * kinetic + (d - 1) / d * a2 + 3 * two * (d - 1) / (d * (d + 2)) * X * (1 + b) / 2 * (1 + e) *
                 (e * (e - 1) + a2 / 6 * (10 + 2 * d - 3 * e + 3 * e * e))) / (of_heat - 1.5 * zeta) * moves
        return bulk, shear, heat, cross, zeta

    def shear0(self, T):
        return (self.d + 2) / 8 * gamma(self.d / 2) * np.pi ** (-(self.d - 1) / 2) * np.sqrt(T) / self.sigma ** (self.d - 1)

    def heat0(self, T):
        return self.d * (self.d + 2) / (2 * (self.d - 1)) * self.shear0(T)

    def bulk(self, rho, T):
        return self.shear0(T) * self.starred(rho * self.per)[0]

    def shear(self, rho, T):
        return self.shear0(T) * self.starred(rho * self.per)[1]

    def heat(self, rho, T):
        return self.heat0(T) * self.starred(rho * self.per)[2]

    def cross(self, rho, T):
        return self.heat0(T) * T / rho * self.starred(rho * self.per)[3]

    def zeta_u(self, nu):
        """The geometric part of zeta_U: T falls by T zeta_U div u besides (2/d) p/rho div u."""
        return -3 * 2.0 ** (self.d - 2) / self.d * (1 - self.e**2) * self.G(nu)

    def cooling(self, nu):
        """B in dT/dt = -B T^(3/2)."""
        return self.starred(nu)[4] * nu / self.per / self.shear0(1.0)

    def sink(self, rho, T, rate=0.0):
        return self.d / 2 * rho * self.cooling(rho * self.per) * T**1.5


class Pipe(disks.Channel):
    """Steady flow along a pipe of radius R, which gravity g drives along its axis; of a wall as of disks.Channel. p is uniform, and
    (r tau)' = -r rho g, (r flux)' = r (sink - tau u'). Its own unknowns are r tau, r flux and the mass within r over 2 pi."""

    def __init__(self, gas, radius, alpha, wall, gravity, T=1.0, tolerance=1e-8):
        self.gas, self.radius, self.gravity = gas, radius, gravity
        rho = alpha / gas.per
        mass = rho * radius**2 / 2
        r = np.linspace(1e-6 * radius, radius, 101)
        u = rho * gravity * (radius**2 - r**2) / (4 * gas.shear(rho, T)) + np.sqrt(T)
        guess = np.array([0 * r + rho * T * gas.A(alpha), 0 * r + T, 0 * r, u, -rho * gravity * r**2 / 2, r**2 / radius**2 * mass])

        def ends(a, b):
            at = b / np.array([1, 1, radius, 1, radius, 1])
            return np.array([a[2], a[4], a[5], b[5] / mass - 1, *self.wall(at, wall, -1.0)])

        self.solution = solve_bvp(self.slopes, ends, r, guess, tol=tolerance, max_nodes=200000)
        if not self.solution.success:
            raise ArithmeticError(f"no steady flow found: {self.solution.message}")

    def slopes(self, r, q):
        p, T, _, _, _, _ = q
        flux, tau = q[2] / r, q[4] / r
        T = np.maximum(T, 1e-8)
        rho = self.gas.density(p, T)
        shear, cross = tau / self.gas.shear(rho, T), self.gas.cross(rho, T)
        slope = flux / (self.gas.heat(rho, T) - cross * p / (T * T * self.gas.stiffness(rho * self.gas.per)))
        return np.array([0 * r, slope, r * (self.gas.sink(rho, T, shear) - tau * shear), shear, -r * rho * self.gravity, r * rho])


def pipe(path):
    """That of cases/pipe."""
    phi, e = disks.numbers(path, "0.orig/U", r"wall\s+\{ type JohnsonJacksonSlip; specularityCoefficient (\S+); restitutionCoefficient (\S+);")
    gas = Grains(3, disks.numbers(path, "constant/granularProperties", r"restitution (\S+);")[0])
    wall = {"u": 0.0, "specularity": phi, "restitution": e}
    return Pipe(gas, 10.0, 0.2, wall, disks.numbers(path, "constant/g", r"value\s+\((\S+) 0 0\)")[0])
