# SPDX-License-Identifier: GPL-3.0-or-later
"""Every case that is shipped, on its own mesh: what checkCase says of it."""
import os
import re
import unittest

from tests.cases import harness


class Shipped(harness.Folder, unittest.TestCase):
    def test_no_warnings(self):
        """None warns of anything that it does not accept by name, and each name that it accepts is needed, at the start or later."""
        late = {"noFriction"}  # said while a run goes on
        cases = os.path.join(harness.SOURCE, "cases")
        copies = {name: harness.copy(name, self.folder) for name in sorted(os.listdir(cases)) if os.path.isfile(os.path.join(cases, name, "system", "controlDict"))}
        harness.meshes(dict.fromkeys(copies.values(), {}))
        for name, case in copies.items():
            with self.subTest(name):
                if name == "segregationWedge":  # carried by a gas, as its Allrun makes it
                    os.rename(self.short("wedge", 20).path, case + "/gas")
                said = harness.program("checkCase", case, "-strict").stdout
                self.assertIn("The case is sound.", said)
                with open(case + "/system/controlDict") as f:
                    accepted = re.search(r"acceptWarnings\s+\(([\w ]*)\)", f.read())
                needed = set(re.findall(r"^accepted warning: .* \[(\w+)\]$", said, re.M))
                self.assertEqual(set(accepted[1].split() if accepted else ()) - late, needed)

    def test_programs(self):
        """Allrun and Allcheck build the program of each case."""
        def text(path):
            with open(os.path.join(harness.SOURCE, path)) as f:
                return f.read()
        built = re.search(r"^set\(PROGRAMS (.*)\)$", text("CMakeLists.txt"), re.M)[1].split()
        self.assertIn("add_dependencies(programs ${PROGRAMS})", text("CMakeLists.txt"))
        for script in ("Allrun", "Allcheck"):
            self.assertIn("\nbuild programs\n", text(script))
        for name in os.listdir(os.path.join(harness.SOURCE, "cases")):
            if os.path.isfile(os.path.join(harness.SOURCE, "cases", name, "system", "controlDict")):
                self.assertIn(re.search(r"^application +(\w+);", text(f"cases/{name}/system/controlDict"), re.M)[1], built)


if __name__ == "__main__":
    unittest.main()
