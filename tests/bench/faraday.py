#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws run time against error, as bench_faraday prints it: bench_faraday | tests/bench/faraday.py FIGURE.png"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

from haff.plot import figures  # noqa: E402


def rows(lines):
    """(scheme, Courant number, seconds, error of heights, error of growth), without the reference."""
    words = [line.split() for line in lines if len(line.split()) == 11]
    return [(f"{w[0]}, {w[1]}", float(w[2]), float(w[3]), float(w[8]), abs(float(w[10]))) for w in words if float(w[8]) > 0]


def main(path, table):
    fig, axes = figures.panels(1, 2, height=2.8)
    for ax, column, title in zip(axes[0], (3, 4), ("height of the centre of mass", "growth of the wave per period")):
        for scheme in dict.fromkeys(row[0] for row in table):
            mine = sorted(row for row in table if row[0] == scheme)
            ax.loglog([row[2] for row in mine], [row[column] for row in mine], marker="o", markersize=3, label=scheme)
            for row in mine:
                ax.annotate(f"{row[1]:g}", (row[2], row[column]), fontsize=6, xytext=(3, 3), textcoords="offset points")
        figures.label(ax, "processor time (s)", "relative error", title)
    axes[0][0].legend()
    figures.save(fig, path)


if __name__ == "__main__":
    main(sys.argv[1], rows(sys.stdin))
