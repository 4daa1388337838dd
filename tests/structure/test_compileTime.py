# SPDX-License-Identifier: GPL-3.0-or-later
"""No source takes the compiler much longer, or much more memory, than others do: CPU time of the sources that make kernels
by macros, or that are one of many instances, over that of ordinary sources in the same run."""
import os
import re
import resource
import statistics
import subprocess
import tempfile
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
FLAGS = ("-std=c11 -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math -mprefer-vector-width=512 -D_POSIX_C_SOURCE=200809L -w").split()
ORDINARY = ["libcore/gas/step.c", "libcore/gas/gas.c", "solvers/output/output.c", "mesh/format/foamlist.c", "solvers/case/fields.c"]
# Kernels that a macro makes; a kernel with an instance for each number of dimensions.
MANY = re.compile(r"KERNEL static [^;{]*##|#define .*\\\n +KERNEL static|KERNEL static void name\(", re.MULTILINE)
SURE = {"libcore/schemes/reconstruct.c", "libcore/schemes/polynomial.c"}  # the sources that once took 170 and 30 seconds
# An ordinary source takes 0.3 s where the whole takes 75 s on one core. 12 s is 40 of these: no source may be a sixth of the build.
MOST_TIMES = 40
MOST_MEGABYTES = 300


def suspects():
    found = []
    for folder, _, names in os.walk(os.path.join(SOURCE, "libcore")):
        for name in names:
            path = os.path.join(folder, name)
            if name.endswith(".c"):
                with open(path, encoding="utf-8") as file:
                    if MANY.search(file.read()):
                        found.append(os.path.relpath(path, SOURCE))
    return sorted(found)


def compiled(path, out):
    """CPU seconds and megabytes of the compiler itself, which is a child of the driver."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(["gcc", *FLAGS, "-I", SOURCE, "-c", os.path.join(SOURCE, path), "-o", out], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, after.ru_maxrss / 1024


class CompileTime(unittest.TestCase):
    def test_the_rule_finds_what_is_made_by_macros(self):
        self.assertLessEqual(SURE, set(suspects()))

    def test_no_source_takes_the_compiler_long(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "x.o")
            usual = statistics.median(compiled(path, out)[0] for path in ORDINARY)
            for path in suspects():
                seconds, megabytes = compiled(path, out)
                with self.subTest(path):
                    self.assertLess(seconds / usual, MOST_TIMES, f"{path}: {seconds:.1f} s where others take {usual:.2f} s: fewer instances?")
                    self.assertLess(megabytes, MOST_MEGABYTES, f"{path}: {megabytes:.0f} MB")


if __name__ == "__main__":
    unittest.main()
