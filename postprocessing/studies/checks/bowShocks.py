# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of cases/cylinderDisks: the bow shock ahead of a cylinder in a stream of disks, and its drag, of gas and of grains."""
import os
import re

import numpy as np

import haff
from studies.checks import grainCases
from studies.exact import diskShocks

RADIUS, STREAM, T = 200.0, 0.05, 0.02546558323  # diameters, packing and T of the stream, whose speed is 1
SECTOR, WIDTH, WINDOW = 15.0, 12.0, 1000.0  # degrees from the axis; diameters of a shell; time of the grains' means


def profile(case, field, time):
    """Distance of shells from the nose, in radii, and the mean of a field in each, within SECTOR of the axis; T by the mass."""
    x, y = case.centres[:, 0], case.centres[:, 1]
    r, angle = np.hypot(x, y), np.degrees(np.arctan2(y, -x))
    inside = (angle < SECTOR) & (r < 2.7 * RADIUS)
    k = ((r - RADIUS) / WIDTH).astype(int)[inside]
    weight = (case.volumes * (1 if field == "alpha" else case.field("alpha", time)))[inside]
    values = case.field(field, time)[inside]
    return (np.arange(k.max() + 1) + 0.5) * WIDTH / RADIUS, np.bincount(k, weight * values) / np.bincount(k, weight)


def level():
    """Half way between the packing of the stream and that behind a normal shock of elastic disks."""
    return 0.5 * (STREAM + diskShocks.normal(STREAM, T)[0])


def stand_off(case, field, time):
    """Distance of the shock from the nose over the radius: the outermost place where packing passes the level."""
    r, alpha = profile(case, "alpha", time)
    last = np.flatnonzero(alpha >= level())[-1]
    return float(np.interp(-level(), -alpha[last:last + 2], r[last:last + 2]))


def drag(case, field, time):
    """Coefficient of the half cylinder in front: force along x over rho U^2/2 and its height, mean over the last quarter of the run."""
    begin, scale = 0.75 * float(time), 0.5 * STREAM / (np.pi / 4) * RADIUS
    if os.path.exists(os.path.join(case.path, "postProcessing", "grains")):  # all impulses; `forces` has those of the steps that end at its times
        table = grainCases.table_of(case.path)
        late = table["Time"] >= begin
        t, impulse = table["Time"][late], table["impulse_wall_x"][late]
        return float((impulse[-1] - impulse[0]) / (t[-1] - t[0]) / scale)
    with open(os.path.join(case.path, "postProcessing", "drag", "0", "force.dat")) as f:
        depth = float(re.search(r"thickness\s*:\s*(\S+)", f.read())[1])
    table = case.table("drag", "force.dat")
    return float(table[table[:, 0] >= begin, 1].mean() / depth / scale)


def beside(case, _, time):
    """Stand-off of the gas, mean of the ends of the grains' window, less that of the grains beside it."""
    name = {"elastic": "../grainsElastic"}.get(os.path.basename(os.path.abspath(case.path)), "grains")
    gas = 0.5 * (stand_off(case, _, float(time) - WINDOW) + stand_off(case, _, time))
    return gas - stand_off(haff.Case(os.path.join(case.path, name)), _, time)


QUANTITIES = {
    "stand-off over the radius": stand_off,
    "stand-off less that of the grains, over the radius": beside,
    "drag coefficient": drag,
}
