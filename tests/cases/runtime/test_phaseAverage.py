# SPDX-License-Identifier: GPL-3.0-or-later
"""phaseAverage: the means are those of the written times, survive stops and restarts to the bit, and refuse what is wrong."""
import json
import os
import re
import unittest

import meshio
import numpy as np

from tests.cases import harness, runs
from tests.cases.grains import test_particles

CONTROL = "system/controlDict"
PERIOD, PHASES, START, END = 0.01, 4, 0.005, 0.04
AVERAGE = "functions { mean { type phaseAverage; libs (fieldFunctionObjects); fields (%s); %s } }\n"
FIELDS = "rho alpha U T p"


def averaged(folder, n=(24, 18, 1), end=END, settings="period 0.01; phases 4; start 0.005;", fields=FIELDS, **options):
    case = runs.make(folder, n, end, **{"interval": PERIOD / PHASES, **options})
    runs.add(case, CONTROL, AVERAGE % (fields, settings))
    return case


def means(case, start="0"):
    """Phase -> field -> mean, and the samples of each phase."""
    folder = os.path.join("postProcessing", "mean", start)
    result = harness.haff.Case(case)
    names = sorted((n for n in os.listdir(os.path.join(case, folder)) if n != "phaseAverage.dat"), key=float)
    values = {n: {f: result.field(f, os.path.join(folder, n)) for f in FIELDS.split()} for n in names}
    with open(os.path.join(case, folder, "phaseAverage.dat")) as f:
        counts = dict(line.split() for line in f if not line.startswith("#"))
    return values, counts


class PhaseAverage(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def test_means(self):
        """Against the written times, which are those moments."""
        case = averaged(self.path("means"))
        harness.program("granularGas", "-case", case)
        found, counts = means(case)
        result = harness.haff.Case(case)
        self.assertEqual(list(counts.items()), [("0", "4"), ("0.25", "4"), ("0.5", "4"), ("0.75", "3")])
        for j, (phase, values) in enumerate(found.items()):
            times = [START + PERIOD * (k + j / PHASES) for k in range(int(counts[phase]))]
            state = {f: np.array([result.field(f, t) for t in times]) for f in FIELDS.split()}
            rho = state["rho"]
            for field in FIELDS.split():
                with self.subTest(phase=phase, field=field):
                    weight = rho if field == "T" else rho[..., None] if field == "U" else np.ones_like(rho)
                    expected = (weight * state[field]).sum(axis=0) / weight.sum(axis=0)
                    np.testing.assert_allclose(values[field], expected, rtol=2e-14, atol=1e-13 * np.abs(expected).max())

    def test_between_steps(self):
        """No step ends at a moment, or for the average at all: the run has its bits; values are linear within steps."""
        one, other = (averaged(self.path(f"between{i}"), end=0.01, settings="period 0.0037; phases 9; start 0.0011;") for i in (1, 2))
        for case in (one, other):
            os.rename(case + "/0", case + "/0.orig")
            harness.edit(case, CONTROL, writeControl="timeStep", writeInterval=1)
            runs.add(case, CONTROL, "timePrecision 17;\n")
        harness.edit(other, CONTROL, type="phaseAverage; enabled no")
        for case in (one, other):
            harness.program("granularGas", "-case", case)
        self.assertEqual(runs.times(one), runs.times(other))
        last = runs.times(one)[-1]
        for field in ("rho", "rhoU", "rhoE"):
            with open(f"{one}/{last}/{field}", "rb") as f, open(f"{other}/{last}/{field}", "rb") as g:
                self.assertEqual(f.read(), g.read(), field)
        found, counts = means(one)
        result = harness.haff.Case(one)
        times = np.array([float(t) for t in runs.times(one)])
        state = {f: np.array([result.field(f, t) for t in runs.times(one)]) for f in FIELDS.split()}
        for j, (phase, values) in enumerate(found.items()):
            moments = [0.0011 + 0.0037 * (k + j / 9) for k in range(int(counts[phase]))]
            self.assertEqual(len(moments), sum(0.0011 + 0.0037 * (k + j / 9) <= 0.01 for k in range(9)))
            mass = sum(np.apply_along_axis(lambda q, t=t: np.interp(t, times, q), 0, state["rho"]) for t in moments)
            for field in FIELDS.split():
                weight = state["rho"] if field == "T" else state["rho"][..., None] if field == "U" else 1
                sums = sum(np.apply_along_axis(lambda q, t=t: np.interp(t, times, q), 0, weight * state[field]) for t in moments)
                expected = sums / (mass if field == "T" else mass[..., None] if field == "U" else len(moments))
                with self.subTest(phase=phase, field=field):
                    np.testing.assert_allclose(values[field], expected, rtol=0, atol=1e-12 * np.abs(expected).max())

    def restarted(self, name, **options):
        """Stopped between two phases, at a phase and before the first, on one and two ranks."""
        whole = averaged(self.path(name), interval=0.00375, **options)
        harness.program("granularGas", "-case", whole)
        last = runs.times(whole)[-1]
        for ranks, stop in ((1, "0.00375"), (2, "0.015"), (1, "0.02625")):
            with self.subTest(name, stop=stop):
                part = runs.until(whole, f"{whole}_{stop}", stop)
                harness.program("granularGas", "-case", part, ranks=ranks)
                one, other = (runs.contents(os.path.join(c, last)) for c in (whole, part))
                self.assertIn("uniform/phaseAverage.mean" + (".gz" if "compression" in options else ""), one)
                runs.same(self, one, other)
                (values, counts), (again, counted) = means(whole), means(part, stop)
                self.assertEqual(counts, counted)
                self.assertEqual(list(values), list(again))
                for phase, fields in values.items():
                    for field in fields:
                        self.assertTrue((fields[field] == again[phase][field]).all(), f"{phase} {field}")

    def test_restart_binary(self):
        self.restarted("binary")

    def test_restart_ascii(self):
        """The sums have all digits where the fields have three; a hole."""
        self.restarted("ascii", format="ascii", digits=3, compression="on", hole=True)

    def test_grains(self):
        """Means of granularMD, whose fields are those of windows that end at the phases."""
        options = {**test_particles.LAYER, "alpha": 0.08, "particles": "coarseGraining { window 0.5; samples 3; }\n",
                   "control": AVERAGE % (FIELDS, "period 2; phases 4; start 0.5;")}
        whole, part = (test_particles.make(self.path(name), end=end, **options) for name, end in (("whole", 5), ("part", 3.2)))
        for case in (whole, part):
            test_particles.solve(case)
        harness.edit(part, CONTROL, endTime=5)
        test_particles.solve(part)
        (values, counts), (again, counted) = means(whole), means(part, "3.2")
        self.assertEqual(list(counts.values()), ["3", "3", "2", "2"])
        self.assertEqual(counts, counted)
        result = harness.haff.Case(whole)
        rho, T = (np.array([result.field(f, t) for t in (0.5, 2.5, 4.5)]) for f in ("rho", "T"))
        np.testing.assert_allclose(values["0"]["rho"], rho.mean(axis=0), rtol=1e-14)
        full = rho.sum(axis=0) > 0
        self.assertTrue(0 < full.sum() < full.size, "some cells stay empty")
        np.testing.assert_allclose(values["0"]["T"][full], ((rho * T).sum(axis=0)[full] / rho.sum(axis=0)[full]), rtol=1e-13)
        self.assertTrue((values["0"]["T"][~full] == 0).all())
        for phase, fields in values.items():
            for field in fields:
                self.assertTrue((fields[field] == again[phase][field]).all(), f"{phase} {field}")

    def test_other_average(self):
        """Sums of other settings are not mixed in; a moment that such a run starts at counts."""
        case = averaged(self.path("other"), end=0.02, interval=0.01)
        harness.program("granularGas", "-case", case)
        harness.edit(case, CONTROL, endTime=0.03, phases=2)
        said = harness.program("granularGas", "-case", case).stdout
        self.assertIn("the averages begin anew", said)
        self.assertEqual(means(case, "0.02")[1], {"0": "1", "0.5": "2"})

    def test_damaged(self):
        """A sum that was changed is noticed as a field is."""
        case = averaged(self.path("damaged"), end=0.02, interval=0.01)
        harness.program("granularGas", "-case", case)
        with open(os.path.join(case, "0.02", "uniform", "phaseAverage.mean"), "ab") as f:
            f.write(b" ")
        harness.edit(case, CONTROL, endTime=0.03)
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("phaseAverage.mean", done.stderr)

    def test_nonsense(self):
        """A file without checksums that holds something else."""
        case = averaged(self.path("nonsense"), n=(4, 4, 1), end=0.02, interval=0.01, format="ascii")
        harness.program("granularGas", "-case", case)
        os.remove(os.path.join(case, "0.02", "uniform", "checksums"))
        path = os.path.join(case, "0.02", "uniform", "phaseAverage.mean")
        with open(path) as f:
            text = f.read()
        for pattern, new, message in ((r"counts +\( 2", "counts ( -1", "no number of samples"), (r"counts +\( 2", "counts ( 1e99", "no number of samples"),
                                      (r"sum0 nonuniform List<scalar> \n128", "sum0 nonuniform List<scalar> \n127", "says 127 entries, but has more"),
                                      (r"sum1 ", "summe1 ", "'sum1' is missing"), (r"period +", "Period ", "'period' is missing")):
            with self.subTest(new):
                changed, n = re.subn(pattern, new, text)
                self.assertEqual(n, 1)
                with open(path, "w") as f:
                    f.write(changed)
                done = harness.program("granularGas", "-case", case, "-dry-run", check=False)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, "phaseAverage.mean(.|\n)*(" + message + ")")

    def test_file(self):
        """A field file as those of a time folder: class, place, an entry for each patch."""
        case = averaged(self.path("file"), end=0.01, interval=0.01, format="ascii")
        harness.program("granularGas", "-case", case)
        with open(os.path.join(case, "postProcessing/mean/0/0.5/U")) as f:
            text = f.read()
        for part in ("volVectorField", '"postProcessing/mean/0/0.5"', "[0 1 -1 0 0 0 0]", "xLow", "calculated", "zEmpty", "empty"):
            self.assertIn(part, text)

    def test_vtk(self):
        """The phases for ParaView: of the latest start, with their means and a series over the period."""
        case = averaged(self.path("vtk"), end=0.02, interval=0.01)
        harness.program("granularGas", "-case", case)
        harness.edit(case, CONTROL, endTime=0.03)
        harness.program("granularGas", "-case", case)
        harness.program("caseToVTK", case, "-phases", "mean")
        with open(os.path.join(case, "VTK", "mean.vtk.series")) as f:
            series = {e["name"]: e["time"] for e in json.load(f)["files"]}
        self.assertEqual(series, {f"mean_{p}.vtk": float(p) for p in ("0", "0.25", "0.5", "0.75")})
        cells = meshio.read(os.path.join(case, "VTK", "mean_0.5.vtk")).cell_data
        self.assertEqual(set(cells), set(FIELDS.split()))
        for name, values in means(case, "0.02")[0]["0.5"].items():
            self.assertTrue((cells[name][0] == values).all(), name)
        done = harness.program("caseToVTK", case, "-phases", "means", check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("postProcessing/means: no such folder; -phases wants", done.stderr)

    def test_period_of_the_shaking(self):
        case = averaged(self.path("shaken"), n=(12, 10, 1), end=0.02, interval=0.02, settings="phases 5;")
        harness.write_dictionary(case, "constant", "shaking", "type sinusoidal; amplitude 2; frequency 200;\n")
        harness.program("granularGas", "-case", case)
        self.assertEqual(means(case)[1], {"0": "5", "0.2": "4", "0.4": "4", "0.6": "4", "0.8": "4"})

    def test_wrong(self):
        rows = [("period 0.01; phases 0;", ("phases is 0", "1 .. 1000")),
                ("period 0.01; phases 1001;", ("phases is 1001", "1 .. 1000")),
                ("period 0;", ("period is 0", "greater than 0")),
                ("period -1;", ("period is -1", "greater than 0")),
                ("period [0 1 0 0 0 0 0] 1;", ("'period'",)),
                ("period 0.01; start later;", ("'start'", "later")),
                ("phases 3;", ("'period'", "missing", "constant/shaking")),
                ("period 0.01; phase 3;", ("'phase'", "did you mean 'phases'"))]
        for i, (settings, parts) in enumerate(rows):
            with self.subTest(settings):
                case = averaged(self.path(f"wrong{i}"), n=(4, 4, 1), settings=settings)
                done = harness.program("granularGas", "-case", case, "-dry-run", check=False)
                self.assertEqual(done.returncode, 1)
                for part in ("controlDict", *parts):
                    self.assertIn(part, done.stderr)
        case = averaged(self.path("short"), n=(4, 4, 1), settings="period 1e-9; phases 3;")
        done = harness.program("granularGas", "-case", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"controlDict: functions: \S+: the step to t = \S+ s holds \S+e\+\d+ samples, 10000 are allowed: give a longer")
        case = averaged(self.path("wrong"), n=(4, 4, 1), fields="rho alfa")
        self.assertIn("did you mean 'alpha'?", harness.program("granularGas", "-case", case, check=False).stderr)


if __name__ == "__main__":
    unittest.main()
