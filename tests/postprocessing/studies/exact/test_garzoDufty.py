# SPDX-License-Identifier: GPL-3.0-or-later
"""The closures of Garzo & Dufty in Python against the oracles, and a gas without inelasticity."""
import csv
import os
import unittest

import numpy as np

from tests.cases import harness

from studies.exact import garzoDufty  # noqa: E402


class Closures(unittest.TestCase):
    def test_oracles(self):
        for d, name in ((3, "garzo_dufty_3d.csv"), (2, "garzo_2d.csv")):
            with open(os.path.join(harness.SOURCE, "tests", "oracles", name)) as f:
                rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(f)]
            checked = 0
            for r in rows:
                if r["phi"] < 1e-3 or r["phi"] > 0.98 * garzoDufty.Grains(d, 1).packed:
                    continue  # slopes are by differences there
                gas = garzoDufty.Grains(d, r["alpha"])
                bulk, shear, heat, cross, zeta = gas.starred(r["phi"])
                for found, key in ((bulk, "gamma"), (shear, "eta"), (heat, "kappa"), (zeta, "zeta0"), (gas.A(r["phi"]), "pstar"),
                                   (gas.zeta_u(r["phi"]), "zetaU_geo")):
                    self.assertAlmostEqual(found, r[key], delta=1e-11 * max(1, abs(r[key])), msg=f"{key} {r}")
                self.assertAlmostEqual(cross, r["mu"], delta=1e-6 * max(1, abs(r["mu"])), msg=f"mu {r}")
                checked += 1
            self.assertGreater(checked, 80)

    def test_elastic(self):
        gas = garzoDufty.Grains(3, 1)
        self.assertTrue(np.all(np.array(gas.starred(0.3))[3:] == 0))


if __name__ == "__main__":
    unittest.main()
