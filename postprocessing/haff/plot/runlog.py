# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run has told of itself: postProcessing/run/START/run.dat, or where there is no such table the text of log.granular*.

    story = runlog.read("cases/sod")
    story.rows["Time"], story.rows["dt"], ...        arrays [n], nan where a row does not say; story.limiters [n]
    story.end_time, story.running(), story.ended

Columns: Time step dt Courant clockTime and, as far as the solver has them, alphaMin alphaMax TMin TMax magUMax MaMax phiMin phiMax T mass
massChange energy energyChange smallChange momentum_x.. computed (a part of 1) collisions.
"""
import dataclasses
import fcntl
import glob
import os
import re
import struct

import numpy as np

from haff.case.foam import times_in
from haff.plot.quantity import CannotDraw

NUMBER = r"[-+]?(?:\d[\d.]*(?:[eE][-+]?\d+)?|nan|inf)"
STEP = re.compile(rf"Time = ({NUMBER})  step (\d+)  deltaT = ({NUMBER}) \(limited by: ([^),]*).*\)(?:\s+Courant ({NUMBER}))?\s*$")
PATTERNS = (  # what a line of the log tells
    (rf"\balpha ({NUMBER}) \.\. ({NUMBER})", ("alphaMin", "alphaMax")),
    (rf"\bT ({NUMBER}) \.\. ({NUMBER})", ("TMin", "TMax")),
    (rf"\bMa ({NUMBER}) \.\. ({NUMBER})", ("MaMin", "MaMax")),
    (rf"\bU ({NUMBER}) \.\. ({NUMBER})", ("magUMin", "magUMax")),
    (rf"\bphi ({NUMBER}) \.\. ({NUMBER})", ("phiMin", "phiMax")),
    (rf"^    T ({NUMBER})  collisions ({NUMBER})", ("T", "collisions")),
    (rf"\bmass ({NUMBER}) \((?:change|drift) ({NUMBER})\)", ("mass", "massChange")),
    (rf"\benergy ({NUMBER}) \((?:change|drift) ({NUMBER})\)", ("energy", "energyChange")),
    (rf"\(balance ({NUMBER})\)", ("energyChange",)),
    (rf"\bsmall grains ({NUMBER}) \((?:change|drift) ({NUMBER})\)", ("small", "smallChange")),
    (rf"\bmomentum \(({NUMBER})", ("momentum_x",)),
    (rf"\bmomentum \({NUMBER} ({NUMBER})", ("momentum_y",)),
    (rf"\bmomentum \({NUMBER} {NUMBER} ({NUMBER})", ("momentum_z",)),
    (rf"\bmomentum x ({NUMBER})", ("momentum_x",)),
    (rf"\bmomentum y ({NUMBER})", ("momentum_y",)),
    (rf"\bmomentum z ({NUMBER})", ("momentum_z",)),
    (rf"^    wall ({NUMBER}) s", ("clockTime",)),
)
PATTERNS = tuple((re.compile(p), names) for p, names in PATTERNS)
END = re.compile(rf"^end at time ({NUMBER}): (\d+) steps in ({NUMBER}) s", re.M)
COMPUTED = re.compile(rf"^({NUMBER}) % of the cell updates were computed", re.M)
SPENT = ("clockTime", "cpuTime")


@dataclasses.dataclass
class Story:
    """rows {column: [n]}, limiters [n], source: the file they are from; parts [n]: number of the start that a row belongs to."""
    case: str
    source: str
    rows: dict
    limiters: list
    parts: np.ndarray
    end_time: float = np.nan
    ended: bool = False
    computed: float = np.nan

    def running(self):
        return locked(self.case)

    @property
    def last(self):
        return float(self.rows["Time"][-1])

    def column(self, name):
        return self.rows.get(name, np.full(len(self.limiters), np.nan))

    def latest(self, name):
        """The last number of a column that is one; nan without."""
        values = self.column(name)
        values = values[np.isfinite(values)]
        return float(values[-1]) if len(values) else np.nan

    def change(self, name):
        """massChange, energyChange, smallChange over the start [n]; inf where that is 0. The log's are over the larger of start and now.

        The energyChange of grains, which have no total beside it, is the balance of their energy, and stays."""
        share = self.column(name)
        if name.removesuffix("Change") not in self.rows:
            return share
        with np.errstate(divide="ignore"):
            return np.where(share > 0, share / (1 - share), share)

    def pace(self):
        """Seconds of the clock per step and time of the case per second, over each row of the same start: two arrays [n], nan first."""
        clock, t, step = self.column("clockTime"), self.rows["Time"], self.rows["step"]
        same = np.concatenate(([False], self.parts[1:] == self.parts[:-1]))
        before = lambda a: np.concatenate(([np.nan], np.diff(a)))
        with np.errstate(divide="ignore", invalid="ignore"):
            spent = np.where(same & (before(clock) > 0), before(clock), np.nan)
            return spent / before(step), before(t) / spent

    def eta(self):
        """Seconds to the end at each row [n], by the pace of the last fifth of the time that was spent by then."""
        clock, t = self.column("clockTime"), self.rows["Time"]
        found = np.full(len(t), np.nan)
        for part in np.unique(self.parts):
            rows = np.flatnonzero(self.parts == part)
            c, x = clock[rows], t[rows]
            if not np.isfinite(c).all():
                continue
            since = np.minimum(np.searchsorted(c, 0.8 * c), np.maximum(np.arange(len(c)) - 1, 0))
            gone, done = c - c[since], x - x[since]
            some = (gone > 0) & (done > 0)
            found[rows[some]] = np.maximum(self.end_time - x[some], 0) * gone[some] / done[some]
        return found


def locked(case):
    """Does a run hold the lock of the case? The lock is tested, not taken."""
    try:
        with open(os.path.join(case, ".haff.lock"), "rb") as f:
            asked = struct.pack("hhqqi4x", fcntl.F_RDLCK, 0, 0, 0, 0)
            kind = struct.unpack("hhqqi4x", fcntl.fcntl(f, fcntl.F_GETLK, asked))[0]
            return kind != fcntl.F_UNLCK
    except OSError:
        return False


def read(case, log=None):
    """The Story of a case: of its table unless a log is named; CannotDraw where no run has left a trace."""
    if not os.path.isdir(os.path.join(case, "system")):
        raise CannotDraw(f"{case} is no case directory (it has no folder 'system')")
    path = log or newest_log(case)
    if log and not os.path.isfile(log):
        raise CannotDraw(f"{log} is not there")
    story = None if log else read_tables(case)
    text = read_text(path) if path else ""
    if story is None and path:
        story = read_log(case, path, text)
    if story is None or not len(story.limiters):
        raise CannotDraw(f"{case} has neither postProcessing/run/*/run.dat nor a log with steps: run it, and keep the log:  "
                         f"granularGas -case {case} | tee {os.path.join(case, 'log.granularGas')}")
    told = re.findall(rf"^    from time \S+ \(step \d+\) to ({NUMBER})", text, re.M)
    story.end_time = float(told[-1]) if told else end_of_control(case)
    end = END.search(text)
    share = COMPUTED.findall(text)
    story.computed = float(share[-1]) / 100 if share else story.latest("computed")
    story.ended = bool(end) or story.last >= story.end_time * (1 - 1e-9)
    return story


def read_text(path):
    with open(path, errors="replace") as f:
        return f.read()


def newest_log(case):
    found = sorted(glob.glob(os.path.join(glob.escape(case), "log.granular*")), key=os.path.getmtime)
    return found[-1] if found else None


def end_of_control(case):
    try:
        found = re.search(rf"(?:^|[;}}]|\*/)\s*endTime\s+({NUMBER})\s*;", read_text(os.path.join(case, "system", "controlDict")), re.M)
    except OSError:
        found = None
    return float(found.group(1)) if found else np.nan


# ---- the table ----

def read_tables(case):
    """The tables of all starts behind one another: where a later start repeats times, its rows stand. None without tables."""
    folder = os.path.join(case, "postProcessing", "run")
    paths = [os.path.join(folder, n, "run.dat") for n in times_in(folder)]
    kept = []
    for part, path in enumerate(p for p in paths if os.path.isfile(p)):
        rows = read_table(path)
        if rows:
            first = float(rows[0]["Time"])
            started = float(rows[0]["dt"]) == 0  # the row of the start: the step that led there is in an earlier table
            kept = [(k, r) for k, r in kept if float(r["Time"]) < first or (started and float(r["Time"]) == first)]
            kept += [(part, r) for r in rows if float(r["dt"]) > 0 or len(rows) == 1]
    if not kept:
        return None
    names = [n for n in kept[-1][1] if n != "limiter"]
    rows = {n: np.array([number(r.get(n, "nan")) for _, r in kept]) for n in names}
    limiters = [r["limiter"].replace("_", " ") for _, r in kept]
    return Story(case, folder, rows, limiters, np.array([k for k, _ in kept]))


def read_table(path):
    """Rows {column: word}; the last line counts only if it is whole."""
    lines = read_text(path).split("\n")[:-1]
    names = lines[0].lstrip("# ").split("\t") if lines and lines[0].startswith("#") else []
    rows = [dict(zip(names, line.split("\t"))) for line in lines[1:] if line.count("\t") == len(names) - 1]
    return rows if "Time" in names and "limiter" in names else []


def number(word):
    try:
        return float(word)
    except ValueError:
        return np.nan


# ---- the text ----

def read_log(case, path, text):
    """The entries of a log; several runs may stand behind one another."""
    rows, limiters, parts, part = [], [], [], 0
    for line in text.split("\n"):
        step = STEP.match(line)
        if step:
            rows.append({"Time": step.group(1), "step": step.group(2), "dt": step.group(3), "Courant": step.group(5) or "nan"})
            limiters.append(step.group(4))
            parts.append(part)
        elif line.startswith("haff "):
            part += 1
        elif rows and line.startswith("    "):
            for pattern, names in PATTERNS:
                found = pattern.search(line)
                if found:
                    rows[-1].update(zip(names, found.groups()))
    if not rows:
        return None
    names = list(dict.fromkeys(n for r in rows for n in r))
    return Story(case, path, {n: np.array([number(r.get(n, "nan")) for r in rows]) for n in names}, limiters, np.array(parts))
