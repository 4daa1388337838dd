# SPDX-License-Identifier: GPL-3.0-or-later
"""Half of the silo at five times: packing; prints the flow of each span between two times that were written."""
import sys

import haff
from haff.plot import figures, script
from studies.checks import heaps

MOMENTS = 0, 0.02, 0.04, 0.06, 0.1  # s


def main(folder):
    case = haff.Case(folder)
    for before, time in zip(case.times, case.times[1:]):
        flow = heaps.round_outflow(case, None, time, float(time) - float(before))
        print(f"{time} s: {1e9 * flow:.0f} mm^3/s", file=sys.stderr)
    script.save(figures.packing_at(case, MOMENTS, width=8, height=3.4), "siloRound")


if __name__ == "__main__":
    main(script.folder())
