# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing at five times: grains that pour onto a floor."""
import haff
from haff.plot import figures, script

MOMENTS = 0, 0.1, 0.2, 0.35, 0.5  # s


def main(folder):
    script.save(figures.packing_at(haff.Case(folder), MOMENTS, width=3.8, height=1.6, across=False), "heapPoured")


if __name__ == "__main__":
    main(script.folder())
