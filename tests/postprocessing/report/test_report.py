# SPDX-License-Identifier: GPL-3.0-or-later
"""haff report: one file that needs no other, what it tells of gas, grains, sweeps and two cases, and what it says where there is nothing to tell."""
import contextlib
import fcntl
import html.parser
import io
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.plot import cases
from tests.postprocessing.report import made

from haff.plot.profiles import main_axis
from haff.report import report


def called(*words):
    """(exit code, what it says on stdout, on stderr) of haff report."""
    out, told, was = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["haff report", *words]
    try:
        with contextlib.redirect_stderr(told), contextlib.redirect_stdout(out):
            code = report.main()
    except SystemExit as e:
        code = e.code
    finally:
        sys.argv = was
    return code, out.getvalue(), told.getvalue()


def read(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


def data(text):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S).group(1))


class Elements(html.parser.HTMLParser):
    """The elements of a page: their names, and all attributes as (name, value)."""

    def __init__(self):
        super().__init__()
        self.names, self.attributes = [], []

    def handle_starttag(self, name, attributes):
        self.names.append(name)
        self.attributes += attributes


class Reports(harness.Folder, unittest.TestCase):
    def place(self):
        return os.path.join(self.folder, self._testMethodName)

    def page(self, *words):
        code, out, told = called(*words)
        self.assertEqual((code, told), (0, ""))
        return read(out.strip())

    def test_gas(self):
        """Everything that the case has is on the page: fields, films, profiles, tables, verdict, warnings, provenance."""
        path = made.gas(self.place())
        before = cases.files(path)
        code, out, told = called(path)
        self.assertEqual((code, out, told), (0, os.path.join(path, "postProcessing", "report.html") + "\n", ""))
        after = cases.files(path)
        self.assertEqual(after.keys() - before.keys(), {"postProcessing/report.html"})
        self.assertEqual({k: v for k, v in after.items() if k in before}, before)
        text = read(out.strip())
        for wanted in ("packing fraction α", "temperature T (m² s⁻²)", "TorquatoDisks", "1 of 2 values are as expected", "rho = 3",
                       "a &lt;b&gt;made up&lt;/b&gt; warning", "(2 times)", "0.2.0 (git 0)", "application granularGas", "The MIT License", "lattice, 2D"):
            self.assertIn(wanted, text)
        shown = data(text)
        self.assertEqual(shown["times"], list(made.TIMES))
        self.assertEqual([[frame[0] for frame in film] for film in shown["films"]], [list(made.TIMES)] * 3)
        titles = [c["title"] for c in shown["charts"]]
        for wanted in ("Time step, and what limits it", "Packing fraction", "Change since the start", "Speed of the run", "drag: force: total"):
            self.assertIn(wanted, titles)
        force = shown["charts"][titles.index("drag: force: total")]
        self.assertEqual((force["data"], force["x"], force["y"]), ([[0, 0.5, 1, 2], [0, 1, 2, 3], [0, 2, 4, 6]], "t (s)", "force (kg m s⁻²)"))
        for chart in shown["charts"]:
            self.assertTrue(chart["x"] and chart["y"] and chart["about"], chart["title"])

    @made.white()
    def test_names_are_no_html(self):
        """Whatever names and texts a case has, the page has its own elements alone, and data that page.js can read."""
        bad = '"><img src=x onerror=alert(1)><!--<script>alert(1)<|script>'
        path = made.gas(self.place() + bad, (6, 4, 1), times=("0", "1"))
        mesh, text = os.path.join(path, "constant", "polyMesh", "boundary"), bad.replace("|", "/")
        made.write(mesh, read(mesh).replace("type patch;", f"type {text};"))
        for name in (bad, os.fsdecode(b"\xff")):
            shutil.copy(os.path.join(path, "1", "T"), os.path.join(path, "1", name))
        made.write(os.path.join(path, "README.md"), f"# {text}\n")
        made.write(os.path.join(path, "log.granularGas"), made.LOG.replace("made up", text).replace("TorquatoDisks", text))
        made.write(os.path.join(path, "1", "uniform", "provenance"), made.PROVENANCE.replace("made", text.replace('"', "'")))
        made.write(os.path.join(path, "postProcessing", bad, "0", bad + ".dat"), f"# Time\t{text}\n0\t1\n1\t2\n")
        shown = self.page(path)
        found = Elements()
        found.feed(shown)
        self.assertEqual(found.names.count("script"), 3)
        self.assertEqual([said for said in found.attributes if said[0].startswith("on") or said == ("src", "x")], [])
        self.assertIn(text, "".join(c["title"] + str(c["series"]) for c in data(shown)["charts"]))
        self.assertNotIn("<", shown.split('id="data">')[1].split("</script>")[0])
        self.assertIn("\\udcff", shown)

    @made.white()
    def test_damaged_file(self):
        """A field that was cut in the middle, and one that is empty, are named on the page and in the terminal, with the cure."""
        path = made.gas(self.place(), (6, 5, 1))
        for time, name, left in (("1", "T", 400), ("0.5", "U", 0)):
            with open(os.path.join(path, time, name), "r+b") as f:
                f.truncate(left)
        code, out, told = called(path)
        self.assertEqual(code, 0)
        text = read(out.strip())
        for file in ("1/T", "0.5/U"):
            self.assertRegex(told, rf"haff report: warning: \S*/{file}: .*the file is damaged: take another time, or remove \S*/{file[:-2]}, and a run goes on")
            self.assertRegex(text, rf"<strong>warning</strong> \S*/{file}: ")
        self.assertEqual(told.count("warning"), 2)

    @made.white()
    def test_changed_dictionaries(self):
        """After a run restitution is edited: the page has that of the run, by its log, or by the record of the last time where the log is of no
        run, and says that the file has changed. A file that is newer, but says the same, has not."""
        path = made.gas(self.place(), (6, 5, 1), ("0", "1"))
        record = os.path.join(path, "1", "uniform", "provenance")
        entry = "    granularProperties\n    {\n        grain {\n            restitution 0.9;\n        }\n        cooling Haff;\n    }"
        made.write(record, made.PROVENANCE.replace("dictionaries\n{", "dictionaries\n{\n" + entry))
        os.utime(record, (1, 1))
        grain, log = os.path.join(path, "constant", "granularProperties"), os.path.join(path, "log.granularGas")
        made.write(grain, "grain { restitution 0.90; } // as it was\ncooling Haff;\n")
        control = os.path.join(path, "system", "controlDict")
        made.write(control, "application granularGas;\n")
        self.assertEqual(called(path)[2], "")
        made.write(grain, "grain { restitution 0.7; }\ncooling Haff;\n")
        for text in (made.LOG, made.LOG.replace("0.9", "0.7").split("end at")[0] + "nothing to do: time 1 has reached endTime 1\n"):
            made.write(log, text)
            code, out, told = called(path)
            self.assertEqual((code, told), (0, "haff report: warning: constant/granularProperties has changed since time 1 was written: "
                                               "this page tells of the run before that\n"))
            shown = read(out.strip())
            self.assertIn("<dt>restitution</dt><dd>0.9</dd>", shown)
            self.assertIn("<strong>warning</strong> constant/granularProperties has changed since", shown)

    @made.white()
    def test_change_over_the_start(self):
        """A mass that grows from 21580 to 30194 has changed by 39.9 %: run.dat, over the larger of both, says 0.285. Of a mass that was 0 the page
        has its value."""
        for first, told in ((21580, "mass, change</span><span class=\"value\">39.9 %"), (0, "mass</span><span class=\"value\">3.019e+04")):
            path = os.path.join(self.place(), str(first))
            made.gas(path, (6, 5, 1), ("0", "1"))
            table = os.path.join(path, "postProcessing", "run", "0", "run.dat")
            row = lambda k, m: f"{k}\t{k}\t{k}\tCourant\t{m}\t{(m - first) / m if m else 0:.17g}\t{9 - k}\t{-k / 9:.17g}\t{k}\n"
            made.write(table, "# Time\tstep\tdt\tlimiter\tmass\tmassChange\tenergy\tenergyChange\tclockTime\n"
                       + row(0, first) + row(0.5, (first + 30194) / 2) + row(1, 30194))
            text = self.page(path, "-frames", "1")
            self.assertIn(told, text)
            self.assertIn("energy, change</span><span class=\"value\">-11.1 %", text)
            charts = {c["title"]: c for c in data(text)["charts"]}
            change = dict(zip([s["label"] for s in charts["Change since the start"]["series"]], charts["Change since the start"]["data"][1:]))
            self.assertAlmostEqual(change["energy"][-1], 1 / 9, 5)
            self.assertEqual(change["mass"][-1] if first else charts["Mass"]["data"][1][-1], round(8614 / 21580, 6) if first else 30194)

    @made.white()
    def test_needs_nothing_else(self):
        """No file, no server, no network: nothing on the page has an address but data and places on the page."""
        text = self.page(made.gas(self.place()))
        body = re.sub(r"<script>.*?</script>|<style>.*?</style>", "", text, flags=re.S)
        self.assertEqual([a for a in re.findall(r'(?:src|href)="([^"]*)"', body) if not a.startswith(("data:", "#"))], [])
        self.assertNotRegex(re.sub(r"<script>.*?</script>", "", text, flags=re.S), r"@import|url\(|<link|<iframe")
        self.assertNotIn("refresh", body)
        self.assertTrue(all(re.search(r' alt="[^"]{10,}"', image) for image in re.findall(r"<img[^>]*>", text)))

    def test_small(self):
        """Without films, the page of four fields on 250 x 200 cells stays far below 2 MB."""
        path = made.gas(self.place(), (250, 200, 1), ("0", "1"))
        text = self.page(path, "-frames", "1")
        self.assertLess(len(text), 1_000_000)
        self.assertEqual((data(text)["films"], data(text)["times"]), ([], ["1"]))
        self.assertRegex(text, 'alt="packing fraction α at t = 1 s')

    @made.white()
    def test_one_dimension(self):
        """The picture has profiles at several times; the plot those of all times, for the slider."""
        shown = data(self.page(made.gas(self.place(), (20, 1, 1))))
        profiles = [c for c in shown["charts"] if "frames" in c]
        self.assertEqual(shown["films"], [])
        self.assertEqual([len(c["frames"]) for c in profiles], [4] * len(profiles))
        self.assertEqual(profiles[0]["x"], "x (m)")
        self.assertEqual(len(profiles[0]["frames"][0]), 20)

    @made.white()
    def test_profile_along_gravity(self):
        """With gravity along y the layers of a lattice in two dimensions have means, of T over the mass."""
        path = made.gas(self.place())
        made.write(os.path.join(path, "constant", "g"), "value (0 -9.81 0);\n")
        profiles = {c["y"]: c for c in data(self.page(path))["charts"] if "frames" in c}
        case = cases.haff.Case(path)
        alpha, T, row = case.field("alpha"), case.field("T"), case.lattice().ijk[:, 1]
        there = profiles["temperature T (m² s⁻²)"]["frames"][-1][3]
        self.assertAlmostEqual(there, (alpha * T)[row == 3].sum() / alpha[row == 3].sum(), 5)

    @made.white()
    def test_each_component_has_a_profile(self):
        """A layer that slides down a chute moves along x, hardly along y, and not along z: the report shows the first two, the picture the largest."""
        path = self.place()
        at = cases.box(path, (1, 20, 1), (0.1, 2, 0.1))
        made.write(os.path.join(path, "constant", "g"), "value (4 -9 0);\n")
        for time in ("0", "1"):
            cases.fields(path, time, alpha=0 * at[:, 0] + 0.5, U=float(time) * np.outer(at[:, 1], (1, -0.1, 1e-14)))
        text = self.page(path)
        profiles = {c["y"]: c for c in data(text)["charts"] if "frames" in c}
        self.assertEqual([name for name in profiles if "U" in name], ["velocity U_x (m s⁻¹)", "velocity U_y (m s⁻¹)"])
        np.testing.assert_allclose(profiles["velocity U_x (m s⁻¹)"]["frames"][-1], at[:, 1], rtol=1e-5)
        self.assertEqual(main_axis(cases.haff.Case(path), "U", "1", 1), "x")

    @made.white()
    def test_tables_of_function_objects(self):
        """Lines of `sets` are profiles, at the written times that are nearest; energyBudget has one plot of what changed the energy, by cause;
        probes and extremes have the unit of their field; what is no table over time is left out."""
        path = made.gas(self.place())
        table = lambda name, text: made.write(os.path.join(path, "postProcessing", name), text)
        for t in ("0", "0.7", "2"):
            table(f"lines/{t}/up_a_alpha_T.xy", f"0 0.1 {t}\n1 0.2 5\n")
            table(f"lines/{t}/up_a_U.xy", f"0 3 4 0\n1 0 {t} 0\n")
        names = "Time mass energy cooling gravity residual momentum_x momentumWalls_x momentumResidual_x".split()
        table("budget/0/energyBudget.dat", "# " + " ".join(names) + "\n0 4 7 0 0 0 1 0 0\n2 4 6 -2 1 1e-15 2 1 1e-16\n")
        table("ext/0/fieldMinMax.dat", "# Time field min location(min) max location(max)\n" + "".join(
            f"{t} T {t} (0 0 0) {3 * t + 1} (1 1 1)\n" for t in (0, 1, 2)))
        table("notes/0/words.dat", "some words that are\nno table\n")
        charts = {c["title"]: c for c in data(self.page(path))["charts"]}
        line = charts["lines: T along up_a"]
        self.assertEqual((line["times"], line["frames"], line["data"], line["y"]), (["0", "0.7", "2"], [[0, 5], [0.7, 5], [2, 5]], [[0, 1]], "T (m² s⁻²)"))
        self.assertEqual(charts["lines: |U| along up_a"]["frames"][2], [5, 2])
        self.assertEqual([s["label"] for s in charts["budget: energyBudget: energy"]["series"]], ["energy", "cooling", "gravity"])
        self.assertEqual(charts["budget: energyBudget: energy"]["y"], "energy (kg m² s⁻²)")
        self.assertEqual([s["label"] for s in charts["budget: energyBudget: momentum_x"]["series"]], ["momentum_x", "momentumWalls_x"])
        self.assertEqual((charts["ext: T"]["data"], charts["ext: T"]["y"]), ([[0, 1, 2], [0, 1, 2], [1, 4, 7]], "T (m² s⁻²)"))

    def test_grains(self):
        """A film of the grains comes first."""
        text = self.page(made.grains(self.place()), "-frames", "2")
        self.assertIn("20 grains at t = 2 s", text)
        self.assertEqual(len(data(text)["films"]), 4)

    @made.white()
    def test_sweep(self):
        """A row for each run with its picture, a failed one with its reason; plots of what was measured and of the runs over each other."""
        folder = made.sweep(self.place())
        code, out, told = called(folder)
        self.assertEqual((code, out, told), (0, os.path.join(folder, "report.html") + "\n", ""))
        text = read(out.strip())
        self.assertEqual(len(re.findall('<button type="button" class="zoom"', text)), 2)
        self.assertIn("restitution is at most 1", text)
        charts = {c["title"]: c for c in data(text)["charts"]}
        self.assertEqual(charts["hottest over restitution"]["data"], [[0.8, 0.9, 1.1], [1.5, 1.75, None]])
        self.assertEqual([s["label"] for s in charts["Largest temperature"]["series"]], ["restitution 0.8", "restitution 0.9"])

    @made.white()
    def test_pair(self):
        """Gas beside grains: films of both by the same times and colours, differences, runs in one plot."""
        one, other = made.gas(self.place() + "/gas"), made.grains(self.place() + "/dem")
        code, out, told = called(one, other)
        self.assertEqual((code, out, told), (0, os.path.join(one, "postProcessing", "report-dem.html") + "\n", ""))
        text = read(out.strip())
        shown = data(text)
        self.assertEqual([[frame[0] for frame in film] for film in shown["films"]], [list(made.TIMES)] * 7)
        self.assertIn("Differences at t (s) = 2", text)
        self.assertIn(["gas", "dem"], [[s["label"] for s in c["series"]] for c in shown["charts"]])

    @made.white()
    def test_nothing_to_tell(self):
        """What is no case, a case without times, without a mesh: what to do, in one message without a traceback."""
        empty = os.path.join(self.place(), "empty")
        os.makedirs(empty)
        fresh = os.path.join(self.place(), "fresh")
        cases.box(fresh, (4, 4, 1), (1, 1, 1))
        os.makedirs(os.path.join(fresh, "0.orig"))
        bare = os.path.join(self.place(), "bare")
        cases.control(bare)
        cases.fields(bare, "1", alpha=[0.5])
        for words, code, wanted in (
                ([os.path.join(self.folder, "none")], 1, "is not there; give the folder of a case"), ([empty], 1, "no case directory.*no folder of a sweep"),
                ([fresh], 1, "no times with fields: run it first"), ([bare], 1, "has no mesh"), ([fresh, "-o", "x.pdf"], 2, "a report is .html"),
                ([fresh, "-frames", "0"], 2, "1 to 1000"), ([fresh, empty, "-follow"], 2, "-follow is for one case")):
            with self.subTest(words):
                found, out, told = called(*words)
                self.assertEqual((found, out), (code, ""))
                self.assertRegex(told, wanted)
                self.assertEqual(os.path.exists(os.path.join(words[0], "postProcessing")), False)

    @made.white()
    def test_without_a_run_table(self):
        """Fields alone, as of another program, are a report, too; expected values without measured ones give a message."""
        path = self.place()
        made.write(os.path.join(path, "expected.json"), "{}")
        at = cases.box(path, (6, 5, 1), (0.6, 0.5, 0.1))
        cases.fields(path, "1", alpha=at[:, 0])
        text = self.page(path, "-o", os.path.join(self.folder, "alone.html"))
        self.assertIn("packing fraction α", text)
        self.assertRegex(text, "expected.json was not compared: ")

    def test_follow(self):
        """While the case is locked the page renews itself; the last page, when the run has ended, does not."""
        path = made.gas(self.place(), (6, 5, 1), ("0", "1"))
        lock = os.path.join(path, ".haff.lock")
        with open(lock, "wb") as f:
            fcntl.fcntl(f, fcntl.F_SETLK, struct.pack("hhqqi4x", fcntl.F_WRLCK, 0, 0, 0, 0))
            command = [sys.executable, "-m", "haff", "report", path, "-follow", "-every", "1", "-frames", "1"]
            running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            page = running.stdout.readline().strip()
            going = read(page)
        out, told = running.communicate(timeout=60)
        self.assertEqual((running.returncode, out, told), (0, "", ""))
        self.assertEqual(data(going)["every"], 1)
        self.assertRegex(going, r'<noscript><meta http-equiv="refresh" content="1"></noscript>')
        self.assertEqual(data(read(page))["every"], 0)
        self.assertNotIn('http-equiv="refresh"', read(page))


if __name__ == "__main__":
    unittest.main()
