#!/usr/bin/env -S /usr/bin/python3
"""postprocessing/reports/stress.md from the tables that stress and rhoCentralFoam.py write.

    report.py DEFAULT.csv OTHERS.csv FOAM.csv NOTES.md > postprocessing/reports/stress.md

NOTES.md goes in front: what was run, when, on what.
"""
import csv
import sys

SUMS = ("runs", "finished", "capped", "collapsed", "failed", "steps", "cell_stages", "limited_cells", "limited_faces", "floored",
        "rejected")
LARGEST = ("mass", "momentum", "energy", "mass_bound", "momentum_bound", "energy_bound", "source_bound")
HEAD = ("problems", "finished", "capped", "collapsed", "failed", "limited cells", "limited faces", "floored cells", "rejected steps",
        "least dt", "mass", "momentum", "energy", "of bound")


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
    return [t["runs"], percent(t["finished"], t["runs"]), percent(t["capped"], t["runs"]), percent(t["collapsed"], t["runs"]),
            t["failed"], percent(t["limited_cells"], t["cell_stages"]), percent(t["limited_faces"], t["cell_stages"]), t["floored"],
            percent(t["rejected"], t["steps"]), f"{t['least_dt']:.1g}", error(t["mass"]), error(t["momentum"]), error(t["energy"]),
            f"{bound:.1g}"]


def table(name, groups):
    lines = ["| " + " | ".join((name,) + HEAD) + " |", "|---" * (len(HEAD) + 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(map(str, [key] + cells(t))) + " |" for key, t in groups.items()]) + "\n"


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


def main():
    default, others, foam = (read(path) for path in sys.argv[1:4])
    with open(sys.argv[4]) as f:
        print(f.read())
    families = grouped(default, lambda r: r["problem"])
    print("## The default schemes\n\n" + table("problem", {**families, "**all**": add(default)}))
    lattice = [r for r in others if r["problem"] not in ("triangles", "tetrahedra", "badCells")]
    polyhedral = [r for r in others if r not in lattice]
    print("## All other schemes\n\nEvery Runge-Kutta row at the largest Courant number it states.\n")
    print("On lattices:\n\n" + table("flux/reconstruction", grouped(lattice, lambda r: part(r["scheme"], 0, 1))))
    print("On polyhedra:\n\n" + table("flux/polynomial", grouped(polyhedral, lambda r: part(r["scheme"], 0, 1))))
    print("By time scheme:\n\n" + table("time scheme/maxCo", grouped(others, lambda r: part(r["scheme"], 2, 3))))
    print("## The elastic dilute problems by rhoCentralFoam\n\n" + foam_table(foam))


if __name__ == "__main__":
    main()
