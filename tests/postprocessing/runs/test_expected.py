# SPDX-License-Identifier: GPL-3.0-or-later
"""haff expected on a case of one's own: it explains, makes an expected.json, and compares with that."""
import contextlib
import io
import json
import os
import shutil
import sys
import tempfile
import unittest

import numpy as np

from tests.cases import harness  # noqa: F401  (knows where postprocessing is)
from tests.postprocessing.plot import cases
from haff import command
from haff.runs import expected
from studies.checks import variants


def called(*words):
    out, was = io.StringIO(), sys.argv
    sys.argv = ["haff expected", *words]
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            code = command.ended("haff expected", expected.main)
    finally:
        sys.argv = was
    return int(code), out.getvalue()


class Own(unittest.TestCase):
    def test_made_and_compared(self):
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            at = cases.box(folder, (4, 5, 1), (0.4, 0.5, 0.1))
            cases.fields(folder, "1", alpha=at[:, 1], U=at)
            file = os.path.join(folder, "expected.json")
            self.assertEqual(called(folder)[0], 1)
            self.assertIn(f"{file} is not there, which holds what is expected; haff expected {folder} -make writes one", called(folder)[1])
            self.assertEqual(called(folder, "-make"), (0, file + "\n"))
            code, said = called(folder)
            self.assertEqual((code, said.count("ok "), said.count("BAD")), (0, 3, 0), said)
            self.assertIn("ok  maximum alpha at t = 1: 0.45, expected 0.45 +- 0.004", said)
            self.assertIn("is not overwritten", called(folder, "-make")[1])
            cases.fields(folder, "1", alpha=at[:, 1] + 0.01)
            code, said = called(folder)
            self.assertEqual((code, said.count("BAD")), (1, 3), said)

    def test_made_tolerances(self):
        """A hundredth of the range, at most a tenth of the value, and no less than round-off; how often cells were limited is no result."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            x = cases.box(folder, (4, 5, 1), (0.4, 0.5, 0.1))[:, 0] / 0.35
            spans = np.where(x < 0.2, 1e-6, 1.0)
            cases.fields(folder, "1", alpha=spans, T=2 + x, p=np.where(x < 0.2, 0, 1.0))
            shutil.copy(os.path.join(folder, "1", "T"), os.path.join(folder, "1", "limited"))
            self.assertEqual(called(folder, "-make")[0], 0)
            with open(os.path.join(folder, "expected.json")) as f:
                made = {(e["field"], e["quantity"]): e["tolerance"] for e in json.load(f)["full"]}
            self.assertEqual({field for field, _ in made}, {"alpha", "T", "p"})
            for (field, quantity), tolerance in ((("alpha", "minimum"), 1e-7), (("alpha", "maximum"), 0.01), (("alpha", "sum"), 0.2),
                                                 (("T", "minimum"), 6 / 7 / 100), (("p", "minimum"), 1e-9)):
                self.assertAlmostEqual(made[field, quantity] / tolerance, 1, 2, (field, quantity))

    def test_tolerance(self):
        """A value is right up to its tolerance on either side, and wrong beyond; what is no number, or is not there, is wrong."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            at = cases.box(folder, (4, 5, 1), (0.4, 0.5, 0.1))
            cases.fields(folder, "1", alpha=at[:, 1] * 0 + 0.5, T=at[:, 1] * np.nan)
            entry = {"quantity": "maximum", "field": "alpha", "time": 1, "tolerance": 0.125}
            for value, right in ((0.5, True), (0.375, True), (0.625, True), (0.3749, False), (0.6251, False)):
                self.assertEqual(expected.judge(folder, {**entry, "value": value}), (0.5, right, ""), value)
            self.assertFalse(expected.judge(folder, {**entry, "field": "T", "value": 0.5})[1])
            for missing in ({"time": 2}, {"time": 1 + 1e-8}, {"field": "rho"}, {"folder": "fine"}):
                value, right, why = expected.judge(folder, {**entry, "value": 0.5, **missing})
                self.assertEqual((np.isnan(value), right, why[:6]), (True, False, "none ("), missing)

    def test_quantities(self):
        """What cases measure, of fields that are known, on 8 x 5 cells of a width of 0.25 m."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            x, y, _ = cases.box(folder, (8, 5, 1), (2, 1.25, 0.1)).T
            cases.fields(folder, "3", rho=x + y - 2, T=(x - 1.2)**2)
            for quantity, field, value in (("minimum", "rho", -1.75), ("maximum", "rho", 1),
                                           ("position of maximum", "rho", 1.875), ("position of maximum", "T", 0.125),
                                           ("value at the wall", "T", 0.675**2), ("last time", None, 3)):
                case = expected.haff.Case(folder)
                self.assertAlmostEqual(expected.measure(case, {"quantity": quantity, "field": field, "time": 3}), value, 12, (quantity, field))
            cases.fields(folder, "4", rho=np.where(y < 0.25, 3 + x, 100))
            for quantity, at, value in (("value off the wall", 0.3, 4.7), ("value off the wall", 0, 4.875), ("position of the front", 1.25, 1.25 * 3.125 - 3)):
                self.assertAlmostEqual(expected.measure(case, {"quantity": quantity, "field": "rho", "time": 4, "at": at}), value, 12, (quantity, at))
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            x = cases.box(folder, (8, 1, 1), (2, 0.1, 0.1))[:, 0]
            cases.fields(folder, "3", rho=3 + x)
            case = expected.haff.Case(folder)
            self.assertAlmostEqual(expected.measure(case, {"quantity": "integral along x", "field": "rho", "time": 3}), 8, 12)
            self.assertAlmostEqual(expected.measure(case, {"quantity": "sum", "field": "rho", "time": 3}), 32, 12)
            cases.fields(folder, "2.5", rho=3.5 + x)
            self.assertAlmostEqual(expected.measure(case, {"quantity": "change within a time", "field": "rho", "time": 3, "at": 0.5}), 0.5 / 4, 12)
            self.assertEqual(expected.judge(folder, {"quantity": "change within a time", "field": "rho", "time": 3, "at": 0.4, "value": 0, "tolerance": 1})[2][:6], "none (")
            for distance, value in ((0.125, 4.875), (0.3, 4.7), (0, 4.875)):
                self.assertAlmostEqual(expected.measure(case, {"quantity": "value off the wall", "field": "rho", "time": 3, "at": distance}), value, 12)

    def test_heights(self):
        """Of a column in y, whose thin upper half is left out."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            y = cases.box(folder, (1, 8, 1), (0.1, 2, 0.1))[:, 1]
            cases.fields(folder, "3", alpha=np.where(y < 1, 0.3, 0.01), T=1 + y * (1.6 - y) + 7 * (y > 1))
            case = expected.haff.Case(folder)
            for quantity, value in (("maximum above that packing", 1 + 0.875 * 0.725), ("height of the maximum above that packing", 0.875),
                                    ("height up to that packing", 0.875)):
                self.assertAlmostEqual(expected.measure(case, {"quantity": quantity, "field": "T", "time": 3, "at": 0.02}), value, 12, quantity)
            self.assertAlmostEqual(expected.measure(case, {"quantity": "value at the floor", "field": "T", "time": 3}), 1 + 0.125 * 1.475, 12)

    def test_section(self):
        """Of a section of 0.1 x 2 m: a flow of 0.5 m/s in gas of packing 0.3, and faster gas that is too thin to count for the greatest velocity."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            y = cases.box(folder, (1, 8, 1), (0.1, 2, 0.1))[:, 1]
            low = (y < 1)[:, None]
            cases.fields(folder, "3", alpha=np.where(y < 1, 0.3, 0.001), U=np.where(low, [0.03, 0.04, 0.5], [3, 4, 5]))
            case = expected.haff.Case(folder)
            for quantity, value in (("greatest velocity along z", 0.5), ("greatest velocity across z", 0.05), ("flow of packing along z", 0.1 * (0.15 + 0.005))):
                self.assertAlmostEqual(expected.measure(case, {"quantity": quantity, "time": 3}), value, 12, quantity)

    def test_asymmetry(self):
        """About the line y = 10 - x: a field that mirrors itself has none; one cell that is off by a tenth of the greatest value has that."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            x, y, z = cases.box(folder, (5, 5, 1), (10, 10, 1)).T
            for time, more in (("1", 0), ("2", 1)):
                rho, U = x - y + 10, np.stack((x, y - 10, 0 * z), axis=1)
                rho[3] += 0.1 * 18 * more
                U[3, 0] += 0.1 * 9 * more
                cases.fields(folder, time, rho=rho, U=U)
            case = expected.haff.Case(folder)
            for field in ("rho", "U"):
                for time, value in ((1, 0), (2, 0.1)):
                    self.assertAlmostEqual(expected.measure(case, {"quantity": "asymmetry", "field": field, "time": time}), value, 12, field)

    def test_damaged(self):
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            cases.control(folder)
            for text, says in (("{ none", "is no JSON"), ("[]", "holds a list"), ("{}", 'no entry "full"'), ('{"full": 3}', "no list of entries"),
                               ('{"full": [{"quantity": "maximum"}]}', 'entry 1 of "full" has no value'),
                               (json.dumps({"full": [{"quantity": "maxmum", "value": 1, "tolerance": 0}]}), "did you mean maximum?")):
                with open(os.path.join(folder, "expected.json"), "w") as f:
                    f.write(text)
                code, said = called(folder)
                self.assertEqual(code, 1)
                self.assertIn(says, said)


class Variants(unittest.TestCase):
    ENTRY = {"quantity": "maximum", "field": "T", "tolerance": 0.01}

    def test_lists(self):
        """A list as time and one as field make an entry for each pair, with the values in that order."""
        rows = variants.spread({**self.ENTRY, "field": ["T", "p"], "time": [1, 2], "value": [1, 2, 3, 4], "measured": [5, 6, 7, 8]})
        self.assertEqual([(r["field"], r["time"], r["value"], r["measured"]) for r in rows], [("T", 1, 1, 5), ("T", 2, 2, 6), ("p", 1, 3, 7), ("p", 2, 4, 8)])
        self.assertEqual(variants.spread(self.ENTRY), [self.ENTRY])

    def test_what_was_written_down_is_the_value(self):
        one, two, three = variants.entries({"full": [{**self.ENTRY, "measured": 3}, {**self.ENTRY, "value": 1, "measured": 3}, self.ENTRY]})
        self.assertEqual((one["value"], two["value"], one["own"], "own" in two), (3, 1, True, False))
        self.assertTrue(np.isnan(three["value"]))

    def test_written_down(self):
        """To a tenth of the tolerance; an entry that lacks one of its values stays, and the other variants do."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            full = [{**self.ENTRY, "time": [1, 2]}, {**self.ENTRY, "time": [1, 2], "measured": [7, 7]}, {"quantity": "last time", "tolerance": 300}]
            expected.save(folder, {"full": [], "variants": [{"name": n, "full": json.loads(json.dumps(full))} for n in "ab"]})
            variants.write_down(folder, "b", [0.123456, 1, 3, np.nan, 4321.2], 1.234)
            a, b = variants.load(folder)
            self.assertEqual(a["full"], full)
            self.assertEqual([e.get("measured") for e in b["full"]], [[0.123, 1], [7, 7], 4321])
            self.assertEqual(b["seconds"], 1.2)

    def test_damaged(self):
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            good = {"name": "a", "full": [self.ENTRY]}
            for found, says in (([good, good], "variant 2 needs a name of its own.* it has 'a'"), ([{**good, "name": "a b"}], "it has 'a b'"),
                                ([{**good, "grid": 3}], "variant a has an unknown 'grid'"), ([{"name": "a"}], "variant a: \"full\" is no list"),
                                ([{"name": "a", "full": [{"quantity": "maximum"}]}], "variant a: entry 1 of \"full\" has no tolerance")):
                expected.save(folder, {"full": []})
                with open(os.path.join(folder, "expected.json"), "w") as f:
                    json.dump({"variants": found}, f)
                with self.assertRaisesRegex(ValueError, says):
                    variants.load(folder)
            expected.save(folder, {"variants": [good]})
            self.assertEqual(variants.load(folder), [good])


if __name__ == "__main__":
    unittest.main()
