# SPDX-License-Identifier: GPL-3.0-or-later
"""Enskog's contact values, pressure and cooling against tables of an independent derivation (50 digits), and against
what a Maxwellian gas must do."""
import csv
import os
import unittest

import numpy as np

from tests.cases import harness

from haff.start import enskog


def table(name):
    with open(os.path.join(harness.SOURCE, "tests", "oracles", name)) as f:
        return list(csv.DictReader(f))


class Enskog(unittest.TestCase):
    def test_contact_values(self):
        for row in table("torquato_chi.csv"):
            d, delta, phi = int(row["d"]), float(row["delta"]), float(row["phi"])
            close = enskog.TORQUATO[d][1]
            rounding = 2e-14 + 2.3e-16 * phi / (close - phi)  # of phi, near the pole
            np.testing.assert_allclose(enskog.torquato(phi, d, delta), float(row["chi"]), rtol=rounding, err_msg=str(row))

    def test_slope_of_the_fluid(self):
        for row in table("torquato_chi.csv"):
            d, phi = int(row["d"]), float(row["phi"])
            if phi < enskog.TORQUATO[d][0] - 0.011:
                found = enskog.fluid(phi, d)[1:]
                np.testing.assert_allclose(found, [float(row["dchi_dphi"]), float(row["d2chi_dphi2"])], rtol=1e-13)

    def test_coefficients(self):
        """The tables give the contact value itself, so that the reduced coefficients do not depend on it."""
        for d, name in ((2, "garzo_2d.csv"), (3, "garzo_dufty_3d.csv")):
            for row in table(name):
                e, phi, chi = float(row["alpha"]), float(row["phi"]), float(row["chi"])
                given = lambda phi, d: chi
                message = f"d {d}, e {e}, phi {phi}"
                np.testing.assert_allclose(enskog.a2(e, d), float(row["a2"]), rtol=1e-13, atol=1e-16, err_msg=message)
                np.testing.assert_allclose(enskog.pressure_factor(phi, e, d, given), float(row["pstar"]), rtol=1e-14)
                np.testing.assert_allclose(enskog.reduced_cooling_rate(phi, e, d, given), float(row["zeta0"]), rtol=1e-13,
                                           atol=1e-16, err_msg=message)
                np.testing.assert_allclose(enskog.torquato(phi, d), chi, rtol=1e-11, err_msg=message)

    def test_homogeneous_cooling(self):
        """Spheres with Garzo's rate (T in J there); disks with the rate of a Maxwellian (Carrillo et al., 2.15)."""
        mass = 2600 * enskog.volume(3, 1e-3)
        cases = {"GD3D": (3, 1e-3, mass, True), "Carrillo2D": (2, 0.01, 1.0, False)}
        found = 0
        for row in table("hcs.csv"):
            known = cases.get(row["model"].split()[0])
            if known:
                d, sigma, m, sonine = known
                e, phi, T, t = (float(row[k]) for k in ("e", "phi", "T0", "t"))
                cooled = m * enskog.cooled(T / m, t, phi, e, d, sigma, sonine=sonine)
                np.testing.assert_allclose(cooled, float(row["T"]), rtol=1e-12, err_msg=str(row))
                found += 1
        self.assertEqual(found, 18)

    def test_haff_time(self):
        t = enskog.haff_time(0.2, 3.0, 0.9, 2, 0.5)
        self.assertAlmostEqual(enskog.cooled(3.0, t, 0.2, 0.9, 2, 0.5), 0.75, places=14)

    def test_maxwellian_pairs(self):
        """Rates by Monte Carlo: pairs meet with the flux of their normal relative velocity w > 0, lose m (1 - e^2) w^2 / 4
        and transfer m (1 + e) w / 2 over a branch sigma."""
        rng, n = np.random.default_rng(7), 400000
        for d in (2, 3):
            sigma, phi, T, e = 0.7, 0.25, 2.3, 0.8
            w = np.abs(rng.normal(size=n)) * np.sqrt(2 * T)  # of a pair; half of them approach
            chi = enskog.torquato(phi, d)
            density = phi / enskog.volume(d, sigma)
            surface = (2 * np.pi * sigma) if d == 2 else 4 * np.pi * sigma**2
            flux = density * chi * surface * w / 2  # per grain; the mean over w is the rate of impacts
            np.testing.assert_allclose(enskog.collision_rate(phi, T, d, sigma), flux.mean(), rtol=5e-3)
            loss = (flux * (1 - e**2) * w**2 / 4).mean() / 2  # half a pair each
            np.testing.assert_allclose(enskog.cooling_rate(phi, T, e, d, sigma, sonine=False), loss / (d * T / 2), rtol=1e-2)
            virial = (flux * (1 + e) * w / 2).mean() / 2 * sigma / d
            np.testing.assert_allclose(enskog.pressure_factor(phi, e, d), 1 + virial / T, rtol=5e-3)

    def test_virial_coefficients(self):
        """chi = 1 + (B3/B2) rho ... : 1 + 0.782 * 2 phi for disks, 1 + 5/2 phi for spheres."""
        exact = {2: 2 * (4 / 3 - np.sqrt(3) / np.pi), 3: 2.5}
        for name, chi in enskog.CHI.items():
            for d in (2, 3) if name != "Luding" else (2,):
                slope = (chi(1e-6, d) - 1) / 1e-6
                self.assertLess(abs(slope / exact[d] - 1), 2e-3, f"{name}, d = {d}")

    def test_luding_is_of_disks(self):
        with self.assertRaises(ValueError):
            enskog.luding(0.1, 3)


if __name__ == "__main__":
    unittest.main()
