# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case with every combination of values of some entries, several runs at once, and makes a table.

    haff sweep CASE constant/granularProperties:grain/restitution=0.8,0.9 mesh:N=10,20 -folder F -cores 2

Each run has a folder in F; the table is F/sweep.csv. Ctrl-C stops the runs, which write their states; the same command goes on from
there, also with more values: what is finished is not run again. FILE.py of -measure holds a function measure(case), which gets each
finished run as a haff.Case and returns {column: number}. Exit code 1: a run has failed, and the table says why.
"""
import csv
import os
import runpy
import sys

from haff import command
from haff.runs import runCase
from haff.runs.sweep import sweep


def values(text):
    """The values between commas that stand in no brackets or quotes; numbers as numbers."""
    found, depth, quoted = [""], 0, False
    for letter in text:
        quoted ^= letter == '"'
        depth += 0 if quoted else (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0 and not quoted:
            found.append("")
        else:
            found[-1] += letter
    return [as_number(word.strip()) for word in found]


def as_number(word):
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            pass
    return word


def measure_of(path):
    if path is None:
        return None
    found = runpy.run_path(path).get("measure")
    if not callable(found):
        raise ValueError(f"{path} has no function measure(case)")
    return found


def show(path):
    """Prints sweep.csv in columns, and whether a run failed."""
    with open(path, newline="") as f:
        rows = [[word.split("\n")[0] for word in row] for row in csv.reader(f)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        print("  ".join(word.ljust(width) for word, width in zip(row, widths)).rstrip())
    print(os.path.relpath(path))
    return 1 if any("failed" in row for row in rows[1:]) else 0


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case")
    parser.add_argument("settings", nargs="+", metavar="FILE:ENTRY=VALUES")
    parser.add_argument("-folder", help="of the sweep (default: CASE-sweep)")
    parser.add_argument("-cores", type=int, default=2, metavar="N", help="cores to use at once (default 2)")
    parser.add_argument("-ranks", type=int, default=1, metavar="N", help="of MPI, of each run")
    parser.add_argument("-measure", metavar="FILE.py", help="a file with a function measure(case)")
    parser.add_argument("-quiet", action="store_true", help="no line of progress on stderr")
    o = parser.parse_args()
    folder = o.folder or f"{o.case.rstrip('/')}-sweep"

    def action():
        grid, mesh = runCase.settings(o.settings, values)
        sweep(o.case, grid, mesh=mesh, cores=o.cores, ranks=o.ranks, folder=folder, measure=measure_of(o.measure), progress=not o.quiet)
        return show(os.path.join(folder, "sweep.csv"))
    return runCase.reported(action, f"the same command goes on from there; {os.path.join(folder, 'sweep.csv')} has what is done")


if __name__ == "__main__":
    sys.exit(main())
