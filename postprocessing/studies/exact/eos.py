# SPDX-License-Identifier: GPL-3.0-or-later
"""Equations of state in numpy: perfect gas, Goldshtein-Shapiro (Serna & Marquina eqs (1)-(13); where a factor is missing
in print, or the exponent is too large, corrected: docs/physics.md S1, S3, S4), with the adiabatic exponent and the
fundamental derivative (docs/physics.md 2.5), and spheres with Torquato's contact value (docs/physics.md 2.4).

Written from the formulas, not from the solver, so that one can test the other. With grain mass 1, rho is a number
density and T a velocity squared. p = rho T A(rho), T = (gamma - 1) eps.
"""
import os
import re

import numpy as np
from numpy.polynomial import legendre

from haff.start import enskog


class PerfectGas:
    model = "perfectGas"  # the word of the dictionary

    def __init__(self, gamma=5 / 3):
        self.gamma = gamma

    rho_max = np.inf

    def __eq__(self, other):
        return type(self) is type(other) and vars(self) == vars(other)

    def __hash__(self):
        return hash((type(self), *vars(self).values()))

    def A(self, rho):
        return 1 + 0 * rho

    def rho_dA(self, rho):
        return 0 * rho

    def p(self, rho, T):
        return rho * T * self.A(rho)

    def T(self, rho, p):
        return p / (rho * self.A(rho))

    def c_over_root_T(self, rho):
        A = self.A(rho)
        return np.sqrt(A + self.rho_dA(rho) + (self.gamma - 1) * A**2)

    def c(self, rho, T):
        return self.c_over_root_T(rho) * np.sqrt(T)


class GoldshteinShapiro(PerfectGas):
    model = "GoldshteinShapiro"

    def __init__(self, e, sigma=0.1, alpha_max=0.65, gamma=5 / 3):
        super().__init__(gamma)
        self.e, self.sigma, self.alpha_max = e, sigma, alpha_max
        self.a = 4 / 3 * alpha_max
        self.rho_max = alpha_max / (np.pi * sigma**3 / 6)

    def nu(self, rho):
        return np.pi * rho * self.sigma**3 / 6

    def rho(self, nu):
        return nu / (np.pi * self.sigma**3 / 6)

    def x(self, nu):
        return (nu / self.alpha_max) ** self.a

    def G(self, nu):
        return nu / (1 - self.x(nu))

    def dG(self, nu):
        x = self.x(nu)
        return (1 + (self.a - 1) * x) / (1 - x) ** 2

    def A(self, rho):
        return 1 + 2 * (1 + self.e) * self.G(self.nu(rho))

    def rho_dA(self, rho):
        nu = self.nu(rho)
        return 2 * (1 + self.e) * nu * self.dG(nu)

    def adiabatic_exponent(self, nu):
        G, A = self.G(nu), 1 + 2 * (1 + self.e) * self.G(nu)
        return self.gamma + 2 * (1 + self.e) * ((self.gamma - 1) * G + nu * self.dG(nu) / A)

    def grueneisen(self, nu):
        return (self.gamma - 1) * (1 + 2 * (1 + self.e) * self.G(nu))

    def fundamental_derivative(self, nu):
        x, A = self.x(nu), 1 + 2 * (1 + self.e) * self.G(nu)
        B = self.a * x / (1 - x)
        slope = 2 * (1 + self.e) * (self.dG(nu) * ((self.gamma - 1) + (1 + B) / A**2)
                                    + self.a**2 * x / (A * (1 - x) ** 3))
        exponent = self.adiabatic_exponent(nu)
        return (1 + exponent + nu / exponent * slope) / 2

    def cooling_rate(self, rho):
        """B in dT/dt = -B T^(3/2): Haff's law, eq. (2)."""
        return ((self.gamma - 1) * 12 / np.sqrt(np.pi) * (1 - self.e**2)
                * self.G(self.nu(rho)) / self.sigma)

    def cooled(self, rho, T, t):
        """Temperature of a uniform gas after a time t."""
        return T / (1 + self.cooling_rate(rho) * np.sqrt(T) * t / 2) ** 2


class TorquatoSpheres(PerfectGas):
    """G = nu chi; its slope is a central difference, good to 1e-9."""
    model = "TorquatoSpheres"

    def __init__(self, e, sigma=0.1, gamma=5 / 3):
        super().__init__(gamma)
        self.e, self.grain = e, np.pi * sigma**3 / 6
        self.rho_max = enskog.TORQUATO[3][1] / self.grain

    def nu(self, rho):
        return rho * self.grain

    def rho(self, nu):
        return nu / self.grain

    def A(self, rho):
        return enskog.pressure_factor(self.nu(rho), self.e, 3)

    def rho_dA(self, rho):
        h = 1e-6 * np.minimum(rho, self.rho_max - rho)
        return rho * (self.A(rho + h) - self.A(rho - h)) / (2 * h)


# Gauss-Legendre nodes on [0, 1] for the integrals along an isentrope; UP_TO[j] weighs values at the nodes for the integral up to node j, of the
# polynomial through them.
NODES, WEIGHTS = legendre.leggauss(12)
UP_TO = legendre.legval(NODES, legendre.legint(np.eye(12), lbnd=-1)).T / 2 @ ((np.arange(12) + 0.5) * WEIGHTS[:, None] * legendre.legvander(NODES, 11)).T
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2


def isentrope(eos, rho0, T0, rho, panels=16):
    """T(rho) on the isentrope through (rho0, T0), and the integral of c/rho from rho0 to rho; rho is an array.

    d ln T = (gamma - 1) A d ln rho, both integrals are taken in ln rho over `panels` Gauss panels.
    """
    step = np.log(np.asarray(rho, float) / rho0)[..., None, None] / panels
    nodes = rho0 * np.exp(step * (np.arange(panels)[:, None] + NODES))
    slope = (eos.gamma - 1) * eos.A(nodes)
    rise = np.cumsum(slope @ WEIGHTS, axis=-1)[..., None]
    T = T0 * np.exp(step * (rise - (slope @ WEIGHTS)[..., None] + slope @ UP_TO.T))
    return T0 * np.exp(step * rise[..., -1:, :])[..., 0, 0], (step[..., 0] * (eos.c(nodes, T) @ WEIGHTS)).sum(axis=-1)


def of_case(case):
    """The equation of state that a case names in constant/granularProperties (plain numbers, as in the cases shipped)."""
    with open(os.path.join(case.path, "constant", "granularProperties")) as f:
        text = re.sub(r"//[^\n]*", "", f.read())

    def value(key, standard=None):
        found = re.search(rf"\b{key}\s+([^;\s]+)\s*;", text)
        return float(found.group(1)) if found else standard

    if re.search(r"equationOfState\s+perfectGas", text):
        return PerfectGas(value("gamma", 5 / 3))
    return GoldshteinShapiro(value("restitution"), value("diameter"), value("alphaMax", 0.65), value("gamma", 5 / 3))
