# SPDX-License-Identifier: GPL-3.0-or-later
"""Enskog theory of inelastic hard disks (d = 2) and spheres (d = 3): contact values, pressure, rate of cooling.

Garzo & Dufty, Phys. Rev. E 59 (1999) 5895, for any d as in Garzo & Santos, Physica A 276 (2000) 262; without gradients.
T is per unit mass (the variance of a component of velocity), phi the packing fraction, e the restitution, sigma the
diameter, n the number per unit of volume; written from the formulas, not from the solver.

    p = n m T (1 + 2^(d-2) (1 + e) phi chi),    dT/dt = -zeta T
"""
from math import gamma, pi

import numpy as np

TORQUATO = {2: (0.69, 0.82), 3: (0.49, 0.64)}  # freezing, random close packing


def volume(d, sigma):
    """Of a grain; phi = n * volume."""
    return pi * sigma**d / (4 if d == 2 else 6)


def fluid(phi, d):
    """Contact value of Torquato's fluid branch and its first two derivatives."""
    q = 1 - phi
    if d == 2:
        a = 0.436
        return (1 - a * phi) / q**2, (-a * q + 2 * (1 - a * phi)) / q**3, (-4 * a * q + 6 * (1 - a * phi)) / q**4
    return (1 - phi / 2) / q**3, (2.5 - phi) / q**4, (9 - 3 * phi) / q**5


def torquato(phi, d, delta=0.01):
    """Torquato, Phys. Rev. E 51 (1995) 3170: the fluid up to freezing, then a pole at random close packing. The two are
    joined within delta by a polynomial with continuous second derivatives; delta = 0: with a kink, as published."""
    phi = np.asarray(phi, float)
    freezing, close = TORQUATO[d]
    top = fluid(freezing, d)[0] * (close - freezing)

    def dense(x):
        return top / (close - x), top / (close - x) ** 2, 2 * top / (close - x) ** 3

    with np.errstate(divide="ignore"):
        chi = np.where(phi < freezing, fluid(phi, d)[0], dense(phi)[0])
    if delta == 0:
        return chi
    h = 2 * delta
    low, high = fluid(freezing - delta, d), dense(freezing + delta)
    c = [low[0], h * low[1], h**2 * low[2] / 2]
    value, slope, bend = high[0] - sum(c), h * high[1] - c[1] - 2 * c[2], h**2 * high[2] - 2 * c[2]
    c += [10 * value - 4 * slope + bend / 2, -15 * value + 7 * slope - bend, 6 * value - 3 * slope + bend / 2]
    return np.where(np.abs(phi - freezing) < delta, np.polyval(c[::-1], (phi - freezing + delta) / h), chi)


def carnahan_starling(phi, d=3):
    """Spheres: Carnahan & Starling, J. Chem. Phys. 51 (1969) 635. Disks: Henderson, Mol. Phys. 30 (1975) 971."""
    return (1 - 7 * phi / 16) / (1 - phi) ** 2 if d == 2 else (1 - phi / 2) / (1 - phi) ** 3


def luding(phi, d=2):
    """Disks below freezing: Luding, Phys. Rev. E 63 (2001) 042201; to about 0.1 % of simulations up to phi = 0.65."""
    if d != 2:
        raise ValueError("luding is a contact value of disks")
    return carnahan_starling(phi, 2) - phi**3 / (128 * (1 - phi) ** 4)


# Powers of phi/(1 - phi) in p/(n T), fits to simulations of elastic fluids, good to 0.03 %.
# Disks below 0.69: Kolafa & Rottner, Mol. Phys. 104 (2006) 3435. Spheres below 0.53: Kolafa, Labik & Malijevsky, Phys.
# Chem. Chem. Phys. 6 (2004) 2335.
SIMULATED = {
    2: {0: 1, 1: 2, 2: 1.12801775, 3: 0.00181895291, 4: -0.0526134737, 5: 0.0504951668, 6: -0.0325433846, 7: 0.0133946531,
        8: 0.00174265604, 9: -0.00944632202, 10: 0.00851111768, 11: -0.0035963525, 12: 0.000577345106, 19: -1.06399127e-7},
    3: {0: 1, 1: 4, 2: 6, 3: 2.3647684, 4: -0.8698551, 5: 1.1062803, 6: -1.1014221, 7: 0.66605866, 8: -0.03633431,
        10: -0.20965164, 14: 0.10555569, 22: -0.0087238},
}


def simulated(phi, d):
    """Contact value of those fits."""
    x = np.asarray(phi, float) / (1 - np.asarray(phi, float))
    return sum(a * x ** (k - 1) for k, a in SIMULATED[d].items() if k) * (x / phi) / 2.0 ** (d - 1)


CHI = {"Torquato": torquato, "CarnahanStarling": carnahan_starling, "Luding": luding}


def pressure_factor(phi, e, d, chi=torquato):
    """p / (n m T)."""
    return 1 + 2.0 ** (d - 2) * (1 + e) * phi * chi(phi, d)


def a2(e, d):
    """First Sonine coefficient of the homogeneous cooling state."""
    return 16 * (1 - e) * (1 - 2 * e**2) / (9 + 24 * d - e * (41 - 8 * d) + 30 * e**2 * (1 - e))


def collision_rate(phi, T, d, sigma, chi=torquato):
    """Impacts of one grain per second, Maxwellian velocities."""
    per_area = 2 * pi ** ((d - 1) / 2) / gamma(d / 2)
    return per_area * phi / volume(d, sigma) * sigma ** (d - 1) * chi(phi, d) * np.sqrt(T)


def reduced_cooling_rate(phi, e, d, chi=torquato, sonine=True):
    """zeta over the rate n T / eta0 of the elastic dilute gas."""
    return (d + 2) / (4 * d) * (1 - e**2) * chi(phi, d) * (1 + (3 / 16 * a2(e, d) if sonine else 0))


def cooling_rate(phi, T, e, d, sigma, chi=torquato, sonine=True):
    """zeta (1/s)."""
    viscosity = (d + 2) / 8 * gamma(d / 2) * pi ** (-(d - 1) / 2) / sigma ** (d - 1)  # of unit mass at T = 1
    return phi / volume(d, sigma) * np.sqrt(T) / viscosity * reduced_cooling_rate(phi, e, d, chi, sonine)


def cooled(T, t, phi, e, d, sigma, chi=torquato, sonine=True):
    """Haff's law: T after a time t."""
    return T / (1 + cooling_rate(phi, T, e, d, sigma, chi, sonine) * t / 2) ** 2


def haff_time(phi, T, e, d, sigma, chi=torquato, sonine=True):
    """In which T falls to a quarter."""
    return 2 / cooling_rate(phi, T, e, d, sigma, chi, sonine)

