# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries of dictionaries, read and set by their path: the comments and the layout of the file stay.

    entries.get("case/constant/granularProperties", "grain/restitution")            0.97
    entries.edit("case/constant/granularProperties", {"grain/restitution": 0.9, "+grain/thresholdSpeed": 0.1, "cooling": None})

A path is the names of the dictionaries and of the entry, with '/' between them, or a tuple of names (where a name has a '/').
Of two entries of one name the last one counts, as for the solvers. '+' before a path makes the entry where there is none (and
the dictionaries it stands in); None takes an entry or a whole dictionary away; a dictionary as a value stands for the entries in it.
"""
import difflib
import os
import re

import numpy as np

TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"|#\{.*?#\}|[{};]|[()\[\]]|(?:[^\s{}()\[\];"/]|/(?![/*])|(?<=[\w*])\([^\s()]*\))+', re.S)
OPEN, CLOSE = "([{", ")]}"


class EntryError(KeyError):
    """An entry that is not there, or a file that is no dictionary: says the file, and what stands nearest to it."""

    def __str__(self):
        return str(self.args[0])


class Entry:
    """One entry in a text: path (tuple of names), where it starts and ends, and its value; a dictionary's is what its braces hold."""

    def __init__(self, path, start, end, value, is_dictionary):
        self.path, self.start, self.end, self.value, self.is_dictionary = path, start, end, value, is_dictionary


def tokens(text):
    """(start, end) of words, strings and brackets; comments are left out."""
    return [m.span() for m in TOKEN.finditer(text) if not m.group().startswith(("//", "/*"))]


def parse(text, name="the dictionary"):
    """All entries of a text, dictionaries before what they hold. EntryError names the line where it is no dictionary."""
    found, at, inside = [], 0, []
    spans = tokens(text)
    word = lambda i: text[spans[i][0]:spans[i][1]]
    fail = lambda i, why: EntryError(f"{name}:{text.count(chr(10), 0, spans[min(i, len(spans) - 1)][0]) + 1}: {why}")
    while at < len(spans):
        key, start = word(at), spans[at][0]
        if key == "}":
            if not inside:
                raise fail(at, "'}' closes nothing")
            entry = inside.pop()
            entry.end, entry.value = spans[at][1], (entry.value[0], spans[at][0])
            at += 1
        elif key.startswith("#") or key.startswith("$"):
            at = directive(text, spans, at)
        elif key == ";":
            at += 1
        elif key in OPEN + CLOSE:
            raise fail(at, f"'{key}' where the name of an entry should be")
        elif at + 1 < len(spans) and word(at + 1) == "{":
            entry = Entry((*(inside[-1].path if inside else ()), key.strip('"')), start, None, (spans[at + 1][1], None), True)
            found.append(entry)
            inside.append(entry)
            at += 2
        else:
            last = end_of_value(text, spans, at + 1)
            if last is None:
                raise fail(at, f"entry '{key}' is not closed by ';'")
            value = (spans[at + 1][0], spans[last - 1][1]) if last > at + 1 else (spans[last][0], spans[last][0])
            found.append(Entry((*(inside[-1].path if inside else ()), key.strip('"')), start, spans[last][1], value, False))
            at = last + 1
    if inside:
        raise fail(len(spans), f"dictionary '{'/'.join(inside[-1].path)}' is not closed by '}}'")
    return found


def directive(text, spans, at):
    """The first token behind `#remove functions` and the like, which end with their line, or with ';' if they have one."""
    line = text.find("\n", spans[at][0])
    line = len(text) if line < 0 else line
    while at < len(spans) and spans[at][0] < line and text[spans[at][0]] != "}":
        at += 1
    return at


def end_of_value(text, spans, at):
    """The ';' that ends a value."""
    depth = 0
    while at < len(spans):
        token = text[spans[at][0]:spans[at][1]]
        if token == ";" and depth == 0:
            return at
        depth += (token in OPEN) - (token in CLOSE)
        if depth < 0:
            return None
        at += 1
    return None


def names(path):
    return tuple(path) if isinstance(path, tuple) else tuple(str(path).split("/"))


def shown(path):
    return "/".join(path)


def read(path):
    """The text of a dictionary. FileNotFoundError names the nearest file."""
    if not os.path.isfile(path):
        folder = os.path.dirname(path)
        near = difflib.get_close_matches(os.path.basename(path), os.listdir(folder) if os.path.isdir(folder) else [], 1, 0.5)
        raise FileNotFoundError(f"{path} is not there" + (f"; did you mean {near[0]}?" if near else ""))
    with open(path, encoding="latin-1", newline="") as f:
        text = f.read()
    if re.search(r"^\s*format\s+binary\s*;", text[:4096], re.M):
        raise EntryError(f"{path}: a binary file has no entries that can be edited")
    return text


def nearest(found, wanted):
    """What the user may have meant: the same name elsewhere, else the path that reads most alike."""
    paths = [entry.path for entry in found if entry.path[0] != "FoamFile"]
    same = [p for p in paths if p[-1] == wanted[-1]]
    near = difflib.get_close_matches(shown(wanted), [shown(p) for p in paths], 1, 0.4)
    return shown(same[0]) if same else near[0] if near else None


def missing(path, found, wanted):
    near = nearest(found, wanted)
    return EntryError(f"{path}: there is no entry '{shown(wanted)}'; " + (f"did you mean '{near}'? " if near else "")
                      + f"('+{shown(wanted)}' makes it)")


def last(found, wanted):
    """The entry that counts, or None."""
    same = [entry for entry in found if entry.path == wanted]
    return same[-1] if same else None


def value_of(text):
    """A value as Python has it: float, list of floats (nested as the brackets are), or the text itself."""
    try:
        return float(text)
    except ValueError:
        pass
    flat = re.sub(r"\s+", " ", text.strip())
    if re.fullmatch(r"\([-+.\deE() ]*\)", flat):
        try:
            return eval_list(flat)
        except ValueError:
            pass
    return text.strip('"') if re.fullmatch(r'"[^"]*"', text) else text


def eval_list(text):
    stack = [[]]
    for word in re.findall(r"[()]|[^\s()]+", text):
        if word == "(":
            stack.append([])
        elif word == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(float(word))
    return stack[0][0]


def get(path, entry):
    """The value of an entry of a file: float, list of floats, or text; of a dictionary the text in its braces.
    EntryError where there is none; FileNotFoundError."""
    text = read(path)
    found = parse(text, path)
    one = last(found, names(entry))
    if one is None:
        near = nearest(found, names(entry))
        raise EntryError(f"{path}: there is no entry '{shown(names(entry))}'" + (f"; did you mean '{near}'?" if near else ""))
    value = text[slice(*one.value)]
    return value if one.is_dictionary else value_of(value)


def as_text(value):
    """A value of Python as a dictionary has it: yes/no, numbers with all their digits, (lists), texts as they are."""
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (list, tuple, np.ndarray)):
        return "(" + " ".join(as_text(v) for v in value) + ")"
    return str(value)


def flat(changes, above=()):
    """[(path, value)] of nested dictionaries; a '+' anywhere in a path holds for all of it."""
    found = []
    for key, value in changes.items():
        path = (*above, *names(key))
        found += flat(value, path) if isinstance(value, dict) and value else [(path, "" if value == {} else value)]
    return [(tuple(n.lstrip("+") if i else ("+" if any(m.startswith("+") for m in p) else "") + n.lstrip("+") for i, n in enumerate(p)), v)
            for p, v in found]


def edit(path, changes, anywhere=False):
    """Sets entries {path: value} of a file. Nothing is written unless all of them can be.

    anywhere: a path of one name means the first entry of that name at any depth. EntryError, FileNotFoundError.
    """
    text = read(path)
    for wanted, value in flat(changes):
        text = changed(text, path, wanted, value, anywhere)
    with open(path, "w", encoding="latin-1", newline="") as f:
        f.write(text)


def changed(text, path, wanted, value, anywhere=False):
    add, wanted = wanted[0].startswith("+"), (wanted[0].lstrip("+"), *wanted[1:])
    found = parse(text, path)
    one = last(found, wanted)
    if anywhere and len(wanted) == 1:
        one = next((e for e in found if e.path[-1] == wanted[0] and e.path[0] != "FoamFile"), None)
    if one is None and not add:
        raise missing(path, found, wanted)
    if one is None:
        return text if value is None else inserted(text, found, wanted, as_text(value))
    if value is None:
        return without(text, one)
    if not one.is_dictionary:
        start, end = one.value
        space = "" if start < end or text[start - 1:start].isspace() else " "
        return text[:start] + space + as_text(value) + text[end:]
    return text[:one.start] + f"{one.path[-1]} {as_text(value)};" + text[one.end:]


def without(text, entry):
    """The text less an entry, and less its line if nothing else stands there."""
    start, end = entry.start, entry.end
    line = text.rfind("\n", 0, start) + 1
    tail = re.compile(r"[ \t]*(?:\r?\n|$)").match(text, end)
    if not text[line:start].strip() and tail:
        return text[:line] + text[tail.end():]
    return text[:start] + text[end:].lstrip(" \t")


def inserted(text, found, wanted, value):
    """A new entry at the end of the innermost dictionary that is there."""
    depth = next(k for k in range(len(wanted) - 1, -1, -1) if k == 0 or any(e.is_dictionary and e.path == wanted[:k] for e in found))
    new = wanted[depth:]
    entry = "".join(f"{name} {{ " for name in new[:-1]) + f"{quoted(new[-1])} {value};" + " }" * (len(new) - 1)
    if depth == 0:
        return text + ("" if text.endswith("\n") else "\n") + entry + "\n"
    start, close = last([e for e in found if e.is_dictionary], wanted[:depth]).value
    if "\n" not in text[start:close]:
        return text[:close].rstrip(" ") + f" {entry} " + text[close:]
    line = text.rfind("\n", 0, close) + 1
    indent = re.match(r"[ \t]*", text[line:]).group() + "    "
    if text[line:close].strip():  # the brace ends a line of entries
        return text[:close].rstrip(" ") + f" {entry} " + text[close:]
    return text[:line] + indent + entry + "\n" + text[line:]


def quoted(name):
    return f'"{name}"' if re.search(r"[|*()\s]", name) and not re.fullmatch(r"\w+\([^\s()]*\)", name) else name


def edit_case(case, changes):
    """Sets entries of files of a case: {"constant/granularProperties": {"grain/restitution": 0.9}}. All or none: every file is
    tried before the first is written. EntryError, FileNotFoundError."""
    texts = {}
    for file, entries in changes.items():
        path = os.path.join(case, file)
        texts[path] = read(path)
        for wanted, value in flat(entries):
            texts[path] = changed(texts[path], path, wanted, value)
    for path, text in texts.items():
        with open(path, "w", encoding="latin-1", newline="") as f:
            f.write(text)


def drop(path, kind):
    """Removes every function object of a type from a controlDict; how many they were."""
    text, count = read(path), 0
    while True:
        found = parse(text, path)
        one = next((e for e in found if e.path[-1] == "type" and len(e.path) == 3 and e.path[0] == "functions"
                    and text[slice(*e.value)] == kind), None)
        if one is None:
            break
        text, count = without(text, last(found, one.path[:2])), count + 1
    if count:
        with open(path, "w", encoding="latin-1", newline="") as f:
            f.write(text)
    return count
