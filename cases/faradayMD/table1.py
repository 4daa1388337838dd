# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of Table 1 of Carrillo et al. by granularMD: wavelengths beside those of the paper.

    haff figure table1.py FOLDER [-rows 1,5-9] [-plate 1 0.75] [-jobs 2] [-warm CYCLES] [-cycles FIRST LAST] [-seed 1] [-keep]

Each row runs as a variant of this case in FOLDER/rowNN-eE (E: restitution of the plate) and adds a line to
FOLDER/table1.csv, drawn as FOLDER/table1.png; rows that stand there are not run again, and a run that was stopped goes on.
Up to -jobs run at once, longest first. -warm: that many cycles are shaken with the acceleration WARM first, and only then
as the row says. Fields are measured from cycle FIRST to LAST and removed then (-keep: not).
"""
import concurrent.futures
import csv
import math
import os
import re
import shutil
import sys
import threading
import time

import numpy as np

from haff import command
from haff.layers import faraday
from studies.faradayRows import acceleration, call, clear, copy, edit, has_mesh, mesh, numbers, paper, throw

HERE = os.path.dirname(os.path.abspath(__file__))
WARM = 2.75  # g: amplitude of -warm
COLUMNS = ("row Gamma f_Hz A_sigma L_sigma N plate seed warm cycles paper dpaper wavelength shorter longer centroid spread "
           "contrast flip stands within strongest dstrongest meanHeight impacts seconds").split()
lock = threading.Lock()


def height(amplitude, frequency):
    """Of the box: grains thrown by the plate, above the layer and its stroke; whole."""
    return math.ceil((30 + 4 * throw(acceleration(amplitude, frequency), frequency)) / 10) * 10


def make(case, row, plate, seed, cycles):
    """The case with its mesh; written at quarters of the period."""
    copy(HERE, case)
    period = 1 / row["f_Hz"]
    at = lambda *names: os.path.join(case, *names)
    edit(at("constant", "shaking"), frequency=repr(row["f_Hz"]), amplitude=repr(acceleration(row["A_diam"], row["f_Hz"])))
    edit(at("constant", "particleProperties"), N=int(row["N"]), seed=seed, writeCloud="no", restitution=plate,
         window=repr(period / 100))
    edit(at("system", "controlDict"), endTime=repr(cycles * period), writeInterval=repr(period / 4))
    mesh(case, row["L_diam"], height(row["A_diam"], row["f_Hz"]))


def measured(case, first, last):
    """What faraday.py finds, as entries of a line of the table."""
    layer = faraday.Layer(case)
    found = faraday.samples(layer, first, last)
    samples = list(found.values())
    result = faraday.measure(samples, layer.length)
    mean, deviation = faraday.strongest(samples, layer.length)
    heights = np.array([layer.height(name).mean() for name in next(iter(layer.phases(first, last).values()))[1]])
    entries = {k: f"{result[k]:.4g}" for k in ("wavelength", "shorter", "longer", "centroid", "spread", "contrast", "flip")}
    return {**entries, "stands": "yes" if result["stands"] else "no", "strongest": f"{mean:.4g}",
            "dstrongest": f"{deviation:.3g}", "meanHeight": f"{heights.mean():.4g}"}, result


def run(folder, number, row, plate, o):
    """One row; the line of the table."""
    case = os.path.join(folder, f"row{number:02d}-e{plate:g}" + (f"-warm{o.warm}" if o.warm else "") + f"-seed{o.seed}")
    begin = time.time()
    if not has_mesh(case):
        shutil.rmtree(case, ignore_errors=True)
        make(case, row, plate, o.seed, o.warm or o.last)
    shaking, control = (os.path.join(case, *names) for names in (("constant", "shaking"), ("system", "controlDict")))
    period = 1 / row["f_Hz"]
    if o.warm:
        edit(shaking, amplitude=WARM)
        edit(control, endTime=repr(o.warm * period))
        call(case, "granularMD", "-case", case)
        edit(shaking, amplitude=repr(acceleration(row["A_diam"], row["f_Hz"])))
        edit(control, endTime=repr(o.last * period))
    call(case, "granularMD", "-case", case)
    entries, result = measured(case, o.first, o.last)
    with open(os.path.join(case, "log.granularMD")) as f:
        impacts = re.findall(r"^(\d+) collisions and", f.read(), re.M) or [""]
    away = abs(result["wavelength"] - row["lambda_diam"])
    line = {"row": number, "Gamma": row["Gamma_printed"], "f_Hz": row["f_Hz"], "A_sigma": row["A_diam"],
            "L_sigma": int(row["L_diam"]), "N": int(row["N"]), "plate": plate, "seed": o.seed, "warm": o.warm,
            "cycles": f"{o.first:g}-{o.last:g}", "paper": row["lambda_diam"], "dpaper": row["dlambda_diam"], **entries,
            "within": "yes" if result["stands"] and away <= row["dlambda_diam"] else "no",
            "impacts": impacts[-1], "seconds": f"{time.time() - begin:.0f}"}
    spectrum = " ".join("%.5g" % p for p in result["power"][1:101])
    with lock:
        with open(os.path.join(folder, "spectra.txt"), "a") as f:
            f.write(f"{number} {plate:g} {row['L_diam']:g} {result['floor']:.5g} {spectrum}\n")
        new = not os.path.exists(os.path.join(folder, "table1.csv"))
        with open(os.path.join(folder, "table1.csv"), "a") as f:
            f.write((",".join(COLUMNS) + "\n" if new else "") + ",".join(str(line[k]) for k in COLUMNS) + "\n")
    if not o.keep:
        clear(case)
    return (f"row {number:2d}, plate {plate:g}: paper {row['lambda_diam']:g} +- {row['dlambda_diam']:g}; "
            f"{faraday.describe(result)}")


def done_already(folder, o):
    path = os.path.join(folder, "table1.csv")
    if not os.path.exists(path):
        return set()
    with open(path) as f:
        return {(int(r["row"]), float(r["plate"])) for r in csv.DictReader(f)
                if int(r["warm"]) == o.warm and int(r["seed"]) == o.seed}


def draw(folder):
    """Wavelength over amplitude, Fig. 3 of the paper; bars: the paper's deviation, our neighbours in the box."""
    from haff.plot import figures
    with open(os.path.join(folder, "table1.csv")) as f:
        words = ("stands", "within", "cycles")
        lines = [{k: v if k in words else float(v or "nan") for k, v in r.items()} for r in csv.DictReader(f)]
    fig, axes = figures.panels(1, 2, width=7.5, height=3.2)
    for ax, plate in zip(axes[0], (1.0, 0.75)):
        for colour, gamma in zip(figures.COLOURS, (2.0, 2.25, 2.52, 2.75)):
            rows = [r for r in lines if r["Gamma"] == gamma and r["plate"] == plate]
            ax.errorbar([r["A_sigma"] for r in rows], [r["paper"] for r in rows], [r["dpaper"] for r in rows], color=colour,
                        fmt="o", markersize=3, linewidth=0.5, markerfacecolor="none", label=rf"$\Gamma$ = {gamma:g}")
            rows = [r for r in rows if r["stands"] == "yes"]
            bars = [[r["wavelength"] - r["shorter"] for r in rows], [r["longer"] - r["wavelength"] for r in rows]]
            ax.errorbar([r["A_sigma"] + 0.08 for r in rows], [r["wavelength"] for r in rows], bars, color=colour, fmt="s",
                        markersize=4)
        figures.label(ax, r"amplitude $A$ ($\sigma$)", r"wavelength ($\sigma$)", f"restitution of the plate {plate:g}")
        ax.set(xlim=(1, 12), ylim=(0, 90))
    axes[0][0].legend(title="open: the paper, filled: ours", fontsize=7, title_fontsize=7)
    figures.save(fig, os.path.join(folder, "table1.png"))


def arguments():
    parser = command.parser(__doc__)
    parser.add_argument("folder")
    parser.add_argument("-rows", type=numbers, default=list(range(1, 23)))
    parser.add_argument("-plate", type=float, nargs="+", default=[1.0])
    parser.add_argument("-jobs", type=int, default=os.cpu_count())
    parser.add_argument("-warm", type=int, default=0)
    parser.add_argument("-cycles", dest="span", type=float, nargs=2, default=[20, 70])
    parser.add_argument("-seed", type=int, default=1)
    parser.add_argument("-keep", action="store_true")
    o = parser.parse_args()
    o.first, o.last = o.span
    return o


def main():
    o = arguments()
    os.makedirs(o.folder, exist_ok=True)
    rows, done = paper(), done_already(o.folder, o)
    todo = [(k, e) for e in o.plate for k in o.rows if (k, e) not in done]
    todo.sort(key=lambda entry: -rows[entry[0]]["N"] / rows[entry[0]]["f_Hz"])
    begin, cost = time.time(), [rows[k]["N"] / rows[k]["f_Hz"] for k, _ in todo]
    print(f"{len(todo)} rows to run, {len(done)} stand in {o.folder}/table1.csv", flush=True)
    spent, failed = 0.0, 0
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        jobs = {pool.submit(run, o.folder, k, rows[k], e, o): rows[k]["N"] / rows[k]["f_Hz"] for k, e in todo}
        for job in concurrent.futures.as_completed(jobs):
            spent += jobs[job]
            left = (time.time() - begin) * (sum(cost) - spent) / spent
            try:
                message = job.result()
            except (RuntimeError, OSError, ValueError) as error:
                failed, message = failed + 1, f"FAILED: {error}"
            print(f"{message}   ({spent / sum(cost):.0%}, about {left / 60:.1f} min left)", flush=True)
    if os.path.exists(os.path.join(o.folder, "table1.csv")):
        draw(o.folder)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
