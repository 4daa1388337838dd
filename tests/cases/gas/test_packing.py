# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing is a bound of every gas whose pressure diverges there: in a column that settles, at open patches of every kind, at the start."""
import itertools
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes

MOST = {"TorquatoDisks": 0.82, "TorquatoSpheres": 0.64, "GoldshteinShapiro": 0.65}
INSIDE = np.nextafter(1, 0)


class Packing(harness.Folder, unittest.TestCase):
    def box(self, n, size, alpha, T, rules, end, eos="TorquatoDisks", grain="", engine="", **options):
        """Gas of grains of diameter 1 at rest; rules: {field: {patch: rule}}, else a patch is a slip wall."""
        case, cells = os.path.join(self.folder, "case"), int(np.prod(n))
        shutil.rmtree(case, ignore_errors=True)
        disks = eos == "TorquatoDisks"
        walls = [a + side for a, k in zip("xyz", n) if k > 1 for side in ("Low", "High")]
        boxes.box_case(case, n, size, np.ones(cells), np.zeros((cells, 3)), np.ones(cells), end, eos=eos, gamma=2.0 if disks else 5 / 3,
                       stepper="SSPRK43", courant=1.0, reconstruct="WPENO5", **options)
        os.remove(os.path.join(case, "0", "rho"))
        os.remove(os.path.join(case, "0", "p"))
        standard = {"alpha": "type zeroGradient;", "T": "type zeroGradient;", "U": "type slip;"}
        for field, value in (("alpha", alpha), ("T", T), ("U", "(0 0 0)")):
            inner = value if isinstance(value, str) and value[0] != "(" else f"internalField uniform {value};"
            of = {**{p: standard[field] for p in walls}, **rules.get(field, {}), **{a + "Empty": "type empty;" for a, k in zip("xyz", n) if k == 1}}
            with open(os.path.join(case, "0", field), "w") as f:
                f.write(boxes.header("volVectorField" if field == "U" else "volScalarField", field, "0")
                        + f"dimensions {boxes.DIMENSIONS[field]};\n{inner}\nboundaryField\n{{\n"
                        + "".join(f"{p} {{ {rule} }}\n" for p, rule in of.items()) + "}\n")
        harness.edit(case, "constant/granularProperties", diameter=f"1; {grain}")
        with open(os.path.join(case, "system", "fvSchemes"), "a") as f:
            f.write(engine and f"meshEngine {engine};\n")
        return case

    def column(self, cells, end, **options):
        """Disks of e = 0.75 at 0.4 of T = 1 fall in a box of 20 under g = 1; at rest they would be 9.76 deep."""
        return self.box((1, cells, 1), (20 / cells, 20.0, 20 / cells), 0.4, 1, {}, end, e=0.75, cooling="Haff", gravity=(0.0, -1.0, 0.0),
                        **options)

    def below(self, case, eos="TorquatoDisks"):
        case = harness.haff.Case(case)
        for time in case.times[1:]:
            self.assertLessEqual(case.field("alpha", time).max(), MOST[eos] * INSIDE, f"t = {time}")
        return case

    def test_collapse(self):
        """Without a threshold speed the column ends at its collapse, at the floor. The times fall towards 2.827, that of infinitely fine
        cells (2.849, 2.838, 2.833 with 160, 320, 640 cells)."""
        for engine in ("lattice", "polyhedral"):
            last = 4.0
            for cells in (20, 40, 80):
                with self.subTest(engine=engine, cells=cells):
                    case = self.column(cells, 10.0, interval=1.0, engine=engine)
                    done = harness.program("granularGas", "-case", case, check=False)
                    self.assertEqual(done.returncode, 2)
                    said = re.search(r"inelastic collapse at t = (\S+), \(\S+ (\S+) \S+\), alpha = (\S+), T = (\S+): ", done.stderr)
                    t, y, alpha, T = (float(v) for v in said.groups())
                    self.assertTrue(2.827 < t < last, f"t = {t}")
                    self.assertEqual(y, 10 / cells)
                    self.assertTrue(0.819 < alpha <= 0.82 and 0 < T < 1e-6, f"alpha = {alpha}, T = {T}")
                    self.below(case)
                    last = t

    def test_rest(self):
        """With a threshold speed of 3e-3 sqrt(g depth) it lies at rest: for 25 times of free fall through its depth, where steps are
        short (149,000 of 12 cells), but no collapse."""
        case = self.column(12, 110.5, interval=22.1, grain="thresholdSpeed 9.37e-3;")
        said = harness.program("granularGas", "-case", case).stdout
        self.assertLess(int(re.search(r"end at time 110.5: (\d+) steps", said).group(1)), 2e5)
        case = self.below(case)
        y = (np.arange(12) + 0.5) / 0.6
        centre = [y @ case.field("alpha", t) / case.field("alpha", t).sum() for t in case.times[1:]]
        self.assertLess(np.ptp(centre), 0.02 * np.mean(centre))
        self.assertGreater(case.field("alpha", case.times[-1])[:5].min(), 0.8199)

    def test_open_patches(self):
        """Gas that is driven into a closed box through a patch of any open kind: it stays below packing, whatever the patch gives. Where it
        packs, steps end at minDeltaT."""
        kinds = {"alpha": ("type zeroGradient;", "type fixedValue; value uniform {0};", "type inletOutlet; inletValue uniform {0};"),
                 "U": ("type zeroGradient;", "type fixedValue; value uniform (3 0 0);", "type inletOutlet; inletValue uniform (3 0 0);"),
                 "T": ("type zeroGradient;", "type fixedValue; value uniform 4;", "type inletOutlet; inletValue uniform 4;")}
        shapes = ((12, 1, 1), (12, 1, 1), (12, 1, 1), (12, 1, 1), (6, 5, 1), (4, 2, 2))
        packed = 0
        for k, rule in enumerate(itertools.product(*kinds.values())):
            eos, n = list(MOST)[k % 3], shapes[k % 6]
            n = (n[0], n[1], 1) if eos == "TorquatoDisks" else n
            engine = ("lattice", "polyhedral")[k // 3 % 2]
            with self.subTest(rule=rule, eos=eos, n=n, engine=engine):
                rules = {f: {"xLow": r.format(0.9998 * MOST[eos])} for f, r in zip(kinds, rule)}
                case = self.box(n, tuple(map(float, n)), 0.9 * MOST[eos], 1, rules, 0.75, eos=eos, engine=engine, gravity=(2.0, 0.0, 0.0))
                with open(os.path.join(case, "system", "controlDict"), "a") as f:
                    f.write("minDeltaT 1e-5;\n")
                done = harness.program("granularGas", "-case", case, check=False)
                self.assertIn(done.returncode, (0, 2), done.stderr)
                packed += done.returncode == 2
                self.below(case, eos)
        self.assertGreater(packed, 5)

    def test_refused(self):
        """A start, or what a patch gives, at packing or beyond, with file, line and cure; what lies below it is taken."""
        table = ("internalField uniform {0};", 'expression "{0} + 0*y";', "internalField uniform 0.1;\nsettledLayer {{ depth 3; hydrostatic no; "
                 "laidAt {0}; }}")
        for text, engine in itertools.product(table, ("lattice", "polyhedral")):
            for value in (0.82, 0.83, 0.8199):
                with self.subTest(text=text, value=value, engine=engine):
                    case = self.box((1, 8, 1), (1.0, 8.0, 1.0), text.format(value), 1, {}, 1e-9, engine=engine, gravity=(0.0, -1.0, 0.0))
                    done = harness.program("checkCase", case, check=False)
                    self.assertEqual(done.returncode, 0 if value < 0.82 else 1, done.stderr)
                    if value >= 0.82:
                        self.assertRegex(done.stderr, r"0/alpha:1[012]: .*alpha (is|=) 0\.8.*between 0 and 0\.82 \(alphaMax, .*lower it")
        patch = {"alpha": {"yHigh": "type fixedValue; value uniform 0.82;"}, "U": {"yHigh": "type zeroGradient;"}}
        done = harness.program("checkCase", self.box((1, 8, 1), (1.0, 8.0, 1.0), 0.4, 1, patch, 1e-9), check=False)
        self.assertRegex(done.stderr, r"0/alpha:\d+: patch yHigh: value of alpha is 0\.82; .*alphaMax")

    def test_tangent(self):
        """What was asked for has no bound: in the same column with G continued by its tangent the floor goes beyond packing."""
        case = self.column(20, 10.0)
        harness.edit(case, "constant/granularProperties", gamma="2; tangent yes")
        harness.program("granularGas", "-case", case)
        self.assertGreater(harness.haff.Case(case).field("alpha").max(), 0.825)


if __name__ == "__main__":
    unittest.main()
