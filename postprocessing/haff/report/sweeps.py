# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a sweep: a table of its runs with small pictures, what was measured over what was varied, and the runs over each other."""
import csv
import os

import numpy as np

from haff.case.case import Case, number
from haff.plot import log, quantity
from haff.plot.quantity import GRAINS, CannotDraw
from haff.plot.scale import common
from haff.plot.wish import Wish, times_with_results
from haff.report import running
from haff.report.charts import chart, overlay
from haff.report.onecase import story_of
from haff.report.page import Page
from haff.report.pictures import LOST, Painter
from haff.report.words import ESCAPE, symbol, table, tag, tiles, with_unit
from haff.runs import copies
from haff.runs.sweep import OURS

TABLE, NOTES = "sweep.csv", "sweep.json"
MOST_CURVES = 8  # in one plot
MOST_PICTURES = 60


def is_sweep(folder):
    return os.path.isfile(os.path.join(folder, TABLE)) and os.path.isfile(os.path.join(folder, NOTES))


class Sweep:
    """The rows of a sweep.csv as dictionaries of texts, and the columns that were varied or measured, in their order."""

    def __init__(self, folder):
        self.folder = folder
        with open(os.path.join(folder, TABLE), newline="", encoding="utf-8") as f:
            self.rows = list(csv.DictReader(f))
        if not self.rows:
            raise CannotDraw(f"{os.path.join(folder, TABLE)} has no runs: run the sweep again, it goes on from where it was")
        self.columns = [name for name in self.rows[0] if name not in OURS]
        chosen = lambda n: all(copies.name_of({n: r[n]}).split("-")[0] in r["folder"] for r in self.rows)
        self.varied = [n for n in self.columns if len({r[n] for r in self.rows}) > 1 and chosen(n)]

    def numbers(self, name):
        """The column [rows]; nan where there is no number."""
        return np.array([number(r[name] or "nan") for r in self.rows])

    def name(self, row):
        return ", ".join(f"{n} {row[n]}" for n in self.varied) or row["folder"]

    def case(self, row):
        """The Case of a run with results; None without."""
        try:
            case = Case(os.path.join(self.folder, row["folder"]))
            return case if times_with_results(case) else None
        except (CannotDraw, OSError):
            return None


class Report:
    """make() reads everything anew."""

    def __init__(self, folder, frames):
        self.folder = folder

    def make(self, every=0.0):
        sweep = Sweep(self.folder)
        cases = [sweep.case(row) for row in sweep.rows]
        source = (copies.read_json(os.path.join(self.folder, NOTES)) or {}).get("case", "")
        page = Page(os.path.basename(os.path.abspath(self.folder)), every=every)
        page.lead = tag("p", ESCAPE(f"A sweep of {os.path.basename(source)}: {len(sweep.rows)} runs"), class_="lead")
        page.add("summary", "Summary", summary(sweep))
        page.add("runs", "Runs", self.table(sweep, cases))
        page.add("measured", "What was measured", page.grid(*(page.chart(c) for c in measured(sweep))))
        page.add("beside", "Runs over each other", page.grid(*(page.chart(c) for c in curves(sweep, cases))))
        return page

    def table(self, sweep, cases):
        shots = pictures(cases)
        heads = [*map(ESCAPE, sweep.columns), "state", "clock", *(["picture"] if any(shots) else [])]
        lines = []
        for row, shot in zip(sweep.rows, shots):
            mark = tag("span", ESCAPE(row["state"]), class_={"done": "good", "failed": "bad"}.get(row["state"], "quiet"))
            why = tag("div", ESCAPE(row["error"].split("\n")[0]), class_="quiet") if row["error"] else ""
            lines.append([*(ESCAPE(shorter(row[n])) for n in sweep.columns), mark + why, ESCAPE(log.duration(number(row["seconds"] or "nan"))),
                          *([small(sweep.name(row), shot)] if any(shots) else [])])
        return table(heads, lines, "Runs of the sweep")


def small(name, shot):
    """A picture that grows when it is clicked at."""
    if not shot:
        return ""
    image = tag("img", src=shot.uri, width=shot.size[0], height=shot.size[1], alt=f"{name}: {shot.about}")
    return tag("button", image, type="button", class_="zoom", aria_label=f"picture of {name}, larger or smaller")


def shorter(word):
    value = number(word)
    return word if np.isnan(value) or len(word) < 9 else f"{value:.6g}"


def summary(sweep):
    states = [row["state"] for row in sweep.rows]
    found = [("runs", len(states), ""), *((s, states.count(s), {"done": "ended", "failed": "stopped"}.get(s, "")) for s in dict.fromkeys(states)),
             ("clock of all", log.duration(float(np.nansum(sweep.numbers("seconds")))), "")]
    return tiles(found)


def pictures(cases):
    """The Shot of each case at its last time: grains, or the first of the main fields in one range of colours; None where there is none."""
    last = [case and times_with_results(case)[-1] for case in cases]
    wishes, values = [], []
    for case, time in zip(cases, last):
        name = None
        try:
            name = case and (GRAINS if quantity.has_grains(case, time) else quantity.main_fields(case, time)[0])
            if name and name != GRAINS:
                values.append(quantity.read(case, name, time).values)
        except LOST:
            name = None
        wishes.append(name)
    shots, span = [], common(values, Wish()) if values else None
    for case, time, name in zip(cases, last, wishes):
        if not name or sum(s is not None for s in shots) >= MOST_PICTURES:
            shots.append(None)
            continue
        film = Painter(case).film(name, [time], None if name == GRAINS else Wish(span=span))
        shots.append(film.shots[-1] if film else None)
    return shots


def measured(sweep):
    """Charts of numbers that are no choice, over each choice that is a number."""
    results = [n for n in sweep.columns if n not in sweep.varied and np.isfinite(sweep.numbers(n)).any()]
    for over in sweep.varied:
        x = sweep.numbers(over)
        if not np.isfinite(x).all():
            continue
        order = np.argsort(x, kind="stable")
        kind = [] if len(sweep.varied) == 1 else ["points"]
        for name in results:
            if not running.constant(sweep.numbers(name)):
                yield chart(f"{name} over {over}", x[order], [(name, sweep.numbers(name)[order], *kind)], across=over, y=name, time=False)


def curves(sweep, cases):
    """Extremes and changes over time of the runs, in one plot each."""
    stories = [(sweep.name(row), case and story_of(case), case) for row, case in zip(sweep.rows, cases)]
    stories = [s for s in stories if s[1]][:MOST_CURVES]
    if not stories:
        return []
    units = stories[0][2].units
    found = []
    for title, column, sign, dimensions in running.COMMON:
        some = [(name, s.rows["Time"], s.change(column) if column in log.DRIFTS else s.column(column)) for name, s, _ in stories]
        found.append(overlay(title, some, across=running.time_axis(units), y=with_unit(symbol(sign), dimensions, units)))
    return [c for c in found if c]
