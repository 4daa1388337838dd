# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures of inelastic disks of two kinds that cool: after a few impacts both cool at one rate, at different temperatures (Garzo & Dufty,
Phys. Rev. E 60 (1999) 5706), here with Maxwellians. Written from the formulas, not from the solver.

    mixture = Mixture(diameter=(2, 1), mass=(8, 1), fraction=(0.5, 0.5), restitution=[[0.9, 0.9], [0.9, 0.9]], alpha=0.1)
    mixture.variances(), mixture.temperatures()     # <u^2> and m <u^2> of the first kind over those of the second
"""
import numpy as np


class Mixture:
    """Numbers n per area of disks, and contact values chi of their pair correlations: Jenkins & Mancini, J. Appl. Mech. 54 (1987) 27."""

    def __init__(self, diameter, mass, fraction, restitution, alpha):
        self.d, self.m, self.e, x = map(np.array, (diameter, mass, restitution, fraction))
        self.n = alpha / (np.pi / 4 * np.sum(x * self.d**2)) * x
        both = self.d[:, None] + self.d
        self.chi = 1 / (1 - alpha) + 9 / 8 * np.pi / 4 * np.sum(self.n * self.d) * self.d[:, None] * self.d / both / (1 - alpha) ** 2

    def cooling(self, s):
        """The rate at which s, the variance of a velocity component of each kind, falls, over s, but for a common factor."""
        rate = self.n * self.chi * (self.d[:, None] + self.d) / 2 * (1 + self.e)
        part = self.m / (self.m[:, None] + self.m)  # m_j/(m_i + m_j)
        return np.sum(rate * part * np.sqrt(s[:, None] + s) * (1 - part / 2 * (1 + self.e) * (1 + s / s[:, None])), axis=1)

    def variances(self):
        """The ratio at which both kinds cool alike, by bisection."""
        low, high = 1e-3, 1e3
        for _ in range(100):
            middle = np.sqrt(low * high)
            first, second = self.cooling(np.array([middle, 1.0]))
            low, high = (low, middle) if first > second else (middle, high)
        return middle

    def temperatures(self):
        return self.variances() * self.m[0] / self.m[1]
