# SPDX-License-Identifier: GPL-3.0-or-later
"""Conditions of OpenFOAM on patches as those of haff: each type, entries by groups and patterns, tables in time; checkCase takes them."""
import os
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.openfoam import foam

from haff.case import entries
from haff.openfoam import fromOpenFOAM, patches, setFields, values
from haff.openfoam.report import Refused, Report
from studies.made import rhocentral

R = rhocentral.UNIVERSAL / 28.96
OUT = "outlet { type zeroGradient; }"


def numbers(text):
    return [float(word) for word in text.replace("(", " ").replace(")", " ").split() if word not in ("uniform", "table")]


class Patches(harness.Folder, unittest.TestCase):
    count = 0

    def convert(self, blocks=foam.BLOCKS, **sides):
        """The folder of the new case, which checkCase takes, and what was said."""
        type(self).count += 1
        folder = os.path.join(self.folder, str(self.count))
        case = foam.write(folder, blocks, **sides)
        report, warnings = fromOpenFOAM.convert(case, os.path.join(folder, "haff"))
        self.assertEqual(warnings, [])
        return os.path.join(folder, "haff"), report.text()

    def inlet(self, U, p, T, energy="T", outlet=OUT):
        """{field: {key: value}} of the inlet."""
        new, said = self.convert(U=f"inlet {{ {U} }} {outlet}", p=f"inlet {{ {p} }} {outlet}", T=f"inlet {{ {T} }} {outlet}")
        self.assertEqual(os.path.exists(os.path.join(new, "0.orig", "T")), energy == "T")
        found = {}
        for name in ("U", "rho", energy):
            text = entries.get(os.path.join(new, "0.orig", name), "boundaryField/inlet")
            found[name] = {e.path[-1]: text[slice(*e.value)] for e in entries.parse(text)}
        return found, said

    def close(self, text, *wanted):
        np.testing.assert_allclose(numbers(text), wanted, rtol=1e-14)

    def test_all_given(self):
        found, _ = self.inlet("type fixedValue; value uniform (300 0 0);", "type fixedValue; value uniform 2e5;", "type fixedValue; value uniform 400;")
        self.close(found["U"]["value"], 300, 0, 0)
        self.close(found["rho"]["value"], 2e5 / (R * 400))
        self.close(found["T"]["value"], R * 400)

    def test_streams_from_far(self):
        for U, p, T in (("type supersonicFreestream; pInf 2e5; TInf 400; UInf (900 0 0); gamma 1.4;", "type zeroGradient;", "type zeroGradient;"),
                        ("type freestreamVelocity; freestreamValue uniform (900 0 0);", "type freestreamPressure; freestreamValue uniform 2e5;",
                         "type freestream; freestreamValue uniform 400;")):
            with self.subTest(U):
                found, said = self.inlet(U, p, T)
                self.close(found["U"]["value"], 900, 0, 0)
                self.close(found["rho"]["value"], 2e5 / (R * 400))
                self.close(found["T"]["value"], R * 400)
                self.assertIn("-> fixedValue", said)

    def test_one_of_p_and_T(self):
        """What one of both gives: rho is free where the other is, so that haff has the pair that can say it."""
        found, said = self.inlet("type fixedValue; value uniform (50 0 0);", "type zeroGradient;", "type fixedValue; value uniform 400;")
        self.assertEqual(found["rho"]["type"], "zeroGradient")
        self.close(found["T"]["value"], R * 400)
        self.assertIn("p free and T given -> rho free and T given", said)
        found, said = self.inlet("type pressureInletOutletVelocity; value uniform (0 0 0);", "type fixedValue; value uniform 2e5;", "type zeroGradient;", "p")
        self.assertEqual((found["U"]["type"], found["rho"]["type"]), ("zeroGradient", "zeroGradient"))
        self.close(found["p"]["value"], 2e5)
        found, said = self.inlet("type zeroGradient;", "type fixedValue; value uniform 2e5;", "type inletOutlet; inletValue uniform 400;", "p")
        self.assertEqual(found["rho"]["type"], "inletOutlet")
        self.close(found["rho"]["inletValue"], 2e5 / (R * 400))

    def test_both_in_a_case(self):
        """An inlet of given T and an outlet of given p: rho at the inlet by the p inside, for only one of T and p can be there."""
        case = {"U": "inlet { type fixedValue; value uniform (50 0 0); } outlet { type zeroGradient; }",
                "p": "inlet { type zeroGradient; } outlet { type fixedValue; value uniform 1e5; }",
                "T": "inlet { type fixedValue; value uniform 400; } outlet { type inletOutlet; inletValue uniform 300; }"}
        new, said = self.convert(**case)
        self.close(entries.get(os.path.join(new, "0.orig", "rho"), "boundaryField/inlet/value"), 1e5 / (R * 400))
        self.assertEqual(entries.get(os.path.join(new, "0.orig", "p"), "boundaryField/inlet/type"), "zeroGradient")
        self.assertIn("inlet: p is free and the other is not", said)

    def test_open_sides(self):
        found, said = self.inlet("type inletOutlet; inletValue uniform (50 0 0); value uniform (50 0 0);", "type waveTransmissive; fieldInf 1e5; lInf 1;",
                                 "type inletOutlet; inletValue uniform 400; value uniform 400;")
        self.close(found["U"]["inletValue"], 50, 0, 0)
        self.close(found["rho"]["inletValue"], 1e5 / (R * 400))
        self.close(found["T"]["inletValue"], R * 400)
        self.assertIn("waves leave; fieldInf is not held", said)

    def test_reservoir(self):
        found, said = self.inlet("type pressureInletVelocity; value uniform (0 0 0);", "type totalPressure; p0 uniform 2e5; gamma 1.4;",
                                 "type totalTemperature; T0 uniform 400; gamma 1.4;")
        self.close(found["U"]["value"], 0, 0, 0)
        self.close(found["rho"]["value"], 2e5 / (R * 400))
        self.assertIn("gas at rest beyond the patch", said)
        self.assertIn("acceptWarnings openSide", said)

    def test_flow_rates(self):
        found, _ = self.inlet("type flowRateInletVelocity; massFlowRate constant 0.5; value uniform (0 0 0);", "type zeroGradient;",
                              "type fixedValue; value uniform 400;")
        self.assertEqual((found["U"]["massFlowRate"], found["rho"]["type"]), ("0.5", "zeroGradient"))
        found, said = self.inlet("type flowRateInletVelocity; volumetricFlowRate table ((0 0.1) (1 0.2)); value uniform (0 0 0);", "type zeroGradient;",
                                 "type fixedValue; value uniform 400;")
        self.close(found["U"]["volumetricFlowRate"], 0, 0.1, 1, 0.2)
        self.close(found["rho"]["value"], 1e5 / (R * 400))

    def test_tables(self):
        """rho is p/(R T) at the knots of both."""
        found, _ = self.inlet("type fixedValue; value uniform (50 0 0);", "type uniformFixedValue; uniformValue table ((0 1e5) (2 3e5));",
                              "type uniformFixedValue; uniformValue table ((1 400) (2 300));")
        self.close(found["rho"]["uniformValue"], 0, 1e5 / (R * 400), 1, 2e5 / (R * 400), 2, 3e5 / (R * 300))
        self.close(found["T"]["uniformValue"], 1, R * 400, 2, R * 300)

    def test_walls(self):
        """Gas without viscosity slips; a velocity that leads through a patch of type wall makes it open."""
        for wall, kind in (("type noSlip;", "slip"), ("type fixedValue; value uniform (0 0 0);", "slip"), ("type fixedValue; value uniform (0 3 0);", "slip"),
                           ("type fixedValue; value uniform (50 0 0);", "fixedValue")):
            with self.subTest(wall):
                free = "inlet { type zeroGradient; } outlet { type zeroGradient; }"
                new, said = self.convert(foam.BLOCKS.replace("inlet { type patch", "inlet { type wall"), U=f"inlet {{ {wall} }} {OUT}", p=free,
                                         T=f"inlet {{ type fixedValue; value uniform 400; }} {OUT}")
                self.assertEqual(entries.get(os.path.join(new, "0.orig", "U"), "boundaryField/inlet/type"), kind)
                self.assertEqual("type wall -> patch" in said, kind == "fixedValue")

    def test_groups_and_patterns(self):
        """A name goes before a group, a group before a pattern, the last pattern before the others; mirrors need no entry."""
        blocks = foam.BLOCKS.replace("inlet { type patch;", "inlet { type patch; inGroups (near open);")
        blocks = blocks.replace("outlet { type patch;", "outlet { type symmetryPlane;")
        value = lambda v: f"{{ type fixedValue; value uniform {v}; }}"
        for sides, wanted in ((f'".*" {value(1)} "in.*" {value(2)}', 2), (f'near {value(3)} "in.*" {value(2)}', 3), (f"inlet {value(4)} near {value(3)}", 4),
                              (f"open {value(7)} near {value(3)}", 3), (f"near {value(3)} open {value(7)}", 7),
                              (f'"(inlet|outlet)" {value(5)} "x.*" {value(6)}', 5)):
            with self.subTest(sides):
                new, _ = self.convert(blocks, T=sides, U="inlet { type zeroGradient; }", p=f"inlet {value('1e5')}")
                self.close(entries.get(os.path.join(new, "0.orig", "T"), "boundaryField/inlet/value"), R * wanted)
                self.assertEqual(entries.get(os.path.join(new, "0.orig", "T"), "boundaryField/outlet/type"), "symmetryPlane")

    def test_beside_cells(self):
        """Where p is free and T is not, rho beyond a patch is by the p of the cells beside that patch."""
        case = foam.tube(os.path.join(self.folder, "tube"))
        foam.field(case, "T", '".*" { type inletOutlet; inletValue uniform 400; }', "uniform 1", "0.orig")
        fromOpenFOAM.convert(case, os.path.join(self.folder, "tube", "haff"))
        for patch, p in (("inlet", 1e5), ("outlet", 1e4)):
            self.close(entries.get(os.path.join(self.folder, "tube", "haff", "0.orig", "rho"), f"boundaryField/{patch}/inletValue"), p / (R * 400))

    def test_lists(self):
        """A list of faces; a normal velocity."""
        found, said = self.inlet("type surfaceNormalFixedValue; refValue uniform -50;", "type fixedValue; value nonuniform List<scalar> 1(2e5);",
                                 "type fixedValue; value uniform 400;")
        self.close(found["U"]["value"], 50, 0, 0)
        self.close(found["rho"]["value"], 2e5 / (R * 400))


class Parts(unittest.TestCase):
    """Without a case."""

    def test_combined(self):
        table = values.Series([0, 1], [1, 2])
        both = values.combined(table, np.array([2.0]), lambda a, b: a / b)
        np.testing.assert_allclose((both.times, both.values), ((0, 1), (0.5, 1)))
        with self.assertRaisesRegex(Refused, "cannot be combined"):
            values.combined(table, np.ones((4, 1)), lambda a, b: a)

    def test_shapes(self):
        """Centres in a box, a sphere, a cylinder; the ends belong to them."""
        at = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 2, 0]], float)
        shape = lambda kind, **entries_of: setFields.SHAPES[kind](Entries(entries_of), at).tolist()
        self.assertEqual(shape("boxToCell", box="(0 0 0) (1 1 1)"), [True, True, False, False])
        self.assertEqual(shape("boxToCell", boxes="((0 0 0) (0 1 1) (2 0 0) (3 1 1))"), [True, False, True, False])
        self.assertEqual(shape("sphereToCell", centre="(0 0 0)", radius="1"), [True, True, False, False])
        self.assertEqual(shape("cylinderToCell", p1="(-1 0 0)", p2="(1.5 0 0)", radius="1"), [True, True, False, False])

    def test_no_numbers(self):
        """An entry of setFieldsDict that is no number is refused with file and line."""
        good = """defaultFieldValues
(
    volScalarFieldValue T 300
);
regions
(
    sphereToCell
    {
        origin (0 0 0);
        radius 2;
        fieldValues
        (
            volScalarFieldValue T 240.5
            volVectorFieldValue U (1 0 0)
        );
    }
    boxToCell { box (0 0 0) (1 1 1); fieldValues ( volScalarFieldValue T 7 ); }
);
"""
        at, T = np.zeros((1, 3)), np.zeros((1, 1))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "setFieldsDict")
            for word, line in ((None, 0), ("300", 3), ("0 0 0);\n        radius", 9), ("2;", 10), ("240.5", 13), ("1 0 0)\n", 14), ("1 1 1", 17), ("7", 17)):
                with open(path, "w") as f:
                    f.write(good.replace(word, "x" + word, 1) if word else good)
                if not word:
                    setFields.apply(path, folder, {"T": T, "U": np.zeros((1, 3))}, at, Report())
                    self.assertEqual(T[0, 0], 7)
                    continue
                with self.subTest(word), self.assertRaisesRegex(Refused, rf"^setFieldsDict:{line}: 'x[\d.]+': a number was expected$"):
                    setFields.apply(path, folder, {"T": T, "U": np.zeros((1, 3))}, at, Report())

    def test_every_type_is_one_thing(self):
        """No type stands in two tables."""
        for tables in ((patches.GIVEN, patches.TOTAL, patches.TURNING, patches.FREE), (patches.WALLS, patches.STREAMS, patches.DRIVEN)):
            names = [name for table in tables for name in table]
            self.assertEqual(len(names), len(set(names)))

    def test_report(self):
        report = Report()
        for _ in range(2):
            report.took("0/U:3", "it")
        self.assertEqual(report.text(), "took     0/U:3: it\n")


class Entries(dict):
    place = "here"


if __name__ == "__main__":
    unittest.main()
