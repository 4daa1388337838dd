"""Order of accuracy on a smooth simple wave in the granular gas (e = 1, no source), along an axis and along a diagonal.

The solution is the exact one of postprocessing/simpleWave.py at t = 0.3 of breaking, in the L1 norm; the time step falls
like h^(5/3), so that the third-order time scheme does not show. The least orders are those of issue and prototype.
"""
import os
import unittest

import numpy as np

from tests.cases import boxes, harness
from eos import GoldshteinShapiro
from simpleWave import SETTINGS, SimpleWave

LEAST = {"PHM": 1.9, "WPENO5": 3.4, "WENO5": 4.7}
SIZE = (1.0, 1.0, 0.1)


class Order(harness.Folder, unittest.TestCase):
    def error(self, wave, n, reconstruct, end, monotone=False):
        """L1 error of rho relative to its mean. n = (cells, 1, 1): wave along x; (cells, cells, 1): along (1, 1)."""
        case = os.path.join(self.folder, str(len(os.listdir(self.folder))))
        size = SIZE if n[1] > 1 else (1.0, 0.1, 0.1)
        direction = np.array((1, 1, 0)) if n[1] > 1 else np.array((1, 0, 0))
        phase = boxes.centres(n, size) @ direction
        # a wave along (1, 1) moves by speed*sqrt(2) along x: lengths and speeds both carry the factor
        normal = direction / np.linalg.norm(direction)
        stretch = np.linalg.norm(direction)

        def exact(t):
            return wave.at(phase % 1.0 if not monotone else phase, t * stretch)

        rho, u, p = exact(0.0)
        fastest = (np.abs(u) + wave.eos.c(rho, wave.eos.T(rho, p))).max() * stretch**2
        steps = np.ceil(end * fastest / (0.4 / n[0] * (50 / n[0]) ** (2 / 3)))
        types = {} if monotone else {"x": "cyclic", "y": "cyclic"}
        harness.box_case(case, n, size, rho, np.outer(u, normal), p, end, types=types, reconstruct=reconstruct,
                         adjust="no", step=end / steps, control="runTime")
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        self.assertAlmostEqual(float(result.times[-1]) / end, 1, delta=1e-9)
        return np.abs(result.field("rho") - exact(end)[0]).mean() / wave.rho0

    def orders(self, velocity, cells, schemes, **options):
        wave = SimpleWave(GoldshteinShapiro(1.0), velocity=velocity, tanh=options.get("monotone", False))
        flat = cells[0] if isinstance(cells[0], tuple) else None
        end = float("%.12g" % (0.3 * wave.breaking_time / (np.sqrt(2) if flat else 1)))
        for reconstruct, least in schemes.items():
            with self.subTest(f"velocity {velocity:g} c, {reconstruct}"):
                sizes = [n if flat else (n, 1, 1) for n in cells]
                coarse, fine = (self.error(wave, n, reconstruct, end, **options) for n in sizes)
                order = np.log(coarse / fine) / np.log(sizes[1][0] / sizes[0][0])
                self.assertGreater(order, least, f"errors {coarse:.3e}, {fine:.3e}")

    def test_line(self):
        for velocity in SETTINGS.values():
            self.orders(velocity, (100, 200), LEAST)

    def test_monotone(self):
        """A front without extrema, flat at both ends: PHM is of third order."""
        self.orders(SETTINGS["subsonic"], (400, 800), {"PHM": 2.8}, monotone=True)

    def test_diagonal(self):
        self.orders(SETTINGS["subsonic"], ((32, 32, 1), (64, 64, 1)), {"PHM": 1.9, "WPENO5": 3.0})


if __name__ == "__main__":
    unittest.main()
