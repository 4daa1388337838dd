# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing at five times: grains that slide in a box that stands at an angle."""
import haff
from haff.plot import figures, script

MOMENTS = 0, 0.04, 0.1, 0.2, 0.4  # s


def main(folder):
    script.save(figures.packing_at(haff.Case(folder), MOMENTS, width=9, height=3), "tiltedBox")


if __name__ == "__main__":
    main(script.folder())
