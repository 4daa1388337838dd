# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas at rest under gravity stays at rest to round-off on lattices: on any axis, at any T(height), by every equation of state, with
every reconstruction and Runge-Kutta scheme; and what moves on it converges."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.gas import test_layers
from tests.cases.harness import boxes

COLUMN = "settledLayer { depth 6; packing 0.8; background 1e-30; }"
STEPS = 1000


class Rest(harness.Folder, unittest.TestCase):
    case = test_layers.Layers.case

    def steps(self, case, steps, dt):
        """The case after n steps of dt."""
        path = os.path.join(case, "system", "controlDict")
        with open(path) as f:
            text = f.read()
        for key, value in (("adjustTimeStep", "no"), ("deltaT", repr(dt)), ("endTime", repr(steps * dt)), ("writeInterval", repr(steps * dt))):
            text = re.sub(rf"\b{key} \S+;", f"{key} {value};", text)
        with open(path, "w") as f:
            f.write(text)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def scheme(self, case, old, new):
        path = os.path.join(case, "system", "fvSchemes")
        with open(path) as f:
            text = f.read()
        self.assertIn(old, text)
        with open(path, "w") as f:
            f.write(text.replace(old, new))

    def stays(self, case, dt):
        start = harness.haff.Case(case)
        after = self.steps(case, STEPS, dt)
        fastest = np.abs(after.field("U")).max() / np.sqrt(after.field("T").max())
        self.assertLess(fastest, 1e-12)
        self.assertGreater(after.field("alpha").max() / after.field("alpha").min(), 1.2)
        return start, after

    def test_places(self):
        """In one, two and three dimensions, on either side of the box; T may vary from layer to layer, smoothly or not."""
        for name, dt, options in (
                ("line", 2e-3, dict(n=(1, 40, 1), size=(0.5, 10.0, 0.5), T=5.0)),
                ("lying", 1e-3, dict(n=(40, 1, 1), size=(10.0, 0.5, 0.5), T=30.0, up=0)),
                ("plane", 2e-3, dict(n=(8, 40, 1), size=(2.0, 10.0, 0.5), T="5 + 0.4*y")),
                ("jumps", 1e-3, dict(n=(8, 40, 1), size=(2.0, 10.0, 0.5), T="y < 3 ? 5 : y < 6 ? 20 : 8", sign=-1)),
                ("across", 1e-3, dict(n=(40, 8, 1), size=(10.0, 2.0, 0.5), T=5.0, up=0, sign=-1)),
                ("space", 1e-3, dict(n=(4, 4, 30), size=(1.0, 1.0, 10.0), T=5.0, up=2, eos="GoldshteinShapiro"))):
            with self.subTest(name):
                self.stays(self.case(name, COLUMN, **options), dt)

    def test_schemes(self):
        """Schemes and equations of state."""
        for i, (words, eos) in enumerate((
                ("fluxScheme common; reconstruct PHM; timeScheme SSPRK43;", "TorquatoSpheres"),
                ("fluxScheme common; reconstruct WENO5; timeScheme SSPRK104;", "GoldshteinShapiro"),
                ("fluxScheme common; reconstruct TENO5; timeScheme SSPRK2;", "TorquatoSpheres"),
                ("fluxScheme Marquina; reconstruct WENOZ; timeScheme SSPRK3;", "TorquatoDisks"))):
            with self.subTest(words):
                case = self.case(f"scheme{i}", COLUMN, n=(1, 40, 1), size=(0.5, 10.0, 0.5), T=5.0, eos=eos)
                self.scheme(case, "fluxScheme common; reconstruct WPENO5; timeScheme SSPRK3;", words)
                self.stays(case, 5e-4)

    def test_two_bases(self):
        """Marquina's fluxes, whose bases differ where T jumps."""
        for flux in ("Marquina", "MarquinaStable"):
            for reconstruct in ("PHM", "WPENO5", "TENO5"):
                with self.subTest(flux=flux, reconstruct=reconstruct):
                    case = self.case(flux + reconstruct, COLUMN, n=(1, 40, 1), size=(0.5, 10.0, 0.5), T="y < 3 ? 5 : y < 6 ? 20 : 8")
                    self.scheme(case, "fluxScheme common; reconstruct WPENO5;", f"fluxScheme {flux}; reconstruct {reconstruct};")
                    self.stays(case, 1e-3)

    def test_damping(self):
        """Fluxes that damp jumps, which a column at rest has from cell to cell."""
        for flux in ("LaxFriedrichs", "globalLaxFriedrichs", "FORCE", "MUSTA", "Rusanov"):
            for reconstruct, T in (("PHM", 5.0), ("TENO5", "y < 3 ? 5 : y < 6 ? 20 : 8")):
                with self.subTest(flux=flux, reconstruct=reconstruct):
                    case = self.case(flux + reconstruct, COLUMN, n=(1, 40, 1), size=(0.5, 10.0, 0.5), T=T)
                    self.scheme(case, "fluxScheme common; reconstruct WPENO5;", f"fluxScheme {flux}; reconstruct {reconstruct};")
                    self.stays(case, 1e-3)

    def test_without_heat(self):
        """A gas whose impacts are all too slow to cool, and one that conducts heat at a uniform T."""
        case = self.case("threshold", COLUMN, n=(1, 40, 1), size=(0.5, 10.0, 0.5), T=5.0)
        harness.edit(case, "constant/granularProperties", restitution="0.9; thresholdSpeed 1e3")
        self.stays(case, 1e-3)
        case = self.case("conducting", COLUMN, n=(1, 40, 1), size=(0.5, 10.0, 0.5), T=5.0)
        with open(os.path.join(case, "constant", "granularProperties"), "a") as f:
            f.write("\ntransport JenkinsRichman;\n")
        self.stays(case, 1e-3)

    def test_waves(self):
        """A wave that runs through a layer converges at second order, and no grid makes it louder than another."""
        coarse, last = None, None
        for n in (50, 100, 200, 400):
            case = self.case(f"wave{n}", "settledLayer { depth 4; packing 0.8; background 1e-30; }", n=(1, n, 1), size=(0.5, 10.0, 0.5), T=30.0,
                             eos="GoldshteinShapiro", end=0.3)
            with open(os.path.join(case, "0", "U"), "w") as f:
                f.write(boxes.header("volVectorField", "U", "0") + "dimensions [0 1 -1 0 0 0 0];\nexpression (\"0\" \"0.05*exp(-(y-4)^2)\" \"0\");\n"
                        'boundaryField { "(x|z).*" { type empty; } "y.*" { type slip; } }\n')
            harness.program("granularGas", "-case", case)
            u = harness.haff.Case(case).field("U")[:, 1].reshape(50, -1).mean(axis=1)
            if coarse is not None:
                difference = np.abs(u - coarse).max()
                if last:
                    self.assertGreater(last / difference, 2 ** 1.7)
                last = difference
            coarse = u
        self.assertLess(last, 2e-3 * 0.05)


if __name__ == "__main__":
    unittest.main()
