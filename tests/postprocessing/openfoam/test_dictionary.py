# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenFOAM's dictionaries as they are read for a conversion: macros, included files, arithmetic, patterns, lists; each value knows its line."""
import os
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.openfoam import foam

from haff.case.foam import FormatError
from haff.openfoam import dictionary
from studies.made import boxes


class Dictionaries(harness.Folder, unittest.TestCase):
    def read(self, text):
        foam.put(self.folder, "system/d", text)
        return dictionary.read(os.path.join(self.folder, "system", "d"), self.folder)

    def test_values(self):
        """By OpenFOAM's foamDictionary -expand: a macro has the value that stands before it, patterns are found, blocks merge."""
        d = self.read("""a 1; b $a; a 2; c ${a}; // comment; a 5;
            in { x 3; y $x; z $..a; top $:a; deep { w $x; } } in { x 4; }
            twice #eval{ 2*$a }; root #calc "sqrt(4.0)*$a"; list ( $a (1 2) ); from $in.deep.w;
            solvers { "(p|U)" { tol 1; } U2 { $p; rel 0; } }
            name "with ; and }"; code #{ int x; #};
            """)
        self.assertEqual([d[k] for k in ("b", "c", "twice", "root", "list", "from", "name")], ["1", "2", "4.0", "4.0", "( 2 (1 2) )", "3", '"with ; and }"'])
        self.assertEqual((d["in"]["x"], d["in"]["y"], d["in"]["z"], d["in"]["top"], d["in"]["deep"]["w"]), ("4", "3", "2", "2", "3"))
        self.assertEqual(dict(d["solvers"]["U2"]), {"tol": "1", "rel": "0"})
        self.assertEqual(d["twice"].place, "system/d:4")

    def test_files(self):
        foam.put(self.folder, "system/more", "m 7; n { k 1; }\n")
        d = self.read('#include "more"\n#includeIfPresent "nothing"\n#includeEtc "caseDicts/setConstraintTypes"\n$n; twice #eval{ 2*$m };\n#remove m\n')
        self.assertEqual((d["k"], d["twice"], "m" in d, d["n"]["k"].place), ("1", "14.0", False, "system/more:2"))

    def test_faults(self):
        for text, words in (("a $b;", "system/d:2: macro '$b' names no entry"), ("a 1", "entry 'a' is not closed by ';'"),
                            ("a { b 1; ", "is not closed by '}'"),
                            ("} a 1;", "closes nothing"), ('#include "gone"', "there is no"), ("#if 1\n", "#if is not read here"),
                            ("a #calc \"system(1)\";", "cannot be computed here"), ("d { } a (1 $d);", "is a dictionary")):
            with self.subTest(text):
                with self.assertRaises(FormatError) as caught:
                    self.read(text)
                self.assertIn(words, str(caught.exception))

    def test_matching(self):
        d = self.read('a { } "b.*" { } ".*" { x 1; } "(" { }')
        with self.assertRaisesRegex(FormatError, "no regular expression"):
            d.matching(["c"])
        del d["("]
        self.assertIs(d.matching(["a"]), d["a"])
        self.assertIs(d.matching(["bc"]), d[".*"])
        self.assertIs(d.matching(["c", "a"]), d["a"])

    def test_fields(self):
        """Lists stay apart, binary ones too; what stands behind them has the right line."""
        values = np.arange(12.0).reshape(4, 3)
        for binary in (False, True):
            boxes.write_field(self.folder, "U", values, "in fixedValue; value $internalField\nout zeroGradient", binary=binary)
            d = dictionary.read_field(os.path.join(self.folder, "0", "U"), self.folder)
            self.assertEqual(d["internalField"], "nonuniform @0")
            np.testing.assert_array_equal(d.lists[0], values)
            self.assertEqual((d["boundaryField"]["in"]["value"], d["boundaryField"]["out"]["type"]), ("nonuniform @0", "zeroGradient"))
        boxes.write_field(self.folder, "U", values, "in fixedValue; value uniform (0 0 0)")
        path = os.path.join(self.folder, "0", "U")
        with open(path, encoding="ascii") as f:
            line = next(k for k, row in enumerate(f, 1) if "fixedValue" in row)
        self.assertEqual(dictionary.read_field(path, self.folder)["boundaryField"]["in"]["type"].place, f"0/U:{line}")


if __name__ == "__main__":
    unittest.main()
