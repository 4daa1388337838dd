# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots over time of a run: steps and what limits them, extremes, conservation, speed, and the tables of its function objects."""
import re

import numpy as np

from haff.case import tables
from haff.plot import figures, log
from haff.report.charts import chart
from haff.report.words import plain, symbol, with_unit

TIME, MASS, MOMENTUM, ENERGY, FORCE = (0, 0, 1), (1, 0, 0), (1, 1, -1), (1, 2, -2), (1, 1, -2)
KNOWN = {  # columns of tables: exponents of mass, length, time
    "force": FORCE, "moment": (1, 2, -2), "kinetic": ENERGY, "potential": ENERGY, "lost": ENERGY, "energy": ENERGY, "mass": MASS, "momentum": MOMENTUM,
    "impulse": MOMENTUM, "phi": (1, 0, -1), "phiE": (1, 2, -3), "dt": TIME, "massFlow": MASS, "residual": ENERGY, "massResidual": MASS,
    "momentumResidual": MOMENTUM, "cooling": ENERGY, "clockTime": None, **figures.DIMENSIONS}
INTEGRALS = {"volIntegrate": (0, 3, 0), "areaIntegrate": (0, 2, 0)}
EXTREMES = {"alpha": "packing fraction", "phi": "fraction of small grains", "T": "temperature", "magU": "largest speed", "Ma": "largest Mach number"}
SUM = re.compile(r"(\w+)\((\w+)\)")
COMMON = (  # columns of runs that are shown over each other: title, column, symbol, exponents
    ("Largest packing fraction", "alphaMax", "alpha", None), ("Largest temperature", "TMax", "T", KNOWN["T"]), ("Mean temperature", "T", "T", KNOWN["T"]),
    ("Largest speed", "magUMax", "|U|", KNOWN["U"]), ("Largest fraction of small grains", "phiMax", "phi", None), ("Energy", "energy", "energy", ENERGY),
    ("Change of the energy since the start", "energyChange", "change / start", None),
    ("Change of the mass since the start", "massChange", "change / start", None), ("Time step", "dt", "Δt", TIME))
MOST_PLOTS = 12  # of a function object


def time_axis(units):
    return plain(figures.axis("t", units))


def of_run(story, units):
    """Charts of a runlog.Story."""
    t, at = story.rows["Time"], time_axis(units)
    made = [steps(story, t, at, units)]
    made += [extreme(story, t, at, pair, units) for pair in log.EXTREMES]
    drift = {name: np.abs(story.change(name)) for name in log.DRIFTS}
    made.append(chart("Change since the start", t, [(log.TEXTS[name], v) for name, v in drift.items()], across=at, y="|change| / start", log=True))
    for name in (name for name, values in drift.items() if np.isinf(values).any()):  # the start is 0
        made.append(total(story, t, at, name.removesuffix("Change"), units))
    momenta = [(name[-1], story.column(name)) for name in log.MOMENTA]
    made.append(chart("Momentum", t, moving(momenta), across=at, y=with_unit("momentum", MOMENTUM, units)))
    per_step, speed = story.pace()
    made.append(chart("Speed of the run", t, [("seconds per step", per_step)], across=at, y="clock per step (s)"))
    made.append(chart("Time of the case per second of the clock", t, [("time per second", speed)], across=at, y=with_unit("per second", TIME, units)))
    done = 100 * story.column("computed")
    if len(np.unique(done[np.isfinite(done)])) > 1:
        made.append(chart("Cells that were computed, the rest was uniform", t, [("computed", done)], across=at, y="cells computed so far (%)", log=False))
    return [c for c in made if c]


def steps(story, t, at, units):
    """dt, with points in the colour of what limits it."""
    dt = story.rows["dt"]
    by = [(name, np.where([n == name for n in story.limiters], dt, np.nan), "points") for name, _ in log.limits_of(story, 5)]
    return chart("Time step, and what limits it", t, [("Δt", dt, "line"), *by], across=at, y=with_unit("Δt", TIME, units))


def extreme(story, t, at, pair, units):
    low, high = pair
    name = re.sub("(Min|Max)$", "", low)
    sign = f"|{name[3:]}|" if name.startswith("mag") else symbol(name)
    series = [("largest", story.column(high)), ("least", story.column(low))] if high else [(sign, story.column(low))]
    title = EXTREMES.get(name, name)
    return chart(title[0].upper() + title[1:], t, series, across=at, y=with_unit(sign, KNOWN.get(name.removeprefix("mag")), units))


def total(story, t, at, name, units):
    label = log.TEXTS[name + "Change"]
    return chart(label.capitalize(), t, [(label, story.column(name))], across=at, y=with_unit(label, KNOWN.get(name), units))


def moving(series):
    """Those series that have numbers other than 0."""
    return [s for s in series if np.nanmax(np.abs(s[1]), initial=0) > 0]


# ---- tables of function objects ----

def of_functions(case, without=("run", "limiter", "figures")):
    """{function: charts} of the tables over time that function objects have written."""
    found = {}
    for function, files in case.tables().items():
        if function in without:
            continue
        charts = [c for file in files for c in of_table(case, function, file)]
        if charts:
            found[function] = charts
    return found


def of_table(case, function, file):
    """Charts of one file: columns of one name and unit in one of them. Nothing for files that have no column of times."""
    try:
        table = case.table(function, file, frame=True)
    except (OSError, ValueError, IndexError):
        return []
    columns = {name: np.asarray(table[name]) for name in tables.names_of(table)}
    if not columns or "Time" not in columns or columns["Time"].dtype.kind != "f":
        return []
    t, base = columns.pop("Time"), file.rsplit(".", 1)[0]
    if "field" in columns:
        parts = [(f"{field}", {k: v[columns["field"] == field] for k, v in columns.items() if k in ("min", "max")}, t[columns["field"] == field])
                 for field in dict.fromkeys(columns["field"])]
    else:
        parts = [(base, {k: v for k, v in columns.items() if v.dtype.kind == "f" and not constant(v)}, t)]
    return [c for name, some, when in parts for c in grouped(name, some, when, case.units) if c][:MOST_PLOTS]


def constant(values):
    some = values[np.isfinite(values)]
    return not len(some) or (some == some[0]).all()


def grouped(base, columns, t, units):
    """Charts of columns: those that begin alike (probe0_x, probe0_y), and those of extremes, share one."""
    groups = {}
    for name, values in columns.items():
        stem = cause(name) if base == "energyBudget" else name.rsplit("_", 1)[0] if "_" in name else base if re.match(r"(probe\d+|min|max)$", name) else name
        groups.setdefault(stem, []).append((name, values))
    drawn = []
    for stem, series in groups.items():
        if any(alike(series, s) for s in drawn):  # as the pressure's part of a force without viscosity
            continue
        drawn.append(series)
        title = stem if stem == base else f"{base}: {stem}"
        dimensions = dimensions_of(base, stem)
        y = with_unit(base if base in ("force", "moment") else stem, dimensions, units)
        yield chart(title, t, series, across=time_axis(units), y=y, log=None if len(series) > 1 else False)


def cause(name):
    """The chart of a column of energyBudget: what changed the mass, the momentum along an axis, the energy; what has no cause stands alone."""
    if "esidual" in name:
        return name.rsplit("_", 1)[0]
    return "mass" if name.startswith("mass") else "momentum" + name[-2:] if name.startswith("momentum") else "energy"


def alike(one, other):
    return len(one) == len(other) and all(np.array_equal(a, b, equal_nan=True) for (_, a), (_, b) in zip(one, other))


def dimensions_of(base, stem):
    """Exponents of mass, length and time of a column, where its name tells."""
    known = KNOWN.get(base) if base in ("force", "moment") else None
    if known:
        return known
    found = SUM.match(stem)
    if found and found.group(2) in KNOWN:
        of = KNOWN[found.group(2)]
        return tuple(a + b for a, b in zip(of, INTEGRALS.get(found.group(1), (0, 0, 0))))
    return KNOWN.get(stem) or KNOWN.get(stem.rsplit("_", 1)[0]) or KNOWN.get(base)
