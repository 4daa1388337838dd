# SPDX-License-Identifier: GPL-3.0-or-later
"""The wall of Johnson & Jackson in files and programs: what is written and read again, its budget, tools of OpenFOAM, what is
refused. Its flows are in test_steadyFlows.py and test_viscousTriangles.py."""
import glob
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.runtime import test_energyBudget as audit
from tests.cases.transport.channels import POLYHEDRAL, friction, replace

from studies.exact import disks  # noqa: E402

LID = "type JohnsonJacksonSlip; specularityCoefficient 1; restitutionCoefficient 0.97; value uniform "


class RoughWalls(harness.Folder, unittest.TestCase):
    def channel(self, change=friction, cells=16, **control):
        case = harness.copy("couetteDisks", self.folder)
        change(case)
        harness.mesh(case, cells)
        harness.edit(case, "system/controlDict", **{"endTime": 4, "writeInterval": 2, **control})
        return case

    def velocities(self, case):
        """Velocities face by face on the floor, one value on the lid; a sum that does not end in binary."""
        friction(case, lid=(1 / 3, 1, 0.97))
        replace(case, "0.orig/U", "value uniform (-2 0 0);", "value nonuniform List<vector> 4 ((-2 0 0) (-2.1 0 0) (-2.2 0 0) (-1.9 0 0));")

    def test_restart(self):
        """On both engines: stopped on two ranks and taken up again on one, the same bytes."""
        for engine in ((), POLYHEDRAL):
            with self.subTest(engine=engine):
                def change(case):
                    self.velocities(case)
                    if engine:
                        replace(case, *engine)
                through = self.channel(change, writeFormat="ascii", writePrecision=6)
                harness.program("granularGas", "-case", through)
                part = self.channel(change, endTime=2, writeFormat="ascii", writePrecision=6)
                harness.program("granularGas", "-case", part, ranks=2)
                harness.edit(part, "system/controlDict", endTime=4)
                harness.program("granularGas", "-case", part)
                runs.same(self, runs.contents(through + "/4"), runs.contents(part + "/4"))
                with open(through + "/4/U") as f:
                    self.assertRegex(f.read(), r"lid\s+\{\s+type +JohnsonJacksonSlip;\s+specularityCoefficient 1;\s+"
                                     r"restitutionCoefficient 0.9\d+;\s+value +uniform \(0.33333333333333331 0 0\);\s+\}")
                with open(through + "/4/T") as f:
                    self.assertRegex(f.read(), r"floor\s+\{\s+type +JohnsonJacksonSlip;\s+specularityCoefficient 0.5\d+;\s+"
                                     r"restitutionCoefficient 0.9\d*;\s+value +nonuniform")

    def test_budget(self):
        """In steady flow impacts take what the walls do; a wall without losses at rest changes no energy."""
        case = self.channel(endTime=1200, writeInterval=1200, maxCo=0.4)
        audit.ask(case)
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        b = audit.budget(result)
        audit.EnergyBudget.close(self, b)
        late = b["t"] > 1000
        work, heat, cooling = (np.polyfit(b["t"][late], b[name][late], 1)[0] for name in ("wallWork", "heat", "cooling"))
        stress, area = disks.frictional(case).solution.sol(10)[4], result.volumes.sum() / 20
        self.assertAlmostEqual(work, 4 * stress * area, delta=0.02 * work)  # walls take some of friction's heat at once
        self.assertAlmostEqual(work + heat + cooling, 0, delta=1e-4 * work)
        case = self.channel(lambda case: friction(case, (0, 0.6, 1), (0, 1, 1)))
        harness.edit(case, "constant/granularProperties", cooling="none")
        audit.ask(case)
        harness.program("granularGas", "-case", case)
        b = audit.budget(harness.haff.Case(case))
        audit.EnergyBudget.close(self, b)
        self.assertLess(np.abs(b["energy"] - b["energy"][0]).max(), 1e-13 * b["energy"][0])

    @unittest.skipUnless(shutil.which("foamToVTK"), "OpenFOAM is not installed")
    def test_tools(self):
        """OpenFOAM's tools pass over the type, in the case and in the parts of ranks; caseToVTK reads what was written."""
        case = self.channel(self.velocities, cells=120, endTime=0.02, writeInterval=0.02, writeFormat="ascii")
        runs.add(case, "system/controlDict", "writeProcessors yes;\n")
        harness.program("granularGas", "-case", case, ranks=2)
        fields = {name: harness.haff.Case(case).field(name) for name in ("U", "T")}
        self.assertEqual(len(glob.glob(case + "/processor*")), 2)
        for arguments in (["foamToVTK", "-latestTime", "-name", "fromOpenFOAM"], ["reconstructPar", "-latestTime"]):
            done = subprocess.run([*arguments, "-case", case], capture_output=True, text=True, cwd=case,
                                  env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
            self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])
        for name, values in fields.items():
            np.testing.assert_allclose(harness.haff.Case(case).field(name), values, rtol=1e-15)
        harness.program("caseToVTK", case, "-time", "0.02", "-fields", "U,T")

    def refused(self, change, *words, program="granularGas"):
        def changed(case):
            friction(case)
            change(case)
        done = harness.program(program, "-case", self.channel(changed), check=False)
        self.assertEqual(done.returncode, 1)
        for word in words:
            self.assertIn(word, done.stdout + done.stderr)

    def test_refused(self):
        for file, old, new, words in (
                ("0.orig/U", LID, LID.replace("Coefficient 1;", "Coefficient 1.01;"), ("specularityCoefficient is 1.01; allowed is 0 .. 1",)),
                ("0.orig/U", LID, LID.replace("specularityCoefficient 1;", ""), ("'specularityCoefficient' is missing",)),
                ("0.orig/U", LID, LID.replace("value uniform ", "velocity uniform "), ("'value' is missing",)),
                ("0.orig/U", LID + "(2 0 0)", LID + "(2 0.1 0)", ("patch lid: U (2 0.1 0) leads through the wall",)),
                ("0.orig/U", LID + "(2 0 0)", LID + "(2 0 1)", ("is for disks, which move in a plane", "along z, out of it")),
                ("0.orig/U", LID + "(2 0 0)", "type noSlip", ("0.orig/T:", "patch lid: T is 'JohnsonJacksonSlip'; U must be that, too",)),
                ("0.orig/T", LID, LID.replace("0.97", "0.98"), ("0.orig/U:", "patch lid: U is 'JohnsonJacksonSlip'; T must be that, too, with the same")),
                ("0.orig/T", LID + "1", "type granularWall; restitution 0.97", ("T must be that, too, with the same coefficients, or fixedValue",)),
                ("0.orig/alpha", "lid              { type zeroGradient; }", "lid { %s1; }" % LID, ("alpha cannot be 'JohnsonJacksonSlip' there",)),
                ("constant/granularProperties", "transport       JenkinsRichman;", "", ("U is 'JohnsonJacksonSlip', which is nothing to",))):
            with self.subTest(words=words):
                self.refused(lambda case: replace(case, file, old, new), *words)


if __name__ == "__main__":
    unittest.main()
