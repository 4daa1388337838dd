# SPDX-License-Identifier: GPL-3.0-or-later
"""The look of all figures, units and names on their axes, and saving.

    figures.panels(rows, columns)                 a figure and its axes [rows][columns]
    figures.label(axes, "x", "alpha")             names with the units of a case; without one, of Serna & Marquina: cm, s, grains
    figures.save(figure, "a.pdf")                 png, pdf or svg; written under a temporary name first

A case says in system/units what its numbers are measured in (length cm; mass g; time s;); without that file they are kg, m, s, as
everywhere in OpenFOAM. A copy of a case that lies inside its folder has the units of that case.
"""
import os
import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

from haff.command import replacing  # noqa: E402
from haff.plot.labels import AXES, DIMENSIONS, NAMES, PAPER, SI, SIGNED, axis, unit, units, with_time, with_unit  # noqa: E402, F401

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#333333"]  # Okabe & Ito: told apart by all
FORMATS = ("png", "pdf", "svg")
SOLID, WALL, RIM = "0.86", "#111111", "0.45"  # what is no gas, walls, other ends of the mesh

plt.rcParams.update({
    "font.family": "serif",
    "font.serif": ["DejaVu Serif"],
    "font.size": 9,
    "mathtext.fontset": "cm",
    "axes.linewidth": 0.6,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
    "axes.titlesize": 9,
    "axes.titley": 1.0,  # no search for a title.s place, which half the time of drawing went into: nothing stands above axes
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "lines.linewidth": 0.9,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "image.cmap": "viridis",
    "savefig.dpi": 150,
    "svg.hashsalt": "haff",  # the same figure gives the same file
})


# ---- figures ----

def panels(rows, columns, width=7.0, height=2.6):
    """A figure of the given width, each row of the given height (inches), and its axes [rows][columns]."""
    return plt.subplots(rows, columns, figsize=(width, height * rows), squeeze=False, layout="constrained")


def label(axes, x, y, title=None, of=PAPER):
    """Names along both axes; other texts than names of fields and coordinates stand as they are."""
    axes.set_xlabel(axis(x, of))
    axes.set_ylabel(axis(y, of))
    if title:
        axes.set_title(title, fontsize=9)


def kind(path):
    """The format that the suffix of a path asks for; ValueError where there is none such."""
    suffix = os.path.splitext(path)[1][1:].lower()
    if suffix not in FORMATS:
        raise ValueError(f"{path}: figures are written as .png, .pdf or .svg")
    return suffix


def packing_at(case, moments, width, height, across=True):
    """A figure of the packing on a lattice of two axes at some times (s), side by side or (across False) one above the other; lengths in mm."""
    fig, axes = panels(1, len(moments), width=width, height=height) if across else panels(len(moments), 1, width=width, height=height)
    low, high = 1e3 * case.mesh.points.min(axis=0), 1e3 * case.mesh.points.max(axis=0)
    column, row = (np.unique(np.round(case.centres[:, k], 9), return_inverse=True)[1] for k in (0, 1))
    picture = np.full((row.max() + 1, column.max() + 1), np.nan)
    for ax, t in zip(np.ravel(axes), moments):
        picture[row, column] = case.field("alpha", case.time(t))
        image = ax.imshow(picture.copy(), origin="lower", extent=(low[0], high[0], low[1], high[1]), vmin=0, vmax=0.64, cmap="magma_r")
        label(ax, "$x$ (mm)" if across or t == moments[-1] else "", "$y$ (mm)" if not across or t == moments[0] else "", f"$t$ = {1e3 * t:g} ms")
    fig.colorbar(image, ax=axes, shrink=0.8, label=r"$\alpha$")
    return fig


def titled(figure):
    return [*([figure._suptitle] if figure._suptitle else []), *figure.axes]


def places(figure):
    """Where title and axes of a figure lie that was laid out."""
    return [part.get_position(original=True) if part in figure.axes else part.get_position() for part in titled(figure)]


def place(figure, where):
    """The places of another picture of the same film, whose layout need not be found again: that takes a quarter of the time."""
    figure.set_layout_engine("none")
    for part, at in zip(titled(figure), where):
        part.set_position(at)


def save(figure, path, dpi=None):
    """Writes the figure in the format of the suffix, under a temporary name first; prints its path."""
    suffix = kind(path)
    still = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(suffix)
    try:
        with replacing(path) as temporary:
            figure.savefig(temporary, format=suffix, dpi=dpi or plt.rcParams["savefig.dpi"], metadata=still)
    finally:
        plt.close(figure)
    print(path)


def folder():
    """Where the running script stands: the case. One argument may name another: figure.py CASE."""
    return os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(sys.argv[0])))
