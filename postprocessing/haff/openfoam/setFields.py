# SPDX-License-Identifier: GPL-3.0-or-later
"""What system/setFieldsDict puts into fields: boxes, spheres and cylinders of cells, as OpenFOAM's setFields does."""
import re

import numpy as np

from haff.case.blocks import nested
from haff.case.foam import FormatError
from haff.openfoam import dictionary
from haff.openfoam.report import Refused


def vector(d, *names):
    """The first of some entries as three numbers."""
    for name in names:
        if name in d:
            return np.array([float(x) for x in re.sub("[()]", " ", d[name]).split()])
    raise Refused(f"{d.place}: '{names[0]}' is missing")


def boxes(d, at):
    text = d.get("box") or d.get("boxes") or f"{d.get('min', '')} {d.get('max', '')}"
    corners = np.array([float(x) for x in re.sub("[()]", " ", text).split()])
    if not len(corners) or len(corners) % 6:
        raise Refused(f"{d.place}: a box has two corners, box (x y z) (x y z)")
    inside = np.zeros(len(at), bool)
    for low, high in corners.reshape(-1, 2, 3):
        inside |= ((at >= low) & (at <= high)).all(axis=1)
    return inside


def sphere(d, at):
    distance = np.linalg.norm(at - vector(d, "origin", "centre"), axis=1)
    return (distance <= float(d["radius"])) & (distance >= float(d.get("innerRadius", 0)))


def cylinder(d, at):
    start, end = vector(d, "point1", "p1"), vector(d, "point2", "p2")
    axis = end - start
    along = (at - start) @ axis / (axis @ axis)
    distance = np.linalg.norm(at - start - np.outer(along, axis), axis=1)
    radius = float(d["radius"]) if "radius" in d else float(d["outerRadius"])
    return (along >= 0) & (along <= 1) & (distance <= radius) & (distance >= float(d.get("innerRadius", 0)))


SHAPES = {"boxToCell": boxes, "sphereToCell": sphere, "cylinderToCell": cylinder, "cylinderAnnulusToCell": cylinder}


def assignments(text, place):
    """[(field, value [1] or [3])] of a list  volScalarFieldValue T 300 volVectorFieldValue U (0 0 0) .."""
    found, words = [], nested(f"({text})")
    words = words[0] if len(words) == 1 and isinstance(words[0], list) else words
    for kind, name, value in zip(words[::3], words[1::3], words[2::3]):
        if not str(kind).startswith("vol") or isinstance(name, list):
            raise Refused(f"{place}: '{kind} {name}': volScalarFieldValue NAME VALUE was expected")
        found.append((name, np.array(value if isinstance(value, list) else [value], float)))
    return found


def apply(path, case, fields, centres, report):
    """Sets the fields {name: [cells][components]} in place. Refused where a shape is not known."""
    d = dictionary.read(path, case)
    try:
        set_all(d, fields, centres, report)
    except (LookupError, ValueError, TypeError) as wrong:
        raise wrong if isinstance(wrong, (Refused, FormatError)) else Refused(f"{d.place.split(':')[0]}: it cannot be read ({wrong})") from None


def set_all(d, fields, centres, report):
    lines = lambda text, where: [pair for pair in assignments(text, where) if pair[0] in fields]
    for name, value in lines(re.sub(r"^\s*\(|\)\s*$", "", d.get("defaultFieldValues", "")), d.place):
        fields[name][:] = value
    inside = re.fullmatch(r"\s*\d*\s*\((.*)\)\s*", d.get("regions", "()"), re.S)
    regions = split(inside[1]) if inside else []
    place = getattr(d.get("regions"), "place", d.place)
    for kind, body in regions:
        if kind not in SHAPES:
            raise Refused(f"{place}: {kind}: of shapes there are {' '.join(SHAPES)} here; run OpenFOAM's setFields in the case, and convert it then")
        own = dictionary.parse(body, place)
        cells = SHAPES[kind](own, centres)
        for name, value in lines(re.sub(r"^\s*\(|\)\s*$", "", own.get("fieldValues", "")), place):
            fields[name][cells] = value
        report.took(place, f"{kind}: set in {int(cells.sum())} cells")


def split(text):
    """[(kind, what its braces hold)]."""
    found = re.findall(r"(\w+)\s*\{((?:[^{}]|\{[^{}]*\})*)\}", text)
    return found
