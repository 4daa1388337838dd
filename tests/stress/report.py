# SPDX-License-Identifier: GPL-3.0-or-later
"""The text of postprocessing/reports/stress.md, from the tables that stress and rhoCentralFoam.py write; see `remake`. notes.md
goes in front."""
import csv
import os

SUMS = ("runs", "finished", "capped", "collapsed", "stated", "failed", "steps", "cell_stages", "limited_cells", "limited_faces", "floored",
        "rejected", "implicit", "implicit_made", "automatic", "automatic_made", "beds")
LARGEST = ("mass", "momentum", "energy", "mass_bound", "momentum_bound", "energy_bound", "source_bound")
HEAD = ("problems", "ran to their end", "stopped at the bound of steps", "ended with a stated cause", "failed",
        "limited cells", "limited faces", "floored cells", "rejected steps", "least dt", "mass", "momentum", "energy", "of bound")

BEDS = ("`automatic` is drawn for half of the problems whose gas cools and has a `thresholdSpeed`, and for a third of the families `implicit` and "
        "`implicitCells`; it changes nothing in most. A run in which no step was planned as an implicit one is done again with sound in every cell's way, must "
        "have the same bits, and is judged as those are, stage by stage; others after each step.\n")


def read(path):
    with open(path) as f:
        return list(csv.DictReader(f))


def add(rows):
    total = {name: sum(int(r[name]) for r in rows) for name in SUMS}
    total.update({name: max(float(r[name]) for r in rows) for name in LARGEST})
    total["least_dt"] = min(float(r["least_dt"]) for r in rows)
    return total


def grouped(rows, key):
    groups = {}
    for r in rows:
        groups.setdefault(key(r), []).append(r)
    return {name: add(group) for name, group in groups.items()}


def percent(part, whole):
    return "0" if part == 0 else f"{100 * part / whole:.3g} %"


def error(x):
    return "-" if x < 0 else f"{x:.1e}"


def cells(t):
    bound = max(t["mass_bound"], t["momentum_bound"], t["energy_bound"])
    return [t["runs"], percent(t["finished"], t["runs"]), percent(t["capped"], t["runs"]),
            percent(t["collapsed"] + t["stated"], t["runs"]), t["failed"], percent(t["limited_cells"], t["cell_stages"]), percent(t["limited_faces"], t["cell_stages"]), t["floored"],
            percent(t["rejected"], t["steps"]), f"{t['least_dt']:.1g}", error(t["mass"]), error(t["momentum"]), error(t["energy"]),
            f"{bound:.1g}"]


def table(name, groups):
    lines = ["| " + " | ".join((name,) + HEAD) + " |", "|---" * (len(HEAD) + 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(map(str, [key] + cells(t))) + " |" for key, t in groups.items()]) + "\n"


def beds_table(groups):
    lines = ["| problem | problems | with `implicit` | of these made implicit steps | with `automatic` | of these made implicit steps | "
             "steps | of these implicit |", "|---" * 8 + "|"]
    for key, t in groups.items():
        if t["implicit"] + t["automatic"]:
            lines.append("| " + " | ".join(str(x) for x in (
                key, t["runs"], t["implicit"], t["implicit_made"], t["automatic"], t["automatic_made"], t["steps"],
                percent(t["beds"], t["steps"]))) + " |")
    return "\n".join(lines) + "\n"


def part(scheme, *places):
    return "/".join(scheme.split("/")[i] for i in places)


def foam_table(rows):
    lines = ["| what | problems | ours | rhoCentralFoam |", "|---|---|---|---|"]
    classes = {"all": lambda r: True, "1D": lambda r: r["dim"] == "1", "2D": lambda r: r["dim"] == "2",
               "pressure ratio up to 100, Mach up to 3": lambda r: float(r["pressureRatio"]) <= 100 and float(r["mach"]) <= 3,
               "pressure ratio up to 1e4": lambda r: float(r["pressureRatio"]) <= 1e4,
               "pressure ratio above 1e4": lambda r: float(r["pressureRatio"]) > 1e4,
               "Mach above 10": lambda r: float(r["mach"]) > 10}
    for name, holds in classes.items():
        some = [r for r in rows if holds(r)]
        lines.append(f"| {name} | {len(some)} | {sum(int(r['ours']) for r in some)} | {sum(int(r['rhoCentralFoam']) for r in some)} |")
    whys = {}
    for r in rows:
        if r["why"]:
            whys[r["why"]] = whys.get(r["why"], 0) + 1
    return "\n".join(lines) + "\n\nIts ends: " + "; ".join(f"{n} times {why}" for why, n in whys.items()) + ".\n"


def sentence(t):
    """Of all problems of a table: how they ended."""
    return (f"Of {t['runs']:,} problems {t['finished']:,} ({percent(t['finished'], t['runs'])}) ran to their end, {t['capped']:,} "
            f"({percent(t['capped'], t['runs'])}) were stopped at the bound of steps, {t['collapsed'] + t['stated']:,} ended with a "
            f"stated cause ({t['collapsed']:,} of them a collapse), {t['failed']:,} failed.")


def text(default, others, foam, notes):
    """The report from the tables' paths; None: that part was not run. notes: what notes.md leaves open."""
    rows = read(default)
    total = add(rows)
    with open(os.path.join(os.path.dirname(__file__), "notes.md")) as f:
        parts = [f.read().format(runs=f"{total['runs']:,}", failed=total["failed"] or "no", sentence=sentence(total), **notes)]
    parts += ["## The default schemes\n", table("problem", {**grouped(rows, lambda r: r["problem"]), "**all**": total})]
    parts += ["## Implicit acoustics\n", BEDS, beds_table({**grouped(rows, lambda r: r["problem"]), "**all**": total})]
    if others:
        rows = read(others)
        cells = [r for r in rows if r["problem"] in ("triangles", "tetrahedra", "badCells") or part(r["scheme"], 1) in ("linear", "CWENO3")]
        parts += ["## All other schemes\n\nEvery Runge-Kutta row at the largest Courant number it states.\n", sentence(add(rows)) + "\n"]
        parts += ["On lattices:\n", table("flux/reconstruction", grouped([r for r in rows if r not in cells], lambda r: part(r["scheme"], 0, 1)))]
        parts += ["On polyhedra:\n", table("flux/polynomial", grouped(cells, lambda r: part(r["scheme"], 0, 1)))]
        parts += ["By time scheme:\n", table("time scheme/maxCo", grouped(rows, lambda r: part(r["scheme"], 2, 3)))]
    if foam:
        parts += ["## The elastic dilute problems by rhoCentralFoam\n", foam_table(read(foam))]
        parts += ["One has finished if it came to the end time with all values finite and T and p above zero everywhere; the step of ours is "
                  "not limited here.\n"]
    return "\n".join(parts)
