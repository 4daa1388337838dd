# SPDX-License-Identifier: GPL-3.0-or-later
"""crossCheck --limits: granularGas with a granular gas towards the same program with what the gas tends to, on the blast."""
import csv
import os
from types import SimpleNamespace

import numpy as np

import haff
from haff.case.geometry import Geometry
from studies.exact.eos import GoldshteinShapiro, PerfectGas
from studies.exact.riemann import BLAST, Riemann
from studies.made import twin
from studies.measured import comparison
from studies.source import measured_by, of_source

STEPS, TOLERANCE = 6, 0.1
PERFECT = "equationOfState perfectGas; perfectGasCoeffs { gamma 1.6666666666666667; } cooling none; grain { restitution 1; }"


def nu(sigma):
    """Volume fraction of the gas on the right."""
    return np.pi / 6 * BLAST[1][0] * sigma**3


def losses(k):
    """1 - e^2 of the k-th step where e goes to 1."""
    return 0.2 * 4.0**-k


# small: what goes to 0; step k has (sigma, 1 - e^2); order: of the difference in `small`, from the equations: pressure
# departs by 2 (1 + e) nu, the sink is (1 - e^2) nu/sigma times what does not depend on the grains
SERIES = [
    SimpleNamespace(name="sigma", title="elastic grains that shrink", small="nu", limit="perfect", order=1.0, exact=True,
                    grains=lambda k: (0.1 * 0.5**k, 0.0)),
    SimpleNamespace(name="e", title="grains of 0.1 cm that become elastic", small="1 - e^2", limit="elastic", order=1.0, exact=False,
                    grains=lambda k: (0.1, losses(k))),
    SimpleNamespace(name="both", title="grains that shrink and become elastic, 1 - e^2 ~ nu", small="nu", limit="perfect", order=1.0,
                    exact=False, grains=lambda k: (0.1 * 0.5**k, 0.2 * 8.0**-k)),
    SimpleNamespace(name="inelastic", title="grains that shrink, e = 0.9", small="nu", limit="perfect", order=2 / 3, exact=False,
                    grains=lambda k: (0.1 * 0.5**k, 0.19)),
]


def grain_entries(sigma, loss):
    return f"grain {{ diameter {sigma!r}; restitution {np.sqrt(1 - loss)!r}; }} cooling {'Haff' if loss else 'none'};"


def run(o, name, entries):
    """cases/blast with other grains: geometry and state at the end."""
    case = os.path.join(o.out, "limits", name)
    if not os.path.isdir(os.path.join(o.out, "limits", "mesh")):
        twin.copy(of_source("cases", "blast"), os.path.join(o.out, "limits", "mesh"), o.bin, o.cells)
    twin.copy(os.path.join(o.out, "limits", "mesh"), case, o.bin)
    twin.append(os.path.join(case, "constant", "granularProperties"), "\n" + entries + "\n")
    twin.append(os.path.join(case, "system", "controlDict"),
                "\nwriteControl adjustableRunTime; writeInterval 5.48; endTime 5.48; startFrom startTime; #remove functions\n")
    twin.called(os.path.join(o.bin, "granularGas"), "-case", case)
    done = haff.Case(case)
    return Geometry(done), {f: done.field(f) for f in comparison.FIELDS}


def exact(gas, cells):
    """rho in the cells."""
    return Riemann(gas, *BLAST).averages(np.linspace(0, 10, cells + 1), 5.0, 5.48)[0]


def measure(o):
    """Rows: series, step, sigma, e, what is small, {field: difference to the limit}, that of the exact solutions or None."""
    limits = {"perfect": run(o, "perfect", PERFECT), "elastic": run(o, "elastic", grain_entries(0.1, 0.0))}
    rows = []
    for series in SERIES:
        geometry, limit = limits[series.limit]
        scales = {f: comparison.scale(limit[f]) for f in comparison.FIELDS}
        for k in range(3 if o.quick else STEPS):
            sigma, loss = series.grains(k)
            state = run(o, f"{series.name}{k}", grain_entries(sigma, loss))[1]
            known = None
            if series.exact:
                cells = len(state["rho"])
                known = np.abs(exact(GoldshteinShapiro(1.0, sigma), cells) - exact(PerfectGas(), cells)).mean() / scales["rho"]
            rows.append(SimpleNamespace(series=series, step=k, sigma=sigma, loss=loss, small=loss if series.small == "1 - e^2" else nu(sigma),
                                        apart=comparison.difference(geometry, state, limit, scales), exact=known))
    return rows


def order(before, after, value=lambda r: r.apart["rho"]):
    return float(np.log(value(before) / value(after)) / np.log(before.small / after.small))


def tables(rows):
    lines, good = ["## Limits", ""], True
    for series in SERIES:
        mine = [r for r in rows if r.series is series]
        last = order(*mine[-2:])
        holds = abs(last - series.order) < TOLERANCE
        good &= holds
        lines += [f"{series.title[0].upper() + series.title[1:]}, against the {series.limit} gas: order {last:.3f} in {series.small} at the "
                  f"end, expected {series.order:.3g}: {'yes' if holds else 'NO'}.", ""]
        lines += [measured_by("haff crossCheck --limits"), "", "| sigma | 1 - e^2 | nu | " + " | ".join(comparison.FIELDS) + " | order (rho) |" + (" rho, exact solutions |" if series.exact else ""),
                  "|---" * (8 + series.exact) + "|"]
        for before, r in zip([None, *mine], mine):
            lines.append(f"| {r.sigma:.4g} | {r.loss:.3g} | {nu(r.sigma):.3g} | " + " | ".join(f"{r.apart[f]:.3g}" for f in comparison.FIELDS)
                         + f" | {'' if before is None else f'{order(before, r):.3f}'} |" + (f" {r.exact:.3g} |" if series.exact else ""))
        lines.append("")
    return lines, good


def figure(path, rows):
    from haff.plot import figures
    fig, axes = figures.panels(1, 2, width=7.0, height=2.8)
    for series, colour in zip(SERIES, figures.COLOURS):
        mine = [r for r in rows if r.series is series]
        ax = axes[0][int(series.small != "nu")]
        small = np.array([r.small for r in mine])
        ax.loglog(small, [r.apart["rho"] for r in mine], "o", ms=3, color=colour, label=series.title)
        ax.loglog(small, mine[-1].apart["rho"] * (small / small[-1]) ** series.order, color=colour, lw=0.6)
        figures.label(ax, r"volume fraction $\alpha$" if series.small == "nu" else "$1 - e^2$", r"mean difference of $\rho$")
    for ax in axes[0]:
        ax.legend(fontsize=6)
    fig.savefig(path, dpi=100)


def sweep(o):
    """Runs all; writes limits.md, limits.csv, limits.png into o.out. 0, or 3 where a limit is not met as expected."""
    o.cells = 50 if o.quick else 200
    rows = measure(o)
    lines, good = tables(rows)
    with open(os.path.join(o.out, "limits.md"), "w") as f:
        f.write("\n".join(lines))
    with open(os.path.join(o.out, "limits.csv"), "w", newline="") as f:
        out = csv.writer(f, lineterminator="\n")
        out.writerow(("series", "step", "sigma", "loss", "nu", *comparison.FIELDS, "exact"))
        for r in rows:
            out.writerow((r.series.name, r.step, r.sigma, "%.6g" % r.loss, "%.6g" % nu(r.sigma), *("%.6g" % r.apart[f] for f in comparison.FIELDS),
                          "" if r.exact is None else "%.6g" % r.exact))
    figure(os.path.join(o.out, "limits.png"), rows)
    print("\n".join(lines))
    return 0 if good else 3
