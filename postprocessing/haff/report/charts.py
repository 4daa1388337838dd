# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots of a report: what page.js makes of uPlot. A chart is {title, x, y, log, series: [{label, points}], data: [x, values ..]}."""
import numpy as np

MOST = 900  # rows of a chart, about
DIGITS = 6


def decimated(x, columns, most=MOST):
    """Rows of long tables: of each piece of them those of the least and the largest value of every column."""
    if len(x) <= most:
        return x, columns
    pieces = np.array_split(np.arange(len(x)), max(most // (2 * len(columns)), 50))
    kept = {0, len(x) - 1}
    for piece in pieces:
        for column in columns:
            some = piece[np.isfinite(column[piece])]
            if len(some):
                kept.update((int(some[np.argmin(column[some])]), int(some[np.argmax(column[some])])))
    rows = np.array(sorted(kept))
    return x[rows], [column[rows] for column in columns]


def numbers(values, positive=False):
    """Numbers as JSON has them: with few digits, None for what is none or, of a logarithm, not above 0."""
    return [float(f"{v:.{DIGITS}g}") if np.isfinite(v) and (v > 0 or not positive) else None for v in np.asarray(values, float)]


def wide(columns):
    """Whether values are better shown by powers of ten: all positive, and largest more than 20 times the least."""
    some = np.concatenate([c[np.isfinite(c)] for c in columns])
    return bool(len(some) and some.min() > 0 and some.max() > 20 * some.min())


def chart(title, x, series, *, across="time", y="", log=None, time=True):
    """A chart of columns over x, or None where none has two numbers. series: (label, values [n]), or with "points" behind them, or "line": a
    thin grey one. time: x is the time, at which the slider of the page sets a mark."""
    series = [(label, np.asarray(v, float), *kind) for label, v, *kind in series if np.isfinite(np.asarray(v, float)).any()]
    if not any(np.isfinite(s[1]).sum() > 1 for s in series):
        return None
    columns = [s[1] for s in series]
    log = wide(columns) if log is None else log and any((c > 0).any() for c in columns)
    x, columns = decimated(np.asarray(x, float), columns)
    return {"title": title, "x": across, "y": y, "log": bool(log), "time": time,
            "series": [{"label": label, "points": kind == ["points"], "kind": "line" if kind == ["line"] else ""} for label, _, *kind in series],
            "data": [numbers(x)] + [numbers(c, positive=log) for c in columns], "about": about(title, x, series, across)}


def about(title, x, series, across):
    """A description for those who do not see the plot."""
    ends = []
    for label, values, *_ in series[:4]:
        some = values[np.isfinite(values)]
        ends.append(f"{label}: from {some[0]:.4g} to {some[-1]:.4g}, between {some.min():.4g} and {some.max():.4g}")
    return f"{title} over {across}, {x[0]:.4g} to {x[-1]:.4g}. " + "; ".join(ends)


def joined(curves):
    """Curves (label, x, values) with places of their own on all places together: (x, [(label, values)]), nan between."""
    curves = [(label, *decimated(np.asarray(x, float), [np.asarray(v, float)], MOST // len(curves))) for label, x, v in curves]
    x = np.unique(np.concatenate([c[1] for c in curves]))
    series = []
    for label, places, (values,) in curves:
        on_all = np.full(len(x), np.nan)
        on_all[np.searchsorted(x, places)] = values
        series.append((label, on_all))
    return x, series


def overlay(title, curves, **options):
    """A chart of curves (label, x, values) with places of their own; None without any."""
    curves = [c for c in curves if len(c[1]) and np.isfinite(np.asarray(c[2], float)).any()]
    if not curves:
        return None
    x, series = joined(curves)
    made = chart(title, x, series, **options)
    return {**made, "gaps": True} if made else None
