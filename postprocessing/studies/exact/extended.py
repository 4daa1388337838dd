# SPDX-License-Identifier: GPL-3.0-or-later
"""Extended kinetic theory of sheared spheres, with and without friction, as in `equationOfState VescoviSpheres`, `cooling BerziVescovi`,
`transport JenkinsBerzi` (docs/physics.md 2.6, 3.7 and 4.9); written from the papers' f1 .. f4, not from the solver. Grain mass 1.

    gas = extended.Grains(restitution=0.7, friction=0.5)
    gas.sink(rho, T, rate)                              # per volume and time, at a shear rate
    extended.steady(gas, 0.55)                          # homogeneous shear of a packing

Grains take the place of those of disks.Disks, whose flows between walls they share.
"""
import os

import numpy as np
from scipy.optimize import brentq

from haff import paths
from haff.start import enskog
from studies.exact import disks

PACKED = ((0, 0.1, 0.3, 0.5, 1), (0.636, 0.613, 0.587, 0.581, 0.573))  # Chialvo, Sun & Sundaresan (2012)


class Grains(disks.Disks):
    d = 3

    def __init__(self, restitution, friction=0.0, diameter=1.0, correlated=True):
        self.e, self.sigma, self.correlated = restitution, diameter, correlated
        self.lost = restitution - 1.5 * friction * np.exp(-3 * friction)  # the restitution that impacts have
        self.per = enskog.volume(3, diameter)  # packing per density
        self.packed = float(np.interp(friction, *PACKED))

    def G(self, nu):
        f = 1 - (np.maximum(nu - 0.4, 0) / (self.packed - 0.4))**2
        return nu * (f * (2 - nu) / (2 * (1 - nu)**3) + (1 - f) * 2 / (self.packed - nu))

    def J(self, nu):
        e, G = self.e, self.G(nu)
        return (1 + e) / 2 + np.pi / 32 * (5 + 2 * (1 + e) * (3 * e - 1) * G) * (5 + 4 * (1 + e) * G) / ((24 - 6 * (1 - e)**2 - 5 * (1 - e * e)) * G * G)

    def M(self, nu):
        e, G = self.e, self.G(nu)
        return (1 + e) / 2 + np.pi / (16 * (1 + e) * G * G) * (5 + 3 * G * (2 * e - 1) * (1 + e)**2) * (5 + 6 * G * (1 + e)) / (16 - 7 * (1 - e))

    def shear(self, rho, T):
        nu = rho * self.per
        return 8 / (5 * np.sqrt(np.pi)) * self.J(nu) * self.G(nu) * rho * self.sigma * np.sqrt(T)

    def heat(self, rho, T):
        nu = rho * self.per
        return 4 / np.sqrt(np.pi) * self.M(nu) * self.G(nu) * rho * self.sigma * np.sqrt(T)

    def cooling(self, nu):
        """B in dT/dt = -B T^(3/2) without shear."""
        return 8 / (self.sigma * np.sqrt(np.pi)) * (1 - self.lost**2) * self.G(nu)

    def steady_length(self, nu):
        """L over the diameter in homogeneous shear."""
        return 1 + 26 / 15 * (1 - self.lost) * np.maximum((nu - 0.49) / (0.64 - nu), 0)

    def length(self, nu, T, rate):
        """L over the diameter: Berzi & Vescovi (2015). 1 where impacts are not correlated, as by Haff's law."""
        if not self.correlated:
            return np.ones_like(np.asarray(T, float))
        f0 = np.sqrt(2 * self.J(nu) / (15 * (1 - self.lost**2)) * self.steady_length(nu)**3)
        return np.maximum(1, f0 * np.abs(rate) * self.sigma / np.sqrt(T))

    def sink(self, rho, T, rate=0.0):
        nu = rho * self.per
        return 1.5 * rho * self.cooling(nu) * T**1.5 / self.length(nu, T, rate)


def steady(gas, nu, rate=1.0):
    """(T, p, shear stress over p) of homogeneous shear, where the work of the stress is the sink."""
    rho = nu / gas.per
    T = gas.steady_length(nu) * gas.shear(rho, 1.0) * rate**2 / (1.5 * rho * gas.cooling(nu))
    p = rho * T * gas.A(nu)
    return T, p, gas.shear(rho, T) * rate / p


def couette(path):
    """The steady flow of cases/couetteSpheres, from nearly elastic grains on to its own."""
    with open(os.path.join(path, "constant", "granularProperties"), encoding="utf-8") as f:
        correlated = "BerziVescovi" in f.read()
    flow = None
    for e in (0.97, 0.9, 0.8, 0.7):
        flow = disks.Channel(Grains(e, correlated=correlated), 18, 0.45, {"T": 0.004, "u": 0.17}, {"T": 0.005, "u": 0.86}, guess=flow, tolerance=1e-6)
    return flow


def grains(field):
    """(y over the height, values) of the grains beside cases/couetteSpheres: alpha, T or U."""
    with open(os.path.join(paths.TOP, "cases", "couetteSpheres", "grains.csv"), encoding="utf-8") as f:
        rows = [line.strip().split(",") for line in f if line.startswith(field + ",")]
    return np.array([row[1:] for row in rows], float).T


class Incline:
    """A thick layer that flows down a slope of an angle in degrees, by the local balance: s/p = tan(angle) in each depth, so that packing
    and inertial number do not change with it. Units: diameter and density of a grain, gravity. T over p is `heat`, u at the surface of a
    layer of the height h is `surface` h^(3/2). ValueError: no packing has that s/p."""

    def __init__(self, gas, angle):
        slope, cosine = np.tan(np.radians(angle)), np.cos(np.radians(angle))
        self.packing = brentq(lambda nu: steady(gas, nu)[2] - slope, 0.4, gas.packed - 1e-9)
        T, p, _ = steady(gas, self.packing)
        p *= gas.per
        self.inertial, self.heat = p**-0.5, T / p
        self.surface = 2 / 3 * self.inertial * np.sqrt(self.packing * cosine)


def yield_angle(gas):
    """The least angle of an incline on which a thick layer flows."""
    return float(np.degrees(np.arctan(steady(gas, gas.packed - 1e-9)[2])))
