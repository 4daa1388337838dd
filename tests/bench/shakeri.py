#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run time against error of the scheme of Shakeri et al., and of its parts, beside the defaults.

    tests/bench/shakeri.py [-rounds 3] [-within SECONDS] PROBLEM ..      sedimentation, waves, sound, bed

prints one row a run: user seconds of the program alone, the least of the rounds, which go over all schemes in turn; its
ratio to the defaults' on the same grid; errors.
sedimentation: cases/sedimentation, relative L1 differences from the defaults on 800 cells (-reference: another number).
waves: inelastic spheres with transport in a periodic box; sound: the same without transport and sinks; relative L1
differences at the cells' centres from the defaults on 72^3 cells, through which goes a Fourier series.
bed: cases/bouncingBed with thinner and thinner gas, how much T and u alternate from cell to cell there.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

SOURCE = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path.insert(0, SOURCE)

from tests.cases import harness  # noqa: E402
from tests.cases.harness import boxes, haff  # noqa: E402

DEFAULTS = ("common", "WPENO5", "SSPRK43", "RKJ2")
PAPER = ("MUSTA", "WENO5", "SSPRK3", "gaussLegendre")
# flux, reconstruction, time scheme, diffusion: the defaults, the paper's, and each with one part of the other
SCHEMES = [DEFAULTS, PAPER, ("MUSTA", "WENO5", "SSPRK3", "implicitMidpoint"), ("MUSTA", "WENO5", "SSPRK3", "RKJ2"),
           ("FORCE", "WENO5", "SSPRK3", "RKJ2"), ("common", "WENO5", "SSPRK3", "RKJ2"), ("MUSTA", "WPENO5", "SSPRK43", "RKJ2"),
           ("common", "WPENO5", "SSPRK43", "implicit"), ("common", "WPENO5", "SSPRK43", "implicitMidpoint"),
           ("common", "WPENO5", "SSPRK43", "gaussLegendre")]


def choose(case, scheme):
    flux, reconstruct, stepper, diffusion = scheme
    boxes.write_dictionary(case, "system", "fvSchemes", f"fluxScheme {flux}; reconstruct {reconstruct}; timeScheme {stepper};\n")
    boxes.write_dictionary(case, "system", "fvSolution", f"diffusion {{ type {diffusion}; }}\n")


def timed(case, within):
    """(user seconds, log) of a run; None where it fails or takes too long."""
    with open(os.path.join(case, "log"), "w") as log:
        child = subprocess.Popen(["timeout", str(within), os.path.join(harness.BIN, "granularGas"), "-case", case], stdout=log,
                                 stderr=log)
        _, code, usage = os.wait4(child.pid, 0)
    with open(os.path.join(case, "log")) as log:
        text = log.read()
    return (usage.ru_utime, text) if code == 0 else (None, text)


def steps(log):
    return int(re.findall(r"(\d+) steps in", log)[-1])


def difference(found, known):
    return np.abs(found - known).sum() / np.abs(known).sum()


class Column:
    """cases/sedimentation: alpha and T at 50, 100 and 150 ms."""
    grids, fine, name = (50, 100, 200), 800, "cells, maxCo"
    columns = ("alpha 50 ms", "T 50 ms", "alpha 100 ms", "T 100 ms", "alpha 150 ms", "T 150 ms")

    def make(self, folder, cells, scheme, **control):
        case = harness.copy("sedimentation", folder)
        harness.mesh(case, cells)
        harness.edit(case, "system/controlDict", **{"writeInterval": 0.05, **control})
        choose(case, scheme)
        return case

    def result(self, case):
        run = haff.Case(case)
        return [run.field(f, t) for t in ("0.05", "0.1", "0.15") for f in ("alpha", "T")]

    def errors(self, found, reference, cells):
        mean = [q.reshape(cells, -1).mean(1) for q in reference]
        return [difference(a, b) for a, b in zip(found, mean)]


class Waves:
    """A smooth flow in a periodic box; coarse grids' centres lie between those of the reference."""
    grids, fine, name = (12, 18, 24, 36), 72, "cells a side, maxCo"
    columns = ("rho", "u", "T")
    transport, e, end = "GarzoDufty", 0.9, 0.3

    def make(self, folder, cells, scheme, **control):
        case = os.path.join(tempfile.mkdtemp(dir=folder), "waves")
        n, turn = (cells,) * 3, 2 * np.pi * boxes.centres((cells,) * 3, (1, 1, 1))
        x, y, z = turn.T
        eta = 0.2 * (1 + 0.3 * np.sin(x + y - z))
        rho = eta / (np.pi / 6 * 0.01**3)
        u = 0.5 * np.stack([np.sin(y) + np.cos(z), np.sin(z) * np.cos(x), np.cos(x + y)], axis=1)
        T = 1 + 0.2 * np.cos(x - 2 * z)
        boxes.box_case(case, n, (1, 1, 1), rho, u, rho * T, self.end, types={a: "cyclic" for a in "xyz"}, e=self.e)
        os.remove(os.path.join(case, "0", "p"))
        boxes.write_field(case, "T", T, '".*" cyclic')
        cooling = "GarzoDufty" if self.e < 1 else "none"
        boxes.write_dictionary(case, "constant", "granularProperties",
                               f"grain {{ diameter 0.01; mass 1; restitution {self.e}; }}\nequationOfState TorquatoSpheres;\n"
                               f"cooling {cooling}; transport {self.transport};\n")
        harness.edit(case, "system/controlDict", **{"maxCo": 1, **control})
        choose(case, scheme)
        return case

    def result(self, case):
        run = haff.Case(case)
        n = round(run.mesh.cells ** (1 / 3))
        fields = [run.field(f) for f in ("rho", "U", "T")]
        return [q.reshape((n, n, n, -1)) for q in fields]

    def errors(self, found, reference, cells):
        N = reference[0].shape[0]
        k = np.fft.fftfreq(N, 1 / N)
        at = (np.arange(cells) + 0.5) / cells
        mode = np.exp(2j * np.pi * np.outer(at - 0.5 / N, k)) / N
        out = []
        for a, b in zip(found, reference):
            for axis in range(3):
                b = np.moveaxis(np.tensordot(mode, np.fft.fft(b, axis=axis), (1, axis)), 0, axis).real
            out.append(difference(a, b))
        return out


class Sound(Waves):
    transport, e, end = "none", 1.0, 0.1


def counted(log, word):
    """The last count of a line of the log, over the whole run; 0: there is none."""
    lines = re.findall(rf"^ *{word}: (\d+)(?:[^\n]*in all (\d+))?", log, flags=re.M)
    return int(lines[-1][1] or lines[-1][0]) if lines else 0


def zigzag(q, scale, inner):
    """The mean over cells of what alternates from cell to cell: third differences over 8 times the scale near by."""
    near = np.max([scale[k:len(scale) - 3 + k] for k in range(4)], axis=0)
    bend = np.abs(q[:-3] - 3 * q[1:-2] + 3 * q[2:-1] - q[3:]) / (8 * near)
    inner = inner[:-3] & inner[3:]
    return bend[inner].mean() if inner.any() else 0.0


class Bed:
    """cases/bouncingBed on 100 cells to its end, six periods, with thin gas above and below; the stiffer, the lower alphaMin."""
    grids, fine, name = (1e-3, 1e-4, 0.0), None, "alphaMin, maxCo"
    columns = ("half steps repeated", "T zigzag, alpha < 1e-3", "T, alpha > 0.1", "u/sqrt(T), alpha < 1e-3", "centre of mass (mm)")

    def make(self, folder, least, scheme, **control):
        case = harness.copy("bouncingBed", folder)
        harness.mesh(case, 100)
        harness.edit(case, "constant/granularProperties", alphaMin=repr(least))
        harness.edit(case, "system/controlDict", **control)
        choose(case, scheme)
        return case

    def result(self, case):
        run, parts = haff.Case(case), []
        for t in [t for t in run.times if float(t) > 0.4]:
            alpha, T, u = run.field("alpha", t), run.field("T", t), run.field("U", t)[:, 1]
            thin = alpha < 1e-3
            parts.append((zigzag(T, T, thin), zigzag(T, T, alpha > 0.1), zigzag(u, np.sqrt(T), thin)))
        with open(os.path.join(case, "log")) as f:
            repeated = counted(f.read(), "repeated")
        y = np.arange(0.5, 100)
        return [repeated, *np.mean(parts, axis=0), (alpha * y).sum() / alpha.sum()]

    def errors(self, found, reference, cells):
        return found


PROBLEMS = {"sedimentation": Column, "waves": Waves, "sound": Sound, "bed": Bed}


def study(problem, schemes, courants, rounds, within, folder, grids, control):
    reference = None
    if problem.fine:
        case = problem.make(folder, problem.fine, DEFAULTS, maxCo=0.5)
        seconds, log = timed(case, 3000)
        if seconds is None:
            sys.exit(log[-2000:])
        reference = problem.result(case)
        print(f"reference: {problem.fine}, {seconds:.1f} s, {steps(log)} steps", flush=True)
    print("| " + " | ".join(("scheme", problem.name, "steps", "user s", "of the defaults", *problem.columns)) + " |", flush=True)
    print("|---" * (5 + len(problem.columns)) + "|", flush=True)
    for cells in grids or problem.grids:
        least = {}
        for turn in range(rounds):
            for scheme in schemes:
                for courant in courants:
                    case = problem.make(folder, cells, scheme, maxCo=courant, **control)
                    seconds, log = timed(case, within)
                    key = scheme, courant
                    if seconds is None:
                        least[key] = (np.inf, 0, log.strip().splitlines()[-1][:100])
                    elif key not in least or seconds < least[key][0]:
                        least[key] = (seconds, steps(log), problem.errors(problem.result(case), reference, cells))
        base = least.get((DEFAULTS, courants[0]), (np.nan,))[0]
        for (scheme, courant), (seconds, taken, errors) in least.items():
            shown = [errors] if isinstance(errors, str) else [f"{e:.3g}" for e in errors]
            row = (" ".join(scheme), f"{cells}, {courant:g}", str(taken), f"{seconds:.3g}", f"{seconds / base:.2f}", *shown)
            print("| " + " | ".join(row) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problem", nargs="+", choices=PROBLEMS)
    parser.add_argument("-rounds", type=int, default=3)
    parser.add_argument("-within", type=float, default=600)
    parser.add_argument("-courants", type=float, nargs="+", default=[1])
    parser.add_argument("-longest", type=float, help="s: longest time step, of sedimentation and bed")
    parser.add_argument("-grids", type=int, nargs="+")
    parser.add_argument("-reference", type=int, help="cells of the reference")
    parser.add_argument("-schemes", nargs="+", help="numbers of the list in this file, from 0 on")
    o = parser.parse_args()
    control = {"maxDeltaT": o.longest} if o.longest else {}
    schemes = [SCHEMES[int(i)] for i in o.schemes] if o.schemes else SCHEMES
    for name in o.problem:
        problem = PROBLEMS[name]()
        problem.fine = o.reference if o.reference and problem.fine else problem.fine
        with tempfile.TemporaryDirectory() as folder:
            study(problem, schemes, o.courants, o.rounds, o.within, folder, o.grids, control)


if __name__ == "__main__":
    main()
