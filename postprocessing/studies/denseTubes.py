# SPDX-License-Identifier: GPL-3.0-or-later
"""Riemann problems of dense gas beside their exact solutions: runs of granularGas on a line, errors, and the problems of
denseShocks, which workPrecision shares."""
import functools
import os
import re
import subprocess
import tempfile

import numpy as np

import haff
from haff.paths import program
from studies.exact.eos import GoldshteinShapiro, PerfectGas
from studies.exact.riemann import Riemann, Wave
from studies.exact.roots import root
from studies.made import boxes

ON = "commonCoeffs { shocks on; expansions on; contacts on; }\n"
OFF = "commonCoeffs { shocks off; expansions off; contacts off; fronts off; }\n"
DEFAULTS = {"flux": "common", "reconstruct": "WPENO5", "stepper": "SSPRK43", "courant": 1.0, "binary": True}


def run(cells, size, rho, u, p, end, rules=True, **options):
    """Density, velocity [cells][3] and pressure at the end, and how many faces were limited."""
    number = int(np.prod(cells))
    with tempfile.TemporaryDirectory() as case:
        boxes.box_case(case, cells, size, rho, u, p, end, **{**DEFAULTS, **options})
        return finish(case, number, ON if rules else OFF)


def finish(case, number, schemes, ranks=1):
    """Runs a case with more entries of fvSchemes; what `run` returns."""
    with open(os.path.join(case, "system", "fvSchemes"), "a") as f:
        f.write(schemes)
    command = [program("granularGas"), "-case", case]
    if ranks > 1:
        command = [program("mpirun"), "-np", str(ranks), *command]
    log = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    last = haff.Case(case).times[-1]
    fields = [haff.read_field(os.path.join(case, last, name), number) for name in ("rho", "U", "p")]
    limited = re.findall(r"\(in all (\d+) faces, ", log)
    return *fields, int(limited[-1]) if limited else 0


class Tube:
    """A Riemann problem on a line of length 1; left, right: volume fraction (density of a perfect gas), u, p."""

    def __init__(self, name, left, right, x0, end=None, ways=None, eos=None, **options):
        """The end is given, or the ways that the outermost waves have to the left and to the right at most."""
        self.name, self.eos, self.x0, self.options = name, eos or GoldshteinShapiro(1.0), x0, dict(options)
        self.options.update(eos=self.eos.model, gamma=self.eos.gamma)
        density = getattr(self.eos, "rho", lambda rho: rho)
        self.left, self.right = (density(left[0]), *left[1:]), (density(right[0]), *right[1:])
        self.wanted_end, self.ways, self.known = end, ways, {}

    @functools.cached_property  # takes seconds
    def exact(self):
        return Riemann(self.eos, self.left, self.right)

    @functools.cached_property
    def end(self):
        end = self.wanted_end
        if not end:
            edges = [w.speed if w.shock else w.head for w in (self.exact.left, self.exact.right)]
            end = min(self.ways[0] / max(-edges[0], 1e-30), self.ways[1] / max(edges[1], 1e-30))
        return float("%.6g" % end)

    def averages(self, n):
        if n not in self.known:
            self.known[n] = self.exact.averages(np.linspace(0, 1, n + 1), self.x0, self.end)
        return self.known[n]

    def fields(self, n, rules=True, **options):
        left = (np.arange(n) + 0.5) / n < self.x0
        rho, u, p = (np.where(left, a, b) for a, b in zip(self.left, self.right))
        rho, u, p, limited = run((n, 1, 1), (1.0, 0.1, 0.1), rho, np.outer(u, (1, 0, 0)), p, self.end, rules,
                                 e=getattr(self.eos, "e", 1.0), **{**self.options, **options})
        return rho, u[:, 0], p, limited

    def errors(self, n, fields):
        """The mean errors of rho, u and p over their ranges."""
        return [np.abs(a - b).mean() / np.ptp(b) if np.ptp(b) else np.abs(a - b).mean() for a, b in zip(fields, self.averages(n))]

    def ahead(self, n, p):
        """Cells by which the right shock stands too far ahead, and max p beyond the contact over p* - 1."""
        middle, x = (self.exact.p + self.right[2]) / 2, (np.arange(n) + 0.5) / n
        i = np.nonzero(p > middle)[0].max()
        place = x[i] + (p[i] - middle) / (p[i] - p[i + 1]) / n
        return ((place - self.x0 - self.exact.right.speed * self.end) * n,
                p[x > self.x0 + self.exact.u * self.end].max() / self.exact.p - 1)

    def noise(self, n, rho):
        """Mean and largest |d rho| over the jump on the plateau between two shocks that part from x0 with equal speeds."""
        far = np.abs((np.arange(n) + 0.5) / n - self.x0) / (self.exact.right.speed * self.end)
        off = np.abs(rho[(far > 0.1) & (far < 0.85)] - self.exact.left.rho) / (self.exact.left.rho - self.left[0])
        return off.mean(), off.max()


def sound(nu, p, eos=GoldshteinShapiro(1.0)):
    return float(eos.c(eos.rho(nu), eos.T(eos.rho(nu), p)))


def warm(nu):
    """p of T = 1."""
    eos = GoldshteinShapiro(1.0)
    return float(eos.p(eos.rho(nu), 1.0))


@functools.cache
def drifting_burst(drift=0.81, eos=None):
    """Dense gas that expands behind dilute gas, which recedes: a stiff rarefaction and a weak shock."""
    return Tube("A", (0.4005, drift, 399.0), (0.0032, drift + 0.5613, 1.0), 0.4, 0.2585, eos=eos)


def burst(left, right, ratio, eos=None, name="", **options):
    return Tube(f"{left} \\| {right}, p {ratio:g}{name}", (left, 0.0, ratio), (right, 0.0, 1.0), 0.45, ways=(0.4, 0.5), eos=eos, **options)


BURSTS = ((0.4005, 0.00324, 399.0), (0.55, 0.003, 3138.0), (0.3, 0.01, 1992.0), (0.45, 0.02, 158.0), (0.2, 0.002, 11161.0))


def head_on(nu=0.1, mach=15.8, eos=GoldshteinShapiro(1.0)):
    p = float(eos.p(eos.rho(nu), 1.0))
    u = mach * sound(nu, p, eos)
    return Tube("B", (nu, u, p), (nu, -u, p), 0.5, ways=(0.4, 0.4), eos=eos)


@functools.cache
def contact(end, eos=None):
    return Tube("J", (0.6, 0.7, 1e4), (0.0006, 0.7, 1e4), 0.4, end, eos=eos)


def sod():
    return Tube("Sod", (1.0, 0.0, 1.0), (0.125, 0.0, 0.1), 0.5, 0.2, eos=PerfectGas(1.4))


def others():
    mach = lambda nu, m: m * sound(nu, warm(nu))
    yield Tube("I: Mach 14 \\| -5, nu 0.3 \\| 0.5", (0.3, mach(0.3, 14), warm(0.3)), (0.5, mach(0.5, -5), warm(0.5)), 0.5, ways=(0.32, 0.32))
    yield Tube("E: nu 0.01, p 1e5", (0.01, 0.0, 1e5), (0.01, 0.0, 1.0), 0.45, ways=(0.4, 0.5))
    yield Tube("dense tube 0.45 \\| 0.2", (0.45, 0.0, warm(0.45) / warm(0.2)), (0.2, 0.0, 1.0), 0.45, ways=(0.4, 0.5))
    yield Tube("parting at Mach 0.7, nu 0.1", (0.1, -0.7 * sound(0.1, 1), 1.0), (0.1, 0.7 * sound(0.1, 1), 1.0), 0.5, ways=(0.4, 0.4))
    yield Tube("parting at Mach 0.5, nu 0.4", (0.4, -0.5 * sound(0.4, 1), 1.0), (0.4, 0.5 * sound(0.4, 1), 1.0), 0.5, ways=(0.4, 0.4))
    yield Tube("Mach 5 flow, p 2", (0.1, 5 * sound(0.1, 2), 2.0), (0.02, 5 * sound(0.1, 2), 1.0), 0.2, 0.5 / (6 * sound(0.1, 2)))
    yield sod()


class Cooled(Tube):
    """The same in a gas that cools (Haff's law): known from a run of `fine` cells with the rules, from which another without
    them differs by `gap`: mean |d rho|, |d u|, |d p| over their ranges."""
    fine = 12800

    def __init__(self, tube):
        self.__dict__.update({**tube.__dict__, "exact": tube.exact, "end": tube.end})
        self.eos, self.options, self.known = type(tube.eos)(0.9), {**tube.options, "cooling": "Haff"}, {}
        runs = [np.array(self.fields(self.fine, rules)[:3]) for rules in (True, False)]
        self.finest, difference = runs[0], np.abs(runs[0] - runs[1]).mean(axis=1)
        self.gap = difference / np.ptp(runs[0], axis=1)

    def averages(self, n):
        return self.finest.reshape(3, n, -1).mean(axis=2)


class Slant:
    """A tube's jump along the diagonal of a box of n x n cells, cyclic in both directions, with the reverse jump half a period
    on. Coordinate: x + y, 1 a period, 1/sqrt(2) long. It ends before waves of one jump meet those of the other."""

    def __init__(self, tube):
        self.name, self.tube = tube.name, tube
        other = Riemann(tube.eos, tube.right, tube.left)
        speeds = [w.speed if w.shock else w.head for r in (tube.exact, other) for w in (r.left, r.right)]
        drift = tube.exact.u
        self.end = float("%.6g" % (0.23 / np.sqrt(2) / max(abs(s - drift) for s in speeds)))

    def ahead(self, n, at, p):
        """As that of a tube, in lines of cells along the diagonal."""
        right, middle = self.tube.exact.right, (self.tube.exact.p + self.tube.right[2]) / 2
        scale, (_, index) = np.sqrt(2) * self.end, np.unique(np.round(at * n).astype(int), return_inverse=True)
        means = np.bincount(index, p) / np.bincount(index)
        i = np.nonzero(means > middle)[0].max()
        place = at[index == i].mean() * n + (means[i] - middle) / (means[i] - means[i + 1])
        return place - right.speed * scale * n, 100 * (p[at > self.tube.exact.u * scale].max() / self.tube.exact.p - 1)

    def run(self, n, rules):
        """x + y - 0.25 within the waves of the first jump; rho, u along the diagonal, p; what they should be; the largest
        difference from the image in the diagonal; limited faces."""
        size = (1.0, 1.0, 0.1)
        x = boxes.centres((n, n, 1), size)
        inside = (x[:, 0] + x[:, 1]) % 1
        left = (inside < 0.25) | (inside > 0.75)
        rho, u, p = (np.where(left, a, b) for a, b in zip(self.tube.left, self.tube.right))
        rho, u, p, limited = run((n, n, 1), size, rho, np.outer(u, (1, 1, 0)) / np.sqrt(2), p, self.end, rules,
                                 types={"x": "cyclic", "y": "cyclic"}, e=getattr(self.tube.eos, "e", 1.0), **self.tube.options)
        image = max(np.abs(q - q.T).max() for q in (rho.reshape(n, n), p.reshape(n, n)))
        drift = np.sqrt(2) * self.tube.exact.u * self.end
        at = (inside - 0.25 - drift + 0.5) % 1 - 0.5 + drift
        points, counts = np.unique([(2 * i + 2 * j - 14) / 16 for i in range(8) for j in range(8)], return_counts=True)
        lines, index = np.unique(np.round(at, 9), return_inverse=True)  # points: x + y within a cell, over its width
        scale = np.sqrt(2) * self.end
        known = sum(count * np.array(self.tube.exact.sample((lines + s / n) / scale)) for s, count in zip(points, counts)) / 64
        near = np.abs(at - drift) < 0.24
        return at[near], (rho[near], u[near] @ (1, 1, 0) / np.sqrt(2), p[near]), known[:, index[near]], image, limited


class Standing:
    """A strong shock that stands across a channel of 4 x 1, cyclic across, into which gas flows with noise of 1e-3 of its
    velocity in the cells before the shock: does the shock bend (Quirk 1994)?"""

    def __init__(self, nu, mach, eos=GoldshteinShapiro(1.0)):
        """nu: density of a perfect gas."""
        self.name, rho, T = f"nu {nu}, Mach {mach}", getattr(eos, "rho", lambda rho: rho)(nu), 1.0
        self.options = {"eos": eos.model, "gamma": eos.gamma}
        u = mach * eos.c(rho, T)
        wave = Wave(eos, (rho, 0.0, eos.p(rho, T)), 1, 1.0)
        low, high = rho * (1 + 1e-9), min(eos.rho_max * (1 - 1e-12), rho * 4)
        speed = lambda r: np.sqrt((wave.shock_pressure(r) - wave.p0) * r / (rho * (r - rho)))
        behind = float(root(lambda r: np.where(np.isfinite(wave.shock_pressure(r)), speed(r), np.inf) - u, low, high))
        self.states = (rho, u, wave.p0), (behind, u * rho / behind, float(wave.shock_pressure(behind)))

    def run(self, n, crossings, rules, **scheme):
        """Largest transverse velocity over the inflow's, and the shock's place over the channel in cells, least and most."""
        rows, size = n // 4, (1.0, 0.25, 0.25 / (n // 4))
        x = boxes.centres((n, rows, 1), size)
        before = x[:, 0] < 0.5
        rho, u, p = (np.where(before, a, b) for a, b in zip(*self.states))
        noise = np.random.default_rng(24).uniform(-1, 1, len(x)) * 1e-3 * u[0] * before
        velocity = np.stack([u, noise, 0 * u], axis=1)
        end = float("%.6g" % (crossings / u[0]))
        rho, u, p, _ = run((n, rows, 1), size, rho, velocity, p, end, rules, types={"y": "cyclic"}, **self.options, **scheme)
        middle = (self.states[0][2] + self.states[1][2]) / 2
        place = (p.reshape(rows, n) > middle).argmax(axis=1) - n / 2
        return np.abs(u[:, 1]).max() / self.states[0][1], place.min(), place.max()


def randoms(number=40, seed=24):
    """Riemann problems of nu 1e-3 to 0.6, T 1e-2 to 1e2 and Mach numbers up to 2, without vacuum."""
    eos, random = GoldshteinShapiro(1.0), np.random.default_rng(seed)
    while number:
        nu = np.exp(random.uniform(np.log(1e-3), np.log(0.6), 2))
        T = np.exp(random.uniform(np.log(1e-2), np.log(1e2), 2))
        u = random.uniform(-2, 2, 2) * eos.c(eos.rho(nu), T)
        p = eos.p(eos.rho(nu), T)
        try:
            tube = Tube(f"random {number}", (nu[0], u[0], p[0]), (nu[1], u[1], p[1]), 0.5, ways=(0.4, 0.4))
        except ValueError:
            continue
        if tube.exact.p > 1e-6 * max(p):
            number -= 1
            yield tube
