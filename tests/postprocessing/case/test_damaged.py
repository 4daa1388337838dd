# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files: whatever a reader finds, it gives values, or one error that is meant for the user and names the file."""
import gzip
import os
import random
import shutil
import tracemalloc
import unittest
import warnings

from tests.cases import harness
from tests.cases.harness import haff
from tests.postprocessing.report import made

from haff import command
from haff.case import entries, foam, grains

TRIES = 40  # of each file
PIECES = (b"(", b")", b"{", b"}", b";", b'"', b"[", b"/*", b"//", b"\n", b"\0", b"\xff", b"nan", b"-1", b"1e999", b"99999999999999999999", b"2147483647{0}",
          b"nonuniform", b"uniform", b"List<vector>", b"binary", b"$x", b"#")


def damaged(data, rng):
    """The data with a few bytes cut, repeated, changed, or pieces of the format put in."""
    for _ in range(rng.randint(1, 3)):
        a = rng.randrange(len(data) + 1)
        b = min(len(data), a + rng.choice((0, 1, 4, 40)))
        kind = rng.randrange(5)
        data = (data[:a] + data[b:] if kind == 0 else data[:a] if kind == 1 else data[:b] + data[a:] if kind == 2
                else data[:a] + bytes(rng.randrange(256) for _ in range(b - a)) + data[b:] if kind == 3 else data[:a] + rng.choice(PIECES) + data[b:])
    return data


class Damaged(harness.Folder, unittest.TestCase):
    def tried(self, file, read, packed=False):
        """Reads `file` of a case after each of some changes."""
        path = os.path.join(self.case, file)
        with open(path, "rb") as f:
            whole = f.read()
        rng, refused = random.Random(file), 0
        path += ".gz" if packed else ""
        if packed:
            os.remove(path.removesuffix(".gz"))
        for k in range(TRIES):
            data = damaged(gzip.compress(whole) if packed and k % 2 else whole, rng)
            with open(path, "wb") as f:
                f.write(gzip.compress(data, 1) if packed and not k % 2 else data)
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    read(haff.Case(self.case))
            except Exception as error:  # whatever it is
                refused += 1
                with self.subTest(file, change=k, error=repr(error), tail=data[-200:]):
                    self.assertTrue(command.is_meant(error))
                    self.assertIn(self.case, str(error))
        self.assertGreater(refused, 0)
        if packed:
            os.remove(path)
        with open(path.removesuffix(".gz"), "wb") as f:
            f.write(whole)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.case = made.grains(os.path.join(cls.folder, "case"))
        for name in ("T", "U"):
            made.cases.boxes.write_field(cls.case, name, haff.Case(cls.case).field(name, "1"), time="3", binary=name == "U")

    def test_fields(self):
        for name in ("T", "U"):
            for packed in (False, True):
                self.tried(f"3/{name}", lambda case: (case.field(name, "3"), case.patch_values(name, "xLow", "3"), case.unit(name, "3")), packed)

    def test_mesh(self):
        for name in ("boundary", "owner", "neighbour", "faces", "points"):
            self.tried(f"constant/polyMesh/{name}", lambda case: (case.centres, case.patch_values("T", "xLow", "1")))

    def test_grains(self):
        for name in ("positions", "U"):
            self.tried(f"1/lagrangian/grains/{name}", lambda case: grains.read(case, "1"))

    def test_dictionaries(self):
        made.write(os.path.join(self.case, "constant", "some"), "a { b 1; c (1 2 {3}); }\n\"d|e\" 4; // five\nf [0 1]; $g; /* h */ i {}\n")
        path = os.path.join(self.case, "constant", "some")
        self.tried("constant/some", lambda case: (entries.get(path, "a/b"), entries.edit(path, {"a/b": 2, "+i/j": 3})))
        made.write(os.path.join(self.case, "system", "units"), "length cm; mass g;\ntime s;\n")
        self.tried("system/units", lambda case: case.units)

    def test_tables(self):
        for frame in (False, True):
            self.tried("postProcessing/drag/0/force.dat", lambda case: case.table("drag", frame=frame))

    def test_memory(self):
        """What a short file stands for takes no memory before it is refused; a pipe is not waited for."""
        path = os.path.join(self.case, "2", "T")
        with open(path, "rb") as f:
            whole = f.read()
        bomb, most = b"\n".join((whole, b" " * (1 << 26))), foam.UNZIPPED
        head = made.cases.boxes.header("volScalarField", "T", "2").encode()
        texts = {"values on a mesh": head + b"dimensions [0 2 -2 0 0 0 0];\ninternalField nonuniform List<scalar> 2147483647{0};\n",
                 "times its size": gzip.compress(bomb, 1)}
        shutil.move(path, path + ".kept")
        foam.UNZIPPED = foam.PIECE
        tracemalloc.start()
        try:
            for why, text in texts.items():
                name = path + (".gz" if text[:2] == b"\x1f\x8b" else "")
                with open(name, "wb") as f:
                    f.write(text)
                tracemalloc.reset_peak()
                with self.assertRaisesRegex(foam.FormatError, why):
                    haff.Case(self.case).field("T", "2")
                self.assertLess(tracemalloc.get_traced_memory()[1], len(bomb) + (1 << 27))
                os.remove(name)
            os.mkfifo(path)
            with self.assertRaisesRegex(foam.FormatError, "pipe"):
                foam.FoamFile(path)
            os.remove(path)
        finally:
            tracemalloc.stop()
            foam.UNZIPPED = most
            shutil.move(path + ".kept", path)


if __name__ == "__main__":
    unittest.main()
