# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/gallery.md: what docs/makeGallery makes of the cases' READMEs, and all its pictures are there."""
import os
import re
import subprocess
import unittest

from tests.cases import harness

DOCS = os.path.join(harness.SOURCE, "docs")


class Gallery(unittest.TestCase):
    def test_is_up_to_date(self):
        made = subprocess.run([os.path.join(DOCS, "makeGallery"), "-print"], capture_output=True, text=True)
        self.assertEqual(made.returncode, 0, made.stderr)
        with open(os.path.join(DOCS, "gallery.md"), encoding="utf-8") as f:
            self.assertEqual(f.read(), made.stdout, "run docs/makeGallery")

    def test_pictures(self):
        """Every case but those without a figure is there, and every picture that is shown."""
        with open(os.path.join(DOCS, "gallery.md"), encoding="utf-8") as f:
            text = f.read()
        for path in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", text):
            self.assertTrue(os.path.isfile(os.path.join(DOCS, path)), path)
        cases = os.path.join(harness.SOURCE, "cases")
        for name in (n for n in os.listdir(cases) if os.path.isfile(os.path.join(cases, n, "figure.py"))):
            self.assertRegex(text, rf"!\[[^\]]*\]\(\.\./cases/{name}/", name)


if __name__ == "__main__":
    unittest.main()
