# SPDX-License-Identifier: GPL-3.0-or-later
"""haff.compare: differences on the coarser mesh are those of exact means over its cells, whatever the two meshes are."""
import os
import shutil
import sys
import tempfile
import unittest
import unittest.mock

import numpy as np

from tests.cases import harness
from tests.cases.harness import BIN, boxes, haff
from haff.runs import compare as module
from studies.made import triangles


class Compared(unittest.TestCase):
    size = (1.2, 0.6, 0.1)

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="haff")

    def tearDown(self):
        shutil.rmtree(self.folder)

    def box(self, name, n, fields, size=None, hole=None, time="0.5"):
        """A case of boxes; fields: {name: values, or a function of the centres}."""
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.join(path, "system"), exist_ok=True)
        boxes.write_mesh(path, n, size or self.size, hole=hole)
        keep = slice(None) if hole is None else ~hole
        for field, values in fields.items():
            boxes.write_field(path, field, values(boxes.centres(n, size or self.size))[keep] if callable(values) else values, time=time)
        return haff.Case(path)

    @staticmethod
    def blocks(values, n, by):
        """Means of blocks of by[0] x by[1] cells, x fastest."""
        a = values.reshape(n[1] // by[1], by[1], n[0] // by[0], by[0])
        return a.mean(axis=(1, 3)).ravel()

    def test_norms(self):
        """A fine grid beside a coarse one: L1, L2, max and their place are those of the means of blocks."""
        random = np.random.default_rng(1)
        fine, coarse = random.normal(size=72), random.normal(size=12)
        a = self.box("coarse", (4, 3, 1), {"T": coarse})
        b = self.box("fine", (12, 6, 1), {"T": fine})
        means = self.blocks(fine, (12, 6), (3, 2))
        for one, other, sign in ((a, b, 1), (b, a, -1)):
            found = haff.compare(one, other)
            row = {name: values[0] for name, values in found.columns.items()}
            far = np.abs(coarse - means)
            self.assertEqual((row["field"], row["time"]), ("T", 0.5))
            np.testing.assert_allclose([row["L1"], row["L2"], row["max"]], [far.mean(), np.sqrt((far**2).mean()), far.max()], rtol=1e-13)
            np.testing.assert_allclose([row[x] for x in "xyz"], boxes.centres((4, 3, 1), self.size)[far.argmax()], atol=1e-14)
            self.assertAlmostEqual(row["scale"], np.ptp(coarse if sign > 0 else means), places=13)
            self.assertEqual(row["covered"], 1)
            centres, first, second = found.values("T", 0.5)
            np.testing.assert_allclose(sign * (first - second), coarse - means, atol=1e-14)
            self.assertEqual(centres.shape, (12, 3))

    def test_lines_that_do_not_meet(self):
        """7 x 5 cells on 3 x 2: the integral is kept, and the first cell's mean is that of the parts of cells that it holds."""
        values = np.random.default_rng(2).normal(size=35)
        found = haff.compare(self.box("a", (3, 2, 1), {"T": np.zeros(6)}), self.box("b", (7, 5, 1), {"T": values}))
        moved = found.values("T")[2]
        self.assertAlmostEqual(moved.mean(), values.mean(), places=14)
        x = np.linspace(0, 1, 8)
        row = [np.interp(1 / 3, x, np.append(0, np.cumsum(r) / 7)) * 3 for r in values.reshape(5, 7)]  # means of the first third of each row
        self.assertAlmostEqual(moved[0], (row[0] + row[1] + row[2] / 2) / 2.5, places=13)

    def test_vectors_have_lengths(self):
        u = np.tile([3.0, 4.0, 0.0], (12, 1))
        found = haff.compare(self.box("a", (4, 3, 1), {"U": u}), self.box("b", (8, 6, 1), {"U": np.zeros((48, 3))}), "U")
        for name in ("L1", "L2", "max", "scale"):
            self.assertAlmostEqual(found.columns[name][0], 5, places=14)
        self.assertAlmostEqual(found.columns["relative"][0], 1, places=14)

    def test_equal_meshes_keep_their_bits(self):
        values = np.random.default_rng(4).normal(size=12)
        found = haff.compare(self.box("a", (4, 3, 1), {"T": values}), self.box("b", (4, 3, 1), {"T": values}))
        self.assertEqual((found.columns["L1"][0], found.columns["max"][0]), (0, 0))

    def test_thickness_does_not_matter(self):
        """Disks and a gas have one cell across the plane, each of its own thickness."""
        found = haff.compare(self.box("a", (4, 3, 1), {"T": np.full(12, 2.0)}),
                             self.box("b", (8, 3, 1), {"T": np.full(24, 1.5)}, size=(1.2, 0.6, 7.0)))
        self.assertAlmostEqual(found.columns["L1"][0], 0.5, places=14)
        self.assertEqual(found.columns["covered"][0], 1)

    def test_holes_and_other_extents(self):
        """Cells that the other mesh does not cover in full are left out."""
        hole = np.zeros(48, bool)
        hole[[0, 27]] = True  # in the coarse cells 0 and 5
        fine = self.box("b", (8, 6, 1), {"T": lambda x: np.ones(len(x))}, hole=hole)
        found = haff.compare(self.box("a", (4, 3, 1), {"T": np.full(12, 1.25)}), fine)
        self.assertAlmostEqual(found.columns["covered"][0], 10 / 12, places=14)
        self.assertAlmostEqual(found.columns["L2"][0], 0.25, places=14)
        long = self.box("c", (16, 6, 1), {"T": np.ones(96)}, size=(1.8, 0.6, 0.1))
        self.assertEqual(haff.compare(self.box("a", (4, 3, 1), {"T": np.ones(12)}), long).columns["covered"][0], 1)
        short = self.box("d", (6, 6, 1), {"T": np.ones(36)}, size=(0.8, 0.6, 0.1))
        self.assertAlmostEqual(haff.compare(self.box("a", (4, 3, 1), {"T": np.ones(12)}), short).columns["covered"][0], 6 / 12, places=14)  # 0.8 of 0.3 each

    def test_cells_of_no_value(self):
        """Cells without grains have no temperature."""
        fine = np.ones(48)
        fine[0] = np.nan
        found = haff.compare(self.box("a", (4, 3, 1), {"T": np.zeros(12)}), self.box("b", (8, 6, 1), {"T": fine}))
        self.assertAlmostEqual(found.columns["covered"][0], 11 / 12, places=14)
        self.assertAlmostEqual(found.columns["L1"][0], 1, places=14)

    def test_times_and_fields(self):
        a = self.box("a", (4, 3, 1), {"T": np.zeros(12), "p": np.zeros(12)})
        self.box("a", (4, 3, 1), {"T": np.ones(12)}, time="1")
        b = self.box("b", (4, 3, 1), {"T": np.full(12, 3.0), "p": np.ones(12)}, time="0.50000000001")
        self.assertEqual(haff.compare(a, b).columns["field"].tolist(), ["T", "p"])
        self.box("b", (4, 3, 1), {"T": np.ones(12)}, time="1")
        found = haff.compare(a.path, b.path)
        self.assertEqual(list(zip(found.columns["time"], found.columns["field"], found.columns["L1"])), [(0.5, "T", 3), (1, "T", 0)])
        self.assertEqual(haff.compare(a, b, "T", times=[1]).columns["L1"].tolist(), [0])
        for wrong, what in ((dict(fields="Q"), "no field Q in .*/0.5"), (dict(fields=["T", "p"]), "no field p in .*/1"), (dict(times=[0.7]), "0.7 is not in both")):
            with self.assertRaisesRegex(ValueError, what):
                haff.compare(a, b, **wrong)
        with self.assertRaisesRegex(ValueError, "no time in common: 0.5, 1; 2"):
            haff.compare(a, self.box("c", (4, 3, 1), {"T": np.ones(12)}, time="2"))
        with self.assertRaises(FileNotFoundError):
            haff.compare(a, os.path.join(self.folder, "nowhere"))

    def drawn(self, found):
        """The figure of a comparison, before it is closed."""
        from haff.plot.figures import plt
        with unittest.mock.patch("haff.plot.figures.plt.close"):
            found.draw(os.path.join(self.folder, "f.png"))
            figure = plt.gcf()
        plt.close("all")
        return figure

    def test_the_figure_shows_the_plane_of_the_mesh(self):
        """A mesh in y and z is drawn over y and z, one in x and z over these; each with its own values."""
        T = np.arange(12.0)
        for n, names in (((1, 4, 3), "yz"), ((4, 1, 3), "xz"), ((4, 3, 1), "xy")):
            a, b = (self.box(f"{names}{k}", n, {"T": T + k}) for k in (0, 1))
            first = self.drawn(haff.compare(a, b)).axes[0]
            self.assertEqual((first.get_xlabel(), first.get_ylabel()), tuple(f"${name}$ (m)" for name in names))
            np.testing.assert_array_equal(first.collections[0].get_array().ravel(), T)

    def test_the_figure_has_time_and_units(self):
        figure = self.drawn(haff.compare(self.box("a", (4, 3, 1), {"T": np.zeros(12)}), self.box("b", (4, 3, 1), {"T": np.full(12, 0.1)})))
        self.assertIn(" s", figure._suptitle.get_text())
        self.assertEqual([ax.get_title() for ax in figure.axes[:3]], ["T (m^2/s^2), a", "T (m^2/s^2), b", "T (m^2/s^2), difference"])
        self.assertEqual(figure.axes[0].get_xlabel(), "$x$ (m)")

    def test_table(self):
        found = haff.compare(self.box("a", (4, 3, 1), {"T": np.zeros(12)}), self.box("b", (4, 3, 1), {"T": np.full(12, 0.1)}))
        self.assertEqual(float(found.table["L1"][0]), found.columns["L1"][0])
        with unittest.mock.patch.dict(sys.modules, {"pandas": None}):  # as if it were not installed
            self.assertIsInstance(found.table, np.ndarray)
            self.assertEqual(found.table.dtype.names, tuple(found.columns))
            self.assertEqual(found.table["field"].tolist(), ["T"])
        path = os.path.join(self.folder, "t.csv")
        found.write(path)
        with open(path) as f:
            head, row = f.read().splitlines()
        self.assertEqual(head, "time,field,L1,L2,max,scale,relative,x,y,z,covered")
        self.assertEqual(float(row.split(",")[2]), found.columns["L1"][0])

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_meshes_without_order(self):
        """Triangles beside boxes, both ways: constants are the same, and the means of a linear function are off by less than a cell."""
        path = os.path.join(self.folder, "triangles")
        os.makedirs(os.path.join(path, "system"))
        triangles.make(path, 1.0, 12, os.path.join(BIN, "gmshToCase"))
        case = haff.Case(path)
        self.assertIsNone(case.lattice())
        low = case.mesh.points.min(axis=0)
        linear = lambda x: 2 * (x[:, 0] - low[0])
        boxes.write_field(path, "T", linear(case.centres), time="0.5")
        boxes.write_field(path, "rho", np.full(case.mesh.cells, 4.0), time="0.5")
        for n in (6, 40):
            shift = lambda x: 2 * x[:, 0]
            box = self.box(f"box{n}", (n, n, 1), {"T": shift, "rho": np.full(n * n, 4.0)}, size=(1, 1, 0.1))
            box.mesh.points[:, :2] += low[:2]
            found = haff.compare(box, case)
            row = dict(zip(found.columns["field"], zip(found.columns["L1"], found.columns["max"], found.columns["covered"])))
            self.assertLess(row["rho"][1], 1e-13)
            self.assertAlmostEqual(row["rho"][2], 1, places=12)
            h = max(1 / 12, 1 / n)
            self.assertLess(row["T"][1], 2 * h)
            self.assertLess(row["T"][0], 0.5 * h)

    def test_figures(self):
        """Lines, a plane, the middle of a box; a mesh without order in three dimensions is refused with a word of what draws it."""
        for n, name in (((6, 1, 1), "line.png"), ((4, 3, 1), "plane.svg"), ((4, 3, 2), "box.pdf")):
            T = np.arange(np.prod(n)) / 7
            a, b = (self.box(f"{name}{k}", n, {"T": T + k, "U": np.stack([T] * 3, 1)}) for k in (0, 1))
            path = os.path.join(self.folder, name)
            haff.compare(a, b, figure=path)
            with open(path, "rb") as f:
                self.assertIn({"png": b"PNG", "svg": b"<svg", "pdf": b"%PDF"}[name[-3:]], f.read(2000))
        sheared = haff.Case(a.path)
        sheared.mesh.points[:, 0] += 0.1 * sheared.mesh.points[:, 1]
        sheared.mesh.__dict__.pop("lattice", None)
        with self.assertRaisesRegex(ValueError, "haffPlot"):
            haff.compare(sheared, sheared, figure=os.path.join(self.folder, "x.png"))

    def test_command(self):
        a = self.box("a", (4, 3, 1), {"T": np.zeros(12)})
        b = self.box("b", (4, 3, 1), {"T": np.full(12, 0.1)})
        run = lambda *words: harness.command("compare", *words, cwd=self.folder)
        done = run(a.path, b.path, "-csv", "t.csv", "-o", "f.png")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.splitlines()[1].split()[:3], ["0.5", "T", "0.1"])
        self.assertTrue({"t.csv", "f.png"} <= set(os.listdir(self.folder)))
        path = os.path.join(b.path, "0.5", "T")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("[0 2 -2 0 0 0 0]", "[0 0 0 1 0 0 0]"))
        done = run(a.path, b.path)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"^note: T has the unit m\^2/s\^2 in a and K in b: .*convert one of both first\n$")
        done = run(a.path, b.path, "Q")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "^haff compare: there is no field Q")


class Rebinned(unittest.TestCase):
    def test_exact_means(self):
        """Of random cells on random lines: the overlaps, one by one."""
        random = np.random.default_rng(5)
        old, new = np.sort(random.random(9)), np.sort(random.random(5) * 1.4 - 0.2)
        values = random.normal(size=(3, 8))
        found = module.rebinned(values, old, new, 1)
        for i in range(4):
            share = np.clip(np.minimum(new[i + 1], old[1:]) - np.maximum(new[i], old[:-1]), 0, None)
            np.testing.assert_allclose(found[:, i], values @ share / (new[i + 1] - new[i]), atol=1e-14)


if __name__ == "__main__":
    unittest.main()
