# SPDX-License-Identifier: GPL-3.0-or-later
"""clang finds nothing to warn of in any source of the build; its warnings come before it makes code, so that none is made. The
whole build by clang is sanitize/clang (ctest -C Long)."""
import json
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
COMMANDS = os.path.join(os.environ.get("HAFF_BIN", os.path.join(SOURCE, "build", "bin")), "..", "compile_commands.json")
MOST = 50  # files in one process, which keeps what it has read of all: 0.1 GB


def options(command):
    """The options of a row of compile_commands.json, which stand between the compiler and the output."""
    words = shlex.split(command)
    first = next(k for k, word in enumerate(words) if word.startswith("-"))
    return words[first:words.index("-o")]


def looked_at(files, options, folder):
    """What clang says of files. One process reads them all, for its start takes ten times as long as a file: -Xclang hands it more inputs."""
    more = [word for path in files[1:] for word in ("-Xclang", path)]
    return subprocess.run(["clang", *options, "-Werror", "-fsyntax-only", *more, files[0]], cwd=folder, capture_output=True, text=True)


@unittest.skipUnless(shutil.which("clang"), "clang is not installed")
class Clang(unittest.TestCase):
    def test_no_source_is_warned_of(self):
        with open(COMMANDS) as f:
            rows = {row["file"]: row for row in json.load(f)}
        self.assertGreater(len(rows), 300)
        alike = {}
        for path, row in sorted(rows.items()):
            alike.setdefault((*options(row["command"]), row["directory"]), []).append(path)
        for (*words, folder), paths in alike.items():
            for k in range(0, len(paths), MOST):
                done = looked_at(paths[k:k + MOST], words, folder)
                self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_every_file_is_read(self):
        """Of several files in one process each one is warned of."""
        with tempfile.TemporaryDirectory() as folder:
            names = ["a.c", "b.c", "c.c"]
            for name in names:
                with open(os.path.join(folder, name), "w") as f:
                    f.write("int f(int a) { int idle; return a; }\n")
            done = looked_at(names, ["-Wall"], folder)
        self.assertEqual((done.returncode, sorted(re.findall(r"(\w+\.c):1:\d+: error: unused variable", done.stderr))), (1, names))


if __name__ == "__main__":
    unittest.main()
