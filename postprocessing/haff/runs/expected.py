# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares a finished case with its expected.json.

    haff expected CASE         prints one line per value, exit code 1 if one is outside its tolerance or missing
    haff expected CASE -make   writes expected.json of a case that has none: least, greatest and sum of its fields at its last time, so that a
                               change is noticed (tolerance: a hundredth of the field's range, at most a tenth of the value; edit what you know better)

An entry of expected.json: quantity (a key of QUANTITIES, or one that only shipped cases check: `quantities` of the file names a module of
postprocessing/studies/checks that has such), field, time (if it is of one), value, tolerance (absolute), source; optional
cells (the grid it holds for: per side in 2D, per radius or length of a body), folder (a copy that Allrun makes), paper (what the paper
prints, where value is a band about it). `full` lists what Allrun gives, `short` what the coarser runs of the tests give, `seconds` is
the processor time of Allrun in user mode. Optional `words` are what Allcheck gives to Allrun, as the rows of a sweep that it compares.

docs/makeValidation makes its table of these, for which an entry of `full` also has kind (of KINDS: what value is), measured (what the
case had when it was last run in full; `./Allcheck -record` writes it down), where it is further from the paper than the tolerance why,
and beside: what else it is compared with, each with kind, reference, source, allowed (the deviation that the reference has) and why.
`told` lists what the README compares and no program measures again: quantity, haff and reference as printed there, kind, source; optional
allowed (printed there, too), why (where the two differ). `variants` lists the same case with other entries or another grid
(postprocessing/studies/checks/variants.py).
"""
import json
import os
import sys

import numpy as np

from haff import command
from haff.case.case import Case
from haff.layers import columns, faraday
from haff.paths import suggestion, take_study

COUNTS = ("limited",)  # fields of what a run did, which are no result
ROUND_OFF = 1e-9  # over the greatest value: below it a value counts as 0
# What a number is compared with.
KINDS = {
    "exact": "an exact solution, a law, or a boundary value problem solved to round-off",
    "paper": "a number that a paper prints",
    "grains": "the grains of granularMD or granularDEM",
    "peer": "another program",
    "own": "haff itself: another grid, scheme or commit, so that a change is noticed",
}


def wall_value(case, field, time):
    """At the cell of greatest x."""
    return case.field(field, time)[np.argmax(case.centres[:, 0])]


def lowest_row(case, field, time):
    """x and values of the cells of least y, ascending in x, and the x of the wall at their end."""
    row = np.flatnonzero(np.isclose(case.centres[:, 1], case.centres[:, 1].min()))
    row = row[np.argsort(case.centres[row, 0])]
    x = case.centres[row, 0]
    return x, case.field(field, time)[row], x[-1] + (x[-1] - x[-2]) / 2


def value_before(case, field, time, distance):
    """At that distance from the wall at the end of the lowest row of cells, on straight lines between their centres."""
    x, values, wall = lowest_row(case, field, time)
    return float(np.interp(wall - distance, x, values))


def front(case, field, time, factor):
    """x in the lowest row of cells at which the field first exceeds its first value that many times."""
    x, values, _ = lowest_row(case, field, time)
    n = int(np.argmax(values > factor * values[0]))
    return float(np.interp(factor * values[0], values[n - 1:n + 1], x[n - 1:n + 1]))


def change_within(case, field, time, span):
    """Sum of the differences to the cells a span of time earlier, over the sum of the cells."""
    earlier = case.time(float(time) - span)
    if abs(float(time) - span - float(earlier)) > 1e-9 * float(time):
        raise KeyError(f"{case.path}: time {float(time) - span:g} was not written; the nearest is {earlier}")
    values = case.field(field, time)
    return float(np.abs(values - case.field(field, earlier)).sum() / np.abs(values).sum())


def floor_value(case, field, time):
    """In the cell of least y."""
    return case.field(field, time)[np.argmin(case.centres[:, 1])]


def dense(case, time, least):
    """The cells with more than that packing."""
    return np.flatnonzero(case.field("alpha", time) > least)


def dense_maximum(case, field, time, least):
    return float(case.field(field, time)[dense(case, time, least)].max())


def height_of_maximum(case, field, time, least):
    cells = dense(case, time, least)
    return float(case.centres[cells[np.argmax(case.field(field, time)[cells])], 1])


def channel(case, time):
    """Velocities [cells][3] where packing exceeds 0.01, in a section across z."""
    return case.field("U", time)[dense(case, time, 0.01)]


def flow_along(case, field, time):
    """Integral of packing times velocity along z over a section across z (m^3/s)."""
    width, height, _ = np.ptp(case.mesh.points, axis=0)
    share = case.volumes / case.volumes.sum() * width * height
    return float(share * case.field("alpha", time) @ case.field("U", time)[:, 2])


def column_integral(case, field, time):
    """Integral along x per cross-section of a one-dimensional case."""
    x = case.centres[:, 0]
    length = np.ptp(x) * len(x) / (len(x) - 1)
    return float(np.sum(case.field(field, time)) * length / len(x))


def wavelength(case, _, time):
    """Of the pattern on a shaken layer over the last 50 cycles; nan where none stands."""
    layer = faraday.Layer(case)
    last = float(time) * layer.frequency
    result = faraday.measure(list(faraday.samples(layer, last - 50, last).values()), layer.length)
    return result["wavelength"] if result["stands"] else np.nan


def last_time(case, *_):
    """The last time written: the end of the run, or the time at which a collapse stopped it."""
    return float(case.time(None))


QUANTITIES = {
    "height of the centre of mass": lambda case, field, time: float(columns.centre(columns.profile(faraday.Layer(case), time))),
    "maximum": lambda case, field, time: float(case.field(field, time).max()),
    "minimum": lambda case, field, time: float(case.field(field, time).min()),
    "position of maximum": lambda case, field, time: float(case.centres[np.argmax(case.field(field, time)), 0]),
    "sum": lambda case, field, time: float(case.field(field, time).sum()),
    "integral along x": column_integral,
    "value at the wall": wall_value,
    "value at the floor": floor_value,
    "maximum above that packing": dense_maximum,
    "height of the maximum above that packing": height_of_maximum,
    "height up to that packing": lambda case, field, time, least: float(case.centres[dense(case, time, least), 1].max()),
    "greatest velocity along z": lambda case, field, time: float(channel(case, time)[:, 2].max()),
    "greatest velocity across z": lambda case, field, time: float(np.hypot(*channel(case, time)[:, :2].T).max()),
    "flow of packing along z": flow_along,
    "value off the wall": value_before,
    "position of the front": front,
    "change within a time": change_within,
    "wavelength": wavelength,
    "last time": last_time,
}


def read(path):
    file = os.path.join(path, "expected.json")
    try:
        with open(file, encoding="utf-8") as f:
            found = json.load(f)
    except FileNotFoundError:
        raise FileNotFoundError(f"{file} is not there, which holds what is expected; haff expected {path} -make writes one of what the case has now") from None
    except ValueError as e:
        raise ValueError(f"{file} is no JSON ({e}); haff expected {path} -make writes a new one once it is gone") from None
    if not isinstance(found, dict):
        raise ValueError(f"{file} holds a {type(found).__name__}; it is an object, with entries under \"full\" (haff expected -help)")
    if "quantities" in found:
        learn(found["quantities"], file)
    return found


def learn(name, file):
    """Adds the quantities of a module of studies/checks to QUANTITIES; none may have the name of another one."""
    module = f"checks.{name}"
    try:
        own = take_study(module).QUANTITIES
    except ModuleNotFoundError as why:
        if why.name != f"studies.{module}":
            raise
        raise ValueError(f"{file}: quantities '{name}' is no module of postprocessing/studies/checks") from None
    for quantity in own:
        if QUANTITIES.get(quantity, own[quantity]) is not own[quantity]:
            raise ValueError(f"{file}: the quantity '{quantity}' of {name}.py is one of another module, too; rename one of them")
    QUANTITIES.update(own)


def load(path, part):
    found, file = read(path).get(part), os.path.join(path, "expected.json")
    if found is None:
        raise ValueError(f"{file} has no entry \"{part}\" (haff expected -help)")
    if part not in ("full", "short"):
        return found
    return refuse(found, f"{file}: ", part, ("quantity", "value", "tolerance"))


def refuse(found, where, part, needed):
    """Entries, if they are complete. ValueError says which one is not."""
    if not isinstance(found, list):
        raise ValueError(f"{where}\"{part}\" is no list of entries (haff expected -help)")
    for n, entry in enumerate(found, 1):
        lack = [key for key in needed if not isinstance(entry, dict) or key not in entry]
        if lack:
            raise ValueError(f"{where}entry {n} of \"{part}\" has no {lack[0]}")
        if entry["quantity"] not in QUANTITIES:
            raise ValueError(f"{where}entry {n} of \"{part}\": there is no quantity '{entry['quantity']}'{suggestion(entry['quantity'], QUANTITIES)}")
    return found


def line(entry, indent="    "):
    """An entry as a line of expected.json; a variant has a line more for each entry in it."""
    inner = entry.get("full")
    if inner is None:
        return indent + json.dumps(entry, ensure_ascii=False)
    head = json.dumps({k: v for k, v in entry.items() if k != "full"}, ensure_ascii=False)[:-1]
    return f'{indent}{head}, "full": [\n' + ",\n".join(line(e, indent + "  ") for e in inner) + "]}"


def save(path, known):
    """Writes the whole of expected.json, an entry a line. Who reads it meanwhile finds the old one or the new one."""
    parts = []
    for key, value in known.items():
        rows = ",\n".join(map(line, value)) if isinstance(value, list) else ""
        parts.append(f'  "{key}": ' + (f"[\n{rows}\n  ]" if rows else json.dumps(value)))
    with command.replacing(os.path.join(path, "expected.json")) as temporary, open(temporary, "w", encoding="utf-8") as f:
        f.write("{\n" + ",\n".join(parts) + "\n}\n")


def measure(case, entry):
    """The case's value of an entry; KeyError where the time was not written."""
    time = case.time(entry["time"]) if "time" in entry else None
    if time and abs(float(time) - entry["time"]) > 1e-9 * max(1, entry["time"]):
        raise KeyError(f"{case.path}: time {entry['time']} was not written; the nearest is {time}")
    return QUANTITIES[entry["quantity"]](case, entry.get("field"), time, *([entry["at"]] if "at" in entry else []))


def describe(entry):
    where = f" of {entry['folder']}" if entry.get("folder", ".") != "." else ""
    where += f" ({entry['at']:g})" if "at" in entry else ""
    moment = f" at t = {entry['time']:g}" if "time" in entry else ""
    return f"{entry['quantity']} {entry.get('field', '')}{where}{moment}".replace("  ", " ").strip()


def as_expected(value, entry):
    """Does the value lie within the tolerance? Not a number does not."""
    return abs(value - entry["value"]) <= entry["tolerance"]


def judge(path, entry):
    """The value that the case in that folder has, whether it is as expected, and why there is none."""
    try:
        value = float(measure(Case(os.path.join(path, entry.get("folder", ""))), entry))
    except (KeyError, OSError, ValueError) as why:
        return float("nan"), False, f"none ({command.message(why)})"
    return value, as_expected(value, entry), ""


def make(path):
    """Writes expected.json of a case of one's own, of what it has at its last time."""
    file, case = os.path.join(path, "expected.json"), Case(path)
    if os.path.lexists(file):
        raise ValueError(f"{file} is there, and is not overwritten; remove it first")
    time, rows = case.time(None), []
    for field in case.fields(time):
        values = case.field(field, time)
        if values.ndim > 1 or field in COUNTS or not np.isfinite(values).all():
            continue
        for quantity, cells in (("minimum", 1), ("maximum", 1), ("sum", len(values))):
            value = float(QUANTITIES[quantity](case, field, time))
            tolerance = max(min(float(np.ptp(values)) / 100 * cells, abs(value) / 10), ROUND_OFF * float(np.abs(values).max()) * cells)
            rows.append({"quantity": quantity, "field": field, "time": float(time), "value": float(f"{value:.12g}"), "tolerance": float(f"{tolerance:.3g}"),
                         "source": "haff itself, when this file was made", "kind": "own"})
    if not rows:
        raise ValueError(f"{os.path.join(path, time)} has no scalar field of finite numbers to expect")
    save(path, {"full": rows, "short": []})
    print(file)


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case")
    parser.add_argument("-make", action="store_true", help="write expected.json of what the case has at its last time")
    o = parser.parse_args()
    path, bad = o.case, 0
    if o.make:
        return make(path)
    Case(path)
    for entry in load(path, "full"):
        value, good, why = judge(path, entry)
        bad += not good
        paper = f"  paper {entry['paper']}" if "paper" in entry else ""
        paper += "".join(f"  {other['kind']} {other['reference']:g}" for other in entry.get("beside", []))
        print(f"{'ok ' if good else 'BAD'} {describe(entry)}: {why or '%.9g' % value}, expected {entry['value']:.9g} "
              f"+- {entry['tolerance']:g}{paper}")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
