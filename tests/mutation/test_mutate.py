# SPDX-License-Identifier: GPL-3.0-or-later
"""tests/mutation/mutate.py on toy sources: where it may change what, and what becomes of mutants of a toy with a build and tests."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import mutate  # noqa: E402

QUIET_C = """/* 1 < 2 and a + b */
#define HALF (1 + 1)
#include "toys/ramp/ramp.h"
static const struct row rows[] = {{"ramp", 17, "the height + 1 of it"}};
static const char *name = "1+1"; // i < 3
void check(int a) { static_assert(sizeof(int) < 8); fail("a is %d", a + 1); }
"""
QUIET_PYTHON = '''"""1 < 2 and a + b"""
import sys

def check(a, made):
    assert a < 1 + 2
    made.add_argument("-a", default=3 + 4)
    if not a: raise ValueError(f"{a + 1}")  # a < 1
'''
LOUD_C = """
double most(double a, const double *b, int n)
{
    double sum = 0, c;
    c = 0.5;
    for (int i = 0; i < n; i++) {
        if (a < b[i] && fabs(a) > 2) sum += fmax(a, b[i]);
    }
    return sum * c;
}
"""
LOUD_PYTHON = """
def most(a, b, n):
    total = 0
    for i in range(n):
        if a < b[i] and abs(a) > 2.5:
            total += max(a, i)
    return total
"""
RAMP = """/* Sums: each line has one mutant at most, but for the loop. */
#include "toys/ramp/ramp.h"
int ramp(int n)
{
    int sum = 0;
    for (int i = 0; i < n; i++) sum += i;
    return sum;
}
int unseen(int n)
{
    return n - 7;
}
int either(int n, int m)
{
    int spare = n > m;
    return spare ? n : n;
}
int same(int n, int nought)
{
    return n + nought;
}
"""
SUITE = "tests"  # apart: a test of the rooms looks for each file that is named
TOY = {
    "toys/ramp/ramp.c": RAMP, "toys/ramp/ramp.h": "int ramp(int);\nint unseen(int);\nint either(int, int);\nint same(int, int);\n",
    SUITE + "/toys/ramp/test_ramp.c": '#include "toys/ramp/ramp.h"\nint main(void) { return ramp(4) != 6 || either(3, 2) != 3 || same(2, 0) != 2; }\n',
    "postprocessing/haff/toy/total.py": "def total(n):\n    return n + 1\n",
    SUITE + "/postprocessing/toy/test_total.py": """import unittest
from haff.toy.total import total


class Total(unittest.TestCase):
    def test_one(self):
        self.assertEqual(total(2), 3)
""",
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.25)
project(toy C)
set(CMAKE_BUILD_TYPE Release)
set(SUITE tests)
include_directories(${CMAKE_SOURCE_DIR})
add_library(toy toys/ramp/ramp.c)
add_executable(core_test_ramp ${SUITE}/toys/ramp/test_ramp.c)
target_link_libraries(core_test_ramp toy)
enable_testing()
add_test(NAME toys/ramp/test_ramp COMMAND core_test_ramp)
add_test(NAME postprocessing/toy/test_total COMMAND /usr/bin/python3 -m tests.run
         ${CMAKE_SOURCE_DIR}/${SUITE}/postprocessing/toy/test_total.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
""",
    ".gitignore": "build/\n",
    "tests/mutation/equivalent.txt": "toys/ramp/ramp.c\treturn n + nought;\treturn n - nought;\tnought is 0\n",
}


def drawn(path, text, seed=1):
    return list(mutate.draw({path: text}, seed))


class Draws(unittest.TestCase):
    """What is drawn from a source."""

    def test_comments_texts_messages_and_assertions_stay(self):
        self.assertEqual([], drawn("a.c", QUIET_C))
        self.assertEqual([], drawn("a.py", QUIET_PYTHON))

    def test_every_operator_in_both_languages(self):
        for path, text in (("a.c", LOUD_C), ("a.py", LOUD_PYTHON)):
            wanted = {"relation", "sign", "logic", "extreme", "constant", "condition", "loop", "arguments", "dropped"}
            found = {m.operator for seed in range(20) for m in drawn(path, text, seed)}
            self.assertEqual(wanted, found, path)

    def test_a_mutant_is_one_change_that_compiles(self):
        for mutant in (m for seed in range(20) for m in drawn("a.py", LOUD_PYTHON, seed)):
            changed = LOUD_PYTHON[:mutant.start] + mutant.new + LOUD_PYTHON[mutant.end:]
            compile(changed, "a.py", "exec")
            self.assertEqual(1, sum(a != b for a, b in zip(LOUD_PYTHON.split("\n"), changed.split("\n"), strict=True)), changed)

    def test_the_seed_says_all(self):
        texts = {"a.c": LOUD_C, "b.py": LOUD_PYTHON}
        orders = [list(mutate.draw(texts, seed)) for seed in (1, 1, 2)]
        self.assertEqual(orders[0], orders[1])
        self.assertNotEqual(orders[0], orders[2])
        lines = [(m.path, texts[m.path].count("\n", 0, m.start)) for m in orders[0]]
        self.assertEqual(len(set(lines)), len(lines))

    def test_nearest(self):
        """Tests that mirror the folder come first; then the name of the file; then rare words; no document is near."""
        tests = {f"{SUITE}/toys/ramp/test_all.c": '#include "toys/ramp/hill.h"', f"{SUITE}/cases/gas/test_slope.py": "",
                 f"{SUITE}/cases/gas/test_a.py": "the rampart", f"{SUITE}/cases/gas/test_b.py": "common",
                 f"{SUITE}/cases/gas/test_c.py": "common", f"{SUITE}/docs/test_slope.py": "rampart"}
        near = mutate.nearest("toys/ramp/hill_slope.c", 'f("rampart", "common", other)', tests, 3)
        self.assertEqual([f"{SUITE}/toys/ramp/test_all.c", f"{SUITE}/cases/gas/test_slope.py", f"{SUITE}/cases/gas/test_a.py",
                          f"{SUITE}/cases/gas/test_b.py"], near)


class Runs(unittest.TestCase):
    """The table of a toy whose tests are as above."""

    @classmethod
    def setUpClass(cls):
        cls._temporary = tempfile.TemporaryDirectory(prefix="haff")
        cls.top = cls._temporary.name
        for path, text in TOY.items():
            os.makedirs(os.path.dirname(os.path.join(cls.top, path)), exist_ok=True)
            with open(os.path.join(cls.top, path), "w") as file:
                file.write(text)
        shutil.copy(os.path.join(HERE, "mutate.py"), os.path.join(cls.top, "tests/mutation"))
        for command in (["init", "-q"], ["add", "."], ["-c", "user.name=toy", "-c", "user.email=toy", "commit", "-qm", "toy"]):
            subprocess.run(["git", "-C", cls.top, *command], check=True)
        cls.rows = cls.table("-count", "99", "toys", "postprocessing")

    @classmethod
    def tearDownClass(cls):
        cls._temporary.cleanup()

    @classmethod
    def table(cls, *words):
        done = subprocess.run([sys.executable, os.path.join(cls.top, "tests/mutation/mutate.py"), *words], capture_output=True, text=True,
                              timeout=300, check=True)
        return [[cell.strip() for cell in re.split(r" \| ", row.strip("| "))] for row in done.stdout.split("\n")[2:] if row]

    def results(self, place):
        return [row[3] for row in self.rows if row[1] == place]

    def test_a_wrong_sum_is_seen_by_its_test(self):
        self.assertEqual(["toys/ramp/test_ramp"], self.results("toys/ramp/ramp.c:5"))
        self.assertEqual(["postprocessing/toy/test_total: test_one"], self.results("postprocessing/haff/toy/total.py:2"))

    def test_what_no_test_sees_survives(self):
        self.assertEqual(["**survives** 1 tests"], self.results("toys/ramp/ramp.c:11"))

    def test_the_list_runs_nothing(self):
        row, = self.table("-list", "-count", "1", "postprocessing")
        self.assertEqual(["postprocessing/haff/toy/total.py:2", "postprocessing/toy/test_total"], [row[1], row[3]])

    def test_equivalent(self):
        """By the same object code, where a comparison decides nothing; and by the list."""
        self.assertEqual(["equivalent: the same object code"], self.results("toys/ramp/ramp.c:15"))
        self.assertEqual(["equivalent: nought is 0"], self.results("toys/ramp/ramp.c:20"))

    def test_the_source_tree_is_left_as_it_was(self):
        self.assertEqual("", subprocess.run(["git", "-C", self.top, "status", "--short"], capture_output=True, text=True).stdout)
        with open(os.path.join(self.top, "toys/ramp/ramp.c")) as file:
            self.assertEqual(RAMP, file.read())
