# SPDX-License-Identifier: GPL-3.0-or-later
"""Dense gas and strong shocks against exact Riemann solutions: what the rules of single faces of the flux `common` change.

    haff denseShocks [-out FILE.md] [-quick] [-problem NAME]    tables on stdout, or in the file

Every problem is run by granularGas with its defaults (common, WPENO5, SSPRK43, maxCo 1) twice: with the rules, which is the
default on lattices (`on`, `commonCoeffs { shocks on; expansions on; contacts on; }`), and without. On polyhedra, maxCo is 2;
gmsh makes them.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

import haff
from haff import command
from haff.exact.eos import GoldshteinShapiro, PerfectGas
from haff.exact.riemann import Riemann
from haff.paths import program
from haff.runs import boxes, triangles

ON = "commonCoeffs { shocks on; expansions on; contacts on; }\n"
OFF = "commonCoeffs { shocks off; expansions off; contacts off; }\n"
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
    limited = re.findall(r"\(in all (\d+), ", log)
    return *fields, int(limited[-1]) if limited else 0


class Tube:
    """A Riemann problem on a line of length 1; left, right: volume fraction (density of a perfect gas), u, p."""

    def __init__(self, name, left, right, x0, end=None, ways=None, eos=None, **options):
        """The end is given, or the ways that the outermost waves have to the left and to the right at most."""
        self.name, self.eos, self.x0, self.options = name, eos or GoldshteinShapiro(1.0), x0, dict(options)
        if isinstance(eos, PerfectGas) and not isinstance(eos, GoldshteinShapiro):
            self.options.update(eos="perfectGas", gamma=eos.gamma)
        density = getattr(self.eos, "rho", lambda rho: rho)
        self.left, self.right = (density(left[0]), *left[1:]), (density(right[0]), *right[1:])
        self.exact = Riemann(self.eos, self.left, self.right)
        edges = [w.speed if w.shock else w.head for w in (self.exact.left, self.exact.right)]
        if not end:
            end = min(ways[0] / max(-edges[0], 1e-30), ways[1] / max(edges[1], 1e-30))
        self.end, self.known = float("%.6g" % end), {}

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


def drifting_burst(drift=0.81):
    """Dense gas that expands behind dilute gas, which recedes: a stiff rarefaction and a weak shock."""
    return Tube("A", (0.4005, drift, 399.0), (0.0032, drift + 0.5613, 1.0), 0.4, 0.2585)


def burst(left, right, ratio, eos=None, name="", **options):
    return Tube(f"{left} \\| {right}, p {ratio:g}{name}", (left, 0.0, ratio), (right, 0.0, 1.0), 0.45, ways=(0.4, 0.5), eos=eos, **options)


BURSTS = ((0.4005, 0.00324, 399.0), (0.55, 0.003, 3138.0), (0.3, 0.01, 1992.0), (0.45, 0.02, 158.0), (0.2, 0.002, 11161.0))


def head_on(nu=0.1, mach=15.8, e=1.0):
    eos = GoldshteinShapiro(e)
    p = float(eos.p(eos.rho(nu), 1.0))
    u = mach * sound(nu, p, eos)
    return Tube("B", (nu, u, p), (nu, -u, p), 0.5, ways=(0.4, 0.4), eos=eos)


def contact(end):
    return Tube("J", (0.6, 0.7, 1e4), (0.0006, 0.7, 1e4), 0.4, end)


def others():
    mach = lambda nu, m: m * sound(nu, warm(nu))
    yield Tube("I: Mach 14 \\| -5, nu 0.3 \\| 0.5", (0.3, mach(0.3, 14), warm(0.3)), (0.5, mach(0.5, -5), warm(0.5)), 0.5, ways=(0.32, 0.32))
    yield Tube("E: nu 0.01, p 1e5", (0.01, 0.0, 1e5), (0.01, 0.0, 1.0), 0.45, ways=(0.4, 0.5))
    yield Tube("dense tube 0.45 \\| 0.2", (0.45, 0.0, warm(0.45) / warm(0.2)), (0.2, 0.0, 1.0), 0.45, ways=(0.4, 0.5))
    yield Tube("parting at Mach 0.7, nu 0.1", (0.1, -0.7 * sound(0.1, 1), 1.0), (0.1, 0.7 * sound(0.1, 1), 1.0), 0.5, ways=(0.4, 0.4))
    yield Tube("parting at Mach 0.5, nu 0.4", (0.4, -0.5 * sound(0.4, 1), 1.0), (0.4, 0.5 * sound(0.4, 1), 1.0), 0.5, ways=(0.4, 0.4))
    yield Tube("Mach 5 flow, p 2", (0.1, 5 * sound(0.1, 2), 2.0), (0.02, 5 * sound(0.1, 2), 1.0), 0.2, 0.5 / (6 * sound(0.1, 2)))
    yield Tube("Sod", (1.0, 0.0, 1.0), (0.125, 0.0, 0.1), 0.5, 0.2, eos=PerfectGas(1.4))


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


def per_mille(errors):
    return " ".join(f"{1e3 * e:.2f}" for e in errors)


def both(show):
    """What `show` says of the run without and with the rules."""
    return " | ".join(show(rules) for rules in (False, True))


def burst_row(tube, n):
    def show(rules):
        *fields, limited = tube.fields(n, rules)
        cells, high = tube.ahead(n, fields[2])
        return f"{cells:.2f} / {100 * high:.1f} % / {per_mille(tube.errors(n, fields)[:2])}" + (f", {limited} limited" if limited else "")

    return f"| {tube.name} | {n} | {both(show)} |"


def bursts(grids):
    yield "| burst | cells | off: shock ahead in cells / p behind it too high / L1 of rho, u in 1e-3 | on |\n|---|---|---|---|"
    tube = drifting_burst()
    for n in grids:
        yield burst_row(tube, n)
    for drift in (0.0, 0.4, 1.2):
        tube = Tube(f"A at {drift}", (0.4005, drift, 399.0), (0.0032, drift + 0.5613, 1.0), 0.52 - 0.15 * drift, 0.2)
        yield burst_row(tube, 400)
    for problem in BURSTS:
        yield burst_row(burst(*problem), 400)
    yield burst_row(burst(*BURSTS[1], eos=GoldshteinShapiro(0.9), name=", e = 0.9 in p alone"), 400)


def contacts(grids):
    yield "| contact J, cells | off: largest error of p / false u at t = 0.001, 0.002, 0.004 | on |\n|---|---|---|"
    for n in grids:
        def show(rules):
            all_of = [contact(t).fields(n, rules) for t in (0.001, 0.002, 0.004)]
            return ", ".join(f"{100 * np.abs(p / 1e4 - 1).max():.1f} % / {np.abs(u - 0.7).max():.2f}" for _, u, p, _ in all_of)

        yield f"| {n} | {both(show)} |"


def noises(grids):
    yield "| head on B, cells | off: noise, mean / largest / L1 of rho in 1e-3 | on |\n|---|---|---|"
    tube = head_on()
    for n in grids:
        def show(rules):
            *fields, _ = tube.fields(n, rules)
            return "%.1e / %.1e" % tube.noise(n, fields[0]) + f" / {1e3 * tube.errors(n, fields)[0]:.2f}"

        yield f"| {n} | {both(show)} |"


def singles(n):
    yield f"| {n} cells | off: L1 of rho, u, p in 1e-3 (density in the centre over exact) | on |\n|---|---|---|"
    for tube in others():
        def show(rules):
            *fields, _ = tube.fields(n, rules)
            return per_mille(tube.errors(n, fields)) + f" ({fields[0][n // 2] / tube.averages(n)[0][n // 2]:.3f})"

        yield f"| {tube.name} | {both(show)} |"


def ratios(number, n=200):
    found, limited = [], np.zeros(2, int)
    for tube in randoms(number):
        errors = []
        for k, rules in enumerate((False, True)):
            *fields, count = tube.fields(n, rules)
            limited[k] += count
            errors.append(tube.errors(n, fields))
        found.append(np.array(errors[1]) / errors[0])
    show = lambda v: " ".join(f"{x:.2f}" for x in v)
    yield (f"{number} random problems, {n} cells, L1 of rho, u, p with the rules over that without: geometric mean "
           f"{show(np.exp(np.log(found).mean(axis=0)))}; worst {show(np.max(found, axis=0))}; best {show(np.min(found, axis=0))}; "
           f"faces limited {limited[0]} without, {limited[1]} with.")


class Strip:
    """A line of n edges and 8 rows of triangles, with fixed states at its ends."""

    def __init__(self, n, folder):
        self.n, self.case = n, os.path.join(folder, f"strip{n}")
        triangles.make(self.case, 1.0, n, program("gmshToCase"), cyclic="y", rows=8)
        self.mesh = haff.Mesh(os.path.join(self.case, "constant", "polyMesh"))
        self.x = triangles.corners(self.mesh).mean(axis=1)[:, 0]
        self.volume = self.areas()
        self.slice = np.minimum((self.x * n).astype(int), n - 1)

    def areas(self):
        corner = triangles.corners(self.mesh)
        (a, b), (c, d) = (corner[:, 1] - corner[:, 0]).T, (corner[:, 2] - corner[:, 0]).T
        return np.abs(a * d - b * c) / 2

    def write(self, case, tube, **options):
        shutil.copytree(self.case, case)
        left = self.x < tube.x0
        rho, u, p = (np.where(left, a, b) for a, b in zip(tube.left, tube.right))
        kinds = {name: kind for name, (kind, _, _) in self.mesh.patches.items()}
        options = {**DEFAULTS, "courant": 2.0, "e": getattr(tube.eos, "e", 1.0), **tube.options, **options}
        boxes.write_case(case, kinds, rho, np.outer(u, (1, 0, 0)), p, tube.end, **options)
        others = "\n".join(f"{name} {kind}" for name, kind in kinds.items() if kind != "patch")
        for k, (name, values) in enumerate((("rho", rho), ("U", np.outer(u, (1, 0, 0))), ("p", p))):
            ends = ("%.17g" if name != "U" else "(%.17g 0 0)")
            patches = "\n".join(f"{side} fixedValue; value uniform {ends % state[k]}" for side, state in (("left", tube.left), ("right", tube.right)))
            boxes.write_field(case, name, values, patches + "\n" + others, binary=True)

    def fields(self, tube, rules, polynomial="CWENO3", ranks=1, **options):
        with tempfile.TemporaryDirectory() as folder:
            case = os.path.join(folder, "case")
            self.write(case, tube, **options)
            return finish(case, len(self.x), f"polyReconstruct {polynomial};\n" + (ON if rules else OFF), ranks)

    def slices(self, q):
        """Means over the n slices of the length of an edge."""
        return np.bincount(self.slice, self.volume * q, self.n) / np.bincount(self.slice, self.volume, self.n)

    def errors(self, tube, fields):
        """As those of a tube, but over the triangles."""
        known = triangles.means(self.mesh, lambda x: curve(tube)((x[:, 0] - tube.x0) / tube.end)).T
        fields = fields[0], fields[1][:, 0], fields[2]
        return [(self.volume * np.abs(a - b)).sum() / self.volume.sum() / np.ptp(b) for a, b in zip(fields, known)]

    def noise(self, tube, rho):
        """As that of a tube."""
        far = np.abs(self.x - tube.x0) / (tube.exact.right.speed * tube.end)
        inside = (far > 0.1) & (far < 0.85)
        off = np.abs(rho[inside] - tube.exact.left.rho) / (tube.exact.left.rho - tube.left[0])
        return np.average(off, weights=self.volume[inside]), off.max()


def curve(tube):
    """The exact solution by x/t, [n][3], from a table."""
    if "curve" not in tube.known:
        exact, jump = tube.exact, np.array([-1e-9, 1e-9])
        knots = [exact.u + jump] + [w.speed + jump if w.shock else np.linspace(w.head, w.tail, 100) for w in (exact.left, exact.right)]
        knots = np.sort(np.concatenate(knots))
        tube.known["curve"] = knots, exact.sample(knots)
    knots, values = tube.known["curve"]
    return lambda speeds: np.stack([np.interp(speeds, knots, q) for q in values], axis=1)


def strip_burst(strip, tube, name, polynomial):
    def show(rules):
        rho, u, p, limited = strip.fields(tube, rules, polynomial)
        cells, high = tube.ahead(strip.n, strip.slices(p))
        errors = strip.errors(tube, (rho, u, p))[:2]
        return f"{cells:.2f} / {100 * high:.1f} % / {per_mille(errors)}" + (f", {limited} limited" if limited else "")

    return f"| {name} | {polynomial} | {strip.n} | {both(show)} |"


def strip_contact(strip, polynomial):
    def show(rules):
        found = []
        for t in (0.001, 0.002, 0.004):
            _, u, p, _ = strip.fields(contact(t), rules, polynomial)
            found.append(f"{100 * np.abs(p / 1e4 - 1).max():.1f} % / {np.hypot(u[:, 0] - 0.7, u[:, 1]).max():.2f}")
        return ", ".join(found)

    return f"| J: largest error of p / false u at t = 0.001, 0.002, 0.004 | {polynomial} | {strip.n} | {both(show)} |"


def strip_noise(strip, polynomial):
    tube = head_on()

    def show(rules):
        rho, u, p, _ = strip.fields(tube, rules, polynomial)
        return "%.1e / %.1e" % strip.noise(tube, rho) + f" / {1e3 * strip.errors(tube, (rho, u, p))[0]:.2f}"

    return f"| B: noise, mean / largest / L1 of rho in 1e-3 | {polynomial} | {strip.n} | {both(show)} |"


def strip_single(strip, tube, polynomial):
    show = lambda rules: per_mille(strip.errors(tube, strip.fields(tube, rules, polynomial)[:3]))
    return f"| {tube.name}: L1 of rho, u, p in 1e-3 | {polynomial} | {strip.n} | {both(show)} |"


def polyhedra(grids):
    yield "| strip of triangles | polynomials | edges along it | off: as in the tables above, per edge in place of cell | on |\n|---|---|---|---|---|"
    with tempfile.TemporaryDirectory() as folder:
        strips = [Strip(n, folder) for n in grids]
        for polynomial in ("CWENO3", "linear"):
            for strip in strips:
                yield strip_burst(strip, drifting_burst(), "A", polynomial)
            for problem in BURSTS:
                tube = burst(*problem)
                yield strip_burst(strips[-1], tube, tube.name, polynomial)
            for strip in strips[:2]:
                yield strip_contact(strip, polynomial)
            for strip in strips:
                yield strip_noise(strip, polynomial)
        for tube in others():
            yield strip_single(strips[0], tube, "CWENO3")


class Ball:
    """Dense gas at rest that bursts out of a ball about the corner of a unit cube; u, p by radius from a fine 1D run in spherical
    coordinates (`spherical`), whose shock is 4e-4 further in than on half the cells."""

    RADIUS, END, LEFT, RIGHT = 0.35, 0.3, (0.4005, 399.0), (0.00324, 1.0)
    GEO = """Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0}; Line(1) = {1, 2}; Line(2) = {2, 3};
Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; o[] = Extrude{0, 0, 1}{Surface{1};};
Mesh.MeshSizeMax = 1/%d; Mesh.MeshSizeMin = 1/%d; Physical Surface("low") = {1, o[2], o[5]};
Physical Surface("high") = {o[0], o[3], o[4]}; Physical Volume("gas") = {o[1]};
"""

    def __init__(self, cells):
        self.eos = GoldshteinShapiro(1.0)
        self.states = [(float(self.eos.rho(nu)), 0.0, p) for nu, p in (self.LEFT, self.RIGHT)]
        self.known = spherical(self.eos, *self.states, self.RADIUS, self.END, cells)
        self.shock = self.front(self.known[0], self.known[3])

    def front(self, r, p):
        """Where p is twice that outside."""
        i = np.nonzero(p > 2 * self.RIGHT[1])[0].max()
        return r[i] + (p[i] - 2 * self.RIGHT[1]) / (p[i] - p[i + 1]) * (r[i + 1] - r[i])

    def boxes(self, case, n):
        kinds = boxes.write_mesh(case, (n, n, n), (1.0, 1.0, 1.0), binary=True)
        return kinds, boxes.centres((n, n, n), (1.0, 1.0, 1.0)), np.full(n**3, n**-3.0)

    def tetrahedra(self, case, n):
        boxes.write_dictionary(case, "system", "meshDict", "patches { }\n")
        geo, msh = os.path.join(case, "mesh.geo"), os.path.join(case, "mesh.msh")
        with open(geo, "w") as f:
            f.write(self.GEO % (n, n))
        subprocess.run(["gmsh", "-3", "-v", "2", geo, "-o", msh], check=True, capture_output=True)
        subprocess.run([program("gmshToCase"), msh, "-case", case, "-binary"], check=True, capture_output=True)
        found = haff.Case(case)
        return {name: kind for name, (kind, _, _) in found.mesh.patches.items()}, found.centres, found.volumes

    def run(self, n, polynomial, rules):
        """Shock ahead in V^(1/3), p behind it too high, mean errors of rho and radial u over their ranges; faces limited."""
        with tempfile.TemporaryDirectory() as case:
            kinds, x, V = self.tetrahedra(case, n) if polynomial else self.boxes(case, n)
            r = np.linalg.norm(x, axis=1)
            rho, _, p = (np.where(r < self.RADIUS, a, b) for a, b in zip(*self.states))
            boxes.write_case(case, kinds, rho, np.zeros((len(r), 3)), p, self.END, **{
                **DEFAULTS, "slip": ("low", "xLow", "yLow", "zLow"), "courant": 2.0 if polynomial else 1.0})
            rho, u, p, limited = finish(case, len(r), (f"polyReconstruct {polynomial};\n" if polynomial else "") + (ON if rules else OFF))
        h, known = len(r) ** (-1 / 3), [np.interp(r, self.known[0], q) for q in self.known[1:]]
        shell = np.minimum((2 * r / h).astype(int), int(2 / h))
        mean = lambda q: (np.bincount(shell, V * q) / np.maximum(np.bincount(shell, V), 1e-300))[np.bincount(shell) > 0][:-1]
        front, high = self.front(mean(r), mean(p)), lambda r, p, at: p[(r > at - 0.1)].max()
        above = high(mean(r), mean(p), front) / high(self.known[0], self.known[3], self.shock) - 1
        inside = r < 1
        errors = [np.average(np.abs(a - b)[inside], weights=V[inside]) / np.ptp(b) for a, b in ((rho, known[0]), ((u * x).sum(axis=1) / r, known[1]))]
        return (front - self.shock) / h, above, errors, limited, len(r)


def spherical(eos, left, right, radius, end, n):
    """r, rho, u, p [n] at the end on a line of n shells: HLLC of rho, u, p with slopes by minmod, two stages a step."""
    edge = np.linspace(0, 1, n + 1)
    area, volume, r = edge**2, np.diff(edge**3) / 3, 0.75 * np.diff(edge**4) / np.diff(edge**3)
    g = lambda rho: (eos.gamma - 1) * eos.A(rho)
    speed = lambda q: eos.c(q[0], eos.T(q[0], q[2]))
    rho, _, p = (np.where(r < radius, a, b) for a, b in zip(left, right))
    U = np.array([rho, 0 * rho, p / g(rho)])

    def primitives(U):
        rho, u = U[0], U[1] / U[0]
        return np.array([rho, u, (U[2] - 0.5 * rho * u * u) * g(rho)])

    def hllc(l, r):
        cl, cr = speed(l), speed(r)
        low, high = np.minimum(l[1] - cl, r[1] - cr), np.maximum(l[1] + cl, r[1] + cr)
        ml, mr = l[0] * (low - l[1]), r[0] * (high - r[1])
        middle, fluxes = (r[2] - l[2] + ml * l[1] - mr * r[1]) / (ml - mr), []
        for (rho, u, p), s, outer in ((l, low, low >= 0), (r, high, high <= 0)):
            E, star, k = p / g(rho) + 0.5 * rho * u * u, p + rho * (s - u) * (middle - u), (s - u) / (s - middle)
            energy = (k * E + (star * middle - p * u) / (s - middle) + star) * middle
            inner = np.array([rho * k * middle, rho * k * middle**2 + star, energy])
            fluxes.append(np.where(outer, np.array([rho * u, rho * u * u + p, (E + p) * u]), inner))
        return np.where(high <= 0, fluxes[1], np.where((low >= 0) | (middle >= 0), fluxes[0], fluxes[1]))

    def rates(U):
        W, mirror = primitives(U), np.array([[1], [-1], [1]])
        d = np.diff(np.concatenate([W[:, :1] * mirror, W, W[:, -1:]], axis=1), axis=1)
        a, b = d[:, :-1], d[:, 1:]
        half = np.where(a * b > 0, np.where(np.abs(a) < np.abs(b), a, b), 0) / 2
        F = hllc(np.concatenate([(W - half)[:, :1] * mirror, W + half], axis=1), np.concatenate([W - half, W[:, -1:]], axis=1))
        out = -np.diff(area * F, axis=1) / volume
        out[1] += W[2] * np.diff(area) / volume
        return out

    t = 0.0
    while t < end:
        W = primitives(U)
        dt = min(0.45 / n / (np.abs(W[1]) + speed(W)).max(), end - t)
        first = U + dt * rates(U)
        U, t = (U + first + dt * rates(first)) / 2, t + dt
    return r, *primitives(U)


def balls(sizes, cells):
    yield "| burst out of a ball | cells | off: shock ahead in V^(1/3) / p behind it too high / L1 of rho, u in 1e-3 | on |\n|---|---|---|---|"
    ball = Ball(cells)
    for n, polynomial in sizes:
        def show(rules):
            cells, high, errors, limited, show.cells = ball.run(n, polynomial, rules)
            return f"{cells:.2f} / {100 * high:.1f} % / {per_mille(errors)}" + (f", {limited} limited" if limited else "")

        row = both(show)
        yield f"| {'tetrahedra, ' + polynomial if polynomial else 'lattice'} | {show.cells} | {row} |"


def tables(quick):
    grids = (100, 200) if quick else (100, 200, 400, 800, 1600)
    yield "bursts", bursts(grids)
    yield "contacts", contacts(grids[:4])
    yield "noise", noises(grids if quick else grids[1:])
    yield "others", singles(100 if quick else 400)
    yield "random", ratios(4 if quick else 40)
    yield "polyhedra", polyhedra((50, 100) if quick else (100, 200, 400))
    sizes = ((16, ""), (8, "CWENO3")) if quick else ((32, ""), (64, ""), (12, "CWENO3"), (24, "CWENO3"), (12, "linear"), (24, "linear"))
    yield "balls", balls(sizes, 400 if quick else 6400)


def main():
    parser = command.parser(__doc__)
    parser.add_argument("-out", metavar="FILE.md", help="writes the tables there")
    parser.add_argument("-quick", action="store_true", help="coarse grids, four random problems")
    parser.add_argument("-problem", help="one table: bursts, contacts, noise, others, random, polyhedra, balls")
    options = parser.parse_args()
    out = open(options.out, "w") if options.out else sys.stdout
    for name, rows in tables(options.quick):
        if options.problem in (None, name):
            print(f"\n## {name}\n", file=out)
            for row in rows:
                print(row, file=out, flush=True)


if __name__ == "__main__":
    main()
