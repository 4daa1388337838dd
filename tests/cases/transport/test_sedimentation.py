# SPDX-License-Identifier: GPL-3.0-or-later
"""The column of cases/sedimentation: against the grains, against a prototype (an independent program of finite volumes with the
same closure, 100 cells; its values are in mm, mm/s), in three dimensions, and a bed that lies still."""
import re
import unittest

import numpy as np

from tests.cases import harness

from haff.layers import columns, faraday
from haff.start import enskog
from tests.cases.transport.channels import replace

NUMBER = 6 / np.pi  # grains per mm^3 and packing


class Sedimentation(harness.Folder, unittest.TestCase):
    def fall(self, T0, end):
        """{time: profile in mm, s} of the shipped case from another T (m^2/s^2)."""
        case = harness.copy("sedimentation", self.folder)
        harness.mesh(case, 100)
        replace(case, "0.orig/T", "uniform 9.81e-3", f"uniform {T0!r}")
        profiles = columns.at(harness.run(case, endTime=end, writeInterval=0.05), np.arange(0.05, end + 1e-9, 0.05))
        scale = {"y": 1e3, "alpha": 1, "U": 1e3, "T": 1e6}
        return {round(1e3 * t): {name: scale[name] * p[name] for name in scale} for t, p in profiles.items()}

    def test_expected(self):
        """Among others: nearer to the packing of 190,986 spheres than 0.06, 0.08, 0.08."""
        self.compare(self.short("sedimentation", 100, writeInterval=0.05), harness.entries("sedimentation"))

    def test_prototype(self):
        """Tolerances are what the prototype's variants of scheme and time step differ by."""
        fall = self.fall(1e-2, 0.15)
        for t, centre, near in ((50, 38.99, 0.02), (100, 16.32, 0.03), (150, 8.80, 0.03)):
            self.assertAlmostEqual(columns.centre(fall[t]), centre, delta=near)
        for t, T, y in ((50, 6117, 30), (100, 4122, 20)):
            p = fall[t]
            plateau = np.interp(y, p["y"], p["T"])
            self.assertAlmostEqual(plateau / T, 1, delta=0.005)
            self.assertAlmostEqual(plateau / (1e6 * enskog.cooled(1e-2, t / 1e3, 0.1, 0.9, 3, 1e-3)), 1, delta=0.002)
        for t, T, y in ((50, 3.50e4, 5.5), (100, 1.04e5, 13)):
            hot = np.where(fall[t]["alpha"] > 0.02, fall[t]["T"], 0)
            self.assertAlmostEqual(hot.max() / T, 1, delta=0.03)
            self.assertLess(abs(fall[t]["y"][np.argmax(hot)] - y), 1.01)
        for t, floor, near in ((50, 0.379, 0.006), (100, 0.632, 0.002)):
            self.assertAlmostEqual(fall[t]["alpha"][0], floor, delta=near)
        for t, y, flux in ((50, 14.5, -93.68), (100, 19.5, -187.33)):
            p = fall[t]
            self.assertAlmostEqual(NUMBER * np.interp(y, p["y"], p["alpha"] * p["U"]) / flux, 1, delta=0.005)

    def test_ladder(self):
        """Height of the centre of mass at 100 ms from cold and hot starts."""
        for T0, centre in ((1e-4, 15.86), (1e-3, 15.92), (4e-2, 17.04), (1e-1, 17.79), (1.0, 19.93)):
            with self.subTest(T0=T0):
                self.assertAlmostEqual(columns.centre(self.fall(T0, 0.1)[100]), centre, delta=0.04)

    def test_cold_start(self):
        """At T = 1e-8 c alone would allow a first step of 5 s. Gravity allows a fifth of the fall through a cell, on either kind of
        mesh; no step is rejected, and what the walls have not been felt by falls freely and cools by Haff's law."""
        for engine in ("lattice", "polyhedral"):
            case = harness.copy("sedimentation", self.folder)
            harness.mesh(case, 100)
            replace(case, "0.orig/T", "uniform 9.81e-3", "uniform 1e-8")
            replace(case, "system/fvSchemes", "fluxScheme  common;", f"fluxScheme  common; meshEngine {engine};")
            harness.edit(case, "system/controlDict", deltaT=1, maxDeltaT=1, endTime=0.03, writeInterval=0.03)
            said = harness.program("granularGas", "-case", case).stdout
            first = re.search(r"step 1  deltaT = (\S+) \(limited by: free fall\)", said)
            self.assertAlmostEqual(float(first.group(1)), 0.2 * np.sqrt(2e-3 / 9.81), places=8)
            self.assertNotIn("rejected", said)
            p = columns.at(case, (0.03,))[0.03]
            free = (p["y"] > 0.02) & (p["y"] < 0.08)
            np.testing.assert_allclose(p["U"][free], -9.81 * 0.03, rtol=1e-6)
            np.testing.assert_allclose(p["T"][free], enskog.cooled(1e-8, 0.03, 0.1, 0.9, 3, 1e-3), rtol=1e-3)

    def test_box(self):
        """The box of the paper, cyclic across and computed in all its cells, is the column in each of their columns, to round-off."""
        cases = [harness.copy("sedimentation", self.folder) for _ in range(2)]
        harness.mesh(cases[0], 40)
        box = cases[1]
        replace(box, "mesh.geo", "N = {100", "N = {40")
        replace(box, "system/fvSolution", "limits {", "skipUniformAxes no;\nlimits {")
        sides = ("left", "right", "front", "back")
        for field in ("alpha", "T", "U"):
            replace(box, f"0.orig/{field}", "sides        { type empty; }", '"(left|right|front|back)" { type cyclic; }')
        replace(box, "system/meshDict", "patches\n{", "patches\n{" + "".join(
            f"{a} {{ type cyclic; neighbourPatch {b}; }} {b} {{ type cyclic; neighbourPatch {a}; }}\n" for a, b in zip(sides[::2], sides[1::2])))
        harness.mesh(box, 4, "M")
        column, box = (harness.run(case, endTime=0.05, writeInterval=0.05) for case in cases)
        p, box = columns.at(column, (0.05,))[0.05], faraday.Layer(box)
        for name in ("alpha", "T"):
            values = box.field(name, "0.05")
            np.testing.assert_allclose(values, np.broadcast_to(p[name][None, :, None], values.shape), rtol=1e-9)

    def test_rest(self):
        """A bed that no impact cools carries its weight (40 cells, ten times of free fall from the lid): in the mean over time p of
        each cell is what lies above, to 1e-3 of the whole weight, in the floor's own cell, too."""
        fall = np.sqrt(2 * 0.1 / 9.81)
        for cells in (40, 80):
            case = harness.copy("sedimentation", self.folder)
            harness.mesh(case, cells)
            harness.edit(case, "constant/granularProperties", restitution=1)
            replace(case, "0.orig/T", "uniform 9.81e-3", "uniform 0.03")
            replace(case, "0.orig/alpha", "uniform 0.1;", "uniform 0.1;\nsettledLayer { depth 40; packing 0.6; hydrostatic yes; background 1e-6; }")
            layer = faraday.Layer(harness.run(case, endTime=10 * fall, writeInterval=fall))
            p = layer.profile(layer.case.times[1:])
            layers = 2600 * 9.81 * 0.1 / cells * p["alpha"]
            above = np.cumsum(layers[::-1])[::-1] - layers / 2
            miss = np.abs(p["p"] - above) / layers.sum()
            self.assertAlmostEqual(layers.sum(), 2600 * 9.81 * 0.024, delta=1e-6)
            self.assertLess(miss.max(), 1e-3, f"{cells} cells")


if __name__ == "__main__":
    unittest.main()
