# SPDX-License-Identifier: GPL-3.0-or-later
"""granularMD with grains of several kinds: equipartition, the ratio of temperatures of a cooling mixture, pressure, walls, packings, fields against grains, restarts to the bit, errors."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.grains import test_particles as hard
from tests.cases.grains import test_walls as walls
from haff.case import grains  # noqa: E402
from studies.exact.mixtures import Mixture  # noqa: E402

D = {"x": "wall", "y": "wall"}


def species(d, m, x=(1, 1), more=("", "")):
    kinds = "".join(f" {name} {{ diameter {a}; mass {b}; fraction {c}; {extra} }}" for name, a, b, c, extra in zip(("one", "two"), d, m, x, more))
    return f"species {{{kinds} }}\n"


def column(case, name):
    with open(os.path.join(case, "postProcessing", "grains", "0", "grains.dat")) as f:
        names = [line for line in f if line.startswith("# Time")][0].split()[1:]
    return harness.haff.Case(case).table("grains", "grains.dat")[:, names.index(name)]


class Mixtures(harness.Folder, unittest.TestCase):
    def case(self, name, particles, size=70.0, **options):
        return hard.make(os.path.join(self.folder, name), **{"cells": (4, 4, 1), "size": (size, size, 1.0), "alpha": 0.1, "particles": particles, **options})

    def test_ratio(self):
        """The theory has no correlations; clusters, which form later, lower the ratio. Of 1250 grains of each kind the mean of 14 moments scatters by 1 %."""
        m, e = (8, 1), [[0.9, 0.9], [0.9, 0.9]]
        case = self.case("cooling", species((1, 1), m), size=140.0, e=0.9, end=36, interval=36, control="maxDeltaT 1.7;\n")
        hard.solve(case)
        exact = Mixture((1, 1), m, (0.5, 0.5), e, 0.1).variances()
        self.assertAlmostEqual(exact, 0.16957, delta=1e-5)
        found = (column(case, "T_one") / column(case, "T_two"))[column(case, "Time") > 12]
        self.assertGreater(len(found), 13)
        self.assertAlmostEqual(found.mean() / exact, 1, delta=0.04)
        case = self.case("pairs", species((1, 1), (1, 1), more=("restitution 1; with { two 0.9; }", "restitution 0.6;")), size=140.0, e=0.9, end=30, interval=30, control="maxDeltaT 1.5;\n")
        hard.solve(case)
        exact = Mixture((1, 1), (1, 1), (0.5, 0.5), [[1, 0.9], [0.9, 0.6]], 0.1).variances()
        self.assertGreater(exact, 1.15)
        found = (column(case, "T_one") / column(case, "T_two"))[column(case, "Time") > 10]
        self.assertAlmostEqual(found.mean() / exact, 1, delta=0.04)

    def test_elastic(self):
        """Equal energies of both kinds, pressure, energy to round-off."""
        d, m, alpha = np.array([1.0, 0.5]), (2, 1), 0.3
        case = self.case("elastic", "coarseGraining { samples 200; }\n" + species(d, m), e=1, alpha=alpha, end=40, interval=40, size=60.0)
        said = hard.solve(case)
        self.assertLess(abs(float(re.findall(r"balance ([-+\d.e]+)", said)[-1])), 1e-12)
        found = harness.haff.Case(case)
        self.assertAlmostEqual(found.field("alpha", "40").mean() / alpha, 1, delta=1e-3)
        mixture = Mixture(d, m, (0.5, 0.5), [[1, 1], [1, 1]], alpha)
        n, chi, sigma = mixture.n, mixture.chi, (d[:, None] + d) / 2
        pressure = (n.sum() + np.pi / 2 * np.sum(n[:, None] * n * sigma**2 * chi)) * 1.5  # m T: the mean mass
        self.assertAlmostEqual(found.field("p", "40").mean() / pressure, 1, delta=0.03)
        self.assertAlmostEqual(found.field("T", "40").mean(), 1, delta=0.01)
        self.assertAlmostEqual((column(case, "T_two") / column(case, "T_one")).mean() / 2, 1, delta=0.1)

    def test_fields(self):
        """Of a moment: all mass and area of the grains in a cell, mean velocity and T by mass; alpha, U, T of each kind; d and kind of each grain in the cloud, also in VTK."""
        case = self.case("moment", "coarseGraining { window 10; }\n" + species((1, 0.6), (3, 0.5), (1, 2)), e=0.9, end=1, interval=1, size=40.0)
        hard.solve(case)
        found = harness.haff.Case(case)
        c = grains.read(found, "1")
        alpha, rho, U, T = (found.field(f, "1") for f in ("alpha", "rho", "U", "T"))
        self.assertEqual(sorted(set(c["d"])), [0.6, 1.0])
        self.assertAlmostEqual(np.mean(c["d"] == 1), 1 / 3, delta=1 / len(c["d"]))
        mass = np.where(c["d"] == 1, 3, 0.5)
        for i in range(found.mesh.cells):
            inside = c["cell"] == i
            m, u = mass[inside], c["U"][inside]
            mean = np.average(u, axis=0, weights=m)
            self.assertAlmostEqual(rho[i], m.sum() / 100, delta=1e-12)
            self.assertAlmostEqual(alpha[i], np.pi / 4 * np.sum(c["d"][inside] ** 2) / 100, delta=1e-12)
            np.testing.assert_allclose(U[i], mean, atol=1e-12)
            self.assertAlmostEqual(T[i], np.sum(m * ((u - mean) ** 2).sum(axis=1)) / (2 * m.sum()), delta=1e-12)
            for name, k, d in (("one", 0, 1.0), ("two", 1, 0.6)):
                own = c["U"][inside & (c["species"] == k)]
                self.assertAlmostEqual(found.field(f"alpha.{name}", "1")[i], np.pi / 4 * d**2 * len(own) / 100, delta=1e-12)
                np.testing.assert_allclose(found.field(f"U.{name}", "1")[i], own.mean(axis=0), atol=1e-12)
                self.assertAlmostEqual(found.field(f"T.{name}", "1")[i], ((own - own.mean(axis=0)) ** 2).sum() / (2 * len(own)), delta=1e-12)
        np.testing.assert_array_equal(c["species"] == 0, c["d"] == 1)
        if not hard.VTK:
            self.skipTest("VTK's Python module is not there")
        harness.program("caseToVTK", case)
        data = hard.points(os.path.join(case, "VTK", "moment-grains_1.vtk"))
        for name in ("species", "d"):
            np.testing.assert_array_equal(hard.values(data, name), c[name])

    def test_means(self):
        """fieldAverage and phaseAverage weigh U and T of a kind by its alpha: each grain counts alike, and a time at which a cell has none of that kind does not count."""
        functions = ("functions { means { type fieldAverage; fields ( U.one { mean on; prime2Mean on; } T.one { mean on; } alpha.one { mean on; } U { mean on; } T.two { mean on; } ); }"
                     " phases { type phaseAverage; period 0.5; start 0.5; phases 1; fields (T.two U.one U alpha.two U.two); } }\n")
        particles = "coarseGraining { window 0.5; samples 1; }\n" + species((1, 0.6), (3, 0.5))
        case = self.case("means", particles, cells=(6, 6, 1), e=0.9, end=3, interval=0.5, size=18.0, control=functions)
        whole = shutil.copytree(case, os.path.join(self.folder, "means in parts"))
        hard.solve(case)
        found = harness.haff.Case(case)
        times = [f"{0.5 * k:g}" for k in range(1, 7)]
        field = {(name, t): found.field(name, t) for name in ("U.one", "U.two", "T.one", "T.two", "alpha.one", "alpha.two", "rho", "U") for t in times}
        self.assertEqual(min(field["alpha.one", t].min() for t in times), 0)

        def mean(name, weight):
            w = np.array([field[weight, t] for t in times])
            f = np.array([field[name, t] for t in times])
            w = w[..., None] if f.ndim == 3 else w
            return (w * f).sum(axis=0) / np.maximum(w.sum(axis=0), 1e-300)

        for name, weight in (("U.one", "alpha.one"), ("T.one", "alpha.one"), ("T.two", "alpha.two"), ("U", "rho")):
            np.testing.assert_allclose(found.field(name + "Mean", "3"), mean(name, weight), atol=1e-12, err_msg=name)
        for name, weight in (("T.two", "alpha.two"), ("U.one", "alpha.one"), ("U.two", "alpha.two"), ("U", "rho")):
            np.testing.assert_allclose(found.field(name, os.path.join("postProcessing", "phases", "0", "0")), mean(name, weight), atol=1e-12, err_msg=name)
        np.testing.assert_allclose(found.field("alpha.oneMean", "3"), np.mean([field["alpha.one", t] for t in times], axis=0), atol=1e-12)
        spread = np.array([field["U.one", t][:, 0] - mean("U.one", "alpha.one")[:, 0] for t in times])
        weight = np.array([field["alpha.one", t] for t in times])
        np.testing.assert_allclose(found.field("U.onePrime2Mean", "3")[:, 0] * weight.sum(axis=0), (weight * spread**2).sum(axis=0), atol=1e-12)
        harness.edit(whole, "system/controlDict", endTime=1.5)
        hard.solve(whole)
        harness.edit(whole, "system/controlDict", endTime=3)
        hard.solve(whole)
        a, b = hard.results(case, "3"), hard.results(whole, "3")
        for name in a:
            if "Mean" in name or "Average" in name:
                self.assertEqual(a[name], b[name], name)

    def test_walls(self):
        """Grains come to flat walls and to facets as near as their own radius, and not nearer."""
        box = self.case("box", species((1, 0.5), (2, 1)), types=D, e=1, end=20, interval=20, size=20.0, alpha=0.2)
        room = walls.make(os.path.join(self.folder, "room"), walls.ROOM, alpha=0.2, end=20, interval=20, particles=species((0.8, 0.4), (2, 1)))
        for case, size in ((box, (20, 20)), (room, (20, 16))):
            hard.solve(case)
            c = grains.read(harness.haff.Case(case), "20")
            gap = np.min([c["x"][:, :2].T, (np.array(size) - c["x"][:, :2]).T], axis=(0, 1)) / c["d"]
            for d in set(c["d"]):
                self.assertGreaterEqual(gap[c["d"] == d].min(), 0.5 - 1e-9)
                self.assertLess(gap[c["d"] == d].min(), 0.7)

    def test_dense(self):
        """Grains of two sizes are grown to 0.75; none overlaps another."""
        case = self.case("dense", species((1, 0.7), (2, 1)), alpha=0.75, e=1, end=0.01, interval=0.01, size=24.0)
        hard.solve(case)
        c = grains.read(harness.haff.Case(case), "0.01")
        r = c["x"][:, None, :2] - c["x"][None, :, :2]
        r -= 24 * np.round(r / 24)
        far = np.sqrt((r**2).sum(axis=2)) / (0.5 * (c["d"][:, None] + c["d"])) + 10 * np.eye(len(c["d"]))
        self.assertGreaterEqual(far.min(), 1 - 1e-9)
        self.assertAlmostEqual(np.pi / 4 * np.sum(c["d"] ** 2) / 24**2, 0.75, delta=0.002)

    def test_restart(self):
        one = self.case("first", species((1, 0.5), (2, 0.3)), types=D, g=(0, -1, 0), e=0.9, threshold=0.01, end=4, interval=2, size=30.0)
        two = shutil.copytree(one, os.path.join(self.folder, "second"))
        hard.solve(one)
        harness.edit(two, "system/controlDict", endTime=2)
        hard.solve(two)
        harness.edit(two, "system/controlDict", endTime=4)
        self.assertIn("to the bit", hard.solve(two))
        a, b = hard.results(one, "4"), hard.results(two, "4")
        self.assertEqual(a.keys(), b.keys())
        for name in a:
            if name != "uniform/provenance":
                self.assertEqual(a[name], b[name], name)
        harness.edit(two, "system/controlDict", endTime=5)
        harness.edit(two, "constant/particleProperties", mass=4)
        self.assertIn("have changed, so counts and averages begin anew", hard.solve(two))

    def test_sheared(self):
        """Two equal kinds move as one kind does. Of unequal ones energy and work balance, none overlaps another or its images, which move, and T is that of all velocities relative to the shear."""
        with_shear = dict(alpha=0.4, e=0.9, end=4, interval=4, size=24.0, T=4)
        alone, alike = (self.case(name, "shearRate 1;\nN 250;\n" + text, **with_shear) for name, text in (("alone", ""), ("alike", species((1, 1), (1, 1)))))
        case = self.case("sheared", "shearRate 1;\n" + species((1, 0.6), (2, 0.5), (1, 2)), **with_shear)
        for one in (alone, alike, case):
            said = hard.solve(one)
            self.assertLess(abs(float(re.findall(r"balance ([-+\d.e]+)", said)[-1])), 1e-12)
        a, b = (grains.read(harness.haff.Case(one), "4") for one in (alone, alike))
        for name in ("x", "U"):
            np.testing.assert_allclose(a[name], b[name], rtol=0, atol=1e-6)
        c = grains.read(harness.haff.Case(case), "4")
        mass = np.where(c["species"] == 0, 2, 0.5)
        r = c["x"][:, None, :2] - c["x"][None, :, :2]
        above = np.round(r[..., 1] / 24)
        r[..., 1] -= 24 * above
        r[..., 0] -= 24 * 4 * above
        r[..., 0] -= 24 * np.round(r[..., 0] / 24)
        gap = np.sqrt((r**2).sum(axis=2)) / (0.5 * (c["d"][:, None] + c["d"])) + 10 * np.eye(len(mass))
        self.assertTrue(1 - 1e-9 <= gap.min() < 1.05, gap.min())
        self.assertGreater(np.sum((above != 0) & (gap < 1.2)), 4)
        u = c["U"][:, :2] - np.outer(c["x"][:, 1] - 12, (1, 0))
        square = ((u - np.average(u, axis=0, weights=mass)) ** 2).sum(axis=1)
        self.assertAlmostEqual(column(case, "T")[-1], np.sum(mass * square) / (2 * mass.sum()), delta=1e-9)
        for k, name in enumerate(("one", "two")):
            self.assertAlmostEqual(column(case, f"T_{name}")[-1], square[c["species"] == k].mean() / 2, delta=1e-9)

    def test_refused(self):
        many = "species {" + "".join(f" k{i} {{ }}" for i in range(9)) + " }\n"
        for n, (particles, text) in enumerate(((many, r"particleProperties:\d+: key 'species' .*8 kinds at most"),
                                               (species((1, 0.5), (1, 1), more=("with { two 1.5; }", "")), r"key 'two' is 1.5; a restitution lies in 0 to 1"),
                                               ("species { a-b { } c { } }\n", r"key 'a-b'.* a kind of grains has a name of letters, digits and _, 40 at most"),
                                               (species((1, 0.5), (1, 1), more=("", "restitutio 0.5;")), r"keyword 'restitutio' is not used"))):
            done = harness.program("granularMD", "-case", self.case(f"refused {n}", particles), check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, text)


if __name__ == "__main__":
    unittest.main()
