# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of docs/benchmarks.md in short forms: all run to their end; of three the physics is compared: the growth of a wave in a gas that cools, shocks
ahead of a piston and over a wedge."""
import json
import os
import shutil
import unittest

from tests.cases import harness
from tests.parity import cases as parity


class Short(harness.Folder, unittest.TestCase):
    def test_vortices(self):
        """In the box of 31 the wave grows as linear theory says, to 0.02 of the rate of cooling."""
        self.compare(self.short("vortices", 16), harness.entries("vortices"))

    def test_piston(self):
        """An elastic shock has the speed of mass, momentum and energy across it."""
        case = harness.copy("piston", self.folder)
        harness.edit(case, "constant/granularProperties", restitution=1, thresholdSpeed=0)
        harness.mesh(case, 200)
        self.compare(harness.run(case, endTime=100), harness.entries("piston"))

    def test_wedge(self):
        """An elastic stream of disks has the exact shock, to half a sector, on a coarse mesh."""
        case = harness.copy("wedgeDisks", self.folder)
        harness.edit(case, "constant/granularProperties", restitution=1)
        harness.edit(case, "0.orig/T", restitution=1)
        harness.mesh(case, 20)
        self.compare(harness.run(case), harness.entries("wedgeDisks"))


class All(harness.Folder, unittest.TestCase):
    def test_run_to_their_end(self):
        """The short forms of tests/parity/cases.py."""
        with open(os.path.join(harness.SOURCE, "docs", "benchmarks.json"), encoding="utf-8") as f:
            names = [name for benchmark in json.load(f) for name in benchmark["cases"]]
        self.assertGreater(len(names), 10)
        meshes = {}
        for name in names:
            parity.make(name, parity.SHIPPED[name], os.path.join(self.folder, name), mesh=meshes.__setitem__)
        harness.meshes(meshes)
        for name in names:
            with self.subTest(name):
                row, case = parity.SHIPPED[name], os.path.join(self.folder, name)
                solver = parity.application(case)
                if solver == "granularDEM" and not shutil.which("lmp"):
                    continue  # LAMMPS is not installed
                harness.program(solver, "-case", case)
                self.assertAlmostEqual(float(harness.haff.Case(case).times[-1]), row.control["endTime"])


if __name__ == "__main__":
    unittest.main()
