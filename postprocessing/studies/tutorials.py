#!/usr/bin/env -S /usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tutorials of OpenFOAM through `haff fromOpenFOAM`, beside what OpenFOAM itself makes of them.

    haff tutorials FOLDER [NAME ..] [-from EXAMPLES] [-coarse] [-keep]

Each tutorial is copied, its mesh made with several numbers of cells (the tutorial's times a factor), and run by its own solver and, as
converted, by granularGas, with the schemes and the time step of both as the tutorial and the conversion have them. FOLDER gets all runs and
tutorials.md, a table of all that were run into it: mean differences of rho, U, T (R times kelvin) and p over the range of each field (the
measure of `haff crossCheck`), and the errors of rho of both against granularGas on twice the cells of the finest grid, or against the exact
solution of a shock tube.

NAME: shockTube, obliqueShock, wedge15Ma5, forwardStep, sonicForwardStep, sonicShockTube, prism (all of them). EXAMPLES: the folder of Debian's package
openfoam-examples (a copy will do: its files may be zipped). -coarse: the first grid only. -keep: the table goes into docs/fromOpenFOAM.md.
Exit code 77: OpenFOAM or its examples are not there.
"""
import os
import re
import shutil
import subprocess
import sys

import numpy as np

import haff
from haff import command
from haff.case import entries
from haff.case.geometry import Geometry
from haff.openfoam import dictionary, fromOpenFOAM
from haff.openfoam.gas import Gas
from haff.openfoam.report import Report
from haff.paths import program
from studies.crossCheck import order, timed
from studies.exact.eos import PerfectGas
from studies.exact.riemann import Riemann
from studies.made import rhocentral, twin
from studies.measured import comparison
from studies.measured.comparison import FIELDS
from studies.source import of_source

EXAMPLES = "/usr/share/doc/openfoam-examples/examples"
MARK = "<!-- made by haff tutorials -->"


class Tutorial:
    """folder: in EXAMPLES; factors: times the cells of the tutorial along each axis; end: time, or None for the tutorial's."""

    def __init__(self, folder, factors, end=None, exact=False):
        self.folder, self.factors, self.end, self.exact = "compressible/" + folder, factors, end, exact


TUTORIALS = {
    "shockTube": Tutorial("rhoCentralFoam/shockTube", (1, 2, 4), exact=True),
    "obliqueShock": Tutorial("rhoCentralFoam/obliqueShock", (1, 2)),
    "wedge15Ma5": Tutorial("rhoCentralFoam/wedge15Ma5", (0.5, 1)),
    "forwardStep": Tutorial("rhoCentralFoam/forwardStep", (0.25, 0.5, 1)),
    "sonicForwardStep": Tutorial("sonicFoam/laminar/forwardStep", (0.4, 0.8), end=4),
    "sonicShockTube": Tutorial("sonicFoam/laminar/shockTube", (0.25, 0.5, 1), exact=True),
    "prism": Tutorial("sonicFoam/RAS/prism", (0.5, 1)),
}


def unzip(folder):
    """Debian zips what is long."""
    for path, _, names in os.walk(folder):
        for name in names:
            if name.endswith(".gz"):
                subprocess.run(["gunzip", "-f", os.path.join(path, name)], check=True)


def more_cells(path, factor):
    """blockMeshDict with other numbers of cells; an axis of one cell keeps it."""
    text = entries.read(path)
    times = lambda n: n if n == "1" else str(max(1, round(int(n) * factor)))
    text, found = re.subn(r"(hex\s*\([\d\s]+\)\s*)\(\s*(\d+)\s+(\d+)\s+(\d+)\s*\)",
                          lambda m: f"{m[1]}({' '.join(times(m[k]) for k in (2, 3, 4))})", text)
    if not found:
        raise twin.Refused(f"{path}: there are no numbers of cells in its blocks")
    with open(path, "w", encoding="latin-1") as f:
        f.write(text)


def prepare(source, case, factor, end):
    """A copy of a tutorial on a mesh of its own: no more than the end is written."""
    shutil.rmtree(case, ignore_errors=True)
    shutil.copytree(source, case)
    unzip(case)
    more_cells(os.path.join(case, "system", "blockMeshDict"), factor)
    control = os.path.join(case, "system", "controlDict")
    d = dictionary.read(control)
    end = float(d["endTime"]) if end is None else end
    changes = {"endTime": end, "writeInterval": end, "writeControl": "adjustableRunTime" if d.get("adjustTimeStep") == "yes" else "runTime",
               "+writePrecision": 12, "+deltaT": float(d["deltaT"]) / max(1, factor), "functions": None}
    entries.edit(control, {key: value for key, value in changes.items() if key.lstrip("+") in d})
    return end


def foam(case, *words):
    done = subprocess.run([*words, "-case", case], capture_output=True, text=True, env=rhocentral.ENVIRONMENT)
    if done.returncode:
        raise twin.Refused(f"{' '.join(words)} failed on {case}: {(done.stderr or done.stdout).strip()[-500:]}")


class Pair:
    """A tutorial on one grid: both results, CPU seconds."""

    def __init__(self, o, name, tutorial, factor):
        self.folder = os.path.join(o.out, f"{name}-{factor:g}")
        self.factor, self.foam, self.ours = factor, os.path.join(self.folder, "openfoam"), os.path.join(self.folder, "haff")
        self.end = prepare(os.path.join(o.examples, tutorial.folder), self.foam, factor, tutorial.end)
        self.solver = dictionary.read(os.path.join(self.foam, "system", "controlDict"))["application"]
        shutil.rmtree(self.ours, ignore_errors=True)
        fromOpenFOAM.convert(self.foam, self.ours)  # before OpenFOAM touches the case
        self.gas = Gas(self.foam, Report())

    def run(self, core):
        foam(self.foam, "blockMesh")
        if os.path.isdir(os.path.join(self.foam, "0.orig")):
            shutil.copytree(os.path.join(self.foam, "0.orig"), os.path.join(self.foam, "0"))
        if os.path.exists(os.path.join(self.foam, "system", "setFieldsDict")):
            foam(self.foam, "setFields")
        self.cpu = (self.run_ours(core), timed([self.solver], self.foam, core))
        self.states = (self.state(self.ours, 1), self.state(self.foam, self.gas.R))
        self.geometry = Geometry(haff.Case(self.ours))
        scales = {f: comparison.scale(self.states[1][f]) for f in FIELDS}
        self.apart = comparison.difference(self.geometry, *self.states, scales)
        return self

    def run_ours(self, core):
        return timed([program("granularGas")], self.ours, core)

    @staticmethod
    def state(path, R):
        case = haff.Case(path)
        found = {f: case.field(f) for f in ("U", "T", "p")}
        found["T"] = R * found["T"]
        return {**found, "rho": found["p"] / found["T"]}

    def against(self, known):
        """Mean errors of rho, of both, over its range in what is known."""
        scales = {f: comparison.scale(known[f]) for f in FIELDS}
        self.errors = [comparison.difference(self.geometry, s, known, scales)["rho"] for s in self.states]


def exact_tube(pair):
    """The exact solution of a shock tube with gas at rest on both sides of x = 0, in the cells."""
    d = dictionary.read(os.path.join(pair.foam, "system", "setFieldsDict"))
    values = lambda text: [float(re.findall(rf"\b{name}\s+(\S+)", text)[0]) for name in ("T", "p")]
    sides = [(p / (pair.gas.R * T), 0.0, p) for T, p in (values(d["defaultFieldValues"]), values(d["regions"]))]
    x = np.sort(pair.geometry.at[:, 0])
    edges = np.concatenate(([1.5 * x[0] - 0.5 * x[1]], (x[1:] + x[:-1]) / 2, [1.5 * x[-1] - 0.5 * x[-2]]))
    rho, u, p = Riemann(PerfectGas(pair.gas.gamma), *sides).averages(edges, 0.0, pair.end)
    back = np.argsort(np.argsort(pair.geometry.at[:, 0]))
    rho, u, p = rho[back], u[back], p[back]
    return {"rho": rho, "U": np.stack([u, 0 * u, 0 * u], axis=1), "T": p / rho, "p": p}


def fine_run(o, name, tutorial):
    """granularGas on twice the cells of the finest grid, in long steps."""
    pair = Pair(o, name, tutorial, 2 * max(tutorial.factors))
    entries.edit(os.path.join(pair.ours, "system", "fvSchemes"), {"timeScheme": "SSPRK43"})
    entries.edit(os.path.join(pair.ours, "system", "controlDict"), {"adjustTimeStep": "yes", "+maxCo": 1.5})
    print(f"{name}: granularGas on a finer grid, to compare with: {pair.run_ours(o.core):.1f} s", flush=True)
    return Geometry(haff.Case(pair.ours)), Pair.state(pair.ours, 1)


def study(o, name):
    """The Pairs of a tutorial."""
    tutorial, found = TUTORIALS[name], []
    fine = None if tutorial.exact or o.coarse else fine_run(o, name, tutorial)
    for factor in tutorial.factors[:1 if o.coarse else None]:
        pair = Pair(o, name, tutorial, factor).run(o.core)
        if tutorial.exact:
            pair.against(exact_tube(pair))
        elif fine:
            pair.against(pair.geometry.average(*fine))
        else:
            pair.errors = None
        print(f"{name}: {len(pair.geometry.at)} cells, CPU {pair.cpu[0]:.1f} s and {pair.cpu[1]:.1f} s, apart "
              + ", ".join(f"{f} {v:.3g}" for f, v in pair.apart.items()), flush=True)
        found.append(pair)
    return found


HEAD = ["| tutorial | cells | to t | rho apart (order) | U | T | p | error of rho: haff | its own solver | CPU s, haff / its own |", "|" + "---|" * 10]


def rows(name, pairs):
    """Of the table, a row for each grid."""
    lines = []
    for k, pair in enumerate(pairs):
        grown = f" ({order(pairs[k - 1], pair, lambda r: r.apart['rho']):.2f})" if k else ""
        errors = [f"{e:.4f}" for e in pair.errors] if pair.errors else ["", ""]
        cells = f"{len(pair.geometry.at)}{' (as shipped)' if pair.factor == 1 else ''}"
        title = name if k == 0 else ""
        lines.append(f"| {title} | {cells} | {pair.end:g} | {pair.apart['rho']:.4f}{grown} | " + " | ".join(f"{pair.apart[f]:.4f}" for f in ("U", "T", "p"))
                     + f" | {' | '.join(errors)} | {pair.cpu[0]:.1f} / {pair.cpu[1]:.1f} |")
    return "".join(f"{line}\n" for line in lines)


def table(folder):
    """All tutorials that the folder has rows of."""
    text = "".join(f"{line}\n" for line in HEAD)
    for path in (os.path.join(folder, f"{name}.rows") for name in TUTORIALS):
        if os.path.exists(path):
            with open(path, encoding="utf-8") as f:
                text += f.read()
    return text


def keep(text):
    path = of_source("docs", "fromOpenFOAM.md")
    with open(path, encoding="utf-8") as f:
        head, _, tail = f.read().split(MARK)
    with open(path, "w", encoding="utf-8") as f:
        f.write(f"{head}{MARK}\n{text}{MARK}{tail}")


def arguments():
    parser = command.parser(__doc__)
    parser.add_argument("out", metavar="FOLDER", help="folder of the runs and of tutorials.md")
    parser.add_argument("names", metavar="NAME", nargs="*", help=f"of {', '.join(TUTORIALS)} (all)")
    parser.add_argument("-from", dest="examples", default=EXAMPLES, metavar="EXAMPLES", help=f"({EXAMPLES})")
    parser.add_argument("-coarse", action="store_true", help="the first grid only, without errors")
    parser.add_argument("-keep", action="store_true", help="writes the table into docs/fromOpenFOAM.md")
    o = parser.parse_args()
    unknown = [name for name in o.names if name not in TUTORIALS]
    if unknown:
        parser.error(f"there is no tutorial {unknown[0]} here; there are {', '.join(TUTORIALS)}")
    o.out, o.core = os.path.abspath(o.out), max(os.sched_getaffinity(0))
    return o


def main():
    o = arguments()
    if not rhocentral.installed() or not os.path.isdir(o.examples):
        print(f"{o.examples} is not there: install Debian's package openfoam-examples, or say -from FOLDER" if rhocentral.installed() else
              f"{rhocentral.MISSING}: no comparison")
        return 77
    os.makedirs(o.out, exist_ok=True)
    try:
        for name in o.names or TUTORIALS:
            made = rows(name, study(o, name))
            with open(os.path.join(o.out, f"{name}.rows"), "w", encoding="utf-8") as f:
                f.write(made)
    except (twin.Refused, ValueError, OSError) as why:
        print(f"error: {why}", file=sys.stderr)
        return 1
    text = table(o.out)
    with open(os.path.join(o.out, "tutorials.md"), "w", encoding="utf-8") as f:
        f.write(text)
    print(text)
    if o.keep:
        keep(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
