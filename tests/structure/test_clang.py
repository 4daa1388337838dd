# SPDX-License-Identifier: GPL-3.0-or-later
"""clang finds nothing to warn of in any source of the build; its warnings come before it makes code, so that none is made. The
whole build by clang is sanitize/clang (ctest -C Long)."""
import json
import os
import shlex
import shutil
import subprocess
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
COMMANDS = os.path.join(os.environ.get("HAFF_BIN", os.path.join(SOURCE, "build", "bin")), "..", "compile_commands.json")


def options(command):
    """The options of a row of compile_commands.json, which stand between the compiler and the output."""
    words = shlex.split(command)
    first = next(k for k, word in enumerate(words) if word.startswith("-"))
    return words[first:words.index("-o")]


@unittest.skipUnless(shutil.which("clang"), "clang is not installed")
class Clang(unittest.TestCase):
    def test_no_source_is_warned_of(self):
        with open(COMMANDS) as f:
            rows = {row["file"]: row for row in json.load(f)}
        self.assertGreater(len(rows), 300)
        for path, row in sorted(rows.items()):
            done = subprocess.run(["clang", *options(row["command"]), "-Werror", "-fsyntax-only", path], cwd=row["directory"],
                                  capture_output=True, text=True)
            with self.subTest(os.path.relpath(path, SOURCE)):
                self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
