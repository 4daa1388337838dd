# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports in headless Chromium, from file://: no error on the console, pictures are there, the slider works, nothing is wider than a small screen."""
import os
import unittest

from tests.cases import harness
from tests.postprocessing.report import made
from tests.postprocessing.report.browser import PROGRAM, Browser
from tests.postprocessing.report.test_report import called, data, read

BROKEN = "[...document.images].filter(i => !(i.complete && i.naturalWidth > 0)).length"
SHIFT = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
CONTRAST = """(() => {
    const light = c => { const v = c.match(/[\\d.]+/g).slice(0, 3).map(x => x / 255).map(x => x <= 0.03928 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
        return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]; };
    const back = light(getComputedStyle(document.body).backgroundColor);
    return Math.min(...[...document.querySelectorAll("p, h1, h2, h3, dt, dd, a, td, figcaption, summary, .name, .value, .good, .bad")].map(e => {
        const [a, b] = [light(getComputedStyle(e).color), back].sort((x, y) => y - x);
        return (a + 0.05) / (b + 0.05);
    }));
})()"""


@unittest.skipUnless(PROGRAM, "there is no chromium")
class Pages(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser().__enter__()
        cls.addClassCleanup(cls.browser.__exit__)
        cls.paths = {"gas": cls.report(made.gas(cls.folder + "/gas"))}
        with made.white():  # pictures of the same sizes
            cls.paths.update(grains=cls.report(made.grains(cls.folder + "/grains")), line=cls.report(made.gas(cls.folder + "/line", (20, 1, 1))),
                             sweep=cls.report(made.sweep(cls.folder + "/sweep")), pair=cls.report(cls.folder + "/gas", cls.folder + "/grains"))

    @classmethod
    def report(cls, *words):
        code, out, told = called(*words)
        if code:
            raise AssertionError(told)
        return out.strip()

    def test_all_kinds(self):
        """Every kind of report, wide and narrow, light and dark: no errors, all pictures, all plots, no sideways scrolling, readable letters."""
        for path, page, width, dark in self.browser.looks(self.paths.values()):
            with self.subTest(path, width=width):
                self.assertEqual(page.errors, [])
                self.assertEqual(page.value(BROKEN), 0)
                self.assertGreater(page.value("document.images.length"), 0)
                self.assertEqual(page.value("document.querySelectorAll('.uplot canvas').length"), len(data(read(path))["charts"]))
                self.assertLessEqual(page.value(SHIFT), 0)
                self.assertGreaterEqual(page.value(CONTRAST), 4.5)  # WCAG 2, AA
                back = list(map(int, page.value("getComputedStyle(document.body).backgroundColor")[4:-1].split(",")))
                self.assertTrue(max(back) < 60 if dark else min(back) > 200, back)

    def test_slider(self):
        """The slider moves all films, profiles and the time shown; at its end it shows the last time again."""
        page = self.browser.open(self.paths["gas"])
        sources = "JSON.stringify([...document.querySelectorAll('[data-film]')].map(i => i.src))"
        move = "slider => { const s = document.getElementById('time'); s.value = slider; s.dispatchEvent(new Event('input')); }"
        last = page.value(sources)
        self.assertEqual(page.value("document.getElementById('now').textContent"), "t = 2 s")
        page.value(f"({move})(1)")
        self.assertEqual(page.value("document.getElementById('now').textContent"), "t = 0.5 s")
        self.assertFalse(page.value(sources) == last, "the films stand still")
        self.assertIn("t = 0.5 s", page.value("document.querySelector('[data-film]').alt"))
        page.value("new Promise(done => setTimeout(done, 100))")
        self.assertEqual(page.value(BROKEN), 0)
        page.value(f"({move})(3)")
        self.assertTrue(page.value(sources) == last, "the films do not come back to the last time")
        self.assertEqual(page.errors, [])
        line = self.browser.open(self.paths["line"])
        line.value(f"({move})(0)")
        self.assertIn("t = 0 s", line.value("document.querySelector('#profiles .u-legend').textContent"))
        self.assertEqual(line.errors, [])

    def test_plots_are_read_and_zoomed(self):
        """Under the cursor the legend has the values there; dragging makes the span of time smaller."""
        page = self.browser.open(self.paths["gas"])
        page.value("document.querySelector('#run .u-over').scrollIntoView({block: 'center', behavior: 'instant'})")
        box = "(b => [b.left, b.top + b.height / 2, b.width])(document.querySelector('#run .u-over').getBoundingClientRect())"
        x, y, w = page.value(box)
        mouse = lambda kind, at, **more: page.call("Input.dispatchMouseEvent", type=kind, x=x + at * w, y=y, **more)
        legend = "document.querySelector('#run .u-legend').textContent"
        mouse("mouseMoved", 0.5)
        self.assertRegex(page.value(legend), r"^t \(s\):?\s*1\D")
        before = page.value("document.querySelector('#run canvas').toDataURL()")
        mouse("mousePressed", 0.5, button="left", buttons=1, clickCount=1)
        mouse("mouseMoved", 0.7, button="left", buttons=1)
        mouse("mouseReleased", 0.7, button="left", clickCount=1)
        page.value("new Promise(done => setTimeout(done, 100))")
        self.assertFalse(page.value("document.querySelector('#run canvas').toDataURL()") == before, "the plot looks as before")
        self.assertEqual(page.errors, [])

    def test_pictures_of_sweeps_grow(self):
        page = self.browser.open(self.paths["sweep"])
        width = "document.querySelector('.zoom img').getBoundingClientRect().width"
        small = page.value(width)
        page.value("document.querySelector('.zoom').click()")
        self.assertGreater(page.value(width), 2 * small)

    @made.white()
    def test_reload(self):
        """A page of a run that goes on loads itself anew, and keeps its place and the time of the slider."""
        path = os.path.join(self.folder, "going.html")
        from haff.report import onecase, page as pages
        pages.write(onecase.Report(harness.haff.Case(self.folder + "/gas"), 12).make(every=1), path)
        page = self.browser.open(path, height=500)
        page.value("scrollTo({top: 600, behavior: 'instant'}); (s => { s.value = 1; s.dispatchEvent(new Event('input')); })(document.getElementById('time'))")
        page.wait("Page.loadEventFired", 2)
        page.value("new Promise(done => setTimeout(done, 100))")
        self.assertEqual(page.value("scrollY"), 600)
        self.assertEqual(page.value("document.getElementById('now').textContent"), "t = 0.5 s")
        self.assertEqual(page.errors, [])


if __name__ == "__main__":
    unittest.main()
