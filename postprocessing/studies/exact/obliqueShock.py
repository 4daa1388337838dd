# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact oblique and normal shocks and stagnation states of a gas with p = rho T A(rho), no sink: steady flow past wedges.

    shock = ObliqueShock(GoldshteinShapiro(1.0), rho=191.0, p=300.0, mach=3.5)
    beta = shock.angle(np.radians(15))               # weak branch; strong=True: the other
    behind = shock.behind(beta)                      # rho, p, T, speed, mach, normal, tangential; arrays where beta is
    theta, beta = shock.detachment()                 # greatest deflection and the angle of its shock
    shock.behind(np.pi/2)                            # normal shock
    stagnation(gas, rho, T, speed)                   # rho, p, T where the gas is brought to rest on its isentrope

Angles in radians, beta from the stream. The normal velocity ahead follows from the density behind through the Hugoniot
curve; both that relation and the deflection on either branch are monotone and are inverted to round-off.

    haff obliqueShock MACH DEFLECTION [NU [e]]         prints a wedge's flow (degrees; NU = 0: perfect gas), upstream rho c^2 = 1
"""
from types import SimpleNamespace

import numpy as np

from haff import command
from studies.exact.eos import GoldshteinShapiro, PerfectGas, isentrope
from studies.exact.roots import root


class ObliqueShock:
    """A uniform stream of density rho, pressure p and Mach number mach > 1."""

    def __init__(self, eos, rho, p, mach):
        if not mach > 1:
            raise ValueError(f"no shock stands in a stream of Mach number {mach:g}: it must exceed 1")
        self.eos, self.rho, self.p, self.mach = eos, rho, p, mach
        self.T = eos.T(rho, p)
        self.c = eos.c(rho, self.T)
        self.speed = mach * self.c
        self.mach_angle = np.arcsin(1 / mach)

    def flux_squared(self, rho):
        """(rho1 un1)^2 = (p2 - p1)/(1/rho1 - 1/rho2) of the shock with density rho behind; infinite beyond the greatest."""
        eos, dV = self.eos, 1 / self.rho - 1 / rho
        g = (eos.gamma - 1) * rho * eos.A(rho)  # p = g eps
        below = 1 - g * dV / 2
        eps = (self.T / (eos.gamma - 1) + self.p * dV / 2) / np.where(below > 0, below, 1)
        weak = dV * self.rho < 1e-14  # a Mach wave
        flux2 = np.where(weak, (self.rho * self.c) ** 2, (g * eps - self.p) / np.where(weak, 1, dV))
        return np.where(below > 0, flux2, np.inf)

    def behind(self, beta):
        """The state behind a shock at the angle beta (Mach angle .. pi/2)."""
        normal, along = self.speed * np.sin(beta), self.speed * np.cos(beta)
        top = min(self.eos.rho_max * (1 - 1e-15), self.rho * 1e6)
        rho = root(lambda r: self.flux_squared(r) - (self.rho * normal) ** 2,
                     np.full(np.shape(beta), self.rho), np.full(np.shape(beta), top))
        p = self.p + self.rho * normal**2 * (1 - self.rho / rho)
        T, normal = self.eos.T(rho, p), normal * self.rho / rho
        speed = np.hypot(normal, along)
        return SimpleNamespace(rho=rho, p=p, T=T, normal=normal, tangential=along, speed=speed,
                               mach=speed / self.eos.c(rho, T))

    def deflection(self, beta):
        state = self.behind(beta)
        return np.asarray(beta) - np.arctan2(state.normal, state.tangential)

    def detachment(self):
        """Greatest deflection and its shock angle (good to about 1e-8: a maximum is flat)."""
        low, high = self.mach_angle, np.pi / 2
        for _ in range(12):
            beta = np.linspace(low, high, 41)
            best = int(np.argmax(self.deflection(beta)))
            low, high = beta[max(best - 1, 0)], beta[min(best + 1, 40)]
        beta = (low + high) / 2
        return float(self.deflection(beta)), beta

    def angle(self, theta, strong=False):
        """Angle of the shock that turns the stream by theta; ValueError where none is attached."""
        greatest, top = self.detachment()
        if np.any(np.asarray(theta) > greatest) or np.any(np.asarray(theta) < 0):
            raise ValueError(f"a stream of Mach number {self.mach:g} cannot be turned by {np.degrees(np.max(theta)):g} degrees: "
                             f"its shock detaches at {np.degrees(greatest):.4g}")
        ones = np.ones(np.shape(theta))
        if strong:
            return root(lambda b: theta - self.deflection(b), top * ones, np.pi / 2 * ones)
        return root(lambda b: self.deflection(b) - theta, self.mach_angle * ones, top * ones)


def enthalpy(eos, rho, T):
    return T * (1 / (eos.gamma - 1) + eos.A(rho))


def stagnation(eos, rho, T, speed):
    """rho, p, T of a gas (rho, T, speed) brought to rest on its isentrope."""
    total = enthalpy(eos, rho, T) + speed**2 / 2

    def excess(density):
        return enthalpy(eos, density, isentrope(eos, rho, T, density)[0]) - total

    top = min(eos.rho_max * (1 - 1e-12), rho * 1e6)
    density = float(root(excess, rho, top))
    temperature = float(isentrope(eos, rho, T, density)[0])
    return density, eos.p(density, temperature), temperature


def main():
    parser = command.parser(__doc__)
    for name, value in (("mach", None), ("degrees", None), ("nu", 0.0), ("e", 1.0)):
        parser.add_argument(name, type=float, **({} if value is None else {"nargs": "?", "default": value}))
    o = parser.parse_args()
    show(o.mach, o.degrees, o.nu, o.e)


def show(mach, degrees, nu, e):
    gas = GoldshteinShapiro(e) if nu else PerfectGas()
    rho = gas.rho(nu) if nu else 1.0
    p = gas.p(rho, 1 / (rho * gas.c(rho, 1.0) ** 2))
    shock = ObliqueShock(gas, rho, p, mach)
    theta, beta = (float(np.degrees(a)) for a in shock.detachment())
    print(f"Mach {mach:g}, volume fraction {nu:g}: detaches at {theta:.6g} (shock {beta:.6g})")
    branches = [("weak", float(shock.angle(np.radians(degrees)))), ("strong", float(shock.angle(np.radians(degrees), strong=True))),
                ("normal", np.pi / 2)]
    for name, beta in branches:
        s = shock.behind(beta)
        print(f"  {name:6} shock at {np.degrees(beta):.10g}: rho ratio {s.rho / rho:.10g}, p ratio {s.p / p:.10g}, "
              f"T ratio {s.T / shock.T:.10g}, Mach {s.mach:.10g}")
    s = shock.behind(np.pi / 2)
    r, q, T = stagnation(gas, s.rho, s.T, s.speed)
    print(f"  nose of a blunt body: rho ratio {r / rho:.10g}, p ratio {q / p:.10g}, T ratio {T / shock.T:.10g}")


if __name__ == "__main__":
    main()
