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
    """That column of a row, by its number, of table/faradayDiagram.csv that cases/faradaySweep makes; a wavelength only where a wave stands."""
    def value(case, _, time, number):
        with open(os.path.join(case.path, "table", "faradayDiagram.csv"), newline="") as f:
            row = next((row for row in csv.DictReader(f) if int(row["row"]) == number), None)
        if row is None or (column == "wavelength" and row["state"] != "stands"):
            raise ValueError(f"row {number} of the sweep " + (f"has no standing wave: {row['state']}" if row else "was not run"))
        return float(row[column])
    return value


QUANTITIES = {
    "difference to the grains": difference_to_grains,
    "wavelength in a row of the sweep": swept("wavelength"),
    "growth a period in a row of the sweep": swept("growth"),
    "amplitude in a row of the sweep": swept("amplitude"),
}
