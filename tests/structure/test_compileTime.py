# SPDX-License-Identifier: GPL-3.0-or-later
"""No source costs the compiler much more than others do. Counted is the machine code that the build made of each source: time
and memory of the compiler grow with the instances of a kernel, and so does the code."""
import glob
import os
import subprocess
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
BUILD = os.path.join(os.environ.get("HAFF_BIN", os.path.join(SOURCE, "build", "bin")), "..", "CMakeFiles")
# reconstruct.c with instances for each number of dimensions took 173 s and gigabytes; its code was two fifths of the library's
# (843 kB of 2.1 MB, without clones). Today polynomial.c has most, a twelfth; with clones, some seventh.
MOST_SHARE = 1 / 5


def code():
    """Bytes of machine code of each object of the library of physics."""
    objects = sorted(glob.glob(os.path.join(BUILD, "haffcore.dir", "libcore", "**", "*.o"), recursive=True))
    rows = subprocess.run(["size", *objects], check=True, capture_output=True, text=True).stdout.splitlines()[1:]
    return {path: int(row.split()[0]) for path, row in zip(objects, rows)}


class CompileTime(unittest.TestCase):
    def test_no_source_is_much_of_the_code(self):
        sizes = code()
        self.assertGreater(len(sizes), 50)
        for path, size in sizes.items():
            with self.subTest(path):
                self.assertLess(size, MOST_SHARE * sum(sizes.values()), "fewer instances?")


if __name__ == "__main__":
    unittest.main()
