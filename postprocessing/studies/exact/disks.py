# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference solutions for a gas of disks with viscosity and heat conduction (`transport JenkinsRichman`): a gas that
cools, the linear waves in it, and steady flow between two walls. Needs scipy.

Jenkins & Richman (1985) as in Carrillo, Poeschel & Saluena (2008), (2.11)-(2.15) with G = nu chi, Torquato's chi; grain
mass 1, T per unit mass (its energy per mass is T). Written from the formulas, not from the solver.

    rho' + div(rho u) = 0,  rho Du/Dt = -grad p + div tau + rho g,  rho DT/Dt = -p div u + tau : grad u + div(kappa grad T) - Gamma
    tau = (mu1 - mu2) div(u) I + mu2 (grad u + grad u^T)

    gas = disks.Disks(restitution=0.9)
    flow = disks.Channel(gas, height=20, alpha=0.2, low={"T": 1}, high={"T": 4})
    flow(y, "T")
"""
import functools
import os
import re

import numpy as np
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from haff.start import enskog
from studies.exact.roots import root

ROOT_PI = np.sqrt(np.pi)


class Disks:
    d, packed = 2, 0.82

    def __init__(self, restitution, diameter=1.0, threshold=0.0):
        self.e, self.sigma, self.threshold = restitution, diameter, threshold
        self.per = np.pi / 4 * diameter**2  # packing per density

    @classmethod
    def of(cls, path):
        """From a case's constant/granularProperties."""
        with open(os.path.join(path, "constant", "granularProperties")) as f:
            text = re.sub(r"//[^\n]*", "", f.read())
        value = {key: float(number) for key, number in re.findall(r"\b(\w+)\s+([-+.\deE]+)\s*;", text)}
        return cls(value["restitution"], value["diameter"], value.get("thresholdSpeed", 0.0))

    def G(self, nu):
        return nu * enskog.torquato(nu, self.d)

    def slope(self, nu):
        """d ln G / d ln nu."""
        h = 1e-5 * nu
        return (self.G(nu + h) - self.G(nu - h)) / (2 * h) * nu / self.G(nu)

    def A(self, nu):
        """p = rho T A."""
        return 1 + 2.0 ** (self.d - 2) * (1 + self.e) * self.G(nu)

    def stiffness(self, nu):
        """d(nu A)/d nu: p_rho = T times that."""
        return self.A(nu) + (self.A(nu) - 1) * self.slope(nu)

    def cross(self, rho, T):
        """Of grad rho in the heat flux."""
        return 0 * T

    def density(self, p, T):
        """rho of a pressure: nu = per p/(T A), whose sides are near to straight lines, in thin gas and near packing."""
        wanted = self.per * np.asarray(p / T, float)
        nodes, sides = self.bracket
        at = np.clip(np.searchsorted(sides, wanted), 1, len(nodes) - 1)
        return root(lambda nu: nu - wanted / self.A(nu), nodes[at - 1], nodes[at]) / self.per

    @functools.cached_property
    def bracket(self):
        """nu from 0 to packing, and nu A: the intervals in which `density` looks for a root."""
        nodes = np.linspace(0, self.packed * (1 - 1e-9), 1001)
        return nodes, np.append(0, nodes[1:] * self.A(nodes[1:]))

    def bulk(self, rho, T):
        return 2 / ROOT_PI * rho * self.sigma * np.sqrt(T) * self.G(rho * self.per)

    def shear(self, rho, T):
        G = self.G(rho * self.per)
        return ROOT_PI / 8 * rho * self.sigma * np.sqrt(T) * (1 / G + 2 + (1 + 8 / np.pi) * G)

    def heat(self, rho, T):
        G = self.G(rho * self.per)
        return ROOT_PI / 2 * rho * self.sigma * np.sqrt(T) * (1 / G + 3 + (9 / 4 + 4 / np.pi) * G)

    def cooling(self, nu):
        """B in dT/dt = -B T^(3/2): Haff's law."""
        return 4 / (self.sigma * ROOT_PI) * (1 - self.e**2) * self.G(nu)

    def sink(self, rho, T, rate=0.0):
        """Energy that impacts take per volume and time; no law here sees the shear rate."""
        return rho * self.cooling(rho * self.per) * T**1.5

    def cooled(self, nu, T, t):
        return T / (1 + 0.5 * self.cooling(nu) * np.sqrt(T) * t) ** 2


# ---- waves in a uniform gas that cools ------------------------------------------------------------------------------

class Cooling:
    """Faint waves exp(i k x) in the homogeneous cooling of packing nu from T0. With tau(t), d tau = sqrt(T/T0) dt, and in
    units of the gas, density over rho0, velocity over sqrt T, temperature over T, their equations do not depend on time."""

    def __init__(self, gas, nu, T0=1.0):
        self.gas, self.nu, self.c = gas, nu, np.sqrt(T0)
        rho = nu / gas.per
        self.beta = 0.5 * gas.cooling(nu) * self.c
        self.shear, self.bulk = gas.shear(rho, T0) / rho, gas.bulk(rho, T0) / rho
        self.heat, self.cross = 2 / gas.d * gas.heat(rho, T0) / rho, 2 / gas.d * gas.cross(rho, T0) / T0

    def tau(self, t):
        return np.log1p(self.beta * np.asarray(t)) / self.beta if self.beta else np.asarray(t)

    def across(self, k):
        """Growth rate in tau of u across the wave over sqrt T."""
        return self.beta - self.shear * np.asarray(k) ** 2

    def matrix(self, k):
        """d/dtau of (rho/rho0 - 1, u/sqrt T along the wave, T/T_h - 1)."""
        gas, nu, c, beta = self.gas, self.nu, self.c, self.beta
        A, b, stiff, d = gas.A(nu), gas.slope(nu), gas.stiffness(nu), gas.d
        return np.array([[0, -1j * k * c, 0],
                         [-1j * k * c * stiff, beta - (self.bulk + (2 - 2 / d) * self.shear) * k * k, -1j * k * c * A],
                         [-2 * beta * b - self.cross * k * k, -2 / d * 1j * k * c * A, -beta - self.heat * k * k]])

    def growth(self, k):
        """Growth rates in tau of the three waves along k: most first."""
        return np.sort(np.linalg.eigvals(self.matrix(k)).real)[::-1]

    def along(self, k, start, t):
        """The three amplitudes at t from those at 0."""
        values, vectors = np.linalg.eig(self.matrix(k))
        return (vectors * np.exp(values * self.tau(t))) @ np.linalg.solve(vectors, np.asarray(start, complex))

    def thresholds(self):
        """Wave numbers below which vortices and clusters grow."""
        across = np.sqrt(self.beta / self.shear)
        far = across
        while self.growth(far)[0] > 0:
            far *= 2
        return across, brentq(lambda k: self.growth(k)[0], far / 1e3, far)


# ---- steady flow between two walls ----------------------------------------------------------------------------------

class Channel:
    """Steady flow along x between walls at y = 0 and `height`, mean packing alpha, gravity (gx, gy). A wall is a dict: T
    of an isothermal one, or `restitution` of one that takes q_w = (1 - e_w^2) p sqrt(T/(2 pi)), else adiabatic; u, the
    velocity, of one that holds the gas, or drags it if it has a `specularity` phi, else it slips. Across: p' = rho gy,
    (mu2 u')' = -rho gx, (kappa T' + mu rho')' = Gamma - mu2 u'^2; p' = p_rho rho' + p_T T' has the rho' of a gas whose heat
    flux follows grad rho (garzoDufty.Grains).

    The wall of Johnson & Jackson (1987), with phi, drags with tau_w = phi p/sqrt(2 pi T) (u - u_w): p/(m sqrt(2 pi T))
    grains hit it per area and time, and give it the part phi of their momentum along it. What it drags away beyond its
    own work, tau_w (u - u_w), heats the gas there, so that with n into the gas  kappa dT/dn = q_w - tau_w (u - u_w)."""

    NAMES = ("p", "T", "flux", "u", "tau", "mass")  # flux = kappa T' + mu rho', tau = mu2 u', mass below y

    def __init__(self, gas, height, alpha, low, high, gravity=(0.0, 0.0), tolerance=1e-9, guess=None):
        self.gas, self.height = gas, height
        self.gravity = gravity
        mass = alpha / gas.per * height
        if "u" not in low and "u" not in high:
            low = {**low, "u": 0}  # of the flow nothing else says how fast it is
        self.ends = [(low, 1.0), (high, -1.0)]  # and the direction inwards
        known = [w["T"] for w, _ in self.ends if "T" in w] or [1.0]
        y = np.linspace(0, height, 101)
        if guess is None:
            T, rho = np.full_like(y, np.mean(known)), alpha / gas.per
            u = np.interp(y, [0, height], [low.get("u", 0), high.get("u", 0)])
            if gravity[0]:
                u = u + 0.1 * y * (height - y) * rho * gravity[0] / gas.shear(rho, T[0])
            p = rho * T[0] * gas.A(alpha) + rho * gravity[1] * (y - height / 2)
            values = np.array([p, T, 0 * y, u, 0 * y, y / height * mass])
        else:
            values = guess.solution.sol(y * guess.height / height)
            values[5] *= mass / values[5, -1]

        def walls(a, b):
            return np.array([a[5], b[5] / mass - 1] + [r for at, (wall, inwards) in zip((a, b), self.ends) for r in self.wall(at, wall, inwards)])

        self.solution = solve_bvp(self.slopes, walls, y, values, tol=tolerance, max_nodes=200000)
        if not self.solution.success:
            raise ArithmeticError(f"no steady flow found: {self.solution.message}")

    def slopes(self, y, q):
        p, T, flux, _, tau, _ = q
        T = np.maximum(T, 1e-8)
        rho = self.gas.density(p, T)
        shear, cross = tau / self.gas.shear(rho, T), self.gas.cross(rho, T)
        p_rho = T * self.gas.stiffness(rho * self.gas.per)
        slope = (flux - cross * rho * self.gravity[1] / p_rho) / (self.gas.heat(rho, T) - cross * p / (T * p_rho))
        return np.array([rho * self.gravity[1], slope, self.gas.sink(rho, T, shear) - tau * shear, shear,
                         -rho * self.gravity[0], rho])

    @staticmethod
    def wall(at, wall, inwards):
        """What must be zero there, of heat and of momentum."""
        p, T, flux, u, tau, _ = at
        warm = max(T, 1e-8)
        slip = u - wall["u"] if "u" in wall else 0
        drag = wall.get("specularity", 0) * p / np.sqrt(2 * np.pi * warm) * slip
        if "T" in wall:
            heat = T - wall["T"]
        else:
            heat = inwards * flux - (1 - wall.get("restitution", 1) ** 2) * p * np.sqrt(warm / (2 * np.pi)) + drag * slip
        return heat, (slip if "u" in wall and "specularity" not in wall else inwards * tau - drag)

    def __call__(self, y, name):
        p, T = self.solution.sol(y)[:2]
        if name == "rho":
            return self.gas.density(p, T)
        if name == "alpha":
            return self.gas.density(p, T) * self.gas.per
        return self.solution.sol(y)[self.NAMES.index(name)]


# ---- the cases ------------------------------------------------------------------------------------------------------

def numbers(path, file, pattern):
    """The numbers of the first match in a file of the case; None: there is none."""
    with open(os.path.join(path, file)) as f:
        found = re.search(pattern, f.read())
    return found and [float(number) for number in found.groups()]


def heated_walls(path, gas=None, gravity=0.0):
    absorbed = numbers(path, "0.orig/T", r"right\s+\{ type granularWall; restitution (\S+);")
    far = {"restitution": absorbed[0]} if absorbed else {"T": 4}
    return Channel(gas or Disks.of(path), 20, 0.2, {"T": 1}, far, (0, gravity))


def poiseuille(path):
    wall = {"T": 1, "u": 0}
    return Channel(Disks.of(path), 20, 0.2, wall, wall, (*numbers(path, "constant/g", r"value\s+\((\S+) 0 0\)"), 0))


def couette(path):
    u = numbers(path, "0.orig/U", r"lid\s+\{ type translatingWallVelocity; U \((\S+) 0 0\)")[0]
    return Channel(Disks.of(path), 20, 0.2, {"T": 1, "u": -u}, {"T": 1, "u": u})


def frictional(path, gas=None):
    """Walls of Johnson & Jackson that move against each other."""
    lids = []
    for patch in ("floor", "lid"):
        phi, e, u = numbers(path, "0.orig/U", patch + r"\s+\{ type JohnsonJacksonSlip; specularityCoefficient (\S+); "
                            r"restitutionCoefficient (\S+); value uniform \((\S+) 0 0\)")
        lids.append({"specularity": phi, "restitution": e, "u": u})
    return Channel(gas or Disks.of(path), 20, 0.2, *lids)


def error(case, flow, name, component=None, axis=0):
    """Mean difference of a field at the last time over the flow's largest value."""
    found = case.field(name, case.times[-1])
    wanted = flow(case.centres[:, axis], "u" if name == "U" else name)
    return np.abs((found if component is None else found[:, component]) - wanted).mean() / np.abs(wanted).max()
