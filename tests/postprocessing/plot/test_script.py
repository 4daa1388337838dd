# SPDX-License-Identifier: GPL-3.0-or-later
"""haff figure: where the figure of a case goes, of its own run and of another, and that the case's own picture is not touched."""
import os
import tempfile
import unittest

from tests.cases import harness

FIGURE = """from haff.plot import figures, script
fig, axes = figures.panels(1, 1)
axes[0][0].plot([0, 1], [0, 1], label=script.folder())
script.save(fig, "case")
"""


class Script(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="haff")
        self.addCleanup(temporary.cleanup)
        self.case, self.run_folder = (os.path.join(temporary.name, name) for name in ("a case", "a run"))
        for folder in (self.case, self.run_folder):
            os.mkdir(folder)
        with open(os.path.join(self.case, "figure.py"), "w") as f:
            f.write(FIGURE)
        with open(os.path.join(self.case, "case.png"), "w") as f:
            f.write("kept")

    def figure(self, *arguments, code=0):
        done = harness.command("figure", *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout.strip() or done.stderr

    def kept(self):
        with open(os.path.join(self.case, "case.png"), "rb") as f:
            return f.read()

    def test_places(self):
        there = os.path.join("postProcessing", "figures")
        self.assertEqual(self.figure(self.case), os.path.join(self.case, there, "case.png"))
        self.assertEqual(self.figure(self.case, self.run_folder, "-format", "svg"), os.path.join(self.run_folder, there, "case.svg"))
        with open(os.path.join(self.run_folder, there, "case.svg")) as f:
            self.assertIn("<svg", f.read())
        self.assertEqual(self.kept(), b"kept")
        self.assertEqual(self.figure(os.path.join(self.case, "figure.py"), self.case, "-keep"), os.path.join(self.case, "case.png"))
        self.assertEqual(self.kept()[:4], b"\x89PNG")

    def test_refused(self):
        self.assertIn("has no figure.py", self.figure(self.run_folder, code=1))
        self.assertIn("-foo", self.figure(self.case, "-foo", code=2))
        self.assertIn("RUN", self.figure("-help"))
        self.assertIn("RUN", self.figure(self.case, "-help"))


if __name__ == "__main__":
    unittest.main()
