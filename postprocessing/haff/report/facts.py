# SPDX-License-Identifier: GPL-3.0-or-later
"""What was run: models, mesh, warnings and provenance of a case, from its log, its last time and its mesh."""
import collections
import os
import re

from haff.case import entries
from haff.plot import runlog

SECTION = re.compile(r"^(Mesh|Models|Control)\n((?:    .*\n)+)", re.M)
WARNING = re.compile(r"^(accepted warning|warning|note|error): (.*)$", re.M)
ENTRY = re.compile(r'^(\w+)\s+"?(.*?)"?;$', re.M)
NOTHING = re.compile(r"^nothing to do: ", re.M)
SHORT = ("application", "equationOfState", "cooling", "transport", "restitution", "diameter", "thresholdSpeed", "gravity", "grains", "percolation",
         "diffusivity", "fluxScheme", "reconstruct", "polyReconstruct", "timeScheme", "diffusion", "acoustics", "iteration", "closure", "kernel", "window")


class Facts:
    """log: the text of the newest log, "" without; provenance {name: text} of a time, and the dictionaries there as one text."""

    def __init__(self, case, time):
        path = runlog.newest_log(case.path)
        self.log = runlog.read_text(path) if path else ""
        self.log_path = path
        self.provenance, self.dictionaries = provenance(case, time)
        self.sections = {name: body for name, body in SECTION.findall(self.log)}
        self.was = {path[1:]: value for path, value in values_of("dictionaries" + self.dictionaries).items()}
        self.changed = changed_since(case, time, self.was)

    @property
    def models(self):
        """{keyword: value} of the run: from the log, else from the provenance. A log that says "nothing to do" is of no run, but of an edit after it."""
        told = dict(line.split(None, 1) for line in self.sections.get("Models", "").split("\n") if len(line.split(None, 1)) == 2)
        if told and not (NOTHING.search(self.log) and self.provenance):
            return told
        recorded = {path[-1]: value for path, value in self.was.items() if path[0] not in ("controlDict", "fvSchemes")}
        return {**recorded, **{k: v for k, v in self.provenance.items() if k not in ("version", "compiler", "host", "date", "ranks", "meshChecksum", "cells")}}

    def short(self):
        """The models that one wants to see first: [(keyword, value)]."""
        application = re.search(r"^\s*application\s+(\w+)", self.dictionaries, re.M)
        models = {**({"application": application.group(1)} if application else {}), **self.provenance, **self.models}
        return [(k, models[k]) for k in SHORT if models.get(k) not in (None, "", "none", "(0 0 0)")]

    def warnings(self):
        """[(kind, text, how often)] of the log, in their order."""
        return [(kind, text, n) for (kind, text), n in collections.Counter(WARNING.findall(self.log)).items()]

    def mesh(self):
        """Lines of the log about the mesh, but for patches."""
        return [line.strip() for line in self.sections.get("Mesh", "").split("\n") if line.strip() and not line.startswith("    patch ")]


def provenance(case, time):
    """({name: text}, text of the dictionaries) of TIME/uniform/provenance; both empty without it."""
    path = os.path.join(case.path, time, "uniform", "provenance")
    try:
        text = runlog.read_text(path)
    except OSError:
        return {}, ""
    head, _, rest = text.partition("\ndictionaries\n")
    return dict(ENTRY.findall(head.partition("}")[2])), rest


def values_of(text):
    """{path of an entry: its value} of a dictionary; empty where that is none."""
    words = lambda value: " ".join(re.sub(r"([()\[\]])", r" \1 ", value).split())
    try:
        return {e.path: words(text[slice(*e.value)]) for e in entries.parse(text) if not e.is_dictionary and "FoamFile" not in e.path}
    except entries.EntryError:
        return {}


def changed_since(case, time, was):
    """The files of dictionaries that are newer than a time, and hold other entries than the run read: [name]. Includes and macros are not
    followed: where a file has some, it counts as changed when it is newer."""
    try:
        written = os.path.getmtime(os.path.join(case.path, time, "uniform", "provenance"))
    except OSError:
        return []
    found = []
    for name in dict.fromkeys(path[0] for path in was):
        read = {key[1:]: value for key, value in was.items() if key[0] == name}
        for path in (os.path.join(case.path, folder, name) for folder in ("constant", "system")):
            if os.path.isfile(path) and os.path.getmtime(path) > written and differs(runlog.read_text(path), read):
                found.append(os.path.relpath(path, case.path))
    return found


def differs(text, was):
    now = values_of(text)
    same = lambda a, b: a == b or (a is not None and b is not None and number(a) == number(b))
    return any(not same(now.get(k), was.get(k)) for k in now.keys() | was.keys())


def number(word):
    """Its value; of what is no number the word itself, without quotes."""
    try:
        return float(word)
    except ValueError:
        return word.strip('"')


def heading(case):
    """The first heading of the case's README.md; None without."""
    try:
        found = re.search(r"^#\s+(.+)$", runlog.read_text(os.path.join(case.path, "README.md")), re.M)
    except OSError:
        return None
    return found.group(1).replace("`", "") if found else None
