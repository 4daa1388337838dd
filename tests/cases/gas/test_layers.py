# SPDX-License-Identifier: GPL-3.0-or-later
"""settledLayer and perturbation: mass, equilibrium and waves, on any axes and both engines, and what is refused."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes

TRIANGLES = """L = 12; H = 10; Point(1) = {0, 0, 0}; Point(2) = {L, 0, 0}; Point(3) = {L, H, 0}; Point(4) = {0, H, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Periodic Curve {2} = {4} Translate {L, 0, 0}; Mesh.MeshSizeMax = 0.5;
Physical Curve("yLow") = {1}; Physical Curve("xHigh") = {2}; Physical Curve("yHigh") = {3}; Physical Curve("xLow") = {4};
Physical Surface("gas") = {1};
"""
FULL = "settledLayer { depth 6; packing 0.8; }"


class Layers(harness.Folder, unittest.TestCase):
    def case(self, name, alpha=FULL, n=(24, 40, 1), size=(12.0, 10.0, 0.5), up=1, sign=1, gravity=10.0, T=30.0, end=1e-12, eos="TorquatoDisks",
             schemes="", field="alpha"):
        """Elastic disks, gravity against sign times axis `up`, cyclic along all others; T: a number, or an expression."""
        case = os.path.join(self.folder, name)
        cells, along = np.prod(n), "xyz"[up]
        types = {a: "cyclic" for a, k in zip("xyz", n) if k > 1 and a != along}
        g = tuple(-sign * gravity if k == up else 0.0 for k in range(3))
        harness.box_case(case, n, size, np.ones(cells), np.zeros((cells, 3)), np.ones(cells), end, types=types, eos=eos, gravity=g,
                         gamma=2.0 if eos == "TorquatoDisks" else 5 / 3, slip=(along + "Low", along + "High"), reconstruct="WPENO5")
        os.remove(os.path.join(case, "0", "rho"))
        os.remove(os.path.join(case, "0", "p"))
        rules = "".join(f'"{a}.*" {{ type {"empty" if k == 1 else "cyclic" if a in types else "zeroGradient"}; }}\n'
                        for a, k in zip("xyz", n))
        temperature = f'internalField uniform {T};' if isinstance(T, float) else f'expression "{T}";'
        for key, text in ((field, alpha), ("T", temperature)):
            with open(os.path.join(case, "0", key), "w") as f:
                f.write(boxes.header("volScalarField", key, "0") + f"dimensions {boxes.DIMENSIONS[key]};\n{text}\n"
                        f"boundaryField {{ {rules} }}\n")
        harness.edit(case, "constant/granularProperties", diameter=1)
        with open(os.path.join(case, "system", "fvSchemes"), "a") as f:
            f.write(schemes)
        return case

    def start(self, *arguments, **options):
        """The case, with what the start was, to round-off: after a step of next to nothing."""
        case = self.case(*arguments, **options)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def mass(self, case):
        """alpha times height, per area of the floor."""
        return float(case.field("alpha") @ case.volumes / case.volumes.sum())

    def test_mass_and_place(self):
        """On every axis, from either side, on both engines: the same layer, with the mass asked for."""
        profiles = []
        for up, sign, engine in ((0, 1, ""), (0, -1, ""), (1, 1, ""), (1, -1, "meshEngine polyhedral;"), (2, 1, ""), (2, -1, "")):
            n, size = np.ones(3, int), np.full(3, 0.5)
            n[up], size[up], n[up - 1], size[up - 1] = 40, 10.0, 8, 4.0
            with self.subTest(up=up, sign=sign):
                case = self.start(f"axis{up}{sign}", n=tuple(n), size=tuple(size), up=up, sign=sign, schemes=engine, T=5.0)
                self.assertAlmostEqual(self.mass(case) * 10, 4.8, delta=1e-13)
                alpha = np.moveaxis(case.field("alpha").reshape(n[::-1]), 2 - up, 0).reshape(40, -1)
                np.testing.assert_allclose(alpha, alpha[:, :1] + 0 * alpha, rtol=1e-9)
                profiles.append(alpha[::sign, 0])
        for p in profiles[1:]:
            np.testing.assert_allclose(p, profiles[0], rtol=1e-7)
        self.assertGreater(profiles[0][0], profiles[0][10])
        self.assertLess(profiles[0][-1], 0.1)

    def test_equilibrium(self):
        """It rests, and converges to the column whose p is the weight above: dp/dh = -rho g."""
        miss = []
        for n in (40, 80):
            case = self.start(f"rest{n}", n=(1, n, 1), size=(0.5, 10.0, 0.5), end=0.3)
            self.assertLess(np.abs(case.field("U")).max(), 1e-12)
            rho, p = case.field("rho"), case.field("p")
            slope = (p[:-3] - 27 * p[1:-2] + 27 * p[2:-1] - p[3:]) / (24 * 10 / n)
            miss.append(np.abs(slope / (10 * (rho[1:-2] + rho[2:-1]) / 2) + 1)[:n // 2].max())
        self.assertLess(miss[0], 5e-3)
        self.assertGreater(miss[0] / miss[1], 3.5)
        uneven = self.start("fall", "settledLayer { depth 6; packing 0.8; hydrostatic no; laidAt 0.5; }", n=(1, 40, 1), size=(0.5, 10.0, 0.5),
                            end=0.3)
        self.assertGreater(np.abs(uneven.field("U")).max(), 0.3)

    def test_uniform(self):
        """A cell that the surface cuts has its part; T may vary."""
        case = self.start("uniform", "settledLayer { depth 6; packing 0.8; hydrostatic no; laidAt 0.76; background 1e-9; }",
                          n=(1, 10, 1), size=(0.5, 10.0, 0.5), T="30 + y")
        np.testing.assert_allclose(case.field("alpha"), [0.76] * 6 + [0.24] + [1e-9] * 3, rtol=1e-7, atol=1e-11)
        standard = self.start("alphaMax", "settledLayer { depth 6; hydrostatic no; laidAt 0.5; }", n=(1, 20, 1), size=(0.5, 10.0, 0.5))
        self.assertAlmostEqual(self.mass(standard) * 10, 6 * 0.82, delta=1e-13)

    def test_rho(self):
        """rho in its own unit, of spheres: mass per area over the mass of a grain."""
        case = self.start("rho", "settledLayer { depth 4; packing 0.5; }", eos="GoldshteinShapiro", field="rho", n=(4, 40, 1))
        self.assertAlmostEqual(float(case.field("rho") @ case.volumes / case.volumes.sum()) * 10 * np.pi / 6, 2.0, delta=1e-12)

    def test_waves(self):
        """Each of the longest waves has the amplitude, others nothing; phases follow the seed; the mass stays."""
        for of in ("density", "depth"):
            found = []
            for seed in (1, 1, 2):
                text = "settledLayer { depth 6; packing 0.8; } perturbation { modes 5; amplitude 1e-3; seed %d; of %s; }" % (seed, of)
                case = self.start(f"waves{of}{len(found)}", text)
                column = case.field("alpha").reshape(40, 24).sum(axis=0)
                c = 2 * np.fft.rfft(column / column.mean() - 1)[:-1] / 24
                np.testing.assert_allclose(np.abs(c[1:6]), 1e-3, rtol=2e-3)
                self.assertLess(np.abs(c[6:]).max(), 1e-5)
                self.assertAlmostEqual(self.mass(case) * 10, 4.8, delta=1e-13)
                found.append(c)
            np.testing.assert_array_equal(found[0], found[1])
            self.assertGreater(np.abs(np.angle(found[2][1:6] / found[0][1:6])).max(), 0.1)

    def test_waves_alone(self):
        """On any field, along the axis asked for; an expression is evaluated first."""
        case = self.start("alone", 'expression "0.2 + 0.01*y"; perturbation { modes 1; amplitude 0.01; }')
        alpha = case.field("alpha").reshape(40, 24)
        flat = 0.2 + 0.01 * (np.arange(40) + 0.5) * 0.25
        c = np.fft.rfft(alpha / flat[:, None] - 1, axis=1) / 12
        np.testing.assert_allclose(np.abs(c[:, 1]), 0.01, rtol=1e-9)
        deep = self.start("axis", "internalField uniform 0.2; perturbation { modes 2; amplitude 0.01; axis z; }", n=(8, 8, 8),
                          size=(4.0, 4.0, 2.0), eos="GoldshteinShapiro")
        alpha = deep.field("alpha").reshape(8, 8, 8)
        self.assertLess(np.ptp(alpha, axis=(1, 2)).max(), 1e-9)
        self.assertGreater(np.ptp(alpha), 0.005)

    def test_triangles(self):
        """Cells that are no boxes: the mass is that asked for, and densities follow the height."""
        case = self.case("triangles", T=5.0)
        with open(case + "/mesh.geo", "w") as f:
            f.write(TRIANGLES)
        boxes.write_dictionary(case, "system", "meshDict", "patches { xLow { type cyclic; neighbourPatch xHigh; } xHigh { type cyclic; "
                               "neighbourPatch xLow; } front { type empty; } back { type empty; } }\n")
        harness.mesh(case, 0, option="unused")
        for key in ("alpha", "T", "U"):
            path = os.path.join(case, "0", key)
            with open(path) as f:
                text = re.sub(r"nonuniform List<vector>[^;]*;", "uniform (0 0 0);", f.read())
                text = re.sub(r'"?z\w*[.*]*"? *\{ type empty; \}', '"(front|back)" { type empty; }', text)
            with open(path, "w") as f:
                f.write(text)
        harness.program("granularGas", "-case", case)
        case = harness.haff.Case(case)
        self.assertAlmostEqual(self.mass(case) * 10, 4.8, delta=1e-12)
        order = np.argsort(case.centres[:, 1])
        alpha = case.field("alpha")[order]
        self.assertLess(alpha.max(), 0.82)
        self.assertGreater(alpha[:50].mean(), alpha[len(alpha) // 2:].mean() + 0.1)

    def test_refused(self):
        rows = [
            ("settledLayer { packing 0.8; }", {}, "'depth' is missing"),
            ("settledLayer { depth 6; paking 0.8; }", {}, "did you mean 'packing'"),
            ("settledLayer { depth 6; } perturbation { modes 3; amplitude 1e-3; sed 3; }", {}, "did you mean 'seed'"),
            ("settledLayer { depth 6; laidAt 0.7; }", {}, "hydrostatic no;"),
            (FULL + ' expression "0.3";', {}, "remove one of them"),
            (FULL, {"gravity": 0.0}, "needs gravity"),
            (FULL, {"T": "30 + x"}, "needs one T at each height"),
            ("settledLayer { depth 60; }", {}, "deeper than the box"),
            ("settledLayer { depth 6; background 0.79; }", {}, "would fall on the layer; say  background 0.001;"),
            ("settledLayer { depth 6; packing 0.8; background 0.3; }", {"T": 5.0}, "its background of alpha 0.3 is 0."),
            ("settledLayer { depth 6; packing 0.8; background 0.02; hydrostatic no; }", {}, "say  background 0.01;"),
            ("internalField uniform 0.2; perturbation { amplitude 1e-3; of depth; }", {}, "of density;"),
            ("internalField uniform 0.2; perturbation { amplitude 1e-3; axis y; }", {}, "y does not"),
            ("internalField uniform 0.2; perturbation { amplitude 1e-3; axis t; }", {}, "allowed are: x, y, z"),
            ("internalField uniform 0.2; perturbation { amplitude 0.9; }", {}, "lower amplitude"),
            ("internalField uniform 0.2; perturbation { amplitude 1e-3; }", {"n": (1, 40, 1)}, "none does"),
        ]
        for i, (alpha, options, expected) in enumerate(rows):
            with self.subTest(expected):
                done = harness.program("granularGas", "-case", self.case(f"bad{i}", alpha, **options), check=False)
                self.assertEqual(done.returncode, 1)
                self.assertIn(expected, done.stderr)
                self.assertRegex(done.stderr, r"0/(alpha|T):\d+: ")

    def test_listed(self):
        listed = harness.program("granularGas", "-listModels").stdout
        for word in ("settledLayer", "hydrostatic", "laidAt", "perturbation", "amplitude", "seed"):
            self.assertIn(word, listed)


if __name__ == "__main__":
    unittest.main()
