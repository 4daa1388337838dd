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

from haff.case.units import SI  # noqa: E402
from haff.case.units import read as units  # noqa: E402, F401
from haff.command import replacing  # noqa: E402

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#333333"]  # Okabe & Ito: told apart by all
FORMATS = ("png", "pdf", "svg")
SOLID, WALL, RIM = "0.86", "#111111", "0.45"  # what is no gas, walls, other ends of the mesh
NAMES = {  # name of a field: what it is, its symbol, its colours
    "alpha": ("packing fraction", r"$\alpha$", "viridis"),
    "rho": ("density", r"$\rho$", "viridis"),
    "T": ("temperature", "$T$", "magma"),
    "p": ("pressure", "$p$", "cividis"),
    "U": ("velocity", "$U$", "cividis"),
    "rhoU": ("momentum", r"$\rho U$", "cividis"),
    "rhoE": ("energy", r"$\rho E$", "magma"),
    "Ma": ("Mach number", "Ma", "cividis"),
    "c": ("speed of sound", "$c$", "cividis"),
    "phi": ("fraction of small grains", r"$\phi$", "cividis"),
    "vorticity": ("vorticity", r"$\omega$", "viridis"),
    "gradAlpha": ("gradient of the packing", r"$\nabla\alpha$", "viridis"),
    "stressRatio": ("friction: shear stress over pressure", r"$|\tau|/p$", "magma"),
    "Kn": ("Knudsen number", "Kn", "magma"),
    "limited": ("limited faces", "limited faces", "magma"),
}
SIGNED = "RdBu_r"  # for values of both signs
PAPER = {"mass": "", "length": "cm", "time": "s"}
DIMENSIONS = {"x": (0, 1, 0), "y": (0, 1, 0), "z": (0, 1, 0), "t": (0, 0, 1), "rho": (1, -3, 0), "alpha": (0, 0, 0), "T": (0, 2, -2),
              "p": (1, -1, -2), "U": (0, 1, -1), "rhoU": (1, -2, -1), "rhoE": (1, -1, -2), "c": (0, 1, -1), "Ma": (0, 0, 0), "phi": (0, 0, 0)}
AXES = {"impedance": r"impedance $\rho c_s$ (cm$^{-2}$ s$^{-1}$)"}

plt.rcParams.update({
    "font.family": "serif",
    "font.serif": ["DejaVu Serif"],
    "font.size": 9,
    "mathtext.fontset": "cm",
    "axes.linewidth": 0.6,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
    "axes.titlesize": 9,
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


# ---- units and names ----

def unit(dimensions, of=SI):
    """The unit of a quantity with exponents of mass, length and time, as "cm$^2$ s$^{-2}$"; empty where it has none, and where the
    unit of its length or of its time has no name. A mass without a name is that of a grain: 1."""
    words = []
    if any(power and not of[name] for name, power in zip(("length", "time"), dimensions[1:3])):
        return ""
    for name, power in zip(("mass", "length", "time"), dimensions):
        if power and of[name]:
            words.append(of[name] if power == 1 else f"{of[name]}$^{{{power:g}}}$")
    return " ".join(words)


def with_unit(text, dimensions, of=SI):
    measured = unit(dimensions, of)
    return f"{text} ({measured})" if measured else text


def with_time(time, of=SI):
    """A time as it stands in a title: t = 0.05 s."""
    return f"$t$ = {float(time):.6g} {of['time']}".rstrip()


def axis(name, of=PAPER):
    """What stands along an axis: "x", "t", a field."""
    if name in NAMES and name in DIMENSIONS:
        return with_unit(" ".join(dict.fromkeys(NAMES[name][:2])), DIMENSIONS[name], of)
    return with_unit(f"${name}$", DIMENSIONS[name], of) if name in DIMENSIONS else AXES.get(name, name)


AXES.update({name: axis(name) for name in DIMENSIONS})


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
