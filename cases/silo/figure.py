# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing at five times: grains that run out of a silo."""
import haff
from haff.plot import figures, script

MOMENTS = 0, 0.04, 0.08, 0.12, 0.16  # s


def main(folder):
    script.save(figures.packing_at(haff.Case(folder), MOMENTS, width=9, height=3), "silo")


if __name__ == "__main__":
    main(script.folder())
