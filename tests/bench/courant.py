#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""SSPRK43 at maxCo 2 against 1 in two dimensions, or smooth faces against none at maxCo 1: user seconds in turn, errors, what was
limited and rejected.

    courant.py [-smooth] [-bin build/bin] [-core N] [-references FOLDER] [PROBLEM...]

The problems are those of workPrecision and two more. `dense`: gas of grains at 500 kg/m^3, in which a disk of 1000 kg/m^3 is
three times as hot. `void`: grains at 100 kg/m^3 that fly apart from a point at Mach 4. Both are known from two schemes on 400 x 400
cells at maxCo 1/2; FOLDER keeps what that gave. postprocessing/reports/workPrecision.md says what came of it."""
import argparse
import os
import statistics
import sys
import tempfile

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "postprocessing"))

from haff.paths import folder_of_programs  # noqa: E402
from studies.exact.eos import GoldshteinShapiro  # noqa: E402
from studies.source import of_source  # noqa: E402
from studies.workPrecision import Haff  # noqa: E402
from studies.workPrecisionProblems import PROBLEMS, Referenced  # noqa: E402

GAS = GoldshteinShapiro(1.0)
SCHEME = {"flux": "common", "reconstruct": "WPENO5", "stepper": "SSPRK43"}


class Dense(Referenced):
    name, title, two_dimensional = "dense", "a hot disk of twice the density in dense gas", True
    fine, store, scale, end = 400, 400, 500.0, float("%.4g" % (0.25 / GAS.c(700.0, 1.0)))

    def initial(self, at):
        inside = np.hypot(at[:, 0] - 0.45, at[:, 1] - 0.55) < 0.25
        rho = np.where(inside, 1000.0, 500.0)
        return rho, np.zeros((len(at), 3)), GAS.p(rho, 1.0) * np.where(inside, 3.0, 1.0)


class Void(Referenced):
    name, title, two_dimensional = "void", "gas that flies apart from a point at Mach 4", True
    fine, store, scale, end = 400, 400, 100.0, float("%.4g" % (0.25 / (4 * GAS.c(100.0, 1.0))))

    def initial(self, at):
        x, y = at[:, 0] - 0.5, at[:, 1] - 0.5
        r = np.hypot(x, y) + 1e-12
        rho, speed = 100.0 + 0 * r, 4 * GAS.c(100.0, 1.0) * np.minimum(1, r / 0.1)
        return rho, np.stack([speed * x / r, speed * y / r, 0 * r], axis=1), GAS.p(rho, 1.0)


GRIDS = {"vortex": (80, 160), "shear": (32, 64), "riemann2D": (100, 200), "step": (100, 200), "wedge": (100, 200), "dense": (50, 100),
         "void": (50, 100)}
LINES = {"wave": (100, 200), "sod": (400, 1600), "shuOsher": (400, 800), "blast": (1000, 4000), "burst": (100, 400), "headOn": (100, 400),
         "contact": (100, 400), "parting": (100, 400)}  # for -smooth


def run(program, problem, n, courant=1.0, **scheme):
    with tempfile.TemporaryDirectory() as case:
        values, entry = program.run(problem, case, n, **{**SCHEME, "courant": courant, **scheme})
    if values is None:
        sys.exit(f"{problem.name} on {n} cells at maxCo {courant} failed: {entry['net']}")
    return values, entry


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problems", nargs="*", default=[])
    parser.add_argument("-smooth", action="store_true")
    parser.add_argument("-bin", default=folder_of_programs())
    parser.add_argument("-core", type=int, default=0)
    parser.add_argument("-references", default=None)
    o = parser.parse_args()
    grids = {**LINES, **GRIDS} if o.smooth else GRIDS
    if not set(o.problems) <= set(grids):
        parser.error("the problems are " + ", ".join(grids))
    pair = [{"flux": f"common; commonCoeffs {{ smooth {word}; }}", "courant": 1.0} for word in ("no", "yes")] if o.smooth else \
        [{"courant": courant} for courant in (1.0, 2.0)]
    program, known = Haff(o.bin, o.core, 1), {p.name: p for p in (*PROBLEMS, Dense(), Void())}
    for problem in (known[name] for name in o.problems or grids):
        if isinstance(problem, Referenced):
            folder = o.references or tempfile.mkdtemp(prefix="courant")
            if not problem.load([of_source("postprocessing", "references"), folder]):
                problem.keep(folder, [run(program, problem, problem.fine, 0.5, flux=f, reconstruct=r)[0] for f, r in problem.pair])
        for n in grids[problem.name]:
            pairs = [[run(program, problem, n, **scheme) for scheme in pair] for _ in range(3 if n <= 100 else 2)]
            (one, a), (two, b) = pairs[0]
            errors = [float(problem.error(n, values)) for values in (one, two)]
            print(f"{problem.name} {n}: steps {a['steps']}, {b['steps']}; {a['user']:.3g} s, "
                  f"{statistics.median(x[1]['user'] / max(y[1]['user'], 1e-3) for x, y in pairs):.2f} times as fast; "
                  f"error {errors[0]:.3g}, {100 * (errors[1] / errors[0] - 1):+.1f} %; limited '{a['net']}', '{b['net']}'", flush=True)


if __name__ == "__main__":
    main()
