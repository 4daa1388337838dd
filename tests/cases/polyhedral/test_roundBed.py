# SPDX-License-Identifier: GPL-3.0-or-later
"""Beds about an axis, with and without friction, on lattices and polyhedra: the same bits on any ranks and over restarts; a can far from
the axis is a box in the plane; budgets close; a heap rests; what is not there is refused with its cure."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.runtime import test_energyBudget as audit
from tests.cases.transport import test_friction
from tests.cases.transport.channels import replace

G, N = 9.81, (20, 14, 1)
COLUMN = "x < 0.007 && y < 0.01 ? 0.6 : 1e-5"


def budget(result):
    """The columns of energyBudget.dat by their titles."""
    with open(result.path + "/postProcessing/budget/0/energyBudget.dat") as f:
        titles = next(line for line in f if "residual" in line).lstrip("# ").split()
    return dict(zip(titles, result.table("budget", "energyBudget.dat").T))


class RoundBed(harness.Folder, unittest.TestCase):
    def column(self, name, engine="lattice", end=0.04, n=N, alpha=COLUMN, **options):
        """A column of cold spheres that falls; x is the radius."""
        schemes = "" if engine == "lattice" else f"meshEngine polyhedral; polyReconstruct {engine};\n"
        case = test_friction.bed(os.path.join(self.folder, name), n, alpha, (0.0, -G, 0.0), end, end / 2, schemes=schemes, **options)
        replace(case, "system/fvSolution", "automatic", "implicit")
        return case

    def triangles(self, name, **options):
        """The same on triangles that reach the axis."""
        case = self.column(name, "linear", axis=0.0, **options)
        shutil.rmtree(case + "/constant/polyMesh")
        with open(case + "/mesh.geo", "w") as f:
            f.write(re.sub("MeshSizeM(..) = [0-9.]+", r"MeshSizeM\1 = 0.0014", test_friction.TRIANGLES))
        with open(case + "/system/meshDict", "a") as f:
            f.write("patches { xLow { type symmetryPlane; } xHigh { type wall; } yLow { type wall; } yHigh { type wall; } }\n")
        harness.mesh(case, 1)
        return case

    def test_same(self):
        """2 ranks and a restart on 3 have the bits of a run on one, with the stress that friction keeps."""
        for engine in ("lattice", "linear"):
            with self.subTest(engine):
                one = self.column("one" + engine, engine, 0.01, axis=0.0)
                _, log = test_friction.solve(one)
                self.assertIn("implicit acoustics", log)
                two = self.column("two" + engine, engine, 0.01, axis=0.0)
                test_friction.solve(two, ranks=2)
                runs.same(self, runs.results(one), runs.results(two), "ranks")
                shutil.rmtree(two + "/0.01")
                test_friction.solve(two, ranks=3)
                runs.same(self, runs.contents(one + "/0.01"), runs.contents(two + "/0.01"), "restart")

    def test_far(self):
        """At a radius of 500 and of 5000 diameters the difference from the plane is at most twice the width over the radius. With friction it falls
        as 1/r; without, other steps may be implicit ones."""
        for engine in ("lattice", "linear"):
            for friction in ("", "type muI;"):
                with self.subTest(engine=engine, friction=friction):
                    name = engine + str(friction != "")
                    alpha = [test_friction.solve(self.column(f"{name}{axis}", engine, 0.02, friction=friction, axis=axis))[0].field("alpha")
                             for axis in (None, -0.5, -5.0)]
                    near, far = (np.abs(a - alpha[0]).mean() / alpha[0].mean() for a in alpha[1:])
                    self.assertLess(near, 2 * 0.02 / 0.5)
                    self.assertLess(far, min(2 * 0.02 / 5, 0.2 * near if friction else 1))

    def test_budget(self):
        """Mass, energy and momentum along the axis come from named causes; friction takes energy. On triangles cells are raised to the floor, too."""
        for engine in ("lattice", "linear") + (("triangles",) if shutil.which("gmsh") else ()):
            for friction in ("", "type muI;", "type muI; frictionalHeating 0.5;"):
                with self.subTest(engine=engine, friction=friction):
                    name = f"budget{engine}{len(friction)}"
                    case = (self.triangles(name, end=0.02, friction=friction) if engine == "triangles" else
                            self.column(name, engine, 0.02, friction=friction, axis=0.0))
                    audit.ask(case)
                    result, _ = test_friction.solve(case)
                    b = budget(result)
                    scale = np.abs(b["gravity"]).max()
                    self.assertLess(np.abs(b["residual"]).max(), 1e-12 * scale)
                    self.assertLess(np.abs(b["massResidual"]).max(), 1e-13 * b["mass"][0])
                    self.assertLess(np.abs(b["momentumResidual_y"]).max(), 1e-12 * np.abs(b["momentumGravity_y"]).max())
                    radius = result.centres[:, 0]
                    mass = [(result.field("rho", t) * radius).sum() for t in ("0", "0.02")]
                    if engine != "triangles":
                        self.assertAlmostEqual(mass[1] / mass[0], 1, delta=1e-13)
                    if friction:
                        self.assertLess(b["friction"][-1], -0.1 * scale)

    def test_transport(self):
        """Beds and friction beside stress and conduction of impacts, on a lattice."""
        case = self.column("transport", end=0.03, axis=0.0)
        replace(case, "constant/granularProperties", "cooling Haff;", "cooling GarzoDufty; transport GarzoDufty;")
        audit.ask(case)
        result, log = test_friction.solve(case)
        self.assertIn("implicit acoustics", log)
        b = budget(result)
        self.assertLess(np.abs(b["residual"]).max(), 1e-12 * np.abs(b["gravity"]).max())
        self.assertLess(np.abs(b["momentumResidual_y"]).max(), 1e-12 * np.abs(b["momentumGravity_y"]).max())
        self.assertLess(b["friction"][-1], -0.1 * np.abs(b["gravity"]).max())

    def test_heap(self):
        """What falls over stays a heap: it is highest on the axis, and hardly moves."""
        for engine in ("lattice", "linear"):
            with self.subTest(engine):
                result, _ = test_friction.solve(self.column("heap" + engine, engine, 0.4, axis=0.0))
                packed = result.field("alpha") > 0.5
                speed = np.abs(result.field("U")[packed]).max()
                self.assertLess(speed, 0.01 * np.sqrt(G * 0.01))
                filled = result.field("alpha").reshape(N[1], N[0]).sum(axis=0) / 0.64
                self.assertTrue((np.diff(filled[:10]) < 0).all())
                self.assertGreater(filled[0], 3.5)

    def test_refused(self):
        """Beds beside swirl, and friction without cells along the axis."""
        swirls = self.column("swirls", axis=0.0)
        replace(swirls, "0.orig/U", "uniform (0 0 0)", "uniform (0 0 0.1)")
        rows = [(swirls, "take that velocity away")]
        smooth = self.column("smooth", axis=0.0, friction="")
        replace(smooth, "0.orig/U", "uniform (0 0 0)", "uniform (0 0 0.1)")
        rows.append((smooth, "type explicit"))
        rows.append((self.column("line", axis=0.0, n=(20, 1, 1), alpha="0.6"), "cells along the axis"))
        for case, cure in rows:
            with self.subTest(cure):
                harness.refused(self, case, r"meshDict:\d+: ", cure)


if __name__ == "__main__":
    unittest.main()
