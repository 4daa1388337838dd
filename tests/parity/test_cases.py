# SPDX-License-Identifier: GPL-3.0-or-later
"""tests/parity/cases.py: silent where two builds compute the same, and not where a byte, a message or an input differs."""
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
BIN = os.environ.get("HAFF_BIN", os.path.join(HERE, "..", "..", "build", "bin"))
CASE = "reconstructPHM"  # a box that runs for a tenth of a second

# A build that writes another last byte of the density, one that reads another restitution, and one that says another word.
BYTE = """{0}/granularGas "$@" || exit
printf x | dd of="$2/0.03/rho" bs=1 seek=100 conv=notrunc 2>/dev/null
"""
VALUE = """sed -i 's/restitution 0.9/restitution 0.8/' "$2/constant/granularProperties"
exec {0}/granularGas "$@"
"""
WORD = """{0}/granularGas "$@" | sed 's/drift/shift/'
"""
STOP = """{0}/granularGas "$@"
exit 3
"""


def tool(*arguments):
    return subprocess.run([sys.executable, os.path.join(HERE, "cases.py"), *arguments], capture_output=True, text=True, timeout=300)


class Parity(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._temporary = tempfile.TemporaryDirectory(prefix="haff")
        cls.folder = cls._temporary.name

    @classmethod
    def tearDownClass(cls):
        cls._temporary.cleanup()

    def build(self, name, script):
        """The programs of the build, but for a granularGas that does something else."""
        folder = os.path.join(self.folder, name)
        os.mkdir(folder)
        for program in ("granularMD", "granularSegregation", "gmshToCase", "checkCase", "caseToVTK", "mpirun"):
            os.symlink(os.path.join(BIN, program), os.path.join(folder, program))
        path = os.path.join(folder, "granularGas")
        with open(path, "w") as f:
            f.write("#!/bin/sh\n" + script.format(os.path.abspath(BIN)))
        os.chmod(path, 0o755)
        return folder

    def test_same(self):
        done = tool(BIN, BIN, CASE)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, rf"^{CASE} +same  \(\d\d files")

    def test_saved(self):
        """Against saved checksums: listings and a run; a case that was not saved is no silent success."""
        saved, kept = os.path.join(self.folder, "saved.json"), os.path.join(self.folder, "kept")
        self.assertEqual(tool(BIN, "-save", saved, "-keep", kept, CASE, "listings").returncode, 0)
        self.assertTrue(os.path.isfile(os.path.join(kept, "a", CASE, "0.03", "rho")))
        done = tool(BIN, "-against", saved, CASE, "listings")
        self.assertEqual((done.returncode, done.stdout.count(" same ")), (0, 2), done.stdout + done.stderr)
        done = tool(self.build("savedByte", BYTE), "-against", saved, CASE)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, rf"{CASE} +0.03/rho: bytes 1 .. 1024 of")
        done = tool(BIN, "-against", saved, "timeEuler")
        self.assertEqual(done.returncode, 1)
        self.assertIn("not among the saved checksums", done.stdout)

    def test_differs(self):
        rows = (("byte", BYTE, r"0\.03/rho: byte 101 of (\d+) and \1"),
                ("value", VALUE, r"0\.015/T: byte \d+ of .* more of \d+ differ"),
                ("word", WORD, r"log\.solver: line \d+: '.*drift.*\| '.*shift"),
                ("stop", STOP, r"log\.solver: .*instead of exit code 0"))
        for name, script, message in rows:
            with self.subTest(name):
                done = tool(BIN, self.build(name, script), CASE)
                self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
                self.assertRegex(done.stdout, rf"{CASE} +" + message)

    def test_wrong_command_line(self):
        for arguments, words in (((BIN, BIN, "wegde"), "no case wegde"), ((BIN,), "which folders"), ((HERE, BIN), "holds no granularGas")):
            done = tool(*arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)

    def test_every_shipped_case(self):
        """A folder of cases/ that has no short form would be left out unseen."""
        cases = os.path.join(HERE, "..", "..", "cases")
        listed = tool("-list").stdout.split()
        self.assertEqual([n for n in sorted(os.listdir(cases)) if os.path.isfile(os.path.join(cases, n, "system", "controlDict")) and n not in listed], [])


if __name__ == "__main__":
    unittest.main()
