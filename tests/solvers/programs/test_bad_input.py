# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong input, as users make it, through the real programs: each mistake is named with file, line, what was found and
what is allowed; the exit code is 1 and the case folder stays as it was, to the byte."""
import hashlib
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

from tests.cases import harness
from tests.solvers.programs import bad_case
from tests.solvers.programs.bad_meshes import BOX_MESH, CONVERSION, MESH_FILE, RESTART
from tests.solvers.programs.bad_rows import COMMANDS, CONTROL, DICTIONARIES, FIELDS, PROPERTIES, Row
from tests.solvers.programs.bad_warnings import HARMLESS, WARNINGS

SOLVER = 5  # every fifth mistake is shown to granularGas, too: a run begins with the reading that is all of checkCase (run.c)


def snapshot(folder):
    """Every folder and file below, with the size and hash of its contents."""
    out = {}
    for path, folders, files in os.walk(folder):
        out.update({os.path.relpath(os.path.join(path, d), folder): None for d in folders})
        for name in files:
            with open(os.path.join(path, name), "rb") as f:
                data = f.read()
            out[os.path.relpath(os.path.join(path, name), folder)] = (len(data), hashlib.sha256(data).hexdigest())
    return out


class Folder(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.bases = {}

    def call(self, program, *arguments, cwd=None):
        done = subprocess.run([os.path.join(harness.BIN, program), *arguments], capture_output=True, text=True,
                              timeout=60, cwd=cwd, errors="replace")
        # where /sys is missing (bare containers) a library of MPI says so first
        done.stderr = "".join(line for line in done.stderr.splitlines(True) if not line.startswith("[hwloc/"))
        return done

    def base(self, name):
        """The sound case, alone or after a run; made once."""
        if name not in self.bases:
            case = self.bases[name] = os.path.join(self.folder, name)
            bad_case.write(case)
            if name != "box":
                harness.edit(case, CONTROL, writeFormat=name)
                harness.program("granularGas", "-case", case)
                for time in ("0.001", "0.002"):  # what is asked here is behind them; tests/cases/runtime/test_faults.py
                    os.remove(os.path.join(case, time, "uniform", "checksums"))
                harness.edit(case, CONTROL, endTime="0.004")
            harness.program("checkCase", case)
        return self.bases[name]

    def refuse(self, done, place, says):
        """Exit code 1, and a message for a user."""
        self.assertEqual(done.returncode, 1, done.stdout[-600:] + done.stderr[-1500:])
        self.assertTrue(done.stderr.startswith("error: "), done.stderr)
        self.assertEqual(done.stderr.count("error: "), 1, done.stderr)
        self.assertNotRegex(done.stderr, r"\.[ch]:\d|MPI_|Signal|Sanitizer|runtime error")
        self.assertNotRegex(done.stdout, r"(?i)\b(nan|inf)\b|Courant")
        if place:
            self.assertIn(place, done.stderr)
        for text in says:
            self.assertIn(text, done.stderr)


class BadInput(Folder):
    def outcome(self, row, commands):
        """A fresh case with the mistake, tried by the programs: [(result, what changed in the folder)]."""
        case = os.path.join(tempfile.mkdtemp(dir=self.folder), "case")
        shutil.copytree(self.base(row.base), case)
        place = row.spoil(case)
        before, tried = snapshot(case), []
        for command in commands:
            done = self.call(*(word.replace("CASE", case) for word in command))
            tried.append((done, set(before.items()) ^ set(snapshot(case).items())))
        shutil.rmtree(os.path.dirname(case))
        return place, tried

    def check(self, rows, commands=(("checkCase", "CASE"), ("granularGas", "-case", "CASE"))):
        self.assertEqual(len({row.name for row in rows}), len(rows))
        for name in {row.base for row in rows}:
            self.base(name)
        with ThreadPoolExecutor(4) as pool:
            outcomes = [pool.submit(self.outcome, row, commands if k % SOLVER == 0 else commands[:1]) for k, row in enumerate(rows)]
        for row, outcome in zip(rows, outcomes):
            with self.subTest(row.name):
                place, tried = outcome.result()
                for done, changed in tried:
                    self.refuse(done, place, row.says)
                    self.assertEqual(changed, set(), "the case was changed")

    def test_dictionaries(self):
        self.check(DICTIONARIES)

    def test_fields(self):
        self.check(FIELDS)

    def test_meshes(self):
        self.check(BOX_MESH)

    def test_restart(self):
        self.check(RESTART)

    def test_mesh_files(self):
        self.check(MESH_FILE, [("gmshToCase", "CASE/mesh.msh", "-case", "CASE")])

    def test_conversion(self):
        self.check(CONVERSION, [("caseToVTK", "CASE")])

    def test_warnings(self):
        """Named with file and line, and counted; an error with -strict; accepted by name, all is sound."""
        for k, row in enumerate(WARNINGS):
            with self.subTest(row.name):
                case = os.path.join(tempfile.mkdtemp(dir=self.folder), "case")
                shutil.copytree(self.base("box"), case)
                place, (name, *says) = row.spoil(case), row.says
                said = harness.program("checkCase", case).stdout
                found = re.findall(r"^(warning: .*) \[(\w+)\]$", said, re.M)
                self.assertEqual([n for _, n in found], [name], said[:2000])
                for text in (place, *says):
                    self.assertIn(text, found[0][0])
                self.assertIn(f"The case can be run, with 1 warning: {name}\n", said)
                for command in (("checkCase", case, "-strict"), ("granularGas", "-case", case, "-strict"))[:2 if k % SOLVER == 0 else 1]:
                    self.refuse(self.call(*command), place, (f"-strict: warning {name}", f"acceptWarnings ({name});"))
                with open(os.path.join(case, CONTROL), "a") as f:
                    f.write(f"acceptWarnings ({name});\n")
                said = harness.program("checkCase", case, "-strict").stdout
                self.assertIn("accepted " + found[0][0], said)
                self.assertIn("The case is sound.", said)

    def test_every_warning(self):
        """Each warning that acceptWarnings knows has a row here, or stands in another test."""
        said = harness.program("granularGas", "-keywords", "-markdown").stdout
        known = set(re.findall(r"`(\w+)` \| word of acceptWarnings", said))
        rows = {row.says[0] for row in WARNINGS}
        self.assertGreater(len(known), 25)
        self.assertEqual(rows - known, set())
        texts = ""
        for folder, _, files in os.walk(os.path.join(harness.SOURCE, "tests")):
            for name in files:
                if name.startswith("test_") and name.endswith(".py"):
                    with open(os.path.join(folder, name)) as f:
                        texts += f.read()
        self.assertEqual([name for name in sorted(known - rows) if name not in texts], [])

    def test_no_warnings(self):
        """What is no mistake is not warned of."""
        for row in HARMLESS:
            with self.subTest(row.name):
                case = os.path.join(tempfile.mkdtemp(dir=self.folder), "case")
                shutil.copytree(self.base("box"), case)
                row.spoil(case)
                said = harness.program("checkCase", case).stdout
                self.assertEqual(re.findall(r"^warning: .*", said, re.M), [])

    def test_long_step(self):
        """A deltaT that becomes too long while a run goes on is cut, which the log says and counts."""
        case = os.path.join(tempfile.mkdtemp(dir=self.folder), "case")
        shutil.copytree(self.base("box"), case)
        harness.edit(case, CONTROL, deltaT="0.03", endTime="0.3", writeInterval="0.3")
        with open(os.path.join(case, PROPERTIES), "a") as f:
            f.write("sources (uniformHeating); uniformHeatingCoeffs { rate 1e3; }\n")
        said = harness.program("granularGas", "-case", case).stdout
        self.assertEqual(len(re.findall(r"^warning: .*/controlDict:14: deltaT 0.03 is longer than the time scheme allows", said, re.M)), 1)
        steps, cut = int(re.search(r": (\d+) steps in", said)[1]), int(re.search(r"^(\d+) steps were shorter than deltaT", said, re.M)[1])
        self.assertGreater(cut, 1)
        self.assertGreater(steps, 10)
        self.assertLessEqual(cut, steps)
        self.assertTrue(said.endswith("1 warning: longTimeStep\n"))

    def test_ranks(self):
        """On two ranks a mistake is reported once, and mpirun adds nothing to it."""
        case = os.path.join(tempfile.mkdtemp(dir=self.folder), "case")
        shutil.copytree(self.base("box"), case)
        place = Row("", (CONTROL, "maxCo 0.5;", "maxC0 0.5;")).spoil(case)
        before = snapshot(case)
        for command in (["mpirun", "-np", "2", os.path.join(harness.BIN, "granularGas"), "-case", case],
                        ["granularGas", "-np", "2", "-case", case]):
            done = self.call(*command)
            self.refuse(done, place, ("did you mean 'maxCo'?",))
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertEqual(snapshot(case), before)

    def test_command_lines(self):
        case, msh = self.base("ascii"), os.path.join(self.folder, "sound.msh")
        with open(msh, "w") as f:
            f.write(bad_case.MSH2)
        before = snapshot(case)
        for command, *says in COMMANDS:
            with self.subTest(" ".join(command)):
                done = self.call(*(word.replace("CASE", case).replace("MSH", msh) for word in command))
                self.refuse(done, None, [text.replace("CASE", case) for text in says])
                self.assertEqual(snapshot(case), before, "the case was changed")

    def test_defaults_are_listed(self):
        """checkCase of the sound case names each key of controlDict as read or default, and writes nothing."""
        case = self.base("box")
        before = snapshot(case)
        said = harness.program("checkCase", case).stdout
        self.assertRegex(said, r"maxCo +0.5 +read ")
        self.assertRegex(said, r"minDeltaT +0 +default ")
        self.assertRegex(said, r"logInterval +0 +default ")
        self.assertIn("The case is sound.", said)
        self.assertEqual(snapshot(case), before)

    def test_triangles(self):
        """A mesh that is no lattice: checked, with its summary, and refused by `meshEngine lattice`."""
        case = tempfile.mkdtemp(dir=self.folder)
        shutil.copytree(self.base("box"), case, dirs_exist_ok=True)
        msh = os.path.join(case, "mesh.msh")
        with open(msh, "w") as f:
            f.write(bad_case.MSH2.replace("8 3 2 3 1 2 3 6 5", "8 2 2 3 1 2 3 6\n9 2 2 3 1 2 6 5").replace(
                "$Elements\n8", "$Elements\n9"))
        harness.program("gmshToCase", msh, "-case", case)
        for name in ("alpha", "T", "U"):
            path = os.path.join(case, "0", name)
            with open(path) as f:
                text = f.read().replace(bad_case.LIST, "uniform 0.2;\n")
            patches = "\n".join(f"{p} {{ type {t}; }}" for p, t in (
                ("ends", "zeroGradient"), ("sides", "slip"), ("front", "empty"), ("back", "empty")))
            with open(path, "w") as f:
                f.write(text[:text.index("boundaryField")] + "boundaryField\n{\n" + patches + "\n}\n")
        path = os.path.join(case, "system/controlDict")
        with open(path) as f:
            text = f.read().replace("(3 2 0.5)", "(0.6 0.5 0.5)")  # the box is longer
        with open(path, "w") as f:
            f.write(text)
        before = snapshot(case)
        said = harness.program("checkCase", case).stdout
        self.assertRegex(said, r"faces \(2 internal\), 3 cells")
        self.assertRegex(said, r"patch ends +patch +2 faces")
        self.assertRegex(said, r"no lattice: cell \d+ at \(.*\) is no box")
        self.assertEqual(snapshot(case), before)
        with open(os.path.join(case, "system/fvSchemes"), "a") as f:
            f.write("meshEngine lattice;\n")
        self.refuse(self.call("granularGas", "-case", case), case, ("no lattice of equal boxes", "meshEngine polyhedral;"))


if __name__ == "__main__":
    unittest.main()
