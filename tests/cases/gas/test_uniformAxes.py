# SPDX-License-Identifier: GPL-3.0-or-later
"""Axes along which a run is uniform are computed on one layer of cells, and no output shows it: every byte that a run writes
is that of the full computation, on any number of ranks. One bit in one cell brings the full computation back."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs

boxes = harness.boxes
N = (26, 30, 4)  # cells: two blocks of tiles along x and along y
TRANSPORT = "transport GarzoDufty; GarzoDuftyCoeffs { alphaMin 1e-2; }\n"
BUDGET = "    budget { type energyBudget; }\n"
TABLES = runs.TABLES.format("0.31 0.2 0.05", "2.1 2.9 0.05").replace("{\n", "{\n" + BUDGET, 1)


def edit_list(path, change):
    """change(values), an array, of the first list of a field in ascii."""
    with open(path) as f:
        lines = f.read().split("\n")
    first = lines.index("(") + 1
    last = lines.index(")", first)
    values = np.array([float(line) for line in lines[first:last]])
    change(values)
    lines[first:last] = ["%.17g" % v for v in values]
    with open(path, "w") as f:
        f.write("\n".join(lines))


class UniformAxes(harness.Folder, unittest.TestCase):
    def make(self, name, n=N, end=0.06, along="xz", slope=0.0, wall="slip", heat="zeroGradient", more="", fast=False,
             **options):
        """A column that falls through a cooling gas onto its floor and slides; uniform but for a slope along z. Or two
        that collide fast in a near vacuum."""
        n, size = np.array(n), 0.1 * np.array(n)
        at = boxes.centres(n, size)
        y, z = at[:, 1] / size[1], at[:, 2] / size[2]
        rho = np.where(y < 0.6, 300.0, 3.0) * (1 + slope * np.sin(2 * np.pi * z))
        u = np.stack([2 * np.sin(3 * y), -1 - y, np.cos(5 * y)], axis=1)  # also along an axis that the mesh lacks
        if fast:
            rho = np.where((np.abs(y - 0.2) < 0.1) | (np.abs(y - 0.7) < 0.1), 800.0, 1e-5)
            u[:, 1] = np.where(y < 0.5, 80, -80)
        case = harness.box_case(os.path.join(self.folder, name), n, size, rho, u, rho, end, e=0.8, cooling="Haff",
                                gravity=(0.0, -30.0, 0.0), types={a: "cyclic" for a in along}, interval=end / 4,
                                **{"eos": "TorquatoSpheres", **options})
        os.remove(os.path.join(case, "0", "p"))
        rest = "".join(f'\n"{a}.*" ' + ("empty" if k == 1 else "cyclic" if a in along else "zeroGradient")
                       for a, k in zip("xz", n[::2]))
        for field, values, rule in (("U", u, wall), ("rho", rho, "zeroGradient"), ("T", np.where(y < 0.3, 0.3, 0.05), heat)):
            boxes.write_field(case, field, values, f'"y.*" {rule}{rest}')
        runs.add(case, "system/controlDict", TABLES.replace(BUDGET, "") if fast else TABLES)
        if more:
            path = os.path.join(case, "constant", "granularProperties")
            with open(path) as f:
                text = f.read()
            with open(path, "w") as f:
                f.write(text.replace("transport none;", more))
        return case

    def pair(self, case, computed, ranks, but=()):
        """Runs in full, then as found on that number of ranks; the log says how many cells are computed. Files of the names `but` may differ.
        Returns the full case and the last log."""
        full = shutil.copytree(case, case + "_full")
        runs.add(full, "system/fvSolution", "skipUniformAxes no;\n")
        self.assertNotIn("uniform along", harness.program("granularGas", "-case", full).stdout)
        def results(case):
            return {name: text for name, text in runs.results(case).items() if os.path.basename(name) not in but}
        wanted = results(full)
        for count in ranks:
            copy = shutil.copytree(case, f"{case}_{count}/{os.path.basename(full)}")
            log = harness.program("granularGas", "-case", copy, ranks=count).stdout
            self.assertEqual(re.findall(r"uniform along (.*) are computed", log), [computed] if computed else [])
            runs.same(self, wanted, results(copy), f"{count} ranks")
        return full, log

    def test_inviscid(self):
        """Two axes, one because of the state, one because of the mesh, and the plane; shaken, heated."""
        full, _ = self.pair(self.make("column"), "x and z: 30 of 3120 cells", (1, 4))
        self.assertIn("postProcessing/budget/0/energyBudget.dat", runs.results(full))
        self.assertIn("VTK/column_full.vtk.series", runs.results(full))
        self.pair(self.make("sloped", slope=0.1), "x: 120 of 3120 cells", (2,))
        self.pair(self.make("open", along="x"), "x: 120 of 3120 cells", (1,))
        case = self.make("plane", n=(26, 70, 1), more="sources (uniformHeating); uniformHeatingCoeffs { rate 3; }\n")
        boxes.write_dictionary(case, "constant", "shaking", "type sinusoidal; frequency 60; amplitude 3;\n")
        self.pair(case, "x: 70 of 1820 cells", (1,))
        for name, last, computed in (("lid", "(0 -1 3)", "x: 70 of 1820 cells"), ("torn", "(0 -1 3.5)", "")):
            wall = "zeroGradient\nyHigh fixedValue; value nonuniform List<vector> 26 (%s)" % ("(0 -1 3) " * 25 + last)
            self.pair(self.make(name, n=(26, 70, 1), wall=wall), computed, (1,))

    def test_limited(self):
        """Cells that are limited and filled are counted on the whole mesh. Only what the floors add is summed in another
        order, so that its last digit may differ: that is in the budget, which is left out here, and in uniform/limiter."""
        case = self.make("limited", fast=True, end=0.003)
        runs.add(case, "system/fvSolution", "limits { alphaFloor 5e-9; }\n")
        full, log = self.pair(case, "x and z: 30 of 3120 cells", (2,), but=("limiter", "checksums"))
        table = np.loadtxt(os.path.join(full, "postProcessing", "limiter", "0", "limiter.dat"), ndmin=2)
        self.assertGreater(table[:, 2].sum(), 0)
        self.assertGreater(table[:, 10].sum(), 0)
        self.assertEqual(harness.haff.Case(full).field("limited").sum(), table[:, 2].sum())
        said = re.findall(r"limited: .*\(in all (\d+) faces, (\d+) cells\)", log)[-1]
        self.assertEqual([int(v) for v in said], [table[:, 3].sum(), table[:, 2].sum()])

    def test_transport(self):
        """Walls that rub and heat, also by values that differ along x."""
        self.pair(self.make("viscous", wall="noSlip", heat="fixedValue; value uniform 0.5", more=TRANSPORT),
                  "x and z: 30 of 3120 cells", (1, 2))
        values = " ".join("%g" % (1 + i % N[0]) for i in range(N[0] * N[2]))
        case = self.make("heated", wall="translatingWallVelocity; U (0 0 3)", more=TRANSPORT, end=0.01,
                         heat=f"fixedValue; value nonuniform List<scalar> {N[0] * N[2]} ({values})")
        self.pair(case, "z: 780 of 3120 cells", (1,))

    def test_expression(self):
        """The points of gmsh differ in the last digit; an expression in y is uniform along x all the same."""
        case = harness.copy("couetteDisks", self.folder)
        harness.mesh(case, 40)
        self.assertIn("uniform along x: 40 of 160 cells are computed", harness.program("checkCase", case).stdout)

    def test_broken(self):
        """A run goes on from a state with one bit changed, or with a row changed, or as it was."""
        case = self.make("broken", more=TRANSPORT, wall="noSlip", format="ascii", digits=17)
        harness.program("granularGas", "-case", case)
        half = runs.until(case, case + "_half", 0.03)
        shutil.copytree(half, case + "_again")
        self.assertIn("uniform along x and z", harness.program("granularGas", "-case", case + "_again").stdout)
        for name in ("0.045", "0.06"):
            runs.same(self, *(runs.contents(os.path.join(c, name)) for c in (case, case + "_again")), name)
        os.remove(os.path.join(half, "0.03", "uniform", "checksums"))
        bit = shutil.copytree(half, case + "_bit")

        def one_bit(values):
            values[1234] = np.nextafter(values[1234], np.inf)
        edit_list(os.path.join(bit, "0.03", "rhoE"), one_bit)
        self.pair(bit, None, (1,))
        row = shutil.copytree(half, case + "_row")

        def one_row(values):
            values.reshape(N[::-1])[1, 7] *= 1.001
        for name in ("rhoU", "rhoE"):
            os.remove(os.path.join(row, "0.03", name))
        edit_list(os.path.join(row, "0.03", "T"), one_row)
        self.pair(row, "x: 120 of 3120 cells", (2,))


if __name__ == "__main__":
    unittest.main()
