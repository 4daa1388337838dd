# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables that function objects write: postProcessing/FUNCTION/START/FILE, whose columns have names.

    case = haff.Case("cases/wedge")
    table = case.table("mass", frame=True)
    table["Time"], table["volIntegrate(rho)"]

A table is a pandas.DataFrame where pandas is installed, and else a numpy structured array: both give a column by its name. The titles
are those of the last comment above the rows; a title of several words in brackets names the parts of a vector.
"""
import os
import re

import numpy as np

from haff.case.foam import times_in
from haff.paths import suggestion

CELL = re.compile(r"\(([^()]*)\)|(\S+)")
PARTS = {3: "xyz", 6: ("xx", "xy", "xz", "yy", "yz", "zz")}


def frame(columns):
    """{name: values [rows]} as a pandas.DataFrame, or as a numpy structured array where there is no pandas."""
    try:
        import pandas
    except ImportError:
        return structured(columns)
    return pandas.DataFrame(columns)


def structured(columns):
    """The numpy structured array [rows] with these columns."""
    arrays = {name: np.array(values) for name, values in columns.items()}
    found = np.empty(len(next(iter(arrays.values()), ())), [(name, a.dtype) for name, a in arrays.items()])
    for name, a in arrays.items():
        found[name] = a
    return found


def names_of(table):
    """The names of the columns of either kind."""
    return list(table.dtype.names if isinstance(table, np.ndarray) else table.columns)


def number(word):
    """The number that a word is; nan for other words."""
    try:
        return float(word)
    except ValueError:
        return np.nan


def cells_of(line):
    """The cells of a row: a word, or the list of words of (..)."""
    return [inside.split() if word == "" else word for inside, word in CELL.findall(line)]


class Start:
    """One file: its rows as lists of cells, its titles, its number of probes."""

    def __init__(self, path):
        self.path, self.rows, self.titles, self.probes = path, [], [], 0
        with open(path, errors="replace") as f:
            for line in f:
                if line.startswith("#"):
                    self.comment(line[1:])
                elif line.strip():
                    self.rows.append(cells_of(line))
        self.cut_short()

    def comment(self, line):
        if re.match(r"\s*Probe\s+\d+\s+\(", line):
            self.probes += 1
        else:
            words = [w.strip() for w in line.split("\t")] if "\t" in line.strip() else line.split()
            self.titles = [w for w in words if w]

    def cut_short(self):
        """A last row with fewer cells than the first is one that a run is writing, or was when it ended: it is left out."""
        if len(self.rows) > 1 and len(widened(self.rows[-1])) < len(widened(self.rows[0])):
            self.rows.pop()

    @property
    def first(self):
        """The time of the first row; nan without one."""
        return self.time(self.rows[0]) if self.rows else np.nan

    @staticmethod
    def time(row):
        return number(row[0]) if isinstance(row[0], str) else np.nan


def files_of(folder):
    """The names of the files that any start has."""
    return sorted({n for start in times_in(folder) for n in os.listdir(os.path.join(folder, start))
                   if os.path.isfile(os.path.join(folder, start, n))})


def there(folder):
    """{function: its files} of a folder postProcessing."""
    if not os.path.isdir(folder):
        return {}
    found = {name: files_of(os.path.join(folder, name)) for name in sorted(os.listdir(folder)) if os.path.isdir(os.path.join(folder, name))}
    return {name: files for name, files in found.items() if files}


def file_of(folder, file):
    """The name of the file; None: the only one that the starts have. FileNotFoundError says what there is."""
    have = files_of(folder)
    if not have:
        above = ", ".join(there(os.path.dirname(folder))) or "none"
        meant = suggestion(os.path.basename(folder), there(os.path.dirname(folder)))
        raise FileNotFoundError(f"{folder} has no tables{meant or ';'} function objects that have some: {above}")
    if file is None and len(have) == 1:
        return have[0]
    if file not in have:
        what = "which file?" if file is None else f"there is no {file}{suggestion(file, have) or ';'}"
        raise FileNotFoundError(f"{folder}: {what} The files are: {', '.join(have)}")
    return file


def starts_of(folder, file):
    """The Start of every file, in the order of time. Rows at and after the first time of a later start are left out: it repeats them."""
    file, found = file_of(folder, file), []
    for name in times_in(folder):
        path = os.path.join(folder, name, file)
        if not os.path.exists(path):
            continue
        start = Start(path)
        if not np.isnan(start.first):
            for before in found:
                before.rows = [row for row in before.rows if not Start.time(row) >= start.first]
        found.append(start)
    return found


def widened(cells):
    return [w for cell in cells for w in (cell if isinstance(cell, list) else [cell])]


def titles_of(start, row):
    """The names of the columns of a row whose vectors are spread out: those of the file, or column1, column2 .."""
    titles, flat = start.titles, len(widened(row))
    if start.probes and len(row) == start.probes + 1:
        titles = ["Time"] + [f"probe{i}" for i in range(start.probes)]
    if len(titles) == len(row):
        titles = [name for title, cell in zip(titles, row) for name in parts(title, cell)]
    return titles if len(titles) == flat else [f"column{i + 1}" for i in range(flat)]


def parts(title, cell):
    """One name for each part of a cell: of a title (a b c) its own, else title_x .."""
    if not isinstance(cell, list):
        return [title]
    own = title[1:-1].split() if title.startswith("(") else []
    return own if len(own) == len(cell) else [f"{title}_{p}" for p in PARTS.get(len(cell), range(len(cell)))]


def as_array(folder, file):
    """Rows of all starts joined [rows][columns]; vectors are spread out, words are nan. ValueError where rows differ in length."""
    found, width = [], None
    for start in starts_of(folder, file):
        for row in start.rows:
            found.append([number(w) for w in widened(row)])
            width = width or len(found[0])
            if len(found[-1]) != width:
                raise ValueError(f"{start.path}: a row has {len(found[-1])} columns, the first one {width}; with frame=True columns go by name")
    return np.array(found)


def as_frame(folder, file):
    """The same with names, as `frame` has it; words stay. Columns that only some starts have are nan in the others."""
    columns, count = {}, 0
    for start in starts_of(folder, file):
        names = titles_of(start, start.rows[0]) if start.rows else []
        rows = [widened(row) for row in start.rows]
        if any(len(row) != len(names) for row in rows):
            raise ValueError(f"{start.path}: a row has another number of columns than {len(names)}")
        for name in names:
            columns.setdefault(name, [np.nan] * count)
        for name, column in columns.items():
            column += [row[names.index(name)] for row in rows] if name in names else [np.nan] * len(rows)
        count += len(rows)
    return frame({name: typed(column) for name, column in columns.items()})


def typed(column):
    """Numbers as floats; a column of words as text."""
    try:
        return np.array(column, float)
    except ValueError:
        return np.array([str(w) for w in column])
