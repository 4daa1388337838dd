# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles of a report: means of fields over the layers of the mesh along the one axis along which they differ, at the written times."""
import os
import re

import numpy as np

from haff.case.foam import FormatError, text_numbers, times_in
from haff.plot import figures, quantity
from haff.plot.quantity import CannotDraw
from haff.report.charts import numbers
from haff.report.pictures import LOST
from haff.report.words import plain, symbol, with_unit

MOST = 400  # places of a profile
ROUND_OFF = 1e-10  # of the largest component: smaller ones are what sums of steps leave of 0


def axis_of(space):
    """The axis of profiles: the only one with many cells, that of gravity, or the only one whose ends are no periodic ones; else None."""
    if space.column is not None:
        return space.column
    if not space.lattice:
        return None
    path = os.path.join(space.case.path, "constant", "g")
    found = re.search(r"\bvalue\s*\(([^)]*)\)", quantity.head(path))
    g = text_numbers(found.group(1).encode("latin-1"), float, path) if found else np.zeros(3)
    if len(g) != 3:
        raise FormatError(f"{path}: the value has {len(g)} numbers; give 3")
    along = [k for k in space.axes if g[k]]
    if len(along) == 1:
        return along[0]
    ends = [k for k in space.axes if k not in periodic(space)]
    return ends[0] if len(ends) == 1 else None


def periodic(space):
    """The axes of a lattice across which a cyclic patch lies."""
    first, found = len(space.mesh.neighbour), set()
    for kind, start, count in space.mesh.patches.values():
        if kind == "cyclic" and count:
            normal = np.abs(space.mesh.face_geometry(first)[1][start - first])
            found.add(int(np.argmax(normal)))
    return found


def layers(space, axis):
    """(places, function: values [cells], weights [cells] -> means [layers]) along an axis."""
    if not space.lattice:
        x, order = space.along(axis)
        return x, lambda values, weights: order(values)
    layer, x = space.lattice.ijk[:, axis], space.lattice.middles[axis]
    volume = space.lattice.volumes()

    def mean(values, weights):
        total = np.bincount(layer, weights * volume, len(x))
        return np.bincount(layer, values * weights * volume, len(x)) / np.where(total > 0, total, np.nan)

    return x, mean


def of_case(space, names, times):
    """Charts whose data are profiles at each time: {"times": [..], "frames": [[values] ..]} beside what a chart has. U and T are means over mass."""
    axis = axis_of(space)
    if axis is None:
        return []
    x, mean = layers(space, axis)
    some = slice(None, None, max(-(-len(x) // MOST), 1))
    return [c for name in names for c in of_field(space, name, times, axis, x, mean, some)]


def of_field(space, name, times, axis, x, mean, some):
    """Charts of a field: of a vector each component that is not 0 to round-off, at least that along the axis; of a tensor its size."""
    parts, shown = {}, []
    for time in times:
        try:
            there = quantity.fields(space.case, time)
            count, dimensions = there[name]
            values, mass = space.case.field(name, time), np.ones(space.mesh.cells)
            if name in ("U", "T") and {"alpha", "rho"} & there.keys():
                mass = space.case.field("alpha" if "alpha" in there else "rho", time)
        except (CannotDraw, KeyError, *LOST):
            continue
        for part in {1: ("",), 3: "xyz"}.get(count, ("mag",)):
            one = quantity.component_of(values, part, count) if part else values
            frames, largest, _ = parts.get(part, ([], 0.0, None))
            q = quantity.Quantity(name, part, dimensions, one, space.case.units)
            parts[part] = (frames + [numbers(mean(one, mass)[some])], max(largest, *map(abs, quantity.limits(one))), plain(q.label))
        shown.append(time)
    most = max((largest for _, largest, _ in parts.values()), default=0)
    for part, (frames, largest, label) in parts.items():
        if largest > ROUND_OFF * most or (not most and part in ("", "mag", "xyz"[axis])):
            yield of_part(space, name + part, label, shown, axis, numbers(x[some]), frames)


def of_part(space, key, label, times, axis, x, frames):
    """The chart of a component; key: tells it from others of the case."""
    how = "" if space.dim == 1 else ", mean over the mass of a layer" if key[:1] in ("U", "T") else ", mean over a layer"
    return {"title": label + how, "key": key, "x": with_unit("xyz"[axis], (0, 1, 0), space.case.units), "y": label, "log": False, "time": False,
            "times": times, "frames": frames, "data": [x], "series": [], "about": f"Profile of {label} along {'xyz'[axis]} at {len(times)} times"}


# ---- lines of the function object `sets` ----

def of_sets(case, times):
    """Charts of the lines that sets wrote at the times that are nearest to these: postProcessing/FUNCTION/TIME/LINE_FIELD_FIELD.xy."""
    charts = []
    for function, files in case.tables().items():
        folder = os.path.join(case.path, "postProcessing", function)
        there = times_in(folder)
        near = list(dict.fromkeys(min(there, key=lambda name: abs(float(name) - float(t))) for t in times)) if there else []
        for file in (f for f in files if f.endswith(".xy")):
            charts += of_lines(case, function, file, [(t, os.path.join(folder, t, file)) for t in near if os.path.isfile(os.path.join(folder, t, file))])
    return charts


def of_lines(case, function, file, paths):
    """Charts of one line: a column of places (or three), then those of each field of its name."""
    line, fields = file[:-3].split("_"), []
    known = {n: components for t in case.times[-1:] for n, (components, _) in quantity.fields(case, t).items()}
    while len(line) > 1 and line[-1] in known:
        fields.insert(0, line.pop())
    width = sum(known[f] for f in fields)
    frames = [(t, np.loadtxt(path, ndmin=2)) for t, path in paths]
    frames = [(t, rows) for t, rows in frames if rows.shape[1] - width in (1, 3) and rows.shape == frames[0][1].shape]
    if not fields or not frames:
        return []
    first = frames[0][1].shape[1] - width
    x = frames[0][1][:, :first]
    x = x[:, 0] if first == 1 else np.linalg.norm(x - x[0], axis=1)
    charts = []
    for name in fields:
        values = [rows[:, first:first + known[name]] for _, rows in frames]
        values = [v[:, 0] if known[name] == 1 else np.sqrt((v**2).sum(axis=1)) for v in values]
        sign = symbol(name) if known[name] == 1 else f"|{symbol(name)}|"
        charts.append({"title": f"{function}: {sign} along {'_'.join(line)}", "x": with_unit("place along the line", (0, 1, 0), case.units),
                       "y": with_unit(sign, figures.DIMENSIONS.get(name), case.units), "log": False, "time": False, "times": [t for t, _ in frames],
                       "frames": [numbers(v) for v in values], "data": [numbers(x)], "series": [],
                       "about": f"{sign} along {'_'.join(line)} at {len(frames)} times"})
        first += known[name]
    return charts
