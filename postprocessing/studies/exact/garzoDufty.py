# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures of Garzo & Dufty (1999) for a gas of inelastic disks (d = 2) or spheres (d = 3), as in `transport GarzoDufty` and `cooling
GarzoDufty`; written from the formulas in d dimensions, not from the solver. Grain mass 1, T per unit mass.

    gas = garzoDufty.Grains(3, restitution=0.9)
    gas.heat(rho, T)                                    # q = -heat grad T - cross grad rho

They take the place of those of disks.Disks, whose contact value, pressure and flows they share.
"""
from math import gamma

import numpy as np

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
