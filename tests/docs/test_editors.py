# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/makeEditors: VS Code and Vim know each keyword that -keywords tells of, in the files where it belongs."""
import fnmatch
import glob
import json
import os
import re
import shutil
import subprocess
import unittest

from tests.cases import harness
from tests.docs.test_reference import PROGRAMS, reference

EXAMPLES = os.path.join(harness.SOURCE, "docs", "examples")


def kind_of(file):
    return "fields" if file.startswith("0.orig/") else os.path.basename(file)


def typed(body):
    """What a snippet of VS Code leaves if its first offers are taken."""
    text = re.sub(r"\$\{1\|([^,|]*)[^|]*\|\}", r"\1", body)
    text = re.sub(r"\$\{1:((?:\\.|[^}\\])*)\}", r"\1", text)
    return re.sub(r"\\([$}\\])", r"\1", text)


class Editors(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run(["/usr/bin/python3", "-B", os.path.join(harness.SOURCE, "docs", "makeEditors"), cls.folder], check=True, env={**os.environ, "HAFF_BIN": harness.BIN})
        cls.rows = [(kind_of(file), row) for program in PROGRAMS for row in reference(program) for file in row.files]
        cls.package = cls.json("package.json")

    @classmethod
    def json(cls, *parts):
        with open(os.path.join(cls.folder, "vscode", *parts), encoding="utf-8") as file:
            return json.load(file)

    def test_snippets(self):
        """Each row of -keywords is a snippet, in the language of its file; what it types is the example of the row."""
        known = {what["language"]: {(s["prefix"], typed(s["body"])) for s in self.json(what["path"]).values()} for what in self.package["contributes"]["snippets"]}
        for kind, row in self.rows:
            for entry in filter(None, row.example.split("    in U: ")):
                self.assertIn((row.value, entry), known[f"haff-{kind}"])
        bodies = [s["body"] for what in self.package["contributes"]["snippets"] for s in self.json(what["path"]).values()]
        self.assertIn("stopAt ${1|endTime,writeNow,noWriteNow,nextWrite|};", bodies)
        self.assertIn("maxCo ${1:1};", bodies)

    def test_languages(self):
        """Each file of the examples is of one language; paths of the extension are there, and its patterns compile."""
        languages = self.package["contributes"]["languages"]
        for path in glob.glob("*/*/*", root_dir=EXAMPLES):
            of = [what["id"] for what in languages if any(fnmatch.fnmatch("/" + path, p.replace("**/", "*/")) for p in what["filenamePatterns"])]
            self.assertEqual(of, [f"haff-{kind_of(path.partition('/')[2])}"], path)
        for what in self.package["contributes"]["grammars"]:
            grammar = self.json(what["path"])
            self.assertEqual(grammar["scopeName"], what["scopeName"])
            scopes = {p["name"]: re.compile(p.get("match", p.get("begin"))) for p in grammar["patterns"]}
            for kind, row in self.rows:
                if f"haff-{kind}" == what["language"]:
                    self.assertTrue(any(scopes[s].fullmatch(row.value) for s in ("keyword.other", "constant.language") if s in scopes), row.value)

    @unittest.skipUnless(shutil.which("vim"), "no vim")
    def test_vim(self):
        """Vim takes the files for those of haff, colours a keyword and a value, and completes keywords in their file alone."""
        script = ["set nocompatible", f"set runtimepath^={os.path.join(self.folder, 'vim')}", "filetype plugin on", "syntax on",
                  f"edit {EXAMPLES}/gas/system/controlDict", "let g:out = [&filetype]"]
        script += [f"call search('\\<{word}\\>', 'w') | call add(g:out, synIDattr(synID(line('.'), col('.'), 1), 'name'))" for word in ("maxCo", "granularGas")]
        complete = [rf"""execute "normal Go{start}\<C-X>\<C-K>\<Esc>" | call add(g:out, getline('.'))""" for start in ("maxDe", "skipUniformA")]
        script += [*complete, f"edit! {EXAMPLES}/gas/system/fvSolution", *complete, "call writefile(g:out, 'said') | qall!"]
        with open(os.path.join(self.folder, "script.vim"), "w", encoding="utf-8") as file:
            file.write("\n".join(script) + "\n")
        done = subprocess.run("vim -u NONE -i NONE -n -N -es -S script.vim".split(), cwd=self.folder, capture_output=True, text=True, timeout=60,
                              stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(os.path.join(self.folder, "said"), encoding="utf-8") as file:
            self.assertEqual(file.read().split(), ["haff", "haffKeyword", "haffWord", "maxDeltaT", "skipUniformA", "maxDe", "skipUniformAxes"])


if __name__ == "__main__":
    unittest.main()
