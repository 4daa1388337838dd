# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from system/blockMeshDict in Python: the arrays are those of the polyMesh that OpenFOAM's blockMesh makes of the same file."""
import os
import shutil
import unittest

import numpy as np

from haff.case import blocks
from haff.case.foam import FormatError
from tests.cases import harness
from tests.cases.harness import boxes, haff
from tests.cases.runtime import test_blockMesh as dictionaries


def case_of(path, text):
    boxes.write_dictionary(path, "system", "blockMeshDict", text)
    boxes.write_dictionary(path, "system", "controlDict", boxes.CONTROL.format(**{**boxes.STANDARD, "end": 1, "interval": 1}))
    return path


class Blocks(harness.Folder, unittest.TestCase):
    def test_arrays_are_those_of_blockMesh(self):
        if not shutil.which("blockMesh"):
            self.skipTest("blockMesh is not installed: apt-get install openfoam")
        for name, text in (("step", dictionaries.STEP), ("box", dictionaries.BOX % (5, 3, 4))):
            with self.subTest(name):
                case = case_of(os.path.join(self.folder, name), text)
                mine = haff.Case(case).mesh
                self.assertIsInstance(mine, blocks.BlockMesh)
                dictionaries.block_mesh(case)
                mesh = haff.Case(case).mesh
                self.assertNotIsInstance(mesh, blocks.BlockMesh)
                self.assertEqual(list(mine.patches.items()), list(mesh.patches.items()))
                self.assertEqual(mine.cells, mesh.cells)
                self.assertLess(np.abs(mine.points - mesh.points).max(), 1e-3)  # those of the file are rounded to 1/1024
                for array in ("owner", "neighbour", "face_start", "face_points"):
                    self.assertTrue(np.array_equal(getattr(mine, array), getattr(mesh, array)), array)
                one, other = mine.lattice, mesh.lattice
                self.assertTrue(np.array_equal(one.index, other.index))
                for a, b in zip(one.edges, other.edges):
                    self.assertLess(np.abs(a - b).max(), 1e-3)
                mine.release()
                self.assertTrue(np.array_equal(mine.owner, mesh.owner))

    def test_macros_and_arithmetic(self):
        self.assertEqual(blocks.arithmetic("2*(3 + 4)^2 - sqrt(16)/pow(2, 2)"), 97)
        self.assertRaises(FormatError, blocks.arithmetic, "__import__('os')")
        known = {"n": "8"}
        self.assertEqual(blocks.expanded("($n #eval{ $n/4 } ${n}) // $x", known).split(), ["(8", "2.0", "8)"])
        self.assertRaises(FormatError, blocks.expanded, "$m", known)

    def test_what_is_no_union_of_boxes_is_refused(self):
        for old, new in (("simpleGrading (1 1 1)", "simpleGrading (1 2 1)"), ("($half $ny 1) edge", "($half 8 1) edge"),
                         ("(6 4 0)", "(6 4.1 0)"), ("(2 5 13 10)); }", "(1 4 12 9)); }"), ("boundary", "#include")):
            with self.subTest(new):
                case = case_of(os.path.join(self.folder, "wrong"), dictionaries.STEP.replace(old, new, 1))
                with self.assertRaisesRegex(FormatError, "system/blockMeshDict: "):
                    _ = haff.Case(case).mesh


if __name__ == "__main__":
    unittest.main()
