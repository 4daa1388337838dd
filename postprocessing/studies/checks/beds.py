# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for beds of grains beside the gas, and for the rows of cases/faradaySweep."""
import csv
import os

from haff.layers import columns, faraday
from haff.paths import TOP

CASES = os.path.join(TOP, "cases")


def row_of(case, time):
    """Profile over the height at that time, and of the grains of the case of the same name and MD, profiles.csv, which is
    of the same time or phase of the shaking."""
    layer = faraday.Layer(case)
    grains = columns.read(os.path.join(CASES, os.path.basename(os.path.abspath(case.path)) + "MD", "profiles.csv"))
    moment = float(time) * layer.frequency % 1 if hasattr(layer, "frequency") else float(time)
    return columns.profile(layer, time), grains[min(grains, key=lambda m: abs(m - moment))]


def difference_to_grains(case, field, time, raised=0.0):
    """L1, relative, over cells where there are grains; field: of the profile, or energy; raised: how far the gas is lifted (m)."""
    return float(columns.difference(*row_of(case, time), columns.energy if field == "energy" else field, raised))


def swept(column):
    """From rows of table/faradayDiagram.csv that cases/faradaySweep makes: a function of the list of that column."""
    def take(function):
        def value(case, _, time):
            with open(os.path.join(case.path, "table", "faradayDiagram.csv"), newline="") as f:
                return float(function([row[column] for row in csv.DictReader(f)]))
        return value
    return take


QUANTITIES = {
    "difference to the grains": difference_to_grains,
    "rows with a standing wave": swept("state")(lambda states: states.count("stands")),
    "standing waves within 20 % of the paper's": swept("within20")(lambda answers: answers.count("yes")),
}
