# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields made of the state: vorticity, gradAlpha and Kn, in the time folders by writeObjects and in the files of the other function
objects."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes

CONTROL = "system/controlDict"
OBJECTS = "functions {{ derived {{ type writeObjects; libs (utilityFunctionObjects); {} }} {} }}\n"
ALL = "objects (Ma vorticity gradAlpha Kn c U);"
READERS = """
    spots {{ type probes; fields (vorticity Kn); probeLocations (({0})); }}
    extreme {{ type fieldMinMax; fields (vorticity gradAlpha); }}
    whole {{ type volFieldValue; fields (vorticity Kn); operation volAverage; }}
    cut {{ type surfaceFieldValue; regionType sampledSurface; operation weightedAverage; weightField Kn; fields (vorticity);
          sampledSurfaceDict {{ type plane; basePoint ({0}); normalVector (1 0 0); }} }}
    line {{ type sets; fields (vorticity gradAlpha); sets {{ a {{ type uniform; axis distance; start ({0}); end (0.9 0.9 0.01); nPoints 9; }} }} }}
    means {{ type fieldAverage; fields ( vorticity {{ mean on; }} ); }}
    pictures {{ type vtk; fields (Kn vorticity); writeControl writeTime; }}
"""
SLOPE = np.array([0.08, -0.11, 0.07])  # of alpha, 1/m
DIAMETER, DENSITY = 0.1, 6 / (np.pi * 0.1 ** 3)  # of the grains of box_case


def flow(x):
    """A velocity of second degree and its derivatives [n, i, j] = du_i/dx_j."""
    a, b, c = x.T
    u = np.stack([b * b + a * c, a * a - 2 * b * c, a * b + b * b], axis=1)
    zero = 0 * a
    return u, np.stack([np.stack(row, axis=1) for row in ((c, 2 * b, a), (2 * a, -2 * c, -2 * b), (b, a + 2 * b, zero))], axis=1)


def curl(slopes):
    return np.stack([slopes[:, (k + 2) % 3, (k + 1) % 3] - slopes[:, (k + 1) % 3, (k + 2) % 3] for k in range(3)], axis=1)


def box(path, n, text=OBJECTS.format(ALL, ""), original=True, moved=(1, 1, 1), width=0.1, **options):
    """Spheres of alpha linear and U quadratic in x along the axes that the mesh has and that are moved; returns x, alpha, and the
    curl."""
    n = np.array(n)
    size = width * n
    x = np.where(n > 1, boxes.centres(n, size), 0)
    alpha = 0.15 + x @ np.where(n > 1, SLOPE, 0)
    u, slopes = flow(x)
    u, slopes = u * moved, slopes * np.array(moved)[:, None] * (n > 1)
    harness.box_case(path, n, size, DENSITY * alpha, u, 5000 + 0 * alpha, 0.002,
                     **{"eos": "TorquatoSpheres", "interval": 0.001, "format": "binary", **options})
    runs.add(path, CONTROL, text)
    if original:
        os.rename(os.path.join(path, "0"), os.path.join(path, "0.orig"))
    return x, alpha, curl(slopes)


class WriteObjects(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def test_start(self):
        """Exact for U of second degree and linear alpha, which differences and fits of second order are, beside patches, too; along
        all axes where gas moves along an axis that the mesh lacks; in a plane the curl leads out of it."""
        meshes = {"line": ((30, 1, 1), (1, 0, 0)), "plane": ((14, 1, 12), (1, 0, 1)), "oblique": ((14, 12, 1), (1, 1, 1)),
                  "space": ((9, 8, 7), (1, 1, 1))}
        for name, (n, moved) in meshes.items():
            for engine in ("lattice", "polyhedral"):
                path = self.path(name + engine)
                x, alpha, omega = box(path, n, moved=moved)
                runs.add(path, "system/fvSchemes", f"meshEngine {engine};\n")
                harness.program("initialFields", path)
                result = harness.haff.Case(path)
                grad = np.where(np.array(n) > 1, SLOPE, 0) + 0 * x
                chi = (1 - alpha / 2) / (1 - alpha) ** 3  # Carnahan and Starling, below freezing
                kn = DIAMETER / (6 * np.sqrt(2) * alpha * chi) * np.linalg.norm(grad, axis=1) / alpha
                with self.subTest(name=name, engine=engine):
                    for field, wanted in (("vorticity", omega), ("gradAlpha", grad), ("Kn", kn)):
                        found = result.field(field, "0")
                        # round-off of values of order 1 over widths of 0.1
                        np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-11, err_msg=field)
                        self.assertTrue(wanted.any() or (name, field) == ("line", "vorticity"))
                    u, c = result.field("U", "0"), result.field("c", "0")
                    np.testing.assert_allclose(result.field("Ma", "0"), np.linalg.norm(u, axis=1) / c, rtol=1e-13)

    def test_ranks(self):
        """The same bits on any number of ranks and after a restart, and in every file of the other function objects; a run without
        them writes the same state."""
        for name, more in (("lattice", ""), ("polyhedral", "meshEngine polyhedral; polyReconstruct linear;\n")):
            where = "0.51 0.63 0.01"
            one, two, bare = (self.path(name + part) for part in ("1", "3", "bare"))
            for path in (one, two, bare):
                box(path, (70, 65, 1), OBJECTS.format(ALL, READERS.format(where)) if path != bare else "", original=False, width=0.02)
                runs.add(path, "system/fvSchemes", more)
            harness.program("granularGas", "-case", one)
            harness.program("granularGas", "-case", two, ranks=3)
            harness.program("granularGas", "-case", bare)
            part = runs.until(one, self.path(name + "part"), "0.001")
            harness.program("granularGas", "-case", part)
            for time in runs.times(one)[1:]:
                first = runs.contents(os.path.join(one, time))
                self.assertTrue({"Ma", "vorticity", "gradAlpha", "Kn", "c", "vorticityMean"} <= set(first))
                runs.same(self, first, runs.contents(os.path.join(two, time)), f"{name} {time} ranks")
                runs.same(self, first, runs.contents(os.path.join(part, time)), f"{name} {time} restart")
                without = runs.contents(os.path.join(bare, time))
                self.assertFalse({"Ma", "vorticity"} & set(without))
                for field in runs.FIELDS:
                    self.assertEqual(first[field], without[field], field)
            runs.same(self, runs.contents(os.path.join(one, "postProcessing")), runs.contents(os.path.join(two, "postProcessing")), name)
            self.agree(harness.haff.Case(one), runs.times(one)[-1])

    def agree(self, result, time):
        """What others write of them is what stands in the time folder."""
        omega, kn = result.field("vorticity", time), result.field("Kn", time)
        at = {n: os.path.join(result.path, "postProcessing", n, "0") for n in ("spots", "extreme", "whole")}
        with open(os.path.join(at["whole"], "volFieldValue.dat")) as f:
            row = [float(w.strip("()")) for w in f.read().splitlines()[-1].split()]
        np.testing.assert_allclose(row[1:], [*omega.mean(axis=0), kn.mean()], rtol=1e-11, atol=1e-11)
        with open(os.path.join(at["extreme"], "fieldMinMax.dat")) as f:
            lines = [line.split("\t") for line in f.read().splitlines() if "\tvorticity\t" in line]
        cells = [[self.cell_at(result, line[k]) for k in (3, 5)] for line in lines]
        length = np.linalg.norm(omega, axis=1)
        np.testing.assert_allclose([float(lines[-1][k]) for k in (2, 4)], (length.min(), length.max()), rtol=1e-11)
        np.testing.assert_allclose(length[cells[-1]], (length.min(), length.max()), rtol=1e-11)
        with open(os.path.join(at["spots"], "Kn")) as f:
            self.assertLess(np.abs(kn / float(f.read().split()[-1]) - 1).min(), 1e-11)

    def cell_at(self, result, place):
        """The cell whose centre is a place `(x y z)`."""
        off = np.linalg.norm(result.centres - [float(w) for w in place.strip("()").split()], axis=1)
        self.assertLess(off.min(), 1e-9)
        return off.argmin()

    def test_checksums(self):
        """A spoilt file of theirs is found by a restart, as that of any other field."""
        path = self.path("spoilt")
        box(path, (12, 10, 1))
        harness.program("granularGas", "-case", path)
        last = runs.times(path)[-1]
        with open(os.path.join(path, last, "vorticity"), "r+b") as f:
            f.seek(-200, os.SEEK_END)
            f.write(b"?")
        harness.edit(path, CONTROL, endTime=0.003)
        said = harness.program("granularGas", "-case", path, check=False)
        self.assertEqual(said.returncode, 1)
        self.assertIn(f"{last}/vorticity", said.stderr)

    def test_perfect_gas(self):
        """A gas without grains has no mean free path; it has a vorticity."""
        path = self.path("perfect")
        box(path, (12, 10, 1), eos="perfectGas")
        said = harness.program("checkCase", path, check=False)
        self.assertEqual(said.returncode, 1)
        self.assertRegex(said.stderr, r"system/controlDict:\d+: key 'objects' .*no field 'Kn' here: a gas without grains has no mean free path")
        harness.edit(path, CONTROL, objects="(vorticity)")
        harness.program("checkCase", path)


if __name__ == "__main__":
    unittest.main()
