"""A gas of disks with Torquato's contact value, through the program."""
import os
import unittest

import numpy as np

from tests.cases import harness

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
        """No density is forbidden: a gas beyond close packing stays at rest, and a dense one hits a wall and rebounds."""
        ones = np.ones(8)
        case = self.box("beyond", (8, 1, 1), density(0.83) * ones, np.zeros((8, 3)), ones, 1e-3)
        np.testing.assert_array_equal(case.field("rho"), density(0.83) * ones)
        ones = np.ones(100)
        case = self.box("wall", (100, 1, 1), density(0.78) * ones, np.outer(10 * ones, (1, 0, 0)), 1e4 * ones, 0.02,
                        types=None, slip=("xHigh",))
        self.assertGreater(case.field("alpha").max(), 0.8)

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


if __name__ == "__main__":
    unittest.main()
