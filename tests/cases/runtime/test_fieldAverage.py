# SPDX-License-Identifier: GPL-3.0-or-later
"""fieldAverage: means and mean squares of fluctuations are integrals over time of the second order, change no bit of the run,
survive restarts to the bit on any ranks, and refuse what is wrong."""
import os
import re
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.grains import test_particles

CONTROL = "system/controlDict"
STEP, END = 1e-3, 0.02
AVERAGE = """functions {{ mean {{ type fieldAverage; libs (fieldFunctionObjects); {0} fields (
    U {{ mean on; prime2Mean on; base time; }}
    T {{ mean on; prime2Mean on; base time; }}
    alpha {{ mean yes; prime2Mean yes; base {1}; }}
    p {{ prime2Mean off; }}
); }} }}
"""


def averaged(folder, settings="", base="time", n=(24, 18, 1), **options):
    case = runs.make(folder, n, END, **{"interval": 0.005, **options})
    runs.add(case, CONTROL, AVERAGE.format(settings, base))
    return case


def mean_weights(times, start, end):
    """Weights of the states at `times` in the mean from start to end over what is linear in between."""
    w = np.zeros(len(times))
    for i, (a, b) in enumerate(zip(times[:-1], times[1:])):
        low, high = max(a, start), min(b, end)
        late = (0.5 * (low + high) - a) / (b - a)
        w[i:i + 2] += max(high - low, 0) * np.array((1 - late, late))
    return w


def iter_weights(times, start, end):
    return ((times > start) & (times <= end)).astype(float)


def tensors(case, name, time):
    """A symmTensor field as [cells, 6]."""
    with open(os.path.join(case, time, name), "rb") as f:
        data = f.read()
    head = re.search(rb"internalField +nonuniform List<symmTensor>\s+(\d+)\s*\(", data)
    n = int(head[1])
    return np.frombuffer(data, count=6 * n, offset=head.end()).reshape(n, 6)


def moments(weights, values):
    """Mean and mean squares (xx xy xz yy yz zz) of samples [steps, cells, ...] with weights [steps, cells]."""
    w = weights / weights.sum(axis=0)
    w = w[..., None] if values.ndim == 3 else w
    mean = (w * values).sum(axis=0)
    d = values - mean
    if values.ndim == 2:
        return mean, (w * d * d).sum(axis=0)
    return mean, np.stack([(w[..., 0] * d[..., i] * d[..., j]).sum(axis=0) for i in range(3) for j in range(i, 3)], axis=1)


class FieldAverage(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def check(self, case, start, end, base, weighted):
        """The averages of the last time against the written steps."""
        result = harness.haff.Case(case)
        names = runs.times(case)
        at = np.array([float(n) for n in names])
        state = {f: np.array([result.field(f, n) for n in names]) for f in ("rho", "U", "T", "alpha", "p")}
        last, one = names[-1], np.ones_like(state["rho"])
        for name in ("U", "T", "alpha", "p"):
            weights = iter_weights if name == "alpha" and base == "iter" else mean_weights
            time = one * weights(at, start, end)[:, None]
            mean, squares = moments(time * (state["rho"] if weighted and name in "UT" else 1), state[name])
            with self.subTest(case=case, name=name):
                scale = np.abs(state[name]).max()
                np.testing.assert_allclose(result.field(name + "Mean", last), mean, rtol=0, atol=1e-13 * scale)
                if name == "U":
                    found = tensors(case, "UPrime2Mean", last)
                elif name != "p":
                    found = result.field(name + "Prime2Mean", last)
                if name != "p":
                    np.testing.assert_allclose(found, squares, rtol=0, atol=1e-13 * scale ** 2)
                    self.assertGreater(np.abs(squares).max(), 1e-7 * scale ** 2)
        self.assertFalse(os.path.exists(os.path.join(case, last, "pPrime2Mean")))

    def test_means(self):
        """Of all steps, each of which is written, of other lengths, with U and T weighted by rho, or not; of some of the time."""
        for name, settings, base, start, end, weighted in (
                ("all", "", "time", 0, END, True), ("plain", "weighted no;", "iter", 0, END, False),
                ("part", "timeStart 0.0041; timeEnd 0.0153;", "iter", 0.0041, 0.0153, True)):
            case = averaged(self.path(name), settings, base)
            os.rename(case + "/0", case + "/0.orig")  # so that the start is written, too
            harness.edit(case, CONTROL, writeControl="timeStep", writeInterval=1)
            runs.add(case, CONTROL, "timePrecision 17;\n")
            harness.program("granularGas", "-case", case)
            times = np.array([float(t) for t in runs.times(case)])
            if name == "all":
                whole = times
            if name == "part":
                self.assertTrue((times == whole).all(), "no step ends at timeStart or timeEnd")
                late = [t for t in runs.times(case) if float(t) > end]
                self.assertGreater(len(late), 1)
                for t in late:  # what follows timeEnd changes nothing
                    self.assertTrue((tensors(case, "UPrime2Mean", t) == tensors(case, "UPrime2Mean", late[0])).all())
                self.assertFalse(os.path.exists(os.path.join(case, runs.times(case)[1], "UMean")), "nothing before timeStart")
            self.assertGreater(np.ptp(np.diff(times)[2:-2]), 1e-7)
            self.check(case, start, end, base, weighted)

    def test_second_order(self):
        """Uniform gas that cools by Haff's law, T = T0/(1 + t/tau)^2, in few steps: the mean from t1 to t2 is
        T0/((1 + t1/tau) (1 + t2/tau)), and its error falls four times with the step; the sum of right ends was 7.7 % off."""
        errors = []
        for i, step in enumerate((0.00125, 0.000625)):
            case, n = self.path(f"cooling{i}"), (2, 2, 1)
            one = np.ones(4)
            harness.box_case(case, n, np.array((10, 10, 0.1)), 100 * one, np.zeros((4, 3)), 2e6 * one, END, e=0.5, cooling="Haff", interval=END)
            runs.add(case, CONTROL, AVERAGE.format("timeStart 0.0031;", "time"))
            os.rename(case + "/0", case + "/0.orig")
            harness.edit(case, CONTROL, adjustTimeStep="no", deltaT=step)
            harness.program("granularGas", "-case", case)
            result = harness.haff.Case(case)
            T0, T1 = (result.field("T", t)[0] for t in runs.times(case))
            tau = END / (np.sqrt(T0 / T1) - 1)
            self.assertGreater(END / tau, 0.5)
            expected = T0 / ((1 + 0.0031 / tau) * (1 + END / tau))
            errors.append(result.field("TMean", runs.times(case)[-1])[0] / expected - 1)
        self.assertLess(abs(errors[0]), 0.005)
        self.assertLess(abs(errors[1]), abs(errors[0]) / 3.5)

    def test_restart(self):
        """Binary and ascii of few digits; other ranks; tables of the restarted run."""
        for name, others, options in (("binary", 2, {}), ("ascii", 3, {"format": "ascii", "digits": 3, "compression": "on", "hole": True})):
            case = averaged(self.path(name), "timeStart 0.003;", **options)
            harness.program("granularGas", "-case", case)
            for stop, ranks in (("0.005", 1), ("0.01", others)):
                part = runs.until(case, f"{case}_{stop}", stop)
                harness.program("granularGas", "-case", part, ranks=ranks)
                for time in runs.times(case):
                    if float(time) > float(stop):
                        one, other = (runs.contents(os.path.join(c, time)) for c in (case, part))
                        self.assertTrue({n.removesuffix(".gz") for n in one} >= {"UMean", "UPrime2Mean", "pMean", "uniform/fieldAverage.mean"})
                        runs.same(self, one, other, f"{name} {time}")

    def test_polyhedra(self):
        """The same from cells in blocks of polyhedra, on two ranks, and after a restart."""
        case, other = (averaged(self.path(f"poly{i}"), hole=True) for i in (1, 2))
        for c in (case, other):
            runs.add(c, "system/fvSchemes", "meshEngine polyhedral;\n")
        harness.program("granularGas", "-case", case)
        harness.program("granularGas", "-case", other, ranks=2)
        again = runs.until(case, self.path("poly3"), "0.01")
        harness.program("granularGas", "-case", again)
        for c in (other, again):
            runs.same(self, *(runs.contents(c + "/0.02") for c in (case, c)))

    def test_anew(self):
        """restartOnOutput: the means of a time are those since the one before; restartOnRestart: since the start."""
        case, plain = averaged(self.path("output"), "restartOnOutput yes;"), averaged(self.path("plain2"))
        for c in (case, plain):
            harness.program("granularGas", "-case", c)
        again = runs.until(plain, self.path("again"), "0.015")
        runs.add(again, CONTROL, "")
        with open(os.path.join(again, CONTROL)) as f:
            text = f.read()
        with open(os.path.join(again, CONTROL), "w") as f:
            f.write(text.replace("type fieldAverage;", "type fieldAverage; restartOnRestart yes;"))
        harness.program("granularGas", "-case", again)
        for field in ("UMean", "TMean", "UPrime2Mean", "alphaMean", "pMean"):
            with open(os.path.join(case, "0.02", field), "rb") as f, open(os.path.join(again, "0.02", field), "rb") as g:
                self.assertEqual(f.read(), g.read(), field)
            with open(os.path.join(plain, "0.02", field), "rb") as f, open(os.path.join(again, "0.02", field), "rb") as g:
                self.assertNotEqual(f.read(), g.read(), field)

    def test_other_settings(self):
        """Sums of other settings are not mixed in."""
        case = averaged(self.path("other"))
        harness.program("granularGas", "-case", case)
        harness.edit(case, CONTROL, endTime=0.025)
        with open(os.path.join(case, CONTROL)) as f:
            text = f.read()
        with open(os.path.join(case, CONTROL), "w") as f:
            f.write(text.replace("base time;", "base iter;"))
        self.assertIn("the averages begin anew", harness.program("granularGas", "-case", case).stdout)

    def test_uniform_axis(self):
        """A mesh of which one layer is computed has the averages of all its cells."""
        types = {"x": "cyclic"}
        case = os.path.join(self.folder, "layers")
        n, size = np.array((8, 12, 1)), np.array((0.8, 1.2, 0.1))
        y = harness.boxes.centres(n, size)[:, 1]
        harness.box_case(case, n, size, 100 + 20 * np.cos(3 * y), np.zeros((len(y), 3)), 2000 + 0 * y, END, types=types, gravity=(0, -20.0, 0),
                         e=0.9, cooling="Haff")
        runs.add(case, CONTROL, AVERAGE.format("", "time"))
        self.assertIn("uniform along x", harness.program("granularGas", "-case", case).stdout)
        mean = harness.haff.Case(case).field("TMean", runs.times(case)[-1]).reshape(12, 8)
        self.assertTrue((mean == mean[:, :1]).all())
        self.assertGreater(np.ptp(mean), 0.01)

    def test_grains(self):
        case = test_particles.make(self.path("grains"), end=2, control=AVERAGE.format("", "time"))
        test_particles.solve(case)
        self.assertTrue(np.isfinite(harness.haff.Case(case).field("UMean", runs.times(case)[-1])).all())

    def test_wrong(self):
        rows = [(("fields (", "fields ( V { mean on; }"), ("no field 'V'", "known are rho")),
                (("alpha {", "alpa {"), ("no field 'alpa'", "did you mean 'alpha'?")),
                (("prime2Mean off;", "prime2Mean off; mean off;"), ("neither mean nor prime2Mean",)),
                (("prime2Mean off;", "prime2Meen on;"), ("'prime2Meen'", "did you mean 'prime2Mean'?")),
                (("base time; }\n    T", "base tyme; }\n    T"), ("tyme", "time, iter")),
                (("type fieldAverage;", "type fieldAverage; timeStart 1; timeEnd 0.5;"), ("not behind timeStart",)),
                (("type fieldAverage;", "type fieldAverage; writeControl timeStep;"), ("stand in the time folders",)),
                (("functions {", "functions { first { type fieldAverage; fields ( T { mean on; } ); } "), ("'first' averages it already",)),
                (("fields (", "fields (U T); others ("), ("'fields' of fieldAverage says",))]
        for i, ((old, new), parts) in enumerate(rows):
            with self.subTest(new):
                case = averaged(self.path(f"wrong{i}"), n=(4, 4, 1))
                with open(os.path.join(case, CONTROL)) as f:
                    text = f.read()
                self.assertIn(old, text)
                with open(os.path.join(case, CONTROL), "w") as f:
                    f.write(text.replace(old, new, 1))
                done = harness.program("granularGas", "-case", case, "-dry-run", check=False)
                self.assertEqual(done.returncode, 1)
                for part in ("controlDict", *parts):
                    self.assertIn(part, done.stderr)

    def test_nonsense(self):
        """Sums in a file without checksums that hold something else."""
        case = averaged(self.path("nonsense"), n=(4, 4, 1), format="ascii")
        harness.program("granularGas", "-case", case)
        os.remove(os.path.join(case, "0.02", "uniform", "checksums"))
        path = os.path.join(case, "0.02", "uniform", "fieldAverage.mean")
        with open(path) as f:
            text = f.read()
        for pattern, new, message in ((r"total [^;]*;", "total -1;", "not below 0"), (r"List<scalar> \n160", "List<scalar> \n159", "159 entries"),
                                      (r"\nT\n", "\nTT\n", "'T' is missing"), (r"averages +", "average ", "'averages' is missing")):
            with self.subTest(new):
                changed, n = re.subn(pattern, new, text, count=1)
                self.assertEqual(n, 1)
                with open(path, "w") as f:
                    f.write(changed)
                done = harness.program("granularGas", "-case", case, "-dry-run", check=False)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, "fieldAverage.mean(.|\n)*" + message)


if __name__ == "__main__":
    unittest.main()
