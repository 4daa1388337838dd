"""What the figure scripts share: one look, and saving."""
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

COLOURS = ["#1f4e79", "#c0392b", "#2e7d32", "#8e44ad", "#b9770e"]
AXES = {
    "x": "$x$ (cm)",
    "alpha": r"volume fraction $\nu$",
    "T": r"temperature $T$ (cm$^2$ s$^{-2}$)",
    "p": r"pressure $P$ (cm$^{-1}$ s$^{-2}$)",
    "U": r"velocity $u$ (cm s$^{-1}$)",
    "Ma": "Mach number",
    "impedance": r"impedance $\rho c_s$ (cm$^{-2}$ s$^{-1}$)",
}

plt.rcParams.update({
    "font.family": "serif",
    "font.size": 9,
    "mathtext.fontset": "cm",
    "axes.linewidth": 0.6,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
    "lines.linewidth": 0.9,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "legend.frameon": False,
    "savefig.dpi": 150,
})


def panels(rows, columns, width=7.0, height=2.6):
    return plt.subplots(rows, columns, figsize=(width, height * rows), squeeze=False, layout="constrained")


def label(axes, x, y, title=None):
    axes.set_xlabel(AXES.get(x, x))
    axes.set_ylabel(AXES.get(y, y))
    if title:
        axes.set_title(title, fontsize=9)


def save(figure, path):
    """Writes the PNG under a temporary name first; prints its path."""
    temporary = path + ".tmp"
    figure.savefig(temporary, format="png")
    os.replace(temporary, path)
    plt.close(figure)
    print(path)


def folder():
    """Where the running script stands: the case. One argument may name another: figure.py CASE."""
    return os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(sys.argv[0])))
