# SPDX-License-Identifier: GPL-3.0-or-later
"""Function object image: the pictures of haffPlot at each written time, without a say in the run."""
import os
import re
import shutil
import subprocess
import time
import unittest

from tests.cases import harness, runs

CONTROL = "system/controlDict"
GAS = os.path.join(harness.BIN, "granularGas")
IMAGE = "functions {{ pictures {{ type image; fields ({}); {} }} }}\n"
# Stands in for haffPlot: notes its words, open files and variables, and whether the time is there before and after it was slow.
STAND_IN = r"""#!/bin/sh
there=no; test -s "$1/$4/U" && there=yes
cat > "$6"
for word; do echo "word $word" >> "$6"; done
ls -l /proc/$$/fd >> "$6"
env | grep -c '^OMPI_\|^PMIX_' >> "$6"
sleep {}
test -s "$1/$4/U" || there=gone
echo "there $there" >> "$6"
"""


class Image(harness.Folder, unittest.TestCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def case(self, name, fields="U T", more="", **options):
        path = runs.make(self.path(name), (12, 10, 1), 0.002, **{"interval": 0.001, **options})
        runs.add(path, CONTROL, IMAGE.format(fields, more) + "acceptWarnings (fewGrains rarefied);\n")
        return path

    def pictures(self, path, name="pictures"):
        folder = os.path.join(path, "postProcessing", name)
        return sorted(os.listdir(folder)) if os.path.isdir(folder) else []

    def alone(self, name, stand_in=None):
        """granularGas in a folder of its own, with another haffPlot beside it, or with none."""
        folder = self.path(name)
        os.makedirs(folder)
        program = shutil.copy(os.path.join(harness.BIN, "granularGas"), folder)
        if stand_in:
            with open(os.path.join(folder, "haffPlot"), "w") as f:
                f.write(stand_in)
            os.chmod(f.name, 0o755)
        return program

    def run_with(self, program, *arguments, code=0, ranks=1):
        start = [os.path.join(harness.BIN, "mpirun"), "-np", str(ranks)] if ranks > 1 else []
        done = subprocess.run([*start, program, *arguments], capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def test_pictures(self):
        """Those of the command, byte by byte, of a field of each time and of one that is not there at the start, as PDF, in a case with blanks
        in its name, on two ranks, whose state is that of a run without pictures."""
        path = self.case("with blanks'", "U.x", "options (-size 400x300 -contours 3); } films { type image; fields (Ma); format pdf; } "
                         "more { type writeObjects; objects (Ma);", interval=0.002)
        self.assertNotIn("noPicture", harness.program("granularGas", "-case", path, ranks=2).stdout)
        bare = runs.make(self.path("bare"), (12, 10, 1), 0.002, interval=0.002)
        harness.program("granularGas", "-case", bare)
        runs.same(self, *(runs.contents(case + "/0.002", ("provenance", "checksums", "Ma")) for case in (bare, path)))
        self.assertEqual(sorted(os.listdir(os.path.join(path, "postProcessing"))), ["films", "pictures", "run"])
        self.assertEqual(self.pictures(path), ["0.002.U.x.png", "0.U.x.png"])
        self.assertEqual(self.pictures(path, "films"), ["0.002.Ma.pdf"])
        with open(os.path.join(path, "postProcessing", "films", "0.002.Ma.pdf"), "rb") as f:
            self.assertEqual(f.read(5), b"%PDF-")
        own = self.path("own.png")
        harness.command("Plot", path, "U.x", "-time", "0.002", "-size", "400x300", "-contours", "3", "-o", own)
        with open(own, "rb") as one, open(os.path.join(path, "postProcessing", "pictures", "0.002.U.x.png"), "rb") as other:
            self.assertEqual(one.read(), other.read())

    def test_missing(self):
        """One warning with the line and the path, before the run starts, on any ranks."""
        program = self.alone("lonely")
        for ranks in (1, 2):
            path = self.case(f"missing{ranks}")
            said = self.run_with(program, "-case", path, ranks=ranks)
            self.assertEqual(said.count("[noPicture]"), 1)
            self.assertRegex(said, rf"warning: .*{CONTROL}:\d+: 'pictures' draws nothing: .*lonely/haffPlot is not there")
            self.assertRegex(said, r"\d warnings?: .*noPicture\n")
            self.assertEqual(self.pictures(path), [])
            self.assertEqual(runs.times(path)[-1], "0.002")

    def test_failing(self):
        """One warning with the reason, of all fields and times; -strict, too, lets the run go on. The command itself, and one that fails at once."""
        failing = self.alone("failing", "#!/bin/sh\necho 'error: -slice q=3' >&2\nexit 1\n")
        for name, program, arguments, ranks, fields in (("plain", failing, (), 1, "U T"), ("ranks", failing, (), 2, "U"), ("strict", GAS, ("-strict",), 1, "U")):
            path = self.case("failing" + name, fields, "options (-slice q=3);", interval=0.001 if name == "plain" else 0.002)
            said = self.run_with(program, "-case", path, *arguments, ranks=ranks)
            self.assertEqual(said.count("[noPicture]"), 1)
            self.assertRegex(said, r"'pictures' could not draw all its pictures, the run goes on: .*-slice q=3")
            self.assertEqual(runs.times(path)[-1], "0.002")
            self.assertEqual(self.pictures(path), [])

    def test_stand_in(self):
        """What the command gets: its words, no input, no file of the run, no word of MPI; and the time stays until it is done, though
        purgeWrite removes it."""
        program = self.alone("stand in", STAND_IN.format(0.3))
        path = self.case("words", "U", "options (-log);", interval=0.0005, purge=1)
        self.run_with(program, "-case", path, ranks=2)
        found = self.pictures(path)
        self.assertEqual(len(found), 5)
        for name in found:
            file = os.path.join(path, "postProcessing", "pictures", name)
            at = name.removesuffix(".U.png")
            with open(file) as f:
                lines = f.read().splitlines()
            words = [line[5:] for line in lines if line.startswith("word ")]
            self.assertEqual(words, [path, "U", "-time", at, "-o", file, "-log"])
            files = dict(re.search(r"(\d+) -> (.*)", line).groups() for line in lines if " -> " in line)
            own = os.path.join(os.path.dirname(program), "haffPlot")  # the shell reads that, and may hold copies of 1 and 2
            self.assertEqual({"/dev/null", files["2"]}, {target for target in files.values() if target not in (own, file)})
            self.assertEqual((files["0"], files["2"][:5]), ("/dev/null", "pipe:"))
            self.assertEqual(lines[-2:], ["0", "there yes"])

    def test_run_does_not_wait(self):
        """All steps are logged while the picture of the start is being drawn."""
        program = self.alone("slow", STAND_IN.format(3))
        path = self.case("slowly", "U", interval=0.002)
        run = subprocess.Popen([program, "-case", path], stdout=subprocess.PIPE, text=True)
        first = os.path.join(path, "postProcessing", "pictures", "0.U.png")
        for line in run.stdout:
            if line.startswith("Time = 0.002 "):
                break
        while not os.path.exists(first) and run.poll() is None:  # the shell starts
            time.sleep(0.01)
        with open(first) as f:
            self.assertNotIn("there", f.read())
        run.stdout.read()
        self.assertEqual(run.wait(), 0)
        with open(first) as f:
            self.assertIn("there yes", f.read())


if __name__ == "__main__":
    unittest.main()
