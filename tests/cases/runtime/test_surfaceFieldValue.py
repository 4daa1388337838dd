# SPDX-License-Identifier: GPL-3.0-or-later
"""The function object surfaceFieldValue: operations on patches and planes, what flows through them, second order of planes on any mesh."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.runtime.test_forces import BUDGET, ask, columns
from tests.cases.transport.channels import friction, spheres

PLANE = "sampledSurfaceDict { type plane; basePoint (%.17g %.17g %.17g); normalVector (%.17g %.17g %.17g); }"
ENTRY = "%s { type surfaceFieldValue; regionType %s; operation %s; fields (%s); %s }\n"
BASE = np.array([0.52, 0.4, 0.31])


def flow(at, dim):
    """rho, p, u of a smooth flow; in a plane for dim 2."""
    x, y, z = at.T * np.array([[1], [1], [dim - 2]])
    u = np.stack([1 + 0.3 * np.sin(y + z), np.cos(2 * x) - 0.2 * z, (dim - 2) * 0.4 * np.sin(x + y)], axis=1)
    return 2 + 0.5 * np.sin(2 * x + y + 0.5 * z), 3 + np.cos(x - 2 * y + z), u


def through(normal, dim, thick):
    """Area, mean p, and the flows of mass, momentum and energy through the plane in the unit square or cube, by fine quadrature."""
    normal, fine = np.array(normal) / np.linalg.norm(normal), (np.arange(600) + 0.5) / 600
    y, z = (a.ravel() for a in np.meshgrid(fine, fine if dim == 3 else [BASE[2]]))
    x = BASE[0] - (normal[1] * (y - BASE[1]) + normal[2] * (z - BASE[2])) / normal[0]
    weight = thick / len(y) / normal[0] * ((x > 0) & (x < 1))
    rho, p, u = flow(np.stack([x, y, z], axis=1), dim)
    speed, E = u @ normal, 1.5 * p + 0.5 * rho * (u**2).sum(axis=1)
    momentum = weight @ ((rho * speed)[:, None] * u + p[:, None] * normal)
    return weight.sum(), weight @ p / weight.sum(), np.array([weight @ (rho * speed), *momentum, weight @ ((E + p) * speed)])


class SurfaceFieldValue(harness.Folder, unittest.TestCase):
    def laid(self, mesh, dim, cells):
        """A case with the smooth flow in the cells of a unit square or cube."""
        case = os.path.join(self.folder, f"{mesh}{dim}{cells}")
        return runs.unit_box(case, mesh, dim, cells, lambda at: dict(zip(("rho", "p", "U"), flow(at, dim))))

    def cut(self, mesh, dim, cells, normal):
        """Errors of the flows through a plane and of the mean pressure there, at the start."""
        plane = PLANE % (*BASE, *normal)
        case = ask(self.laid(mesh, dim, cells), ENTRY % ("cut", "sampledSurface", "sum", "phi phiU phiE", plane),
                   ENTRY % ("mean", "sampledSurface", "areaAverage", "p", "writeArea yes; " + plane))
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        area, p, flows = through(normal, dim, np.ptp(result.mesh.points[:, 2]) if dim == 2 else 1)
        mean, sums = result.table("mean", "surfaceFieldValue.dat")[0], result.table("cut", "surfaceFieldValue.dat")[0, 1:]
        np.testing.assert_allclose(mean[1], area, rtol=5e-3 / 600 if mesh == "lattice" else 1e-5)
        return np.array([np.abs(sums / flows[0] - flows / flows[0]).max(), abs(mean[2] - p)])

    def test_planes(self):
        """Across cells in any way and along their faces, in two and three dimensions, on boxes and simplices."""
        for mesh, dim, cells, normal in (("lattice", 2, (16, 32), (1, 0.6, 0)), ("lattice", 3, (10, 20), (1, 0.6, -0.3)),
                                         ("lattice", 2, (25, 50), (1, 0, 0)),  # on faces of both
                                         ("simplices", 2, (16, 32), (1, 0.6, 0)), ("simplices", 3, (5, 10), (1, 0.6, -0.3))):
            if mesh == "simplices" and not shutil.which("gmsh"):
                continue
            with self.subTest(f"{mesh} {dim} {normal}"):
                coarse, fine = (self.cut(mesh, dim, k, normal) for k in cells)
                self.assertLess(coarse.max(), 2e-2)
                self.assertLess((fine / coarse).max(), 0.32)

    def test_a_plane_beside_the_mesh(self):
        case = ask(self.laid("lattice", 2, 8), ENTRY % ("cut", "sampledSurface", "sum", "phi", PLANE % (5, 0, 0, 1, 0, 0)))
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("does not cut the mesh", done.stderr)

    def test_operations(self):
        """Of all kinds on a patch, by the values in the cells beside it; the same on two ranks."""
        operations = ("sum", "sumMag", "average", "areaAverage", "areaIntegrate", "areaNormalAverage", "areaNormalIntegrate",
                      "weightedSum", "weightedAverage", "weightedAreaAverage", "weightedAreaIntegrate", "min", "max")
        functions = []
        for name in operations:
            fields = "U" if "Normal" in name else "p U"
            functions.append(ENTRY % (name, "patch", name, fields, "name xHigh;" + ("weightField rho;" if "weighted" in name else "")))
        functions.append(ENTRY % ("scaled", "patch", "sum", "p", "name (xHigh yLow); scaleFactor -2;"))
        case = ask(self.laid("lattice", 2, 12), *functions)
        pair = shutil.copytree(case, case + "_2")
        harness.program("granularGas", "-case", case)
        harness.program("granularGas", "-case", pair, ranks=2)
        runs.same(self, runs.contents(case + "/postProcessing"), runs.contents(pair + "/postProcessing"))
        result = harness.haff.Case(case)
        beside, low = result.centres[:, 0] > 1 - 1 / 12, result.centres[:, 1] < 1 / 12
        rho, p, u = flow(result.centres, 2)
        values, w, area = np.column_stack((p, u))[beside], rho[beside, None], 0.1 / 12
        expected = {"sum": values.sum(0), "sumMag": np.abs(values).sum(0), "average": values.mean(0), "areaAverage": values.mean(0),
                    "areaIntegrate": area * values.sum(0), "areaNormalAverage": values[:, 1].mean(), "areaNormalIntegrate": area * values[:, 1].sum(),
                    "weightedSum": (w * values).sum(0), "weightedAverage": (w * values).sum(0) / w.sum(),
                    "weightedAreaAverage": (w * values).sum(0) / w.sum(), "weightedAreaIntegrate": area * (w * values).sum(0),
                    "min": values.min(0), "max": values.max(0)}
        for name in operations:
            np.testing.assert_allclose(result.table(name, "surfaceFieldValue.dat")[0, 1:], expected[name], rtol=1e-12, err_msg=name)
        np.testing.assert_allclose(result.table("scaled", "surfaceFieldValue.dat")[0, 1], -2 * (p[beside].sum() + p[low].sum()), rtol=1e-12)

    def test_heading(self):
        case = ask(self.laid("lattice", 2, 6), ENTRY % ("mean", "patch", "weightedAverage", "p U", "name xHigh; weightField rho; writeArea yes;"))
        harness.program("granularGas", "-case", case)
        with open(case + "/postProcessing/mean/0/surfaceFieldValue.dat") as f:
            lines = f.read().splitlines()
        self.assertEqual(lines[:5], ["# Region type : patch xHigh", "# Faces       : 6", "# Area        : 0.1", "# Scale factor: 1",
                                     "# Weight field: rho"])
        self.assertEqual(lines[5].split("\t"), ["# Time        ", "Area", "weightedAverage(p)", "weightedAverage(U)"])

    def test_flows_close(self):
        """Mass and energy that leave through all patches are what the budget says they have brought, to round-off: heat, work of
        walls and of the gas outside, friction on rough walls, heat that follows the density."""
        def end(time):
            return lambda case: harness.edit(case, "system/controlDict", endTime=time, maxCo=0.4)

        for engine in ("lattice", "polyhedral"):
            for name, cells, *changes in (("couetteDisks", 12, end(2)), ("couetteDisks", 12, end(2), friction),
                                          ("couetteDisks", 12, end(2), spheres(0.9), friction), ("heatedWalls", 12, end(1)),
                                          ("heatedWalls", 12, end(1), spheres(0.8, -0.1)), ("cylinder", 8, end(0.1))):
                if name == "cylinder" and engine == "lattice":
                    continue
                case = harness.copy(name, self.folder)
                harness.mesh(case, cells)
                for change in changes:
                    change(case)
                runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
                ask(case, BUDGET, ENTRY % ("all", "patch", "sum", "phi phiE", 'name ".*";'))
                harness.program("granularGas", "-case", case)
                with self.subTest(engine=engine, name=name, changes=len(changes)):
                    b, sums = columns(case, "budget", "energyBudget.dat"), harness.haff.Case(case).table("all", "surfaceFieldValue.dat")
                    dt = np.diff(b["Time"])
                    gained = b["heat"] + b["wallWork"] + b["flow"]
                    self.assertGreater(np.abs(gained).max(), 1e-3 * b["energy"].max())
                    scale = np.cumsum(np.abs(sums[:, 2]) * dt)[-1] + b["energy"].max()
                    np.testing.assert_allclose(np.cumsum(sums[:, 2] * dt), -gained[1:], atol=1e-11 * scale, rtol=0)
                    np.testing.assert_allclose(np.cumsum(sums[:, 1] * dt), -b["massFlow"][1:], atol=1e-11 * b["mass"].max(), rtol=0)

    def test_restart(self):
        """Flows have a row a step, values besides one at the start; a restart goes on with the same rows."""
        case = runs.make(os.path.join(self.folder, "whole"), (16, 12, 1), 0.01, interval=0.005)
        ask(case, ENTRY % ("flows", "patch", "sum", "phiU phiE p", 'name ".*";'), ENTRY % ("values", "patch", "max", "p", "name yLow;"))
        harness.program("granularGas", "-case", case)
        again = runs.until(case, case + "_again", 0.005)
        harness.program("granularGas", "-case", again, ranks=2)
        for name, first in (("flows", 0), ("values", 1)):
            whole, rest = (harness.haff.Case(c).table(name, "surfaceFieldValue.dat") for c in (case, again))
            self.assertEqual((whole[:, 0] == 0).sum(), first)
            np.testing.assert_array_equal(whole[whole[:, 0] >= rest[0, 0]], rest)


if __name__ == "__main__":
    unittest.main()
