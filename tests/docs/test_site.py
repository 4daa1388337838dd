# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/makeSite: a site of HTML from some of the documents, opened from its files in headless Chromium."""
import glob
import importlib.util
import os
import re
import subprocess
import sys
import unittest
from importlib.machinery import SourceFileLoader

from tests.cases import harness
from tests.postprocessing.report import made
from tests.postprocessing.report.browser import PROGRAM, Browser
from tests.postprocessing.report.test_browser import BROKEN, SHIFT

MISSING = next((name for name in ("sphinx", "myst_parser", "furo") if not importlib.util.find_spec(name)), None)
MAKER = os.path.join(harness.SOURCE, "docs", "makeSite")
PAGES = {"README.md": "index", "docs/install.md": "docs/install", "docs/userGuide.md": "docs/userGuide", "docs/benchmarks.md": "docs/benchmarks",
         "cases/silo/README.md": "cases/silo/index", "cases/wedge/README.md": "cases/wedge/index"}


def maker():
    loader = SourceFileLoader("makeSite", MAKER)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("makeSite", loader))
    sys.dont_write_bytecode, before = True, sys.dont_write_bytecode
    loader.exec_module(module)
    sys.dont_write_bytecode = before
    return module


class Links(harness.Folder, unittest.TestCase):
    def test_all_documents(self):
        """Each document of the tree becomes a page, each link in it leads to a page or picture, and each file of a case is shown."""
        site = maker().Site(self.folder, ())
        site.fill()
        self.assertLessEqual({"index", "docs/userGuide", "docs/reference", "cases/wedge/index", "docs/library/sod.c", "docs/examples/index"}, set(site.pages))
        self.assertEqual(len(glob.glob(os.path.join(harness.SOURCE, "cases", "*", "README.md"))), len([name for name in site.pages if re.fullmatch(r"cases/\w+/index", name)]))
        self.assertIn("endTime", site.pages["cases/wedge/index"].split("### `system/controlDict`")[1])
        self.assertIn("| upstream Mach number |  | 0.0425 | 11.5909 | 11.5909 | exact solution |", site.pages["cases/wedge/index"])
        self.assertIn('<a href="../../docs/gallery.html">', maker().Site(self.folder, ()).converted("[more](../../docs/gallery.md)", "cases/silo/README.md"))
        self.assertIn("`[no](link.md)`", site.converted("`[no](link.md)`", "README.md"))

    def test_a_link_that_leads_nowhere(self):
        with self.assertRaisesRegex(SystemExit, "docs/x.md: ../nothing.md is not there"):
            maker().Site(self.folder, ()).converted("[lost](../nothing.md)", "docs/x.md")
        for name, text in (("a.html", '<a href="b.html#there">x</a><a href="b.html#gone">x</a><img src="c.png">'), ("b.html", '<p id="there">')):
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        self.assertEqual(["a.html: b.html#gone", "a.html: c.png"], maker().lost(self.folder))


@unittest.skipIf(MISSING, f"{MISSING} is not there")
@unittest.skipUnless(PROGRAM, "there is no chromium")
class Pages(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.site = os.path.join(cls.folder, "site")
        made.gas(os.path.join(cls.folder, "runs", "wedge"), (6, 5, 1), ("0", "1"))
        done = subprocess.run([MAKER, cls.site, "-runs", os.path.join(cls.folder, "runs"), *PAGES], capture_output=True, text=True)
        if done.returncode:
            raise AssertionError(done.stdout + done.stderr)
        cls.browser = Browser().__enter__()
        cls.addClassCleanup(cls.browser.__exit__)

    def path(self, page):
        return os.path.join(self.site, page + ".html")

    def test_pages(self):
        """Wide and narrow, light and dark: no error on the console, all pictures, no sideways scrolling."""
        for path, page, width, dark in self.browser.looks(map(self.path, PAGES.values())):
            with self.subTest(path, width=width):
                self.assertEqual(page.errors, [])
                self.assertLessEqual(page.value(SHIFT), 0)
                self.assertEqual(page.value(BROKEN), 0)
                back = page.value("getComputedStyle(document.body).backgroundColor")
                self.assertEqual(max(map(int, back[4:-1].split(","))) < 60, dark, back)

    def test_report_of_a_run(self):
        """A case that has run in RUNS links to its report; others have none."""
        for case, there in (("wedge", 1), ("silo", 0)):
            with open(self.path(f"cases/{case}/index"), encoding="utf-8") as page:
                self.assertEqual(page.read().count('href="report.html"'), there)
        self.assertEqual(self.browser.open(self.path("cases/wedge/report")).errors, [])

    def test_search(self):
        """Works from files, without a server."""
        page = self.browser.open(self.path("search"))
        page.value("location.assign('search.html?q=Beverloo')")
        page.wait("Page.loadEventFired", 2)
        found = page.value("new Promise(done => setTimeout(() => done([...document.querySelectorAll('ul.search a')].map(a => a.textContent).join()), 1500))")
        self.assertIn("silo", found)


if __name__ == "__main__":
    unittest.main()
