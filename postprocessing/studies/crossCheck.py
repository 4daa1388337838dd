#!/usr/bin/env -S /usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A case in the elastic limit by granularGas and by OpenFOAM's rhoCentralFoam, compared.

    crossCheck CASE [--grids N1,N2,..] [--fine N] [--out FOLDER] [--quick] [--courant C] [--bin FOLDER] [--core N]
    crossCheck --limits [--out FOLDER] [--quick] [--bin FOLDER] [--core N]

writes the equivalent rhoCentralFoam case on the same constant/polyMesh (Kurganov, vanLeer, Euler), runs both, compares rho, U,
T, p in the mean (over the range of the field) and the positions of shocks (steepest gradient of rho along given lines), and
tells which is nearer to the exact solution, or to granularGas on a finer grid. Without --grids: the GRIDS below, else the mesh
that the case has.
FOLDER (default: a new temporary one) gets NAME.md, NAME.csv, NAME.png and all cases that were run.

A case may say more in its file crossCheck.py: GRIDS, QUICK (for --quick), FINE, FINE_SCHEMES (entries of fvSchemes for
that run), COURANT, LINES = {name: (start, end)},
exact(case, time) = {"rho", "U", "T", "p"} or None.

--limits: granularGas itself towards the perfect gas, on the blast of cases/blast: grain diameter to 0, restitution to 1.

Exit code 0: every shock agrees within a cell, and the differences shrink from grid to grid; 1: the case is refused, or a
program failed; 2: wrong arguments; 3: the two disagree; 77: rhoCentralFoam is not installed.
"""
import csv
import importlib.util
import os
import subprocess
import sys
import tempfile
from types import SimpleNamespace

import numpy as np

import haff
from haff import command
from haff.case.geometry import Geometry
from haff.paths import folder_of_programs
from studies.made import rhocentral, twin
from studies.measured import comparison
from studies.measured.comparison import FIELDS
from studies.source import measured_by, of_source

sys.dont_write_bytecode = True  # beside the cases' crossCheck.py
OURS, FOAM = "haff", "rhoCentralFoam"


def settings(case):
    """crossCheck.py of the case."""
    standard = SimpleNamespace(GRIDS=(), QUICK=(), FINE=None, FINE_SCHEMES="", COURANT=0.2, LINES={}, exact=lambda case, time: None)
    path = os.path.join(case, "crossCheck.py")
    if os.path.exists(path):
        spec = importlib.util.spec_from_file_location("case_crossCheck", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        standard.__dict__.update({k: v for k, v in vars(module).items() if k in vars(standard)})
    return standard


def timed(command, case, core):
    """Runs a solver on a core; CPU seconds."""
    with open(os.path.join(case, "log"), "w") as f:
        child = subprocess.Popen(["taskset", "-c", str(core), *command, "-case", case], stdout=f, stderr=subprocess.STDOUT,
                                 env=rhocentral.ENVIRONMENT)
        _, state, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(state)
    if child.returncode:
        with open(f.name) as f:
            raise twin.Refused(f"{' '.join(command)} failed on {case}: {f.read().strip().splitlines()[-1]}")
    return usage.ru_utime + usage.ru_stime


def last(path):
    case = haff.Case(path)
    return case, {name: case.field(name) for name in FIELDS}


def fine_run(o, cells, entries):
    """Geometry and state of granularGas on a fine grid, with entries of fvSchemes changed."""
    folder = os.path.join(o.out, f"fine{cells}")
    both = twin.Twin(o.case, folder, o.bin, o.courant, cells)
    twin.append(os.path.join(both.ours, "system", "fvSchemes"), f"\n{entries}\n")
    print(f"{o.name}: {OURS} on {cells} cells, to compare with: {timed([o.granular_gas], both.ours, o.core):.1f} s", flush=True)
    case, state = last(both.ours)
    return Geometry(case), state


def compare(o, cells, known, fine):
    """Runs both on a grid."""
    both = twin.Twin(o.case, os.path.join(o.out, str(cells or "mesh")), o.bin, o.courant, cells)
    cpu = {OURS: timed([o.granular_gas], both.ours, o.core), FOAM: timed([FOAM], both.foam, o.core)}
    (case, ours), (_, foam) = last(both.ours), last(both.foam)
    r = SimpleNamespace(case=case, cells=cells or case.mesh.cells, cpu=cpu, geometry=Geometry(case), end=both.end)
    r.states = {OURS: ours, FOAM: foam}
    r.known = known.exact(case, both.end) or (r.geometry.average(*fine) if fine else None)
    r.scales = {name: comparison.scale((r.known or ours)[name]) for name in FIELDS}
    r.apart = comparison.difference(r.geometry, ours, foam, r.scales)
    r.errors = {code: comparison.difference(r.geometry, s, r.known, r.scales) for code, s in r.states.items()} if r.known else {}
    every = {**r.states, **({"known": r.known} if r.known else {})}
    r.shocks = {name: {code: comparison.shock(r.geometry, s["rho"], line) for code, s in every.items()}
                for name, line in known.LINES.items()}
    print(f"{o.name}: {r.cells} cells, CPU {cpu[OURS]:.2f} s and {cpu[FOAM]:.2f} s, apart "
          + ", ".join(f"{name} {v:.3g}" for name, v in r.apart.items()), flush=True)
    return r


def order(coarse, fine, value):
    """Of convergence between two grids."""
    a, b = value(coarse), value(fine)
    return np.log(a / b) / np.log(coarse.geometry.h / fine.geometry.h) if a > 0 and b > 0 else np.nan


def table(head, rows):
    return [measured_by("haff crossCheck CASE"), "", "| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows), ""]


def with_orders(results, value):
    """A column: numbers with the order from the grid before."""
    return [f"{value(r):.3g}" + (f" ({order(results[k - 1], r, value):.2f})" if k else "") for k, r in enumerate(results)]


def columns(results, head, values):
    """Rows of a table with a row per grid and a column per function of a result."""
    cells = [[str(r.cells) for r in results], *(with_orders(results, v) for v in values)]
    return table(["cells", *head], zip(*cells))


def shock_table(results, what):
    rows = []
    for r in results:
        for name, s in r.shocks.items():
            known = [f"{s['known']:.5g}"] if "known" in s else []
            rows.append([str(r.cells), name, f"{s[OURS]:.5g}", f"{s[FOAM]:.5g}", *known, f"{abs(s[OURS] - s[FOAM]) / r.geometry.h:.2f}"])
    return table(["cells", "shock", OURS, FOAM, *([what] if results[0].known else []), "apart, in cells"], rows) if rows else []


def nearer(r, what):
    """Who is nearer to what is known, and where the two differ most."""
    lines = []
    for name in FIELDS:
        cell, place = comparison.worst(r.geometry, r.states[OURS], r.states[FOAM], name)
        say = lambda v: " ".join(f"{c:.4g}" for c in np.atleast_1d(v)[:max(len(r.geometry.axes), 1)])
        text = (f"* {name} differs most at ({' '.join(f'{x:.4g}' for x in place)}): {OURS} {say(r.states[OURS][name][cell])}, {FOAM} "
                f"{say(r.states[FOAM][name][cell])}")
        if r.known:
            ours, foam = (r.errors[code][name] for code in (OURS, FOAM))
            text += (f", {what} {say(r.known[name][cell])}. In the mean {OURS if ours < foam else FOAM} is nearer: {ours:.3g} against "
                     f"{foam:.3g}")
        lines.append(text + ".")
    return lines + [""]


def verdicts(results):
    """(sentence, holds)."""
    found = []
    if len(results) > 1:
        shrinks = all(b.apart[f] < a.apart[f] for a, b in zip(results, results[1:]) for f in FIELDS)
        orders = ", ".join(f"{f} {order(results[0], results[-1], lambda r: r.apart[f]):.2f}" for f in FIELDS)
        text = f"The differences {'shrink' if shrinks else 'DO NOT shrink'} from grid to grid, with the orders {orders} over all grids"
        if results[0].known:
            text += f"; the errors of {FOAM} with " + ", ".join(
                f"{f} {order(results[0], results[-1], lambda r: r.errors[FOAM][f]):.2f}" for f in FIELDS)
        found.append((text + ".", shrinks))
    gaps = [(abs(s[OURS] - s[FOAM]) / r.geometry.h, name, r.cells) for r in results for name, s in r.shocks.items()]
    if gaps:
        most, name, cells = max(gaps)
        found.append((f"Shocks {'agree within a cell' if most <= 1 else 'DO NOT agree within a cell'}: at most {most:.2f} cells apart "
                      f"({name}, {cells} cells).", most <= 1))
    return found


def report(o, results, what, found):
    lines = [f"## {o.name}", "", *(text for text, _ in found), "",
             "Mean differences between the two, over the field's range (order from the grid before):", ""]
    lines += columns(results, FIELDS, [lambda r, f=f: r.apart[f] for f in FIELDS])
    if results[0].known:
        lines += [f"Mean errors against the {what}:", ""]
        lines += columns(results, [f"{f}, {code}" for f in ("rho", "p") for code in (OURS, FOAM)],
                         [lambda r, f=f, c=c: r.errors[c][f] for f in ("rho", "p") for c in (OURS, FOAM)])
    lines += shock_table(results, what)
    lines += [f"On {results[-1].cells} cells:", "", *nearer(results[-1], what)]
    lines += [f"CPU seconds, {OURS} / {FOAM} at maxCo {o.courant:g}: "
              + ", ".join(f"{r.cpu[OURS]:.2f} / {r.cpu[FOAM]:.2f} ({r.cells})" for r in results) + ".", ""]
    with open(os.path.join(o.out, f"{o.name}.md"), "w") as f:
        f.write("\n".join(lines))
    print("\n".join(lines))


def numbers(o, results):
    with open(os.path.join(o.out, f"{o.name}.csv"), "w", newline="") as f:
        out = csv.writer(f, lineterminator="\n")
        out.writerow(("case", "cells", "h", "quantity", "name", "value"))
        for r in results:
            row = lambda quantity, name, value: out.writerow((o.name, r.cells, f"{r.geometry.h:.8g}", quantity, name, f"{value:.6g}"))
            for name, value in r.apart.items():
                row("difference", name, value)
            for code, errors in r.errors.items():
                for name, value in errors.items():
                    row(f"error {code}", name, value)
            for name, at in r.shocks.items():
                for code, value in at.items():
                    row(f"shock {code}", name, value)
            for code, value in r.cpu.items():
                row("cpu", code, value)


def check(o):
    if not os.path.isdir(os.path.join(o.case, "system")):
        raise twin.Refused(f"{o.case} is no case directory (it has no folder 'system')")
    known = settings(o.case)
    o.courant = o.courant or known.COURANT
    grids = o.grids or (known.QUICK if o.quick else known.GRIDS) or (None,)
    fine_cells = o.fine or (2 * max(grids) if o.quick and known.FINE else known.FINE)
    fine = fine_run(o, fine_cells, known.FINE_SCHEMES) if fine_cells else None
    results = [compare(o, cells, known, fine) for cells in grids]
    what = "fine grid" if fine else "exact solution"
    found = verdicts(results)
    report(o, results, what, found)
    numbers(o, results)
    from studies import crossCheckFigures
    crossCheckFigures.draw(os.path.join(o.out, f"{o.name}.png"), o.name, results[-1], what)
    return 0 if all(holds for _, holds in found) else 3


def arguments():
    parser = command.parser(__doc__)
    parser.add_argument("case", nargs="?", help="a case directory, or the name of one in cases/")
    parser.add_argument("--limits", action="store_true", help="the sweeps towards the perfect gas")
    parser.add_argument("--grids", default=None, help="values of N of mesh.geo, separated by commas")
    parser.add_argument("--fine", type=int, default=None, help="N of the run of granularGas to compare with")
    parser.add_argument("--out", default=None, help="folder of the results")
    parser.add_argument("--quick", action="store_true", help="small grids")
    parser.add_argument("--courant", type=float, default=None, help="maxCo of rhoCentralFoam (default: the case's, or 0.2)")
    parser.add_argument("--bin", default=folder_of_programs(), help="folder of granularGas")
    parser.add_argument("--core", type=int, default=max(os.sched_getaffinity(0)), help="the core everything runs on")
    o = parser.parse_args()
    if bool(o.case) == o.limits:
        parser.error("give a case, or --limits")
    try:
        o.grids = [int(n) for n in o.grids.split(",")] if o.grids else None
    except ValueError:
        parser.error(f"--grids {o.grids}: whole numbers separated by commas, e.g. 50,100,200")
    if o.case and not os.path.isdir(o.case):
        o.case = of_source("cases", o.case)
    o.name = os.path.basename(os.path.abspath(o.case)) if o.case else "limits"
    o.out = os.path.abspath(o.out or tempfile.mkdtemp(prefix="crossCheck"))
    o.granular_gas = os.path.join(o.bin, "granularGas")
    return o


def main():
    o = arguments()
    os.makedirs(o.out, exist_ok=True)
    if not o.limits and not rhocentral.installed():
        print(f"{rhocentral.MISSING}: no comparison")
        return 77
    try:
        if o.limits:
            from studies import crossCheckLimits
            return crossCheckLimits.sweep(o)
        return check(o)
    except twin.Refused as why:
        print("error: " + str(why).removeprefix("error: "), file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
