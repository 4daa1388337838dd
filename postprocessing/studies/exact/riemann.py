# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact solution of the Riemann problem for a gas with p = rho T A(rho), no sink: an independent reference.

    solution = Riemann(GoldshteinShapiro(1.0), (44.5, 0.698, 3.528), (50, 0, 0.571))
    rho, u, p = solution.sample((x - x0)/t)

Shocks satisfy the Rankine-Hugoniot conditions, rarefactions the Riemann invariants; both to round-off.
"""

import numpy as np

from haff import command
from studies.exact.eos import GoldshteinShapiro, isentrope
from studies.exact.roots import root


class Wave:
    """The left (sign -1) or right (+1) acoustic wave that leads from a known state to the pressure `star`."""

    def __init__(self, eos, state, sign, star):
        self.eos, self.sign = eos, sign
        self.rho0, self.u0, self.p0 = state
        self.T0 = eos.T(self.rho0, self.p0)
        self.c0 = eos.c(self.rho0, self.T0)
        self.shock = star > self.p0
        if self.shock:
            self.rho = self.shock_density(star)
            jump = np.sqrt((star - self.p0) * (1 / self.rho0 - 1 / self.rho))
            self.u = self.u0 + sign * jump
            self.speed = (self.rho * self.u - self.rho0 * self.u0) / (self.rho - self.rho0) if star > self.p0 else None
        else:
            pressure = lambda rho: eos.p(rho, isentrope(eos, self.rho0, self.T0, rho)[0]) - star
            self.rho = float(root(pressure, self.rho0 * 1e-12, self.rho0))
            T, integral = isentrope(eos, self.rho0, self.T0, self.rho)
            self.u = self.u0 + sign * float(integral)
            self.head, self.tail = self.u0 + sign * self.c0, self.u + sign * float(eos.c(self.rho, T))

    def shock_pressure(self, rho):
        """Pressure on the Hugoniot curve at density rho > rho0; infinite beyond the greatest compression."""
        eos = self.eos
        dV = 1 / self.rho0 - 1 / rho
        g = (eos.gamma - 1) * rho * eos.A(rho)  # p = g eps
        below = 1 - g * dV / 2
        eps = (self.T0 / (eos.gamma - 1) + self.p0 * dV / 2) / np.where(below > 0, below, 1)
        return np.where(below > 0, g * eps, np.inf)

    def shock_density(self, star):
        top = min(self.eos.rho_max * (1 - 1e-15), self.rho0 * 1e6)
        return float(root(lambda rho: self.shock_pressure(rho) - star, self.rho0, top))

    def fan(self, speeds):
        """(rho, u, p) inside the rarefaction where x/t = speeds."""
        eos, sign = self.eos, self.sign

        def characteristic(rho):
            T, integral = isentrope(eos, self.rho0, self.T0, rho)
            return self.u0 + sign * integral + sign * eos.c(rho, T)

        low, high = np.full(speeds.shape, self.rho), np.full(speeds.shape, self.rho0)
        rho = root(lambda r: sign * (characteristic(r) - speeds), low, high)
        T, integral = isentrope(eos, self.rho0, self.T0, rho)
        return rho, self.u0 + sign * integral, eos.p(rho, T)


class Riemann:
    """left, right: (rho, u, p). Afterwards p, u: the star state; left, right: the two waves."""

    def __init__(self, eos, left, right):
        velocity_gap = lambda p: Wave(eos, left, -1, p).u - Wave(eos, right, +1, p).u
        scale = max(left[2], right[2])
        low, high = 1e-12 * scale, scale
        if velocity_gap(low) < 0:
            raise ValueError("the two states part so fast that a vacuum opens")
        while velocity_gap(high) > 0:
            high *= 2
        self.p = float(root(lambda p: np.array(-velocity_gap(float(p))), low, high))
        self.left, self.right = Wave(eos, left, -1, self.p), Wave(eos, right, +1, self.p)
        self.u = (self.left.u + self.right.u) / 2

    def sample(self, speeds):
        """rho, u, p at x/t = speeds (array)."""
        speeds = np.asarray(speeds, float)
        out = np.empty((3, *speeds.shape))
        for wave, side in ((self.left, speeds <= self.u), (self.right, speeds > self.u)):
            inner, outer = (wave.speed, wave.speed) if wave.shock else (wave.tail, wave.head)
            ahead = side & (wave.sign * speeds >= wave.sign * outer)
            star = side & (wave.sign * speeds <= wave.sign * inner) & ~ahead
            fan = side & ~ahead & ~star
            out[:, ahead] = np.reshape((wave.rho0, wave.u0, wave.p0), (3, 1))
            out[:, star] = np.reshape((wave.rho, self.u, self.p), (3, 1))
            if fan.any():
                out[:, fan] = wave.fan(speeds[fan])
        return out

    def averages(self, edges, x0, t, points=8):
        """Cell averages of rho, u, p between edges, [3][cells]: cells with a jump are cut there."""
        jumps = [self.u] + [s for w in (self.left, self.right)
                            for s in ((w.speed,) if w.shock else (w.head, w.tail))]
        cuts = np.unique(np.concatenate((edges, np.clip(x0 + t * np.array(jumps), edges[0], edges[-1]))))
        nodes, weights = np.polynomial.legendre.leggauss(points)
        width = np.diff(cuts)
        x = (cuts[:-1] + cuts[1:])[:, None] / 2 + width[:, None] * nodes / 2
        integral = self.sample((x - x0) / t) @ (weights / 2) * width
        cell = np.clip(np.searchsorted(edges, (cuts[:-1] + cuts[1:]) / 2) - 1, 0, len(edges) - 2)
        return np.stack([np.bincount(cell, v, len(edges) - 1) for v in integral]) / np.diff(edges)


BLAST = ((44.5, 0.698, 3.528), (50.0, 0.0, 0.571))  # Serna & Marquina, section 4.2

def main():
    parser = command.parser(__doc__)
    parser.add_argument("e", type=float, nargs="?", default=1.0, help="coefficient of restitution")
    e = parser.parse_args().e
    s = Riemann(GoldshteinShapiro(e), *BLAST)
    nu = GoldshteinShapiro(e).nu
    print(f"blast wave without sink, e = {e:g}: p* = {s.p:.10g}, u* = {s.u:.10g}, "
          f"alpha* = {nu(s.left.rho):.10g} | {nu(s.right.rho):.10g}")
    for wave in (s.left, s.right):
        print(f"  shock at speed {wave.speed:.10g}" if wave.shock else f"  rarefaction {wave.head:.10g} .. {wave.tail:.10g}")


if __name__ == "__main__":
    main()
