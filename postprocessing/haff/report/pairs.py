# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of two cases beside each other, as a gas and grains: pictures in the same colours, differences, profiles and runs in one plot."""
import dataclasses

import numpy as np

from haff.plot import log, quantity
from haff.plot.quantity import GRAINS
from haff.plot.scale import common
from haff.plot.wish import Wish, times_with_results
from haff.report import facts, profiles, running
from haff.report.charts import joined, numbers, overlay
from haff.report.onecase import FRAMES, spent, story_of
from haff.report.page import Page
from haff.report.pictures import Painter, some_of
from haff.report.words import ESCAPE, symbol, table, tag, with_unit
from haff.runs import compare


COLUMNS = "L1", "L2", "max", "scale", "relative", "covered"  # of haff.compare


class Report:
    """make() reads everything anew."""

    def __init__(self, one, other, frames):
        self.cases, self.frames = (one, other), frames

    def make(self, every=0.0):
        """The Page. CannotDraw: one has no times; ValueError: they share no time."""
        for case in self.cases:
            times_with_results(case)
        self.names = compare.labels(*(case.path for case in self.cases))
        self.painters = [Painter(case) for case in self.cases]
        pairs = compare.common_times(*self.cases)
        self.pairs = [pairs[int(k)] for k in some_of([str(k) for k in range(len(pairs))], self.frames or FRAMES)]
        page = Page(" and ".join(self.names), unit=self.cases[0].units["time"], every=every)
        page.times = [a for a, _ in self.pairs]
        page.add("summary", "Summary", self.summary())
        page.add("fields", "Fields", self.fields(page))
        page.add("differences", "Differences", self.differences(page))
        page.add("profiles", "Profiles", page.grid(*(page.chart(c) for c in self.profiles())))
        page.add("run", "The runs", page.grid(*(page.chart(c) for c in self.runs())))
        return page

    def summary(self):
        """A table of what both are; where they differ first."""
        told = []
        for case in self.cases:
            last = times_with_results(case)[-1]
            found, story = facts.Facts(case, last), story_of(case)
            run = {}
            if story:
                run = {"time": f"{story.last:.6g} of {story.end_time:.6g}", "steps": f"{int(story.rows['step'][-1]):,}", "clock": log.duration(spent(story))}
            told.append({**run, "cells": f"{case.mesh.cells:,}", **dict(found.short())})
        keys = list(dict.fromkeys([*told[0], *told[1]]))
        keys.sort(key=lambda k: told[0].get(k) == told[1].get(k))
        mark = lambda k, text: tag("strong", ESCAPE(text)) if told[0].get(k) != told[1].get(k) else ESCAPE(text)
        lines = [[ESCAPE(k), *(mark(k, t.get(k, "–")) for t in told)] for k in keys]
        return table(["", *map(ESCAPE, self.names)], lines, "What both are; what differs is bold")

    def films(self, name, span=None):
        """Films of both of a field at the times that both have, named by those of the first."""
        found = []
        for k, painter in enumerate(self.painters):
            film = painter.film(name, [p[k] for p in self.pairs], Wish(span=span))
            if film:
                names = {p[k]: p[0] for p in self.pairs}
                film.shots = [dataclasses.replace(s, time=names[s.time], about=f"{self.names[k]}: {s.about}") for s in film.shots]
                found.append((f"{self.names[k]}: {film.title}", film))
        return found

    def common(self):
        """Main fields of both."""
        last = self.pairs[-1]
        both = [quantity.main_fields(case, t) if quantity.fields(case, t) else [] for case, t in zip(self.cases, last)]
        return [n for n in both[0] if n in both[1]]

    def span(self, name):
        """The range of a field over both cases and all times."""
        there = ((case, p[k]) for k, case in enumerate(self.cases) for p in self.pairs if self.painters[k].readable(Wish(fields=[name]), p[k]))
        return common((quantity.read(case, name, time).values for case, time in there), Wish())

    def fields(self, page):
        films = []
        solid = any(p.space.dim == 3 for p in self.painters)
        for name in self.common()[:1 if solid else None]:
            films += self.films(name, self.span(name))
        if any(quantity.has_grains(case, t) for case, t in zip(self.cases, self.pairs[-1])):
            films += self.films(GRAINS)
        return page.grid(*(page.film(film, caption) for caption, film in films))

    def differences(self, page):
        """haff.compare at the last time, and its relative L1 over time."""
        try:
            found = compare.compare(*self.cases, self.common() or None, times=[float(a) for a, _ in self.pairs if float(a) > 0] or None)
        except (ValueError, OSError) as why:
            return tag("p", ESCAPE(str(why)), class_="quiet")
        told = "".join(tag("p", ESCAPE(f"Note: {text}."), class_="quiet") for text in found.notes)
        rows, last = found.columns, found.times[-1]
        units = self.cases[0].units
        value = lambda k, name: f"{rows[name][k]:.4g}"
        lines = []
        for k in np.flatnonzero(rows["time"] == last):
            name = str(rows["field"][k])
            lines.append([ESCAPE(with_unit(symbol(name), running.KNOWN.get(name), units)), *(value(k, c) for c in COLUMNS)])
        at = running.time_axis(units)
        shown = table(["field", "mean", "root mean square", "largest", "range", "mean / range", "covered"], lines, f"Differences at {at} = {last:.6g}")
        of = {n: rows["field"] == n for n in found.fields}
        curves = [(symbol(n), rows["time"][some], rows["relative"][some]) for n, some in of.items()]
        curve = overlay("Mean difference over the range", curves, across=at, y="mean / range")
        return told + shown + (page.grid(page.chart(curve)) if curve else "")

    def profiles(self):
        """Profiles of both along an axis that both have, at the time of the slider."""
        if profiles.axis_of(self.painters[0].space) != profiles.axis_of(self.painters[1].space):
            return
        for name in self.common():
            both = [{c["key"]: c for c in profiles.of_case(painter.space, [name], [p[k] for p in self.pairs])} for k, painter in enumerate(self.painters)]
            for a, b in ((both[0][key], both[1][key]) for key in both[0] if key in both[1]):
                if len(a["frames"]) == len(b["frames"]):
                    yield self.beside(a, b)

    def beside(self, a, b):
        """The profiles of both cases in one chart."""
        frames = []
        for one, other in zip(a["frames"], b["frames"]):
            x, series = joined([(n, c["data"][0], np.array(v, float)) for n, c, v in zip(self.names, (a, b), (one, other))])
            frames.append([numbers(v) for _, v in series])
        return {**a, "labels": list(self.names), "frames": frames, "data": [numbers(x)], "gaps": True}

    def runs(self):
        stories = [(name, story_of(case)) for name, case in zip(self.names, self.cases)]
        units = self.cases[0].units
        for title, column, sign, dimensions in running.COMMON:
            some = [(name, s.rows["Time"], s.change(column) if column in log.DRIFTS else s.column(column)) for name, s in stories if s]
            made = overlay(title, some, across=running.time_axis(units), y=with_unit(symbol(sign), dimensions, units))
            if made:
                yield made
