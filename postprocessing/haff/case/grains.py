# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the cloud of grains that granularMD writes beside the fields: TIME/lagrangian/grains. Needs numpy only.

    cloud = grains.read(haff.Case("cases/faradayMD"), "20")
    cloud["x"], cloud["U"], cloud["id"], cloud["d"], cloud["cell"]    # [n][3], [n][3], [n], [n], [n]; of a mixture also cloud["species"]
"""
import os

import numpy as np

from haff.case.foam import FoamFile, FormatError, text_numbers

KINDS = {"vectorField": 3, "scalarField": 1, "labelField": 1}


def folder(case, time):
    return os.path.join(case.path, time if isinstance(time, str) else case.time(time), "lagrangian", "grains")


def positions(path):
    """Places [n][3] and cells [n]: lines (x y z) cell."""
    f = FoamFile(path)
    if not f.header.get("class", "").startswith("Cloud"):
        raise FormatError(f"{path}: class {f.header.get('class')} is no cloud")
    values = text_numbers(f.body, float, path)
    if not len(values) or len(values) != 1 + 4 * values[0]:
        raise FormatError(f"{path}: {max(len(values) - 1, 0)} numbers for {values[0] if len(values) else 0:g} grains; 4 each are expected")
    rows = values[1:].reshape(-1, 4)
    return rows[:, :3], rows[:, 3].astype(int)


def places(case, time):
    return positions(os.path.join(folder(case, time), "positions"))[0]


def read(case, time):
    """{"x", "cell" and every field of the cloud}."""
    where = folder(case, time)
    x, cell = positions(os.path.join(where, "positions"))
    found = {"x": x, "cell": cell}
    for name in sorted({n.removesuffix(".gz") for n in os.listdir(where)} - {"positions"}):
        f = FoamFile(os.path.join(where, name))
        if f.header.get("class") in KINDS:
            kind = f.label if f.header["class"] == "labelField" else f.scalar
            found[name] = f.numbers(0, KINDS[f.header["class"]], kind)[0]
            if len(found[name]) != len(x):
                raise FormatError(f"{f.path}: {len(found[name])} values for {len(x)} grains")
    return found
