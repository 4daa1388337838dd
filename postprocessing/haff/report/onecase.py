# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of one case: summary, warnings, pictures, profiles, plots of the run, expected values, models, provenance."""
import os

import numpy as np

from haff import command
from haff.case import grains
from haff.case.foam import FormatError
from haff.plot import log, quantity, runlog
from haff.plot.quantity import GRAINS, CannotDraw
from haff.plot.wish import Wish, times_with_results
from haff.report import facts, profiles, running
from haff.report.page import Page
from haff.report.pictures import LOST, Film, Painter, some_of
from haff.report.words import ESCAPE, rows, symbol, table, tag, tiles, unfold

FRAMES, WORK = 12, 6_000_000  # defaults: written times in a film; cells or grains in all of its pictures
SOLID_FRAMES = 6  # of films in three dimensions, whose pictures take a second each
MOST_FIELDS = 16  # pictures of fields at the last time


class Report:
    """What a page of one case is made of. make() may be called again while a run goes on."""

    def __init__(self, case, frames):
        self.case, self.frames, self.painter, self.faults = case, frames, None, {}

    def make(self, every=0.0):
        """The Page now. CannotDraw: no times, no mesh."""
        case = self.case
        there = times_with_results(case)
        self.painter = self.painter or Painter(case)
        self.painter.begin()
        self.story = story_of(case)
        self.facts = facts.Facts(case, there[-1])
        page = Page(os.path.basename(os.path.abspath(case.path)), unit=case.units["time"], every=every)
        page.lead = self.lead()
        page.times = some_of(there, self.frames or self.worth(there[-1]))
        page.told = [f"{name} has changed since time {there[-1]} was written: this page tells of the run before that" for name in self.facts.changed]
        page.told += self.damaged(page.times)
        self.notes = self.facts.warnings() + [("warning", text, 1) for text in page.told]
        page.add("summary", "Summary", self.tiles(there), self.warnings())
        self.pictures(page, there[-1])
        lines = profiles.of_case(self.painter.space, self.names(there[-1]), page.times) + profiles.of_sets(case, page.times)
        page.add("profiles", "Profiles", page.grid(*(page.chart(c) for c in lines)))
        if self.story:
            page.add("run", "The run", page.grid(*(page.chart(c) for c in running.of_run(self.story, case.units))))
        self.functions(page)
        page.add("expected", "Expected values", *verdict(case.path))
        page.add("case", "What was run", self.models())
        page.add("provenance", "Provenance", self.provenance())
        return page

    # ---- words ----

    def lead(self):
        said = facts.heading(self.case)
        return tag("p", ESCAPE(said), class_="lead") if said and said != os.path.basename(os.path.abspath(self.case.path)) else ""

    def tiles(self, there):
        """The numbers that one looks for first."""
        story, unit = self.story, self.case.units["time"]
        found = []
        if story:
            state = "ended" if story.ended else "running" if story.running() else "stopped"
            reached = f"{story.last:.6g}" + ("" if story.ended else f" of {story.end_time:.6g}")
            found += [("the run", state, state), (f"time ({unit})" if unit else "time", reached, ""),
                      ("steps", f"{int(story.rows['step'][-1]):,}", ""), ("clock", log.duration(spent(story)), "")]
        else:
            found.append((f"last time ({unit})" if unit else "last time", there[-1], ""))
        found.append(("cells", f"{self.painter.space.mesh.cells:,}", ""))
        if quantity.has_grains(self.case, there[-1]):
            found.append(("grains", f"{len(grains.places(self.case, there[-1])):,}", ""))
        for name in log.DRIFTS:
            if story and log.there(story, name):
                share = story.change(name)[np.isfinite(story.column(name))][-1]
                if np.isinf(share):  # from 0
                    found.append((log.TEXTS[name], f"{story.latest(name.removesuffix('Change')):.4g}", ""))
                else:
                    found.append((f"{log.TEXTS[name]}, change", f"{100 * share:.3g} %" if share == 0 or abs(share) > 1e-4 else f"{share:.1e}", ""))
        n = sum(count for kind, _, count in self.notes if kind == "warning")
        if self.facts.log or n:
            found.append(("warnings", str(n), "stopped" if n else ""))
        return tiles(found)

    def warnings(self):
        found = self.notes
        if not found:
            return ""
        line = lambda kind, text, n: tag("li", tag("strong", ESCAPE(kind)), " ", ESCAPE(text), f" ({n} times)" if n > 1 else "", class_=kind.split()[0])
        lines = [line(*f) for f in found[:40]]
        more = tag("p", f"and {len(found) - 40} more in {ESCAPE(self.facts.log_path)}", class_="quiet") if len(found) > 40 else ""
        return tag("ul", *lines, class_="warnings") + more

    def damaged(self, times):
        """Of the files of fields that cannot be read at these times, what is wrong and what to do."""
        names = dict.fromkeys(name for time in times for name in quantity.fields(self.case, time))
        return [why for time in times for name in names if (why := self.fault(name, time))]

    def fault(self, name, time):
        """What is wrong with the file of a field, "" where nothing is. What was read once is not read again."""
        if (name, time) not in self.faults:
            try:
                self.case.field(name, time)
                self.faults[name, time] = ""
            except FormatError as why:
                self.faults[name, time] = "" if "expression" in str(why) else command.message(why)
            except OSError:  # not written, or removed by purgeWrite
                return ""
        return self.faults[name, time]

    def models(self):
        case = self.case
        patches = [[ESCAPE(name), ESCAPE(kind), f"{count:,}"] for name, (kind, _, count) in case.mesh.patches.items()]
        mesh = [("cells", f"{case.mesh.cells:,}"), *(("kind", line) for line in self.facts.mesh() if line.startswith(("polyhedral", "lattice")))]
        shown = tag("h3", "Models") + rows(self.facts.short()) + tag("h3", "Mesh") + rows(mesh)
        shown += table(["patch", "type", "faces"], patches, "Patches of the mesh")
        if self.facts.models:
            shown += unfold("All settings of the models", rows(self.facts.models.items()))
        return shown

    def provenance(self):
        said = [(k, v) for k, v in self.facts.provenance.items() if k in ("version", "compiler", "host", "date", "ranks", "meshChecksum")]
        made = rows([*said, ("folder", os.path.abspath(self.case.path))])
        if self.facts.dictionaries:
            made += unfold("Dictionaries of the run", tag("pre", ESCAPE(self.facts.dictionaries)))
        if self.facts.log:
            text = self.facts.log
            part = text if len(text) < 20000 else text[:8000] + "\n ..\n" + text[-8000:]
            made += unfold(f"The log, {os.path.basename(self.facts.log_path)}", tag("pre", ESCAPE(part)))
        return made

    # ---- pictures ----

    def worth(self, last):
        """Times of films by default: fewer of large cases."""
        size = max(self.painter.space.mesh.cells, len(grains.places(self.case, last)) if quantity.has_grains(self.case, last) else 0)
        return int(min(FRAMES, max(WORK // size, 2)))

    def names(self, time):
        """Main fields first."""
        try:
            main = quantity.main_fields(self.case, time)
        except CannotDraw:
            main = []
        return main + [n for n in quantity.fields(self.case, time) if n not in main]

    def pictures(self, page, last):
        """Films of the main fields and of grains, pictures of the others at the last time; uniform fields are described in words."""
        space, names = self.painter.space, self.names(last)
        column = space.column is not None
        main = [] if column else quantity.main_fields(self.case, last) if names else []
        filmed = ([GRAINS] if quantity.has_grains(self.case, last) else []) + main
        films, others, uniform = [], [], []
        if column and names:
            shown = quantity.main_fields(self.case, last)
            films.append(Film("Profiles at times of the run", [self.painter.still(f"Profiles of {', '.join(map(symbol, shown))} at times of the run", Wish())]))
            if quantity.has_grains(self.case, last):
                films.append(self.painter.film(GRAINS, page.times))
        for k, name in enumerate(filmed if not column else []):
            films.append(self.painter.film(name, self.times_of_film(page.times, k)))
        for name in [n for n in names if n not in main][:MOST_FIELDS]:
            if is_uniform(self.case, name, last):
                uniform.append(name)
            elif not column:
                others.append(self.painter.film(name, [last]))
        films, others = [f for f in films if f], [f for f in others if f]
        kind = "tall" if films and np.median([f.shots[-1].size[0] / f.shots[-1].size[1] for f in films]) < 0.85 else ""
        told = ", ".join(f"{n} = {value_of(self.case, n, last)}" for n in uniform)
        flat = tag("p", f"Uniform at the last time: {ESCAPE(told)}.", class_="quiet") if uniform else ""
        page.add("fields", "Fields", page.grid(*(page.film(f) for f in films), kind=kind),
                 tag("h3", "Other fields at the last time") + page.grid(*(page.film(f) for f in others), kind="small") if others else "", flat)

    def times_of_film(self, times, k):
        if self.painter.space.dim < 3:
            return times
        return some_of(times, self.frames or SOLID_FRAMES) if k == 0 else times[-1:]

    def functions(self, page):
        charts = [{**c, "title": f"{name}: {c['title']}"} for name, found in running.of_functions(self.case).items() for c in found]
        page.add("tables", "Function objects", page.grid(*(page.chart(c) for c in charts)))


def story_of(case):
    """The Story of the run, None where it left no trace."""
    try:
        return runlog.read(case.path)
    except (CannotDraw, OSError):
        return None


def spent(story):
    """Seconds of the clock of all starts."""
    return sum(np.nanmax(story.column("clockTime")[story.parts == p], initial=0) for p in np.unique(story.parts))


def is_uniform(case, name, time):
    try:
        values = case.field(name, time)
    except LOST:
        return False
    return bool((values == values[:1]).all())


def value_of(case, name, time):
    first = case.field(name, time)[0]
    return f"{first:.6g}" if np.ndim(first) == 0 else "(" + " ".join(f"{v:.6g}" for v in first) + ")"


def verdict(path):
    """The expected.json of the case beside what it has, as HTML."""
    if not os.path.isfile(os.path.join(path, "expected.json")):
        return
    try:
        from haff.runs import expected  # which needs scipy
        entries = expected.load(path, "full")
    except (ImportError, KeyError, ValueError, OSError) as why:
        yield tag("p", ESCAPE(f"{os.path.join(path, 'expected.json')} was not compared: {command.message(why)}"), class_="quiet")
        return
    lines, bad = [], 0
    for entry in entries:
        value, good, why = expected.judge(path, entry)
        bad += not good
        mark = tag("span", "as expected" if good else "not as expected", class_="good" if good else "bad")
        lines.append([ESCAPE(expected.describe(entry)), ESCAPE(why or f"{value:.6g}"), f"{entry['value']:.6g} ± {entry['tolerance']:.2g}", mark])
    yield tag("p", f"{len(lines) - bad} of {len(lines)} values are as expected.", class_="bad" if bad else "good")
    yield table(["quantity", "value", "expected", ""], lines, "Values beside expected.json")
