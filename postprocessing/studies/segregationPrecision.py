# SPDX-License-Identifier: GPL-3.0-or-later
"""Run time against error of granularSegregation: closures, iterations, fixed and adaptive steps.

    haff segregationPrecision FIGURE.png        with the programs in $HAFF_BIN (default build/bin)

The well mixed layer of cases/segregationLinear, D_r = 0.1, to t = 0.5 s, against Gray & Chugunov's exact solution; M nodes, M - 1 steps,
or adaptive with timeTolerance M^-2/10. Time: of the time loop, best of three, without writing.
"""
import os
import re
import shutil
import subprocess
import tempfile

import numpy as np

from haff import command
from haff.case import entries
from haff.paths import TOP, program
from haff.plot import figures
from studies.exact import segregation
from studies.measured import mixture

NODES = (51, 101, 201, 401, 801, 1601)
VARIANTS = (("conservative", "Newton", "no", 1), ("conservative", "Picard", "no", 1), ("conservative", "Newton", "no", 0),
            ("paper", "Newton", "no", 1), ("paper", "Picard", "no", 1), ("paper", "Newton", "no", 0), ("conservative", "Newton", "yes", 1))


def edit(path, **values):
    entries.edit(path, {f"+{key}": value for key, value in values.items()})


def make(folder, M):
    case = os.path.join(folder, str(M))
    for part in ("0.orig", "constant", "system", "mesh.geo"):
        source, target = os.path.join(TOP, "cases", "segregationLinear", part), os.path.join(case, part)
        if os.path.isdir(source):
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("polyMesh"))
        else:
            shutil.copy(source, target)
    subprocess.run(["gmsh", "-3", "-v", "2", "-setnumber", "M", str(M), case + "/mesh.geo", "-o", case + "/mesh.msh"], check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run([program("gmshToCase"), case + "/mesh.msh", "-case", case], check=True, stdout=subprocess.DEVNULL)
    return case


def solve(case):
    """Seconds of the time loop, and solves."""
    shutil.rmtree(os.path.join(case, "0.5"), ignore_errors=True)
    shutil.rmtree(os.path.join(case, "postProcessing"), ignore_errors=True)
    log = subprocess.run([program("granularSegregation"), "-case", case], check=True, capture_output=True, text=True).stdout
    steps, rate = re.search(r"(\d+) steps in .*, (\S+) million", log).groups()
    cells = int(re.search(r"(\d+) cells;", log).group(1))
    return int(steps) * cells / (1e6 * float(rate)), int(re.findall(r"(\d+) solves, ", log)[-1])


def measure(case, M, closure, iteration, adjust, damped):
    control = os.path.join(case, "system", "controlDict")
    edit(os.path.join(case, "system", "fvSchemes"), closure=closure)
    edit(os.path.join(case, "system", "fvSolution"), iteration=iteration, dampedSteps=damped, timeTolerance=repr(0.1 / M**2))
    edit(control, endTime=0.5, writeInterval=0.5, adjustTimeStep=adjust, deltaT=repr(0.5 / (M - 1)), writeControl="adjustableRunTime")
    with open(control) as f:
        text = f.read()
    with open(control, "w") as f:
        f.write(re.sub(r"^ *(mean|extreme) +\{[^}]*\}\n", "", text, flags=re.M))
    solve(case)
    y, phi = mixture.profile(case, 0.5)
    every = (M - 1) // 50
    exact = np.array(segregation.gray_chugunov(y[::every], 0.5, -1, 0.1, 0.5, 0.55), float)
    edit(control, writeControl="none")
    runs = [solve(case) for _ in range(3)]
    return min(r[0] for r in runs), np.max(np.abs(phi[::every] - exact)), runs[0][1]


def main():
    parser = command.parser(__doc__)
    parser.add_argument("figure", help="written; png, pdf or svg")
    target = parser.parse_args().figure
    found = {v: [] for v in VARIANTS}
    with tempfile.TemporaryDirectory() as folder:
        for M in NODES:
            case = make(folder, M)
            for v in VARIANTS:
                found[v].append(measure(case, M, *v))
    fig, axes = figures.panels(1, 1, width=5.5, height=3.8)
    ax = axes[0][0]
    print("closure iteration adaptive dampedSteps: nodes, seconds, error, solves")
    for k, (v, rows) in enumerate(found.items()):
        rows = np.array(rows)
        name = f"{v[0]}, {v[1]}" + (", adaptive" if v[2] == "yes" else "" if v[3] else ", no damped step")
        ax.loglog(1e3 * rows[:, 0], rows[:, 1], "so^vD*x"[k] + "-", markersize=4, label=name)
        for M, (seconds, error, solves) in zip(NODES, rows):
            print(f"{v[0]} {v[1]} {v[2]} {v[3]}: {M} {seconds:.5f} {error:.3e} {solves:.0f}")
    ax.legend(fontsize=7)
    figures.label(ax, "time of the loop (ms)", "largest error at 0.5 s")
    figures.save(fig, target)


if __name__ == "__main__":
    main()
