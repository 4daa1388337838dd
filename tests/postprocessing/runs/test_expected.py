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
import unittest.mock

import numpy as np

from tests.cases import harness
from tests.postprocessing.plot import cases
from haff import command, paths
from haff.runs import expected


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
                case = harness.haff.Case(folder)
                self.assertAlmostEqual(expected.measure(case, {"quantity": quantity, "field": field, "time": 3}), value, 12, (quantity, field))
            cases.fields(folder, "4", rho=np.where(y < 0.25, 3 + x, 100))
            for quantity, at, value in (("value off the wall", 0.3, 4.7), ("value off the wall", 0, 4.875), ("position of the front", 1.25, 1.25 * 3.125 - 3)):
                self.assertAlmostEqual(expected.measure(case, {"quantity": quantity, "field": "rho", "time": 4, "at": at}), value, 12, (quantity, at))
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            x = cases.box(folder, (8, 1, 1), (2, 0.1, 0.1))[:, 0]
            cases.fields(folder, "3", rho=3 + x)
            case = harness.haff.Case(folder)
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
            case = harness.haff.Case(folder)
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
            case = harness.haff.Case(folder)
            for quantity, value in (("greatest velocity along z", 0.5), ("greatest velocity across z", 0.05), ("flow of packing along z", 0.1 * (0.15 + 0.005))):
                self.assertAlmostEqual(expected.measure(case, {"quantity": quantity, "time": 3}), value, 12, quantity)

    def test_saved_at_once(self):
        """While expected.json is written, the old one is there: Allcheck -record writes beside runs that read it."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            expected.save(folder, {"seconds": 1})
            with unittest.mock.patch.object(os, "replace", side_effect=OSError), self.assertRaises(OSError):
                expected.save(folder, {"seconds": 2})
            self.assertEqual((expected.read(folder), os.listdir(folder)), ({"seconds": 1}, ["expected.json"]))

    def test_of_a_study(self):
        """`quantities` names the module that has what only shipped cases check; without the source tree it says what to do."""
        with tempfile.TemporaryDirectory(prefix="haff") as folder:
            x, _, _ = cases.box(folder, (4, 4, 1), (10, 10, 1)).T
            cases.fields(folder, "1", rho=1 + 0 * x)
            entry = {"quantity": "asymmetry", "field": "rho", "time": 1, "value": 0, "tolerance": 0}
            expected.save(folder, {"quantities": "wedges", "full": [entry]})
            self.assertEqual(called(folder), (0, "ok  asymmetry rho at t = 1: 0, expected 0 +- 0\n"))
            expected.save(folder, {"quantities": "wedgs", "full": [entry]})
            code, said = called(folder)
            self.assertEqual(code, 1)
            self.assertIn("expected.json: quantities 'wedgs' is no module of postprocessing/studies/checks", said)
            expected.save(folder, {"quantities": "wedges", "full": [entry]})
            with unittest.mock.patch.object(paths, "TOP", folder):
                code, said = called(folder)
            self.assertEqual((code, said), (1, f"haff expected: {paths.WITHOUT_STUDIES}\n"))

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



if __name__ == "__main__":
    unittest.main()
