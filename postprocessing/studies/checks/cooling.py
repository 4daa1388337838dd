# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of expected.json for a gas and grains that cool in the same box."""
import os

import numpy as np

from haff.paths import TOP
from studies.measured import clustering

CASES = os.path.join(TOP, "cases")


def kept_box(case):
    """The cooling box of the case, and time, impacts and energy of the grains beside it: its own, or cooling.csv of the case of the
    same name and MD."""
    path = os.path.abspath(case.path)
    name = os.path.basename(os.path.dirname(path) if os.path.basename(path) == "fromGrains" else path)
    rows = clustering.read(os.path.join(CASES, name.removesuffix("MD") + "MD"), "cooling.csv")
    return clustering.Box(path), rows


def doubled(case, *_):
    """The time at which the energy of motion is twice Haff's law."""
    box = clustering.Box(case.path)
    grains = os.path.isdir(os.path.join(case.path, "postProcessing", "grains"))
    t, T = box.totals()[::2] if grains else box.budget()
    return clustering.left(t, T, box.haff(t))


def doubled_beside(case, *_):
    """That time over the grains', less 1."""
    box, rows = kept_box(case)
    return doubled(case) / clustering.left(rows["t"], rows["T"], box.haff(rows["t"])) - 1


def cooled_beside(case, _, time):
    """Energy of motion over the grains', less 1."""
    box, rows = kept_box(case)
    return float(np.interp(float(time), *box.budget()) / clustering.at(rows, float(time))[1] - 1)


def impacts(case, _, time):
    """Of each grain of a case of grains until then."""
    return float(np.interp(float(time), *clustering.Box(case.path).totals()[:2]))


def impacts_beside(case, _, time):
    """Of each grain of the gas, by Enskog's rate, over those of the grains, less 1."""
    box, rows = kept_box(case)
    return float(np.interp(float(time), *box.impacts()) / clustering.at(rows, float(time))[0] - 1)


QUANTITIES = {
    "time at twice Haff's law": doubled,
    "time at twice Haff's law over the grains', less 1,": doubled_beside,
    "energy of motion over the grains', less 1,": cooled_beside,
    "impacts over the grains', less 1,": impacts_beside,
    "impacts of a grain": impacts,
}
