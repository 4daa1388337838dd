# SPDX-License-Identifier: GPL-3.0-or-later
"""A gas of disks with Torquato's contact value, through the program."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness, runs

TUBE = {"eos": "TorquatoDisks", "gamma": 2.0, "types": {"x": "cyclic"}, "reconstruct": "WPENO5"}


def density(nu, sigma=0.1):
    return 4 * nu / (np.pi * sigma**2)


def compressibility(nu, e):
    """A and nu A' below freezing: p = rho T A."""
    chi = (1 - 0.436 * nu) / (1 - nu)**2
    slope = (-0.436 * (1 - nu) + 2 * (1 - 0.436 * nu)) / (1 - nu)**3
    return 1 + (1 + e) * nu * chi, (1 + e) * nu * (chi + nu * slope)


class Disks(harness.Folder, unittest.TestCase):
    def box(self, name, n, rho, u, p, end, **options):
        case = harness.box_case(os.path.join(self.folder, name), n, (1.0, n[1] / n[0], 0.1), rho, u, p, end,
                                **{**TUBE, **options})
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def test_cooling(self):
        """Haff's law of disks, of 0.1 instead of the oracle's 0.01: times are ten times longer."""
        with open(os.path.join(harness.SOURCE, "tests", "oracles", "hcs.csv")) as f:
            rows = [line.strip().split(",")[1:] for line in f if line.startswith("Carrillo2D")]
        self.assertEqual(len(rows), 8)
        for e, nu, T0, t, T in (map(float, row) for row in rows):
            if t != 1:
                continue
            rho = density(nu) * np.ones(8)
            with self.subTest(nu=nu):
                case = harness.box_case(os.path.join(self.folder, f"cooling{nu}"), (8, 1, 1), (1.0, 0.1, 0.1), rho,
                                        np.zeros((8, 3)), rho, 10 * t, e=e, cooling="Haff", **TUBE)
                os.remove(os.path.join(case, "0", "p"))
                harness.boxes.write_field(case, "T", T0 + 0 * rho, "\"x.*\" cyclic\n\"[yz].*\" empty")
                harness.program("granularGas", "-case", case)
                result = harness.haff.Case(case)
                np.testing.assert_allclose(result.field("T"), T, rtol=1e-9)
                np.testing.assert_allclose(result.field("alpha"), nu, rtol=1e-13)

    def test_sound(self):
        """A faint sound wave is back where it was after one crossing at the speed of the equation of state."""
        n, e, nu, T, faint = 64, 0.9, 0.4, 2.0, 1e-6
        A, slope = compressibility(nu, e)
        c = np.sqrt(T * (A + slope + A * A))
        wave = faint * np.sin(2 * np.pi * (np.arange(n) + 0.5) / n)
        rho, p = density(nu) * (1 + wave), density(nu) * T * A * (1 + c * c / (T * A) * wave)
        case = self.box("sound", (n, 1, 1), rho, np.outer(c * wave, (1, 0, 0)), p, 1 / c, e=e)
        self.assertLess(np.abs(case.field("rho") - rho).max() / (faint * density(nu)), 1e-3)

    def test_beyond_packing(self):
        """With `tangent` no density is forbidden: a gas beyond close packing stays at rest. Without, a dense one that hits a wall and
        rebounds stays below it."""
        ones = np.ones(8)
        case = harness.box_case(os.path.join(self.folder, "beyond"), (8, 1, 1), (1.0, 0.1, 0.1), density(0.83) * ones, np.zeros((8, 3)), ones, 1e-3,
                                **TUBE)
        harness.edit(case, "constant/granularProperties", gamma="2; tangent yes")
        harness.program("granularGas", "-case", case)
        np.testing.assert_array_equal(harness.haff.Case(case).field("rho"), density(0.83) * ones)
        ones = np.ones(100)
        case = self.box("wall", (100, 1, 1), density(0.78) * ones, np.outer(10 * ones, (1, 0, 0)), 1e4 * ones, 0.02,
                        types=None, slip=("xHigh",))
        self.assertTrue(0.8 < case.field("alpha").max() < 0.82)

    def test_refused(self):
        ones = np.ones(27)
        case = harness.box_case(os.path.join(self.folder, "cube"), (3, 3, 3), (1.0, 1.0, 1.0), ones, np.zeros((27, 3)), ones, 1.0,
                                eos="TorquatoDisks", gamma=2.0)
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("TorquatoDisks is for disks", done.stderr + done.stdout)
        harness.edit(case, "constant/granularProperties", gamma="2; smoothing 0.14")
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("alphaFreezing + smoothing", done.stderr + done.stdout)


class Viscous(harness.Folder, unittest.TestCase):
    """transport JenkinsRichman."""

    def box(self, name, n, rho, u, T, end, transport="JenkinsRichman", diffusion=None, engine=None, **options):
        options = {"eos": "TorquatoDisks", "gamma": 2.0, "reconstruct": "WPENO5", "types": {"x": "cyclic", "y": "cyclic"},
                   **options}
        case = harness.box_case(os.path.join(self.folder, name), n, (1.0, n[1] / n[0], 0.1), rho, u, rho, end, **options)
        os.remove(os.path.join(case, "0", "p"))
        rules = "\n".join(f"\"{axis}.*\" {options['types'].get(axis, 'empty' if n['xyz'.index(axis)] == 1 else 'zeroGradient')}"
                          for axis in "xyz")
        harness.boxes.write_field(case, "T", T, rules)
        harness.edit(case, "constant/granularProperties", transport=transport)
        if engine:
            runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        if diffusion:
            harness.write_dictionary(case, "system", "fvSolution", "diffusion { type %s; }\n" % diffusion)
        return case

    def run_box(self, *arguments, **options):
        case = self.box(*arguments, **options)
        done = harness.program("granularGas", "-case", case)
        return harness.haff.Case(case), done.stdout

    def shear(self, name, cells, **options):
        """A faint shear wave, and the rate it must decay with."""
        nu, T, faint = 0.4, 2.0, 1e-3
        n, ones = (cells, 4, 1), np.ones(4 * cells)
        x = np.tile((np.arange(cells) + 0.5) / cells, 4)
        G = nu * (1 - 0.436 * nu) / (1 - nu)**2
        rate = np.sqrt(np.pi) / 8 * 0.1 * np.sqrt(T) * (1 / G + 2 + (1 + 8 / np.pi) * G) * (2 * np.pi)**2
        u = np.outer(faint * np.sin(2 * np.pi * x), (0, 1, 0))
        case, log = self.run_box(name, n, density(nu) * ones, u, T * ones, 1 / rate, **options)
        return np.abs(case.field("U")[:, 1] * np.e - u[:, 1]).max() / faint, log

    def test_shear_wave(self):
        """Decays by e as the viscosity says, to second order, by either way of taking the steps."""
        for diffusion in ("RKJ2", "RKL2", "explicit"):
            with self.subTest(diffusion):
                coarse, _ = self.shear(f"coarse{diffusion}", 16, diffusion=diffusion)
                fine, log = self.shear(f"fine{diffusion}", 32, diffusion=diffusion)
                self.assertLess(fine, 4e-3)
                self.assertGreater(np.log2(coarse / fine), 1.8)
                self.assertIn("stages of viscous stress", log)
                self.assertIn(f"diffusion              {diffusion}", log)
        # a lattice run as polyhedra: the same fluxes of the diffusion
        boxes, log = self.shear("boxes", 32, engine="polyhedral")
        self.assertLess(boxes, 4e-3)
        self.assertRegex(log, r"meshEngine +polyhedral")
        # bulk viscosity does not act on shear
        other, _ = self.shear("bulk", 32, diffusion="explicit", transport="JenkinsRichman; JenkinsRichmanCoeffs { bulk paper; }")
        self.assertAlmostEqual(fine, other, 6)

    def test_heat(self):
        """A hot spot in a closed box: energy stays, T becomes even; the same bits on two ranks and after a restart."""
        n = (24, 18, 1)
        x, y, _ = harness.boxes.centres(n, (1.0, 0.75, 0.1)).T
        rho = density(0.1 + 0.3 * y)
        u = np.stack([3 * np.sin(3 * y + x), np.cos(5 * x), 0 * x], axis=1)
        T = 1 + 20 * np.exp(-30 * ((x - 0.3)**2 + (y - 0.3)**2))
        options = {"types": {}, "slip": ("xLow", "xHigh", "yLow", "yHigh"), "interval": 0.01}
        case, log = self.run_box("spot", n, rho, u, T, 0.02, **options)
        for drift in re.findall(r"\(drift (\S+)\)", log):
            self.assertLess(abs(float(drift)), 1e-13)
        self.assertIn("drift", log)
        self.assertLess(np.ptp(case.field("T")), 0.5 * np.ptp(T))
        again = self.box("again", n, rho, u, T, 0.02, **options)
        harness.edit(again, "system/controlDict", endTime=0.01)
        harness.program("granularGas", "-case", again, ranks=2)
        harness.edit(again, "system/controlDict", endTime=0.02)
        harness.program("granularGas", "-case", again)
        for field in ("rho", "rhoU", "rhoE"):
            np.testing.assert_array_equal(harness.haff.Case(again).field(field), case.field(field))

    def test_granular_wall(self):
        """Steady conduction from a wall of T = 1 to one that takes q = (1 - e^2) p sqrt(T/(2 pi)); p is uniform."""
        sigma, restitution = 0.1, 0.6
        c = (1 - restitution**2) / np.sqrt(2 * np.pi)

        def profile(p, Tw):
            """T, rho and x from the hot wall to the cold one at x = 1, and the heat flux."""
            T = np.linspace(1, Tw, 1001)
            low, high = density(1e-3) + 0 * T, density(0.68) + 0 * T
            for _ in range(50):
                rho = 0.5 * (low + high)
                above = rho * T * compressibility(np.pi / 4 * sigma**2 * rho, 1.0)[0] > p
                low, high = np.where(above, low, rho), np.where(above, rho, high)
            phi = np.pi / 4 * sigma**2 * rho
            G = phi * (1 - 0.436 * phi) / (1 - phi)**2
            heat = np.sqrt(np.pi) / 2 * rho * sigma * np.sqrt(T) * (1 / G + 3 + (9 / 4 + 4 / np.pi) * G)
            x = np.concatenate([[0], np.cumsum(0.5 * (heat[1:] + heat[:-1]) * -np.diff(T))])
            return T, rho, x / x[-1], x[-1]

        low, high, p = 1e-3, 0.999, 57.0
        for _ in range(45):
            Tw = 0.5 * (low + high)
            low, high = (Tw, high) if c * p * np.sqrt(Tw) < profile(p, Tw)[3] else (low, Tw)
        T, rho, x, _ = profile(p, Tw)
        mean = np.sum(0.5 * (rho[1:] + rho[:-1]) * np.diff(x))
        errors = []
        for cells in (8, 16):
            n, ones = (cells, 1, 1), np.ones(cells)
            at = (np.arange(cells) + 0.5) / cells
            case = self.box(f"granularWall{cells}", n, mean * ones, np.zeros((cells, 3)), np.interp(at, x, T), 15.0, types={},
                            slip=("xLow", "xHigh"), courant=0.8, step=1e-4)
            rules = f"xLow fixedValue; value uniform 1\nxHigh granularWall; restitution {restitution}\n\"[yz].*\" empty"
            harness.boxes.write_field(case, "T", np.interp(at, x, T), rules)
            harness.program("granularGas", "-case", case)
            errors.append(np.abs(harness.haff.Case(case).field("T") - np.interp(at, x, T)).max())
        self.assertLess(errors[1], 2e-5)
        self.assertGreater(np.log2(errors[0] / errors[1]), 1.8)

    def moving_wall(self, name, U="(0.5 0 0)", end=0.4, cold="granularWall; restitution 0.8"):
        """A channel whose upper wall moves with U and whose lower one is at rest."""
        n = (4, 16, 1)
        y = harness.boxes.centres(n, (1.0, 4.0, 0.1))[:, 1]
        rho, zeros = density(0.3) * np.ones(64), np.zeros((64, 3))
        case = self.box(name, n, rho, zeros, 1 + 0.2 * y, end, types={"x": "cyclic"}, slip=("yLow", "yHigh"), interval=end / 2)
        harness.boxes.write_field(case, "U", zeros, f'"x.*" cyclic\nyLow noSlip\nyHigh translatingWallVelocity; U {U}\n"z.*" empty')
        harness.boxes.write_field(case, "T", 1 + 0.2 * y, f'"x.*" cyclic\nyLow {cold}\nyHigh zeroGradient\n"z.*" empty')
        return case

    def test_moving_wall(self):
        """Couette flow of a granular gas: mass stays, the wall's work heats; the same bits on two ranks after a restart."""
        case = self.moving_wall("couette")
        log = harness.program("granularGas", "-case", case).stdout
        result = harness.haff.Case(case)
        u = result.field("U")[:, 0].reshape(16, 4)
        np.testing.assert_array_equal(u, np.repeat(u[:, :1], 4, axis=1))
        self.assertTrue((np.diff(u[:, 0]) > 0).all())
        self.assertGreater(u[0, 0], 0)
        self.assertLess(u[-1, 0], 0.5)
        self.assertRegex(log, r"mass \S+ \(drift [+-]\S+e(-1[4-9]|\+00)")
        self.assertRegex(log, r"energy \S+ \(change ")
        with open(os.path.join(case, "0.2", "U"), errors="replace") as f:
            self.assertRegex(f.read(), r"type +translatingWallVelocity;\s+U +\(0.5 0 0\);\s+value")
        with open(os.path.join(case, "0.2", "T"), errors="replace") as f:
            self.assertRegex(f.read(), r"type +granularWall;\s+restitution +0.80*\d*;\s+value")
        again = self.moving_wall("couetteAgain")
        harness.edit(again, "system/controlDict", endTime=0.2)
        harness.program("granularGas", "-case", again, ranks=2)
        harness.edit(again, "system/controlDict", endTime=0.4)
        harness.program("granularGas", "-case", again)
        for field in ("rho", "rhoU", "rhoE"):
            np.testing.assert_array_equal(harness.haff.Case(again).field(field), result.field(field))
        other = self.moving_wall("couetteCells")
        with open(os.path.join(other, "system", "fvSchemes"), "a") as f:
            f.write("meshEngine polyhedral;\n")
        harness.program("granularGas", "-case", other)
        np.testing.assert_allclose(harness.haff.Case(other).field("U")[:, 0], result.field("U")[:, 0], atol=2e-3)
        np.testing.assert_allclose(harness.haff.Case(other).field("T"), result.field("T"), atol=5e-3)
        for U, words in (("(0.5 0.1 0)", r"0/U:\d+: patch yHigh: U .*leads through the wall"),
                         ("(0.5 0 1)", r"granularProperties:\d+: .*TorquatoDisks is for disks, which move in a plane")):
            done = harness.program("granularGas", "-case", self.moving_wall(f"wrong{len(words)}", U), check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stdout + done.stderr, words)
        for cold, words in (("granularWall; restitution 1.2", "restitution is 1.2; allowed is 0 .. 1"), ("granularWall; restitution uniform 0.8", "number"),
                            ("granularWall; restitutoin 0.8", "'restitution' is missing"), ("granularWal; restitution 1", "did you mean 'granularWall'")):
            done = harness.program("granularGas", "-case", self.moving_wall("wrongT", cold=cold), check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn(words, done.stdout + done.stderr)

    def test_refused(self):
        ones = np.ones(4)
        for name, options, words in (("spheres", {"eos": "TorquatoSpheres"}, "JenkinsRichman is for disks"),
                                     ("unknown", {"transport": "JenkinsRichmann"}, "did you mean 'JenkinsRichman'"),
                                     ("bulk", {"transport": "JenkinsRichman; JenkinsRichmanCoeffs { bulk half; }"}, "corrected, paper"),
                                     ("type", {"diffusion": "RKL3"}, "RKJ2, RKL2, explicit")):
            with self.subTest(name):
                case = self.box(name, (4, 1, 1), density(0.3) * ones, np.zeros((4, 3)), ones, 1.0, **options)
                done = harness.program("granularGas", "-case", case, check=False)
                self.assertEqual(done.returncode, 1)
                self.assertIn(words, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
