# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact smooth simple wave of a gas with p = rho T A(rho), no sink: the reference for orders of accuracy.

A right-going simple wave has one entropy and one left-going Riemann invariant, so each density travels at its own
constant speed u + c. A periodic profile rho(s) = rho0 (1 + amplitude sin(2 pi s/L)) thus has, at time t, the value
rho(s) at x = s + (u + c) t, and one Newton solve per point inverts that until the wave breaks.

    wave = SimpleWave(GoldshteinShapiro(1.0), nu=0.2, velocity=3.0)
    rho, u, p = wave.at(x, 0.3*wave.breaking_time)
"""
import numpy as np

from studies.exact.eos import isentrope


class SimpleWave:
    """velocity: of the gas at mean density, in units of the sound speed there. SETTINGS names three of them."""

    def __init__(self, eos, nu=0.2, amplitude=0.15, T=1.0, velocity=3.0, length=1.0):
        self.eos, self.amplitude, self.length, self.T0 = eos, amplitude, length, T
        self.rho0 = eos.rho(nu)
        self.u0 = velocity * eos.c(self.rho0, T)
        s = np.linspace(0, length, 4001)
        self.breaking_time = -1 / self.speed_slope(s).min()

    def density(self, s):
        """Initial density and its slope."""
        k = 2 * np.pi / self.length
        return self.rho0 * (1 + self.amplitude * np.sin(k * s)), self.rho0 * self.amplitude * k * np.cos(k * s)

    def state(self, rho):
        T, integral = isentrope(self.eos, self.rho0, self.T0, rho, panels=2)
        return self.u0 + integral, T

    def speed(self, s):
        rho, _ = self.density(s)
        u, T = self.state(rho)
        return u + self.eos.c(rho, T)

    def speed_slope(self, s):
        """d(u + c)/ds = (c/rho) GG drho/ds with GG the fundamental derivative of the gas."""
        rho, slope = self.density(s)
        _, T = self.state(rho)
        return self.eos.c(rho, T) / rho * self.eos.fundamental_derivative(self.eos.nu(rho)) * slope

    def foot(self, x, t):
        """Where the characteristic through (x, t) began: Newton, kept inside a shrinking bracket. Each place is looked for once."""
        shape = np.shape(x)
        x, where = np.unique(np.asarray(x, float), return_inverse=True)
        ends = self.speed(np.linspace(0, self.length, 4001))
        low, high = x - t * (ends.max() + 1e-9 * abs(ends).max()), x - t * (ends.min() - 1e-9 * abs(ends).max())
        s, slack = (low + high) / 2, 1e-12 * self.length  # round-off may lead out of the bracket at its end
        for _ in range(100):
            miss = s + self.speed(s) * t - x
            low, high = np.where(miss <= 0, s, low), np.where(miss >= 0, s, high)
            step = s - miss / (1 + self.speed_slope(s) * t)
            step = np.where((step < low - slack) | (step > high + slack), (low + high) / 2, step)
            near = np.all(abs(step - s) <= 1e-9 * self.length)  # and this step squares what was left
            s = step
            if near:
                break
        return s[where].reshape(shape)

    def at(self, x, t):
        """rho, u, p at points x and time t < breaking_time."""
        if not t < self.breaking_time:
            raise ValueError(f"the wave breaks at t = {self.breaking_time:g}, before t = {t:g}")
        rho, _ = self.density(self.foot(x, t))
        u, T = self.state(rho)
        return rho, u, self.eos.p(rho, T)


# gas velocity over sound speed at mean density
SETTINGS = {
    "supersonic": 3.0,   # u - c > 0 everywhere
    "subsonic": 0.0,     # u passes through 0
    "sonic": -1.0,       # u + c passes through 0
}
