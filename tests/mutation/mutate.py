#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws small mistakes ("mutants") in given files, builds each, runs the nearest tests, and prints which test sees it.

    tests/mutation/mutate.py -count 8 -seed 1 libcore/acoustics            eight mutants of a folder
    tests/mutation/mutate.py -count 8 -seed 1 -list libcore/acoustics      shows mutants and tests, runs nothing
    tests/mutation/mutate.py -seed 1 -pick 3,7 -tests 20 libcore/acoustics     two of them, with more tests

Files are *.c and *.py of the given files and folders, as git has committed them. A mutant is one change of one line, never in a
comment, a text, a message, an assertion or a row of help. Mutants are made in a work tree of their own, build/mutation/tree; one
build folder serves all of them. README.md says which tests are near to a file, and lists what was found.
"""
import argparse
import ast
import collections
import fcntl
import io
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time
import tokenize

Mutant = collections.namedtuple("Mutant", "path start end new operator")  # text[start:end] becomes new
HERE = pathlib.Path(__file__).resolve().parent
SWAPS = {"relation": {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="},
         "sign": {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/="},
         "logic": {"&&": "||", "||": "&&", "and": "or", "or": "and"},
         "extreme": {"fmin": "fmax", "fmax": "fmin", "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum"}}
WORDS = r"(?<= )(?:<=?|>=?|==|!=|[-+*]=?|/|&&|\|\||and|or)(?= )|\b(?:fmin|fmax|min|max|minimum|maximum)(?=\()"
COMMENT, TEXT = r"/\*.*?\*/|//[^\n]*", r'"((?:\\.|[^"\\\n])*)"'
ARGUMENT, WORD = r"(?:[\w.]|->|\[\w+\])+", r"[A-Za-z]\w\w+"
IF = r"\bif \(((?:[^()\n]|\((?:[^()\n]|\([^()\n]*\))*\))+)\)", r"^ *(?:el)?if (.+):[ ]*$"  # in C, in Python: the condition
FOR = r"\bfor \([^;\n]*= ?(?:0|\w+)();[^;\n]* <=? [^;\n]+?();", r"\brange\(()[\w.\[\]]+()\)"  # behind the start and the end of a loop
FAR = tuple(f"tests/{folder}/" for folder in ("docs", "structure", "install", "mutation", "fuzz", "parity", "stress"))


def blank(text, spans):
    """The text with spaces in the place of spans, so that offsets stay."""
    for start, end in spans:
        text = text[:start] + re.sub(r"[^\n]", " ", text[start:end]) + text[end:]
    return text


def bare_c(text):
    """A C source without comments, texts, lines of the preprocessor, and statements or rows with a message or an assertion."""
    spans = [m.span() for m in re.finditer(rf"{COMMENT}|{TEXT}|'(?:\\.|[^'\\\n])+'", text, re.DOTALL)]
    spans += [m.span() for m in re.finditer(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", text, re.MULTILINE)]
    code = blank(text, spans)
    silent = blank(text, [span for span in spans if text[span[0]] == "/"])
    return blank(code, [m.span() for m in re.finditer(r"[^;{}]+", code) if "assert" in m.group()
                        or any(re.search("[ %]", said) for said in re.findall(TEXT, silent[slice(*m.span())]))])


def bare_python(text):
    """A Python source without comments, texts, and statements that raise, assert, import, print or make options."""
    starts = [0, *(m.end() for m in re.finditer("\n", text)), len(text)]
    spans = [(starts[t.start[0] - 1] + t.start[1], starts[t.end[0] - 1] + t.end[1])
             for t in tokenize.generate_tokens(io.StringIO(text).readline) if t.type in (tokenize.COMMENT, tokenize.STRING)]
    for node in ast.walk(ast.parse(text)):
        called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
        if isinstance(node, (ast.Raise, ast.Assert, ast.Import, ast.ImportFrom)) or re.search("add_argument|print|parser|isinstance", called):
            spans.append((starts[node.lineno - 1], starts[node.end_lineno]))
    return blank(text, spans)


def statements(code, python):
    """(start, end) of assignments and calls that stand on a line of their own."""
    form = rf"^ +(?!\w*free\b|return|yield|del |if|for|while|else|case)((?:[\w.\->\[\]()*, ]+ [-+*/|&]?= .+|[\w.\->]+\(.*\)){'' if python else ';'})[ ]*$"
    for m in re.finditer(form, code, re.MULTILINE):
        before = code[:m.start()].rstrip().rsplit("\n", 1)[-1].strip()
        whole = all(m.group(1).count(a) == m.group(1).count(b) for a, b in ("()", "[]"))
        begins = not before.endswith((",", "(", "[", "{", "\\")) if python else re.search(r"[;{}]$|^(if|for|while|else)\b.*\)$|^else$", before)
        if whole and begins and (python or not re.match(r"[\w ]+ \**\w+(\[[^]]*\])* ?$", m.group(1).split("=")[0])):  # no declaration
            yield m.span(1)


def changes(code, python):
    """(start, end, new text, operator) of every change of a bare source."""
    for m in re.finditer(WORDS, code):
        for operator, table in SWAPS.items():
            if m.group() in table:
                yield *m.span(), table[m.group()], operator
    for m in re.finditer(r"(?<![\w.\[])(?:(\d+)|\d+\.?\d*(?:e-?\d+)?)(?![\w.])", code):
        number = m.group(1)
        yield *m.span(), f"({number} + 1)" if number else f"(2 * {m.group()})", "constant"
        if number and int(number):
            yield *m.span(), f"({number} - 1)", "constant"
    yield from ((*m.span(1), "not ({})" if python else "!({})", "condition") for m in re.finditer(IF[python], code, re.MULTILINE))
    yield from ((*span, "pass" if python else ";", "dropped") for span in statements(code, python))
    for m in re.finditer(FOR[python], code):
        yield from ((m.start(1), m.start(1), "1, " if python else " + 1", "loop"), (m.start(2), m.start(2), " - 1", "loop"))
    for m in re.finditer(rf"(?<=[\w)])[(\[](?:[^()\n]*, )?({ARGUMENT}), ({ARGUMENT})(?=[,)\]])", code):
        line = code[code.rfind("\n", 0, m.start()) + 1:m.start()]
        if line[:1] == " " and not line.lstrip().startswith("def ") and m.group(1) != m.group(2):
            yield m.start(1), m.end(2), f"{m.group(2)}, {m.group(1)}", "arguments"


def draw(texts, seed):
    """All mutants of {path: text}, in the order in which they are drawn: first an operator, then a place; one a line."""
    kinds, taken, rng = collections.defaultdict(list), set(), random.Random(seed)
    for path, text in sorted(texts.items()):
        python = path.endswith(".py")
        for start, end, new, operator in changes(bare_python(text) if python else bare_c(text), python):
            kinds[operator].append(Mutant(path, start, end, new.replace("{}", text[start:end]), operator))
    while kinds:
        operator = rng.choice(sorted(kinds))
        mutant = kinds[operator].pop(rng.randrange(len(kinds[operator])))
        if not kinds[operator]:
            del kinds[operator]
        place = mutant.path, texts[mutant.path].count("\n", 0, mutant.start)
        if place not in taken:
            taken.add(place)
            yield mutant


def nearest(path, text, tests, count):
    """The tests of {path: text} that are nearest to a file: in C all that mirror its folder, and `count` more, by names of the file and
    its folder in the test's path, and by rare words that both hold. A test in Python can know only the words in quotes of a C file; one in
    C must include a header of a folder of that name."""
    folder, stem, python = os.path.dirname(path), os.path.splitext(os.path.basename(path))[0], path.endswith(".py")
    words, quoted = set(re.findall(WORD, text)), set(re.findall(WORD, " ".join(re.findall(TEXT, text))))
    names = [name.lower() for name in (*stem.split("_"), os.path.basename(folder)) if len(name) > 3]
    included = rf'"[^"]*\b{os.path.basename(folder)}/'
    eligible = lambda test: test.endswith(".py") and (python or not test.startswith("tests/postprocessing/")) or (
        test.endswith(".c") and not python and re.search(included, tests[test]))
    near = {test: set(re.findall(WORD, body)) for test, body in tests.items() if eligible(test) and not test.startswith(FAR)}
    common = collections.Counter(word for body in near.values() for word in body)
    score = {test: sum(1 / common[word] for word in (words if python == test.endswith(".py") else quoted) & body)
             + 3 * sum(name in test.lower() for name in names) for test, body in near.items()}
    ranked = sorted(score, key=lambda test: (-score[test], test))
    mirrors = [test for test in ranked if os.path.dirname(test) == "tests/" + folder and not python]
    return mirrors + [test for test in ranked if test not in mirrors][:count]


def said(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Tree:
    """A work tree with a build folder, in which mutants are made and tested."""

    def __init__(self, top, build):
        self.top, self.path, self.build = top, top / "build/mutation/tree", top / "build/mutation/tree/build"
        self.seconds, self.sound, self.objects = {}, {}, {}  # of a test; does it pass on the code as it is; object code of a file
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.lock = open(self.path.parent / "lock", "w")
        fcntl.flock(self.lock, fcntl.LOCK_EX)  # one run at a time; another one waits
        if self.path.is_dir():
            said("git", "-C", self.path, "checkout", "-qf", "--detach", said("git", "-C", top, "rev-parse", "HEAD").strip())
        else:
            said("git", "-C", top, "worktree", "prune")
            said("git", "-C", top, "worktree", "add", "-q", "--detach", self.path)
        cache = top / "build/CMakeCache.txt"  # what the user's own build was configured with
        chosen = re.findall(r"^(CMAKE_(?:BUILD_TYPE|C_FLAGS|C_COMPILER|C_COMPILER_LAUNCHER)):\w+=(.+)$",
                            cache.read_text() if cache.is_file() else "", re.MULTILINE)
        said("cmake", "-S", self.path, "-B", self.build, *(f"-D{key}={value}" for key, value in chosen))
        if build:  # CTest knows the command of a test only if its program is there
            said("cmake", "--build", self.build, "--parallel", "2")
        self.programs = (re.findall(r"set\(PROGRAMS ([^)]*)\)", self.text("CMakeLists.txt")) or [""])[0].split()
        self.tests = {test["name"]: test for test in json.loads(said("ctest", "--test-dir", self.build, "--show-only=json-v1"))["tests"]}
        self.names = collections.defaultdict(list)  # names of the tests of a source
        for name in self.tests:
            self.names[self.source(name)].append(name)
        self.texts = {source: self.whole(source) for source in self.names if (self.path / source).is_file()}

    def text(self, path):
        return (self.path / path).read_text()

    def whole(self, path):
        """The text of a test with those headers of tests that it includes."""
        return "\n".join([self.text(path), *(self.whole(name) for name in re.findall(r'#include "(tests/[^"]+)"', self.text(path)))])

    def source(self, name):
        """The source of a test: the file that its command names, or the one that its name tells."""
        last = self.tests[name].get("command", [""])[-1]
        return os.path.relpath(last, self.path) if last.endswith(".py") else "tests/" + re.sub(r"(mpi_.*)_\d$", r"\1", name) + ".c"

    def make(self, name):
        """Builds what a test needs; did the compiler take the code, also without a pointer in the place of a number?"""
        bins = [os.path.basename(word) for word in self.tests[name]["command"] if word.startswith(f"{self.build}/")]
        done = subprocess.run(["cmake", "--build", self.build, "--target", *(bins or self.programs or ["all"])],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        return done.returncode == 0 and not re.search("incompatible pointer type|integer from pointer|pointer from integer", done.stdout)

    def run(self, name, limit):
        """Runs a test for `limit` seconds at most: None if it passes or is skipped, or what of it failed."""
        properties = {p["name"]: p["value"] for p in self.tests[name]["properties"]}
        env = {"PYTHONPATH": str(self.path / "postprocessing"), **dict(entry.split("=", 1) for entry in properties.get("ENVIRONMENT", []))}
        command = [word if word != "tests.run" else "unittest" for word in self.tests[name]["command"]]
        command[3:3] = ["-f"] if "unittest" in command else []  # stops at the first failure
        with tempfile.TemporaryDirectory(prefix="m", ignore_cleanup_errors=True) as scratch, tempfile.TemporaryFile("w+", errors="replace") as log:
            code = subprocess.run(["timeout", "-k", "9", str(limit), *command], cwd=properties["WORKING_DIRECTORY"],
                                  env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "TMPDIR": scratch, **env}, stdout=log, stderr=log, check=False).returncode
            log.seek(0)
            words = log.read()
        if code in (0, properties.get("SKIP_RETURN_CODE", 0)):
            return None
        found = re.findall(r"^(?:FAIL|ERROR): (\w+)|^\[  FAILED  \] ([a-z]\w+)", words, re.MULTILINE) or re.findall(
            r"^\[ RUN +\] (\w+)()", words, re.MULTILINE)[-1:]
        return name + (": " + "".join(found[0]) if found else "") + (" (does not end)" if code in (124, 137) else "")

    def near(self, path, options):
        """The tests of a file: those of its nearest sources, on one and two ranks, and those that `-also` names."""
        header = f'"{path.removesuffix(".c")}.h"'  # a file's words are also those of files of its folder that include its header
        texts = [self.text(path), *(text for text in map(self.text, (self.path / path).parent.glob("*.c")) if header in text)]
        names = [name for source in nearest(path, "\n".join(texts), self.texts, options.tests) for name in self.names[source]]
        return [name for name in names if not re.search(r"mpi_.*_4$", name)] + [
            name for name in self.tests if options.also and re.search(options.also, name) and name not in names]

    def passes(self, path, text, name, limit):
        if name not in self.sound:
            (self.path / path).write_text(text)
            self.sound[name] = self.make(name) and self.run(name, limit) is None
        return self.sound[name]

    def judge(self, mutant, names, limit):
        """What becomes of a mutant: the first of the tests, cheapest first, that fails with it and passes without, or another end."""
        text, python = self.text(mutant.path), mutant.path.endswith(".py")
        changed = text[:mutant.start] + mutant.new + text[mutant.end:]
        known, before = reason_of(mutant, text, changed), self.objects.setdefault(mutant.path, self.object(mutant.path))
        if known:
            return f"equivalent: {known}"
        try:
            if python:
                compile(changed, mutant.path, "exec")
            sound = [name for name in names if self.sound.get(name, True)]
            for name in sorted(sound, key=lambda name: self.seconds.get(name, 9 if "tests.run" in self.tests[name]["command"] else 3 if name[-2:] == "_2" else 1)):
                (self.path / mutant.path).write_text(changed)
                if not python and not self.make(name):
                    return "does not build"
                if before and self.object(mutant.path) == before:
                    return "equivalent: the same object code"
                begin, failed = time.time(), self.run(name, limit)
                self.seconds[name] = time.time() - begin
                if failed and self.passes(mutant.path, text, name, limit):
                    return failed
            return f"**survives** {sum(self.sound.get(name, True) for name in sound)} tests"
        except SyntaxError:
            return "does not build"
        finally:
            (self.path / mutant.path).write_text(text)

    def object(self, path):
        return [found.read_bytes() for found in self.build.glob(f"CMakeFiles/*/{path}.o")]


def reason_of(mutant, text, changed):
    """Why no test can see a mutant, if equivalent.txt says so: file, line, line of the mutant, reason, with tabs between."""
    rows = [line.split("\t") for line in (HERE / "equivalent.txt").read_text().split("\n")]
    wanted = [mutant.path, *(lines.split("\n")[text.count("\n", 0, mutant.start)].strip() for lines in (text, changed))]
    return next((row[3] for row in rows if row[:3] == wanted), None)


def shown(text, mutant):
    around = text[max(0, mutant.start - 24):mutant.start].split("\n")[-1].lstrip(), text[mutant.end:mutant.end + 24].split("\n")[0].rstrip()
    change = f"`{text[mutant.start:mutant.end].join(around)}` -> `{mutant.new.join(around)}`".replace("|", "\\|")
    return f"{mutant.path}:{1 + text.count(chr(10), 0, mutant.start)} | {mutant.operator}: {change}"


def main(words):
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, add_help=False, allow_abbrev=False)
    made.add_argument("-help", "-h", "--help", action="help", help="this text")
    for name, default, text in (("-count", 8, "so many mutants that build (8)"), ("-seed", 1, "the same seed draws the same mutants (1)"),
                                ("-pick", "", "only these numbers of the table, say 3,7"), ("-tests", 8, "so many sources of tests beside the mirrors (8)"),
                                ("-also", "", "further tests of CTest, a regular expression, say stress/implicit"),
                                ("-limit", 60, "a test that takes longer has failed (60 s); one that does so without a mutant is left out")):
        made.add_argument(name, type=type(default), default=default, metavar="X", help=text)
    made.add_argument("-list", action="store_true", help="show mutants and their tests, and run nothing")
    made.add_argument("-keep", action="store_true", help="leave the work tree to the next run, which then need not build it")
    made.add_argument("files", nargs="+", help="files and folders, as git names them")
    options = made.parse_args(words)
    tree, left = Tree(HERE.parent.parent, not options.list), options.count
    paths = said("git", "-C", tree.path, "ls-files", *options.files).split()
    texts = {path: tree.text(path) for path in paths if path.endswith((".c", ".py"))}
    picked = [int(number) for number in options.pick.split(",") if number]
    print("| # | place | change | killed by | s |\n|---|---|---|---|---|")
    for number, mutant in enumerate(draw(texts, options.seed), 1):
        if number > max(picked) if picked else not left:
            break
        if not picked or number in picked:
            names, begin = tree.near(mutant.path, options), time.time()
            result = ", ".join(names) if options.list else tree.judge(mutant, names, options.limit)
            left -= result != "does not build"
            print(f"| {number} | {shown(texts[mutant.path], mutant)} | {result} | {time.time() - begin:.0f} |", flush=True)
    if not options.keep:
        said("git", "-C", tree.top, "worktree", "remove", "--force", tree.path)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except subprocess.CalledProcessError as error:
        sys.exit(f"{error}\n{error.stderr.strip()}")
