# SPDX-License-Identifier: GPL-3.0-or-later
"""haff expected on a case of one's own: it explains, makes an expected.json, and compares with that."""
import contextlib
import io
import json
import os
import sys
import tempfile
import unittest

from tests.cases import harness  # noqa: F401  (knows where postprocessing is)
from tests.postprocessing.plot import cases
from haff import command
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
