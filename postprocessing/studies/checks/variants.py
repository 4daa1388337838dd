# SPDX-License-Identifier: GPL-3.0-or-later
"""Variants: shipped cases with other entries or on another grid, and what they give.

expected.json of a case lists them under `variants`. Each has a name; changes ({file: {entry: value}}) and mesh ({number of mesh.geo:
value}), both as haff.run takes them; seconds of processor time in user mode; full, its entries; optional short (true: a test of CTest runs it, too),
named (true: Allcheck runs it only where it or its case is named: a costly point of a table whose others show the same) and
ends (the exit code of a run that must not reach its end: 2 after an inelastic collapse).

An entry is one of runs/expected.py. Where it has no value, the value is what was last written down, `measured`. A list as field, time or
at makes it an entry for each of them, with lists of value and measured. `./Allcheck -record` writes measured, to a tenth of the tolerance.
"""
import itertools
import json
import math
import os
import re

from haff.case import entries as dictionary
from haff.runs import expected

LISTS = ("field", "time", "at")  # keys that may have a list
KEYS = {"name", "changes", "mesh", "seconds", "short", "named", "ends", "full"}


def spread(entry):
    """The entries that one with lists stands for."""
    lists = {key: entry[key] for key in LISTS if isinstance(entry.get(key), list)}
    rows = []
    for n, chosen in enumerate(itertools.product(*lists.values())):
        one = {**entry, **dict(zip(lists, chosen))}
        one.update((key, one[key][n]) for key in ("value", "measured") if isinstance(one.get(key), list))
        rows.append(one)
    return rows


def load(path):
    """The variants of a case, in order. ValueError says what is wrong in which of them."""
    found, file, names = expected.read(path).get("variants", []), os.path.join(path, "expected.json"), set()
    for n, variant in enumerate(found, 1):
        name = variant.get("name", "")
        if not re.fullmatch(r"[-+.,=\w]+", name) or name in names:
            raise ValueError(f"{file}: variant {n} needs a name of its own, of letters, digits and -+.,=_; it has '{name}'")
        names.add(name)
        unknown = sorted(variant.keys() - KEYS)
        if unknown:
            raise ValueError(f"{file}: variant {name} has an unknown '{unknown[0]}'; known are {', '.join(sorted(KEYS))}")
        expected.refuse(variant.get("full"), f"{file}: variant {name}: ", "full", ("quantity", "tolerance"))
    return found


def entries(variant):
    """Its entries, each of one field and time, with a value; `own`: that is what was written down, or nan."""
    rows = [one for entry in variant["full"] for one in spread(entry)]
    return [one if "value" in one else {**one, "value": one.get("measured", math.nan), "own": True} for one in rows]


def changes(variant, case):
    """Its changes, without the VTK files of the case, which nothing here reads."""
    found, control = dict(variant.get("changes", {})), "system/controlDict"
    if any(entry.path == ("functions", "vtk") for entry in dictionary.parse(dictionary.read(os.path.join(case, control)))):
        found[control] = {**found.get(control, {}), "functions/vtk": None}
    return found


def rounded(value, tolerance):
    """To a tenth of the tolerance or less."""
    return float(f"{value:.{max(0, 1 + math.ceil(-math.log10(tolerance)))}f}")


def spent(seconds):
    """Processor time as it is written down: two digits."""
    value = float(f"{seconds:.2g}")
    return int(value) if value >= 10 else value


def write_down(path, name, values, seconds=None):
    """The values of all entries of a variant into expected.json, and the seconds of a run of its own. An entry of which one is nan stays."""
    known, values = expected.read(path), iter(values)
    variant = next(v for v in known["variants"] if v["name"] == name)
    for entry in variant["full"]:
        new = [rounded(next(values), entry["tolerance"]) for _ in spread(entry)]
        if all(v == v for v in new):
            entry["measured"] = new if any(isinstance(entry.get(key), list) for key in LISTS) else new[0]
    if seconds is not None:
        variant["seconds"] = spent(seconds)
        variant["full"] = variant.pop("full")  # stays the last
    expected.save(path, known)


def digest(variant):
    """What its run depends on beside the case, as bytes; none, if that is nothing: then it is the run of the case."""
    return b"" if not variant.get("changes") and not variant.get("mesh") else json.dumps([variant.get("changes"), variant.get("mesh")], sort_keys=True).encode()
