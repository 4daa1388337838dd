# SPDX-License-Identifier: GPL-3.0-or-later
"""The recipes of docs/addAModel.md: each diff applies to this tree, touches no more files than it says, and all together
compile, pass the tests that go over the tables of models, and run."""
import glob
import itertools
import os
import re
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes
from tests.install import outside

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
BOOK = os.path.join(SOURCE, "docs", "addAModel.md")

# Heading of a recipe: the source files it may touch, tests aside, and the name that -listModels or -listBCs shows.
RECIPES = {
    "An equation of state": (1, "CarnahanStarling"),
    "A flux": (1, "HLL"),
    "A reconstruction": (1, "vanLeer"),
    "A transport law": (1, "DiluteSpheres"),
    "A wall": (2, "slipLength"),
    "A source": (1, "quadraticDrag"),
    "A cooling law": (1, "viscoelastic"),
    "A function object": (2, "centreOfMass"),
    "A law that sees the flow": (1, "Bagnold"),
    "A part of a step": (2, None),  # the log of a run shows it
    "A carried quantity": (1, "tagged"),
}
# Is there a build whose objects go together with those of any other?
PLAIN = outside.INSTALLS and shutil.which("make") and {outside.cached(name) for name in ("HAFF_SANITIZE", "HAFF_FUZZ")} == {"OFF"}
TABLE_TESTS = ["models/test_eos", "models/test_transport", "models/test_source", "models/test_cooling",
               "models/test_boundary", "schemes/test_flux", "schemes/test_reconstruct"]


def recipes():
    """Heading -> diff, in the order of the book."""
    with open(BOOK, encoding="utf-8") as file:
        parts = re.split(r"^## (?:\d+\. )?(.+)$", file.read(), flags=re.MULTILINE)[1:]
    found = {}
    for heading, body in zip(parts[::2], parts[1::2]):
        diffs = re.findall(r"^```diff\n(.*?)^```", body, flags=re.MULTILINE | re.DOTALL)
        if diffs:
            found[heading.strip()] = "".join(diffs)
    return found


def run(*command, cwd, text=None):
    done = subprocess.run(command, cwd=cwd, input=text, capture_output=True, text=True)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done.stdout


class Recipes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tree = tempfile.mkdtemp(prefix="recipes")
        cls.addClassCleanup(shutil.rmtree, cls.tree)
        for name in (".ci", "mesh", "libcore", "solvers", "tests"):
            shutil.copytree(os.path.join(SOURCE, name), os.path.join(cls.tree, name),
                            ignore=shutil.ignore_patterns("seeds", "regressions", "__pycache__"))
        shutil.copy(os.path.join(SOURCE, "CMakeLists.txt"), cls.tree)
        cls.applied = {}
        for heading, diff in recipes().items():
            try:
                run("git", "apply", "-p1", "--recount", "-C1", "-", cwd=cls.tree, text=diff)
                cls.applied[heading] = None
            except AssertionError as error:
                cls.applied[heading] = str(error)

    def test_1_all_recipes_are_there(self):
        self.assertEqual(list(recipes()), list(RECIPES))

    def test_2_they_apply(self):
        for heading, error in self.applied.items():
            self.assertIsNone(error, f"{heading}: {error}")

    def test_3_they_touch_as_few_files_as_they_say(self):
        for heading, diff in recipes().items():
            touched = set(re.findall(r"^\+\+\+ b/(\S+)", diff, flags=re.MULTILINE))
            touched = [path for path in touched if not path.startswith("tests/")]
            self.assertLessEqual(len(touched), RECIPES[heading][0], f"{heading}: {touched}")

    def test_new_files_name_their_licence(self):
        for heading, diff in recipes().items():
            for first in re.findall(r"^--- /dev/null\n\+\+\+ .*\n@@ .*\n(.*)$", diff, flags=re.MULTILINE):
                self.assertEqual(first, "+/* SPDX-License-Identifier: GPL-3.0-or-later */", heading)

    def test_4_they_compile_and_their_tables_pass(self):
        build = os.path.join(self.tree, "build")
        if PLAIN:
            outside.keep_configuration(build, self.tree)
        tests = ["libcore_" + os.path.basename(name) for name in TABLE_TESTS]
        with open(os.path.join(self.tree, "CMakeLists.txt"), "a", encoding="utf-8") as file:
            file.write(f"add_custom_target(wanted DEPENDS granularGas {' '.join(tests)})\n")  # of several targets make looks at each library anew
        run("cmake", "-S", self.tree, "-B", build, *["-G", "Unix Makefiles"] * bool(PLAIN), "-DCMAKE_BUILD_TYPE=Debug", "-DHAFF_WERROR=ON", "-DCMAKE_RULE_MESSAGES=OFF",
            "-DCMAKE_C_FLAGS=-O0 -g0 -DHAFF_NO_CLONES", cwd=self.tree)
        if PLAIN:
            self.keep_objects(build)
        run("cmake", "--build", build, "--parallel", "2", "--target", "wanted", cwd=self.tree)
        for test in tests:
            run(os.path.join(build, "bin", test), cwd=self.tree)
        solver = os.path.join(build, "bin", "granularGas")
        listed = run(solver, "-listModels", cwd=self.tree) + run(solver, "-listBCs", cwd=self.tree)
        for heading, (_, name) in RECIPES.items():
            self.assertIn(name or "", listed, f"{heading}: -listModels does not show {name}")
        self.run_all_of_them(solver)

    def keep_objects(self, build):
        """Objects that read no file of a recipe are copied from the build of this tree: make takes them for new. The others are compiled."""
        touched = {os.path.join(SOURCE, path) for diff in recipes().values() for path in re.findall(r"^\+\+\+ b/(\S+)", diff, flags=re.MULTILINE)}
        kept = 0
        for path, needs in self.objects():
            if path.startswith("CMakeFiles") and not {os.path.normpath(os.path.join(outside.BUILD, need)) for need in needs} & touched:
                copy = os.path.join(build, path)
                os.makedirs(os.path.dirname(copy), exist_ok=True)
                shutil.copyfile(os.path.join(outside.BUILD, path), copy)
                kept += 1
        self.assertGreater(kept, 200)

    def objects(self):
        """Path and needed files of each object of the build of this tree, below that."""
        if os.path.exists(os.path.join(outside.BUILD, "build.ninja")):
            for rule in run("ninja", "-t", "deps", cwd=outside.BUILD).split("\n\n"):
                first, *needs = rule.split("\n    ")
                yield first.split(":")[0], needs
        for rules in glob.glob(os.path.join(outside.BUILD, "CMakeFiles", "**", "*.o.d"), recursive=True):
            with open(rules, encoding="utf-8") as file:
                yield os.path.relpath(rules.removesuffix(".d"), outside.BUILD), file.read().replace("\\\n", " ").split()

    def run_all_of_them(self, solver):
        """A stream of spheres in a channel that uses all of them, on both engines, with either law of transport."""
        for engine, law in itertools.product(("lattice", "polyhedral"), ("DiluteSpheres", "Bagnold")):
            case, n = os.path.join(self.tree, engine + law), np.array([12, 8, 1])
            at = boxes.centres(n, 0.1 * n)
            u = np.stack([2 + at[:, 1], 0 * at[:, 0], 0 * at[:, 0]], axis=1)
            boxes.box_case(case, n, 0.1 * n, 50 + at[:, 0], u, np.full(96, 500.0), 0.02, types={"x": "cyclic"}, e=0.9,
                           eos="CarnahanStarling", flux="HLL", reconstruct="vanLeer", cooling="viscoelastic")
            boxes.write_field(case, "U", u, '"x.*" cyclic\n"y.*" slipLength; length 0.05\n"z.*" empty')
            harness.edit(case, "constant/granularProperties", transport=law)
            runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
            runs.add(case, "constant/granularProperties",
                     "sources (quadraticDrag); quadraticDragCoeffs { factor 0.1; }\n")
            runs.add(case, "constant/granularProperties", "carried { mark { type tagged; } }\n")
            boxes.DIMENSIONS["mark"] = "[0 0 0 0 0 0 0]"
            boxes.write_field(case, "mark", np.where(at[:, 0] < 0.5, 1.0, 0.0), '"x.*" cyclic\n"y.*" zeroGradient\n"z.*" empty')
            runs.add(case, "system/controlDict", "functions { centre { type centreOfMass; } }\n")
            log = run(solver, "-case", case, cwd=self.tree)
            self.assertIn("    Coriolis force ", log[log.index("Seconds of the clock"):])
            mark = harness.haff.Case(case).field("mark", runs.times(case)[-1])
            self.assertTrue(0 <= mark.min() and mark.max() <= 1 and np.any((mark > 0.1) & (mark < 0.9)))
            table = os.path.join(case, "postProcessing", "centre", "0", "centreOfMass.dat")
            with open(table, encoding="utf-8") as file:
                self.assertGreater(len(file.readlines()), 2)


if __name__ == "__main__":
    unittest.main()
