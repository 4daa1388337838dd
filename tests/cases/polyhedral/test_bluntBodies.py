# SPDX-License-Identifier: GPL-3.0-or-later
"""Bow shocks ahead of a cylinder and a sphere: in air where experiments have them, in a cooling gas nearer to the body."""
import unittest

from tests.cases import harness

from studies.exact.eos import of_case  # noqa: E402
from studies.measured import shocks  # noqa: E402

PERFECT = {"equationOfState": "perfectGas", "cooling": "none"}


class Bodies(harness.Folder, unittest.TestCase):
    def stand_off(self, name, cells, restitution=None, **control):
        """restitution None: air."""
        case = harness.copy(name, self.folder)
        harness.mesh(case, cells)
        properties = "constant/granularProperties"
        if restitution is None:
            harness.edit(case, properties, gamma=1.4, **PERFECT)
            with open(f"{case}/{properties}") as f:
                text = f.read().replace("GoldshteinShapiroCoeffs", "perfectGasCoeffs").replace(
                    " alphaMax 0.65; printedSoundSpeed no;", "")
            with open(f"{case}/{properties}", "w") as f:
                f.write(text)
            mach = {"cylinder": 4, "sphere3D": 3}[name]
            with open(f"{case}/0.orig/T") as f:
                lines = f.read().split("uniform ")
            with open(f"{case}/0.orig/T", "w") as f:
                f.write("uniform ".join(lines[:1] + [f"{1e4 / mach**2 / 1.4!r};" + part.split(";", 1)[1] for part in lines[1:]]))
        else:
            harness.edit(case, properties, restitution=restitution)
        result = harness.run(case, **control)
        stream = shocks.upstream(result, of_case(result))
        return shocks.stand_off(result, stream), stream.mach

    def test_cylinder(self):
        air, mach = self.stand_off("cylinder", 8, endTime=1)
        self.assertAlmostEqual(mach, 4, delta=1e-3)
        # the shock is smeared over about two cells of an eighth of the radius: within half of one
        self.assertAlmostEqual(air, shocks.billig(mach, "cylinder"), delta=0.0625)
        elastic, cooling = (self.stand_off("cylinder", 8, e, endTime=1)[0] for e in (1, 0.98))
        self.assertGreater(elastic, 1.2 * air, "a denser gas is compressed less, so it needs more room")
        self.assertLess(cooling, 0.7 * elastic)

    def test_sphere(self):
        air, mach = self.stand_off("sphere3D", 10)
        self.assertAlmostEqual(mach, 3, delta=1e-3)
        self.assertAlmostEqual(air, shocks.billig(mach, "sphere"), delta=0.1)  # one cell


if __name__ == "__main__":
    unittest.main()
