# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares a finished case with its expected.json.

    haff expected CASE         prints one line per value, exit code 1 if one is outside its tolerance or missing
    haff expected CASE -make   writes expected.json of a case that has none: least, greatest and sum of its fields at its last time, so that a
                               change is noticed (tolerance: a hundredth of the field's range, at most a tenth of the value; edit what you know better)

An entry of expected.json: quantity (a key of QUANTITIES), field, time (if it is of one), value, tolerance (absolute), source; optional
cells (the grid it holds for: per side in 2D, per radius or length of a body), folder (a copy that Allrun makes), paper (what the paper
prints, where value is a band about it). `full` lists what Allrun gives, `short` what the coarser runs of the tests give, `seconds` is
the processor time of Allrun.

docs/makeValidation makes its table of these, for which an entry of `full` also has kind (of KINDS: what value is), measured (what the
case had when it was last run in full; `./Allcheck -record` writes it down), where it is further from the paper than the tolerance why,
and beside: what else it is compared with, each with kind, reference, source, allowed (the deviation that the reference has) and why.
`told` lists what the README compares and no program measures again: quantity, haff and reference as printed there, kind, source; optional
allowed (printed there, too), why (where the two differ). `variants` lists the same case with other entries or another grid (runs/variants.py).
"""
import csv
import json
import os
import re
import sys

import numpy as np

import haff
from haff import command
from haff.layers import columns, faraday
from haff.paths import TOP, suggestion
from haff.plot import cellmap
from studies.checks import errors
from studies.exact import obliqueShock
from studies.exact import bunches
from studies.exact.eos import GoldshteinShapiro, PerfectGas
from studies.exact.riemann import BLAST, Riemann
from studies.measured import clustering, shocks

REFERENCES = os.path.join(TOP, "postprocessing", "references")
CASES = os.path.join(TOP, "cases")
COUNTS = ("limited",)  # fields of what a run did, which are no result
ROUND_OFF = 1e-9  # over the greatest value: below it a value counts as 0
WEDGE = np.radians(15)  # of the cases wedge15, wedge15Dilute
# What a number is compared with.
KINDS = {
    "exact": "an exact solution, a law, or a boundary value problem solved to round-off",
    "paper": "a number that a paper prints",
    "grains": "the grains of granularMD",
    "peer": "another program",
    "own": "haff itself: another grid, scheme or commit, so that a change is noticed",
}


def gas(case):
    """The equation of state from constant/granularProperties (plain numbers, as in the cases shipped)."""
    with open(os.path.join(case.path, "constant", "granularProperties")) as f:
        text = re.sub(r"//[^\n]*", "", f.read())

    def value(key, standard=None):
        found = re.search(rf"\b{key}\s+([^;\s]+)\s*;", text)
        return float(found.group(1)) if found else standard

    if re.search(r"equationOfState\s+perfectGas", text):
        return PerfectGas(value("gamma", 5 / 3))
    return GoldshteinShapiro(value("restitution"), value("diameter"), value("alphaMax", 0.65), value("gamma", 5 / 3))


def wall_value(case, field, time):
    """At the cell of greatest x."""
    return case.field(field, time)[np.argmax(case.centres[:, 0])]


def upstream_mach(case, _, time):
    """At the upper left corner."""
    cell = np.argmax(case.centres[:, 1] - case.centres[:, 0])
    c = gas(case).c(case.field("rho", time)[cell], case.field("T", time)[cell])
    return np.linalg.norm(case.field("U", time)[cell]) / c


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


def asymmetry(case, field, time):
    """Greatest difference to the mirror image about the line y = 10 - x, relative to the greatest value."""
    x, y = np.round(case.centres[:, :2].T, 9)
    here, there = np.lexsort((y, x)), np.lexsort((np.round(10 - x, 9), np.round(10 - y, 9)))
    value = case.field(field, time)
    mirrored = -value[:, [1, 0]] if value.ndim > 1 else value
    value = value[:, :2] if value.ndim > 1 else value
    return float(np.abs(value[here] - mirrored[there]).max() / np.abs(value).max())


def blast_error(case, field, time):
    """L1 error of the elastic blast against the exact solution at the cell centres, over 50 grains/cm^3."""
    x, rho = case.line(("rho",), time)
    exact = Riemann(gas(case), *BLAST).sample((x - 5) / float(time))[0]
    return float(np.abs(rho - exact).mean() * 10 / 50)


def reference_error(case, field, time):
    """L1 difference of the density to cell averages of the fine lattice runs of cases/wedge (workPrecision), over the
    upstream density."""
    with np.load(os.path.join(REFERENCES, "wedge.npz")) as f:
        known = f["mean"].astype(float)
    n = len(known)
    column, row = np.moveaxis(np.clip((cellmap.spread(case.mesh) / 10 * n).astype(int), 0, n - 1), -1, 0)
    miss = np.abs(case.field("rho", time) - known[row, column].mean(axis=1))
    return float(case.volumes @ miss / case.volumes.sum() / known[-1, 0])


def shock_angle(case, _, time):
    """Degrees."""
    return float(np.degrees(shocks.straight_shock(case, shocks.upstream(case, gas(case), time), WEDGE, time).angle))


def behind_shock(case, field, time):
    """rho, p or mach over the exact value, less 1."""
    return float(getattr(shocks.behind_wedge(case, shocks.upstream(case, gas(case), time), WEDGE, time), field))


def wedge_error(case, _, time):
    return shocks.wedge_error(case, shocks.upstream(case, gas(case), time), WEDGE, time)


def stand_off(case, _, time):
    return float(shocks.stand_off(case, shocks.upstream(case, gas(case), time), time))


def nose_pressure(case, _, time):
    """Largest p over that of the stream at rest behind a normal shock."""
    stream = shocks.upstream(case, gas(case), time)
    behind = stream.behind(np.pi / 2)
    return float(case.field("p", time).max() / obliqueShock.stagnation(gas(case), behind.rho, behind.T, behind.speed)[1])


def swept(column):
    """From rows of table/faradayDiagram.csv that cases/faradaySweep makes: a function of the list of that column."""
    def take(function):
        def value(case, _, time):
            with open(os.path.join(case.path, "table", "faradayDiagram.csv"), newline="") as f:
                return float(function([row[column] for row in csv.DictReader(f)]))
        return value
    return take


def wavelength(case, _, time):
    """Of the pattern on a shaken layer over the last 50 cycles; nan where none stands."""
    layer = faraday.Layer(case)
    last = float(time) * layer.frequency
    result = faraday.measure(list(faraday.samples(layer, last - 50, last).values()), layer.length)
    return result["wavelength"] if result["stands"] else np.nan


def row_of(case, time):
    """Profile over the height at that time, and of the grains of the case of the same name and MD, profiles.csv, which is
    of the same time or phase of the shaking."""
    layer = faraday.Layer(case)
    grains = columns.read(os.path.join(CASES, os.path.basename(os.path.abspath(case.path)) + "MD", "profiles.csv"))
    moment = float(time) * layer.frequency % 1 if hasattr(layer, "frequency") else float(time)
    return columns.profile(layer, time), grains[min(grains, key=lambda m: abs(m - moment))]


def difference_to_grains(case, field, time, raised=0.0):
    """L1, relative, over cells where there are grains; field: of the profile, or energy; raised: how far the gas is lifted (m)."""
    return float(columns.difference(*row_of(case, time), columns.energy if field == "energy" else field, raised))


def kept_box(case):
    """The cooling box of the case, and time, impacts and energy of the grains beside it: its own, or cooling.csv of the case of the
    same name and MD."""
    path = os.path.abspath(case.path)
    name = os.path.basename(os.path.dirname(path) if os.path.basename(path) == "fromGrains" else path)
    rows = clustering.read(os.path.join(CASES, name.removesuffix("MD") + "MD"), "cooling.csv")
    return clustering.Box(path), rows


def doubled(case, *_):
    """The time at which the energy of motion is twice Haff's law."""
    box = clustering.Box(case.path)
    grains = os.path.isdir(os.path.join(case.path, "postProcessing", "grains"))
    t, T = box.totals()[::2] if grains else box.budget()
    return clustering.left(t, T, box.haff(t))


def doubled_beside(case, *_):
    """That time over the grains', less 1."""
    box, rows = kept_box(case)
    return doubled(case) / clustering.left(rows["t"], rows["T"], box.haff(rows["t"])) - 1


def cooled_beside(case, _, time):
    """Energy of motion over the grains', less 1."""
    box, rows = kept_box(case)
    return float(np.interp(float(time), *box.budget()) / clustering.at(rows, float(time))[1] - 1)


def impacts(case, _, time):
    """Of each grain of a case of grains until then."""
    return float(np.interp(float(time), *clustering.Box(case.path).totals()[:2]))


def impacts_beside(case, _, time):
    """Of each grain of the gas, by Enskog's rate, over those of the grains, less 1."""
    box, rows = kept_box(case)
    return float(np.interp(float(time), *box.impacts()) / clustering.at(rows, float(time))[0] - 1)


def last_time(case, *_):
    """The last time written: the end of the run, or the time at which a collapse stopped it."""
    return float(case.time(None))


QUANTITIES = {
    **errors.QUANTITIES,
    "time at twice Haff's law": doubled,
    "time at twice Haff's law over the grains', less 1,": doubled_beside,
    "energy of motion over the grains', less 1,": cooled_beside,
    "impacts over the grains', less 1,": impacts_beside,
    "impacts of a grain": impacts,
    "height of the centre of mass": lambda case, field, time: float(columns.centre(columns.profile(faraday.Layer(case), time))),
    "difference to the grains": difference_to_grains,
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
    "upstream Mach number": upstream_mach,
    "asymmetry": asymmetry,
    "L1 error": blast_error,
    "L1 difference to the lattice": reference_error,
    "shock angle": shock_angle,
    "error behind the shock": behind_shock,
    "L1 error of a wedge": wedge_error,
    "stand-off distance": stand_off,
    "pressure at the nose": nose_pressure,
    "rows with a standing wave": swept("state")(lambda states: states.count("stands")),
    "standing waves within 20 % of the paper's": swept("within20")(lambda answers: answers.count("yes")),
    "wavelength": wavelength,
    "last time": last_time,
    "error of the bunches": lambda case, field, time: bunches.error(case, time),
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
    return found


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
    """Writes the whole of expected.json, an entry a line."""
    parts = []
    for key, value in known.items():
        rows = ",\n".join(map(line, value)) if isinstance(value, list) else ""
        parts.append(f'  "{key}": ' + (f"[\n{rows}\n  ]" if rows else json.dumps(value)))
    with open(os.path.join(path, "expected.json"), "w", encoding="utf-8") as f:
        f.write("{\n" + ",\n".join(parts) + "\n}\n")


def measure(case, entry):
    """The case's value of an entry; KeyError where the time was not written."""
    if "time" not in entry:
        return QUANTITIES[entry["quantity"]](case, entry.get("field"), None)
    time = case.time(entry["time"])
    if abs(float(time) - entry["time"]) > 1e-9 * max(1, entry["time"]):
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
        value = float(measure(haff.Case(os.path.join(path, entry.get("folder", ""))), entry))
    except (KeyError, OSError, ValueError) as why:
        return float("nan"), False, f"none ({command.message(why)})"
    return value, as_expected(value, entry), ""


def make(path):
    """Writes expected.json of a case of one's own, of what it has at its last time."""
    file, case = os.path.join(path, "expected.json"), haff.Case(path)
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
    haff.Case(path)
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
