# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of values, their bars, and how panels are arranged on a page."""
import functools

import numpy as np
from matplotlib import colormaps, colors
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.cm import ScalarMappable

from haff.plot import figures, quantity
from haff.plot.quantity import CannotDraw

STRIP = 8.0  # ratio of the sides beyond which a domain is not drawn to scale


def span_of(values, wish, positive=False):
    """The ends of the colours: as wished, or least and largest, without the outermost 0.2 % where these stretch it twofold."""
    if wish.span:
        return wish.span
    values = values[np.isfinite(values)]
    if positive:
        values = values[values > 0]
    if not values.size:
        return (1.0, 10.0) if positive else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    inner = np.percentile(values if values.size < 2_000_000 else values[::values.size // 1_000_000], (0.2, 99.8))
    if inner[1] - inner[0] < 0.5 * (high - low) and inner[1] > inner[0] and not positive:
        low, high = float(inner[0]), float(inner[1])
    if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
        low, high = -max(-low, high), max(-low, high)
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        room = 0.05 * abs(high) or 1.0
        low, high = low - room, high + room
    return low, high


def common(several, wish):
    """The ends of the colours of several fields, or of one at several times. A uniform one, as a start at rest, asks for its value and no room."""
    low, high = np.inf, -np.inf
    for values in several:
        ends = quantity.limits(values)
        some = ends if ends[0] == ends[1] and not wish.log else span_of(values, wish, positive=wish.log)
        low, high = min(low, some[0]), max(high, some[1])
    return (low, high) if high > low else span_of(np.array([low, high]), wish, positive=wish.log)


class Scale:
    """Colours of values: norm, map, and whether values lie beyond its ends."""

    def __init__(self, q, wish, values=None):
        values = q.values if values is None else values
        span = span_of(values, wish, positive=wish.log)
        if wish.log and span[0] <= 0:
            raise CannotDraw(f"-log needs values above 0, but the range begins at {span[0]:g}")
        self.norm = (colors.LogNorm if wish.log else colors.Normalize)(*span)
        self.colours = colormaps[q.colours(span)].copy()
        self.colours.set_bad(figures.SOLID)
        low, high = quantity.limits(values)
        slack = 1e-6 * (span[1] - span[0])
        below, above = low < span[0] - slack, high > span[1] + slack
        self.extend = "both" if below and above else "min" if below else "max" if above else "neither"

    def mappable(self):
        return ScalarMappable(self.norm, self.colours)


def own_bar(figure, ax, scale, text=None):
    """A colour bar of the height of one picture, which is drawn to scale."""
    box = ax.inset_axes([1.03, 0, 0.02 + 0.02 / min(1.0, ratio_of(ax)), 1])
    return finish_bar(figure.colorbar(scale.mappable(), cax=box, extend=scale.extend, extendfrac=0.03), text)


def ratio_of(ax):
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    return (right - left) / (high - low) if ax.get_aspect() == 1 else STRIP


def bar(figure, axes, scale, text=None, mark=None, **options):
    """A colour bar beside axes; mark: a value to be marked on it."""
    made = figure.colorbar(scale.mappable(), ax=axes, extend=scale.extend, extendfrac=0.03, **{"aspect": 25, "pad": 0.015, **options})
    return finish_bar(made, text, mark)


def finish_bar(made, text=None, mark=None):
    made.outline.set_linewidth(0.5)
    made.ax.tick_params(width=0.5, labelsize=8)
    if text:
        made.set_label(text)
    if mark is not None and made.norm.vmin <= mark <= made.norm.vmax:
        vertical = made.orientation == "vertical"
        (made.ax.axhline if vertical else made.ax.axvline)(mark, color="white", linewidth=2.4)
        (made.ax.axhline if vertical else made.ax.axvline)(mark, color="black", linewidth=1.0)
    return made


# ---- layout ----

def arrange(count, ratio, width=7.2, most=8.0):
    """(columns, height of a panel) for that number of panels whose width over height is `ratio`, on a page that is wider than high."""
    best = None
    for columns in range(1, count + 1):
        rows = -(-count // columns)
        tall = max((width / columns - 1.0) / ratio, 0.45) + 0.55
        if tall * rows > most:
            tall = most / rows
        room = min((width / columns - 1.0), (tall - 0.55) * ratio)  # width of the picture itself
        waste = rows * columns - count
        score = room * min(1.0, 0.75 * width / (tall * rows)) * (1 - 0.12 * waste)
        if best is None or score > best[0]:
            best = (score, columns, tall)
    return best[1:]


@functools.lru_cache(4)
def renderer_of(width, height, dpi):
    return RendererAgg(width, height, dpi)


class Canvas(FigureCanvasAgg):
    """Draws with the renderer of the picture before, where that had the same size: it keeps how texts are laid out, which takes as long as
    all other work on a picture of a film. What was drawn is there until another figure is drawn."""

    def get_renderer(self, cleared=False):
        self.renderer = renderer_of(*self.figure.bbox.size, self.figure.dpi)
        if cleared:
            self.renderer.clear()
        return self.renderer


def new(rows, columns, width, height, wish):
    """A figure and its axes, of the size that is wished, or of the given one in inches."""
    if wish.size:
        width, height = (n / wish.dpi for n in wish.size)
    figure, axes = figures.plt.subplots(rows, columns, figsize=(width, height), squeeze=False, layout="constrained")
    Canvas(figure)
    figure.get_layout_engine().set(w_pad=0.04, h_pad=0.04, wspace=0.03, hspace=0.03)
    return figure, axes
