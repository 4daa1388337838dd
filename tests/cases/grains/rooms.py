#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pressure of disks in equilibrium on every side of an irregular room with a round pillar in it, beside the equation of state.

    python3 tests/cases/grains/rooms.py [ALPHA [TIME]]         # 0.2, 16000; an installation or a build stands in HAFF_BIN

Each side's impulse over time and over the length that contacts have (a radius less at each corner, along the bisector) is divided by n T Z of Henderson (1975), with n and T of the grains more than 2.5 diameters from walls. The excess falls with the length of the side: the last line is a fit of 1 + b/length. Errors are standard errors of 20 pieces of the run."""
import os
import re
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))
from tests.cases import harness  # noqa: E402
from tests.cases.grains import test_walls as walls  # noqa: E402

CORNERS = 2 * np.array([(0, 0), (18, -2), (24, 9), (10, 16), (-2, 8)], dtype=float)
PILLAR, RADIUS, D = (20, 12), 5, 0.8


def geometry():
    n = len(CORNERS)
    lines = [f"Point({i + 1}) = {{{x}, {y}, 0, 1.5}};" for i, (x, y) in enumerate(CORNERS)]
    lines += [f"Line({i + 1}) = {{{i + 1}, {(i + 1) % n + 1}}}; Physical Curve(\"side{i}\") = {{{i + 1}}};" for i in range(n)]
    x, y = PILLAR
    lines += [f"Point(11) = {{{x}, {y}, 0, 1}}; Point(12) = {{{x + RADIUS}, {y}, 0, 1}}; Point(13) = {{{x - RADIUS}, {y}, 0, 1}};",
              "Circle(11) = {12, 11, 13}; Circle(12) = {13, 11, 12};", f"Curve Loop(1) = {{1:{n}}}; Curve Loop(2) = {{11, 12}};",
              'Plane Surface(1) = {1, 2}; Physical Curve("pillar") = {11, 12}; Physical Surface("gas") = {1};']
    return "\n".join(lines) + "\n"


def sides():
    """Inward normals, and lengths of the sides on which centres come to contact."""
    along = np.roll(CORNERS, -1, axis=0) - CORNERS
    length = np.hypot(*along.T)
    along /= length[:, None]
    before = np.roll(along, 1, axis=0)
    turn = np.arctan2(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0], (before * along).sum(axis=1))
    lost = D / 2 * np.tan(turn / 2)
    return np.stack([-along[:, 1], along[:, 0]], axis=1), length - lost - np.roll(lost, -1)


def measure(alpha, end):
    normal, length = sides()
    with tempfile.TemporaryDirectory() as folder:
        case = os.path.join(folder, "room")
        os.makedirs(case)
        with open(os.path.join(case, "mesh.geo"), "w") as f:
            f.write(geometry())
        walls.make(case, geometry(), alpha=alpha, end=end, interval=end, d=D, more=f"maxDeltaT {end / 20};\n", particles=f"coarseGraining {{ samples {end}; }}\n")
        walls.solve(case)
        found = harness.haff.Case(case)
        with open(os.path.join(case, "postProcessing", "grains", "0", "grains.dat")) as f:
            names = [line for line in f if line.startswith("# Time")][0].split()[1:]
        rows = found.table("grains", "grains.dat")
        field = {name: found.field(name, str(end)) for name in ("alpha", "T")}
        x, volume = found.centres[:, :2], found.volumes
    far = np.hypot(*(x - PILLAR).T) - RADIUS
    for corner, n in zip(CORNERS, normal):
        far = np.minimum(far, (x - corner) @ n)
    inner = far > 2.5 * D
    nu = np.average(field["alpha"][inner], weights=volume[inner])
    T = np.average(field["T"][inner], weights=(field["alpha"] * volume)[inner])
    state = nu / (np.pi / 4 * D**2) * T * (1 + nu**2 / 8) / (1 - nu) ** 2
    print(f"packing {nu:.5f}, T {T:.5f} far from walls, pressure by the equation of state {state:.5f}, wall impacts {rows[-1, names.index('wallCollisions')]:.0f}")
    found = []
    for i in range(len(CORNERS)):
        impulse = -(rows[:, [names.index(f"impulse_side{i}_{a}") for a in "xy"]] @ normal[i])
        part = np.diff(impulse) / np.diff(rows[:, 0]) / length[i] / state
        found.append((part.mean(), part.std(ddof=1) / np.sqrt(len(part))))
        print(f"side{i}, {length[i]:.1f} long: pressure over it {found[i][0]:.4f} +- {found[i][1]:.4f}")
    mean, error = np.array(found).T
    (b, far), spread = np.polyfit(1 / length, mean, 1, w=1 / error, cov="unscaled")
    print(f"far from corners: {far:.4f} +- {np.sqrt(spread[1, 1]):.4f}, with {b:.3f}/length more")


if __name__ == "__main__":
    measure(float(sys.argv[1]) if len(sys.argv) > 1 else 0.2, int(sys.argv[2]) if len(sys.argv) > 2 else 16000)
