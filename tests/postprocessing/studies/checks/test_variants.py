# SPDX-License-Identifier: GPL-3.0-or-later
"""Variants in expected.json: lists, what is written down, what is refused."""
import json
import os
import tempfile
import unittest

import numpy as np

from tests.cases import harness  # noqa: F401  (knows where postprocessing is)
from haff.runs import expected
from studies.checks import variants


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
