# SPDX-License-Identifier: GPL-3.0-or-later
"""A run with all function objects has the bits of the same run without any."""
import os
import re
import unittest

from tests.cases import harness, runs

CONTROL = "system/controlDict"
# One of each type but `image`, which reads the written times in a program of its own. All but those of written times act in each step.
OBJECTS = """functions
{
    points  { type probes; fields (alpha U); probeLocations ((0.31 0.22 0.05)); }
    line    { type sets; fields (rho U); sets { a { type uniform; axis distance; start (0.1 0.1 0.05); end (1 0.7 0.05); nPoints 9; } } }
    extreme { type fieldMinMax; fields (T U); }
    mass    { type volFieldValue; fields (rho U); operation volIntegrate; }
    files   { type vtk; fields (alpha U); writeControl timeStep; writeInterval 2; }
    budget  { type energyBudget; }
    phases  { type phaseAverage; period 0.002; phases 3; fields (rho U); }
    means   { type fieldAverage; fields (U { mean on; prime2Mean on; } rho { mean on; }); }
    force   { type forces; patches (".*"); CofR (0 0 0); }
    coeffs  { type forceCoeffs; patches (yLow); CofR (0 0 0); magUInf 2; rhoInf 3; lRef 0.5; Aref 0.25; dragDir (0 1 0); liftDir (1 0 0); }
    flow    { type surfaceFieldValue; regionType patch; name yLow; operation sum; fields (p); }
    derived { type writeObjects; objects (Ma vorticity); }
    cuts    { type surfaces; surfaceFormat vtk; fields (rho p); surfaces (cut { type cuttingPlane; planeType pointAndNormal; pointAndNormalDict { point (0.5 0.4 0.05); normal (1 2 0); } }); }
}
"""


class FunctionObjects(harness.Folder, unittest.TestCase):
    def test_every_type_is_here(self):
        text = harness.program("granularGas", "-listModels").stdout.split("system/controlDict: functions\n")[1].split("  fields:")[0]
        types = set(re.findall(r"^  (\w+) ", text, re.MULTILINE))
        self.assertEqual(set(re.findall(r"\{ type (\w+);", OBJECTS)) & types | {"image"}, types)

    def test_they_change_no_bit(self):
        for engine, viscous in (("lattice", True), ("polyhedral", True), ("lattice", False)):
            with self.subTest(engine=engine, viscous=viscous):
                one, other = (runs.make(os.path.join(self.folder, f"{name}{engine}{viscous}"), (12, 8, 1), 0.004, viscous=viscous)
                              for name in ("with", "without"))
                for case in (one, other):
                    runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
                    harness.edit(case, CONTROL, writeInterval=0.002)
                runs.add(one, CONTROL, OBJECTS)
                for case in (one, other):
                    harness.program("granularGas", "-case", case)
                self.assertGreater(len(runs.times(other)), 2)
                self.assertEqual(runs.times(one), runs.times(other))
                found = {case: runs.results(case) for case in (one, other)}
                wanted = [f"{time}/{field}" for time in runs.times(other) if float(time) for field in runs.FIELDS]
                runs.same(self, *({name: found[case][name] for name in wanted} for case in (one, other)))
                self.assertTrue(all(os.listdir(f"{one}/postProcessing/{name}") for name in ("points", "line", "extreme", "mass", "budget", "force",
                                                                                            "coeffs", "flow", "cuts")))
                self.assertIn(f"{runs.times(one)[-1]}/UPrime2Mean", found[one])
                self.assertIn(f"{runs.times(one)[-1]}/Ma", found[one])
                self.assertEqual(runs.contents(f"{other}/postProcessing"), {})


if __name__ == "__main__":
    unittest.main()
