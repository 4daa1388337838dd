# SPDX-License-Identifier: GPL-3.0-or-later
"""The reader of clouds: ascii and binary fields, .gz, and what it must refuse."""
import gzip
import os
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes, haff

from haff.case import grains


class Clouds(harness.Folder, unittest.TestCase):
    def setUp(self):
        self.path = tempfile.mkdtemp(dir=self.folder)
        self.cloud = os.path.join(self.path, "0.5", "lagrangian", "grains")
        os.makedirs(self.cloud)
        os.makedirs(os.path.join(self.path, "system"))
        rng = np.random.default_rng(1)
        self.x, self.U, self.cell = rng.normal(size=(9, 3)), rng.normal(size=(9, 3)), np.arange(9) * 3
        self.write("positions", "Cloud<passiveParticle>", b"9\n(\n" + b"".join(
            b"(%.17g %.17g %.17g) %d\n" % (*x, c) for x, c in zip(self.x, self.cell)) + b")\n")
        self.case = haff.Case(self.path)

    def write(self, name, kind, body, binary=False):
        with open(os.path.join(self.cloud, name), "wb") as f:
            f.write(boxes.header(kind, name, "0.5/lagrangian/grains", binary=binary).encode() + b"\n" + body)

    def test_ascii_and_binary(self):
        self.write("U", "vectorField", boxes.raw(self.U, "<f8"), binary=True)
        self.write("id", "labelField", b"9\n(\n" + b"\n".join(b"%d" % i for i in range(9, 0, -1)) + b"\n)\n")
        self.write("d", "scalarField", b"9{0.25}\n")
        found = grains.read(self.case, 0.5)
        self.assertEqual(sorted(found), ["U", "cell", "d", "id", "x"])
        np.testing.assert_array_equal(found["x"], self.x)
        np.testing.assert_array_equal(found["cell"], self.cell)
        np.testing.assert_array_equal(found["U"], self.U)
        np.testing.assert_array_equal(found["id"], np.arange(9, 0, -1))
        np.testing.assert_array_equal(found["d"], np.full(9, 0.25))

    def test_gz(self):
        path = os.path.join(self.cloud, "positions")
        with open(path, "rb") as f:
            text = f.read()
        os.remove(path)
        with open(path + ".gz", "wb") as f:
            f.write(gzip.compress(text))
        np.testing.assert_array_equal(grains.places(self.case, "0.5"), self.x)

    def test_errors(self):
        self.write("d", "scalarField", b"8{0.25}\n")
        with self.assertRaisesRegex(haff.FormatError, "8 values for 9 grains"):
            grains.read(self.case, "0.5")
        self.write("positions", "Cloud<passiveParticle>", b"9\n(\n(1 2 3) 4\n)\n")
        with self.assertRaisesRegex(haff.FormatError, "4 numbers for 9 grains"):
            grains.places(self.case, "0.5")
        self.write("positions", "vectorField", b"1\n(\n(1 2 3)\n)\n")
        with self.assertRaisesRegex(haff.FormatError, "no cloud"):
            grains.places(self.case, "0.5")


if __name__ == "__main__":
    unittest.main()
