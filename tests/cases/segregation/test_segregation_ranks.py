# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures on ranks: each has a slab of a lattice, with the bytes of one rank, and a share of the memory."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.segregation import mixtures
from tests.cases.segregation.test_segregation_flow import laws

CONTROL = "system/controlDict"
OBJECTS = """functions
{
    mean { type volFieldValue; fields (phi U percolation diffusivity); operation volAverage; writeControl timeStep; writeInterval 1; }
    ends { type fieldMinMax; fields (phi U diffusivity); writeControl timeStep; writeInterval 1; }
    line { type probes; fields (phi U); probeLocations ((0.31 0.21 0.05) (0.01 0.007 0.001)); allowOutside yes;
           writeControl timeStep; writeInterval 1; }
}
"""
BOXES = """scale 1;
vertices ((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 0.1) (1 0 0.1) (1 1 0.1) (0 1 0.1));
blocks (hex (0 1 2 3 4 5 6 7) (%d %d 1) simpleGrading (1 1 1));
boundary
(
    inlet { type patch; faces ((0 4 7 3)); }
    outlet { type patch; faces ((1 2 6 5)); }
    walls { type wall; faces ((0 1 5 4) (3 7 6 2)); }
    ends { type empty; faces ((0 3 2 1) (4 5 6 7)); }
);
"""
START = """dimensions [%s];
expression %s;
internalField uniform %s;
boundaryField { inlet { type fixedValue; value uniform %s; } outlet { type zeroGradient; } walls { type %s; } ends { type empty; } }
"""


class Ranks(mixtures.Mixture, unittest.TestCase):
    def compare(self, case, ranks):
        """All that one rank and several write is the same."""
        copies = {count: shutil.copytree(case, f"{case}_{count}/case") for count in ranks}
        runs.add(case, CONTROL, OBJECTS)
        self.run_case(case)
        reference = runs.results(case)
        self.assertTrue(any(name.endswith("volFieldValue.dat") for name in reference))
        for count, copy in copies.items():
            with self.subTest(ranks=count):
                runs.add(copy, CONTROL, OBJECTS)
                log = self.run_case(copy, ranks=count)
                self.assertRegex(log, rf"{count} ranks(.|\n)*each has a slab of \d+ to \d+ layers along [yz]")
                runs.same(self, reference, runs.results(copy))

    def boxes(self, n, **control):
        """A mesh that is said by boxes: no rank has tables of it."""
        case = self.chute(4)
        shutil.rmtree(case + "/constant/polyMesh")
        for name in ("mesh.geo", "mesh.msh"):
            os.remove(os.path.join(case, name))
        harness.write_dictionary(case, "system", "blockMeshDict", BOXES % n)
        harness.write_dictionary(case, "constant", "segregationProperties", laws(-0.5, 1e-3))
        fields = (("phi", "volScalarField", ("0 0 0 0 0 0 0", '"0.5 + 0.4*sin(20*x)*cos(14*y)"', "0.5", "0.3", "noFlux")),
                  ("U", "volVectorField", ("0 1 -1 0 0 0 0", '("1 + 0.3*sin(6*y)*sin(3*x)" "0.2*x*(1 - x)*sin(3*y)" "0")', "(1 0 0)",
                                           "(1 0 0)", "slip")))
        for name, kind, values in fields:
            with open(f"{case}/0.orig/{name}", "w") as f:
                f.write(harness.boxes.header(kind, name, "0") + START % values)
        harness.edit(case, CONTROL, **{"endTime": 0.004, "deltaT": 1e-3, "writeInterval": 0.002, **control})
        return case

    def test_boxes(self):
        self.compare(self.boxes((61, 45), adjustTimeStep="no"), (3,))
        self.compare(self.boxes((20, 7), adjustTimeStep="yes", writeFormat="ascii"), (4,))

    def test_chute(self):
        """A polyMesh, open patches, a law of phi and of the shear rate, which every rank computes of all of U."""
        case = self.chute(12, endTime=0.04, deltaT=5e-3, writeInterval=0.02)
        with open(case + "/constant/segregationProperties") as f:
            text = f.read()
        harness.edit(case, CONTROL, writeFormat="binary")
        self.compare(shutil.copytree(case, case + "_plain"), (2,))
        constant = "type constant; value 5e-6"
        self.assertIn(constant, text)
        with open(case + "/constant/segregationProperties", "w") as f:
            f.write(text.replace(constant, 'type expression; value "1e-6*(1 + phi + shearRate)"'))
        self.compare(case, (3,))

    def test_gas_with_a_hole(self):
        """Density, U and kinetic stress of a gas around a wedge, whose inside is a hole of the lattice."""
        gas = self.short("wedge", 20, writeInterval=0.0425).path
        case = harness.copy("segregationWedge", self.folder)
        harness.mesh(case, 40)
        harness.edit(case, CONTROL, endTime=0.01, deltaT=1e-3, writeInterval=0.005)
        path = case + "/constant/segregationProperties"
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace('"gas"', f'"{os.path.abspath(gas)}"'))
        self.compare(case, (4,))

    def test_solid_cyclic(self):
        """Three axes, of which the ranks close the last one to a ring; a layer for each of 4 ranks."""
        n, size = (7, 6, 4), (0.7, 0.6, 0.4)
        at = harness.boxes.centres(n, size)
        U = np.stack([np.sin(9 * at[:, 1]), np.cos(7 * at[:, 2]), 0.2 + np.sin(5 * at[:, 0])], axis=1)
        case = self.box(n, size, np.where(at[:, 1] > 0.3, 0.9, 0.2), laws(0.3, 1e-3, "1 2 1"), "", 0.1, 0.02,
                        types={"x": "cyclic", "z": "cyclic"}, U=U)
        self.compare(case, (2, 4))

    def test_restart_on_other_ranks(self):
        whole = self.boxes((30, 20), adjustTimeStep="yes")
        parts = shutil.copytree(whole, whole + "_parts")
        self.run_case(whole)
        for end, count in ((0.002, 3), (0.004, 1)):
            harness.edit(parts, CONTROL, endTime=end)
            self.run_case(parts, ranks=count)
        runs.same(self, runs.contents(whole + "/0.004"), runs.contents(parts + "/0.004"))

    def test_too_many_ranks(self):
        case = self.boxes((30, 5))
        done = harness.program("granularSegregation", "-case", case, ranks=6, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("6 ranks for 5 layers of cells along y: each rank takes one or more; give  -np 5  at most", done.stderr)
        self.assertEqual(runs.times(case), [])

    def test_bad_value_on_another_rank(self):
        """The message of one rank, wherever the cell is."""
        n, messages = (6, 12, 1), []
        phi = np.full(72, 0.5)
        phi[61] = 1.5
        case = self.box(n, (0.6, 1.2, 0.1), phi, laws(-1, 0.1), "", 1, 0.1)
        for count in (1, 3):
            done = harness.program("granularSegregation", "-case", case, ranks=count, check=False)
            self.assertEqual(done.returncode, 1)
            messages.append(re.search("error: .*", done.stderr)[0])
        self.assertIn("cell 61", messages[0])
        self.assertEqual(*messages)

    def test_line(self):
        """A line, graded too, is computed by every rank."""
        case = self.case("kink", 41, endTime=0.05)
        copy = shutil.copytree(case, case + "_ranks")
        self.run_case(case)
        self.assertIn("each computes the whole line", self.run_case(copy, ranks=3))
        runs.same(self, runs.results(case), runs.results(copy))

    def test_memory(self):
        """The peak of a rank beyond that of a tiny case falls with their number: 4 ranks need a fourth and their halos."""
        def beyond(ranks):
            """Without a flow, whose projection takes its time."""
            found = []
            for n in ((16, 16), (500, 600)):
                case = self.boxes(n, adjustTimeStep="no", endTime=0.001, writeInterval=0.001)
                os.remove(case + "/0.orig/U")
                found.append(harness.peak("granularSegregation", "-case", case, ranks=ranks))
            return found[1] - found[0]

        one, four = beyond(1), beyond(4)
        self.assertLess(one, 330 * 300000)
        self.assertLess(four, 0.25 * 1.25 * one, (one, four))
