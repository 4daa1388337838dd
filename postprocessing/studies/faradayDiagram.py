#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of Table 1 of Carrillo et al. by granularGas: which wave stands in which row, beside the grains'.

    haff faradayDiagram FOLDER [-rows 1,5-9] [-jobs 2] [-cycles 20] [-last 8] [-warm CYCLES RAMP] [-warmBelow 2.1] [-length 1] [-draw] ..

Each row runs as a variant of the template (cases/faradaySweep: its layer, schemes and Courant number) in FOLDER/rowNN and
adds a line to FOLDER/faradayDiagram.csv, which is drawn beside the paper's values and the grains of
cases/faradayMD/table1.csv as FOLDER/faradayDiagram.png. Rows that stand there are not run again; with its line removed a
row that was run with -keep gets more -cycles. After Ctrl-C or SIGTERM the runs write their state, and the same command
goes on from there. The rows named first run first; -jobs of them at once.

Rows below the acceleration -warmBelow begin warm: near 2 g two base states coexist, and from a cold layer no wave grows.
They are shaken with 2.75 g for CYCLES, which fall to the row's own within RAMP more (constant/shaking: a table of the
amplitude), and then for -cycles less 6. What stands is measured in the -last cycles (faraday.py), of the column's mass.
-length 0.5 takes boxes half as long as the paper's: half the time, twice the distance of the wavelengths that fit.
A wave stands where faraday.py says so, and its amplitude is at least STANDS of the mean mass; if it is fainter, it
grows, decays or is none (it does not turn over with every stroke).
"""
import concurrent.futures
import csv
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np

import haff
from haff import command
from haff.layers import faraday
from haff.paths import TOP, program
from haff.plot import figures
from studies.faradayRows import acceleration, clear, copy, edit, has_mesh, mesh, numbers, paper, throw

TEMPLATE = os.path.join(TOP, "cases", "faradaySweep")
GRAINS = os.path.join(TOP, "cases", "faradayMD", "table1.csv")
HOT, STANDS = 2.75, 0.05  # g; of the mean mass of a column
COLUMNS = ("row Gamma f_Hz A_sigma L_sigma height cells warm cycles paper dpaper wavelength shorter longer centroid spread contrast flip "
           "amplitude growth state off within20 meanHeight steps cpuSeconds options").split()


class Row:
    """A row of the table as a case of `folder`."""

    def __init__(self, folder, number, entry, o):
        self.number, self.entry, self.o = number, entry, o
        self.case = os.path.join(folder, f"row{number:02d}")
        self.period = 1 / entry["f_Hz"]
        self.own = acceleration(entry["A_diam"], entry["f_Hz"])
        self.warm = sum(o.warm) if self.own < o.warmBelow else 0
        self.cycles = self.warm + o.cycles - (6 if self.warm else 0)
        hottest = HOT if self.warm else self.own
        self.height = math.ceil((20 + 5 * throw(hottest, entry["f_Hz"])) / 10) * 10
        self.length = 2 * round(0.5 * o.length * entry["L_diam"])
        self.cells = self.length // 2 * self.height

    @property
    def cost(self):
        """Relative: steps are nearly equal in time."""
        return self.cells * self.cycles * self.period

    def at(self, *names):
        return os.path.join(self.case, *names)

    def reached(self):
        """Cycle of the last time written."""
        if not os.path.isdir(self.case):
            return 0
        return max([float(n) for n in os.listdir(self.case) if haff.is_time(n)], default=0) / self.period

    def shaking(self):
        if not self.warm:
            return repr(self.own)
        hold, ramp = self.o.warm
        return "table ((0 %r) (%r %r) (%r %r))" % (HOT, hold * self.period, HOT, (hold + ramp) * self.period, self.own)

    def make(self):
        """The case with its mesh; written at quarters of the period."""
        copy(self.o.template, self.case)
        edit(self.at("constant", "shaking"), frequency=repr(self.entry["f_Hz"]), amplitude=self.shaking())
        edit(self.at("0.orig", "alpha"), seed=self.o.seed)
        edit(self.at("system", "controlDict"), endTime=repr(self.cycles * self.period), writeInterval=repr(self.period / 4))
        mesh(self.case, self.length, self.height)

    def run(self, processes):
        """To its end, from where it is; processor time is noted, that of runs before this one included."""
        with open(self.at("log.granularGas"), "a") as log:
            process = subprocess.Popen([program("granularGas"), "-case", self.case], stdout=log, stderr=subprocess.STDOUT)
            processes.add(process)
            _, code, used = os.wait4(process.pid, 0)
            process.returncode = code
            processes.discard(process)
        with open(self.at("cpu.txt"), "a") as f:
            f.write(f"{used.ru_utime + used.ru_stime:.1f}\n")
        if code or self.reached() < self.cycles - 0.01:
            raise RuntimeError(f"row {self.number} stopped at cycle {self.reached():.1f} of {self.cycles}, see {self.at('log.granularGas')}")

    def options(self):
        """What the case says of scheme and waves, and how it was measured."""
        said = []
        for key, *names in (("timeScheme", "system", "fvSchemes"), ("maxCo", "system", "controlDict"), ("amplitude", "0.orig", "alpha"), ("seed", "0.orig", "alpha")):
            with open(self.at(*names)) as f:
                said.append(f"{key} {re.search(rf'{key}[ ]+([^;]+);', f.read())[1]}")
        return " ".join(said + [f"last {self.o.last}", self.o.note]).strip()

    def steps(self):
        """Of all runs: the log numbers them through from the start of each."""
        with open(self.at("log.granularGas")) as f:
            return sum(int(n) for n in re.findall(r"^end at time .*?: (\d+) steps", f.read(), re.M))


def measured(case, last_cycle, count):
    """What stands in the last `count` cycles: the entries of faraday.measure, amplitude and growth."""
    layer = faraday.Layer(case)
    found = faraday.samples(layer, last_cycle - count, last_cycle)
    samples = list(found.values())
    result = faraday.measure(samples, layer.length)
    k, (cycles, c) = result["mode"], samples[result["phase"]]
    wave = np.abs(faraday.alternating(c, cycles)[:, k])
    result["amplitude"] = float(np.mean(wave))
    result["growth"] = float(np.exp(np.polyfit(np.arange(len(wave)), np.log(wave), 1)[0])) if wave.min() > 0 else np.nan
    result["meanHeight"] = float(np.mean([layer.height(t).mean() for t in layer.phases(last_cycle - count, last_cycle)[list(found)[0]][1]]))
    result["state"] = state(result)
    return result


def state(result):
    """Of a measurement, in a word."""
    if result["flip"] > faraday.FLIP or result["contrast"] < faraday.CONTRAST:
        return "none"
    if result["amplitude"] >= STANDS:
        return "stands"
    return "grows" if result["growth"] > 1 else "decays"


def finish(row):
    """Measures; leaves the modes of the columns' mass, {phase: [cycle][number of the cycle, mode 0, 1, ..]}, for when the
    fields are gone."""
    entry, result = row.entry, measured(row.case, row.cycles, row.o.last)
    every = faraday.samples(faraday.Layer(row.case))
    np.savez_compressed(row.at("modes.npz"), **{f"{key:g}": np.column_stack([cycles, c]) for key, (cycles, c) in every.items()})
    off = result["wavelength"] / entry["lambda_diam"] - 1
    with open(row.at("cpu.txt")) as f:
        cpu = sum(float(line) for line in f)
    line = {"row": row.number, "Gamma": entry["Gamma_printed"], "f_Hz": entry["f_Hz"], "A_sigma": entry["A_diam"],
            "L_sigma": row.length, "height": row.height, "cells": row.cells, "warm": row.warm, "cycles": row.cycles,
            "paper": entry["lambda_diam"], "dpaper": entry["dlambda_diam"],
            **{k: f"{result[k]:.4g}" for k in ("wavelength", "shorter", "longer", "centroid", "spread", "contrast", "flip", "amplitude",
                                               "growth", "meanHeight")},
            "state": result["state"], "off": f"{off:+.3f}",
            "within20": ("yes" if abs(off) <= 0.2 else "no") if result["state"] == "stands" else "",
            "steps": row.steps(), "cpuSeconds": f"{cpu:.0f}",
            "options": row.options()}
    return line, result


def append(folder, line):
    path = os.path.join(folder, "faradayDiagram.csv")
    new = not os.path.exists(path)
    with open(path, "a") as f:
        f.write((",".join(COLUMNS) + "\n" if new else "") + ",".join(str(line[k]) for k in COLUMNS) + "\n")


def table(folder):
    path = os.path.join(folder, "faradayDiagram.csv")
    if not os.path.exists(path):
        return []
    with open(path) as f:
        return list(csv.DictReader(f))


def grains():
    """Lines of the table of the grains: on the elastic plate."""
    with open(GRAINS) as f:
        return [r for r in csv.DictReader(f) if float(r["plate"]) == 1]


def markdown(folder):
    """The table for a README: all rows of the paper, beside our grains (first seed, cold start)."""
    have = {int(r["row"]): r for r in table(folder)}
    ours = {int(r["row"]): r for r in reversed(grains()) if r["warm"] == "0" and r["seed"] == "1"}
    wave = lambda r: f"**{float(r['wavelength']):.1f}** ({float(r['shorter']):.1f} .. {float(r['longer']):.1f})"
    lines = ["| row | Gamma | f (Hz) | A | L | paper (grains) | our grains | gas | centroid | amplitude, growth a period | off the paper | processor s |",
             "|" + "---|" * 12]
    for k, e in paper().items():
        g, r = ours.get(k), have.get(k)
        cells = [k, f"{e['Gamma_printed']:.2f}", f"{e['f_Hz']:g}", e["A_diam"], r["L_sigma"] if r else int(e["L_diam"]),
                 f"{e['lambda_diam']:g} +- {e['dlambda_diam']:g}", f"{float(g['wavelength']):.1f}" if g and g["stands"] == "yes" else "none"]
        if r and r["state"] == "stands":
            cells += [wave(r), f"{float(r['centroid']):.1f} +- {float(r['spread']):.1f}"]
        else:
            cells += [f"{r['state']} ({float(r['wavelength']):.1f})" if r else "not run", ""]
        cells += [f"{float(r['amplitude']):.2g}, {float(r['growth']):.2f}" if r else "",
                  f"{float(r['off']):+.0%}" if r and r["state"] == "stands" else "", r["cpuSeconds"] if r else ""]
        lines.append("| " + " | ".join(str(c) for c in cells) + " |")
    return "\n".join(lines)


def draw(folder, path=None):
    """Wavelength over frequency, a panel for each acceleration (Fig. 3 of the paper draws the same over the amplitude).
    Bars: the paper's deviation; of ours the neighbours in the box."""
    gas = [r for r in table(folder) if r["state"] == "stands"]
    ours = [r for r in grains() if r["stands"] == "yes"]
    fig, axes = figures.panels(2, 2, width=7.5, height=2.8)

    def points(ax, rows, move, wave, bars, **style):
        if rows:
            ax.errorbar([float(r["f_Hz"]) + move for r in rows], [float(r[wave]) for r in rows], bars(rows), **style)
    neighbours = lambda rows: [[float(r["wavelength"]) - float(r["shorter"]) for r in rows],
                               [float(r["longer"]) - float(r["wavelength"]) for r in rows]]
    for ax, gamma in zip(axes.flat, (2.0, 2.25, 2.52, 2.75)):
        of = lambda rows, key: [r for r in rows if float(r[key]) == gamma]
        points(ax, of(paper().values(), "Gamma_printed"), 0, "lambda_diam", lambda rows: [r["dlambda_diam"] for r in rows], color="0.4",
               fmt="o", markersize=4, linewidth=0.5, markerfacecolor="none", label="paper, grains")
        points(ax, of(ours, "Gamma"), 0.05, "wavelength", neighbours, color=figures.COLOURS[1], fmt="s", markersize=4, linewidth=0.7,
               label="ours, grains")
        points(ax, of(gas, "Gamma"), 0.1, "wavelength", neighbours, color=figures.COLOURS[0], fmt="D", markersize=4, linewidth=0.7,
               label="ours, gas")
        for r in of(table(folder), "Gamma"):
            if r["state"] != "stands":
                ax.plot([float(r["f_Hz"]) + 0.1], [3], marker="x", color=figures.COLOURS[0], markersize=4)
        figures.label(ax, "frequency (Hz)", r"wavelength ($\sigma$)", rf"$\Gamma$ = {gamma:g}")
        ax.set(xlim=(2.3, 6.3), ylim=(0, 85))
    axes[0][0].legend(fontsize=7, title=r"$\times$: no pattern of the gas", title_fontsize=7)
    figures.save(fig, path or os.path.join(folder, "faradayDiagram.png"))


class Progress:
    """What the rows have done, and when they will be done, from the pace of this call."""

    def __init__(self, rows):
        self.rows, self.begin, self.done = rows, time.time(), set()
        self.was = {r.number: r.reached() for r in rows}

    def line(self):
        now = {r.number: r.cycles if r.number in self.done else min(r.reached(), r.cycles) for r in self.rows}
        total = sum(r.cost for r in self.rows)
        gone = sum(r.cost * now[r.number] / r.cycles for r in self.rows)
        here = gone - sum(r.cost * self.was[r.number] / r.cycles for r in self.rows)
        left = (time.time() - self.begin) * (total - gone) / here / 60 if here > 0 else float("nan")
        at = ", ".join(f"row {r.number} cycle {now[r.number]:.1f}/{r.cycles}" for r in self.rows if 0 < now[r.number] < r.cycles)
        return f"{gone / total:.0%} done, about {left:.0f} min left; {at}"


def work(row, folder, processes, stopping, lock):
    if stopping.is_set():
        raise RuntimeError(f"row {row.number} was not begun")
    if not has_mesh(row.case):
        shutil.rmtree(row.case, ignore_errors=True)
        row.make()
    if row.reached() < row.cycles - 0.01:
        edit(row.at("system", "controlDict"), endTime=repr(row.cycles * row.period))  # more than it was made for, perhaps
        row.run(processes)
    line, result = finish(row)
    with lock:
        append(folder, line)
    if not row.o.keep:
        clear(row.case)
    return (f"row {row.number:2d}: paper {row.entry['lambda_diam']:g} +- {row.entry['dlambda_diam']:g}; {result['state']}; "
            f"{faraday.describe(result)}, amplitude {result['amplitude']:.2g}, growth {result['growth']:.3f}; {line['cpuSeconds']} s")


def sweep(folder, rows, jobs):
    """True when all rows are done."""
    processes, stopping, lock, good = set(), threading.Event(), threading.Lock(), True

    def stop(*_):
        stopping.set()
        for p in list(processes):
            p.send_signal(signal.SIGTERM)
    for s in (signal.SIGINT, signal.SIGTERM):
        signal.signal(s, stop)
    progress = Progress(rows)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        pending = {pool.submit(work, row, folder, processes, stopping, lock): row for row in rows}
        while pending:
            ready, _ = concurrent.futures.wait(pending, timeout=60, return_when=concurrent.futures.FIRST_COMPLETED)
            for job in ready:
                row = pending.pop(job)
                try:
                    print(job.result(), flush=True)
                    progress.done.add(row.number)
                except (RuntimeError, OSError, ValueError, KeyError) as error:
                    good = False
                    print(f"FAILED: {error}", flush=True)
            print(progress.line(), flush=True)
    return good


def arguments():
    parser = command.parser(__doc__)
    parser.add_argument("folder")
    parser.add_argument("-rows", type=numbers, default=None, help="default: all, the longest runs first")
    parser.add_argument("-jobs", type=int, default=os.cpu_count())
    parser.add_argument("-cycles", type=int, default=20)
    parser.add_argument("-last", type=int, default=8, help="cycles to measure in")
    parser.add_argument("-warm", type=int, nargs=2, default=[8, 4])
    parser.add_argument("-warmBelow", type=float, default=2.1)
    parser.add_argument("-length", type=float, default=1, help="of the box, in that of the paper")
    parser.add_argument("-seed", type=int, default=1)
    parser.add_argument("-template", default=TEMPLATE)
    parser.add_argument("-note", default="", help="for the column of options, say the version")
    parser.add_argument("-keep", action="store_true", help="the fields of rows that are done")
    parser.add_argument("-draw", action="store_true", help="only print and draw what stands in the table")
    return parser.parse_args()


def main():
    o = arguments()
    os.makedirs(o.folder, exist_ok=True)
    if not o.draw:
        done = {int(r["row"]) for r in table(o.folder)}
        entries = paper()
        rows = [Row(o.folder, k, entries[k], o) for k in o.rows or entries if k not in done]
        if not o.rows:
            rows.sort(key=lambda r: -r.cost)
        print(f"{len(rows)} rows to run, {len(done)} stand in {o.folder}/faradayDiagram.csv", flush=True)
        good = sweep(o.folder, rows, o.jobs) if rows else True
    if table(o.folder):
        print(markdown(o.folder))
        draw(o.folder)
    sys.exit(0 if o.draw or good else 1)


if __name__ == "__main__":
    main()
