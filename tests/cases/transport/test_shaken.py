# SPDX-License-Identifier: GPL-3.0-or-later
"""Short forms of heatedColumn, shockLayer and leidenfrost: a column beside its steady equations, two shaken layers beside the grains of their cases; and of
blastCold, gas and grains."""
import unittest

import numpy as np

from tests.cases import harness

from studies.checks import coldBlast, shockLayers, vibrated
from studies.exact import disks


def of_grains(name, quantity, folder, **wanted):
    """What the grains of a case have by its expected.json."""
    found = [e for e in harness.expected.load(f"{harness.SOURCE}/cases/{name}", "full")
             if e["quantity"] == quantity and e.get("folder") == folder and all(e[k] == v for k, v in wanted.items())]
    assert len(found) == 1
    return found[0]["value"]


class Short(harness.Folder, unittest.TestCase):
    def test_column(self):
        """T falls and rises again as by the steady equations, to second order in the cells."""
        errors = []
        for cells in (20, 40):
            case = self.short("heatedColumn", cells, endTime=800, writeInterval=800)
            errors.append(disks.error(case, vibrated.column(case), "T", axis=1))
        self.assertTrue(3 < errors[0] / errors[1] < 6, errors)
        self.assertLess(errors[1], 0.01)

    def test_shocks(self):
        """On cells twice as large the layer has its centre of mass at three phases within 3 % of the grains."""
        case = self.short("shockLayer", 60, endTime=70)
        for phase in (0.9, 0.1, 0.5):
            centre = shockLayers.columns.centre(shockLayers.at(case, phase))
            known = of_grains("shockLayer", "centre of mass at a phase", "grains", at=phase)
            self.assertAlmostEqual(centre, known, delta=0.03 * known)

    def test_floating_layer(self):
        """The layer floats at S = 36, at the height of the grains within 5 %, and lies at S = 4."""
        found = {}
        for strength in (4, 36):
            case = harness.copy("leidenfrost", self.folder)
            harness.edit(case, "constant/shaking", amplitude=strength, frequency=np.sqrt(strength) / (2 * np.pi))
            harness.mesh(case, 60)
            found[strength] = vibrated.shaken(harness.run(case, endTime=80))
            known = of_grains("leidenfrost", "mean height of the centre of mass", f"grains{strength}")
            self.assertAlmostEqual(vibrated.columns.centre(found[strength]), known, delta=0.05 * known)
        self.assertLess(vibrated.inversion(found[36]), 0.5)
        self.assertGreater(vibrated.inversion(found[4]), 0.5)

    def test_plough(self):
        """The shell keeps its momentum, R ~ t^(1/3); gas and grains, on cells twice as large."""
        case = harness.copy("blastCold", self.folder)
        harness.mesh(case, 72)
        for program in ("granularMD", "granularGas"):
            harness.edit(case, "system/controlDict", application=program, deltaT={"granularMD": 10, "granularGas": 1e-3}[program])
            harness.program(program, "-case", case)
            radius, momentum = coldBlast.exponents(harness.haff.Case(case))
            self.assertAlmostEqual(radius, 1 / 3, delta=0.03)
            self.assertAlmostEqual(momentum, 0, delta=0.06)
            harness.subprocess.run(["sh", "-c", f"cd {case} && rm -rf 0 [1-9]*"], check=True)


if __name__ == "__main__":
    unittest.main()
