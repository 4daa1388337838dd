# SPDX-License-Identifier: GPL-3.0-or-later
"""tests/run.py: what CTest gets to know of a module that passes, fails, holds nothing, or has all of its tests skipped."""
import os
import subprocess
import sys
import tempfile
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..")))
PASS, FAIL, SKIP = "def test_a(self): pass", "def test_b(self): self.fail()", "def test_c(self): self.skipTest('no reason')"
CLASS = "import unittest\n{0}\nclass T(unittest.TestCase):\n    {1}\n"


class Run(unittest.TestCase):
    def code(self, text, *names):
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            with open(os.path.join(folder, "module.py"), "w") as f:
                f.write(text)
            return subprocess.run([sys.executable, "-m", "tests.run", "module.py", *names], cwd=folder, capture_output=True,
                                  env={**os.environ, "PYTHONPATH": SOURCE}).returncode

    def test_exit_codes(self):
        skipped_class = CLASS.format("@unittest.skip('no reason')", f"{PASS}\n    {FAIL}")
        for text, expected in ((CLASS.format("", PASS), 0), (CLASS.format("", f"{PASS}\n    {FAIL}"), 1),
                               (CLASS.format("", f"{PASS}\n    {SKIP}"), 0), (CLASS.format("", f"{FAIL}\n    {SKIP}"), 1),
                               (CLASS.format("", SKIP), 77), (skipped_class, 77), ("import nothing_of_this_name", 1), ("", 1),
                               (skipped_class + CLASS.format("", PASS).replace("T(", "U("), 0)):
            with self.subTest(text):
                self.assertEqual(self.code(text), expected)
        both = CLASS.format("", f"{PASS}\n    {FAIL}")
        self.assertEqual((self.code(both, "T.test_a"), self.code(both, "T.test_b")), (0, 1))


if __name__ == "__main__":
    unittest.main()
