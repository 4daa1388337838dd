# SPDX-License-Identifier: GPL-3.0-or-later
"""What was run: models, mesh, warnings and provenance of a case, from its log, its last time and its mesh."""
import collections
import os
import re

from haff.plot import runlog

SECTION = re.compile(r"^(Mesh|Models|Control)\n((?:    .*\n)+)", re.M)
WARNING = re.compile(r"^(accepted warning|warning|note|error): (.*)$", re.M)
ENTRY = re.compile(r'^(\w+)\s+"?(.*?)"?;$', re.M)
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

    @property
    def models(self):
        """{keyword: value}, from the log, else from the provenance."""
        told = dict(line.split(None, 1) for line in self.sections.get("Models", "").split("\n") if len(line.split(None, 1)) == 2)
        return told or {k: v for k, v in self.provenance.items() if k not in ("version", "compiler", "host", "date", "ranks", "meshChecksum", "cells")}

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


def heading(case):
    """The first heading of the case's README.md; None without."""
    try:
        found = re.search(r"^#\s+(.+)$", runlog.read_text(os.path.join(case.path, "README.md")), re.M)
    except OSError:
        return None
    return found.group(1).replace("`", "") if found else None
