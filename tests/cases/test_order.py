"""Order of accuracy on a smooth simple wave in the granular gas: periodic line, e = 1, no source."""
import os
import unittest

import numpy as np

from tests.cases import boxes, harness
from eos import GoldshteinShapiro
from simpleWave import SETTINGS, SimpleWave

CONTROL = """application granularGas; startFrom startTime; startTime 0; stopAt endTime; endTime %.17g;
deltaT %.17g; adjustTimeStep no; maxCo 0.5; writeControl runTime; writeInterval %.17g; writeFormat binary;
writePrecision 17; timePrecision 12;
"""
PROPERTIES = """grain { diameter 0.1; mass 1; restitution 1; }
equationOfState GoldshteinShapiro;
GoldshteinShapiroCoeffs { gamma 1.6666666666666667; alphaMax 0.65; }
cooling none; transport none;
"""
SCHEMES = "fluxScheme %s; reconstruct %s; timeScheme SSPRK3;\n"


def write(case, location, name, text):
    os.makedirs(os.path.join(case, location), exist_ok=True)
    with open(os.path.join(case, location, name), "w") as f:
        f.write(boxes.header("dictionary", name, location) + text)


class Order(harness.Folder, unittest.TestCase):
    def error(self, wave, cells, flux, reconstruct, end):
        """L1 error of rho at time `end`, relative to the mean; time steps fall faster than h where the order asks."""
        case = os.path.join(self.folder, f"{flux}_{reconstruct}_{cells}_{len(os.listdir(self.folder))}")
        boxes.write_mesh(case, (cells, 1, 1), (1.0, 0.1, 0.1), {"x": "cyclic"})
        x = boxes.centres((cells, 1, 1), (1.0, 0.1, 0.1))[:, 0]
        patches = "xLow cyclic\nxHigh cyclic\nyEmpty empty\nzEmpty empty"
        rho, u, p = wave.at(x, 0.0)
        boxes.write_field(case, "rho", rho, patches)
        boxes.write_field(case, "p", p, patches)
        boxes.write_field(case, "U", np.stack([u, 0 * u, 0 * u], axis=1), patches)
        steps = np.ceil(end * np.abs(wave.speed(x)).max() / (0.4 / cells * (50 / cells) ** (2 / 3)))
        write(case, "system", "controlDict", CONTROL % (end, end / steps, end))
        write(case, "system", "fvSchemes", SCHEMES % (flux, reconstruct))
        write(case, "system", "fvSolution", "")
        write(case, "constant", "granularProperties", PROPERTIES)
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        time = result.times[-1]
        self.assertAlmostEqual(float(time), end, delta=1e-9 * end)
        return np.abs(result.field("rho", time) - wave.at(x, end)[0]).mean() / wave.rho0

    def test_orders(self):
        for name, velocity in SETTINGS.items():
            wave = SimpleWave(GoldshteinShapiro(1.0), velocity=velocity)
            end = float("%.12g" % (0.3 * wave.breaking_time))
            for reconstruct, least in (("PHM", 1.9), ("WPENO5", 3.4), ("WENO5", 4.7)):
                with self.subTest(f"{name} {reconstruct}"):
                    coarse, fine = (self.error(wave, n, "common", reconstruct, end) for n in (100, 200))
                    order = np.log2(coarse / fine)
                    self.assertGreater(order, least, f"errors {coarse:.3e}, {fine:.3e}")


if __name__ == "__main__":
    unittest.main()
