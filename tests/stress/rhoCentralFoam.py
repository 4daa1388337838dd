#!/usr/bin/env -S /usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The problems `elastic` of stress (two random states of a perfect gas, e = 1, closed box, 1D and 2D) by OpenFOAM's rhoCentralFoam.

    rhoCentralFoam.py [-count 60] [-courant 0.2] [-bin build/bin] [-table FILE] [-keep FOLDER]

Each problem goes to both programs on the same cells to the same end: ours with the default schemes, rhoCentralFoam with its
usual ones (Kurganov, vanLeer, Euler, maxCo 0.2), in units in which the fastest wave has 300 m/s and the largest density is
1 kg/m^3. One has finished if it ended at the end time with all values finite and T, p > 0 everywhere. Exit code 0: ours finished
all; 77: rhoCentralFoam is not installed.
"""
import argparse
import csv
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "postprocessing"))

import haff  # noqa: E402
from studies.made import boxes, rhocentral  # noqa: E402

ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Problem:
    def __init__(self, stress, seed):
        self.command = [stress, "-problem", "elastic", "-seed", str(seed), "-cap", "100000"]
        text = subprocess.run(self.command + ["-export"], capture_output=True, text=True, env=ENVIRONMENT).stdout.split("\n", 1)
        words = text[0].split()
        self.dim, self.n, self.gamma, self.end = int(words[0]), [int(w) for w in words[1:4]], float(words[4]), float(words[5])
        values = np.array(text[1].split(), float).reshape(-1, 5)
        self.rho, self.u, self.T = values[:, 0], values[:, 1:4], values[:, 4]

    def ours(self):
        done = subprocess.run(self.command, capture_output=True, text=True, env=ENVIRONMENT)
        found = re.search(r"/1: (\w+), (\d+) steps", done.stdout)
        return done.returncode == 0 and found.group(1) == "finished", int(found.group(2))

    def write(self, case, courant):
        speed = np.max(np.linalg.norm(self.u, axis=1) + np.sqrt(self.gamma * self.T)) / 300
        rho, u, T = self.rho / self.rho.max(), self.u / speed, self.T / speed**2
        patches = boxes.write_mesh(case, self.n, (1.0, 1.0, 1.0))
        walls = {name: kind if kind == "empty" else "zeroGradient" for name, kind in patches.items()}
        slip = {name: kind if kind == "empty" else "slip" for name, kind in patches.items()}
        rhocentral.write(case, self.gamma, self.end * speed, courant, {"p": rho * T, "U": u, "T": T},
                         {"p": walls, "U": slip, "T": walls})

    def theirs(self, case, courant):
        """(finished?, steps, what was wrong)"""
        self.write(case, courant)
        done = subprocess.run(["rhoCentralFoam", "-case", case], capture_output=True, text=True, env=rhocentral.ENVIRONMENT)
        steps = len(re.findall(r"^Time = ", done.stdout, re.M))
        if done.returncode:
            said = done.stdout + done.stderr
            fatal = re.search(r"FATAL ERROR.*?\n\s*(.+)", said)
            return False, steps, fatal.group(1).strip() if fatal else \
                "floating-point exception" if "sigFpe" in said or done.returncode == -8 else f"exit code {done.returncode}"
        written = haff.Case(case)
        T, p, u = written.field("T"), written.field("p"), written.field("U")
        if not (np.isfinite(T).all() and np.isfinite(p).all() and np.isfinite(u).all()):
            return False, steps, "values not finite"
        if T.min() <= 0 or p.min() <= 0:
            return False, steps, "T or p not above zero"
        return True, steps, ""


def row(stress, seed, folder, courant):
    problem = Problem(stress, seed)
    if problem.dim > 2:
        return None
    mach = np.linalg.norm(problem.u, axis=1) / np.sqrt(problem.gamma * problem.T)
    p = problem.rho * problem.T
    finished, steps = problem.ours()
    other, their_steps, why = problem.theirs(os.path.join(folder, f"elastic{seed}"), courant)
    return {"seed": seed, "dim": problem.dim, "pressureRatio": "%.2g" % (p.max() / p.min()),
            "densityRatio": "%.2g" % (problem.rho.max() / problem.rho.min()), "mach": "%.3g" % mach.max(), "ours": int(finished),
            "ourSteps": steps, "rhoCentralFoam": int(other), "itsSteps": their_steps, "why": why}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-count", type=int, default=60)
    parser.add_argument("-courant", type=float, default=0.2, help="maxCo of rhoCentralFoam")
    parser.add_argument("-bin", default=os.path.join(ROOT, "build", "bin"))
    parser.add_argument("-table")
    parser.add_argument("-keep")
    o = parser.parse_args()
    if not rhocentral.installed():
        print(rhocentral.MISSING)
        return 77
    rows, seed = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        while len(rows) < o.count:
            found = row(os.path.join(o.bin, "stress"), seed, o.keep or scratch, o.courant)
            if found:
                rows.append(found)
                print(found, flush=True)
            seed += 1
    if o.table:
        with open(o.table, "w", newline="") as f:
            table = csv.DictWriter(f, rows[0], lineterminator="\n")
            table.writeheader()
            table.writerows(rows)
    ours, theirs = sum(r["ours"] for r in rows), sum(r["rhoCentralFoam"] for r in rows)
    print(f"{len(rows)} problems: ours finished {ours}, rhoCentralFoam {theirs}")
    return 0 if ours == len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
