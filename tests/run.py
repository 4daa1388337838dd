# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs one module of unittest for CTest, and tells it of a module all of whose tests were skipped.

    /usr/bin/python3 -m tests.run tests/cases/gas/test_wall.py [CLASS[.TEST] ..]

Exit code 0: tests ran and passed; 1: one failed, or there are none; 77: every one was skipped, which CTest shows as skipped.
"""
import os
import sys
import unittest

SKIPPED = 77
PACKAGE = os.path.join(os.environ.get("HAFF_SOURCE", os.getcwd()), "postprocessing")


class Result(unittest.TextTestResult):
    """Counts the tests that ran: neither a skipped test nor one of a skipped class did."""

    ran = 0

    def addSuccess(self, test):
        super().addSuccess(test)
        self.ran += 1


def main(path, names):
    os.environ["PYTHONPATH"] = PACKAGE  # of the programs that tests start
    sys.path.insert(0, PACKAGE)
    module = os.path.splitext(os.path.relpath(path))[0].replace(os.sep, ".")
    tests = unittest.defaultTestLoader.loadTestsFromNames([f"{module}.{name}" for name in names] or [module])
    result = unittest.TextTestRunner(verbosity=2, resultclass=Result).run(tests)
    if not result.wasSuccessful():
        return 1
    if result.skipped and not result.ran:
        print("Every test of this module was skipped.", file=sys.stderr)
        return SKIPPED
    if not result.ran:
        print(f"{path} holds no tests", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
