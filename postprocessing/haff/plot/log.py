# SPDX-License-Identifier: GPL-3.0-or-later
"""How a run goes or went: time steps and what limits them, extremes, drift, speed, time left.

    haffLog CASE                  a summary and small plots in the terminal
    haffLog CASE -follow          the same, renewed while the run goes on; ends with the run
    haffLog CASE -o run.png       a picture; png, pdf or svg

It reads postProcessing/run/START/run.dat, else the text that granularGas, granularMD or granularSegregation printed into
CASE/log.granular*, or the file that -log names. Nothing is written without -o. Exit code: 2 for a wrong command line, 1 for a case that no
run has left a trace in.
"""
import collections
import os
import shutil
import sys
import time

import numpy as np

from haff import command
from haff.plot import figures, options, runlog

EXTREMES = (("alphaMin", "alphaMax"), ("phiMin", "phiMax"), ("TMin", "TMax"), ("T", None), ("magUMax", None), ("MaMax", None))
MOMENTA = ("momentum_x", "momentum_y", "momentum_z")
DRIFTS = ("massChange", "energyChange", "smallChange")
TEXTS = {"alphaMin": r"$\alpha$", "phiMin": r"$\phi$", "TMin": "$T$", "T": "$T$", "magUMax": "largest $|U|$", "MaMax": "largest Mach number",
         "massChange": "mass", "energyChange": "energy", "smallChange": "small grains"}
PLAIN = {"alphaMin": "alpha", "phiMin": "phi", "TMin": "T", "T": "T", "magUMax": "|U| max", "MaMax": "Ma max", "massChange": "mass",
         "energyChange": "energy", "smallChange": "small"}
BARS = " ▁▂▃▄▅▆▇█"


def duration(seconds):
    """Seconds as people say them."""
    if not np.isfinite(seconds):
        return "?"
    n = int(round(seconds))
    if n < 120:
        return f"{seconds:.3g} s"
    return f"{n // 60} min {n % 60:02d} s" if n < 7200 else f"{n // 3600} h {n % 3600 // 60:02d} min"


def there(story, name):
    return np.isfinite(story.column(name)).any()


# ---- the terminal ----

def summary(story, width=80):
    """Lines of text: how far, how fast, what limits, extremes and drift, and a small plot of each."""
    running = story.running()
    state = "ended" if story.ended else "running" if running else "stopped"
    share = story.last / story.end_time if story.end_time > 0 else np.nan
    spent = sum(np.nanmax(story.column("clockTime")[story.parts == p], initial=0) for p in np.unique(story.parts))
    per_step, speed = story.pace()
    lines = [f"{story.case}: {state} at time {story.last:g} of {story.end_time:g} ({100 * share:.0f} %), step {int(story.rows['step'][-1])}, "
             f"wall {duration(spent)}"]
    if np.isfinite(per_step).any():
        left = story.eta()[-1]
        lines.append(f"  speed   {last(per_step):.3g} s/step, time {last(speed):.3g} per second"
                     + (f", about {duration(left)} left" if running and not story.ended and np.isfinite(left) else ""))
    if np.isfinite(story.computed):
        lines.append(f"  cells   {100 * story.computed:.3g} % of the updates were computed, the rest was uniform")
    lines.append("  limits  of the steps in the log: " + ", ".join(f"{name} {100 * count / len(story.limiters):.0f} %" for name, count in limits_of(story)))
    lines += plots(story, width)
    return [line[:width] for line in lines]


def last(values):
    values = values[np.isfinite(values)]
    return float(values[-1]) if len(values) else np.nan


def limits_of(story, most=4):
    return collections.Counter(name for name in story.limiters).most_common(most)


def plots(story, width):
    """One line for each quantity: its name, a plot of characters over time, and its last value."""
    rows = [("dt", story.rows["dt"], True)]
    for low, high in EXTREMES:
        if there(story, low):
            rows.append((PLAIN[low] + (" max" if high else ""), story.column(high or low), False))
            if high and high == "alphaMax":
                rows.append((PLAIN[low] + " min", story.column(low), True))
    rows += [("|" + PLAIN[name] + " change|", np.abs(story.column(name)), True) for name in DRIFTS if there(story, name)]
    rows.append(("s/step", story.pace()[0], True))
    rows = [(name, values, log) for name, values, log in rows if np.isfinite(values).any()]
    span = max(10, width - 60)
    found = []
    for name, values, log in rows:
        drawn, low, high = sparkline(story.rows["Time"], values, span, log)
        found.append(f"  {name:18} {drawn} {last(values):9.3g}  [{low:.3g}, {high:.3g}]")
    return found


def sparkline(t, values, width, log=False):
    """A plot of characters over time, and the least and the largest value. log: by powers of ten if all values are positive."""
    some = np.isfinite(values)
    t, values = t[some], values[some]
    low, high = float(values.min()), float(values.max())
    if log and low <= 0 < high:
        floor = values[values > 0].min()
        values = np.maximum(values, floor)
    shown = np.log10(values) if log and high > 0 else values
    bottom, top = float(shown.min()), float(shown.max())
    place = np.zeros(len(t), int) if t[-1] == t[0] else np.minimum(((t - t[0]) / (t[-1] - t[0]) * width).astype(int), width - 1)
    total, count = np.bincount(place, shown, width), np.bincount(place, minlength=width)
    text, level = [], 0
    for s, n in zip(total, count):
        if n:
            level = 1 + int(round(7 * (s / n - bottom) / (top - bottom))) if top > bottom else 4
        text.append(BARS[level])
    return "".join(text), low, high


def follow(case, log, seconds, out=None):
    """Prints the summary again and again until the run has ended; returns the last Story."""
    out = out or sys.stdout
    lines = 0
    while True:
        story = runlog.read(case, log)
        over = story.ended or not story.running()
        if over and not story.ended:  # the last rows may have come between the reading and the question
            story = runlog.read(case, log)
        text = summary(story, shutil.get_terminal_size((100, 24)).columns)
        if out.isatty() and lines:
            out.write(f"\x1b[{lines}A\x1b[J")
        if out.isatty() or over or not lines:
            out.write("\n".join(text) + "\n")
        else:
            out.write(text[0] + "\n")
        out.flush()
        lines = len(text)
        if over:
            return story
        time.sleep(seconds)


# ---- the picture ----

def picture(story):
    """A figure: dt by what limits it, extremes, drift, speed, time left."""
    units = figures.units(story.case)
    extremes = [pair for pair in EXTREMES if there(story, pair[0])]
    parts = [lambda ax: steps(ax, story, units)] + [lambda ax, pair=pair: extreme(ax, story, pair, units) for pair in extremes]
    for draw, wanted in ((drift, any(there(story, n) for n in DRIFTS)), (momentum, any(there(story, n) for n in MOMENTA)), (pace, True),
                         (share, len(np.unique(story.column("computed"))) > 1), (left, np.isfinite(story.eta()).any())):
        if wanted:
            parts.append(lambda ax, draw=draw: draw(ax, story))
    columns = 3 if len(parts) > 6 else 2
    figure, axes = figures.panels(-(-len(parts) // columns), columns, width=3.4 * columns, height=2.1)
    for draw, ax in zip(parts, axes.flat):
        draw(ax)
    for ax in axes.flat[len(parts):]:
        ax.set_axis_off()
    for ax in axes.flat[:len(parts)]:
        ax.set_xlabel(figures.axis("t", units))
        ends = (float(story.rows["Time"][0]), story.last)
        ax.set_xlim(*(ends if ends[1] > ends[0] else (ends[0] - 0.5, ends[0] + 0.5)))
    figure.suptitle(os.path.basename(os.path.abspath(story.case)) + summary(story, 10000)[0][len(story.case):], fontsize=8)
    return figure


def log_if_wide(ax, values):
    values = values[np.isfinite(values)]
    if len(values) and values.min() > 0 and values.max() > 20 * values.min():
        ax.set_yscale("log")


def steps(ax, story, units):
    t, dt = story.rows["Time"], story.rows["dt"]
    ax.plot(t, dt, color="0.75", linewidth=0.6, zorder=1)
    names = [n for n, _ in limits_of(story, 6)]
    for k, name in enumerate(names):
        here = np.array([n == name for n in story.limiters])
        ax.plot(t[here], dt[here], ".", markersize=3.5, color=figures.COLOURS[k % len(figures.COLOURS)], label=name)
    log_if_wide(ax, dt)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high * (high / low) ** (0.12 * len(names)) if ax.get_yscale() == "log" else high + 0.14 * len(names) * (high - low))
    ax.legend(loc="upper right", fontsize=6.5, handletextpad=0.2, title="limited by", title_fontsize=6.5)
    ax.set_ylabel(figures.with_unit(r"$\Delta t$", (0, 0, 1), units))


def extreme(ax, story, pair, units):
    low, high = pair
    t, text = story.rows["Time"], TEXTS[low]
    if high:
        ax.plot(t, story.column(high), label="largest")
        ax.plot(t, story.column(low), color=figures.COLOURS[5], label="least")
        ax.legend(loc="best", fontsize=6.5)
    else:
        ax.plot(t, story.column(low))
    log_if_wide(ax, np.concatenate([story.column(n) for n in pair if n]))
    ax.set_ylabel(figures.with_unit(text, {"T": (0, 2, -2), "m": (0, 1, -1)}.get(low[0], (0, 0, 0)), units))


def drift(ax, story):
    smallest = np.inf
    for name in DRIFTS:
        if there(story, name):
            size = np.abs(story.column(name))
            smallest = min(smallest, *(size[size > 0] if (size > 0).any() else [1e-16]))
            ax.plot(story.rows["Time"], np.where(size > 0, size, np.nan), marker=".", markersize=2.5, label=TEXTS[name])
    if np.isfinite(smallest):
        ax.set_yscale("log")
        low, high = ax.get_ylim()
        ax.set_ylim(min(low, smallest / 5), max(high, 20 * smallest))
    ax.set_ylabel("change since the start")
    ax.legend(loc="best", fontsize=6.5)


def momentum(ax, story):
    for name, text in zip(MOMENTA, "xyz"):
        if there(story, name) and np.nanmax(np.abs(story.column(name))) > 0:
            ax.plot(story.rows["Time"], story.column(name), label=f"${text}$")
    ax.set_ylabel("momentum")
    if ax.lines:
        ax.legend(loc="best", fontsize=6.5)


def share(ax, story):
    """The part of the cell updates that was computed, from the start of the run."""
    ax.plot(story.rows["Time"], 100 * story.column("computed"))
    ax.set_ylabel("cells computed so far (%)")
    ax.set_ylim(0, 105)


def pace(ax, story):
    per_step, speed = story.pace()
    t = story.rows["Time"]
    ax.plot(t, per_step, marker=".", markersize=2.5)
    ax.set_ylabel("seconds per step", color=figures.COLOURS[0])
    log_if_wide(ax, per_step)
    other = ax.twinx()
    other.plot(t, speed, color=figures.COLOURS[1], marker=".", markersize=2.5)
    other.set_ylabel("time per second", color=figures.COLOURS[1])
    other.tick_params(direction="in")
    log_if_wide(other, speed)


def left(ax, story):
    values = story.eta()
    ax.plot(story.rows["Time"], values, marker=".", markersize=2.5)
    ax.set_ylabel("time left (s of the clock)")
    ax.set_ylim(0, None)


def main():
    parser = options.parser(__doc__)
    parser.add_argument("case", metavar="CASE")
    parser.add_argument("-follow", action="store_true", help="renew it while the run goes on")
    parser.add_argument("-every", type=float, default=2.0, metavar="SECONDS", help="between two looks of -follow: 2")
    parser.add_argument("-log", metavar="FILE", help="the log to read instead of the table")
    parser.add_argument("-o", metavar="FILE", help="a picture is written; .png, .pdf or .svg")
    o = parser.parse_args()
    if o.o and not o.o.lower().endswith(tuple("." + f for f in figures.FORMATS)):
        parser.error(f"-o {o.o}: pictures are .png, .pdf or .svg")
    if not 0.05 <= o.every <= 86400:
        parser.error(f"-every {o.every:g}: 0.05 to 86400 seconds")
    return command.ended("haffLog", lambda: work(o))


def work(o):
    if o.follow:
        story = follow(o.case, o.log, o.every)
    else:
        story = runlog.read(o.case, o.log)
        print("\n".join(summary(story, shutil.get_terminal_size((100, 24)).columns)))
    if o.o:
        figures.save(picture(story), o.o)


if __name__ == "__main__":
    sys.exit(main())
