# SPDX-License-Identifier: GPL-3.0-or-later
"""The rooms of the house: which folder may include which, how many files a room holds, who may see a library, what is
nowhere allowed, and that every path the code, the build and the documents name is there. Each rule is a function from
sources, {path: text}, to complaints, so that the rules are tested themselves, on made-up sources."""
import fnmatch
import os
import re
import subprocess
import unittest

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
LAYERS = ("mesh", "libcore", "solvers")
MOST_FILES = 24  # of a room
MOST_LINES = 700  # of a file
LONGEST = 45  # lines of a function: a screen
MOST_PARAMETERS = 8  # of a function: more are a struct that names them

LICENCE = "SPDX-License-Identifier: GPL-3.0-or-later"

# Each room, and the rooms its files may include beside their own. A room may use only rooms that stand above it here,
# so that there are no circles.
ROOMS = {
    "mesh/base": [],
    "mesh/format": ["mesh/base"],
    "mesh/lattice": ["mesh/base", "mesh/format"],
    "mesh/spread": ["mesh/base", "mesh/format"],
    "mesh/polyhedral": ["mesh/base", "mesh/format", "mesh/spread"],
    "mesh/grid": ["mesh/base", "mesh/format", "mesh/lattice", "mesh/spread", "mesh/polyhedral"],
    "libcore/models": ["mesh/base"],
    "libcore/multigrid": ["libcore/models", "mesh/base"],
    "libcore/acoustics": ["libcore/models", "libcore/multigrid", "mesh/base"],
    "libcore/schemes": ["libcore/models", "mesh/base", "mesh/polyhedral"],
    "libcore/gas": ["libcore/models", "libcore/schemes", "libcore/acoustics", "mesh/base", "mesh/grid"],
    "libcore/step": ["libcore/models", "libcore/schemes", "libcore/gas", "mesh/base"],
    "libcore/lattice": ["libcore/models", "libcore/schemes", "libcore/gas", "mesh/base", "mesh/lattice"],
    "libcore/polyhedral": ["libcore/models", "libcore/schemes", "libcore/gas", "mesh/base", "mesh/polyhedral"],
    "libcore/grains": ["libcore/models", "mesh/base"],
    "libcore/segregation": ["libcore/models", "mesh/base"],
    "solvers/dict": ["libcore/models", "mesh/base", "mesh/format"],
    "solvers/case": ["libcore/models", "mesh/base", "mesh/format", "mesh/spread", "mesh/grid", "solvers/dict"],
    "solvers/output": ["libcore/models", "mesh/base", "mesh/format", "mesh/grid", "solvers/dict", "solvers/case"],
    "solvers/functions": ["libcore/models", "mesh/base", "mesh/format", "mesh/grid", "solvers/dict", "solvers/case",
                          "solvers/output"],
    "solvers/gas": ["libcore/models", "libcore/schemes", "libcore/gas", "libcore/grains", "mesh/base", "mesh/format",
                    "mesh/grid", "solvers/dict", "solvers/case", "solvers/output"],
    "solvers/grains": ["libcore/models", "libcore/grains", "mesh/base", "mesh/format", "mesh/grid", "solvers/dict",
                       "solvers/case", "solvers/output", "solvers/gas"],
    "solvers/dem": ["libcore/models", "libcore/grains", "mesh/base", "mesh/format", "mesh/grid", "solvers/dict",
                    "solvers/case", "solvers/output", "solvers/gas", "solvers/grains"],
    "solvers/segregation": ["libcore/models", "libcore/segregation", "mesh/base", "mesh/format", "mesh/grid",
                            "solvers/dict", "solvers/case", "solvers/output"],
    "solvers/programs": ["libcore/models", "mesh/base", "mesh/format", "mesh/grid", "mesh/lattice", "solvers/dict",
                         "solvers/case", "solvers/output", "solvers/functions"],
    "solvers/python": ["mesh/base", "solvers/output", "solvers/programs"],
}

# Libraries and the only files that may include them.
LIBRARIES = {
    r"mpi\.h": ["mesh/base/comm.c"],
    r"pthread\.h": ["mesh/base/background.c"],
    r"(p4est|p8est|sc)[_.]": ["mesh/lattice/trees_flat.c", "mesh/lattice/trees_solid.c"],
    r"metis\.h": ["mesh/polyhedral/polyhedra_cut.c"],
    r"petsc": ["libcore/gas/implicit_petsc.c"],
    r"lapacke?\.h": ["libcore/segregation/segregation.c"],
    r"dlfcn\.h": ["solvers/gas/linear.c"],
    r"(fcntl|dirent)\.h": ["mesh/format/files.c", "solvers/case/lock.c", "solvers/case/times.c", "solvers/dem/child.c",
                           "solvers/functions/functions_image.c", "solvers/output/vtk.c", "solvers/programs/unread.c"],
    r"zlib\.h": ["mesh/format/foamfile.c", "mesh/format/foamwrite.c", "mesh/base/window.c", "mesh/spread/spread_outline.c"],
    r"libdeflate\.h": ["mesh/format/foamwrite.c", "mesh/format/polymesh.c", "mesh/spread/spread_outline.c",
                        "solvers/output/vtu.c"],
}

# Headers of the system that libcore has no business with: it opens no file, and does not know where programs lie.
NOT_IN_LIBCORE = r"(stdio|unistd|fcntl|dirent|dlfcn|signal|sys/\w+)\.h"

# What opens, makes, renames and removes files, and the one file that may call it: it walks past links.
FILES = "mesh/format/files.c"
FILE_CALLS = (r"(?<![\w>.])(f?open|openat|open64|creat|freopen|gzopen|rename|renameat|unlink|unlinkat|remove|rmdir|mkdir|mkdirat|"
              r"mkfifo|mknod|link|symlink|truncate|mkstemp|mkdtemp|tmpfile|tmpnam|popen|system|chdir|chmod|chown)\(")

# Variables of a whole file that may change, with the reason.
MUTABLE = {"solvers/programs/run.c": ["asked_to_stop"]}  # the one thing that a signal handler may touch


def includes(text, kind):
    """What a source includes: kind '"' is ours, '<' the system's."""
    return re.findall(r"^[ \t]*#[ \t]*include[ \t]*" + kind + r'([^">]+)', text, re.MULTILINE)


def bare(text):
    """A source without comments, texts and lines of the preprocessor."""
    text = re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'',
                  lambda found: '""' if found.group()[0] == '"' else "0" if found.group()[0] == "'" else " ", text,
                  flags=re.DOTALL)
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.MULTILINE)


def table_is_wrong(rooms):
    """A circle, or a way up, in a table of rooms."""
    seen, wrong = [], []
    for room, uses in rooms.items():
        for used in uses:
            if used not in seen:
                wrong.append(f"{room} may use {used}, which does not stand above it")
            elif LAYERS.index(used.split("/")[0]) > LAYERS.index(room.split("/")[0]):
                wrong.append(f"{room} may use {used}, which is a layer above it")
        seen.append(room)
    return wrong


def forbidden_includes(files, rooms):
    wrong = []
    for path, text in files.items():
        room = os.path.dirname(path)
        if room not in rooms:
            wrong.append(f"{path}: no room of the table has it")
            continue
        wrong += [f"{path} includes {name}" for name in includes(text, '"')
                  if os.path.dirname(name) not in (room, *rooms[room])]
    return wrong


def circles(files):
    """Headers that include each other."""
    edges = {path: includes(text, '"') for path, text in files.items() if path.endswith(".h")}
    done, wrong = set(), []

    def walk(path, way):
        if path in way:
            wrong.append(" -> ".join((*way[way.index(path):], path)))
        elif path in edges and path not in done:
            for name in edges[path]:
                walk(name, (*way, path))
            done.add(path)

    for path in edges:
        walk(path, ())
    return wrong


def misplaced_libraries(files, libraries):
    return [f"{path} includes {name}" for path, text in files.items() for name in includes(text, "<")
            for library, allowed in libraries.items() if re.match(library, name) and path not in allowed]


def opens_files(files):
    """What in libcore deals with files, with the terminal or with the loader."""
    wrong = []
    for path, text in files.items():
        if not path.startswith("libcore/"):
            continue
        wrong += [f"{path} includes {name}" for name in includes(text, "<") if re.fullmatch(NOT_IN_LIBCORE, name)]
        wrong += [f"{path} calls {name}" for name in
                  re.findall(r"\b(v?f?printf|puts|fopen|open|getenv|readlink|dlopen|system)\(", bare(text))]
    return wrong


def touches_files(files):
    return [f"{path} calls {name}" for path, text in files.items() if path != FILES
            for name in re.findall(FILE_CALLS, bare(text))]


def ends_the_program(files):
    return [f"{path} calls {name}" for path, text in files.items()
            for name in re.findall(r"\b(abort|_?exit|_Exit|assert)\(", bare(text))]


def long_functions(files, longest):
    wrong = []
    for path, text in files.items():
        begin = 0
        for number, line in enumerate(text.split("\n"), 1):
            if re.match(r"[A-Za-z_].*\(", line) and not line.endswith(";"):
                begin = number
            elif line == "}" and begin:
                if number - begin >= longest:
                    wrong.append(f"{path}:{begin}: a function of {number - begin + 1} lines")
                begin = 0
    return wrong


def long_lists(files, most):
    """Functions, also their types, that take more than that number of parameters."""
    return [f"{path}: {name} has {count} parameters" for path, text in files.items()
            for name, count in ((found[1], found[2].count(",") + 1) for found in re.finditer(
                r"^[A-Za-z_][\w \t*]*?\b(\w+)\(((?:[^(){};]|\([^(){};]*\))*)\)", bare(text), re.MULTILINE)) if count > most]


def outside_functions(text):
    """The declarations of a file that stand in no braces, with {} in place of what does."""
    out, now, depth = [], "", 0
    for c in bare(text):
        depth += (c == "{") - (c == "}")
        if c == "}" and depth == 0:
            now += "{}"
            if "(" in now and "=" not in now:  # the end of a function
                now = ""
        elif c == ";" and depth == 0:
            out.append(" ".join(now.split()))
            now = ""
        elif depth == 0:
            now += c
    return out


def mutable_globals(files, allowed):
    wrong = []
    for path, text in files.items():
        for declaration in outside_functions(text):
            first, *others = re.sub(r"\[[^]]*\]", "", declaration).split(",")
            first = first.split("=")[0].strip()
            if "(" in first or re.match(r"typedef\b|(struct|enum|union) \w* ?(\{\})?$", first):
                continue
            for declarator in (first, *others):
                declarator = declarator.split("=")[0].strip()
                name = re.search(r"\w+$", declarator)
                fixed = re.search(r"\bconst \w+$", declarator) if "*" in declarator else re.search(r"\bconst\b", first)
                if name and not fixed and name.group() not in allowed.get(path, []):
                    wrong.append(f"{path}: {declaration}")
    return wrong


def shared_guards(files):
    """Headers whose guards have the same name: the second to be included would vanish."""
    found, wrong = {}, []
    for path, text in files.items():
        guard = re.search(r"^#ifndef (\w+_H)$", text, re.MULTILINE)
        if path.endswith(".h") and not guard:
            wrong.append(f"{path} has no include guard")
        elif path.endswith(".h"):
            if guard.group(1) in found:
                wrong.append(f"{path} and {found[guard.group(1)]} have one guard")
            found[guard.group(1)] = path
    return wrong


def shared_kernels(files):
    """Kernels of one name: clang exports what chooses among a kernel's clones, also of static ones, and two of one name
    do not link. Kernels that are not static: clang 14 gives them another name, which their callers in other files do not find."""
    found, wrong = {}, []
    for path, text in files.items():
        wrong += [f"{path} has a kernel that is not static: {line}" for line in re.findall(r"^KERNEL (?!static ).*", text, re.MULTILINE)]
        for name in re.findall(r"^KERNEL static [\w ]*?\**(\w+)\(", text, re.MULTILINE):
            if name in found:
                wrong.append(f"{path} and {found[name]} have a kernel {name}")
            found[name] = path
    return wrong


def shared_tags(files, layers):
    """Tags of structs, unions and enums that are defined more than once in a layer: the name does not say which is meant."""
    found, wrong = {}, []
    for path, text in files.items():
        layer = path.split("/")[0]
        for tag in re.findall(r"\b(?:struct|union|enum)\s+(\w+)\s*\{", bare(text)) if layer in layers else []:
            if (layer, tag) in found:
                wrong.append(f"{path} and {found[layer, tag]} define {tag}")
            found[layer, tag] = path
    return wrong


def headless(files):
    """Sources that do not begin, below the line of the licence, with a comment whose first sentence says something and ends, with a stop or a colon."""
    def head(text):
        found = re.match(r"/\*(.*?)\*/", text.removeprefix(f"/* {LICENCE} */\n"), re.DOTALL)
        return " ".join(re.sub(r"\n \*", " ", found.group(1)).split()) if found else ""
    return [path for path, text in files.items() if not re.match(r"\w\S* \S+ .*?[^.][.:]( |$)", head(text))]


def without_licence(files):
    """Sources that do not name their licence: first, or below `#!` and a comment that a script prints as its help."""
    return [path for path, text in files.items() if not re.search(rf"^(/\* |# ){LICENCE}( \*/)?$", "\n".join(text.split("\n")[:15]), re.MULTILINE)]


def forgotten_rows(files):
    """Types of function objects that a file exports and the table of functions.c lacks."""
    table = files.get("solvers/functions/functions.c", "")
    return [f"{path}: {name} is not in the table" for path, text in files.items()
            for name in re.findall(r"^const struct function_type (\w+)", text, re.MULTILINE) if f"&{name}" not in table]


def tracked(*patterns):
    """Paths of the source tree that fit: those that git follows and new ones, none that it ignores; without git, all."""
    found = subprocess.run(["git", "-C", SOURCE, "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True)
    paths = found.stdout.split("\n")
    if found.returncode:
        paths = [os.path.relpath(os.path.join(folder, name), SOURCE)
                 for folder, _, names in os.walk(SOURCE) for name in names]
    return [path for path in paths if path and os.path.isfile(os.path.join(SOURCE, path))
            and any(fnmatch.fnmatch(path, pattern) for pattern in patterns)]


def text_of(path):
    with open(os.path.join(SOURCE, path), encoding="utf-8", errors="replace") as file:
        return file.read()


class Rooms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.files = {path: text_of(path) for path in tracked("*.c", "*.h") if path.split("/")[0] in LAYERS}

    def assertNone(self, wrong):
        self.assertEqual([], wrong, "\n" + "\n".join(wrong))

    def test_there_is_something_to_look_at(self):
        self.assertGreater(len(self.files), 150)

    def test_the_table_has_no_circles_and_no_way_up(self):
        self.assertNone(table_is_wrong(ROOMS))

    def test_files_include_only_what_their_room_may(self):
        self.assertNone(forbidden_includes(self.files, ROOMS))

    def test_headers_have_no_circles(self):
        self.assertNone(circles(self.files))

    def test_libraries_stay_where_they_belong(self):
        self.assertNone(misplaced_libraries(self.files, LIBRARIES))

    def test_libcore_opens_no_file(self):
        self.assertNone(opens_files(self.files))

    def test_files_are_touched_in_one_place(self):
        self.assertNone(touches_files(self.files))

    def test_nothing_ends_the_program(self):
        self.assertNone(ends_the_program(self.files))

    def test_nothing_is_global_that_changes(self):
        self.assertNone(mutable_globals(self.files, MUTABLE))

    def test_functions_fit_a_screen(self):
        self.assertNone(long_functions(self.files, LONGEST))

    def test_functions_take_few_parameters(self):
        self.assertNone(long_lists(self.files, MOST_PARAMETERS))

    def test_kernels_have_names_of_their_own(self):
        self.assertGreater(sum(text.count("\nKERNEL static ") for text in self.files.values()), 50)
        self.assertNone(shared_kernels(self.files))

    def test_tags_are_unique_in_a_layer(self):
        self.assertNone(shared_tags(self.files, set(LAYERS)))

    def test_function_objects_are_in_the_table(self):
        self.assertNone(forgotten_rows(self.files))

    def test_no_room_is_overfull(self):
        count = {}
        for path in tracked("*"):
            if path.split("/")[0] in (*LAYERS, "tests") and "/fuzz/" not in path:
                count[os.path.dirname(path)] = count.get(os.path.dirname(path), 0) + 1
        for room, files in count.items():
            if not re.search(r"/(regressions|references|seeds|oracles)", room):
                self.assertLessEqual(files, MOST_FILES, room)

    def test_tests_mirror_the_rooms(self):
        for path in tracked("tests/*"):
            folders = path.split("/")[1:-1]
            if folders and folders[0] in LAYERS and len(folders) > 1:
                self.assertIn("/".join(folders), ROOMS, f"{path} tests no room")

    def test_files_keep_to_one_subject(self):
        for path, text in self.files.items():
            self.assertLessEqual(text.count("\n"), MOST_LINES, f"{path}: is there a second subject in it?")

    def test_the_gas_is_made_of_parts(self):
        """A further member belongs into the struct of its part."""
        inside = re.search(r"^struct gas \{(.*?)^\};", bare(self.files["libcore/gas/gas_private.h"]), re.MULTILINE | re.DOTALL)[1]
        members = [name for line in inside.split(";") if line.strip() for name in line.split(",")]
        self.assertIn("struct floors floors", [" ".join(m.split()) for m in members])
        self.assertLessEqual(len(members), 25)

    def test_each_file_begins_with_a_sentence(self):
        self.assertNone(headless(self.files))

    def test_each_source_names_its_licence(self):
        scripts = {path: text_of(path) for path in tracked("*") if not path.startswith("docs/examples/") and "." not in os.path.basename(path)}
        scripts = {path: text for path, text in scripts.items() if text.startswith("#!")}
        self.assertNone(without_licence({**scripts, **{path: text_of(path) for path in tracked("*.c", "*.h", "*.py", "*CMakeLists.txt")}}))

    def test_guards_of_headers_differ(self):
        self.assertNone(shared_guards(self.files))


class Paths(unittest.TestCase):
    def test_paths_that_are_named_are_there(self):
        """A path of a source file in a comment, a document or the build leads somewhere."""
        pattern = re.compile(r"(?<![\w/.-])((?:mesh|libcore|solvers|tests)/[\w/]+\.(?:c|h|py))\b")
        for path in tracked("*.c", "*.h", "*.md", "*.py", "*.txt"):
            if path.startswith(("tests/fuzz/seeds", "tests/fuzz/regressions", "tests/structure")):
                continue
            for name in pattern.findall(text_of(path)):
                self.assertTrue(os.path.isfile(os.path.join(SOURCE, name)), f"{path} names {name}")


class Rules(unittest.TestCase):
    """Each rule finds what it forbids in sources that are made up, and lets pass what looks like it."""

    def test_tables(self):
        self.assertEqual([], table_is_wrong({"mesh/a": [], "libcore/b": ["mesh/a"], "solvers/c": ["libcore/b"]}))
        self.assertEqual(1, len(table_is_wrong({"mesh/a": ["mesh/b"], "mesh/b": ["mesh/a"]})))
        self.assertEqual(1, len(table_is_wrong({"libcore/b": [], "mesh/a": ["libcore/b"]})))

    def test_includes(self):
        rooms = {"mesh/a": [], "solvers/b": ["mesh/a"]}
        good = {"mesh/a/x.c": '#include "mesh/a/x.h"\n#include <math.h>\n',
                "solvers/b/y.c": '#include "mesh/a/x.h"\n/* #include "solvers/c/z.h" */\n'}
        self.assertEqual([], forbidden_includes(good, rooms))
        for path, text in (("mesh/a/x.c", '#include "solvers/b/y.h"\n'), ("mesh/a/x.c", '  # include "y.h"\n'),
                           ("mesh/c/x.c", "")):
            self.assertEqual(1, len(forbidden_includes({path: text}, rooms)), text)

    def test_circles(self):
        chain = {"a/x.h": '#include "a/y.h"\n', "a/y.h": '#include "a/z.h"\n', "a/z.h": "", "a/z.c": '#include "a/x.h"\n'}
        self.assertEqual([], circles(chain))
        self.assertEqual(1, len(circles({**chain, "a/z.h": '#include "a/x.h"\n'})))

    def test_libraries(self):
        self.assertEqual([], misplaced_libraries({"mesh/base/comm.c": "#include <mpi.h>\n"}, LIBRARIES))
        for name in ("mpi.h", "petscksp.h", "p4est_bits.h", "zlib.h", "libdeflate.h", "dlfcn.h", "lapacke.h"):
            self.assertEqual(1, len(misplaced_libraries({"solvers/case/case.c": f"#include <{name}>\n"}, LIBRARIES)), name)

    def test_files_and_ends(self):
        fine = "status f(void) {\n    snprintf(text, 3, \"%d\", 1); /* printf( and abort() */\n    g->open(\"exit(\");\n}\n"
        self.assertEqual(1, len(opens_files({"libcore/a.c": fine})))  # open( is a name that libcore does without
        fine = fine.replace("g->open", "reopen")
        self.assertEqual([], opens_files({"libcore/a.c": fine}) + ends_the_program({"libcore/a.c": fine}))
        for line in ('fopen("f", "w");', "printf(text);", 'getenv("HOME");', "dlopen(path, 0);"):
            self.assertEqual(1, len(opens_files({"libcore/a.c": line})), line)
            self.assertEqual([], opens_files({"solvers/a.c": line}), line)
        self.assertEqual(1, len(opens_files({"libcore/a.c": "#include <stdio.h>\n"})))
        for line in ('fopen("f", "w");', "open(path, O_RDONLY);", "if (rename(a, b)) x();", "(void)unlink(path);"):
            self.assertEqual(1, len(touches_files({"solvers/a.c": line})), line)
            self.assertEqual([], touches_files({FILES: line}), line)
        self.assertEqual([], touches_files({"solvers/a.c": "g->open(1); s.remove(2); sink_open(path); fdopen(file);"}))
        for line in ("abort();", "exit(1);", "assert(x);"):
            self.assertEqual(1, len(ends_the_program({"mesh/a.c": line})), line)

    def test_globals(self):
        fine = """
            struct part { int n; };
            static const int sizes[] = {1, 2}, more = 3;
            static const char *const names[] = {"a", "b;"}, *const others[] = {"c"};
            extern const struct row first, second;
            _Static_assert(1 < 2, "int x;");
            typedef double field[3];
            enum { ROWS = 3, COLUMNS };
            static int counted(int n) { static const int k = 1; int i = 0; return i + k; }
            double declared(double x, int n);
            #define LATER int x;
        """
        self.assertEqual([], mutable_globals({"a.c": fine}, {}))
        for line in ("static int count;", "double x = 1;", 'static const char *name = "a";', "static struct part p;",
                     'static const char *const a = "", *b = "";'):
            self.assertEqual(1, len(mutable_globals({"a.c": fine + line}, {})), line)
        self.assertEqual([], mutable_globals({"a.c": "static volatile int asked;"}, {"a.c": ["asked"]}))

    def test_lengths(self):
        body = "    x++;\n" * 10
        self.assertEqual([], long_functions({"a.c": f"static int f(int x,\n             int y) {{\n{body}}}\n"}, 13))
        self.assertEqual(1, len(long_functions({"a.c": f"static int f(int x,\n             int y) {{\n{body}}}\n"}, 12)))
        self.assertEqual([], long_functions({"a.c": f"int f(void);\nstruct s {{\n{body}}}\n;"}, 5))

    def test_parameters(self):
        for text in ("KERNEL static void f(int a, const double *restrict b) {\n}\n", "status f(int a,\n         double (*b)[N]);\n",
                     "typedef void f(int a, void (*b)(int c));\n"):
            self.assertEqual([], long_lists({"a.c": text}, 2), text)
            self.assertEqual(1, len(long_lists({"a.c": text}, 1)), text)
        for text in ("    f(a, b, c);\n", "/* f(a, b, c) */\n", "#define F(a, b, c) a\n", "static int f(void), a, b;\n"):
            self.assertEqual([], long_lists({"a.c": text}, 2), text)

    def test_heads(self):
        for text in ("/* Reads a .msh file.\n * More. */\n", "/* trees: one tree per tile\n * of a lattice. */",
                     "/* A gas\n * is:\n */"):
            self.assertEqual([], headless({"a.c": text}), text)
        for text in ("", '#include "a.h"\n/* A gas moves. */', "/* A gas moves */", "/* gas.c */", "/* ---- gas ---- */",
                     "// A gas moves.\n", "/* Gas. */"):
            self.assertEqual(["a.c"], headless({"a.c": text}), text)

    def test_licences(self):
        self.assertEqual([], without_licence({"a.c": f"/* {LICENCE} */\n/* Adds. */\n", "b": f"#!/bin/sh\n# b: does this.\n# {LICENCE}\n"}))
        self.assertEqual(["a.c"], without_licence({"a.c": "/* Adds. */\n"}))

    def test_names_and_rows(self):
        one = "/* x */\n#ifndef A_H\n#define A_H\n#endif\n"
        self.assertEqual([], shared_guards({"a.h": one, "b.h": one.replace("A_H", "B_H"), "c.c": ""}))
        self.assertEqual(1, len(shared_guards({"a.h": one, "b.h": one})))
        self.assertEqual(1, len(shared_guards({"a.h": "/* x */\n"})))
        kernel = "KERNEL static void sum(int n) {\n}\n"
        self.assertEqual([], shared_kernels({"a.c": kernel, "b.c": kernel.replace("sum", "sums")}))
        self.assertEqual(1, len(shared_kernels({"a.c": kernel, "b.c": kernel.replace("void ", "double *")})))
        self.assertEqual(1, len(shared_kernels({"a.c": kernel.replace("static ", "")})))
        tag = "struct %s { int n; };\nstruct a *make(void);\n"
        self.assertEqual([], shared_tags({"mesh/a.c": tag % "a", "mesh/b.c": tag % "b", "solvers/a.c": tag % "a"}, ("mesh", "solvers")))
        self.assertEqual([], shared_tags({"mesh/a.c": tag % "a", "mesh/b.c": "/* " + tag % "a" + " */"}, ("mesh",)))
        self.assertEqual(1, len(shared_tags({"mesh/a.c": tag % "a", "mesh/b.h": tag % "a"}, ("mesh",))))
        rows = {"solvers/functions/functions.c": "table[] = {&function_a};",
                "solvers/functions/a.c": "const struct function_type function_a = {\n"}
        self.assertEqual([], forgotten_rows(rows))
        self.assertEqual(1, len(forgotten_rows({**rows, "solvers/functions/b.c": rows["solvers/functions/a.c"].replace(
            "function_a", "function_b")})))


if __name__ == "__main__":
    unittest.main()
