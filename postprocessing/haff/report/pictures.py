# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a report: what haffPlot draws, small and as data within the page.

    painter = Painter(haff.Case("cases/wedge"))
    film = painter.film("alpha", ["0", "0.02", "0.04"])        # one range of colours for all times
    film.shots[-1].uri                                         # "data:image/webp;base64,.."
"""
import base64
import contextlib
import dataclasses
import io

import numpy as np
from matplotlib.ticker import MaxNLocator

from haff.case.foam import FormatError
from haff.plot import figures, movie, picture, quantity
from haff.plot.quantity import GRAINS, CannotDraw
from haff.plot.space import Space
from haff.plot.wish import Wish, spread
from haff.report import words

PIXELS_PER_INCH = 150
SHRUNK, SOLID = 0.72, 0.9  # of the size of haffPlot's figures: letters are read on a page where a picture is a hand wide; of several views
NARROW = 4.5  # inches: less room for numbers along x
QUALITY = 82  # of webp
LOST = (CannotDraw, FormatError, OSError, ValueError)  # what a time that is being written may lead to


@dataclasses.dataclass
class Shot:
    """A picture at a time: its data, its size in pixels, and its description for those who do not see it."""
    time: str
    uri: str
    size: tuple
    about: str


@dataclasses.dataclass
class Film:
    """The shots of a field, ascending in time; a single one is a picture of the last time."""
    title: str
    shots: list


def some_of(times, count):
    """At most that number of times, evenly; a single one is the last."""
    return list(times[-1:]) if count == 1 else spread(times, count)


class Painter:
    """Draws a case. What was drawn once is kept, so that a report that follows a run draws new times only."""

    def __init__(self, case):
        self.case = case
        self.space = Space(case)
        self.kept, self.before, self.places = {}, {}, {}

    def begin(self):
        """A new page begins: what the one before showed may be shown again, what it did not is forgotten."""
        self.kept, self.before = {}, self.kept

    def film(self, name, times, wish=None):
        """The Film of a field, or of grains, at those of the times that can be drawn; None without any."""
        wish = dataclasses.replace(wish or Wish(), fields=[name], dpi=PIXELS_PER_INCH)
        times = [t for t in times if self.readable(wish, t)]
        if not times:
            return None
        if not wish.span:
            wish = dataclasses.replace(wish, span=movie.span(self.space, wish, times))
        shots = [shot for shot in (self.shot(dataclasses.replace(wish, time=t)) for t in times) if shot]
        return Film(self.title(name, shots[-1].time), shots) if shots else None

    def readable(self, wish, time):
        try:
            picture.filmed(self.space, wish, time)
            return True
        except LOST:
            return False

    def title(self, name, time):
        if name == GRAINS:
            return "grains, coloured by their speed"
        return words.plain(quantity.read(self.case, name, time).label)

    def shot(self, wish):
        """The Shot that a wish asks for; None where the time cannot be drawn."""
        key = (wish.time, tuple(wish.fields), wish.span, wish.cut)
        if key in self.before:
            self.kept[key] = self.before[key]
        if key not in self.kept:
            try:
                values = picture.filmed(self.space, wish, wish.time)
                image, self.places[key[1:]] = drawn(picture.draw(self.space, wish), self.places.get(key[1:]))
            except LOST:
                return None
            self.kept[key] = Shot(wish.time, encoded(image), image.size, self.about(wish, values))
        return self.kept[key]

    def about(self, wish, values):
        at = words.plain(figures.with_time(wish.time, self.case.units))
        if wish.fields == [GRAINS]:
            return f"{len(values)} grains at {at}, coloured by their speed, at most {quantity.limits(values)[1]:.4g}"
        low, high = quantity.limits(values)
        return f"{self.title(wish.fields[0], wish.time)} at {at}: from {low:.4g} to {high:.4g}"

    def still(self, about, wish=None):
        """The picture that haffPlot draws without options, as a Shot."""
        wish = dataclasses.replace(wish or Wish(), dpi=PIXELS_PER_INCH)
        image, _ = drawn(picture.draw(self.space, wish))
        return Shot(wish.time, encoded(image), image.size, about)


def drawn(figure, places=None):
    """(image, places of its axes) of a figure, which is closed. places: of another picture of the same film (figures.place)."""
    from PIL import Image
    try:
        figure.set_dpi(PIXELS_PER_INCH)
        figure.set_size_inches((SHRUNK if len(figure.axes) < 3 else SOLID) * figure.get_size_inches())
        for ax in figure.axes:
            if figure.get_figwidth() < NARROW and isinstance(ax.xaxis.get_major_locator(), MaxNLocator):
                ax.xaxis.get_major_locator().set_params(nbins=4)
        if places:
            figures.place(figure, places)
        else:
            figure.get_layout_engine().execute(figure)  # it is right the second time, when drawn: colour bars follow the picture
        figure.canvas.draw()
        image = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
        return image, figures.places(figure)
    finally:
        figures.plt.close(figure)


def encoded(image):
    """An image as data of a page: webp or a PNG of 256 colours, whichever is smaller."""
    from PIL import Image, features
    packed = {"png": io.BytesIO()}
    image.quantize(256, dither=Image.Dither.NONE).save(packed["png"], "png")
    if features.check("webp"):
        with contextlib.suppress(OSError):
            packed["webp"] = io.BytesIO()
            image.save(packed["webp"], "webp", quality=QUALITY)
    kind, data = min(((k, p.getvalue()) for k, p in packed.items() if p.getvalue()), key=lambda pair: len(pair[1]))
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
