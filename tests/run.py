# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs one module of unittest for CTest, and tells it of a module all of whose tests were skipped.

    /usr/bin/python3 -m tests.run tests/cases/gas/test_wall.py [CLASS[.TEST] ..]

Exit code 0: tests ran and passed; 1: one failed, or there are none; 77: every one was skipped, which CTest shows as skipped.
"""
import os
import resource
import sys
import unittest

SKIPPED = 77
PACKAGE = os.path.join(os.environ.get("HAFF_SOURCE", os.getcwd()), "postprocessing")


def work():
    """Seconds of processor time until now, with those of programs that have ended."""
    return sum(usage.ru_utime + usage.ru_stime for usage in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))


class Result(unittest.TextTestResult):
    """Counts the tests that ran: neither a skipped test nor one of a skipped class did. Keeps what each cost, with the set-up of
    its class if it is the first one."""

    ran = 0

    def startTestRun(self):
        self.costs, self.before = [], work()

    def stopTest(self, test):
        super().stopTest(test)
        now = work()
        self.costs.append((now - self.before, test.id()))
        self.before = now

    def addSuccess(self, test):
        super().addSuccess(test)
        self.ran += 1


def main(path, names):
    os.environ["PYTHONPATH"] = PACKAGE  # of the programs that tests start
    sys.path.insert(0, PACKAGE)
    module = os.path.splitext(os.path.relpath(path))[0].replace(os.sep, ".")
    tests = unittest.defaultTestLoader.loadTestsFromNames([f"{module}.{name}" for name in names] or [module])
    result = unittest.TextTestRunner(verbosity=2, resultclass=Result).run(tests)
    for seconds, name in sorted(result.costs, reverse=True)[:5]:
        print(f"{seconds:8.2f} s of processor time: {name}", file=sys.stderr)
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
