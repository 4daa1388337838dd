# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenFOAM's dictionaries with their macros, #include, #eval and #calc done; each entry knows its file and line.

    d = dictionary.read("case/system/controlDict")
    d["endTime"], d["endTime"].place            # '4', 'system/controlDict:24'
    d["functions"]["probes"]["fields"]          # '(p U)'

FormatError names file and line. Files of fields are dictionaries, too: their lists of numbers are kept apart, in d.lists, and stand
in the texts as `nonuniform @NUMBER`.
"""
import os
import re

from haff.case import entries, foam
from haff.case.blocks import arithmetic
from haff.case.foam import FormatError

CONSTRAINTS = "caseDicts/setConstraintTypes"  # what it says of patches follows from their types
MACRO = r"\$(?:\{([!:]?[\w./]+)\}|([!:]?\.*\w[\w./]*))"
NONUNIFORM = re.compile(rb"\bnonuniform\s+(?:List<(\w+)>)?")
ETC = os.path.join(os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam"), "etc")


class Text(str):
    """A value with the place of its entry, FILE:LINE, and start: that of its first word."""
    place = start = ""

    def place_of(self, word):
        """FILE:LINE of a word in it."""
        file, _, line = self.start.rpartition(":")
        return f"{file}:{int(line) + self[:max(self.find(word), 0)].count(chr(10))}" if file else self.place


class Dictionary(dict):
    """Entries by their names, in the order of the file; patterns: names that stand in quotes. place: FILE:LINE."""

    def __init__(self, place, lists=None):
        super().__init__()
        self.place, self.patterns, self.lists = place, set(), [] if lists is None else lists

    def matching(self, names):
        """The entry that counts: that of names[0]; else the last one that has another of the names; else the last pattern that fits names[0]; or None."""
        plain = [key for key in self if key in names and key not in self.patterns]
        if names[0] in plain:
            return self[names[0]]
        fits = plain or [key for key in self if key in self.patterns and fullmatch(key, names[0], self.place)]
        return self[fits[-1]] if fits else None

    def text(self, indent=0):
        """As a file has it."""
        lines = []
        for key, value in self.items():
            name, pad = f'"{key}"' if key in self.patterns else key, "    " * indent
            if isinstance(value, Dictionary):
                lines += [f"{pad}{name}", f"{pad}{{", value.text(indent + 1), f"{pad}}}"]
            else:
                lines.append(f"{pad}{name} {value};" if value else f"{pad}{name};")
        return "\n".join(line for line in lines if line)


def number(d, *path, default=None):
    """A number in dictionaries within each other, or the default. FormatError where there is none."""
    here = d
    for name in path:
        here = here.get(name) if isinstance(here, Dictionary) else None
    if here is None and default is not None:
        return default
    if here is None:
        raise FormatError(f"{d.place}: there is no '{'/'.join(path)}'")
    try:
        return float(re.sub(r"\[[^\]]*\]", " ", here).split()[-1])
    except (IndexError, ValueError, TypeError):
        raise FormatError(f"{here.place}: {path[-1]} {here}: a number was expected") from None


def fullmatch(pattern, name, place):
    try:
        return re.fullmatch(pattern, name)
    except re.error as e:
        raise FormatError(f"{place}: \"{pattern}\" is no regular expression ({e})") from None


class Reader:
    """Parses one file into a dictionary; files that it includes go into the same one."""

    def __init__(self, path, shown, text, first=1):
        self.path, self.shown, self.whole, self.first = path, shown, text, first  # first: the number of its first line
        try:
            self.spans = entries.tokens(text)
        except RecursionError:
            raise FormatError(f"{shown}: it cannot be read") from None

    def word(self, i):
        return self.whole[slice(*self.spans[i])]

    def place(self, i):
        return f"{self.shown}:{self.whole.count(chr(10), 0, self.spans[min(i, len(self.spans) - 1)][0]) + self.first}"

    def fill(self, scope, at=0, closed=False):
        """Entries from a token on, into scope[-1]; the token behind the } that ends them."""
        while at < len(self.spans):
            key = self.word(at)
            if key == "}":
                if not closed:
                    raise FormatError(f"{self.place(at)}: '}}' closes nothing")
                return at + 1
            if key.startswith("#"):
                at = self.directive(scope, at)
            elif key == ";":
                at += 1
            elif key == "$" and self.word(at + 1) == "{" and self.word(at + 3) == "}":
                at = self.insert(scope, self.word(at + 2), at, at + 4)
            elif key in "()[]{":
                raise FormatError(f"{self.place(at)}: '{key}' where the name of an entry should be")
            elif at + 1 < len(self.spans) and self.word(at + 1) == "{":
                at = self.dictionary(scope, key, at)
            else:
                at = self.entry(scope, key, at)
        if closed:
            raise FormatError(f"{scope[-1].place}: this dictionary is not closed by '}}'")
        return at

    def dictionary(self, scope, key, at):
        name, here = key.strip('"'), scope[-1]
        inner = here.get(name)
        if not isinstance(inner, Dictionary):
            here.pop(name, None)
            inner = here[name] = Dictionary(self.place(at), here.lists)
        if key.startswith('"'):
            here.patterns.add(name)
        return self.fill([*scope, inner], at + 2, True)

    def entry(self, scope, key, at):
        end = entries.end_of_value(self.whole, self.spans, at + 1)
        if end is None:
            raise FormatError(f"{self.place(at)}: entry '{key}' is not closed by ';'")
        here, name, place = scope[-1], key.strip('"'), self.place(at)
        if key.startswith("$"):
            return self.insert(scope, self.whole[self.spans[at][0]:self.spans[end][0]].strip().strip("$"), at, end + 1)
        raw = self.whole[self.spans[at + 1][0]:self.spans[end - 1][1]] if end > at + 1 else ""
        value = expanded(raw, scope, place)
        if not isinstance(value, Dictionary):
            value = Text(value)
            value.place, value.start = place, self.place(at + 1)
        here.pop(name, None)
        here[name] = value
        if key.startswith('"'):
            here.patterns.add(name)
        return end + 1

    def insert(self, scope, name, at, end):
        """All entries of the dictionary that a macro names."""
        found = lookup(name, scope, self.place(at))
        if not isinstance(found, Dictionary):
            raise FormatError(f"{self.place(at)}: ${name} is no dictionary")
        scope[-1].update(found)
        scope[-1].patterns |= found.patterns
        return end

    def directive(self, scope, at):
        key, place = self.word(at), self.place(at)
        end = self.whole.find("\n", self.spans[at][0])
        rest = self.whole[self.spans[at][1]:end if end >= 0 else len(self.whole)].split("//")[0].strip().strip(";").strip().strip('"')
        if key in ("#include", "#includeIfPresent", "#sinclude", "#includeEtc", "#sincludeEtc"):
            self.include(scope, key, rest, place)
        elif key == "#includeFunc":
            scope[-1][f"#includeFunc {rest}"] = made = Text(rest)
            made.place = place
        elif key == "#remove":
            for name in re.findall(r"[\w.]+", rest):
                scope[-1].pop(name, None)
        elif key != "#inputMode":
            raise FormatError(f"{place}: {key} is not read here; write down what it gives (foamDictionary -expand FILE)")
        start = self.spans[at][0]
        while at < len(self.spans) and (end < 0 or self.spans[at][0] < end) and not (self.word(at) == "}" and self.spans[at][0] > start):
            at += 1
        return at

    def include(self, scope, key, name, place):
        if name == CONSTRAINTS:
            return
        path = os.path.join(ETC if "Etc" in key else os.path.dirname(self.path), name)
        tag = re.match(r"(?:\$FOAM_CASE|<(case|constant|system)>)/(.*)", name)
        if tag:  # from the folder of the case, which holds that of the file
            path = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(self.path))), (tag[1] or "").replace("case", ""), tag[2])
        if not os.path.isfile(path) and not os.path.isfile(path + ".gz"):
            if key in ("#includeIfPresent", "#sinclude", "#sincludeEtc"):
                return
            raise FormatError(f"{place}: {key} \"{name}\": there is no {path}")
        Reader(path, os.path.join(os.path.dirname(self.shown), name), decoded(path)).fill(scope)
        scope[-1].pop("FoamFile", None)


def lookup(name, scope, place):
    """What a macro names: in the dictionary that it stands in, else in those around it; : or ! from the top, . here, .. above."""
    parts = name
    if name[0] in ":!":
        scope, parts = scope[:1], name[1:]
    elif name.startswith("."):
        up = len(name) - len(name.lstrip("."))
        scope, parts = scope[:len(scope) - up + 1][-1:], name.lstrip(".")
    for here in reversed(scope):
        found = here.matching([parts])
        for part in re.split("[./]", parts) if found is None else ():
            found = (here if found is None else found).get(part) if found is None or isinstance(found, Dictionary) else None
            if found is None:
                break
        if found is not None:
            return found
    if parts in os.environ:
        return Text(os.environ[parts])
    raise FormatError(f"{place}: macro '${name}' names no entry that stands before it")


def expanded(text, scope, place):
    """A value with its macros and arithmetic done; the dictionary that a macro alone names."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.S)
    if re.search(r"#(codeStream|\{)", text):
        return text.strip()
    alone = re.fullmatch(MACRO, text.strip())
    if alone:
        return lookup(alone[1] or alone[2], scope, place)

    def macro(found):
        value = lookup(found[1] or found[2], scope, place)
        if isinstance(value, Dictionary):
            raise FormatError(f"{place}: {found[0]} is a dictionary, and stands in a value")
        return value

    def number(found):
        formula = re.sub(MACRO, lambda m: f"({macro(m)})", found[2] if found[1] is None else found[1])
        try:
            return repr(float(arithmetic(formula)))
        except (ValueError, SyntaxError, TypeError, ArithmeticError) as e:  # FormatError is a ValueError
            raise FormatError(f"{place}: {found[0]} cannot be computed here ({e}); write down the number") from None

    text = re.sub(r'#(?:eval|calc)\s*(?:\{((?:[^{}]|\{[^{}]*\})*)\}|"([^"]*)")', number, text)
    return re.sub(MACRO, macro, text).strip()


def decoded(path):
    return foam.read_bytes(path).decode("latin-1")


def shown(path, case):
    return os.path.relpath(path, case) if case else path


def read(path, case=None):
    """The Dictionary of a file; FILE of the places is as seen from case."""
    found = Dictionary(f"{shown(path, case)}:1")
    Reader(path, shown(path, case), decoded(path)).fill([found])
    found.pop("FoamFile", None)
    return found


def parse(text, place):
    """The Dictionary of a text that begins at a place, FILE:LINE or FILE, as of what stands in a list of dictionaries."""
    found = Dictionary(place)
    file, line = re.fullmatch(r"(.*?)(?::(\d+))?", place, re.S).groups()
    Reader(file, file, text, int(line or 1)).fill([found])
    return found


def read_field(path, case=None):
    """The same of a field; lists: arrays [n] or [n][components]."""
    file = foam.FoamFile(path)
    if not file.header.get("class", "").isascii():
        raise FormatError(f"{path}: its header is no text")
    head = bytes(file.data[:len(file.data) - len(file.view)])
    vector = "Vector" in file.header.get("class", "")
    parts, lists, at = [b"\n" * head.count(b"\n")], [], 0
    while found := NONUNIFORM.search(file.view, at):
        kind = (found[1] or (b"vector" if vector else b"scalar")).decode().capitalize().replace("tensor", "Tensor")
        values, end = file.numbers(found.end(), foam.COMPONENTS.get(kind, 1), file.scalar)
        lines = 0 if file.binary else bytes(file.view[found.start():end]).count(b"\n")
        parts += [bytes(file.view[at:found.start()]), b"nonuniform @%d" % len(lists), b"\n" * lines]
        lists.append(values)
        at = end
    made = Dictionary(f"{shown(path, case)}:1", lists)
    Reader(path, shown(path, case), b"".join([*parts, bytes(file.view[at:])]).decode("latin-1")).fill([made])
    return made
