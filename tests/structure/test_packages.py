# SPDX-License-Identifier: GPL-3.0-or-later
"""The rooms of the Python packages haff and studies: which may import which, how large they are. Each rule is a function from sources,
{path below postprocessing: text}, to complaints, so that the rules are tested themselves, on made-up sources."""
import ast
import os
import re
import sys
import unittest

from tests.structure.test_rooms import LONGEST, MOST_FILES, MOST_LINES, text_of, tracked

# Each room, and the rooms whose modules it may import beside its own. A room may use only rooms that stand above it here, so that there are
# no circles. `haff` is paths.py and command.py; `import haff` is what the package offers to others, which its own rooms do without.
OFFER = "import haff"
HAFF = {
    "haff": [],
    "haff/case": ["haff"],
    "haff/plot": ["haff", "haff/case"],
    "haff/layers": ["haff", "haff/case", "haff/plot"],
    "haff/runs": ["haff", "haff/case", "haff/plot", "haff/layers"],
    "haff/report": ["haff", "haff/case", "haff/plot", "haff/runs"],
    "haff/start": ["haff", "haff/case"],
    "haff/openfoam": ["haff", "haff/case", "haff/start"],
    OFFER: ["haff", "haff/case", "haff/runs"],
}
ROOMS = {
    **HAFF,
    "studies/exact": ["haff", "haff/case", "haff/start"],
    "studies/made": [*HAFF],
    "studies/measured": [*HAFF, "studies/exact"],
    "studies/checks": [*HAFF, "studies/exact", "studies/measured"],
    "studies": [*HAFF, "studies/exact", "studies/made", "studies/measured"],
}
# Libraries beside numpy, and the rooms that may import them.
LIBRARIES = {
    "matplotlib": ["haff", "haff/plot", "haff/report", "studies"],
    "scipy": ["haff/case", "haff/plot", "haff/runs", "studies/exact", "studies/measured"],
    "pandas": ["haff/case"],
    "PIL": ["haff/plot", "haff/report"],
    "mpmath": ["studies/exact"],
}
OWN = {"", "haff", "studies", "numpy", *sys.stdlib_module_names}
OFFERED = "haff/__init__.py", "haff/__main__.py"


def room_of(path):
    return OFFER if path in OFFERED else os.path.dirname(path)


def imports(path, text, files):
    """The paths of the modules of these files that one of them imports, wherever in it. A package stands for its __init__.py."""
    def module(name):
        return next((p for p in (name.replace(".", "/") + ".py", name.replace(".", "/") + "/__init__.py") if p in files), None)
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names = [name.name for name in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            names = [f"{base}.{name.name}" if module(f"{base}.{name.name}") else base for name in node.names]
        else:
            continue
        for name in names:
            if name.startswith(".") or name.split(".")[0] in ("haff", "studies"):
                yield module(name) or name


def table_is_wrong(rooms):
    """Rooms that may import one that stands below them."""
    order = list(rooms)
    return [f"{room} may not use {other}: it stands below" for room, others in rooms.items() for other in others
            if other not in order or order.index(other) >= order.index(room)]


def forbidden_imports(files, rooms):
    wrong = [f"{path}: {room_of(path)} is no room" for path in files if room_of(path) not in rooms]
    for path, text in files.items():
        for other in imports(path, text, files):
            if other not in files:
                wrong.append(f"{path} imports {other}, which is no module")
            elif room_of(other) != room_of(path) and room_of(other) not in rooms.get(room_of(path), []):
                wrong.append(f"{path} imports {other}: {room_of(path)} may not use {room_of(other)}")
    return wrong


def misplaced_libraries(files, libraries):
    """Modules that import a library which their room does without; of others than Python's own and numpy."""
    wrong = []
    for path, text in files.items():
        for node in ast.walk(ast.parse(text)):
            names = [name.name for name in node.names] if isinstance(node, ast.Import) else [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            for library in {name.split(".")[0] for name in names} - OWN:
                if room_of(path) not in libraries.get(library, []):
                    wrong.append(f"{path} imports {library}")
    return wrong


def circles(files):
    """Modules that import themselves through others."""
    wrong, done = [], set()

    def visit(path, above):
        if path in above:
            wrong.append(" -> ".join([*above[above.index(path):], path]))
        elif path in files and path not in done:
            for other in imports(path, files[path], files):
                visit(other, [*above, path])
            done.add(path)
    for path in files:
        visit(path, [])
    return wrong


def too_large(files):
    """Rooms of too many files, files of too many lines, functions that do not fit a screen."""
    rooms = [os.path.dirname(path) for path in files]
    wrong = [f"{room} has {rooms.count(room)} files" for room in sorted(set(rooms)) if rooms.count(room) > MOST_FILES]
    for path, text in files.items():
        if text.count("\n") > MOST_LINES:
            wrong.append(f"{path}: is there a second subject in it?")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.end_lineno - node.lineno + 1 > LONGEST:
                wrong.append(f"{path}: {node.name} has {node.end_lineno - node.lineno + 1} lines")
    return wrong


def headless(files):
    """Modules that do not begin with a sentence."""
    return [path for path, text in files.items() if not re.match(r"\w\S* \S+ .*?[^.][.:]( |$)", " ".join((ast.get_docstring(ast.parse(text)) or "").split()))]


class Rooms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.files = {path.removeprefix("postprocessing/"): text_of(path) for path in tracked("postprocessing/haff/*.py", "postprocessing/studies/*.py")}

    def assertNone(self, wrong):
        self.assertEqual([], wrong, "\n" + "\n".join(wrong))

    def test_there_is_something_to_look_at(self):
        self.assertGreater(len(self.files), 100)

    def test_the_table_has_no_circles(self):
        self.assertNone(table_is_wrong(ROOMS))

    def test_modules_import_only_what_their_room_may(self):
        self.assertNone(forbidden_imports(self.files, ROOMS))

    def test_libraries_stay_where_they_belong(self):
        self.assertNone(misplaced_libraries(self.files, LIBRARIES))

    def test_modules_have_no_circles(self):
        self.assertNone(circles(self.files))

    def test_sizes(self):
        self.assertNone(too_large(self.files))

    def test_each_module_begins_with_a_sentence(self):
        self.assertNone(headless(self.files))

    def test_design(self):
        """The table in docs/design.md has these rooms."""
        page = text_of("docs/design.md")
        for room in ROOMS:
            self.assertRegex(page, rf"(?m)^\| [^|]*`{re.escape(room)}`", room)


class Rules(unittest.TestCase):
    """Each rule finds what it forbids in sources that are made up, and lets pass what looks like it."""

    FILES = {"haff/__init__.py": "from haff.case.case import Case\n", "haff/paths.py": "import os\n", "haff/case/__init__.py": "", "studies/__init__.py": "",
             "haff/case/case.py": "from haff import paths\n", "studies/serna.py": "import haff\nfrom haff.paths import TOP\n"}

    def test_tables(self):
        self.assertEqual([], table_is_wrong({"haff": [], "haff/case": ["haff"]}))
        self.assertEqual(1, len(table_is_wrong({"haff": ["haff/case"], "haff/case": ["haff"]})))
        self.assertEqual(1, len(table_is_wrong({"haff": [], "haff/case": ["haff/plot"]})))

    def test_imports(self):
        self.assertEqual([], forbidden_imports(self.FILES, ROOMS))
        for path, text in (("haff/case/case.py", "import haff\n"), ("haff/case/case.py", "from haff import Case\n"), ("haff/paths.py", "from haff.case import case\n"),
                           ("haff/case/case.py", "def f():\n    import studies.serna\n"), ("haff/case/case.py", "from studies import serna\n"),
                           ("haff/case/case.py", "from ..paths import TOP\n"), ("studies/serna.py", "from haff.studies import faraday\n"),
                           ("haff/new/new.py", "")):
            self.assertEqual(1, len(forbidden_imports({**self.FILES, path: text}, ROOMS)), (path, text))

    def test_libraries(self):
        self.assertEqual([], misplaced_libraries({"haff/case/a.py": "import os.path\nimport numpy as np\nfrom haff.case import b\nfrom . import c\ndef f():\n    import pandas\n"}, LIBRARIES))
        for text in ("import matplotlib.pyplot as plt\n", "def f():\n    from PIL import Image\n", "import requests\n"):
            self.assertEqual(1, len(misplaced_libraries({"haff/case/a.py": text}, LIBRARIES)), text)

    def test_circles(self):
        self.assertEqual([], circles(self.FILES))
        self.assertEqual(["haff/paths.py -> haff/case/case.py -> haff/paths.py"],
                         circles({"haff/paths.py": "def f():\n    from haff.case.case import Case\n", "haff/case/case.py": "from haff import paths\n"}))

    def test_sizes(self):
        body = "    x = 1\n" * (LONGEST - 1)
        self.assertEqual([], too_large({"haff/a.py": f"def f():\n{body}", **{f"haff/{n}.py": "" for n in range(MOST_FILES - 1)}}))
        self.assertEqual(1, len(too_large({"haff/a.py": f"def f():\n{body}    y = 1\n"})))
        self.assertEqual(1, len(too_large({"haff/a.py": "\n" * (MOST_LINES + 1)})))
        self.assertEqual(1, len(too_large({f"haff/{n}.py": "" for n in range(MOST_FILES + 1)})))

    def test_heads(self):
        self.assertEqual([], headless({"a.py": '# x\n"""Reads a .msh file.\n\nMore"""\n', "b.py": '"""A gas\nis:\n"""\n'}))
        for text in ("", "x = 1\n", '"""Gas."""\n', '"""A gas moves"""\n'):
            self.assertEqual(["a.py"], headless({"a.py": text}), text)


if __name__ == "__main__":
    unittest.main()
