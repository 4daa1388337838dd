# SPDX-License-Identifier: GPL-3.0-or-later
"""What system/setFieldsDict puts into fields: boxes, spheres and cylinders of cells, as OpenFOAM's setFields does."""
import re

import numpy as np

from haff.case.blocks import nested
from haff.case.foam import FormatError
from haff.openfoam import dictionary
from haff.openfoam.report import Refused


def numbers(words, text, place):
    """The numbers that words of a text are. Refused where one is none."""
    for word in words:
        try:
            float(word)
        except (ValueError, TypeError):
            where = text.place_of(word) if isinstance(text, dictionary.Text) and isinstance(word, str) else place
            raise Refused(f"{where}: '{word}': a number was expected") from None
    return np.array([float(word) for word in words])


def listed(text, place):
    return numbers(re.sub("[()]", " ", text).split(), text, place)


def vector(d, *names):
    """The first of some entries as three numbers."""
    for name in names:
        if name in d:
            return listed(d[name], d.place)
    raise Refused(f"{d.place}: '{names[0]}' is missing")


def length(d, *names, default=None):
    """The first of some entries as a number."""
    found = [d[name] for name in names if name in d]
    if not found and default is None:
        raise Refused(f"{d.place}: '{names[0]}' is missing")
    return numbers([found[0].strip()], found[0], d.place)[0] if found else default


def boxes(d, at):
    parts = [d[name] for name in ("box", "boxes") if name in d][:1] or [d[name] for name in ("min", "max") if name in d]
    corners = np.concatenate([np.zeros(0), *(listed(text, d.place) for text in parts)])
    if not len(corners) or len(corners) % 6:
        raise Refused(f"{d.place}: a box has two corners, box (x y z) (x y z)")
    inside = np.zeros(len(at), bool)
    for low, high in corners.reshape(-1, 2, 3):
        inside |= ((at >= low) & (at <= high)).all(axis=1)
    return inside


def sphere(d, at):
    distance = np.linalg.norm(at - vector(d, "origin", "centre"), axis=1)
    return (distance <= length(d, "radius")) & (distance >= length(d, "innerRadius", default=0))


def cylinder(d, at):
    start, end = vector(d, "point1", "p1"), vector(d, "point2", "p2")
    axis = end - start
    along = (at - start) @ axis / (axis @ axis)
    distance = np.linalg.norm(at - start - np.outer(along, axis), axis=1)
    return (along >= 0) & (along <= 1) & (distance <= length(d, "radius", "outerRadius")) & (distance >= length(d, "innerRadius", default=0))


SHAPES = {"boxToCell": boxes, "sphereToCell": sphere, "cylinderToCell": cylinder, "cylinderAnnulusToCell": cylinder}


def assignments(d, name):
    """[(field, value [1] or [3])] of an entry  ( volScalarFieldValue T 300 volVectorFieldValue U (0 0 0) .. )."""
    text = d.get(name, "")
    place, found, words = getattr(text, "place", d.place), [], nested("(" + re.sub(r"^\s*\(|\)\s*$", "", text) + ")")
    words = words[0] if len(words) == 1 and isinstance(words[0], list) else words
    for kind, name, value in zip(words[::3], words[1::3], words[2::3]):
        if not str(kind).startswith("vol") or isinstance(name, list):
            raise Refused(f"{place}: '{kind} {name}': volScalarFieldValue NAME VALUE was expected")
        found.append((name, numbers(value if isinstance(value, list) else [value], text, place)))
    return found


def apply(path, case, fields, centres, report):
    """Sets the fields {name: [cells][components]} in place. Refused where a shape is not known."""
    d = dictionary.read(path, case)
    try:
        set_all(d, fields, centres, report)
    except (LookupError, ValueError, TypeError) as wrong:
        raise wrong if isinstance(wrong, (Refused, FormatError)) else Refused(f"{d.place.split(':')[0]}: it cannot be read ({wrong})") from None


def set_all(d, fields, centres, report):
    lines = lambda of, name: [pair for pair in assignments(of, name) if pair[0] in fields]
    for name, value in lines(d, "defaultFieldValues"):
        fields[name][:] = value
    for kind, body, place in split(d.get("regions", dictionary.Text())):
        if kind not in SHAPES:
            raise Refused(f"{place}: {kind}: of shapes there are {' '.join(SHAPES)} here; run OpenFOAM's setFields in the case, and convert it then")
        own = dictionary.parse(body, place)
        cells = SHAPES[kind](own, centres)
        for name, value in lines(own, "fieldValues"):
            fields[name][cells] = value
        report.took(place, f"{kind}: set in {int(cells.sum())} cells")


def split(text):
    """[(kind, what its braces hold, FILE:LINE of that)] of a Text."""
    file, _, line = text.start.rpartition(":")
    return [(found[1], found[2], f"{file}:{int(line) + text[:found.start(2)].count(chr(10))}")
            for found in re.finditer(r"(\w+)\s*\{((?:[^{}]|\{[^{}]*\})*)\}", text)]
