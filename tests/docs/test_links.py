# SPDX-License-Identifier: GPL-3.0-or-later
"""Links and commands of the documents: each link leads to a file and its heading, each file of docs/ is reached from README.md, and
each command that README.md, CONTRIBUTING.md and docs/*.md show is run by a test."""
import os
import re
import shutil
import subprocess
import unittest

from tests.cases import harness
from tests.structure.test_rooms import tracked

TOP = harness.SOURCE
# A command begins with one of these words, or with a path that ends so.
PROGRAMS = {"granularGas", "granularMD", "granularDEM", "granularSegregation", "gmshToCase", "checkCase", "caseToVTK", "initialFields", "newCase", "haff", "haffPlot", "haffMovie",
            "haffLog", "Allrun", "Alltest", "Allcheck", "Allclean", "cmake", "ctest", "cpack", "gmsh", "mpirun", "makeReference", "makeGallery", "makeValidation", "makeBenchmarks"}
# A command as it is printed, without its comment: the test that runs it, or the same with other names.
COMMANDS = {
    "./Allrun": "tests/cases/runtime/test_setup.py::test_made_once",
    "newCase myCase mesh.geo && cd myCase && ./Allrun && haffPlot .": "tests/postprocessing/start/test_newCase.py::test_readme",
    "./Alltest": "tests/cases/runtime/test_setup.py::test_tests",
    "./Alltest -long": "tests/cases/runtime/test_setup.py::test_tests",
    "cmake --build build -j2 && ctest --test-dir build -L unit -j2": "tests/cases/runtime/test_setup.py::test_tests",
    "build/bin/haffPlot CASE [FIELD ..]": "tests/postprocessing/plot/test_commands.py::test_without_options",
    "build/bin/haffMovie CASE FIELD": "tests/postprocessing/plot/test_commands.py::test_mp4",
    "build/bin/haffLog CASE -follow": "tests/postprocessing/plot/test_commands.py::test_follow_ends_with_the_run",
    "gmsh -3 mesh.geo -o mesh.msh && gmshToCase mesh.msh -case gas && granularGas -case gas": "tests/docs/test_links.py::test_reference",
    "gmsh -3 mesh.geo -o mesh.msh && gmshToCase mesh.msh -case . && checkCase . && granularGas -case .": "tests/docs/test_userGuide.py::test_mesh_to_run",
    "granularMD -ensemble 8 -np 2 -case DIR": "tests/cases/grains/test_ensemble.py::test_means",
    "haffPlot CASE [FIELD ..]": "tests/postprocessing/plot/test_commands.py::test_without_options",
    "haffMovie CASE FIELD": "tests/postprocessing/plot/test_commands.py::test_mp4",
    "haffLog CASE -follow": "tests/postprocessing/plot/test_commands.py::test_follow_ends_with_the_run",
    "build/bin/haff report CASE": "tests/postprocessing/report/test_report.py::test_gas",
    "haff report CASE": "tests/postprocessing/report/test_report.py::test_gas",
    "haff report CASE -follow": "tests/postprocessing/report/test_report.py::test_follow",
    "haff report bouncingBed bouncingBedMD": "tests/postprocessing/report/test_report.py::test_pair",
    "haff report CASE-sweep": "tests/postprocessing/report/test_report.py::test_sweep",
    "haff turn CASE -angle 270": "tests/postprocessing/plot/test_turn.py::test_volumes",
    "haff columns CASE t.csv 0.5": "tests/postprocessing/layers/test_columns.py::test_of_a_gas",
    "haff expected CASE": "tests/cases/runtime/test_checkCases.py::test_expected",
    "haff faraday CASE": "tests/postprocessing/layers/test_faraday.py::test_command",
    "haff crossCheck CASE": "tests/postprocessing/studies/test_crossCheck.py::test_agrees",
    "haff fromOpenFOAM CASE NEWCASE": "tests/postprocessing/openfoam/test_fromOpenFOAM.py::test_state",
    "granularGas -case NEWCASE": "tests/postprocessing/openfoam/test_fromOpenFOAM.py::test_run",
}

# Pages all of whose commands one test takes from the page and runs: that test.
WHOLE = {"docs/tutorial.md": "tests/docs/test_tutorial.py::test_every_block_is_run", "docs/install.md": "tests/install/test_guide.py::test_commands"}


def text(path):
    with open(os.path.join(TOP, path), encoding="utf-8") as f:
        return f.read()


def prose(path):
    """A document without what stands in its fences and in `code`."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```", "", text(path), flags=re.M | re.S))


def anchors(path):
    """The names that GitHub gives to the headings of a document, after those that stand in it as HTML."""
    names = re.findall(r'<a (?:id|name)="([^"]+)"', text(path))
    for heading in re.findall(r"^#+ +(.+?) *$", re.sub(r"^```.*?^```", "", text(path), flags=re.M | re.S), re.M):
        name = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()).replace(" ", "-")
        same = sum(re.fullmatch(rf"{re.escape(name)}(-\d+)?", known) is not None for known in names)
        names.append(f"{name}-{same}" if same else name)
    return names


def links(path):
    """(file, anchor) of the links of a document to files, from the top; an image is one, too."""
    found = re.findall(r"\]\(<?([^)\s>]*)>?[^)]*\)", prose(path))
    parts = [link.partition("#")[::2] for link in found if not re.match(r"\w+:", link)]
    return [(os.path.normpath(os.path.join(os.path.dirname(path), file)) if file else path, anchor) for file, anchor in parts]


def documents():
    return sorted(path for path in tracked("*.md") if not path.startswith("tests/fuzz/seeds"))


def lost(paths):
    """What is wrong with the links of these documents."""
    wrong = []
    for path in paths:
        for file, anchor in sorted(set(links(path))):
            whole = os.path.join(TOP, file)
            page = os.path.join(file, "README.md") if os.path.isdir(whole) else file
            if not os.path.exists(whole):
                wrong.append(f"{path}: {file} is not there")
            elif anchor and page.endswith(".md") and anchor not in anchors(page):
                wrong.append(f"{path}: {page} has no heading {anchor}; it has {' '.join(anchors(page))}")
    return wrong


def reached(start):
    """Files that links lead to from there: a folder's files are, too, and scripts that a page calls by name."""
    seen, new = set(), [start]
    while new:
        path = new.pop()
        if path in seen or not os.path.exists(os.path.join(TOP, path)):
            continue
        seen.add(path)
        if os.path.isdir(os.path.join(TOP, path)):
            new += [os.path.join(path, name) for name in os.listdir(os.path.join(TOP, path)) if path.startswith("docs/") or name == "README.md"]
        elif path.endswith(".md"):
            new += [file for file, _ in links(path)] + re.findall(r"`(docs/\w+)\b", text(path))
    return seen


def commands(path):
    """The commands in the fences and indented blocks of a document, without comments."""
    fences = re.findall(r"^```(?:|sh|bash|console|text)\n(.*?)^```", text(path), re.M | re.S)
    outside = re.sub(r"^```.*?^```", "", text(path), flags=re.M | re.S)
    lines = [line for fence in fences for line in fence.split("\n")] + re.findall(r"^ {4,}(\S.*)$", outside, re.M)
    lines = [re.sub(r"(\s+#.*)?\s*$", "", line).lstrip("$ ") for line in lines]
    return [line for line in lines if line and os.path.basename(line.split()[0]) in PROGRAMS]


def pages():
    return ["README.md", "CONTRIBUTING.md"] + [path for path in documents() if re.fullmatch(r"docs/[^/]+\.md", path) and path not in WHOLE]


def unrun(lines, known):
    """What is wrong with the tests of these commands."""
    wrong = []
    for line in lines:
        if line not in known:
            wrong.append(f"`{line}` has no row in COMMANDS")
            continue
        path, _, name = known[line].partition("::")
        if not os.path.isfile(os.path.join(TOP, path)) or f"def {name}(" not in text(path):
            wrong.append(f"`{line}`: there is no {known[line]}")
            continue
        for part in re.split(r"\s*&&\s*", line):
            program = os.path.basename(part.split()[0])
            if program in PROGRAMS and program not in text(path) and line[:16] not in text(path):  # the latter takes the line from the page
                wrong.append(f"`{line}`: {path} does not call {program}")
    return wrong


class Links(unittest.TestCase):
    maxDiff = None

    def test_lead_somewhere(self):
        self.assertEqual(lost(documents()), [])

    def test_every_file_of_docs_is_reached(self):
        seen = reached("README.md")
        self.assertEqual([path for path in tracked("docs/*") if path not in seen], [], "no link leads there from README.md")

    def test_headings(self):
        self.assertIn("the-best-peer-on-the-2d-riemann-problem", anchors("postprocessing/reports/workPrecision.md"))
        self.assertIn(("docs/design.md", "reproducibility"), links("docs/addAModel.md"))


class Commands(harness.Folder, unittest.TestCase):
    maxDiff = None

    def test_are_run_by_tests(self):
        self.assertEqual([f"{path}: {wrong}" for path in pages() for wrong in unrun(commands(path), COMMANDS)], [])

    def test_whole_pages(self):
        """The tests of pages that run all commands are there, and read the page."""
        for page, test in WHOLE.items():
            path, _, name = test.partition("::")
            self.assertIn(f"def {name}(", text(path))
            self.assertIn(f'"{os.path.basename(page)}"', text(path))

    def test_rows_are_used(self):
        shown = {line for path in pages() for line in commands(path)}
        self.assertEqual([line for line in COMMANDS if line not in shown], [], "no document shows these commands any more")

    def test_a_command_without_a_test_is_found(self):
        known = {"haffPlot CASE": "tests/docs/test_links.py::test_nothing", "newCase x": "tests/docs/test_gallery.py::test_pictures"}
        self.assertEqual(unrun(["haffPlot .", "haffPlot CASE", "newCase x"], known),
                         ["`haffPlot .` has no row in COMMANDS", "`haffPlot CASE`: there is no tests/docs/test_links.py::test_nothing",
                          "`newCase x`: tests/docs/test_gallery.py does not call newCase"])

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not there")
    def test_reference(self):
        """The line at the head of the reference, on its examples: from mesh.geo by gmsh and gmshToCase to the end of a run of granularGas."""
        line = next(line for line in commands("docs/reference.md") if line.startswith("gmsh -3"))
        folder = os.path.join(self.folder, "examples")
        shutil.copytree(os.path.join(TOP, "docs", "examples"), folder)
        harness.edit(os.path.join(folder, "gas"), "system/controlDict", endTime="1e-4")
        done = subprocess.run(["sh", "-c", line], cwd=folder, capture_output=True, text=True, timeout=300,
                              env={**os.environ, "PATH": harness.BIN + ":" + os.environ["PATH"]})
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])


if __name__ == "__main__":
    unittest.main()
