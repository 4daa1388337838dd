# SPDX-License-Identifier: GPL-3.0-or-later
"""haff scaling counts what ranks send each other, knows it beforehand on lattices, and projects times by its formula."""
import math
import os
import subprocess
import unittest

import numpy as np

from tests.cases import harness

from haff.paths import program
from studies import scaling
from studies.made import boxes


def lattice(case, n, speed=0.1, **options):
    """A periodic box of gas that is disturbed everywhere; at 0.1 m/s without shocks, at 0.3 m/s with some."""
    random, cells = np.random.default_rng(3), math.prod(n)
    u = speed * random.standard_normal((cells, 3)) * (np.array(n) > 1)
    return boxes.box_case(case, n, [0.1 * k for k in n], 1 + 0.2 * random.random(cells), u, 1 + 0.1 * random.random(cells), 1000.0,
                          types={k: "cyclic" for k in "xyz"}, binary=True, **options)


class Counted(harness.Folder, unittest.TestCase):
    def test_lattice(self):
        """On 2, 3 and 4 ranks every rank's messages and bytes of a step are those that the set-up of one rank foretells from another number."""
        case = lattice(os.path.join(self.folder, "box"), (150, 130, 1))
        counted = {n: scaling.count(case, n, 4, 2)[0] for n in (1, 2, 3, 4)}
        self.assertEqual((counted[1].most("messages"), counted[1].most("sent")), (0, 0))
        for model in self.foretold(case, counted):
            self.assertEqual(model.exchanges, 3, "one exchange for each stage of SSPRK3")
            self.assertEqual(model.width, 3 * 3 * 4 * 8, "three stages, three layers, four variables of eight bytes")
        self.assertEqual(sorted(os.listdir(case)), ["0", "constant", "system"])

    def test_shocks(self):
        """A step with shocks has two exchanges more, one layer each: the state, and the speeds of the fronts along two axes."""
        case = lattice(os.path.join(self.folder, "box"), (150, 130, 1), 0.3)
        counted = {n: scaling.count(case, n, 4, 2)[0] for n in (2, 3, 4)}
        for model in self.foretold(case, counted):
            share = (model.exchanges - 3) / 2
            self.assertIn(share, (0.25, 0.5, 0.75, 1), "of the four steps")
            self.assertEqual(model.width, 3 * 3 * 4 * 8 + share * (4 + 2) * 8)

    def foretold(self, case, counted):
        for known in (2, 3, 4):
            model = scaling.Lattice(case, counted[known], known)
            for n in (2, 3, 4):
                rank = model.rank(n)[1]
                self.assertEqual((rank.messages, rank.sent), (counted[n].most("messages"), counted[n].most("sent")), f"{n} ranks from {known}")
            yield model

    def test_reductions(self):
        """Every rank takes part in as many reductions, two a step at least, and the table has its memory."""
        plain = scaling.count(lattice(os.path.join(self.folder, "plain"), (70, 8, 1)), 2, 4, 2)[0]
        self.assertEqual({r.reductions for r in plain.ranks}, {plain.most("reductions")})
        self.assertGreaterEqual(plain.most("reductions"), 2)
        self.assertGreater(min(r.memory for r in plain.ranks), 5e6)

    def test_implicit(self):
        """What PETSc does in its module is counted, too: each iteration of implicit diffusion has reductions."""
        counted = {}
        for diffusion in ("RKJ2", "implicit"):
            case = lattice(os.path.join(self.folder, diffusion), (70, 8, 1))
            harness.edit(case, "constant/granularProperties", transport="GarzoDufty")
            with open(os.path.join(case, "system", "fvSolution"), "a") as f:
                f.write(f"diffusion {{ type {diffusion}; }}\n")
            try:
                counted[diffusion] = scaling.count(case, 2, 2, 1)[0].most("reductions")
            except scaling.Refused as e:
                if "PETSc" in str(e):
                    self.skipTest("built without PETSc")
                raise
        self.assertGreater(counted["implicit"], counted["RKJ2"] + 10)

    def test_failed(self):
        """A case that cannot be run says why, in the program's words."""
        case = lattice(os.path.join(self.folder, "wrong"), (70, 8, 1))
        harness.edit(case, "system/fvSchemes", fluxScheme="comon")
        with self.assertRaisesRegex(scaling.Refused, "on 2 ranks did not take 5 steps: .*fvSchemes.*comon"):
            scaling.run(case, 2, 5)


class SetUp(harness.Folder, unittest.TestCase):
    def box(self, n):
        scaling.write_box(self.folder, n)
        return self.folder

    def table(self, case, ranks):
        done = subprocess.run([program("bench_setup"), "-case", case, str(ranks), "-all"], capture_output=True, text=True)
        return np.array([[int(v) for v in line.split(",")] for line in done.stdout.split("\n")[1:-1]])

    def test_shares_add_up(self):
        """All cells are dealt, all tiles too, and every rank is there, in two and in three dimensions, and with more ranks than tiles."""
        for n, ranks, tiles in (((240, 180, 1), 5, 12), ((48, 72, 24), 3, 4), ((60, 60, 1), 3, 1)):
            rows = self.table(self.box(n), ranks)
            self.assertEqual(rows[:, 0].tolist(), list(range(ranks)))
            self.assertEqual((rows[:, 1].sum(), rows[:, 2].sum()), (math.prod(n), tiles))
            share = scaling.shares(self.folder, ranks)
            self.assertEqual((share.cells, share.neighbours, share.sent), tuple(rows[:, k].max() for k in (1, 3, 4)))

    def test_two_halves(self):
        """Two ranks with a wall of 60 cells between them send these 60."""
        self.assertEqual(self.table(self.box((120, 60, 1)), 2)[:, 1:].tolist(), [[3600, 1, 1, 60]] * 2)

    def test_many(self):
        """1.5e9 cells on 1024 ranks: one rank's share in seconds, without the others."""
        case = self.box((1152, 1152, 1152))
        done = subprocess.run([program("bench_setup"), "-case", case, "1024", "700"], capture_output=True, text=True, timeout=60)
        self.assertRegex(done.stdout, r"^1528823808 cells in 30276 tiles: rank 700 of 1024 has 1512704 cells in 33 tiles")

    def test_not_a_lattice(self):
        case = lattice(os.path.join(self.folder, "uneven"), (4, 1, 1))
        path = os.path.join(case, "constant", "polyMesh", "points")
        points = np.fromfile(path, np.uint8)
        values = points[-2 - 8 * 3 * 20:-2].view("<f8")
        values[3] += 0.03
        points.tofile(path)
        with self.assertRaisesRegex(scaling.Refused, "is no lattice"):
            scaling.shares(case, 2)


class Model(unittest.TestCase):
    def test_formula(self):
        """100 cells of 1 us, 4 messages and 2 reductions of 3 steps by 5 us, 800 bytes at 1e8 B/s."""
        rank = scaling.Rank(messages=4, sent=800, reductions=2)
        self.assertAlmostEqual(scaling.seconds(8, 100, rank, 1e-6, 5e-6, 1e8), 100e-6 + 20e-6 + 8e-6 + 30e-6, places=12)
        self.assertEqual(scaling.seconds(1, 100, scaling.Rank(), 1e-6, 5e-6, 1e8), 100 * 1e-6)

    def test_memory(self):
        counted = {n: scaling.Counted([scaling.Rank(memory=3e7 + 8e7 / n)] * n, 1.0) for n in (1, 2, 4)}
        a, b = scaling.memory_fit(counted)
        self.assertAlmostEqual(a, 3e7, delta=1)
        self.assertAlmostEqual(b, 8e7, delta=1)

    def test_other_meshes(self):
        """Beyond 4 ranks messages stay; bytes go with the surface: in two dimensions half of them at 16. A rank has whole blocks, one at least, or
        3 % more than the mean."""
        rank = scaling.Rank(messages=6, sent=1000, reductions=2)
        model = scaling.Other(10000, 2, 20, {1: scaling.Counted([scaling.Rank()], 1.0), 4: scaling.Counted([rank] * 4, 1.0)})
        self.assertEqual(model.rank(1), (10000, scaling.Rank()))
        cells, found = model.rank(16)
        self.assertEqual((found.messages, found.sent, found.reductions), (6, 500, 2))
        self.assertEqual((cells, model.rank(64)[0]), (1000, 500))
        self.assertAlmostEqual(model.rank(2)[0], 1.03 * 5000)

    def test_boxes(self):
        self.assertEqual([scaling.split(n, 2) for n in (1, 2, 12, 1024)], [[1, 1], [2, 1], [4, 3], [32, 32]])
        self.assertEqual([scaling.split(n, 3) for n in (8, 27, 1024)], [[2, 2, 2], [3, 3, 3], [16, 8, 8]])


class Command(harness.Folder, unittest.TestCase):
    def haff(self, *words):
        return harness.command("scaling", *words)

    def test_report(self):
        """The case stays as it was, and each table has its rows: counted, times, strong and weak."""
        case = lattice(os.path.join(self.folder, "box"), (126, 120, 1))
        said = self.haff(case, "-ranks", "1,2", "-project", "4,64", "-steps", "60", "-after", "2", "-latency", "1e-6", "-bandwidth", "1e9")
        self.assertEqual(said.returncode, 0, said.stderr)
        rows = [line for line in said.stdout.split("\n") if line.startswith("| ") and line[2].isdigit()]
        self.assertEqual([int(row.split("|")[1]) for row in rows], [1, 2, 1, 2][:len(rows) - 4] + [4, 64, 4, 64])
        self.assertIn("| 64 | 3780 | 6.0 |", said.stdout, "4 tiles are for 4 ranks")
        self.assertIn("| 64 | 9.683e+05 | 15498 |", said.stdout)
        self.assertEqual(sorted(os.listdir(case)), ["0", "constant", "system"])

    def test_refused(self):
        case = lattice(os.path.join(self.folder, "box"), (12, 12, 1))
        for words, why in ((("-latency", "-1"), "-latency"), (("-ranks", "0,2"), "-ranks"), (("-steps", "x"), "-steps"),
                           (("-ranks", "1"), "messages are counted on two ranks or more"), (("-ranks", "2", "-steps", "2"), "too few tiles")):
            done = self.haff(case, *words)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(why, done.stderr)
        self.assertRegex(self.haff(self.folder).stderr, "is no case directory")


if __name__ == "__main__":
    unittest.main()
