# SPDX-License-Identifier: GPL-3.0-or-later
"""What is prescribed on a patch comes in: flow rates by volume, and nothing where a given velocity leads along the patch. A patch
through which nothing can flow is a wall, and has to say so."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes

N, SIZE = (12, 8, 1), (1.2, 0.8, 0.1)
AREA = SIZE[1] * SIZE[2]
POLYHEDRAL = "meshEngine polyhedral; polyReconstruct CWENO3;\n"


class Prescribed(harness.Folder, unittest.TestCase):
    def case(self, name, U, rho="zeroGradient", T="zeroGradient", engine="", end=0.02, **options):
        """A closed box of gas that moves, but for the rules of its low side along x."""
        one = np.ones(np.prod(N))
        x, y = boxes.centres(N, SIZE)[:, :2].T
        fields = {"rho": 50 + 10 * np.cos(3 * x), "T": 10 * one, "U": np.outer(np.sin(3 * x + y), (1, 0.3, 0))}
        case = harness.box_case(os.path.join(self.folder, name), N, SIZE, fields["rho"], fields["U"], one, end, **options)
        os.remove(case + "/0/p")
        for field, wall in (("rho", "zeroGradient"), ("T", "zeroGradient"), ("U", "slip")):
            rule = {"rho": rho, "T": T, "U": U}[field]
            boxes.write_field(case, field, fields[field], f'xLow {rule}\n"(xHigh|y.*)" {wall}\nzEmpty empty')
        runs.add(case, "system/fvSchemes", engine)
        runs.add(case, "system/controlDict", "functions { mass { type volFieldValue; fields (rho); operation volIntegrate; "
                 "writeControl timeStep; writeInterval 1; } }\n")
        return case

    def mass(self, *arguments, **options):
        case = self.case(*arguments, **options)
        harness.program("granularGas", "-case", case)
        return np.loadtxt(case + "/postProcessing/mass/0/volFieldValue.dat").T

    def grown(self, t, mass, given):
        """The mass is what it was and what was given, to round-off of the sum."""
        np.testing.assert_allclose(mass - mass[0], given, rtol=1e-11, atol=len(t) * 2e-16 * mass[-1])

    def test_volume(self):
        """A flow of q m^3/s brings q rho t, with the density given on the patch, and with one that changes in time."""
        for engine in ("", POLYHEDRAL):
            with self.subTest(engine=engine):
                t, mass = self.mass(f"volume{len(engine)}", "flowRateInletVelocity; volumetricFlowRate 0.2; value uniform (0 0 0)",
                                    "fixedValue; value uniform 70", "fixedValue; value uniform 12", engine)
                self.assertGreater(len(t), 5)
                self.grown(t, mass, 0.2 * 70 * t)
        t, mass = self.mass("ramp", "flowRateInletVelocity; volumetricFlowRate table ((0 0) (1 60)); value uniform (0 0 0)",
                            "uniformFixedValue; uniformValue table ((0 70) (1 170)); value uniform 70", "fixedValue; value uniform 12")
        self.grown(t, mass, 60 * (70 * t**2 / 2 + 100 * t**3 / 3))

    def test_closed_by_a_table(self):
        """A pulse of a stream whose velocity is 0 from a time on: nothing flows then, whatever the pressure inside."""
        U = "uniformFixedValue; uniformValue table ((0 (5 0 0)) (0.005 (5 0 0)) (0.006 (0 0 0)) (0.03 (0 0 0))); value uniform (5 0 0)"
        for engine in ("", POLYHEDRAL):
            with self.subTest(engine=engine):
                t, mass = self.mass(f"table{len(engine)}", U, "fixedValue; value uniform 70", "fixedValue; value uniform 12", engine)
                closed = t >= 0.006 - 1e-12
                self.assertGreater(closed.sum(), 3)
                self.assertGreater(mass[closed][0] - mass[0], 0.01)
                self.grown(t[closed], mass[closed], 0 * t[closed])

    def test_closed_in_part(self):
        """Faces of an inlet where the velocity is 0 are closed, beside others through which a supersonic stream comes in."""
        rest = "fixedValue; value uniform 70", "fixedValue; value uniform 12"
        t, mass = self.mass("slit", 'exprFixedValue; valueExpr "vector(pos().y() < 0.4 ? 300 : 0, 0, 0)"; value uniform (0 0 0)', *rest, end=0.003)
        t, mass = t[5:], mass[5:]  # the shock has left the inlet: what is given is what comes in
        self.assertGreater(len(t), 20)
        self.grown(t, mass, 70 * 300 * AREA / 2 * (t - t[0]))

    def test_walls_say_so(self):
        """U along a patch, with alpha or T left to the gas, is refused as on a patch of type wall; with both it is the state outside."""
        along = ["fixedValue; value uniform (0 0 0)", "fixedValue; value uniform (0 2 0)", "uniformFixedValue; uniformValue (0 0 0)",
                 "uniformFixedValue; uniformValue table ((0 (0 0 0)) (1 (0 3 0)))", 'exprFixedValue; valueExpr "vector(0, sin(time()), 0)"',
                 'fixedValue; value uniform (9 0 0); expression ("0" "y" "0")']
        for i, U in enumerate(along):
            with self.subTest(U):
                case = self.case(f"along{i}", U, T="fixedValue; value uniform 12" if i % 2 else "zeroGradient")
                done = harness.program("granularGas", "-case", case, "-dry-run", check=False)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertRegex(done.stderr, r"0/U:\d+: patch xLow: U is '\w+' and leads along the patch.*a wall is  type slip;")
        outside = "fixedValue; value uniform 70", "fixedValue; value uniform 12"
        done = harness.program("granularGas", "-case", self.case("outside", along[1], *outside), "-dry-run")
        self.assertRegex(done.stdout, r"warning: .*0/U:\d+: patch xLow: U is 'fixedValue' and leads along.*\[openSide\]")
        done = harness.program("granularGas", "-case", self.case("inlet", "fixedValue; value uniform (5 0 0)"), "-dry-run")
        self.assertNotIn("openSide", done.stdout)

    def test_explicit(self):
        """Implicit acoustics hold the pressure at open patches, and are refused with any flow rate."""
        for rate in ("massFlowRate", "volumetricFlowRate"):
            case = self.case(rate, f"flowRateInletVelocity; {rate} 0.2; value uniform (0 0 0)")
            runs.add(case, "system/fvSolution", "acoustics { type implicit; }\n")
            done = harness.program("granularGas", "-case", case, "-dry-run", check=False)
            self.assertIn("a flow rate is for explicit acoustics", done.stderr)


if __name__ == "__main__":
    unittest.main()
