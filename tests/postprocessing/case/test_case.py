# SPDX-License-Identifier: GPL-3.0-or-later
"""The reader of cases on files written here: ascii, binary, .gz, uniform, tables, geometry, and what it must refuse."""
import gzip
import os
import shutil
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes
from tests.cases.harness import haff


class Reader(unittest.TestCase):
    def setUp(self):
        self.path = tempfile.mkdtemp(prefix="haff")
        os.makedirs(os.path.join(self.path, "system"))
        self.n, self.size = (7, 5, 3), (1.4, 0.5, 0.9)
        self.hole = np.zeros(np.prod(self.n), bool)
        self.hole[[0, 52, 104]] = True
        boxes.write_mesh(self.path, self.n, self.size, hole=self.hole)
        self.case = haff.Case(self.path)
        self.cells = int((~self.hole).sum())

    def tearDown(self):
        shutil.rmtree(self.path)

    def write(self, name, text):
        os.makedirs(os.path.dirname(os.path.join(self.path, name)), exist_ok=True)
        with open(os.path.join(self.path, name), "wb") as f:
            f.write(text if isinstance(text, bytes) else text.encode())

    def test_geometry(self):
        np.testing.assert_allclose(self.case.centres, boxes.centres(self.n, self.size)[~self.hole], atol=1e-15)
        np.testing.assert_allclose(self.case.volumes, 0.2 * 0.1 * 0.3, rtol=1e-13)

    def test_skewed_geometry(self):
        """A sheared box keeps its volume, and its centre moves with the shear."""
        centres = self.case.centres
        self.case.mesh.points[:, 0] += 0.4 * self.case.mesh.points[:, 1]
        sheared, volumes = self.case.mesh.cell_geometry()
        np.testing.assert_allclose(volumes, 0.006, rtol=1e-13)
        np.testing.assert_allclose(sheared, centres + np.outer(0.4 * centres[:, 1], (1, 0, 0)), atol=1e-15)

    def test_what_was_meant(self):
        """A name that is not there: the error says where, which are, and which is near, whatever its capitals."""
        boxes.write_field(self.path, "alpha", np.zeros(self.cells), time="0.5")
        boxes.write_field(self.path, "U", np.zeros((self.cells, 3)), time="0.5")
        os.makedirs(os.path.join(self.path, "0.5", "T"))
        name = os.path.basename(self.path)
        for words, says in ((lambda: self.case.field("alfa"), f"{self.path} has no field 'alfa' at time 0.5; did you mean alpha? (fields there: U, alpha)"),
                            (lambda: self.case.field("u", 0.5), "did you mean U?"), (lambda: self.case.sample("Alpha", [[0.1, 0.1, 0.1]]), "did you mean alpha?"),
                            (lambda: self.case.field("alpha", "0.50"), "has no time '0.50'; its times are: 0.5"), (lambda: self.case.unit("rho"), "has no field 'rho' at time 0.5 ("),
                            (lambda: self.case.field("T"), "0.5/T is a folder, and no field"), (lambda: self.case.patch_values("U", "xlow"), "no patch 'xlow'; did you mean xLow?"),
                            (lambda: haff.Case(self.path + "x"), f"no such folder; did you mean {name}?")):
            with self.assertRaises((OSError, ValueError, KeyError)) as caught:
                words()
            self.assertIn(says, str(caught.exception.args[0]))
        self.write("postProcessing/budget/0/energyBudget.dat", "# Time a\n0 1\n")
        self.assertRaisesRegex(FileNotFoundError, "has no tables; did you mean budget?", self.case.table, "budgit")
        self.assertRaisesRegex(FileNotFoundError, "there is no energyBudge.dat; did you mean energyBudget.dat?", self.case.table, "budget", "energyBudge.dat")

    def test_ascii_and_gz(self):
        values = np.random.default_rng(1).normal(size=(self.cells, 3))
        boxes.write_field(self.path, "U", values, time="0.5")
        np.testing.assert_array_equal(self.case.field("U", 0.5), values)
        plain = os.path.join(self.path, "0.5", "U")
        with open(plain, "rb") as f:
            text = f.read()
        os.remove(plain)
        self.write("0.5/U.gz", gzip.compress(text))
        np.testing.assert_array_equal(self.case.field("U", "0.5"), values)

    def binary(self, values, scalar):
        head = (f'FoamFile\n{{\n version 2.0;\n format binary;\n arch "LSB;label=32;scalar={scalar}";\n'
                " class volScalarField;\n object T;\n}\n"
                f"dimensions [0 2 -2 0 0 0 0];\ninternalField nonuniform List<scalar>\n{len(values)}\n(")
        return head.encode() + values.astype(f"<f{scalar // 8}").tobytes() + b")\n;\nboundaryField\n{\n}\n"

    def test_binary(self):
        values = np.random.default_rng(2).normal(size=self.cells)
        self.write("1/T", self.binary(values, 64))
        np.testing.assert_array_equal(self.case.field("T", 1), values)
        self.write("1/T", self.binary(values, 32))
        np.testing.assert_array_equal(self.case.field("T", 1), values.astype("f4"))

    def test_uniform_and_times(self):
        self.write("10/U", boxes.header("volVectorField", "U") + "internalField uniform (1 2 3);\n")
        self.write("2e-05/T", boxes.header("volScalarField", "T") + "internalField uniform 4.5; // nothing else\n")
        self.assertEqual(self.case.times, ["2e-05", "10"])
        self.assertEqual(self.case.field("U").tolist(), [[1, 2, 3]] * self.cells)
        self.assertEqual(set(self.case.field("T", 0.0)), {4.5})

    def test_refusals(self):
        boxes.write_field(self.path, "T", np.ones(self.cells - 1), time="1")
        with self.assertRaisesRegex(haff.FormatError, "cells"):
            self.case.field("T", 1)
        self.write("1/T", self.binary(np.ones(self.cells), 64)[:-60])
        with self.assertRaisesRegex(haff.FormatError, "does not end"):
            self.case.field("T", 1)
        self.write("1/T", boxes.header("volScalarField", "T") + 'internalField uniform 1;\nexpression "x";\n')
        with self.assertRaisesRegex(haff.FormatError, "expression"):
            self.case.field("T", 1)
        with self.assertRaises(FileNotFoundError):
            haff.Case(os.path.join(self.path, "constant"))

    def test_tables(self):
        self.write("postProcessing/p/0/alpha", "# Probe 0 (1 2 3)\n#  Time\n0.1 5\n0.2 6\n")
        self.write("postProcessing/p/0.2/alpha", "# Probe 0 (1 2 3)\n0.3 7\n")
        self.assertEqual(self.case.table("p", "alpha").tolist(), [[0.1, 5], [0.2, 6], [0.3, 7]])

    @unittest.skipUnless(shutil.which("checkMesh"), "OpenFOAM is not installed")
    def test_openfoam_accepts_the_mesh(self):
        """boxes.py is what other tests stand on."""
        boxes.write_mesh(self.path, (6, 4, 1), (1, 1, 1), {"x": "cyclic", "yLow": "wall"})
        self.write("system/controlDict", boxes.header("dictionary", "controlDict") + "application a; startFrom startTime;"
                   " startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;\n")
        self.write("system/fvSchemes", boxes.header("dictionary", "fvSchemes")
                   + "divSchemes {} gradSchemes {} laplacianSchemes {}\n")
        self.write("system/fvSolution", boxes.header("dictionary", "fvSolution"))
        done = harness.subprocess.run(["checkMesh", "-case", self.path], capture_output=True, text=True,
                                      env={**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam"})
        self.assertIn("Mesh OK.", done.stdout, done.stdout[-1500:] + done.stderr)


if __name__ == "__main__":
    unittest.main()
