# SPDX-License-Identifier: GPL-3.0-or-later
"""granularMD among rough walls, by the coefficients of JohnsonJacksonSlip: stress and heat of a sheared layer, forces, restarts to the bit, errors."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.grains import test_particles as hard
from tests.cases.grains.test_inlets import counts

ROUGH = "{{ type JohnsonJacksonSlip; specularityCoefficient {}; restitutionCoefficient {}; value uniform {}; }}"


def layer(case, phi=0.1, wall=0.95, speed=1, particles="", **options):
    """Elastic disks between two rough walls that move apart along themselves."""
    hard.make(case, **{"cells": (4, 8, 1), "size": (80.0, 20.0, 1.0), "types": {"x": "cyclic", "y": "wall"}, "alpha": 0.2, "T": 0.8, "e": 1, "particles": particles, **options})
    for patch, sign in (("yLow", -1), ("yHigh", 1)):
        for name, value in (("U", f"({sign * speed} 0 0)"), ("T", "1")):
            harness.dictionary.edit(os.path.join(case, "0", name), {f"boundaryField/{patch}": ROUGH.format(phi, wall, value)})
    return case


class RoughGrains(harness.Folder, unittest.TestCase):
    def case(self, name, **options):
        return layer(os.path.join(self.folder, name), **options)

    def test_stress(self):
        """Impacts give the walls phi m s/(1 - phi/2) each on average, with the slip s of the gas: those that come slip by s/(1 - phi/2) (Maxwell 1879). Impacts take (1 - e^2) m T of the motion across the wall."""
        phi, H, V = 0.1, 20, 1
        case = self.case("layer", end=4000, interval=4000, particles="coarseGraining { samples 2000; }\n", control="maxDeltaT 200;\n")
        said = hard.solve(case)
        self.assertLess(abs(float(re.findall(r"balance ([-+\d.e]+)", said)[-1])), 1e-11)
        U = harness.haff.Case(case).field("U", "4000")[:, 0].reshape(-1, 4).mean(axis=1)
        slope, middle = np.polyfit((np.arange(1, 7) + 0.5) * H / 8 - H / 2, U[1:-1], 1)
        slip = V - middle - slope * (H / 2 - 0.5)  # where the centres are
        self.assertGreater(slip, 0.5)
        rows, at = counts(case)
        sums = rows[-1] - rows[1]
        drag = (sums[at["impulse_yLow_x"]] - sums[at["impulse_yHigh_x"]]) / sums[at["wallCollisions"]]
        self.assertAlmostEqual(drag / (phi * slip / (1 - phi / 2)), 1, delta=0.05)
        work = V * (sums[at["impulse_yLow_x"]] - sums[at["impulse_yHigh_x"]])
        T = harness.haff.Case(case).field("TComponents", "4000")[:, 1].reshape(-1, 4).mean(axis=1)
        taken = (sums[at["lost"]] + work) / sums[at["wallCollisions"]]
        self.assertAlmostEqual(taken / ((1 - 0.95**2) * (T[0] + T[-1]) / 2), 1, delta=0.03)

    def test_forces(self):
        """The drag is part of what forces has: times the steps it is the impulse of grains.dat."""
        forces = "functions { force { type forces; patches (yLow); CofR (0 0 0); } flow { type surfaceFieldValue; patches (yLow yHigh); operation sum; fields (phi); } }\n"
        case = self.case("forces", phi=0.5, e=0.9, size=(20.0, 10.0, 1.0), threshold=0.001, end=40, interval=40, control="maxDeltaT 1;\n" + forces.split(" flow")[0] + " }\n")
        hard.solve(case)
        rows, at = counts(case)
        with open(os.path.join(case, "postProcessing", "force", "0", "force.dat")) as f:
            force = np.array([[float(word) for word in line.replace("(", " ").replace(")", " ").split()] for line in f if not line.startswith("#")])
        self.assertEqual(len(force), len(rows) - 1)
        sums = (force[:, 1] * np.diff(rows[:, 0])).sum()
        self.assertAlmostEqual(sums, rows[-1, at["impulse_yLow_x"]], delta=1e-9 * abs(sums))

    def test_restart(self):
        """A run in two parts has the bits of one; with the coefficient 0 walls are smooth."""
        options = dict(phi=0.6, e=0.9, size=(20.0, 10.0, 1.0), threshold=0.001, end=8, interval=4)
        one = self.case("one", **options)
        two = shutil.copytree(one, os.path.join(self.folder, "two"))
        hard.solve(one)
        harness.edit(two, "system/controlDict", endTime=4)
        hard.solve(two)
        harness.edit(two, "system/controlDict", endTime=8)
        self.assertIn("to the bit", hard.solve(two))
        a, b = hard.results(one, "8"), hard.results(two, "8")
        for name in a:
            if name != "uniform/provenance":
                self.assertEqual(a[name], b[name], name)
        smooth, slips = self.case("smooth", **{**options, "phi": 0}), self.case("slips", **{**options, "phi": 0})
        for patch in ("yLow", "yHigh"):
            harness.dictionary.edit(os.path.join(slips, "0", "U"), {f"boundaryField/{patch}": "{ type slip; }"})
            harness.dictionary.edit(os.path.join(slips, "0", "T"), {f"boundaryField/{patch}": "{ type granularWall; restitution 0.95; }"})
        for case in (smooth, slips):
            hard.solve(case)
        for name in ("alpha", "U", "T", "p"):
            np.testing.assert_array_equal(harness.haff.Case(smooth).field(name, "8"), harness.haff.Case(slips).field(name, "8"))

    def test_refused(self):
        for n, (name, rule, text) in enumerate((
                ("U", "{ type noSlip; }", r"0/U:\d+: patch yLow: type is noSlip; walls of grains are smooth or rough: use  slip;  or  JohnsonJacksonSlip;"),
                ("U", ROUGH.format(0.1, 0.95, "(0 1 0)"), r"0/U:\d+: patch yLow: a wall moves along itself, but this value leads across a face"),
                ("U", ROUGH.format(0.1, 0.95, '(1 0 0); expression ("x" "0" "0")'), r"0/U:\d+: patch yLow: rough walls of grains move as a whole: give  value uniform"),
                ("U", ROUGH.format(0.2, 0.95, "(1 0 0)"), r"patch yLow: U and T have other coefficients of impacts: give the same"),
                ("U", "{ type slip; }", r"0/T:\d+: patch yLow: U is 'slip', a wall; walls of grains give no heat: T cannot be 'JohnsonJacksonSlip'"),
                ("T", "{ type granularWall; restitution 0.9; }", r"patch yLow: U and T have other coefficients of impacts"))):
            case = self.case(f"refused {n}", size=(20.0, 10.0, 1.0))
            harness.dictionary.edit(os.path.join(case, "0", name), {"boundaryField/yLow": rule})
            done = harness.program("granularMD", "-case", case, check=False)
            self.assertEqual(done.returncode, 1, text)
            self.assertRegex(done.stderr, text)


if __name__ == "__main__":
    unittest.main()
