# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of postprocessing/reports/serna.md and of a table of marquinaStability.md: Serna & Marquina (2005) by the cases of this tree, on several grids and by several fluxes.

    haff serna FOLDER [-write]

runs some fifty variants of wedge, wedgeDense, wall, blast, blastElastic, blastDense and vibratedLayer in FOLDER, one after the other, and prints the tables;
-write puts them into the reports, between their markers. What stands in FOLDER is not run again: take a new one for another program. About four minutes of
one core. A run that ends before its time, by an inelastic collapse, is listed with its last time."""
import os
import re

import numpy as np

import haff
from haff import command
from haff.paths import TOP
from haff.runs import copies, expected
from studies.source import measured_by

REPORTS = os.path.join(TOP, "postprocessing", "reports")
PLACES = {"flux": ("system/fvSchemes", "fluxScheme"), "reconstruct": ("system/fvSchemes", "reconstruct"), "e": ("constant/granularProperties", "grain/restitution"),
          "printed": ("constant/granularProperties", "GoldshteinShapiroCoeffs/printedSoundSpeed"), "end": ("system/controlDict", "endTime"),
          "interval": ("system/controlDict", "writeInterval")}
PRINTED, STABLE = {"flux": "Marquina", "printed": "yes"}, {"flux": "MarquinaStable"}
MARQUINA = {"flux": "Marquina"}
WEDGES = (("wedge", 0.0425), ("wedgeDense", 0.0412))
NOISE = 1000  # times that cells were limited until then, beyond which a maximum is that of noise, which round-off decides
CYCLES = 0.35, 1.35, 2.35, 3.35, 4.35


class Runs:
    """Variants of cases, each in a folder of `folder`."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self, name, cells=None, **entries):
        """The variant, run to its end or until it stops: a haff.Case."""
        changes = {}
        for key, value in entries.items():
            changes.setdefault(PLACES[key][0], {})[PLACES[key][1]] = value
        label = "-".join([name, *(f"{key}{value}" for key, value in entries.items()), *([str(cells)] if cells else [])])
        path = os.path.join(self.folder, label)
        try:
            return haff.run(os.path.join(TOP, "cases", name), changes, folder=path, mesh={"N": cells} if cells else None)
        except haff.RunError:
            return haff.Case(path)


def stopped(case):
    """The time at which a run stopped before its end, or None."""
    last = max(map(float, case.times))
    end = float(copies.control(case.path, "endTime"))
    if last >= end * (1 - 1e-9):
        return None
    with open(os.path.join(case.path, "log.granularGas"), encoding="utf-8") as f:
        found = re.findall(r"\bt(?:ime)? ?= ?([\d.e+-]+\d)", f.read())
    return float(found[-1]) if found else last


def value(case, quantity, time, digits):
    """A quantity of expected.py in that many digits, or when the run stopped, or that it is noise."""
    stop = stopped(case)
    if stop is not None and stop < time:
        return f"stops at {stop:.4f}"
    found = f"{expected.measure(case, {'quantity': quantity, 'field': 'alpha', 'time': time}):.{digits}f}"
    times = limited(case, time)
    return f"noise, limited {times:.0e} times" if times > NOISE else found


def limited(case, time):
    """How often a cell was limited until then, by the table postProcessing/limiter of the run."""
    if "limiter" not in case.tables():
        return 0
    rows = case.table("limiter", "limiter.dat")
    return int(rows[rows[:, 0] <= time * (1 + 1e-9), 2].sum())


def steps(runs):
    """Fig. 8: by flux, and by grid."""
    def greatest(name, time, cells=400, **entries):
        case = runs(name, cells, interval=time, **entries)
        return value(case, "maximum", time, 5), case

    def off_wall(case, time):
        row = np.isclose(case.centres[:, 1], case.centres[:, 1].min())
        x, alpha = case.centres[row, 0], case.field("alpha", case.time(time))[row]
        return f"{np.interp(4.9, *zip(*sorted(zip(x, alpha)))):.4f}"

    (thin, early), (dense, late) = WEDGES
    take = lambda *a, **k: greatest(*a, **k)[0]
    common = {name: [greatest(name, time, n) for n in (100, 200, 400, 800)] for name, time in WEDGES}
    flux = [["greatest volume fraction", "paper", "prototype", "haff"],
            ["dilute, t = 0.0425: `Marquina` / printed / `common`", "0.1033", "0.10334 / 0.10333 / 0.10206",
             f"{take(thin, early, **MARQUINA)} / {take(thin, early, **PRINTED)} / {common[thin][2][0]}"],
            ["dilute, `Marquina` WPENO5, printed", "no significant difference", "", take(thin, early, reconstruct="WPENO5", **PRINTED)],
            ["dense, t = 0.0412: `Marquina` printed / `common`", "0.5177", "0.51747 / 0.51380", f"{take(dense, late, **PRINTED)} / {common[dense][2][0]}"],
            ["dense, `Marquina`, corrected sound speed", "", "noise", take(dense, late, **MARQUINA)]]
    grids = [["`common`, cells a side", "100", "200", "400", "800"],
             ["dilute: prototype", "0.09420", "0.09830", "0.10206", ""],
             ["dilute: haff", *(v for v, _ in common[thin])],
             ["dilute, 0.1 cm off the wall", *(off_wall(c, early) for _, c in common[thin])],
             ["dense: prototype", "0.49854", "0.50851", "0.51380", ""],
             ["dense: haff", *(v for v, _ in common[dense])],
             ["dense, 0.1 cm off the wall", *(off_wall(c, late) for _, c in common[dense])]]
    mach, mirror = (" / ".join(f"{expected.measure(common[name][2][1], {'quantity': quantity, 'field': 'alpha', 'time': time}):.{digits}g}" for name, time in WEDGES)
                    for quantity, digits in (("upstream Mach number", 9), ("asymmetry", 2)))
    law = [["400 x 400, dilute / dense", "paper", "exact", "haff"], ["upstream Mach number", "\"12\" / \"15.5\"", "11.5909271 / 11.3907967", mach],
           ["asymmetry about the diagonal", "", "0", mirror]]
    return {"step": flux, "stepGrids": grids, "stepMach": law}


def wall(runs):
    """Fig. 2."""
    grids = 250, 500, 1000, 2000
    common, marquina = [runs("wall", n) for n in grids], [runs("wall", n, **MARQUINA) for n in grids[:3]]
    near = []
    for case in common:
        x, alpha = case.line(("alpha",), 0.2)
        near.append(f"{np.interp(9.96, x, alpha):.4f}")
    return {"wall": [["volume fraction in the wall's cell, cells:", *map(str, grids)],
                     ["t = 0.20, prototype `common`", "0.5957", "0.6173", "0.6276", ""],
                     ["t = 0.20, haff `common`", *(value(c, "value at the wall", 0.2, 4) for c in common)],
                     ["t = 0.20, haff `common`, 0.04 cm off the wall", *near],
                     ["t = 0.20, haff `Marquina`", *(value(c, "value at the wall", 0.2, 4) for c in marquina), ""],
                     ["t = 0.23, paper", "", "", "0.649472", ""],
                     ["t = 0.23, prototype `common`", "0.64952", "0.64958", "0.64994", ""],
                     ["t = 0.23, haff `common`", *(value(c, "value at the wall", 0.23, 4) for c in common)],
                     ["t = 0.23, haff `Marquina`", *(value(c, "value at the wall", 0.23, 4) for c in marquina), ""]]}


def blasts(runs):
    """Figs 3 and 4, and Fig. 5."""
    prototype = {0.9: "0.09844 / 0.09995 / 0.10087", 0.7: "/ 0.17841 /", 0.2: "0.4164 / 0.4844 / 0.5333"}
    greatest = [["greatest volume fraction, `common` WPENO5", "500", "1000", "2000", "prototype 500 / 1000 / 2000", "`Marquina` 1000"]]
    for e in prototype:
        greatest.append([f"e = {e:g}", *(value(runs("blast", n, e=e), "maximum", 5.48, 5) for n in (500, 1000, 2000)), prototype[e],
                         value(runs("blast", 1000, e=e, **MARQUINA), "maximum", 5.48, 5)])
    grids = 250, 500, 1000, 2000, 4000
    errors = [["e = 1, L1(rho)/50 against the exact solution", *map(str, grids)]]
    for name, entries, known in (("`common` PHM", {}, ("0.1255", "0.0763", "0.0436", "0.0225", "0.0143")), ("`Marquina` PHM", MARQUINA, None),
                                 ("`common` WPENO5", {"reconstruct": "WPENO5"}, ("0.0972", "0.0579", "0.0331", "0.0168", "")),
                                 ("`common` first order", {"reconstruct": "firstOrder"}, None)):
        if known:
            errors.append([f"{name}, prototype", *known])
        errors.append([name, *(f"{expected.measure(runs('blastElastic', n, **entries), {'quantity': 'L1 error', 'time': 5.48}):.4f}" for n in grids)])
    return {"blasts": greatest, "blastElastic": errors, "blastDense": dense_blast(runs)}


def dense_blast(runs):
    def line(name, prototype, cells, **entries):
        case = runs("blastDense", cells, **entries)
        said = value(case, "maximum", 12, 5)
        if said[0].isdigit():
            said += f" at x = {value(case, 'position of maximum', 12, 2)}"
        return [name, said, prototype]
    return [["greatest volume fraction", "haff", "prototype"],
            line("`common` WPENO5, 2000 cells", "0.646072 at 6.16", 2000), line("`common` PHM, 2000", "0.6437", 2000, reconstruct="PHM"),
            line("`common` WPENO5, 1000", "", 1000), line("`common` PHM, 1000", "", 1000, reconstruct="PHM"),
            line("`Marquina` WPENO5, 2000", "dies at 7.8 without net", 2000, **MARQUINA), line("the same, printed", "dies at 7.1 without net", 2000, **PRINTED),
            line("`MarquinaStable` WPENO5, 2000 ([why, and what it is](marquinaStability.md))", "", 2000, **STABLE)]


def layer(runs):
    """Figs 6 and 7."""
    common, marquina = runs("vibratedLayer", 1500, end=0.05), runs("vibratedLayer", 1500, **MARQUINA)
    take = lambda case, quantity, digits: [value(case, quantity, phase / 200, digits) for phase in CYCLES]
    frames = [["f t", *map(str, CYCLES)],
              ["sum: paper", "28.23", "28.31", "28.28", "28.32", "28.27"],
              ["sum: prototype `common`", "27.6887", "27.7096", "27.7549", "27.8023", "27.7910"],
              ["sum: haff `common`", *take(common, "sum", 3)], ["sum: haff `Marquina`", *take(marquina, "sum", 3)],
              ["plate: prototype `common`", "0.299", "0.328", "0.290", "0.283", "0.285"],
              ["plate: haff `common`", *take(common, "value at the wall", 4)],
              ["plate: independent numpy program", "0.3023", "0.3338", "0.2966", "0.2918", "0.2954"]]
    profiles = [common.field("alpha", common.time((n + 0.15) / 200)) for n in range(10)]
    changes = [f"{np.abs(b - a).sum() / a.sum():.3f}" for a, b in zip(profiles, profiles[1:])]
    return {"layer": frames, "layerCycles": [["change from cycle to cycle, L1, f t = .15", *(f"{n}-{n + 1}" for n in range(1, 10))],
                                             ["prototype", "0.365", "0.452", "0.235", "0.122", "", "", "", "", ""], ["haff", *changes]]}


def cure(runs):
    """The paper's flux, the stable one and the default, for marquinaStability.md."""
    fluxes = MARQUINA, STABLE, {}
    wedge = lambda name, time, grids: [", ".join(value(runs(name, n, interval=time, **flux), "maximum", time, 4) for n in grids) for flux in fluxes]
    plate = lambda time, grids: [", ".join(value(runs("wall", n, **flux), "value at the wall", time, 4) for n in grids) for flux in fluxes]
    (thin, early), (dense, late) = WEDGES
    blasts = [runs("blastDense", 2000, **flux) for flux in fluxes]
    return {"cure": [["", "`Marquina`", "`MarquinaStable`", "`common`"],
                     ["dilute wedge, nu_max at 200, 400 cells (paper 0.1033)", *wedge(thin, early, (200, 400))],
                     ["dense wedge, correct A', 100, 200, 400 (paper 0.5177)", *wedge(dense, late, (100, 200, 400))],
                     ["wall, alpha in the wall's cell at t = 0.20, 250, 500 cells", *plate(0.2, (250, 500))],
                     ["the same, t = 0.23, 500, 1000 cells (paper 0.649472)", *plate(0.23, (500, 1000))],
                     ["`blastDense` to t = 12, WPENO5, 2000 cells, alpha_max at t = 12",
                      *(value(c, "maximum", 12, 4) for c in blasts)]]}


def markdown(rows):
    head, *rest = ("| " + " | ".join(row) + " |" for row in rows)
    return "\n".join([head, "|" + "---|" * len(rows[0]), *rest]).replace("|  |", "| |").replace("|  |", "| |") + "\n"


def written(text, tables, when):
    """The text of the report with these tables between their markers, each below the line that tells when. ValueError where one has none."""
    for name, rows in tables.items():
        mark = re.compile(rf"(<!-- table {name}: made by haff serna -->\n).*?(<!-- end -->)", re.S)
        if not mark.search(text):
            raise ValueError(f"the report has no marker of the table {name}: <!-- table {name}: made by haff serna -->")
        text = mark.sub(lambda found: f"{found[1]}{when}\n\n{markdown(rows)}{found[2]}", text)
    return text


def main():
    parser = command.parser(__doc__)
    parser.add_argument("folder")
    parser.add_argument("-write", action="store_true", help="into the reports")
    o = parser.parse_args()
    runs, when = Runs(o.folder), measured_by("build/bin/haff serna FOLDER -write")
    for report, studies in (("serna.md", (blasts, wall, layer, steps)), ("marquinaStability.md", (cure,))):
        tables, path = {}, os.path.join(REPORTS, report)
        for study in studies:
            tables |= study(runs)
        for name, rows in tables.items():
            print(f"{name}\n{markdown(rows)}")
        if o.write:
            with open(path, encoding="utf-8") as f:
                text = written(f.read(), tables, when)
            with open(path, "w", encoding="utf-8") as f:
                f.write(text)


if __name__ == "__main__":
    main()
