# SPDX-License-Identifier: GPL-3.0-or-later
"""What must stay as it is with the default flux: gas at rest with noise, contacts at rest, a free stream, free fall."""
import os
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes
from studies.exact.eos import GoldshteinShapiro

GAS = GoldshteinShapiro(1.0)


class Quiet(harness.Folder, unittest.TestCase):
    def line(self, name, cells, rho, u, p, end, **options):
        case = harness.box_case(os.path.join(self.folder, name), (cells, 1, 1), (1.0, 0.1, 0.1), rho,
                                np.outer(u, (1, 0, 0)), p, end, **options)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def test_noise(self):
        """Uniform gas at rest with 1e-6 of noise, periodic, 200 cells, sound crosses the box twice."""
        noise = np.random.default_rng(3).uniform(-1e-6, 1e-6, (3, 200))
        for nu in (0.05, 0.3, 0.45, 0.5, 0.55, 0.6):
            rho, c = GAS.rho(nu), GAS.c(GAS.rho(nu), 1.0)
            p = GAS.p(rho, 1.0)
            for reconstruct in ("PHM", "WPENO5"):
                with self.subTest(f"{nu} {reconstruct}"):
                    case = self.line(f"noise{nu}{reconstruct}", 200, rho * (1 + noise[0]), c * noise[1],
                                     p * (1 + noise[2]), 2 / c, types={"x": "cyclic"}, reconstruct=reconstruct)
                    # a density wave of 1e-6 is a pressure wave of gamma_A 1e-6
                    bound = 3e-6 * GAS.adiabatic_exponent(nu)
                    self.assertLess(np.abs(case.field("U")[:, 0]).max() / c, bound)
                    self.assertLess(np.abs(case.field("p") / p - 1).max(), bound)

    def test_contacts(self):
        """A jump of density at equal pressure, at rest: stays to round-off."""
        left = np.arange(100) < 50
        for low, high in ((0.05, 0.1), (0.35, 0.45), (0.5, 0.6)):
            rho = np.where(left, GAS.rho(low), GAS.rho(high))
            p = GAS.p(GAS.rho(low), 1.0)
            c = GAS.c(GAS.rho(high), GAS.T(GAS.rho(high), p))
            with self.subTest(f"{low} | {high}"):
                case = self.line(f"contact{low}", 100, rho, 0 * rho, 0 * rho + p, 1 / c)
                np.testing.assert_allclose(case.field("rho"), rho, rtol=1e-13)
                np.testing.assert_allclose(case.field("p"), p, rtol=1e-13)
                self.assertLess(np.abs(case.field("U")).max() / c, 1e-13)

    def test_free_stream(self):
        """Uniform gas that flies, falls and cools through a box in 2D stays uniform to the bit and follows the formula."""
        gas = GoldshteinShapiro(0.97)
        n, size = (40, 24, 1), (4.0, 2.4, 0.1)
        ones, end = np.ones(np.prod(n)), 0.02
        rho, p = 34.3774677, 1589.2685472
        case = harness.box_case(os.path.join(self.folder, "stream"), n, size, rho * ones,
                                np.outer(ones, (44.547727, -31.0, 0)), p * ones, end, e=0.97, cooling="Haff",
                                gravity=(690.0, -300.0, 0.0))
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        for field in ("rho", "U", "T", "p"):
            values = result.field(field)
            np.testing.assert_array_equal(values, np.broadcast_to(values[:1], values.shape), err_msg=field)
        T = gas.cooled(rho, gas.T(rho, p), end)
        np.testing.assert_allclose(result.field("T")[0], T, rtol=1e-12)
        np.testing.assert_allclose(result.field("U")[0], (44.547727 + 690 * end, -31 - 300 * end, 0), rtol=1e-12)
        self.assertEqual(result.field("rho")[0], rho)

    def test_homogeneous_cooling(self):
        """Haff's law over the oracle's times."""
        path = os.path.join(harness.SOURCE, "tests", "oracles", "hcs.csv")
        with open(path) as f:
            rows = [line.strip().split(",") for line in f if line.startswith("GS")]
        groups = {}
        for _, e, phi, T0, t, T in rows:
            groups.setdefault((e, phi, T0), []).append((float(t), float(T)))
        self.assertTrue(groups)
        for (e, phi, T0), series in groups.items():
            gas = GoldshteinShapiro(float(e))
            rho = gas.rho(float(phi)) * np.ones(8)
            t, T = series[-1]
            with self.subTest(f"e = {e}, nu = {phi}, t = {t}"):
                case = self.line(f"hcs{e}_{phi}", 8, rho, 0 * rho, gas.p(rho, float(T0)), t, e=float(e), cooling="Haff",
                                 types={"x": "cyclic"}, step=t / 1000, adjust="no", control="runTime")
                np.testing.assert_allclose(case.field("T"), T, rtol=1e-10)


if __name__ == "__main__":
    unittest.main()
