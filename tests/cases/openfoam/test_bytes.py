# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written have OpenFOAM's bytes, but for the banner, as readers in other languages are written against them: they go by
lines, not by the grammar."""
import os
import re
import shutil
import struct
import subprocess
import unittest

import numpy as np

from tests.cases import harness
from tests.solvers.programs import bad_case

FOAM = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
MESH = ("points", "faces", "owner", "neighbour", "boundary")
FORMATS = ("ascii", "binary")


class Lines:
    """A file as such readers see it: the format from the header, counts from lines of their own, lists right behind them."""

    def __init__(self, path):
        with open(path, "rb") as f:
            self.data = f.read()
        self.lines = self.data.split(b"\n")
        start = self.lines.index(b"FoamFile")
        self.header = dict(line.split(None, 1) for line in self.lines[start + 2:self.lines.index(b"}", start)])
        self.binary = self.header[b"format"] == b"binary;"
        self.start = next(n for n, line in enumerate(self.lines) if line.startswith(b"// * *"))

    def numbers(self, line, columns, kind="d"):
        """The list behind a line that is a count."""
        n = int(self.lines[line])
        if self.binary:
            rest = b"\n".join(self.lines[line + 1:])
            assert rest[:1] == b"(", rest[:20]
            size = n * columns * struct.calcsize(kind)
            assert rest[1 + size:2 + size] == b")"
            return np.array(struct.unpack(f"<{n * columns}{kind}", rest[1:1 + size])).reshape(n, -1), rest[2 + size:]
        assert self.lines[line + 1] == b"(" and self.lines[line + 2 + n] == b")"
        rows = self.lines[line + 2:line + 2 + n]
        assert columns == 1 or all(row[:1] == b"(" and row[-1:] == b")" for row in rows)
        rows = [row[1:-1] if columns > 1 else row for row in rows]
        return np.array([[float(v) for v in row.split(b" ")] for row in rows]), b"\n".join(self.lines[line + 3 + n:])

    def field(self):
        at = next(n for n, line in enumerate(self.lines) if line.startswith(b"internalField"))
        kind = re.fullmatch(rb"internalField   nonuniform List<(\w+)> ", self.lines[at])[1]  # with the blank
        values, rest = self.numbers(at + 1, {b"scalar": 1, b"vector": 3}[kind])
        assert rest.startswith(b";\n\nboundaryField\n{\n"), rest[:40]
        return values

    def count(self):
        """The line of the first number alone behind the header, as all of them look for it."""
        assert self.start >= 7  # some skip ten lines before they look
        return next(n for n in range(self.start + 1, self.start + 5) if self.lines[n].isdigit())


class Bytes(harness.Folder, unittest.TestCase):
    def meshed(self, kind):
        """A mesh of several kinds of cells, in a case with which OpenFOAM's programs start."""
        case = os.path.join(self.folder, "mesh" + kind)
        bad_case.write(case)
        shutil.rmtree(case + "/0")
        with open(case + "/system/fvSchemes", "a") as f:
            f.write("laplacianSchemes { }\n")
        harness.edit(case, "system/controlDict", writeFormat=kind)
        source = os.path.join(harness.SOURCE, "tests", "mesh", "format", "mixed.geo")
        subprocess.run(["gmsh", "-3", "-v", "2", source, "-o", case + "/mesh.msh"], check=True, capture_output=True)
        harness.program("gmshToCase", case + "/mesh.msh", "-case", case, "-" + kind)
        return case

    def run_small(self, kind):
        case = os.path.join(self.folder, "run" + kind)
        bad_case.write(case)
        with open(case + "/system/fvSchemes", "a") as f:
            f.write("laplacianSchemes { }\n")
        harness.edit(case, "system/controlDict", writeFormat=kind)
        harness.program("granularGas", "-case", case)
        return case

    def test_fields_by_lines(self):
        for kind in FORMATS:
            with self.subTest(kind):
                case = harness.haff.Case(self.run_small(kind))
                for name in ("alpha", "T", "U"):
                    values = case.field(name, "0.002")
                    self.assertTrue((Lines(os.path.join(case.path, "0.002", name)).field() == values.reshape(len(values), -1)).all())

    def test_meshes_by_lines(self):
        for kind in FORMATS:
            with self.subTest(kind):
                case = harness.haff.Case(self.meshed(kind))
                file = {name: Lines(os.path.join(case.path, "constant", "polyMesh", name)) for name in MESH}
                self.assertEqual([f.binary for f in file.values()], [kind == "binary"] * 4 + [False])
                self.assertTrue((file["points"].numbers(file["points"].count(), 3)[0] == case.mesh.points).all())
                for name in ("owner", "neighbour"):
                    self.assertTrue((file[name].numbers(file[name].count(), 1, "i")[0][:, 0] == getattr(case.mesh, name)).all())
                    self.assertRegex(file[name].header[b"note"], rb'"nPoints:\d+  nCells:\d+  nFaces:\d+  nInternalFaces:\d+";')
                if kind == "binary":
                    start, rest = file["faces"].numbers(file["faces"].count(), 1, "i")
                    self.assertTrue((start[:, 0] == case.mesh.face_start).all())
                    self.assertTrue(rest.startswith(b"\n%d\n(" % case.mesh.face_start[-1]))
                self.assertEqual(int(file["boundary"].lines[file["boundary"].count()]), len(case.mesh.patches))

    @unittest.skipUnless(shutil.which("foamFormatConvert"), "OpenFOAM is not there")
    def test_meshes_as_openfoam(self):
        """OpenFOAM reads a mesh and writes it again: the same bytes behind the banner."""
        for kind in FORMATS:
            with self.subTest(kind):
                case = self.meshed(kind)
                folder = os.path.join(case, "constant", "polyMesh")
                ours = {name: Lines(os.path.join(folder, name)).data for name in MESH}
                subprocess.run(["foamFormatConvert", "-case", case, "-constant"], check=True, capture_output=True, env=FOAM)
                for name in MESH[:4]:  # `boundary` is written as a dictionary by this program
                    theirs = Lines(os.path.join(folder, name)).data
                    self.assertNotEqual(theirs, ours[name])  # it did write
                    self.assertEqual(*(data[data.index(b"FoamFile\n"):].rstrip() for data in (theirs, ours[name])), name)

    @unittest.skipUnless(shutil.which("foamFormatConvert"), "OpenFOAM is not there")
    def test_fields_as_openfoam(self):
        part = re.compile(rb"internalField .*boundaryField\n\{\n", re.S)
        for kind in FORMATS:
            with self.subTest(kind):
                case = shutil.copytree(self.run_small(kind), os.path.join(self.folder, "foam" + kind))
                ours = {name: Lines(os.path.join(case, "0.002", name)).data for name in ("alpha", "rhoU")}
                subprocess.run(["foamFormatConvert", "-case", case, "-time", "0.002"], check=True, capture_output=True, env=FOAM)
                for name, data in ours.items():
                    theirs = Lines(os.path.join(case, "0.002", name)).data
                    self.assertNotEqual(theirs, data)
                    self.assertEqual(part.search(theirs)[0], part.search(data)[0], name)


if __name__ == "__main__":
    unittest.main()
