# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles over the height, of a gas and of grains beside each other: means over rows of cells, and over the cycles of a shaken bed.

    haff columns CASE FILE.csv 0.05 0.1 0.15            at these times
    haff columns CASE FILE.csv 0.3 0.6 0.9 -from 4      at these phases of the shaking, means over all cycles from the fourth on

A profile is {"y", "alpha", "U", "T"}, in SI units, U upwards; of a gas with the pressure as "p" where it was written, of grains with T
along each axis as "Tx", "Ty", "Tz". The columns of the table are those of the profile.
"""
import sys

import numpy as np

from haff import command
from haff.layers import faraday
from haff.plot.wish import named_time, times_with_results

AXES = ("Tx", "Ty", "Tz")
SAME_PHASE = 5e-3  # of the period: as near as faraday takes written phases for one
LEAST = 2e-3  # packing of the cells that differences are taken over


def profile(layer, times):
    p = layer.profile(times)
    parts = p.pop("TComponents", None)
    return p if parts is None else {**p, **dict(zip(AXES, parts.T))}


def at(case, moments, first=None):
    """{moment: profile}; moments are times or, with `first` (a cycle), phases of the shaking."""
    layer = faraday.Layer(case)
    if first is None:
        there = times_with_results(layer.case)
        return {t: profile(layer, named_time(layer.case, f"{t:.12g}", there)) for t in moments}
    try:
        phases = layer.phases(first)
    except ValueError as why:
        raise ValueError(f"{why}: leave out  -from, and give times") from None
    if not phases:
        last = layer.case.time(None)
        raise ValueError(f"{layer.case.path}: no phase of the shaking was written in three cycles or more from cycle {first:g} on; "
                         f"the last time is {last}, in cycle {float(last) * layer.frequency:g}")
    nearest = {p: min(phases, key=lambda k: abs(k - p)) for p in moments}
    for p, there in nearest.items():
        if abs(there - p) > SAME_PHASE:
            raise ValueError(f"{layer.case.path} has no phase {p:g} of the shaking; the nearest is {there:g}, "
                             f"the phases are {' '.join(f'{k:g}' for k in phases)}")
    return {p: profile(layer, phases[there][1]) for p, there in nearest.items()}


def write(path, profiles):
    first = next(iter(profiles.values()))
    names = [name for name in ("y", "alpha", "U", "T", "p", *AXES) if name in first]
    with open(path, "w") as f:
        f.write(",".join(["moment", *names]) + "\n")
        for moment, p in profiles.items():
            for i in range(len(p["y"])):
                f.write(",".join([f"{moment:g}", *(f"{p[name][i]:.5g}" for name in names)]) + "\n")


def read(path):
    rows = np.genfromtxt(path, delimiter=",", names=True)
    return {m: {n: rows[n][rows["moment"] == m] for n in rows.dtype.names[1:]} for m in np.unique(rows["moment"])}


def onto(p, y, by=0.0):
    """The profile in the cells about y, equally far apart, raised by `by`: the mass in each cell is kept."""
    h, to = p["y"][1] - p["y"][0], y[1] - y[0]
    faces = np.append(p["y"] - h / 2, p["y"][-1] + h / 2)
    below = np.append(0, np.cumsum(p["alpha"]) * h)
    alpha = np.diff(np.interp(np.append(y - to / 2, y[-1] + to / 2) - by, faces, below)) / to
    return {"y": y, "alpha": alpha, **{n: np.interp(y - by, p["y"], p[n]) for n in ("U", "T")}}


def energy(p):
    """Of motion, per unit of mass density of the grains' material."""
    return p["alpha"] * (p["U"] ** 2 + 3 * p["T"]) / 2


def centre(p):
    """Of mass."""
    return p["alpha"] @ p["y"] / p["alpha"].sum()


def difference(p, grains, of, by=0.0):
    """Of a profile, raised by `by`, from that of grains: sum |a - b| / sum |b| where grains have more than LEAST. of: a name,
    or a function of a profile."""
    of = of if callable(of) else lambda q, name=of: q[name]
    use = grains["alpha"] > LEAST
    here, there = of(onto(p, grains["y"], by))[use], of(grains)[use]
    return np.abs(here - there).sum() / np.abs(there).sum()


def ratio(p):
    """T along the height over T across it."""
    across = p["Tx"] + p["Tz"]
    return np.where(across > 0, 2 * p["Ty"] / np.where(across > 0, across, 1), np.nan)


def seen(p, values):
    """Values where there is enough of the gas to speak of them; nan elsewhere."""
    return np.where(p["alpha"] > LEAST, values, np.nan)


def draw(path, columns, rows, top):
    """columns: [(title, {label: profile})]; rows: [(label, function of a profile)]; top (m): of the heights shown. The first
    profile is drawn as a line, the others as dots."""
    from haff.plot import figures
    fig, axes = figures.panels(len(rows), len(columns), height=1.7)
    for column, (line, (title, profiles)) in enumerate(zip(axes.T, columns)):
        for ax, (name, of) in zip(line, rows):
            for i, (label, p) in enumerate(profiles.items()):
                ax.plot(1e3 * p["y"], of(p), **({"marker": ".", "markersize": 2.5, "linestyle": "none"} if i else {}), label=label)
            ax.set_xlim(0, 1e3 * top)
            figures.label(ax, "$y$ (mm)" if ax is line[-1] else "", "" if column else name)
        line[0].set_title(title, fontsize=9)
    if all(columns[0][1]):
        axes[0][-1].legend()
    figures.save(fig, path)


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case")
    parser.add_argument("file", help="the table, a .csv")
    parser.add_argument("moments", type=float, nargs="+", help="times, or with -from phases of the shaking, 0 to 1")
    parser.add_argument("-from", dest="first", type=float, metavar="CYCLE", help="the first of the cycles that means are taken over")
    wanted = parser.parse_args()
    write(wanted.file, at(wanted.case, wanted.moments, wanted.first))


if __name__ == "__main__":
    sys.exit(main())
