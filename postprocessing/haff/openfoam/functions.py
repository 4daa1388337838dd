# SPDX-License-Identifier: GPL-3.0-or-later
"""Function objects of controlDict: those of haff's types stay, less what haff does not read of them; checkCase has the last word."""
import os
import re

from haff.openfoam import dictionary

TYPES = ("probes", "sets", "fieldMinMax", "volFieldValue", "fieldAverage", "forces", "forceCoeffs", "surfaceFieldValue", "writeObjects", "surfaces")
FIELDS = ("rho", "U", "T", "p", "Ma", "phi")
ALSO = {"MachNo": "Ma", "vorticity": "vorticity"}  # types that are fields of writeObjects
TRIES = 40


def found_in(case, control, report):
    """{name: Dictionary} of the types that haff has. What is not taken is said."""
    listed = control.get("functions")
    kept = {}
    if isinstance(listed, str):
        inside = re.fullmatch(r"\s*\d*\s*\((.*)\)\s*", listed, re.S)
        listed = dictionary.parse(inside[1], listed.place) if inside else None
    for name, d in (listed or {}).items():
        if name.startswith("#includeFunc"):
            name, d = included(case, str(d), d.place, report)
        if not isinstance(d, dictionary.Dictionary):
            continue
        kind = str(d.get("type", ""))
        if kind in ALSO:
            d = field_object(d, ALSO[kind])
            report.changed(d.place, f"functions/{name}: type {kind} -> writeObjects of {ALSO[kind]}")
        elif kind not in TYPES:
            report.dropped(d.place, f"functions/{name}: haff has no function object of type {kind or 'none'} (granularGas -listModels lists them)")
            continue
        kept[name] = trimmed(name, d, report)
    return {name: d for name, d in kept.items() if d is not None}


def included(case, name, place, report):
    """What #includeFunc NAME stands for, from system/NAME of the case."""
    path = os.path.join(case, "system", name)
    if re.fullmatch(r"\w+", name) and os.path.exists(path):
        d = dictionary.read(path, case)
        return name, d if "type" in d else next((v for v in d.values() if isinstance(v, dictionary.Dictionary)), d)
    if name in ALSO:
        d = dictionary.Dictionary(place)
        d["type"] = name
        return name, d
    report.dropped(place, f"#includeFunc {name}: OpenFOAM's template is not read; write the function object down (granularGas -keywords functions)")
    return name, None


def field_object(d, field):
    made = dictionary.Dictionary(d.place)
    made.update({"type": "writeObjects", "objects": f"({field})", "writeControl": "writeTime"})
    return made


def trimmed(name, d, report):
    """Without fields that a gas of haff has not; None where none is left."""
    if not isinstance(d.get("fields"), str) or d.get("type") == "fieldAverage":
        return d
    words = re.findall(r"[\w.()]+", re.sub(r"^\s*\d*\s*\(|\)\s*$", "", d["fields"]))
    left = [w for w in words if w in FIELDS]
    if left != words:
        report.dropped(d["fields"].place, f"functions/{name}: fields {' '.join(w for w in words if w not in left)}: haff has {' '.join(FIELDS)}")
    if not left:
        return None
    d["fields"] = f"({' '.join(left)})"
    if "T" in left:
        report.changed(d.place, f"functions/{name}: T is R times kelvin now")
    return d


def blamed(message, text, kept):
    """(name of the function object, key or None) that an error about controlDict is about, or None."""
    line = re.search(r"controlDict:(\d+)", message)
    if not line:
        return None
    above = text.split("\n")[:int(line[1])]
    start = max((k for k, row in enumerate(above) if row.strip() == "functions"), default=None)
    names = [row.strip() for row in above[start + 1:] if re.fullmatch(r"    [^\s{}]+", row)] if start is not None else []
    key = re.search(r"key '([^']+)'|'([^']+)' is not used", message)
    name = next((n for n in reversed(names) if n in kept), None)
    return (name, key and (key[1] or key[2])) if name else None


def text_of(kept):
    d = dictionary.Dictionary("")
    d.update(kept)
    return "functions\n{\n" + d.text(1) + ("\n" if kept else "") + "}\n"
