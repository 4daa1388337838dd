# SPDX-License-Identifier: GPL-3.0-or-later
"""Every case that is shipped, on its own mesh: what checkCase says of it."""
import os
import re
import subprocess
import unittest

from tests.cases import harness


class Shipped(harness.Folder, unittest.TestCase):
    def prepared(self, name):
        case = harness.copy(name, self.folder)
        msh = os.path.join(case, "mesh.msh")
        subprocess.run(["gmsh", "-3", "-v", "2", os.path.join(case, "mesh.geo"), "-o", msh], check=True, capture_output=True)
        harness.program("gmshToCase", msh, "-case", case)
        if name == "segregationWedge":  # carried by a gas, as its Allrun makes it
            os.rename(self.short("wedge", 20).path, case + "/gas")
        return case

    def test_no_warnings(self):
        """None warns of anything that it does not accept by name, and each name that it accepts is needed, at the start or later."""
        late = {"noFriction"}  # said while a run goes on
        for name in sorted(os.listdir(os.path.join(harness.SOURCE, "cases"))):
            if not os.path.isfile(os.path.join(harness.SOURCE, "cases", name, "system", "controlDict")):
                continue
            with self.subTest(name):
                case = self.prepared(name)
                said = harness.program("checkCase", case, "-strict").stdout
                self.assertIn("The case is sound.", said)
                with open(case + "/system/controlDict") as f:
                    accepted = re.search(r"acceptWarnings\s+\(([\w ]*)\)", f.read())
                needed = set(re.findall(r"^accepted warning: .* \[(\w+)\]$", said, re.M))
                self.assertEqual(set(accepted[1].split() if accepted else ()) - late, needed)


if __name__ == "__main__":
    unittest.main()
