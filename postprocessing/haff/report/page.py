# SPDX-License-Identifier: GPL-3.0-or-later
"""One HTML file of the parts of a report, with everything that it needs inside. Films and plots are data that page.js shows."""
import dataclasses
import datetime
import json
import os

import matplotlib
import numpy

from haff.command import VERSION, replacing
from haff.report.words import ESCAPE, tag

HERE = os.path.dirname(os.path.abspath(__file__))
SLIDER = """<div class="timebar" id="timebar" hidden>
<button type="button" id="play" aria-label="play the film">&#9654;</button>
<input type="range" id="time" min="0" value="0" step="1" aria-label="time of pictures and profiles">
<output id="now" for="time"></output>
</div>"""
AGAIN = """<p class="again" role="status"><span>The run goes on; this page is made anew every {every:g} s.</span>
<button type="button" id="hold" aria-pressed="false">hold</button></p>"""


@dataclasses.dataclass
class Page:
    """title and lines under it (HTML); sections [(id, name, HTML)]; what page.js shows: times [names], films [[(time, uri)] ..], charts."""
    title: str
    lead: str = ""
    unit: str = ""
    sections: list = dataclasses.field(default_factory=list)
    times: list = dataclasses.field(default_factory=list)
    films: list = dataclasses.field(default_factory=list)
    charts: list = dataclasses.field(default_factory=list)
    every: float = 0.0
    told: list = dataclasses.field(default_factory=list)  # warnings of the page's own, for the terminal, too

    def add(self, key, name, *inside):
        """A section, unless it is empty."""
        if "".join(inside):
            self.sections.append((key, name, "".join(inside)))

    # ---- parts of sections ----

    def film(self, film, caption=None):
        """The picture of a film's last time. The slider shows its other times."""
        shots = film.shots
        wide, high = shots[-1].size
        key = None
        if len(shots) > 1:
            key = len(self.films)
            self.films.append([[s.time, "" if s is shots[-1] else s.uri, s.about] for s in shots])
        image = tag("img", src=shots[-1].uri, width=wide, height=high, alt=shots[-1].about, data_film=key)
        return tag("figure", tag("div", image, class_="paper"), tag("figcaption", ESCAPE(caption or film.title)), class_="film")

    def chart(self, chart):
        """The place of a plot."""
        self.charts.append(chart)
        place = tag("div", class_="plot", data_chart=len(self.charts) - 1, role="group", aria_label=chart["about"])
        return tag("figure", tag("figcaption", ESCAPE(chart["title"])), place, class_="chart")

    def grid(self, *cells, kind=""):
        return tag("div", *cells, class_=f"grid {kind}".strip()) if any(cells) else ""

    # ---- the whole ----

    def html(self):
        links = tag("nav", *(tag("a", ESCAPE(name), href=f"#{key}") for key, name, _ in self.sections), aria_label="sections")
        body = "".join(tag("section", tag("h2", ESCAPE(name)), inside, id=key) for key, name, inside in self.sections)
        again = AGAIN.format(every=self.every) if self.every else ""
        return HEAD.format(title=ESCAPE(self.title), css=inlined("vendor/uPlot.min.css") + inlined("page.css"),
                           again=f'<noscript><meta http-equiv="refresh" content="{self.every:g}"></noscript>' if self.every else "") + "".join((
            "<body>", tag("header", tag("p", "haff report", class_="kind"), tag("h1", ESCAPE(self.title)), self.lead, again, links),
            tag("main", tag("noscript", tag("p", "Plots and films need JavaScript; the pictures are those of the last time.", class_="quiet")), body), SLIDER,
            self.foot(), f'<script type="application/json" id="data">{self.data()}</script>', f'<script>{inlined("vendor/uPlot.iife.min.js")}</script>',
            f'<script>{inlined("page.js")}</script>', "</body></html>\n"))

    def data(self):
        """What page.js shows, as JSON that cannot end its element."""
        told = {"times": self.times, "unit": self.unit, "films": self.films, "charts": self.charts, "every": self.every}
        return json.dumps(told, separators=(",", ":"), allow_nan=False, ensure_ascii=False).replace("<", r"\u003c")

    def foot(self):
        now = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
        made = f"Made {now} by haff {VERSION} (matplotlib {matplotlib.__version__}, numpy {numpy.__version__})."
        licence = inlined("vendor/uPlot.LICENSE.txt")
        return tag("footer", tag("p", made), tag("details", tag("summary", "Plots by uPlot, under the MIT licence"), tag("pre", ESCAPE(licence))))


HEAD = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="haff report">
{again}<title>{title}</title>
<style>{css}</style>
</head>
"""


def inlined(name):
    with open(os.path.join(HERE, name), encoding="utf-8") as f:
        return f.read()


def write(page, path):
    """Writes the page, under a temporary name first: a browser never sees half of it. A byte of a name that is no UTF-8 reads \\udcff."""
    with replacing(path) as temporary, open(temporary, "w", encoding="utf-8", errors="backslashreplace") as f:
        f.write(page.html())
