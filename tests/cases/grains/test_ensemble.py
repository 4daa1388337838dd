# SPDX-License-Identifier: GPL-3.0-or-later
"""granularMD -ensemble: means over members as of one long window, standard errors, going on, the same bits as a run alone, errors."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.grains import test_particles as hard
from tests.cases.harness import haff
from haff.case import entries
from haff.case.foam import Field

N = 8


def ensemble(case, members=N, *options, check=True):
    return harness.program("granularMD", "-ensemble", str(members), "-np", "2", "-case", case, *options, check=check)


class Ensembles(harness.Folder, unittest.TestCase):
    def case(self, name, particles="seed 1;\n", **options):
        return hard.make(os.path.join(self.folder, name), **{"cells": (4, 4, 1), "size": (40.0, 40.0, 1.0), "alpha": 0.2, "e": 1, "particles": particles, "end": 4, "interval": 2, **options})

    def members(self, case):
        return [haff.Case(os.path.join(case, "ensemble", f"seed={k}")) for k in range(1, N + 1)]

    def test_means(self):
        """Sums over members are kept: mass, momentum, energy, impacts; of each kind, too. Errors: those of means, and for T, which is none, what leaving out one member at a time gives. 16 deviations of alpha from 0.2 fit their errors."""
        case = self.case("means", "species { big { } small { diameter 0.5; fraction 2; } }\n", types={"x": "wall"}, format="ascii")
        ensemble(case)
        found, runs = haff.Case(case), self.members(case)
        self.assertEqual(found.times, ["0", "2", "4"])
        self.assertEqual({f.replace("Error", "") for f in found.fields("4")}, set(runs[0].fields("4")))
        at = {name: np.array([r.field(name, "4") for r in runs]) for name in runs[0].fields("4")}
        mean = {name: found.field(name, "4") for name in at}
        same = lambda a, b: np.testing.assert_allclose(a, b.mean(axis=0), rtol=1e-12, atol=1e-14)
        for weight, kind in (("rho", ""), ("alpha.big", ".big"), ("alpha.small", ".small")):
            w, u, T = weight, "U" + kind, "T" + kind
            same(mean[w], at[w])
            same(mean[w][:, None] * mean[u], at[w][..., None] * at[u])
            same(mean[w] * (2 * mean[T] + (mean[u] ** 2).sum(axis=1)), at[w] * (2 * at[T] + (at[u] ** 2).sum(axis=2)))
        same(mean["p"] - mean["rho"] * mean["T"], at["p"] - at["rho"] * at["T"])
        np.testing.assert_allclose(mean["TComponents"].sum(axis=1), 2 * mean["T"], rtol=1e-12)
        np.testing.assert_allclose(found.field("alphaError", "4"), at["alpha"].std(axis=0, ddof=1) / N**0.5, rtol=1e-9)
        tables = np.array([r.table("grains") for r in runs])
        np.testing.assert_allclose(found.table("grains"), tables.mean(axis=0), rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(found.table("grainsError")[:, 1:], tables.std(axis=0, ddof=1)[:, 1:] / N**0.5, rtol=1e-9)
        np.testing.assert_array_equal(found.table("grainsError", frame=True)["Time"], [0, 2, 4])
        w, u, T, left = at["rho"][:, 5], at["U"][:, 5], at["T"][:, 5], []
        for i in range(N):
            others = np.arange(N) != i
            middle = np.average(u[others], axis=0, weights=w[others])
            left.append(np.average(T[others] + ((u[others] - middle) ** 2).sum(axis=1) / 2, weights=w[others]))
        self.assertAlmostEqual(found.field("TError", "4")[5] / (np.std(left) * (N - 1) ** 0.5), 1, delta=1e-9)
        away = (mean["alpha"] - at["alpha"].mean()) / found.field("alphaError", "4")
        self.assertTrue(0.4 < np.mean(away**2) < 3, np.mean(away**2))

    def test_goes_on(self):
        """To a later endTime and with more members, whose fields have the bits of runs alone; walls stay in the fields; times that were averaged are read by caseToVTK."""
        case = self.case("goes", types={"x": "wall", "y": "cyclic"})
        alone = shutil.copytree(case, os.path.join(self.folder, "alone"))
        ensemble(case, 3)
        harness.edit(case, "system/controlDict", endTime=6)
        ensemble(case)
        entries.edit(os.path.join(alone, "constant/particleProperties"), {"seed": 2})
        harness.edit(alone, "system/controlDict", endTime=6)
        hard.solve(alone)
        for name in ("alpha", "U", "T", "p"):
            np.testing.assert_array_equal(haff.Case(alone).field(name, "6"), self.members(case)[1].field(name, "6"))
        self.assertEqual(entries.get(os.path.join(case, "6", "uniform", "ensemble"), "members"), N)
        for name, kind in (("U", "slip"), ("UError", "zeroGradient")):
            patches = Field(os.path.join(case, "6", name)).patches()
            self.assertEqual((patches["xLow"].type, patches["yLow"].type, patches["zEmpty"].type), (kind, "cyclic", "empty"))
        harness.program("caseToVTK", case)
        self.assertTrue(os.path.exists(os.path.join(case, "VTK", "goes_6.vtk")))

    def test_refused(self):
        placed = self.case("placed")
        hard.cloud(placed, [(1, 1, 0.5, 0)], [(0, 0, 0)])
        single = self.case("single", end=2)
        hard.solve(single)
        wrong = self.case("wrong", particles="seed 1;\nwidth 3;\n")
        gas = self.case("gas")
        harness.edit(gas, "system/controlDict", application="granularGas")
        for case, text in ((placed, r"0/lagrangian/grains/U: it says how all grains move"), (single, r"single/2 holds results of a single run"),
                           (self.case("bare", particles=None), r"particleProperties is not there.* seed 1;"),
                           (wrong, r"particleProperties:\d+: keyword 'width' is not used"), (gas, r"only application granularMD has a seed")):
            done = ensemble(case, check=False)
            self.assertEqual(done.returncode, 1, case)
            self.assertRegex(done.stderr, text)
        self.assertEqual(haff.Case(single).times, ["0", "2"])
        for words, text in ((("granularMD", "-ensemble", "1"), "the number of members is a whole number from 2 on"), (("granularMD", "-ensemble", "2", "-strict"), "-ensemble goes with"),
                            (("granularGas", "-ensemble", "2"), "granularGas has no seed")):
            done = harness.program(*words, "-case", placed, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn(text, done.stderr)
        self.assertIn("The case", harness.program("granularMD", "-ensemble", "2", "-np", "2", "-dry-run", "-case", self.case("dry")).stdout)


if __name__ == "__main__":
    unittest.main()
