# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of a case as what a picture shows: one number for each cell, its name with its unit, its colours.

    names = quantity.fields(case, "0.5")               {name: (components, exponents of mass, length, time)} of all fields there
    q = quantity.read(case, "U", "0.5")                q.values [cells], q.label, q.colours, q.signed
    q = quantity.read(case, "U.x", "0.5")              the same as component="x"
"""
import dataclasses
import difflib
import gzip
import os
import re
import zlib

import numpy as np

from haff.case.foam import FormatError, text_numbers
from haff.plot import labels

MAIN = (("alpha", "rho"), ("U",), ("T",), ("p",))  # shown by default: the first of each group that the case has
KINDS = {"Scalar": 1, "Vector": 3, "SymmTensor": 6}
PARTS = {1: (), 3: ("x", "y", "z"), 6: ("xx", "xy", "xz", "yy", "yz", "zz")}
GRAINS = "grains"
HEAD = 4096  # bytes within which header and dimensions lie


class CannotDraw(Exception):
    """Says what is missing in a case and how that is cured."""


@dataclasses.dataclass
class Quantity:
    """values [cells] of a field, or of a component of it; part: "", x, y, z, mag, xx .."""
    name: str
    part: str
    dimensions: tuple
    values: np.ndarray
    units: dict

    @property
    def symbol(self):
        text = labels.NAMES.get(self.name, ("", self.name, ""))[1]
        if not self.part:
            return text
        inner = text[1:-1] if text.startswith("$") else rf"\mathrm{{{text}}}"
        return f"$|{inner}|$" if self.part == "mag" else f"${inner}_{{{self.part}}}$"

    @property
    def label(self):
        about = {"U": "speed"}.get(self.name) if self.part == "mag" else labels.NAMES.get(self.name, ("", "", ""))[0]
        text = self.symbol if not about or about == self.symbol else f"{about} {self.symbol}"
        return labels.with_unit(text, self.dimensions, self.units)

    @property
    def signed(self):
        """Of both signs to such a degree that zero matters."""
        low, high = limits(self.values)
        return low < 0 < high and min(-low, high) > 0.05 * max(-low, high)

    def colours(self, span=None):
        """A map of colours: diverging where the span has both signs."""
        low, high = span or limits(self.values)
        if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
            return labels.SIGNED
        return labels.NAMES.get(self.name, ("", "", "viridis"))[2]


def limits(values):
    """The least and the largest of the numbers that are finite; 0, 0 without any."""
    finite = values[np.isfinite(values)] if not np.isfinite(np.sum(values)) else values
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)


def head(path):
    """Header and the beginning of the body of a file of OpenFOAM's, plain or .gz; '' where that cannot be read."""
    opened = gzip.open if path.endswith(".gz") else open
    try:
        with opened(path, "rb") as f:
            return f.read(HEAD).decode("latin-1")
    except (OSError, EOFError, zlib.error):
        return ""


def fields(case, time):
    """{name: (components, (mass, length, time))} of the fields on cells in the folder of a time."""
    found = {}
    folder = os.path.join(case.path, time)
    for file in sorted(os.listdir(folder)):
        path = os.path.join(folder, file)
        if not os.path.isfile(path):
            continue
        text = head(path)
        kind = re.search(r"class\s+vol(\w+?)Field\b", text)
        if kind and kind.group(1) in KINDS:
            powers = re.search(r"\bdimensions\s*\[([^\]]*)\]", text)
            exponents = text_numbers(powers.group(1).encode("latin-1"), float, path)[:3].tolist() if powers else []
            found[file.removesuffix(".gz")] = (KINDS[kind.group(1)], tuple(exponents + [0.0] * (3 - len(exponents))))
    return found


def has_grains(case, time):
    return os.path.isdir(os.path.join(case.path, time, "lagrangian", GRAINS))


def known(case, time):
    """Names that can be drawn at a time."""
    return sorted(fields(case, time)) + ([GRAINS] if has_grains(case, time) else [])


def unknown(case, name, time):
    """The error that tells of a field that is not there."""
    names = known(case, time)
    if not names:
        return CannotDraw(f"{os.path.join(case.path, time)} holds no fields")
    near = difflib.get_close_matches(name, names, 1, 0.4)
    return CannotDraw(f"{case.path} has no field '{name}' at time {time}{f'; did you mean {near[0]}?' if near else ''}\n"
                      f"  fields there: {' '.join(names)}")


def split(word, component=None):
    """("U", "x") of "U.x" or of "U" with component x."""
    name, dot, part = word.rpartition(".")
    if dot and part in (*PARTS[3], *PARTS[6], "mag"):
        return name, part
    return word, component


def read(case, word, time, component=None, along=None):
    """The Quantity of a field at a time. along: the component of vectors that is the default; None: the size."""
    name, part = split(word, component)
    there = fields(case, time)
    if name not in there:
        raise unknown(case, name, time)
    count, dimensions = there[name]
    try:
        values = case.field(name, time)
    except FormatError as e:
        raise CannotDraw(f"{e}" + ("; draw a time that a run has written" if "expression" in str(e) else "")) from None
    if count == 1:
        if part and part != "mag":
            raise CannotDraw(f"{name} is a scalar and has no component {part}")
        return Quantity(name, "", dimensions, values, labels.units(case.path))
    part = part or along or "mag"
    if part != "mag" and part not in PARTS[count]:
        raise CannotDraw(f"{name} has the components {' '.join(PARTS[count])} and mag, not {part}")
    return Quantity(name, part, dimensions, component_of(values, part, count), labels.units(case.path))


def component_of(values, part, count):
    if part != "mag":
        return np.ascontiguousarray(values[:, PARTS[count].index(part)])
    weights = np.array([1, 2, 2, 1, 2, 1.0]) if count == 6 else np.ones(count)
    return np.sqrt(np.einsum("ij,ij,j->i", values, values, weights))


def main_fields(case, time):
    """Names of the fields that one wants to see first: packing, velocity, temperature, pressure; of mixtures phi."""
    there = fields(case, time)
    if "phi" in there and "alpha" not in there:
        return ["phi"]
    found = [next((n for n in names if n in there), None) for names in MAIN]
    found = [n for n in found if n]
    if not found and not there:
        raise CannotDraw(f"{os.path.join(case.path, time)} holds no fields")
    return found or sorted(there)[:4]
