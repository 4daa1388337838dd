# SPDX-License-Identifier: GPL-3.0-or-later
"""Short forms of the cases of granularSegregation."""
import os
import shutil
import tempfile

from tests.cases import harness, runs


class Mixture(harness.Folder):
    def case(self, name, M, properties=None, **control):
        """A shipped case with M nodes, ready to run."""
        case = harness.copy(name, self.folder)
        harness.mesh(case, M, "M")
        harness.edit(case, "system/controlDict", **control)
        harness.edit(case, "constant/segregationProperties", **(properties or {}))
        return case

    def run_case(self, case, **options):
        return harness.program("granularSegregation", "-case", case, **options).stdout

    def chute(self, N, **control):
        case = harness.copy("segregationChute", self.folder)
        harness.mesh(case, N)
        harness.edit(case, "system/controlDict", **control)
        return case

    def refused(self, case, rows, *commands):
        """rows: of file, what stands there, what it is replaced by, what the message says. Nothing is written."""
        for file, old, new, message in rows:
            path = os.path.join(case, file)
            with open(path) as f:
                text = f.read()
            self.assertIn(old, text)
            with open(path, "w") as f:
                f.write(text.replace(old, new, 1))
            for command in commands:
                done = harness.program(*command, check=False)
                self.assertEqual(done.returncode, 1, f"{new}: {done.stderr}")
                self.assertIn(message, done.stderr)
            self.assertIn(runs.times(case), (["0"], []))
            with open(path, "w") as f:
                f.write(text)

    def box(self, n, size, phi, properties, patches, end, step, types=None, U=None, g=None):
        """A lattice of n cells with walls (noFlux) but for `patches` (lines "NAME TYPE") and cyclic ends; U: "0/U"."""
        case = os.path.join(tempfile.mkdtemp(dir=self.folder), "box")
        kinds = harness.boxes.write_mesh(case, n, size, types)
        rules = {name: kind if kind in ("empty", "cyclic") else "noFlux" for name, kind in kinds.items()}
        walls = {name: "slip" if kind == "noFlux" else kind for name, kind in rules.items()}
        for line in patches.splitlines():
            rules[line.split()[0]] = line.split(None, 1)[1]
            walls[line.split()[0]] = "zeroGradient"
        for name, values, kinds in (("phi", phi, rules), ("U", U, walls)):
            if values is not None:
                harness.boxes.write_field(case, name, values, "\n".join(f"{a} {b}" for a, b in kinds.items()))
        shutil.copytree(os.path.join(harness.SOURCE, "cases", "segregationChute", "system"), os.path.join(case, "system"))
        harness.edit(case, "system/controlDict", endTime=end, deltaT=step, writeInterval=end)
        harness.write_dictionary(case, "constant", "segregationProperties", properties)
        if g is not None:
            harness.write_dictionary(case, "constant", "g", "dimensions [0 1 -2 0 0 0 0];\nvalue (%r %r %r);\n" % tuple(g))
        return case
