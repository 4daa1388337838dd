# SPDX-License-Identifier: GPL-3.0-or-later
"""Steady flows of packed gas with friction mu(I) on lines of cells, against the exact solution of the law: down a rough slope
(Bagnold), in a vertical chute, and below a lid that moves. tau is known at each depth, so mu(I) = tau/p gives the shear rate."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness, runs

boxes = harness.boxes
SIGMA, MU_S, MU_2, I_0 = 0.04, 0.38, 0.64, 0.279  # the grains have density 1
GRAIN = f"grain {{ diameter {SIGMA!r}; mass {np.pi / 6 * SIGMA**3!r}; "
RHO = 0.6  # of chute and lid


def shear_rate(tau, p):
    ratio = tau / np.maximum(p, 1e-300)
    return np.where(ratio > MU_S, I_0 * (ratio - MU_S) / np.maximum(MU_2 - ratio, 1e-9), 0) * np.sqrt(np.maximum(p, 0)) / SIGMA


def profile(height, tau, p):
    """Speed at 20,001 places from the wall on; tau, p: functions of the distance from it."""
    y = np.linspace(0, height, 20001)
    rate = shear_rate(tau(y), p(y))
    return y, np.concatenate([[0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(y))])


class FrictionFlows(harness.Folder, unittest.TestCase):
    def case(self, name, axis, cells, length, p, gravity, walls, end, functions="", adjust="no", engine=""):
        """Gas of uniform density at rest. walls: the rules of U at both ends of the line."""
        n, size, a = [1, 1, 1], [1.0, 1.0, 1.0], "xyz"[axis]
        n[axis], size[axis] = cells, length
        place = boxes.centres(n, size)[:, axis]
        still = np.zeros((cells, 3))
        case = harness.box_case(os.path.join(self.folder, f"{name}{cells}"), n, size, RHO + 0 * place, still, p(place), end, types={a: "wall"},
                                eos="TorquatoSpheres", gravity=gravity, adjust=adjust, step=0.02)
        empty = "\n".join(f"{b}Empty empty" for b in "xyz" if b != a)
        boxes.write_field(case, "U", still, f"{a}Low {walls[0]}\n{a}High {walls[1]}\n{empty}")
        boxes.write_dictionary(case, "constant", "granularProperties", GRAIN + "restitution 1; }\nequationOfState TorquatoSpheres;\n"
                               "cooling none;\nfriction { type muI; }\n")
        if engine:
            runs.add(case, "system/fvSchemes", f"polyReconstruct linear; meshEngine {engine};\n")
        self.finish(case, functions)
        return harness.haff.Case(case)

    def finish(self, case, functions=""):
        boxes.write_dictionary(case, "system", "fvSolution", "acoustics { type implicit; }\n")
        with open(os.path.join(case, "system", "controlDict"), "a") as f:
            f.write("acceptWarnings (largeGrains);\n" + functions)
        with open(os.path.join(case, "log"), "w") as f:
            f.write(harness.program("granularGas", "-case", case).stdout)

    def slope(self, degrees, cells):
        """A layer of depth 1 at packing 0.61, which starts near its speed, and what the law says of its own pressures."""
        case, angle = os.path.join(self.folder, f"slope{degrees}_{cells}"), np.radians(degrees)
        n, height = cells * 5 // 4, 1.25
        boxes.box_case(case, (1, n, 1), (1.0, height, 1.0), np.ones(n), np.zeros((n, 3)), np.ones(n), 60.0, types={"y": "wall"},
                       gravity=(np.sin(angle), -np.cos(angle), 0.0))
        os.remove(os.path.join(case, "0", "p"))
        os.remove(os.path.join(case, "0", "rho"))
        number = I_0 * (np.tan(angle) - MU_S) / (MU_2 - np.tan(angle))
        speed = 0.97 * 2 / 3 * number / SIGMA * np.sqrt(0.64 * np.cos(angle)) * 0.953**1.5
        rules = '{ "[xz]Empty" { type empty; } yLow { type %s; } yHigh { type %s; } }\n'
        for name, kind, dimensions, value, low, high in (
                ("alpha", "Scalar", "[0 0 0 0 0 0 0]", f"settledLayer {{ depth {1 / SIGMA!r}; packing 0.61; }}", "zeroGradient", "zeroGradient"),
                ("T", "Scalar", "[0 2 -2 0 0 0 0]", "internalField uniform 1e-4;", "zeroGradient", "zeroGradient"),
                ("U", "Vector", "[0 1 -1 0 0 0 0]", "internalField uniform (0 0 0);\n"
                 f'expression ("{speed!r}*(1 - max(1 - y/0.953, 0)^1.5)" "0" "0");', "noSlip", "slip")):
            with open(os.path.join(case, "0", name), "w") as f:
                f.write(boxes.header(f"vol{kind}Field", name, "0") + f"dimensions {dimensions};\n{value}\nboundaryField\n" + rules % (low, high))
        boxes.write_dictionary(case, "constant", "granularProperties", GRAIN + "restitution 0.9; thresholdSpeed 6e-3; }\n"
                               "equationOfState TorquatoSpheres;\ncooling Haff;\nfriction { type muI; }\n")
        self.finish(case)
        result = harness.haff.Case(case)
        alpha, u, h = result.field("alpha"), result.field("U")[:, 0], height / n
        weight = np.append(np.cumsum((alpha * h * np.cos(angle))[::-1])[::-1], 0)  # pressure on the faces, from the floor up
        y, exact = profile(height, lambda y: np.tan(angle) * np.interp(y, np.arange(n + 1) * h, weight),
                           lambda y: np.interp(y, np.arange(n + 1) * h, weight))
        exact, packed = np.interp(result.centres[:, 1], y, exact), alpha > 0.5
        return np.abs(u - exact)[packed].sum() / exact[packed].sum()

    def test_slope(self):
        for degrees in (22, 24, 26):
            with self.subTest(degrees=degrees):
                errors = [self.slope(degrees, cells) for cells in (16, 32)]
                self.assertLess(errors[1], 0.006)
                self.assertLess(errors[1], errors[0])

    def chute(self, cells, gravity, end):
        """Between rough walls at x = 0 and 2; p = 1."""
        result = self.case(f"chute{gravity:.3f}", 0, 2 * cells, 2.0, lambda x: 1 + 0 * x, (0.0, gravity, 0.0), ("noSlip", "noSlip"), end,
                           functions="functions { ratio { type writeObjects; objects (stressRatio); } }\n")
        y, exact = profile(1, lambda y: RHO * gravity * (1 - y), lambda y: 1 + 0 * y)
        x = np.abs(result.centres[:, 0] - 1)
        np.testing.assert_allclose(result.field("stressRatio"), RHO * gravity * x, rtol=0, atol=1e-5)
        return x, result.field("U")[:, 1], np.interp(1 - x, y, exact)

    def test_chute(self):
        """A plug of half the width mu_s p/(rho g) does not shear; the rest does as the law says."""
        errors = []
        for cells in (16, 32):
            x, u, exact = self.chute(cells, 0.5 / RHO, 60.0)
            errors.append(np.abs(u - exact).mean() / exact.mean())
            shears = x[:-1][np.abs(np.diff(u)) > 1e-4 * u.max()]
            plug = x < MU_S / 0.5 - 1 / cells
            self.assertLess(abs(shears.min() - MU_S / 0.5), 1 / cells)
            self.assertLess(np.ptp(u[plug]), 1e-8 * u.max())
        self.assertLess(errors[1], 0.01)
        self.assertGreater(errors[0] / errors[1], 3)

    def test_steps_along_an_axis_without_cells(self):
        """dt is limited by gravity along it as along the others: 0.2 sqrt(2 h/g), half of it in a bed; on both engines."""
        for engine in ("lattice", "polyhedral"):
            with self.subTest(engine):
                walls = ("noSlip", "noSlip")
                result = self.case(engine, 0, 16, 2.0, lambda x: 1 + 0 * x, (0.0, 1.0, 0.0), walls, 1.0, adjust="yes", engine=engine)
                with open(os.path.join(result.path, "log")) as f:
                    steps = re.findall(r"deltaT = (\S+) \(limited by: free fall\)", f.read())
                self.assertAlmostEqual(float(steps[-1]), 0.1 * np.sqrt(2 * 0.125), places=6)

    def test_weak_chute(self):
        """Where the stress at the walls is below mu_s p nothing flows."""
        _, u, _ = self.chute(16, 0.37 / RHO, 10.0)
        self.assertLess(np.abs(u).max(), 1e-14)

    def test_lid(self):
        """Gas of weight 1 under a lid that presses with 0.5 and moves with 1: the lid's force, and the speeds below it."""
        found, (low, high) = [], (MU_S * 0.5, MU_2 * 0.5)
        for _ in range(60):
            tau = (low + high) / 2
            y, exact = profile(1, lambda y: tau + 0 * y, lambda y: 1.5 - y)
            low, high = (tau, high) if exact[-1] < 1 else (low, tau)
        for cells in (32, 64):
            forces = "functions { lid { type forces; patches (yHigh); CofR (0 0 0); writeControl writeTime; } }\n"
            walls = ("noSlip", "frictionalSlip; muWall 10; U (1 0 0)")
            result = self.case("lid", 1, cells, 1.0, lambda y: 1.5 - y, (0.0, -1 / RHO, 0.0), walls, 20.0, forces)
            with open(os.path.join(result.path, "postProcessing", "lid", "0", "force.dat")) as f:
                force = -float(f.read().splitlines()[-1].split("(")[1].split()[0])
            speed = np.interp(result.centres[:, 1], y, exact)
            found.append((force / tau - 1, np.abs(result.field("U")[:, 0] - speed).sum() / speed.sum()))
        self.assertLess(abs(found[1][0]), 1e-3)
        self.assertLess(found[1][1], 0.015)
        for coarse, fine in zip(*found):
            self.assertGreater(coarse / fine, 3)


if __name__ == "__main__":
    unittest.main()
