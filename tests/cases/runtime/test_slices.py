# SPDX-License-Identifier: GPL-3.0-or-later
"""No rank holds the whole of the fields: each reads and writes its slice, with the bytes, the errors and the checks of one rank,
and the memory of a rank falls with their number."""
import gzip
import os
import re
import shutil
import subprocess
import unittest

from tests.cases import harness, runs
from tests.cases.runtime import test_blockMesh as meshes

FORMATS = {"binary": "writeFormat binary;", "ascii": "writeFormat ascii; writePrecision 17;",
           "binaryZipped": "writeFormat binary; writeCompression on;", "asciiZipped": "writeFormat ascii; writeCompression on;"}


class Bytes(harness.Folder, unittest.TestCase):
    """Every byte of every file is the same on any number of ranks, of a start and of a restart: walls, an inlet with values that
    follow an expression, cyclic sides along which the run is uniform, three dimensions, more ranks than tiles."""

    def compare(self, case, ranks, ends=(0.01, 0.02)):
        copies = {r: shutil.copytree(case, f"{case}_{r}/{os.path.basename(case)}") for r in ranks}
        for r, copy in {1: case, **copies}.items():
            for end in ends:
                harness.edit(copy, "system/controlDict", endTime=end, writeInterval=0.01)
                harness.program("granularGas", "-case", copy, ranks=r)
        reference = runs.results(case)
        self.assertIn("0.02/rhoE" + (".gz" if "0.02/rhoE.gz" in reference else ""), reference)
        for r, copy in copies.items():
            with self.subTest(case, ranks=r):
                runs.same(self, reference, runs.results(copy))

    def test_a_step_in_all_formats(self):
        for name, entries in FORMATS.items():
            case = meshes.channel(os.path.join(self.folder, name))
            runs.add(case, "system/controlDict", entries)
            self.compare(case, (8,) if name == "binary" else (3,))

    def test_a_room(self):
        self.compare(meshes.room(os.path.join(self.folder, "room"), (20, 16, 12)), (3,))

    def test_uniform_across_slices(self):
        """Slices end within planes of cells, so that a difference along the uniform axis must be looked for across them."""
        for name, wave in (("uniform", ""), ("varied", " + 1e-9*(y > 0.7)*(y < 0.78)")):
            case = meshes.room(os.path.join(self.folder, name), (12, 13, 11))
            self.replace(case, "0.orig/rho", lambda text: re.sub(r'expression "[^"]*"', f'expression "100 + 9*x*z{wave}"', text))
            self.replace(case, "0.orig/p", lambda text: re.sub(r'expression "[^"]*"', 'expression "100 + x"', text))
            self.replace(case, "0.orig/U", lambda text: re.sub(r"expression \([^)]*\);", "internalField uniform (0 0 0);", text))
            self.compare(case, (5,), (0.02,))

    @staticmethod
    def replace(case, file, change):
        path = os.path.join(case, file)
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(change(text))


class Faults(harness.Folder, unittest.TestCase):
    """What is wrong in a slice is said as one rank says it: file, line, cell, cure. Each fault is made in text and in binary, of which one is
    zipped; each format has two of them."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = {}
        for name, entries in FORMATS.items():
            case = cls.made[name] = meshes.channel(os.path.join(cls.folder, name))
            runs.add(case, "system/controlDict", entries)
            harness.edit(case, "system/controlDict", endTime=0.01, writeInterval=0.01)
            harness.program("granularGas", "-case", case)

    def setUp(self):
        self.cases = {name: shutil.copytree(case, f"{case}_{self.id().rsplit('.', 1)[1]}") for name, case in self.made.items()}

    def said(self, case, *patterns):
        """What three ranks say, which must be what one rank says."""
        texts = []
        for ranks in (1, 3):
            done = harness.program("granularGas", "-case", case, ranks=ranks, check=False)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            texts.append([line for line in done.stderr.splitlines() if "granularGas" in line or case in line])
        self.assertEqual(*texts)
        self.assertTrue(texts[0], done.stderr)
        for pattern in patterns:
            self.assertRegex("\n".join(texts[0]), pattern)

    @staticmethod
    def change(path, change):
        """Changes the bytes of a file, zipped or not, and takes the checksums of its folder away."""
        zipped = not os.path.exists(path)
        with (gzip.open(path + ".gz") if zipped else open(path, "rb")) as f:
            data = f.read()
        changed = change(data)
        assert changed != data
        with (gzip.open(path + ".gz", "wb") if zipped else open(path, "wb")) as f:
            f.write(changed)
        sums = os.path.join(os.path.dirname(path), "uniform", "checksums")
        if os.path.exists(sums):
            os.remove(sums)

    def test_a_value_out_of_range(self):
        def ascii_value(data):
            lines = data.split(b"\n")
            self.line = lines.index(b"(") + 1 + 450  # from 0; cell 450 of 576: in the last slice of three
            lines[self.line] = b"-3"
            return b"\n".join(lines)

        def binary_value(data):
            at = data.index(b"(", data.index(b"List<scalar>")) + 1 + 8 * 450
            self.line = data[:data.index(b"internalField")].count(b"\n")
            return data[:at] + b"\0\0\0\0\0\0\x08\xc0" + data[at + 8:]
        for name in ("ascii", "binaryZipped"):
            with self.subTest(name):
                path = os.path.join(self.cases[name], "0.01", "T")
                self.change(path, ascii_value if "ascii" in name else binary_value)
                self.said(self.cases[name], rf"0\.01/T(\.gz)?:{self.line + 1}: cell 450 at \(.*\): T is -3; it must be greater than 0")

    def test_a_number_that_is_none(self):
        for name, old, new, pattern in (("asciiZipped", b"\n", b"\nx", r"U\.gz:518: word 'x"),
                                        ("binary", b"", b"\0\0\0\0\0\0\xf0\x7f", r"U:\d+: entry 500 of the binary list is inf")):
            with self.subTest(name):
                def wrong(data, name=name, old=old, new=new):
                    at = data.index(b"(", data.index(b"List<vector>"))
                    if "ascii" in name:
                        for _ in range(500):
                            at = data.index(old, at + 1)
                        return data[:at] + new + data[at + 1:]
                    at += 1 + 24 * 500
                    return data[:at] + new + data[at + 8:]
                self.change(os.path.join(self.cases[name], "0.01", "U"), wrong)
                self.said(self.cases[name], pattern)

    def test_a_list_that_is_cut_or_too_short(self):
        for what, change, names in (("cut", lambda data: data[:len(data) * 2 // 3], ("binary", "asciiZipped")),
                                    ("short", lambda data: data.replace(b"\n576\n(", b"\n575\n("), ("ascii", "binaryZipped"))):
            for name in names:
                with self.subTest(name, what=what):
                    self.change(os.path.join(self.cases[name], "0.01", "rhoU"), change)
                    self.said(self.cases[name], "rhoU")

    def test_a_damaged_slice(self):
        """A byte that changed on the disk is found by the checksum, whose slice it may be in."""
        for name in ("binary", "asciiZipped"):
            case = self.cases[name]
            path = os.path.join(case, "0.01", "rhoE" + (".gz" if "Zipped" in name else ""))
            with open(path, "rb+") as f:
                f.seek(os.path.getsize(path) * 3 // 4)
                byte = f.read(1)
                f.seek(-1, os.SEEK_CUR)
                f.write(bytes([byte[0] ^ 1]))
            self.said(case, "rhoE", "0.01")

    def test_a_disk_that_is_full_for_one_rank(self):
        """Files may have 11 kB: what fails is the slice of the second rank, in the first field of vectors."""
        case = self.cases["binary"]
        harness.edit(case, "system/controlDict", endTime=0.02)
        before = runs.contents(os.path.join(case, "0.01"))
        limited = 'ulimit -f 11; exec "$0" "$@"'
        done = subprocess.run([os.path.join(harness.BIN, "mpirun"), "-np", "2", "bash", "-c", limited,
                               os.path.join(harness.BIN, "granularGas"), "-case", case], capture_output=True, text=True,
                              env={**os.environ, "OMPI_MCA_btl": "self,tcp"})  # messages by shared memory need files
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertRegex(done.stderr, r"writing time 0\.02; earlier times are intact\s+\S*0\.02\.tmp/U: cannot write: File too large")
        self.assertEqual(before, runs.contents(os.path.join(case, "0.01")))
        self.assertEqual([], [name for name in os.listdir(case) if "0.02" in name])
        harness.program("granularGas", "-case", case, ranks=2)


class Memory(harness.Folder, unittest.TestCase):
    def bytes_a_cell(self, ranks, form):
        """What a cell adds to the rank that takes most, over a start and a restart; 2D, without what a rank takes in any case."""
        most = {}
        for n, starts in ((120, 1), (300, 2)):
            case = meshes.Memory.square(os.path.join(self.folder, f"{form}{ranks}_{n}"), n)
            runs.add(case, "system/controlDict", f"writeFormat {form}; stopAt nextWrite; writeControl timeStep; writeInterval 2;\n")
            most[n] = max(harness.peak("granularGas", "-case", case, ranks=ranks) for _ in range(starts))
        return (most[300] - most[120]) / (300**2 - 120**2)

    def test_it_falls_with_the_number_of_ranks(self):
        alone = self.bytes_a_cell(1, "binary")
        for form in ("binary", "ascii"):
            self.assertLess(self.bytes_a_cell(3, form), 1.15 * alone / 3, form)


if __name__ == "__main__":
    unittest.main()
