# SPDX-License-Identifier: GPL-3.0-or-later
"""A strong shock that stands along a line of the mesh stays straight and in its place with the defaults (Quirk 1994)."""
import os
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import boxes

CELLS, GAMMA = (40, 20, 1), 5 / 3


class Standing(harness.Folder, unittest.TestCase):
    def bend(self, name, mach, noise, crossings, engine="lattice", **options):
        """Speed along the front over that of the stream, and the places of the front over the channel, in cells from its start. Noise
        is in the gas before the shock; both ends hold the exact states, without which the shock may drift as a whole."""
        ahead = {"rho": 1.0, "U": mach, "p": 1 / GAMMA}
        denser = (GAMMA + 1) * mach**2 / ((GAMMA - 1) * mach**2 + 2)
        behind = {"rho": denser, "U": mach / denser, "p": ahead["p"] * (2 * GAMMA * mach**2 - GAMMA + 1) / (GAMMA + 1)}
        size = (1.0, 0.5, 0.025)
        x = boxes.centres(CELLS, size)[:, 0]
        random = np.random.default_rng(7)
        start = {k: np.where(x < 0.5, ahead[k] * (1 + noise * random.uniform(-1, 1, len(x))), behind[k]) for k in ahead}
        across = np.where(x < 0.5, noise * mach * random.uniform(-1, 1, len(x)), 0)
        start["U"] = np.stack([start["U"], across, 0 * x], axis=1)
        case = harness.box_case(os.path.join(self.folder, name), CELLS, size, start["rho"], start["U"], start["p"], crossings / mach,
                                **{"types": {"y": "cyclic"}, "cooling": "none", "eos": "perfectGas", "reconstruct": "WPENO5", **options})
        for field in start:
            show = lambda v: f"uniform ({v!r} 0 0)" if field == "U" else f"uniform {v!r}"
            boxes.write_field(case, field, start[field], f"xLow fixedValue; value {show(ahead[field])}\n"
                              f"xHigh fixedValue; value {show(behind[field])}\nyLow cyclic\nyHigh cyclic\nzEmpty empty")
        runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        result = harness.run(case)
        p = result.field("p").reshape(CELLS[1], CELLS[0])
        middle = (ahead["p"] + behind["p"]) / 2
        at = np.argmax(p > middle, axis=1)
        low, high = (p[np.arange(len(p)), i] for i in (at - 1, at))
        place = at - 0.5 + (middle - low) / (high - low) - CELLS[0] / 2
        return np.abs(result.field("U")[:, 1]).max() / mach, place

    def stands(self, *arguments, straight=1e-2, **options):
        across, place = self.bend(*arguments, **options)
        self.assertLess(across, straight)
        self.assertLess(np.abs(place).max(), 0.5)

    def test_perfect(self):
        """Without fronts these are broken: across 0.2 to 0.6, the front over 6 to 28 cells."""
        self.stands("noise", 6.0, 1e-3, 10)
        self.stands("quiet", 3.0, 1e-6, 15)
        self.stands("quads", 20.0, 1e-3, 8, "polyhedral", straight=5e-2)  # noise of the polynomials at the front remains


if __name__ == "__main__":
    unittest.main()
