# SPDX-License-Identifier: GPL-3.0-or-later
"""The problems of workPrecision: initial state, exact solution or fine reference, error. PROBLEMS at the end lists them.

A problem is a box of square cells (one cell thick), maybe with a corner cut out. `points` problems compare values at
the cell centres, the others cell averages; the error is the mean of |computed - known| over the cells, over `scale`.
"""
import functools
import os
import shutil
import tempfile

import numpy as np

import haff
from studies import denseTubes
from studies.exact.eos import GoldshteinShapiro, PerfectGas
from studies.exact.riemann import BLAST, Riemann
from studies.exact.simpleWave import SimpleWave
from studies.made import boxes, triangles

THICK = 0.1


class Problem:
    """grids, quick: cells along x, for the report and for --quick. foam: {maxCo: grids} of rhoCentralFoam, which knows
    elastic perfect gases only."""
    size, field, scale, foam, foam_quick = (1.0, 1.0), "rho", 1.0, {}, {}
    options = {}
    two_dimensional = general = False  # general: on triangles, by the polyhedral engine
    programs = None  # folder of gmshToCase
    answer = None, None  # cells and known values of the last grid

    def box(self, n):
        if self.two_dimensional:
            return (n, n, 1), (*self.size, THICK)
        return (n, 1, 1), (self.size[0], THICK, THICK)

    def hole(self, n):
        return None

    def kept(self, n):
        """Which cells of the box there are."""
        hole = self.hole(n)
        return np.ones(np.prod(self.box(n)[0]), bool) if hole is None else ~hole

    def centres(self, n):
        return boxes.centres(*self.box(n))[self.kept(n)]

    def make(self, case, n, **scheme):
        cells, size = self.box(n)
        rho, u, p = self.initial(self.centres(n))
        boxes.box_case(case, cells, size, rho, u, p, self.end, hole=self.hole(n), hole_patch="wall", slip=("wall",),
                       binary=True, **{**self.options, **scheme})
        return rho, u, p

    def error(self, n, values):
        if self.answer[0] != n:
            self.answer = n, self.known(n)
        return np.abs(values - self.answer[1]).mean() / self.scale


def along_x(u):
    return np.outer(u, (1.0, 0.0, 0.0))


class Vortex(Problem):
    name, title = "vortex", "isentropic vortex, perfect gas, one period"
    size, end, two_dimensional = (10.0, 10.0), 10.0, True
    grids, quick = (40, 80, 160), (20, 40)
    foam, foam_quick = {0.2: (40, 80), 0.1: (40, 80, 160), 0.05: (40, 80)}, {0.2: (20,)}
    options = {"eos": "perfectGas", "gamma": 1.4, "types": {"x": "cyclic", "y": "cyclic"}}

    def initial(self, at):
        g, beta = 1.4, 5.0
        x, y = at[:, 0] - 5, at[:, 1] - 5
        swirl = beta / (2 * np.pi) * np.exp((1 - x**2 - y**2) / 2)
        T = 1 - (g - 1) / (2 * g) * swirl**2
        return T ** (1 / (g - 1)), np.stack([1 - swirl * y, 1 + swirl * x, 0 * x], axis=1), T ** (g / (g - 1))

    def known(self, n):
        return self.initial(self.centres(n))[0]


class Wave(Problem):
    name, title = "wave", "smooth wave, dense granular gas, volume fraction 0.2, e = 1"
    grids, quick = (50, 100, 200, 400), (50, 100)
    options = {"types": {"x": "cyclic"}}

    def __init__(self):
        self.wave = SimpleWave(GoldshteinShapiro(1.0), velocity=0.0)
        self.end = float("%.12g" % (0.3 * self.wave.breaking_time))
        self.scale = self.wave.rho0

    def initial(self, at):
        rho, u, p = self.wave.at(at[:, 0], 0.0)
        return rho, along_x(u), p

    def known(self, n):
        return self.wave.at(self.centres(n)[:, 0] % 1.0, self.end)[0]


class Shear(Problem):
    """Inviscid gas of uniform rho and T in which u varies across its own direction: the wave is carried along as it is
    and T follows Haff's law, exactly; every error of T is heat that a scheme makes of the shear."""
    name, title = "shear", "cooling shear wave along the diagonal, granular gas, e = 0.9; error of T"
    two_dimensional, field = True, "T"
    grids, quick = (16, 32, 64), (16, 32)
    options = {"types": {"x": "cyclic", "y": "cyclic"}, "e": 0.9, "cooling": "Haff"}

    def __init__(self):
        self.gas = GoldshteinShapiro(0.9)
        self.rho = self.gas.rho(0.1)
        self.end = float("%.6g" % (2 / self.gas.cooling_rate(self.rho)))  # T falls to a quarter
        self.scale = 0.25

    def initial(self, at):
        ones, c = np.ones(len(at)), self.gas.c(self.rho, 1.0)
        wave = 0.5 * c * np.sin(2 * np.pi * (at[:, 0] + at[:, 1]))
        u = np.outer(ones, (0.6 * c, 0.3 * c, 0)) + np.outer(wave, (1, -1, 0)) / np.sqrt(2)
        return self.rho * ones, u, self.gas.p(self.rho, 1.0) * ones

    def known(self, n):
        return self.gas.cooled(self.rho, 1.0, self.end)


class Tube(Problem):
    """A Riemann problem in one dimension against its exact solution's cell averages."""

    def __init__(self, name, title, eos, left, right, x0, length, end, **more):
        self.name, self.title, self.end, self.x0, self.states, self.eos = name, title, end, x0, (left, right), eos
        self.size = (length, THICK)
        self.__dict__.update(more)

    def initial(self, at):
        left = at[:, 0] < self.x0
        rho, u, p = (np.where(left, a, b) for a, b in zip(*self.states))
        return rho, along_x(u), p

    def known(self, n):
        return Riemann(self.eos, *self.states).averages(np.linspace(0, self.size[0], n + 1), self.x0, self.end)[0]


class Dense(Problem):
    """A Riemann problem of denseShocks."""
    grids, quick = (100, 200, 400, 800), ()

    def __init__(self, name, title, tube, field="rho"):
        self.name, self.title, self.tube, self.field = name, title, tube, field
        self.options = tube.options
        self.scale = np.ptp([tube.left[0], tube.right[0]]) or tube.left[0] if field == "rho" else tube.left[2]

    @property
    def end(self):
        return self.tube.end

    def initial(self, at):
        left = at[:, 0] < self.tube.x0
        rho, u, p = (np.where(left, a, b) for a, b in zip(self.tube.left, self.tube.right))
        return rho, along_x(u), p

    def known(self, n):
        return self.tube.averages(n)[("rho", "u", "p").index(self.field)]


class Referenced(Problem):
    """Known from two runs of `fine` cells by different schemes: the mean of the two, averaged over blocks to `store`
    cells. `gap` is the mean of |one - other| over the scale: no error far below it means anything."""
    pair = (("common", "WENO5"), ("LaxFriedrichs", "WPENO5"))
    gap = mean = None

    def known(self, n):
        return self.blocks(self.mean, n)[self.kept(n)]

    def blocks(self, full, n):
        """Averages of an array on a square or line, [cells] of the box with n cells along x."""
        more = n // np.gcd(n, full.shape[-1])  # cells are cut where n is no divisor
        for axis in range(full.ndim):
            full = np.repeat(full, more, axis)
        m = full.shape[-1] // n
        if full.ndim == 1:
            return full.reshape(n, m).mean(axis=1)
        return full.reshape(n, m, n, m).mean(axis=(1, 3)).ravel()

    def whole(self, values, n):
        """Values of the cells there are as an array on the whole box; nan elsewhere."""
        full = np.full(np.prod(self.box(n)[0]), np.nan)
        full[self.kept(n)] = values
        return full.reshape(n, n) if self.two_dimensional else full

    def load(self, folders):
        """From NAME.npz in the first folder that has it: the finest there is. False: in none."""
        for folder in folders:
            path = os.path.join(folder, f"{self.name}.npz")
            if os.path.exists(path):
                with np.load(path) as f:
                    self.mean, self.gap, self.fine = f["mean"].astype(float), float(f["gap"]), int(f["fine"])
                return True
        return False

    def keep(self, folder, runs):
        """runs: the field of each scheme of `pair` on the fine grid. 20 bits are stored."""
        store = min(self.store, self.fine)
        stored = [self.blocks(self.whole(v, self.fine), store) for v in runs]
        there = self.kept(store)
        self.gap = float(np.abs(stored[0] - stored[1])[there].mean() / self.scale)
        mean = np.where(there, (stored[0] + stored[1]) / 2, 0)
        exponent = 2.0 ** (np.floor(np.log2(np.maximum(np.abs(mean), 1e-300))) - 19)
        mean = np.where(there, np.round(mean / exponent) * exponent, np.nan).astype("f4")
        self.mean = mean.reshape(store, store).astype(float) if self.two_dimensional else mean.astype(float)
        os.makedirs(folder, exist_ok=True)
        np.savez_compressed(os.path.join(folder, f"{self.name}.npz"), mean=self.mean.astype("f4"), gap=self.gap, fine=self.fine,
                            schemes=np.array([" ".join(p) for p in self.pair]))


class ShuOsher(Referenced):
    name, title = "shuOsher", "Shu and Osher's shock in a wavy gas, perfect gas"
    size, end = (10.0, THICK), 1.8
    grids, quick, fine, store = (200, 400, 800, 1600), (), 6400, 1600
    foam, foam_quick = {0.2: (200, 400, 800, 1600), 0.1: (200, 400, 800, 1600, 3200)}, {}
    options = {"eos": "perfectGas", "gamma": 1.4}

    def initial(self, at):
        x = at[:, 0] - 5
        left = x < -4
        return (np.where(left, 3.857143, 1 + 0.2 * np.sin(5 * x)), along_x(np.where(left, 2.629369, 0)),
                np.where(left, 10.33333, 1))


class Riemann2D(Referenced):
    name, title = "riemann2D", "two-dimensional Riemann problem, configuration 3, perfect gas"
    end, two_dimensional = 0.3, True
    grids, quick, fine, store = (100, 200, 400), (), 2000, 400
    foam = {0.2: (100, 200, 400), 0.1: (100, 200)}
    options = {"eos": "perfectGas", "gamma": 1.4}
    QUADRANTS = {(1, 1): (1.5, 0, 0, 1.5), (0, 1): (0.5323, 1.206, 0, 0.3), (0, 0): (0.138, 1.206, 1.206, 0.029),
                 (1, 0): (0.5323, 0, 1.206, 0.3)}

    def initial(self, at):
        rho, u, v, p = np.zeros((4, len(at)))
        for (right, top), state in self.QUADRANTS.items():
            here = ((at[:, 0] > 0.5) == right) & ((at[:, 1] > 0.5) == top)
            rho[here], u[here], v[here], p[here] = state
        return rho, np.stack([u, v, 0 * u], axis=1), p


class Step(Referenced):
    """A gas of cases/wedge falls on the step: no sink, no gravity, a perfect gas, so that rhoCentralFoam can."""
    name, title = "step", "a perfect gas at Mach 7.2 falls on a step (the wedge without sink, gravity, density)"
    size, two_dimensional, end = (10.0, 10.0), True, 0.1
    grids, quick, fine, store = (50, 100, 200), (), 800, 400
    foam = {0.2: (50, 100, 200), 0.1: (50, 100)}
    options = {"eos": "perfectGas", "gamma": 5 / 3}
    scale = 34.3774677
    pair = (("common", "WENO5"), ("Marquina", "PHM"))

    def hole(self, n):
        x, y, _ = boxes.centres(*self.box(n)).T
        return (x > 5) & (y < 5)

    def initial(self, at):
        ones = np.ones(len(at))
        return self.scale * ones, np.outer(ones, (44.547727, -44.547727, 0)), 1589.2685472 * ones


class Wedge(Step):
    name, title = "wedge", "cases/wedge: granular gas, e = 0.97, gravity, on a step"
    end, foam = 0.0425, {}
    grids = (100, 200, 400)
    options = {"e": 0.97, "cooling": "Haff", "gravity": (692.9646455628165, -692.9646455628165, 0.0)}


class Triangles(Problem):
    """A square of gmsh's triangles, n edges a side. Both programs start from the averages of the conserved variables over the
    cells, and the error is that of the averages, weighed with the cells."""
    two_dimensional = general = True
    meshes = {}

    def mesh(self, n):
        """The case that holds a mesh, and the mesh; made once."""
        if n not in self.meshes:
            folder = tempfile.TemporaryDirectory(prefix="workPrecision")
            triangles.make(folder.name, self.size[0], n, os.path.join(self.programs, "gmshToCase"), self.cyclic)
            self.meshes[n] = folder, haff.Case(folder.name)
        return self.meshes[n][1]

    def kept(self, n):
        return np.ones(self.mesh(n).mesh.cells, bool)

    def averages(self, n, t):
        return triangles.means(self.mesh(n).mesh, lambda x: self.conserved(x, t), self.parts)

    def make(self, case, n, **scheme):
        mesh, gamma = self.mesh(n), self.options["gamma"]
        shutil.copytree(os.path.join(mesh.path, "constant"), os.path.join(case, "constant"))
        rho, *momentum, E = self.averages(n, 0.0).T
        u = np.stack([m / rho for m in momentum] + [0 * rho], axis=1)
        p = (gamma - 1) * (E - rho * (u**2).sum(axis=1) / 2)
        reconstruct = scheme.pop("reconstruct", "CWENO3")
        patches = {name: kind for name, (kind, _, _) in mesh.mesh.patches.items()}
        boxes.write_case(case, patches, rho, u, p, self.end, binary=True, **{**self.options, **scheme})
        with open(os.path.join(case, "system", "fvSchemes"), "a") as f:
            f.write(f"polyReconstruct {reconstruct};\n")
        return rho, u, p

    def known(self, n):
        return self.averages(n, self.end)[:, 0]

    def error(self, n, values):
        if self.answer[0] != n:
            self.answer = n, self.known(n)
        return np.average(np.abs(values - self.answer[1]), weights=self.mesh(n).volumes) / self.scale


def conserved(rho, u, v, p, gamma):
    return np.stack([rho, rho * u, rho * v, p / (gamma - 1) + rho * (u**2 + v**2) / 2], axis=1)


class VortexTriangles(Triangles):
    name, title = "vortexTriangles", "isentropic vortex on gmsh's triangles, perfect gas, a fifth of a period"
    size, end, cyclic, parts, meshes = (10.0, 10.0), 2.0, "xy", 2, {}
    grids, quick = (20, 40, 80), (12, 24)
    foam, foam_quick = {0.2: (20, 40, 80, 160), 0.1: (40, 80)}, {0.2: (12,)}
    options = {"eos": "perfectGas", "gamma": 1.4}

    def conserved(self, x, t):
        at = np.column_stack([np.mod(x - t, 10.0), 0 * x[:, 0]])
        rho, u, p = Vortex().initial(at)
        return conserved(rho, u[:, 0], u[:, 1], p, 1.4)


class SodTriangles(Triangles):
    """Sod's tube along a square of triangles, cyclic across."""
    name, title = "sodTriangles", "Sod's shock tube on gmsh's triangles, perfect gas"
    size, end, cyclic, parts, meshes = (1.0, 1.0), 0.2, "y", 4, {}
    grids, quick = (25, 50, 100, 200), ()
    foam, foam_quick = {0.2: (25, 50, 100, 200), 0.1: (25, 50, 100)}, {}
    options = {"eos": "perfectGas", "gamma": 1.4}

    @functools.cached_property
    def table(self):
        """x/t and rho, u, p there, between which they are linear or nearly so."""
        tube = Riemann(PerfectGas(1.4), (1, 0, 1), (0.125, 0, 0.1))
        fan, jumps = np.linspace(tube.left.head, tube.left.tail, 300), np.array([tube.u, tube.right.speed])
        speeds = np.sort(np.concatenate([[-9, 9], fan, jumps - 1e-9, jumps + 1e-9]))
        return speeds, tube.sample(speeds)

    def conserved(self, x, t):
        speeds, values = self.table
        rho, u, p = (np.interp((x[:, 0] - 0.5) / max(t, 1e-12), speeds, v) for v in values)
        return conserved(rho, u, 0 * u, p, 1.4)


PROBLEMS = [
    Vortex(), VortexTriangles(), Wave(), Shear(),
    Tube("sod", "Sod's shock tube, perfect gas", PerfectGas(1.4), (1, 0, 1), (0.125, 0, 0.1), 0.5, 1.0, 0.2,
         grids=(100, 400, 1600, 3200), quick=(50, 100, 200), options={"eos": "perfectGas", "gamma": 1.4},
         foam={0.2: (100, 200, 400, 800, 1600, 3200), 0.1: (100, 200, 400, 800, 1600, 3200), 0.05: (400, 1600, 3200)},
         foam_quick={0.2: (100, 200)}),
    Tube("blast", "granular blast, e = 1, exact Riemann solution", GoldshteinShapiro(1.0), *BLAST, 5.0, 10.0, 5.48,
         grids=(250, 1000, 4000), quick=(125, 250), scale=50.0),
    Dense("burst", "dense gas bursts into thin gas that recedes, volume fractions 0.4005 | 0.0032, pressure ratio 399",
          denseTubes.drifting_burst()),
    Dense("headOn", "streams of dense gas meet at Mach 15.8, volume fraction 0.1", denseTubes.head_on()),
    Dense("contact", "contact of volume fractions 0.6 | 0.0006 that moves; error of p", denseTubes.contact(0.002), "p"),
    Dense("parting", "gas of volume fraction 0.1 parts at Mach 0.7", next(t for t in denseTubes.others() if t.name.startswith("parting"))),
    SodTriangles(), ShuOsher(), Riemann2D(), Step(), Wedge(),
]
