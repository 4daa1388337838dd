# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case with every combination of values of some entries, several at once, and makes a table of what came out.

    table = haff.sweep("cases/blast", {"constant/granularProperties": {"grain/restitution": [0.8, 0.9]}}, mesh={"N": [100, 200]},
                       cores=2, folder="blasts", measure=lambda case: {"densest": case.field("alpha").max()})

The folder holds a copy of the case for each run (haff.run), sweep.json, which says of which case, and the table, sweep.csv.
"""
import concurrent.futures
import csv
import fcntl
import itertools
import os
import re
import sys
import time

import numpy as np

from haff.case import entries
from haff.case.case import Case
from haff.case.foam import times_in
from haff.case.tables import frame
from haff.runs import copies
from haff.runs.run import Children, RunError, Stopped, application, carry_out

KEPT = 2  # exit code of a run that left the admissible states: it would do so again
OURS = "state", "seconds", "folder", "error"  # columns of every table


class Point:
    """One run of a sweep. changes, mesh: as for haff.run; values: {column: value}; state: waiting, done or failed."""

    def __init__(self, folder, choices):
        self.changes, self.mesh, self.values = {}, {}, {c.column: value for c, value in choices}
        for c, value in choices:
            (self.mesh if c.file is None else self.changes.setdefault(c.file, {}))[c.entry] = value
        self.folder = os.path.join(folder, copies.name_of(self.values) if choices else "run")
        self.state, self.error, self.measured = "waiting", "", {}

    @property
    def seconds(self):
        return (copies.notes(self.folder) or {"seconds": 0.0})["seconds"]

    def carry_out(self, case, base, ranks, children):
        """RunError; Stopped; OSError; ValueError: the folder holds something else, or the case is not what it was (base)."""
        if children.stopped:
            raise Stopped
        copies.make(case, self.folder, self.changes, self.mesh, base)
        failed = copies.notes(self.folder).get("failed")
        if failed:
            raise RunError(*failed)
        try:
            carry_out(self.folder, self.mesh, ranks, children)
        except RunError as error:
            if error.code == KEPT:
                copies.keep(self.folder, failed=list(error.args))
            raise

    def fraction(self):
        """How much of the run is done, from the last time that it has written or logged."""
        if self.state != "waiting":
            return 1.0
        found = copies.notes(self.folder)
        if not found:
            return 0.0
        if found["state"] == "done":
            return 1.0
        end, reached = copies.number(copies.control(self.folder, "endTime")), self.reached()
        return min(max(reached / end, 0.0), 1.0) if end else 0.0

    def reached(self):
        last = max(map(float, times_in(self.folder)), default=0.0)
        log = os.path.join(self.folder, f"log.{copies.control(self.folder, 'application')}")
        if os.path.exists(log):
            with open(log, "rb") as f:
                f.seek(max(0, os.path.getsize(log) - 8192))
                logged = re.findall(rb"^Time = (\S+)", f.read(), re.M)
            last = max([last] + [copies.number(t, 0.0) for t in logged[-1:]])
        return last


class Choice:
    """The values of one entry. file: None for a number of mesh.geo."""

    def __init__(self, file, entry, values):
        self.file, self.entry = file, entry
        listed = isinstance(values, (list, range)) or (isinstance(values, np.ndarray) and values.ndim > 0)
        self.values = list(values) if listed else [values]
        self.column = entries.names(entry)[-1].lstrip("+")
        if not self.values:
            raise ValueError(f"{file or 'mesh'}: {entry} has no values")
        if len({copies.label(v) for v in self.values}) < len(self.values):
            raise ValueError(f"{file or 'mesh'}: a value of {entry} is given twice: {self.values}")


def choices_of(grid, mesh):
    """The choices of a sweep, with columns of different names: restitution, or constant/granularProperties:grain/restitution."""
    found = []
    for file, wanted in (grid or {}).items():
        for entry, values in flat(wanted):
            found.append(Choice(file, entry, values))
    found += [Choice(None, name, values) for name, values in (mesh or {}).items()]
    columns = [c.column for c in found]
    for c in found:
        if columns.count(c.column) > 1 or c.column in OURS:
            c.column = f"{c.file or 'mesh'}:{entries.shown(entries.names(c.entry))}"
    return found


def flat(wanted, above=""):
    """(path, values) of nested dictionaries of entries."""
    for key, values in wanted.items():
        path = above + (key if isinstance(key, str) else "/".join(key))
        if isinstance(values, dict) and values:
            yield from flat(values, path + "/")
        else:
            yield path, values


def points_of(folder, choices):
    return [Point(folder, list(zip(choices, values))) for values in itertools.product(*[c.values for c in choices])]


def check(case, points):
    """Finds wrong files, entries and numbers before anything runs: EntryError, FileNotFoundError, ValueError."""
    application(case)
    for point in points:
        copies.check_mesh(case, point.mesh)
        copies.edited(case, point.changes)


def take(case, folder):
    """Makes the folder of a sweep, or takes the one that stands there; returns its lock, a file. copies.ChangedCase."""
    os.makedirs(folder, exist_ok=True)
    notes = os.path.join(folder, "sweep.json")
    if not os.path.exists(notes) and set(os.listdir(folder)) - {".lock", "sweep.json.tmp"}:
        raise copies.ChangedCase(f"{folder} is there and is no folder of a sweep (it has no sweep.json): name another folder")
    lock = open(os.path.join(folder, ".lock"), "w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        lock.close()
        raise copies.ChangedCase(f"another sweep is at work in {folder}: wait for its end, or stop it") from None
    found = copies.read_json(notes)
    why = found and copies.difference(case, found["base"], found["case"])
    if why:
        lock.close()
        raise copies.ChangedCase(f"{folder} holds a sweep of {found['case']} as it was: {why}; name another folder, or remove that one")
    if not found:
        copies.write_json(notes, {"case": case, "base": copies.digests(case)})
    return lock


def column(values):
    """Values as an array: numbers where all are numbers (missing: nan), else texts (missing: empty)."""
    there = [v for v in values if v is not None]
    if there and all(isinstance(v, (int, np.integer)) and not isinstance(v, bool) for v in values):
        return np.array(values, int)
    if all(isinstance(v, (int, float, np.number, np.bool_)) for v in there):
        return np.array([np.nan if v is None else float(v) for v in values])
    return np.array(["" if v is None else v if isinstance(v, str) else entries.as_text(v) for v in values])


def columns_of(points):
    """{name: array [points]}: values, what was measured, state, seconds, folder, error."""
    names = list(dict.fromkeys(name for p in points for name in p.measured))
    found = {name: column([p.values[name] for p in points]) for name in points[0].values}
    found.update((name, column([p.measured.get(name) for p in points])) for name in names)
    return {**found, "state": column([p.state for p in points]), "seconds": column([round(p.seconds, 2) for p in points]),
            "folder": column([os.path.basename(p.folder) for p in points]), "error": column([p.error for p in points])}


def write(path, columns):
    """The table as comma-separated values, whole or not at all. Numbers have all their digits."""
    with open(path + ".tmp", "w", newline="") as f:
        rows = csv.writer(f, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows(zip(*[a.tolist() for a in columns.values()]))
    os.replace(path + ".tmp", path)


class Progress:
    """A line on stderr: how many runs are done, and when all will be, from the pace of this call; all runs count alike."""

    def __init__(self, points, wanted):
        self.points, self.wanted, self.begin, self.shown = points, wanted, time.time(), ""
        self.was = sum(p.fraction() for p in points)

    def line(self):
        gone = [p.fraction() for p in self.points]
        here, spent = sum(gone) - self.was, time.time() - self.begin
        failed = sum(p.state == "failed" for p in self.points)
        left = f", about {duration(spent * (len(gone) - sum(gone)) / here)} left" if here > 0 and sum(gone) < len(gone) else ""
        at = ", ".join(f"{os.path.basename(p.folder)} at {f:.0%}" for p, f in zip(self.points, gone) if 0 < f < 1)
        ended = sum(p.state != "waiting" for p in self.points)
        return f"{ended} of {len(gone)} runs have ended" + (f", {failed} of them failed" if failed else "") + left + (f"; {at}" if at else "")

    def show(self, last=False):
        if not self.wanted:
            return
        text = self.line()
        if sys.stderr.isatty():
            sys.stderr.write("\r" + text[:150].ljust(150) + ("\n" if last else ""))
        elif text != self.shown:
            sys.stderr.write(text + "\n")
        sys.stderr.flush()
        self.shown = text


def duration(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


class Sweep:
    """The runs of a call and the table of them."""

    def __init__(self, case, folder, points, ranks, measure):
        self.case, self.folder, self.points, self.ranks, self.measure = case, folder, points, ranks, measure
        self.children = Children()

    def save(self):
        write(os.path.join(self.folder, "sweep.csv"), columns_of(self.points))

    def close(self, point, job):
        """Takes note of a run that has ended: measures it, or keeps its error."""
        try:
            job.result()
            point.measured = self.measured(point)
            point.state = "done"
        except (Stopped, concurrent.futures.CancelledError):
            return
        except RunError as error:
            point.state, point.error = "failed", error.message
        except Exception as error:  # of the user's measure, too: the other runs go on
            point.state, point.error = "failed", f"{type(error).__name__}: {error}"
        self.save()

    def measured(self, point):
        found = dict((self.measure(Case(point.folder)) if self.measure else None) or {})
        for name in found:
            if name in point.values or name in OURS:
                raise ValueError(f"measure gives a column '{name}', which the table of the sweep has already: name it otherwise")
        return found

    def carry_out(self, slots, progress):
        """All runs, `slots` at once. KeyboardInterrupt, when all have written their states."""
        interrupt, base = None, copies.read_json(os.path.join(self.folder, "sweep.json"))["base"]
        with concurrent.futures.ThreadPoolExecutor(slots) as pool:
            pending = {}
            try:
                pending.update((pool.submit(p.carry_out, self.case, base, self.ranks, self.children), p) for p in self.points)
            except KeyboardInterrupt as caught:
                interrupt = caught
                self.children.stop()
            while pending:
                try:
                    ready, _ = concurrent.futures.wait(pending, 1.0, concurrent.futures.FIRST_COMPLETED)
                    for job in ready:
                        self.close(pending[job], job)
                        del pending[job]
                    progress.show()
                except KeyboardInterrupt as caught:
                    interrupt = caught
                    self.children.stop()
        if interrupt:
            raise interrupt


def sweep(case, grid=None, *, cores=2, folder=None, measure=None, mesh=None, ranks=1, progress=True):
    """Runs a case with every combination of values and returns the table.

    case:    its folder, or a haff.Case; it is not changed.
    grid:    {file: {entry: [values]}}, as for haff.run, with a list, range or array of values; a value that is no list is set in all
             runs (a vector is a tuple).
    mesh:    {name: [numbers]} for the DefineConstant of mesh.geo.
    cores:   runs that go on at once, times ranks.
    folder:  of the sweep (default: beside the case, its name and -sweep); each run has a folder there, named after its values.
    measure: function(haff.Case) -> {column: number or text}, called for every finished run, in the calling thread.
    progress: a line about it on stderr.

    Returns a pandas.DataFrame, or a numpy structured array where there is no pandas, with a row for each combination, the last
    choice fastest. Columns: the values; what was measured; state (done, failed); seconds (of the clock, of all calls); folder; error
    (text of a failed run). The same stands in sweep.csv, with the state `waiting` for runs that have not ended.

    The same call on a folder goes on with what is there: finished runs are only measured, runs that were stopped or killed go on from
    their last time; values may be added. Runs that have left the admissible states are not tried again (remove their folder to
    do so), other failed ones are.

    copies.ChangedCase (a ValueError): the folder holds a sweep of another case, or the case has changed.
    EntryError, FileNotFoundError, ValueError: a file, entry or number that is not there; nothing was run.
    KeyboardInterrupt: Ctrl-C; the runs have written their states. Twice: they were ended at once.
    """
    case = copies.path_of(case)
    if min(cores, ranks) < 1:
        raise ValueError(f"cores: {cores}, ranks: {ranks}; needed: numbers from 1 on")
    folder = os.path.abspath(folder if folder is not None else f"{case}-sweep")
    if (folder + os.sep).startswith(case + os.sep) and os.path.relpath(folder, case) != "ensemble":  # which no copy takes along
        raise ValueError(f"{folder} lies in the case: name a folder outside")
    points = points_of(folder, choices_of(grid, mesh))
    check(case, points)
    with take(case, folder):
        work = Sweep(case, folder, points, ranks, measure)
        work.save()
        line = Progress(points, progress)
        try:
            work.carry_out(max(1, cores // ranks), line)
        finally:
            work.save()
            line.show(last=True)
        return frame(columns_of(points))
