# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of patches are the patch's, for all who read them: surfaceFieldValue, written fields, Python, OpenFOAM's postProcess."""
import glob
import os
import shutil
import subprocess
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from studies.exact.eos import TorquatoSpheres

N, SIZE, END = (6, 5, 1), (1.2, 1.0, 0.1), 0.02
GAS = TorquatoSpheres(0.9)
POLYHEDRAL = "meshEngine polyhedral; polyReconstruct CWENO3;\n"
PATCHES = ("xLow", "xHigh", "yLow", "yHigh")
ENTRY = "%s_%s { type surfaceFieldValue; regionType patch; name %s; operation %s; fields (%s); writeControl writeTime; }\n"


class PatchValues(harness.Folder, unittest.TestCase):
    def case(self, name, engine="", **options):
        """Gas with transport between a warm wall and one that moves and takes heat; a stream that changes in time enters along x."""
        one = np.ones(np.prod(N))
        options = {"interval": END / 2, "format": "ascii", "digits": 15, **runs.SPHERES, **options}
        case = harness.box_case(os.path.join(self.folder, name), N, SIZE, 100 * one, np.outer(one, (3, 0.5, 0)), one, END,
                                types={"y": "wall"}, **options)
        runs.conduct(case)
        os.remove(case + "/0/p")
        rules = {"rho": "xLow uniformFixedValue; uniformValue table ((0 90) (1 1090)); value uniform 90\nxHigh zeroGradient\n"
                        '"y.*" zeroGradient',
                 "U": 'xLow exprFixedValue; valueExpr "vector(3 + time(), 0, 0)"; value uniform (3 0 0)\nxHigh zeroGradient\n'
                      "yLow noSlip\nyHigh translatingWallVelocity; U (1 0 0); value uniform (1 0 0)",
                 "T": "xLow fixedValue; value uniform 2\nxHigh inletOutlet; inletValue uniform 7; value uniform 7\n"
                      "yLow fixedValue; value uniform 4\nyHigh granularWall; restitution 0.5; value uniform 1"}
        for field, values in (("rho", 100 * one), ("U", np.outer(one, (3, 0.5, 0))), ("T", one)):
            boxes.write_field(case, field, values, rules[field] + "\nzEmpty empty")
        runs.add(case, "system/fvSchemes", "divSchemes { } gradSchemes { } laplacianSchemes { }\n" + engine)
        functions = "".join(ENTRY % (p, o, p, o, f) for p in PATCHES
                            for o, f in (("areaAverage", "rho alpha U T p c Ma"), ("areaNormalAverage", "U")))
        # on the inlet, the warm wall, the lid, the outlet; inside
        functions += ("probes { type probes; interpolationScheme cellPoint; fields (rho alpha U T p c); writeControl writeTime; "
                      "probeLocations ((0 0.5 0.05) (0.6 0 0.05) (0.6 1 0.05) (1.2 0.5 0.05) (0.5 0.5 0.05)); }\n")
        runs.add(case, "system/controlDict", "functions\n{\n" + functions + "}\n")
        return case

    def values(self, result, time=None):
        return {p: {f: result.patch_values(f, p, time) for f in runs.FIELDS} for p in PATCHES}

    def check(self, result, time):
        """What stands in a written time, by the types of the patches."""
        at, beside = self.values(result, time), result.field
        inlet, warm, lid, outlet = (at[p] for p in ("xLow", "yLow", "yHigh", "xHigh"))
        t = float(time)
        np.testing.assert_allclose(inlet["rho"], 90 + 1000 * t, rtol=1e-12)
        np.testing.assert_allclose(inlet["alpha"], GAS.nu(90 + 1000 * t), rtol=1e-12)
        np.testing.assert_allclose(inlet["U"], np.outer(np.ones(N[1]), (3 + t, 0, 0)), rtol=1e-12)
        np.testing.assert_allclose(inlet["p"], GAS.p(90 + 1000 * t, 2), rtol=1e-12)
        np.testing.assert_array_equal(warm["T"], 4)
        np.testing.assert_array_equal(warm["U"], 0)
        np.testing.assert_array_equal(lid["U"], np.outer(np.ones(N[0]), (1, 0, 0)))
        for f in ("rho", "U", "p"):  # nothing is given there; T flows out
            np.testing.assert_array_equal(outlet[f], beside(f, time)[N[0] - 1::N[0]])
        np.testing.assert_array_equal(outlet["T"], beside("T", time)[N[0] - 1::N[0]])
        for name, cells in (("yLow", slice(0, N[0])), ("yHigh", slice(-N[0], None))):
            np.testing.assert_array_equal(at[name]["rho"], beside("rho", time)[cells])
            np.testing.assert_array_equal(at[name]["p"], beside("p", time)[cells])  # no gradient across a wall
        T = beside("T", time)[-N[0]:]
        self.assertTrue((lid["T"] < T).all() and (lid["T"] > 0.1 * T).all(), (lid["T"], T))
        for name, q in at.items():
            np.testing.assert_allclose(q["rhoU"], q["rho"][:, None] * q["U"], rtol=1e-12, atol=1e-12)
            np.testing.assert_allclose(q["rhoE"], q["rho"] * (1.5 * q["T"] + 0.5 * (q["U"]**2).sum(axis=1)), rtol=1e-12)

    def test_written_and_averaged(self):
        """On both engines, at the start and later; surfaceFieldValue has what is written; restarts and ranks have the same bytes."""
        for engine in ("", POLYHEDRAL):
            with self.subTest(engine=engine):
                case = self.case(f"whole{len(engine)}", engine)
                pair = shutil.copytree(case, case + "_2")
                harness.program("granularGas", "-case", case)
                harness.program("granularGas", "-case", pair, ranks=2)
                runs.same(self, runs.results(case), runs.results(pair))
                again = runs.until(case, case + "_again", END / 2)
                harness.program("granularGas", "-case", again)
                last = runs.times(case)[-1]
                runs.same(self, *(runs.contents(os.path.join(c, last)) for c in (case, again)))
                result = harness.haff.Case(case)
                for time in runs.times(case)[1:]:
                    self.check(result, time)
                for patch, q in self.values(result).items():
                    found = result.table(patch + "_areaAverage", "surfaceFieldValue.dat")[-1, 1:]
                    U = q["U"].mean(axis=0)
                    np.testing.assert_allclose(found[:7], [q["rho"].mean(), q["alpha"].mean(), *U, q["T"].mean(), q["p"].mean()], rtol=1e-11)
                    found = result.table(patch + "_areaNormalAverage", "surfaceFieldValue.dat")[-1, 1]
                    along, sign = (0 if patch[0] == "x" else 1), (-1 if "Low" in patch else 1)
                    np.testing.assert_allclose(found, sign * U[along], rtol=1e-11)
                found = result.table("xLow_areaAverage", "surfaceFieldValue.dat")[-1]
                t, c, Ma = found[0], found[-2], found[-1]
                np.testing.assert_allclose([c, Ma * c], [GAS.c(90 + 1000 * t, 2), 3 + t], rtol=1e-9)  # the slope of GAS is good to that

    def probed(self, case):
        """field -> [probes] or [probes][3], of the last time."""
        found = {}
        for name in ("rho", "alpha", "U", "T", "p", "c"):
            with open(f"{case}/postProcessing/probes/0/{name}") as f:
                row = np.array(f.read().split("\n")[-2].replace("(", " ").replace(")", " ").split(), float)
            found[name], t = row[1:].reshape(-1, 3) if name == "U" else row[1:], row[0]
        return t, found

    def test_probes(self):
        """A probe on a patch has what the patch gives, with cellPoint; elsewhere what it had."""
        for engine in ("", POLYHEDRAL):
            with self.subTest(engine=engine):
                case = self.case(f"probes{len(engine)}", engine)
                harness.program("granularGas", "-case", case)
                t, q = self.probed(case)
                rho = 90 + 1000 * t
                np.testing.assert_allclose([q[f][0] for f in ("rho", "alpha", "T", "p")], [rho, GAS.nu(rho), 2, GAS.p(rho, 2)], rtol=1e-11)
                np.testing.assert_allclose(q["c"][0], GAS.c(rho, 2), rtol=1e-9)  # the slope of GAS is good to that
                np.testing.assert_allclose(q["U"][:3], [(3 + t, 0, 0), (0, 0, 0), (1, 0, 0)], rtol=1e-11, atol=1e-15)
                self.assertAlmostEqual(q["T"][1], 4, places=11)
                self.assertGreater(abs(q["U"][3, 0] - 3 - t), 1e-9)  # of the gas
                result = harness.haff.Case(case)
                np.testing.assert_allclose(q["T"][4], result.field("T")[2 + 2 * N[0]], rtol=1e-11)  # the centre of a cell

    @unittest.skipUnless(shutil.which("postProcess"), "OpenFOAM is not installed")
    def test_openfoam(self):
        """OpenFOAM's postProcess finds the same averages in the files."""
        case = self.case("openfoam")
        harness.program("granularGas", "-case", case)
        for patch in ("xLow", "yLow", "yHigh"):
            done = subprocess.run(["postProcess", "-case", case, "-latestTime", "-noFunctionObjects", "-func",
                                   f"patchAverage(name={patch},rho,alpha,U,T,p)"], capture_output=True, text=True,
                                  env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
            self.assertEqual(done.returncode, 0, done.stdout[-1500:] + done.stderr[-1500:])
            with open(glob.glob(f"{case}/postProcessing/patchAverage*{patch}*/*/surfaceFieldValue.dat")[0]) as f:
                found = np.array(f.read().split("\n")[-2].replace("(", " ").replace(")", " ").split(), float)[1:]
            ours = harness.haff.Case(case).table(patch + "_areaAverage", "surfaceFieldValue.dat")[-1, 1:]
            np.testing.assert_allclose(found, ours[:len(found)], rtol=1e-10, atol=1e-12)


if __name__ == "__main__":
    unittest.main()
