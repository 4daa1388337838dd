#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where waves set in: growth per period of single waves on a layer of gas, over the amplitude of the plate.

    haff faradayOnset FOLDER [-gamma 2 2.25 ..] [-A 1.4 1.55 ..] [-waves 16 20 ..] [-width 2] [-warm 0] [-jobs 2] [-draw]

Each run is a box one wave long, cells `width` x 1, of the template (cases/faradaySweep), shaken with the acceleration Gamma and the
amplitude A (the frequency follows), from a layer at rest whose columns hold 1 + 1e-3 sin(2 pi x/L) of the mean mass. After -settle
periods the part of the wave that turns over with every stroke has the amplitude a(n) in the mass of the columns; its growth is the
slope of ln a over the periods that follow, until -cycles. Waves set in at the A where the growth of the fastest wave is 1, by a line
through the two A about it. FOLDER/faradayOnset.csv keeps the runs: those in it are not run again.
"""
import concurrent.futures
import csv
import math
import os
import shutil
import subprocess
import sys
import threading

import numpy as np

from haff import command
from haff.layers import faraday
from haff.paths import program
from haff.plot import figures
from studies.faradayDiagram import TEMPLATE
from studies.faradayRows import GRAVITY, call, clear, copy, edit, throw

HOT, RAMP = 2.75, 4  # g; periods
COLUMNS = "Gamma A_sigma f_Hz wave width warm cycles settle amplitude growth flip meanHeight options".split()


def frequency(gamma, amplitude):
    return math.sqrt(gamma * GRAVITY / amplitude) / (2 * math.pi)


def growth(case, settle):
    """Amplitude at the end and factor per period of the alternating part of mode 1, flip, mean height of the layer."""
    layer = faraday.Layer(case)
    cycles, c = faraday.samples(layer, settle)[0]
    wave = np.abs(faraday.alternating(c, cycles)[:, 1])
    height = np.mean([layer.height(t).mean() for t in layer.phases(settle)[0][1]])
    return wave[-1], math.exp(np.polyfit(np.arange(len(wave)), np.log(wave), 1)[0]), faraday.flip(c[:, 1], cycles), height


def run(folder, gamma, amplitude, wave, o):
    """One wave; the line of the table."""
    case, f = os.path.join(folder, f"G{gamma:g}-A{amplitude:g}-L{wave:g}-W{o.width:g}-warm{o.warm}"), frequency(gamma, amplitude)
    before = o.warm + RAMP if o.warm else 0
    shaking = "table ((0 %r) (%r %r) (%r %r))" % (HOT, o.warm / f, HOT, before / f, gamma) if o.warm else repr(gamma)
    at = lambda *names: os.path.join(case, *names)
    shutil.rmtree(case, ignore_errors=True)
    copy(o.template, case)
    edit(at("constant", "shaking"), frequency=repr(f), amplitude=shaking)
    edit(at("0.orig", "alpha"), modes=1, amplitude="1e-3")
    edit(at("system", "controlDict"), endTime=repr((before + o.cycles) / f), writeInterval=repr(1 / f))
    height = math.ceil((20 + 5 * throw(HOT if o.warm else gamma, f)) / 10) * 10
    size = [w for key, value in (("L", wave), ("H", height), ("W", o.width)) for w in ("-setnumber", key, f"{value:g}")]
    call(case, "gmsh", "-3", "-v", "2", *size, at("mesh.geo"), "-o", at("mesh.msh"))
    call(case, "gmshToCase", at("mesh.msh"), "-case", case)
    with open(at("log.granularGas"), "w") as log:
        if subprocess.run([program("granularGas"), "-case", case], stdout=log, stderr=subprocess.STDOUT).returncode:
            raise RuntimeError(f"granularGas failed, see {log.name}")
    last, factor, flip, mean = growth(case, before + o.settle)
    clear(case)
    return {"Gamma": gamma, "A_sigma": amplitude, "f_Hz": f"{f:.6g}", "wave": wave, "width": o.width, "warm": o.warm, "cycles": o.cycles, "settle": o.settle,
            "amplitude": f"{last:.3g}", "growth": f"{factor:.4f}", "flip": f"{flip:.3f}", "meanHeight": f"{mean:.4g}", "options": o.note}


def table(folder):
    path = os.path.join(folder, "faradayOnset.csv")
    if not os.path.exists(path):
        return []
    with open(path) as f:
        return [{k: v if k == "options" else float(v) for k, v in row.items()} for row in csv.DictReader(f)]


def fastest(rows, gamma, width, warm):
    """[(A, growth, wave)] of the fastest wave at every A, rising."""
    mine = [r for r in rows if (r["Gamma"], r["width"], r["warm"]) == (gamma, width, warm)]
    best = [max((r for r in mine if r["A_sigma"] == a), key=lambda r: r["growth"]) for a in sorted({r["A_sigma"] for r in mine})]
    return [(r["A_sigma"], r["growth"], r["wave"]) for r in best]


def onset(line):
    """The A at which a line of `fastest` passes growth 1 upwards for the last time; nan where it does not."""
    for (a, g, _), (b, h, _) in reversed(list(zip(line, line[1:]))):
        if g < 1 <= h:
            return a + (b - a) * math.log(1 / g) / math.log(h / g)
    return math.nan


def draw(folder):
    rows = table(folder)
    fig, axes = figures.panels(1, 1, width=4.5, height=3.2)
    ax = axes[0][0]
    kinds = sorted({(r["width"], r["warm"]) for r in rows}, key=lambda k: (-k[0], k[1]))
    for colour, gamma in zip(figures.COLOURS, sorted({r["Gamma"] for r in rows})):
        for (width, warm), style in zip(kinds, ("-", "--", ":", "-.")):
            line = fastest(rows, gamma, width, warm)
            if not line:
                continue
            kind = (f", cells {width:g} wide" if width != 2 else "") + (", warm" if warm else "")
            ax.plot([a for a, _, _ in line], [g for _, g, _ in line], style, marker="o", markersize=3, color=colour, label=rf"$\Gamma$ = {gamma:g}{kind}")
            print(f"Gamma {gamma:g}{kind}: growth " + ", ".join(f"{g:.3f} at A = {a:g} (wave {w:g})" for a, g, w in line)
                  + f"; sets in at A = {onset(line):.3g}")
    ax.axhline(1, color="0.5", linewidth=0.6)
    ax.axvspan(1.55, 1.64, color="0.9")
    ax.legend(fontsize=7, title="grey: onset in the paper", title_fontsize=7)
    figures.label(ax, r"amplitude of the plate $A$ ($\sigma$)", "growth per period, fastest wave")
    figures.save(fig, os.path.join(folder, "faradayOnset.png"))


def arguments():
    parser = command.parser(__doc__)
    parser.add_argument("folder")
    parser.add_argument("-gamma", type=float, nargs="+", default=[2.0, 2.25, 2.52, 2.75])
    parser.add_argument("-A", type=float, nargs="+", default=[1.55, 1.7, 1.85, 2.1, 2.5])
    parser.add_argument("-waves", type=int, nargs="+", default=[16, 18, 20, 22, 26])
    parser.add_argument("-width", type=float, default=2, help="of the cells")
    parser.add_argument("-warm", type=int, default=0, metavar="N")
    parser.add_argument("-cycles", type=int, default=14)
    parser.add_argument("-settle", type=int, default=6)
    parser.add_argument("-jobs", type=int, default=os.cpu_count())
    parser.add_argument("-template", default=TEMPLATE)
    parser.add_argument("-note", default="", help="for the column of options, say the version")
    parser.add_argument("-draw", action="store_true", help="only draw what stands in the table")
    return parser.parse_args()


def main():
    o, lock, good = arguments(), threading.Lock(), True
    os.makedirs(o.folder, exist_ok=True)
    path = os.path.join(o.folder, "faradayOnset.csv")
    done = {(r["Gamma"], r["A_sigma"], r["wave"], r["width"], r["warm"]) for r in table(o.folder)}
    todo = [(g, a, w) for g in o.gamma for a in o.A for w in o.waves if (g, a, w, o.width, o.warm) not in done and not o.draw]
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        jobs = [pool.submit(run, o.folder, *one, o) for one in todo]
        for n, job in enumerate(concurrent.futures.as_completed(jobs), 1):
            try:
                line = job.result()
            except (RuntimeError, OSError, ValueError, KeyError) as error:
                good = False
                print(f"FAILED: {error}", flush=True)
                continue
            with lock, open(path, "a") as f:
                f.write((",".join(COLUMNS) + "\n" if f.tell() == 0 else "") + ",".join(str(line[k]) for k in COLUMNS) + "\n")
            print(f"{n}/{len(todo)}: Gamma {line['Gamma']:g}, A {line['A_sigma']:g}, wave {line['wave']}: growth {line['growth']}, flip {line['flip']}", flush=True)
    if table(o.folder):
        draw(o.folder)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
