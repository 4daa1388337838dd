# SPDX-License-Identifier: GPL-3.0-or-later
"""workPrecision --quick through the real programs: rows, errors that fall with the grid, and the time of rhoCentralFoam."""
import csv
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.report import made


def tool(*arguments):
    return harness.command("workPrecision", "--bin", harness.BIN, *arguments)


class Quick(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.done = tool("--quick", "--out", cls.folder, "--commit", "first")
        cls.rows = cls.written(cls.folder)

    @classmethod
    def written(cls, folder=None):
        with open(os.path.join(folder or cls.folder, "workPrecision.csv"), newline="") as f:
            return list(csv.DictReader(f))

    def series(self, **wanted):
        """{(problem, code, scheme): [(cells, CPU seconds, error)] by cells}."""
        found = {}
        for r in self.rows:
            if all(r[k] == v for k, v in wanted.items()):
                key = tuple(r[k] for k in ("problem", "code", "flux", "reconstruct", "stepper", "courant"))
                found.setdefault(key, []).append((int(r["cells"]), float(r["cpu"]), float(r["error"])))
        return {k: sorted(v) for k, v in found.items()}

    def test_files(self):
        self.assertEqual(self.done.returncode, 0, self.done.stdout[-2000:] + self.done.stderr[-2000:])
        with open(os.path.join(self.folder, "workPrecision.md")) as f:
            text = f.read()
        for problem in ("vortex", "vortexTriangles", "wave", "shear", "sod", "blast"):
            self.assertIn(f"## {problem}:", text)
        with open(os.path.join(self.folder, "workPrecision.png"), "rb") as f:
            self.assertEqual(f.read(4), b"\x89PNG")

    def test_errors_fall(self):
        series = self.series(code="haff")
        self.assertGreaterEqual(len(series), 17)  # five problems of three reconstructions, one of two
        for key, points in series.items():
            with self.subTest(" ".join(key)):
                self.assertGreaterEqual(len(points), 2)
                for (_, _, coarse), (_, _, fine) in zip(points, points[1:]):
                    self.assertLess(fine, coarse)
                self.assertTrue(all(cpu > 0 for _, cpu, _ in points))

    def test_orders(self):
        """WENO5 on the smooth problems gains more than third order, on Sod's tube less than first, which a wrong exact
        solution or a wrong norm would not show."""
        for problem, low, high in (("vortex", 3, 6), ("wave", 2.8, 6), ("sod", 0.6, 1.0)):
            with self.subTest(problem):
                [((n0, _, e0), *_, (n1, _, e1))] = self.series(problem=problem, reconstruct="WENO5").values()
                order = np.log(e0 / e1) / np.log(n1 / n0)
                self.assertGreater(order, low)
                self.assertLess(order, high)

    @unittest.skipUnless(shutil.which("rhoCentralFoam"), "rhoCentralFoam (package openfoam) is not installed: no comparison")
    def test_sooner_than_rhoCentralFoam(self):
        foam = self.series(code="rhoCentralFoam")
        self.assertEqual({key[0] for key in foam}, {"vortex", "vortexTriangles", "sod"})
        for (problem, *_), points in foam.items():
            _, seconds, error = points[-1]
            with self.subTest(problem):
                ours = [cpu for series in self.series(code="haff", problem=problem).values() for _, cpu, e in series if e <= error]
                self.assertTrue(ours, f"no run of ours reaches {error}")
                self.assertGreater(seconds / min(ours), 1)

    @made.white()
    def test_continues(self):
        """A second call with the same folder runs nothing again."""
        again = tool("--quick", "--out", self.folder, "--commit", "first")
        self.assertEqual(again.returncode, 0, again.stderr[-2000:])
        self.assertNotIn("cpu", again.stdout)
        self.assertEqual(self.written(), self.rows)

    @made.white()
    def test_commit(self):
        """Rows say what they were measured at; only --fresh measures again, and only the problems asked for."""
        copy = os.path.join(self.folder, "other")
        os.mkdir(copy)
        shutil.copy(os.path.join(self.folder, "workPrecision.csv"), copy)
        self.assertEqual({r["commit"] for r in self.rows}, {"first"})
        options = ("--quick", "--no-foam", "--problems", "wave", "--out", copy, "--commit", "second")
        self.assertNotIn("cpu", tool(*options).stdout)
        self.assertIn("cpu", tool(*options, "--fresh").stdout)
        rows = self.written(copy)
        self.assertEqual({(r["problem"] == "wave", r["commit"]) for r in rows}, {(False, "first"), (True, "second")})
        known = ("cpu", "user", "loop", "commit")
        once = [sorted(tuple((k, v) for k, v in r.items() if k not in known) for r in which) for which in (rows, self.rows)]
        self.assertEqual(*once)

    def test_order_of_runs(self):
        """From coarse to fine, with rhoCentralFoam neither first nor last of a grid both run on."""
        for problem, cells in (("vortex", "20"), ("sod", "100"), ("sod", "200")):
            codes = [r["code"] for r in self.rows if r["problem"] == problem and r["cells"] == cells]
            if "rhoCentralFoam" in codes:
                self.assertEqual((codes[0], codes[-1]), ("haff", "haff"))
        for problem in {r["problem"] for r in self.rows}:
            cells = [int(r["cells"]) for r in self.rows if r["problem"] == problem]
            self.assertEqual(cells, sorted(cells))


class Arguments(unittest.TestCase):
    def test_help_and_mistakes(self):
        self.assertIn("--quick", tool("-help").stdout)
        wrong = tool("--problems", "vortex,sodd")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("no problem sodd", wrong.stderr)


class References(harness.Folder, unittest.TestCase):
    def test_kept(self):
        """What is kept of two fine runs: block averages of their mean to 1e-6, the gap, and holes."""
        from studies.workPrecisionProblems import Step
        step = Step()
        step.fine = 20
        values = np.random.default_rng(5).uniform(1, 2, int(step.kept(20).sum()))
        step.keep(self.folder, [values, values + 0.1])
        other = Step()
        self.assertTrue(other.load([self.folder]))
        self.assertEqual(other.fine, 20)
        self.assertAlmostEqual(other.gap * step.scale, 0.1, delta=1e-7)
        np.testing.assert_allclose(other.known(20), values + 0.05, rtol=2e-6)
        square = np.full((20, 20), np.nan)
        square.ravel()[step.kept(20)] = values + 0.05
        np.testing.assert_allclose(other.known(4), square.reshape(4, 5, 4, 5).mean(axis=(1, 3)).ravel()[step.kept(4)], rtol=2e-6)
        # 20 cells on 8: two and a half each
        fine = np.repeat(np.repeat(square, 2, 0), 2, 1)
        np.testing.assert_allclose(other.known(8), fine.reshape(8, 5, 8, 5).mean(axis=(1, 3)).ravel()[step.kept(8)], rtol=2e-6)


if __name__ == "__main__":
    unittest.main()
