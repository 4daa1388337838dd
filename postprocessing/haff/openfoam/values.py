# SPDX-License-Identifier: GPL-3.0-or-later
"""Values in files of fields: uniform, nonuniform, constant, a table in time."""
import re

import numpy as np

from haff.case.blocks import nested
from haff.openfoam.report import Refused


class Series:
    """A value that changes in time, linear between its knots: times [k], values [k] or [k][3]."""

    def __init__(self, times, values):
        self.times, self.values = np.asarray(times, float), np.asarray(values, float)

    def at(self, times):
        return np.interp(times, self.times, self.values)


def plain(text):
    """Numbers of a text that holds one number or one (vector). ValueError."""
    return np.array([float(word) for word in re.sub(r"\[[^\]]*\]|[()]", " ", text).split()])


def value_of(entry, lists):
    """[1] or [3] where all have one value; [n][1] or [n][3] of a list; a Series."""
    text = entry.strip()
    listed = re.fullmatch(r"nonuniform\s+@(\d+)", text)
    if listed:
        values = lists[int(listed[1])]
        return values.reshape(len(values), -1)
    table = re.fullmatch(r"table\s*\d*\s*(\(.*\))", text, re.S)
    if table:
        return series(table[1], entry.place)
    try:
        found = plain(re.sub(r"^(uniform|constant)\b", "", text))
    except ValueError:
        found = ()
    if len(found) not in (1, 3):
        raise Refused(f"{entry.place}: '{text[:60]}': a number or a vector was expected; of values that change in time haff has  table ((t v) ..)  only")
    return found


def series(text, place):
    try:
        rows = nested(text)
        rows = [rows] if not isinstance(rows[0], list) else rows
        return Series([float(r[0]) for r in rows], [[float(x) for x in r[1]] if isinstance(r[1], list) else float(r[1]) for r in rows])
    except (IndexError, ValueError, TypeError):
        raise Refused(f"{place}: '{text[:60]}': a table  ((t v) ..)  was expected") from None


def combined(one, other, make):
    """make(one, other) of two values, faces and times among them."""
    if isinstance(one, Series) or isinstance(other, Series):
        if any(not isinstance(v, Series) and v.ndim > 1 for v in (one, other)):
            raise Refused("a list of faces and a table in time cannot be combined")
        times = np.unique(np.concatenate([v.times for v in (one, other) if isinstance(v, Series)]))
        at = [v.at(times) if isinstance(v, Series) else v[0] for v in (one, other)]
        return Series(times, make(*at) + 0 * times)
    return make(one, other)


def row(v):
    return repr(float(v[0])) if len(v) == 1 else "(" + " ".join(repr(float(x)) for x in v) + ")"


def as_entry(value):
    """uniform .. or nonuniform ..; a list of equal rows is uniform."""
    value = np.asarray(value, float)
    if value.ndim == 2 and len(value) and (value == value[0]).all():
        value = value[0]
    if value.ndim == 1:
        return "uniform " + row(value)
    kind = "vector" if value.shape[1] == 3 else "scalar"
    return f"nonuniform List<{kind}> {len(value)}\n(\n" + "\n".join(map(row, value)) + "\n)\n"


def as_table(series):
    return "table (" + " ".join("(%.12g %s)" % (t, row(np.atleast_1d(v))) for t, v in zip(series.times, series.values)) + ")"
