# SPDX-License-Identifier: GPL-3.0-or-later
"""The same problems on triangles and out of a ball, and air that meets a cylinder, for denseShocks."""
import os
import shutil
import subprocess
import tempfile

import numpy as np

import haff
from haff.paths import program
from studies.denseTubes import DEFAULTS, OFF, ON, finish
from studies.exact.eos import GoldshteinShapiro, PerfectGas
from studies.exact.obliqueShock import ObliqueShock
from studies.made import boxes, triangles
from studies.measured import shocks


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


class Body:
    """A cylinder of radius 1 in a stream of air (gamma 1.4, rho 1, c 1) of which the first state has noise of 1e-3: both halves, the mesh
    of the lower one the image of the upper, 2 n sides along a quarter of the cylinder where it is of quads, 1.6 n where of triangles."""

    GEO = """n = %d;
Point(1) = {0, 0, 0, 1/n}; Point(2) = {-1, 0, 0, 1/n}; Point(3) = {0, 1, 0, 1/n}; Point(4) = {0, -1, 0, 1/n};
Point(5) = {-2, 0, 0, 2/n}; Point(6) = {0, 3, 0, 2/n}; Point(7) = {0, -3, 0, 2/n};
Line(1) = {5, 2}; Circle(2) = {2, 1, 3}; Line(3) = {3, 6}; Ellipse(4) = {6, 1, 6, 5}; Circle(5) = {2, 1, 4}; Line(6) = {4, 7}; Ellipse(7) = {7, 1, 7, 5};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Curve Loop(2) = {1, 5:7}; Plane Surface(2) = {2};
Periodic Curve {5:7} = {2:4} Affine {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
Periodic Surface {2} = {1} Affine {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
%s Mesh.Algorithm = 6; Physical Curve("inlet") = {4, 7}; Physical Curve("outlet") = {3, 6}; Physical Curve("wall") = {2, 5};
Physical Surface("gas") = {1, 2};
"""
    QUADS = "Transfinite Curve {1:7} = 2*n + 1; Transfinite Surface {1, 2}; Recombine Surface {1, 2};"

    def __init__(self, n, quads, folder):
        self.name, self.case = "quads" if quads else "triangles", os.path.join(folder, "quads" if quads else "triangles")
        boxes.write_dictionary(self.case, "system", "meshDict", "patches { }\n")
        geo, msh = os.path.join(self.case, "mesh.geo"), os.path.join(self.case, "mesh.msh")
        with open(geo, "w") as f:
            f.write(self.GEO % (n, self.QUADS if quads else ""))
        subprocess.run(["gmsh", "-2", "-v", "2", geo, "-o", msh], check=True, capture_output=True)
        subprocess.run([program("gmshToCase"), msh, "-case", self.case, "-binary"], check=True, capture_output=True)
        os.remove(msh)
        self.mesh = haff.Case(self.case).mesh
        self.x = haff.Case(self.case).centres[:, :2]
        away = lambda at: np.linalg.norm(self.x - at, axis=1)
        self.image = np.array([away(at).argmin() for at in self.x * (1, -1)])

    def run(self, mach, schemes, end=40):
        """Distance of the shock from the nose when the stream has gone `end` radii, and the largest difference of the density to its
        image over the jump."""
        shock, random = ObliqueShock(PerfectGas(1.4), 1.0, 1 / 1.4, mach), np.random.default_rng(24)
        noise = lambda: 1 + 1e-3 * random.uniform(-1, 1, len(self.x))
        stream = {"rho": noise(), "U": mach * np.outer(noise(), (1, 0, 0)), "p": noise() / 1.4}
        kinds = {name: kind for name, (kind, _, _) in self.mesh.patches.items()}
        with tempfile.TemporaryDirectory() as folder:
            case = os.path.join(folder, "case")
            shutil.copytree(self.case, case)
            boxes.write_case(case, kinds, *stream.values(), end / mach, **{**DEFAULTS, "eos": "perfectGas", "gamma": 1.4, "cooling": "none"})
            for name, value in (("rho", "1"), ("U", f"({mach!r} 0 0)"), ("p", repr(1 / 1.4))):
                patches = {"inlet": f"fixedValue; value uniform {value}", "wall": "slip" if name == "U" else "zeroGradient", "outlet": "zeroGradient"}
                boxes.write_field(case, name, stream[name], "\n".join(f"{k} {patches.get(k, kind)}" for k, kind in kinds.items()), binary=True)
            rho = finish(case, len(self.x), schemes)[0]
            jump, flow = float(shock.behind(np.pi / 2).rho) - 1, shocks.Samples(haff.Case(case), ("rho",))
            at = shocks.crossing(flow, (-2, 0), (-1, 0), 1e-2, 1 + jump / 2)
        return -at[0] - 1, np.abs(rho - rho[self.image]).max() / jump


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
