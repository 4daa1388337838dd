#!/usr/bin/env -S /usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run time against error: every sensible scheme of granularGas, and rhoCentralFoam, on problems with a known answer.

    workPrecision [--problems vortex,sod,...] [--out FOLDER] [--quick] [--no-foam] [--no-haff] [--bin FOLDER] [--core N]
                  [--reference N] [--commit NAME] [--fresh]

Writes into FOLDER (default: a new temporary one) workPrecision.csv (every run), workPrecision.md (tables, ratios of CPU
times at equal errors) and workPrecision.png (a panel a problem). Every run is alone on one core; CPU time is that
of the whole process, user and system, start-up, reading and writing included, the least of three where one takes less
than 0.3 s. From grid to grid the runs of rhoCentralFoam stand among ours, so that both meet the same machine.
Runs that the CSV in FOLDER holds are not run again, so a study can be stopped, continued and extended. Each row names
the commit it was measured at (git's, or --commit); --fresh runs again what was measured at another.

Problems without an exact answer are measured against the mean of two runs of different schemes on a fine grid. It is
taken from references/ beside this script; where it is not there, or --reference N asks for another N, it is computed
and kept in FOLDER.
"""
import csv
import os
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

import haff
from haff import command
from haff.paths import TOP, folder_of_programs
from studies.made import rhocentral
from studies.source import measured_by, of_source
from studies.workPrecisionProblems import PROBLEMS, Referenced

# flux schemes and the reconstructions each is tried with; "*": all but those of first order
FLUXES = {"common": "*", "Marquina": ("PHM", "WPENO5", "TENO5"), "LaxFriedrichs": ("WENO5", "WPENO5", "TENO5")}
# time schemes, their largest Courant number (haff's: the sum over the directions) and the reconstructions tried with it,
# for lines and in two dimensions; the other fluxes and --quick take the first alone
STEPPERS = {False: [("SSPRK43", 1.0, "*"), ("SSPRK43", 2.0, "*"), ("SSPRK3", 1.0, "*"), ("SSPRK104", 3.0, "*")],
            True: [("SSPRK43", 2.0, "*"), ("SSPRK3", 1.0, "*"), ("SSPRK104", 3.0, ("WPENO5", "TENO5"))]}
# on general meshes: time scheme, maxCo, and what of polyReconstruct is tried with it; --quick takes the first alone
GENERAL = (("SSPRK43", 2.0, ("CWENO3", "linear")), ("SSPRK3", 1.0, ("CWENO3", "linear")), ("Euler", 0.7, ("linear",)),
           ("Euler", 0.5, ("linear",)))
ERRORS = [m * 10.0**k for k in range(-1, -9, -1) for m in (1, 0.3)]
COLUMNS = ("problem", "code", "flux", "reconstruct", "stepper", "courant", "cells", "steps", "cpu", "user", "loop", "error", "net", "commit")
KEY = COLUMNS[:7]


def schemes(granular_gas, two_dimensional, quick):
    """What of the tables above the program has, by its own list."""
    text = subprocess.run([granular_gas, "-listModels"], capture_output=True, text=True, check=True).stdout
    names = {title: re.findall(r"^  (\w+)", body, re.M)
             for title, body in re.findall(r"^system/fvSchemes: (\w+)\n((?:  .*\n)*)", text, re.M)}
    among = lambda name, wanted: name != "firstOrder" and (wanted == "*" or name in wanted)
    for flux, tried in FLUXES.items():
        if flux != "common" and quick:
            continue
        for stepper, courant, wanted in STEPPERS[two_dimensional][:None if flux == "common" and not quick else 1]:
            if flux not in names["fluxScheme"] or stepper not in names["timeScheme"]:
                continue
            for reconstruct in names["reconstruct"]:
                if among(reconstruct, tried) and among(reconstruct, wanted):
                    yield {"flux": flux, "reconstruct": reconstruct, "stepper": stepper, "courant": courant}


def general_schemes(quick):
    for stepper, courant, tried in GENERAL[:1 if quick else None]:
        for reconstruct in tried:
            yield {"flux": "common", "reconstruct": reconstruct, "stepper": stepper, "courant": courant}


def timed(command, core, log, environment=None):
    """Runs a command on a core; exit code, CPU seconds of the process, and what of them was spent in user mode."""
    with open(log, "w") as f:
        child = subprocess.Popen(["taskset", "-c", str(core), *command], stdout=f, stderr=subprocess.STDOUT, env=environment)
        _, state, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(state)
    return child.returncode, usage.ru_utime + usage.ru_stime, usage.ru_utime


def best_of(run, times, short=0.3):
    """The least of several of a short run."""
    code, cpu, user = run()
    for _ in range(times - 1 if not code and cpu < short else 0):
        cpu, user = min((cpu, user), run()[1:])
    return code, cpu, user


def clear(case):
    for name in os.listdir(case):
        if haff.is_time(name) and name != "0":
            shutil.rmtree(os.path.join(case, name))


def result(case, field, cells):
    times = [t for t in haff.Case(case).times if float(t) > 0]
    return haff.read_field(os.path.join(case, times[-1], field), cells)


class Haff:
    """granularGas."""

    def __init__(self, folder, core, times):
        self.program, self.core, self.times = os.path.join(folder, "granularGas"), core, times

    def run(self, problem, case, n, **scheme):
        problem.make(case, n, **scheme)
        log = os.path.join(case, "log")

        def once():
            clear(case)
            return timed([self.program, "-case", case], self.core, log)

        code, cpu, user = best_of(once, self.times)
        with open(log) as f:
            text = f.read()
        if code:
            return None, {"cpu": cpu, "net": text.strip().splitlines()[-1][:120]}
        steps, loop = re.findall(r"^end at time .*: (\d+) steps in ([\d.]+) s", text, re.M)[-1]
        net = re.findall(r"limited: .*\(in all (\d+) faces, (\d+) cells\)", text)
        return result(case, problem.field, problem.kept(n).sum()), {
            "cpu": cpu, "user": user, "loop": float(loop), "steps": int(steps), "net": " ".join(net[-1]) if net else ""}


class Foam:
    """rhoCentralFoam of Debian's OpenFOAM, vanLeer, Kurganov, Euler, on the same mesh and initial values."""

    def __init__(self, core, times):
        self.core, self.times = core, times

    def make(self, problem, case, n, courant):
        rho, u, p = problem.make(case, n)
        kinds = haff.Mesh(os.path.join(case, "constant", "polyMesh")).patches
        scalar = {name: kind if kind in ("empty", "cyclic") else "zeroGradient" for name, (kind, _, _) in kinds.items()}
        vector = {name: "slip" if name == "wall" else rule for name, rule in scalar.items()}
        os.remove(os.path.join(case, "0", "rho"))
        rhocentral.write(case, problem.options["gamma"], problem.end, courant, {"p": p, "T": p / rho, "U": u},
                         {"p": scalar, "T": scalar, "U": vector})

    def run(self, problem, case, n, courant, **_):
        self.make(problem, case, n, courant)
        log = os.path.join(case, "log")

        def once():
            clear(case)
            return timed(["rhoCentralFoam", "-case", case], self.core, log, rhocentral.ENVIRONMENT)

        code, cpu, user = best_of(once, self.times)
        with open(log) as f:
            text = f.read()
        if code:
            return None, {"cpu": cpu, "net": text.strip().splitlines()[-1][:120]}
        steps, loop = rhocentral.progress(text)
        return result(case, "rho", problem.kept(n).sum()), {"cpu": cpu, "user": user, "loop": loop, "steps": steps}


class Table:
    """The rows of the CSV, which grows by a line as a run ends. fresh: names of problems whose rows of other commits go."""

    def __init__(self, path, commit, fresh=()):
        self.path, self.commit, self.rows = path, commit, []
        if os.path.exists(path):
            with open(path, newline="") as f:
                self.rows = [self.typed({**dict.fromkeys(COLUMNS, ""), **row}) for row in csv.DictReader(f)]
        self.rows = [row for row in self.rows if row["commit"] == commit or row["problem"] not in fresh]
        self.write(path + "~", [COLUMNS, *map(self.text, self.rows)], "w")
        os.replace(path + "~", path)

    @staticmethod
    def typed(row):
        numbers = ("courant", "cells", "steps", "cpu", "user", "loop", "error")
        return {k: (float(v) if v else np.nan) if k in numbers else v for k, v in row.items()}

    @staticmethod
    def text(row):
        number = lambda v: "" if v != v else "%d" % v if v.is_integer() else "%.4g" % v
        return [number(row[c]) if isinstance(row[c], float) else row[c] for c in COLUMNS]

    @staticmethod
    def write(path, rows, mode="a"):
        with open(path, mode, newline="") as f:
            csv.writer(f, lineterminator="\n").writerows(rows)

    def has(self, key):
        return any(all(str(row[k]) == str(v) if isinstance(v, str) else row[k] == v for k, v in key.items()) for row in self.rows)

    def add(self, key, **values):
        row = {**dict.fromkeys(COLUMNS, ""), **key, **values, "commit": self.commit}
        self.write(self.path, [self.text(row)])
        self.rows.append(self.typed({k: str(v) for k, v in row.items()}))


def runs_of(problem, program, quick):
    """{cells: [key of every run]} of granularGas or rhoCentralFoam on a problem."""
    if isinstance(program, Haff):
        found = general_schemes(quick) if problem.general else schemes(program.program, problem.two_dimensional, quick)
        keys = [{"code": "haff", **scheme} for scheme in found]
        return {n: [{**key, "cells": n} for key in keys] for n in (problem.quick if quick else problem.grids)}
    runs = {}
    for courant, grids in (problem.foam_quick if quick else problem.foam).items():
        for n in grids:
            runs.setdefault(n, []).append({"code": "rhoCentralFoam", "flux": "Kurganov", "reconstruct": "vanLeer", "stepper": "Euler",
                                           "courant": courant, "cells": n})
    return runs


def plan(problem, programs, quick):
    """(program, key) of every run of a problem, grid by grid, the runs of one program spread among those of the other."""
    runs = [(program, runs_of(problem, program, quick)) for program in programs]
    for n in sorted(set().union(*(keys for _, keys in runs))):
        spread = [((i + 0.5) / len(keys[n]), program, key) for program, keys in runs if n in keys for i, key in enumerate(keys[n])]
        yield from ((program, key) for _, program, key in sorted(spread, key=lambda s: s[0]))


def reference(problem, program, folder, work, fine):
    """Loads or computes what a Referenced problem is compared with."""
    kept = os.path.join(folder, "references")
    if problem.load([kept] if fine else [of_source("postprocessing", "references"), kept]) and fine in (None, problem.fine):
        return
    problem.fine = fine or problem.fine
    runs = []
    for flux, reconstruct in problem.pair:
        print(f"reference of {problem.name}: {problem.fine} cells a side, {flux} {reconstruct}", flush=True)
        with tempfile.TemporaryDirectory(dir=work) as case:
            values, entry = program.run(problem, case, problem.fine, flux=flux, reconstruct=reconstruct, stepper="SSPRK43",
                                        courant=2.0 if problem.two_dimensional else 1.0)
        if values is None:
            sys.exit(f"the reference of {problem.name} failed: {entry['net']}")
        runs.append(values)
    problem.keep(kept, runs)


def measure(problem, programs, table, work, quick):
    for program, key in plan(problem, programs, quick):
        key = {"problem": problem.name, **key}
        if table.has(key):
            continue
        with tempfile.TemporaryDirectory(dir=work) as case:
            values, entry = program.run(problem, case, **{"n" if k == "cells" else k: v for k, v in key.items() if k not in ("problem", "code")})
        error = np.nan if values is None else float(problem.error(key["cells"], values))
        table.add(key, **entry, error=error)
        print(" ".join(str(v) for v in key.values()), f"cpu {entry['cpu']:.3g} s  error {error:.4g}",
              "" if values is not None else entry["net"], flush=True)


def envelope(rows):
    """The lower left edge of (cpu, error): each point has less error than all that took less time."""
    points = sorted(((r["cpu"], r["error"], r) for r in rows if r["error"] == r["error"]), key=lambda q: q[:2])
    edge = []
    for cpu, error, row in points:
        if not edge or error < edge[-1][1]:
            edge.append((cpu, error, row))
    return edge


def time_to(edge, error):
    """CPU seconds to an error, log-log between the points of an envelope; (seconds, "<" where even the cheapest run is
    better than that); None where no run is."""
    if not edge or edge[-1][1] > error:
        return None
    if edge[0][1] <= error:
        return edge[0][0], "<" if edge[0][1] < error else ""
    for (t0, e0, _), (t1, e1, _) in zip(edge, edge[1:]):
        if e1 <= error:
            return float(np.exp(np.interp(-np.log(error), -np.log([e0, e1]), np.log([t0, t1])))), ""


def label(row):
    return f"{row['flux']} {row['reconstruct']} {row['stepper']} {row['courant']:g}"


def by_scheme(rows, name=label):
    groups = {}
    for row in rows:
        groups.setdefault(name(row), []).append(row)
    return groups


def best_table(rows):
    """For given errors: the three schemes of ours that are soonest there."""
    edges = {name: envelope(group) for name, group in by_scheme([r for r in rows if r["code"] == "haff"]).items()}
    lines = []
    for error in ERRORS:
        times = sorted((t[0], t[1], name) for name, t in ((n, time_to(e, error)) for n, e in edges.items()) if t)
        if times and any(t[1] == "" for t in times):
            lines.append(f"| {error:.0e} | " + " | ".join(f"{name} {mark}{t:.3g} s" for t, mark, name in (times + [(0, "", "")] * 3)[:3]
                                                           if name) + " |")
    return [measured_by("haff workPrecision"), "", "| error | soonest | second | third |", "|---|---|---|---|", *lines] if lines else []


def ratio_table(rows):
    """Where rhoCentralFoam reaches an error: when do we."""
    ours, foam = (envelope([r for r in rows if r["code"] == code]) for code in ("haff", "rhoCentralFoam"))
    lines = []
    for cpu, error, row in foam:
        mine = time_to(ours, error)
        if mine:
            at = next(r for _, e, r in ours if e <= error)
            lines.append(f"| {error:.3g} | {row['cells']:g} cells, maxCo {row['courant']:g}: {cpu:.3g} s | {mine[1]} {mine[0]:.3g} s "
                         f"({label(at)}, {at['cells']:g}) | {'>' if mine[1] else ''} {cpu / mine[0]:.3g} |")
        else:
            lines.append(f"| {error:.3g} | {row['cells']:g} cells, maxCo {row['courant']:g}: {cpu:.3g} s | not reached | |")
    return [measured_by("haff workPrecision"), "", "| error | rhoCentralFoam | haff | CPU ratio |", "|---|---|---|---|", *lines] if lines else []


def output(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def machine():
    """Processor, clock, compiler, date."""
    with open("/proc/cpuinfo") as f:
        text = f.read()
    value = lambda key: (re.findall(rf"^{key}\s*: (.*)$", text, re.M) or ["unknown"])[0]
    vectors = [v for v in ("avx512f", "avx2", "sse4_2") if f" {v} " in value("flags") + " "][:1] or ["none"]
    return (f"{value('model name')}, {value('cpu MHz')} MHz, {os.cpu_count()} cores, vectors {vectors[0]}; "
            f"{output('cc', '--version').splitlines()[0]}; {output('date', '-u', '+%Y-%m-%d %H:%M UTC')}")


def report(path, problems, table):
    commits = {row["commit"] or "unknown": None for row in table.rows}
    lines = ["# Run time against error: tables", "",
             f"Written by `workPrecision` on {machine()}; rows of commit {', '.join(commits) or 'none'}.", ""]
    for problem in problems:
        rows = [r for r in table.rows if r["problem"] == problem.name]
        if not rows:
            continue
        lines += [f"## {problem.name}: {problem.title}", ""]
        if isinstance(problem, Referenced) and problem.gap is not None:
            lines += [f"Reference at N = {problem.fine}: the mean of {' and '.join(' '.join(p) for p in problem.pair)}, "
                      f"which differ by {problem.gap:.2g}.", ""]
        for part in (ratio_table(rows), best_table(rows)):
            lines += part + [""] if part else []
        failed = [f"{label(r)} on {r['cells']:g}: {r['net']}" for r in rows if r["error"] != r["error"]]
        lines += [f"No result: {'; '.join(failed)}.", ""] if failed else []
    with open(path, "w") as f:
        f.write("\n".join(lines).rstrip() + "\n")


def figure(path, problems, table):
    """Per problem the lower edge of each flux and reconstruction over Courant numbers and time schemes."""
    from haff.plot import figures
    problems = [p for p in problems if any(r["problem"] == p.name for r in table.rows)]
    if not problems:
        return
    columns = min(3, len(problems))
    fig, axes = figures.panels(-(-len(problems) // columns), columns, 3.4 * columns, 3.0)
    names = sorted({(r["flux"], r["reconstruct"]) for r in table.rows if r["code"] == "haff"})
    reconstructs = sorted({r for _, r in names})
    marks = {"common": "o-", "Marquina": "s--", "LaxFriedrichs": "^:"}
    for ax, problem in zip(axes.flat, problems):
        for name, group in by_scheme([r for r in table.rows if r["problem"] == problem.name],
                                     lambda r: (r["code"], r["flux"], r["reconstruct"])).items():
            edge = envelope(group)
            if not edge:
                continue
            haff_row = name[0] == "haff"
            style = dict(color=figures.COLOURS[reconstructs.index(name[2]) % len(figures.COLOURS)]) if haff_row else dict(color="black", lw=1.6)
            ax.loglog([c for c, _, _ in edge], [e for _, e, _ in edge], marks.get(name[1], "x-"), ms=2.5, **style,
                      label=f"{name[1]} {name[2]}" if haff_row else "rhoCentralFoam")
        if isinstance(problem, Referenced) and problem.gap:
            ax.axhline(problem.gap, color="grey", lw=0.5)
        figures.label(ax, "CPU seconds, one core", "mean error", problem.name)
    for ax in list(axes.flat)[len(problems):]:
        ax.set_axis_off()
    handles = {l: h for ax in axes.flat for h, l in zip(*ax.get_legend_handles_labels())}
    fig.set_layout_engine("tight", rect=(0, 0.2 / fig.get_figheight() * (1 + len(handles) // 4), 1, 1))
    fig.legend(handles.values(), handles.keys(), loc="lower center", ncols=4, fontsize=7)
    figures.save(fig, path)


def arguments():
    known = {p.name: p for p in PROBLEMS}
    parser = command.parser(__doc__, epilog="problems: " + "; ".join(f"{p.name} ({p.title})" for p in PROBLEMS))
    parser.add_argument("--quick", action="store_true", help="small grids of the problems with an exact answer: under a minute")
    parser.add_argument("--problems", default=None, help="names, separated by commas; default: all")
    parser.add_argument("--out", default=None, help="folder of the results")
    parser.add_argument("--no-foam", action="store_true", help="without rhoCentralFoam")
    parser.add_argument("--no-haff", action="store_true", help="rhoCentralFoam only")
    parser.add_argument("--bin", default=folder_of_programs(), help="folder of granularGas")
    parser.add_argument("--core", type=int, default=max(os.sched_getaffinity(0)), help="the core everything runs on")
    parser.add_argument("--reference", type=int, default=None, help="cells a side of the references")
    parser.add_argument("--commit", default=output("git", "-C", TOP, "describe", "--always", "--dirty"),
                        help="name of what is measured, a column of the CSV; default: git describe of this source (%(default)s)")
    parser.add_argument("--fresh", action="store_true", help="run again what the CSV holds from another commit")
    o = parser.parse_args()
    names = o.problems.split(",") if o.problems else list(known)
    unknown = [name for name in names if name not in known]
    if unknown:
        parser.error(f"no problem {', '.join(unknown)}; there are {', '.join(known)}")
    o.problems = [known[name] for name in names if not o.quick or known[name].quick]
    o.out = os.path.abspath(o.out or tempfile.mkdtemp(prefix="workPrecision"))
    return o


def main():
    o = arguments()
    os.makedirs(o.out, exist_ok=True)
    times = 1 if o.quick else 3
    ours, foam = Haff(o.bin, o.core, times), Foam(o.core, times)
    programs = [] if o.no_haff else [ours]
    if not o.no_foam and rhocentral.installed():
        programs.append(foam)
    elif not o.no_foam:
        print(f"{rhocentral.MISSING}: no comparison")
    table = Table(os.path.join(o.out, "workPrecision.csv"), o.commit, [p.name for p in o.problems] if o.fresh else ())
    with tempfile.TemporaryDirectory(prefix="workPrecision") as work:
        for problem in o.problems:
            problem.programs = o.bin
            if isinstance(problem, Referenced):
                reference(problem, ours, o.out, work, o.reference)
            measure(problem, programs, table, work, o.quick)
    report(os.path.join(o.out, "workPrecision.md"), o.problems, table)
    figure(os.path.join(o.out, "workPrecision.png"), o.problems, table)


if __name__ == "__main__":
    main()
