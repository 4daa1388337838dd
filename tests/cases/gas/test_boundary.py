# SPDX-License-Identifier: GPL-3.0-or-later
"""Given boundary values through the whole program: what enters a box is what the patches say."""
import itertools
import os
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes
from studies.exact.eos import GoldshteinShapiro

GAS = GoldshteinShapiro(1.0)
RHO, U, P = 200.0, (30.0, 20.0, 0.0), 900.0  # supersonic along both axes
N, SIZE = (24, 16, 1), (2.4, 1.6, 0.1)


def stream(value, low, high):
    return f"xLow {low}; {value}\nyLow {low}; {value}\nxHigh {high}\nyHigh {high}\nzEmpty empty"


class Boundary(harness.Folder, unittest.TestCase):
    def case(self, name, inside, patches, end=0.2):
        """A box of uniform gas `inside` (rho, u, p); patches of each field are given as for boxes.write_field."""
        ones = np.ones(np.prod(N))
        rho, u, p = inside
        case = harness.box_case(os.path.join(self.folder, name), N, SIZE, rho * ones, np.outer(ones, u), p * ones, end)
        for field, values in (("rho", rho * ones), ("U", np.outer(ones, u)), ("p", p * ones)):
            boxes.write_field(case, field, values, patches[field])
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def flood(self, inlet, keyword, outlet):
        return {"rho": stream(f"{keyword} uniform {RHO!r}", inlet, outlet),
                "U": stream(f"{keyword} uniform ({U[0]!r} {U[1]!r} {U[2]!r})", inlet, outlet),
                "p": stream(f"{keyword} uniform {P!r}", inlet, outlet)}

    def test_stream_fills_the_box(self):
        """A supersonic stream enters through fixedValue patches; after some crossings nothing else is left."""
        thin = (0.3 * RHO, (25.0, 15.0, 0.0), 0.2 * P)
        for inlet, keyword in (("fixedValue", "value"), ("inletOutlet", "inletValue")):
            with self.subTest(inlet):
                case = self.case(inlet, thin, self.flood(inlet, keyword, "zeroGradient"), end=0.6)
                np.testing.assert_allclose(case.field("rho"), RHO, rtol=1e-10)
                np.testing.assert_allclose(case.field("p"), P, rtol=1e-10)
                np.testing.assert_allclose(case.field("U")[:, 0], U[0], rtol=1e-10)

    def test_inlet_from_above(self):
        """inletOutlet takes the velocity across its own side: gas that comes down through it enters, though it flows along it, too."""
        rest = "xLow zeroGradient\nxHigh zeroGradient\nyLow zeroGradient\nzEmpty empty\nyHigh inletOutlet; inletValue uniform "
        patches = {"rho": f"{rest}{RHO!r}", "U": rest + "(30 -20 0)", "p": f"{rest}{P!r}"}
        case = self.case("above", (0.3 * RHO, (30.0, -20.0, 0.0), 0.2 * P), patches, end=0.03)
        np.testing.assert_allclose(case.field("rho").reshape(N[1], N[0])[-1], RHO, rtol=1e-3)

    def test_outlet_lets_go(self):
        """inletOutlet where the gas leaves: its value does not matter, to the bit."""
        results = []
        for value in (1.0, 900.0):
            patches = self.flood("fixedValue", "value", "zeroGradient")
            for field in ("rho", "p"):
                patches[field] = patches[field].replace("xHigh zeroGradient",
                                                        f"xHigh inletOutlet; inletValue uniform {value!r}")
            results.append(self.case(f"outlet{value:g}", (RHO, U, 1.3 * P), patches, end=0.02))
        for field in ("rho", "U", "p"):
            np.testing.assert_array_equal(results[0].field(field), results[1].field(field))

    def test_outlet_lets_heat_go(self):
        """The same in a gas with transport that cools while it flows out: outlets of U, p and rho beside zeroGradient, on a lattice
        and on polyhedra, with explicit and with implicit diffusion."""
        n, size = (24, 4, 1), (2.4, 0.4, 0.1)
        x = boxes.centres(n, size)[:, 0]
        rho, u = 60 - 10 * x, np.stack([3 * x, 0 * x, 0 * x], axis=1)
        for engine, diffusion in itertools.product(("", "; meshEngine polyhedral"), ("RKJ2", "implicit")):
            results = []
            for outlet in ("zeroGradient", "inletOutlet; inletValue uniform %s"):
                name = f"heat{len(engine)}{diffusion}{len(outlet)}"
                case = harness.box_case(os.path.join(self.folder, name), n, size, rho, u, 300 - 100 * x, 0.02,
                                        eos="TorquatoDisks", e=0.8, gamma=2.0, cooling="GarzoDufty")
                harness.edit(case, "constant/granularProperties", transport="JenkinsRichman", diameter="0.02")
                harness.edit(case, "system/fvSchemes", reconstruct="PHM" + engine)
                harness.write_dictionary(case, "system", "fvSolution", "diffusion { type %s; }\n" % diffusion)
                for field, inside, value in (("rho", rho, "1"), ("U", u, "(3 0 0)"), ("p", 300 - 100 * x, "9000")):
                    wall = "slip" if field == "U" else "zeroGradient"
                    boxes.write_field(case, field, inside, f"xLow fixedValue; value uniform {value}\n"
                                      f"xHigh {outlet.replace('%s', value)}\nyLow slip\nyHigh slip\nzEmpty empty")
                harness.program("granularGas", "-case", case)
                results.append(harness.haff.Case(case))
            for field in ("rho", "U", "T"):
                with self.subTest(f"{field}, {diffusion}{engine}"):
                    first, second = (case.field(field) for case in results)
                    np.testing.assert_allclose(first, second, rtol=0, atol=1e-9 * np.abs(first).max())

    def test_values_per_face(self):
        """A jet: the density at the inlet differs from face to face and is carried along the rows."""
        profile = RHO * (1 + 0.5 * (np.arange(N[1]) >= 8))
        listing = f"nonuniform List<scalar> {N[1]} ({' '.join('%.17g' % v for v in profile)})"
        sides = "\nxHigh zeroGradient\nyLow slip\nyHigh slip\nzEmpty empty"
        scalar = sides.replace("slip", "zeroGradient")
        patches = {"rho": f"xLow fixedValue; value {listing}" + scalar,
                   "U": "xLow fixedValue; value uniform (30 0 0)" + sides,
                   "p": f"xLow fixedValue; value uniform {P!r}" + scalar}
        case = self.case("jet", (RHO, (30.0, 0.0, 0.0), P), patches, end=0.3)
        rho = case.field("rho").reshape(N[1], N[0])
        # a contact along the stream, p and u the same on both sides, stays where it is
        np.testing.assert_allclose(rho, np.broadcast_to(profile[:, None], rho.shape), rtol=1e-12)


if __name__ == "__main__":
    unittest.main()
