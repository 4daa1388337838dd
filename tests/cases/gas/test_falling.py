# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas that falls on a wall and lies there in motion: the cells beside the wall are smooth, and Marquina's flux gives the paper's step."""
import os
import unittest

import numpy as np

from tests.cases import harness

RHO, P, SPEED, GRAVITY = 343.774677, 10174.873548, 44.547727, 692.964646  # of cases/wedgeDense, along one axis
LAST = 5


class Falling(harness.Folder, unittest.TestCase):
    def fall(self, name, n, flux, reconstruct, gravity=GRAVITY):
        """alpha in n cells of a column of 5 cm after 0.04 s."""
        case = harness.box_case(os.path.join(self.folder, name), (n, 1, 1), (5.0, 5.0 / n, 5.0 / n), np.full(n, RHO), np.tile((SPEED, 0.0, 0.0), (n, 1)),
                                np.full(n, P), 0.04, types={"xHigh": "wall"}, slip=("xHigh",), gravity=(gravity, 0.0, 0.0), e=0.97, cooling="Haff",
                                flux=flux, reconstruct=reconstruct)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case).field("alpha")

    def test_smooth_at_the_wall(self):
        """alpha rises to the wall, as without gravity, and is that of a fine grid to a hundredth (less than the heating of walls by
        `common`, 0.03 in the last cell; two bases that lose the pressure at rest zigzag by 0.1)."""
        fine = self.fall("fine", 1000, "common", "PHM").reshape(100, 10).mean(axis=1)
        for flux in ("Marquina", "MarquinaStable"):
            for reconstruct in ("PHM", "WPENO5", "WENO5", "WENOZ", "firstOrder"):
                with self.subTest(flux=flux, reconstruct=reconstruct):
                    alpha = self.fall(flux + reconstruct, 100, flux, reconstruct)[-LAST:]
                    self.assertTrue(np.all(np.diff(alpha) > 0), alpha)
                    np.testing.assert_allclose(alpha, fine[-LAST:], rtol=0.03 if reconstruct == "firstOrder" else 0.01)

    def test_next_to_no_gravity(self):
        """What weighs nothing changes nothing: no flux is another one as soon as there is gravity."""
        for flux in ("common", "Marquina", "MarquinaStable", "LaxFriedrichs", "globalLaxFriedrichs", "FORCE", "MUSTA", "Rusanov"):
            with self.subTest(flux):
                alpha = [self.fall(f"{flux}{g}", 50, flux, "PHM", g) for g in (0.0, 1e-6)]
                np.testing.assert_allclose(alpha[1], alpha[0], rtol=1e-5)

    def test_step(self):
        """cases/wedgeDense by the paper's scheme: the maximum on 100 x 100 cells, 0.51132 before gravity was balanced, and 0.51751, the
        paper's, on 400 x 400; along the wall's end alpha rises to the wall."""
        case = harness.copy("wedgeDense", self.folder)
        harness.edit(case, "constant/granularProperties", printedSoundSpeed="yes")
        harness.edit(case, "system/fvSchemes", fluxScheme="Marquina")
        harness.mesh(case, 100)
        case = harness.run(case)
        alpha, (x, y) = case.field("alpha"), case.centres[:, :2].T
        self.assertAlmostEqual(alpha.max(), 0.51132, delta=2e-4)
        row = (y < 0.1) & (x < 5)
        self.assertTrue(np.all(np.diff(alpha[row][np.argsort(x[row])][-LAST:]) > 0))


if __name__ == "__main__":
    unittest.main()
