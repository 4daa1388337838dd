# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of function objects: names of their columns, starts joined, with pandas and without; of runs of the programs, restarted."""
import os
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import haff

from haff.case import tables  # noqa: E402

FUNCTIONS = """
    extreme { type fieldMinMax; fields (T U); }
    budget { type energyBudget; }
    floor { type forces; patches (yLow); CofR (0 0 0); }
    coeffs { type forceCoeffs; patches (yLow); CofR (0 0 0); magUInf 2; rhoInf 3; lRef 0.5; Aref 0.25; dragDir (0 2 0); liftDir (1 0 0); }
    through { type surfaceFieldValue; regionType patch; name yLow; operation areaAverage; fields (p U); }
    mass { type volFieldValue; fields (rho U); operation volIntegrate; }
    points { type probes; fields (alpha U); probeLocations ((0.05 0.05 0.05) (0.35 0.25 0.05)); }
"""
COLUMNS = {
    ("extreme", "fieldMinMax.dat"): "Time field min location(min)_x location(min)_y location(min)_z max location(max)_x location(max)_y location(max)_z",
    ("floor", "force.dat"): "Time total_x total_y total_z pressure_x pressure_y pressure_z viscous_x viscous_y viscous_z",
    ("coeffs", None): "Time Cd Cs Cl CmRoll CmPitch CmYaw Cd(f) Cd(r) Cs(f) Cs(r) Cl(f) Cl(r)",
    ("through", None): "Time areaAverage(p) areaAverage(U)_x areaAverage(U)_y areaAverage(U)_z",
    ("mass", None): "Time volIntegrate(rho) volIntegrate(U)_x volIntegrate(U)_y volIntegrate(U)_z",
    ("points", "U"): "Time probe0_x probe0_y probe0_z probe1_x probe1_y probe1_z",
    ("points", "alpha"): "Time probe0 probe1",
}


class Written(unittest.TestCase):
    """Files written here."""

    def setUp(self):
        self._temporary = tempfile.TemporaryDirectory(prefix="haff")
        self.case = self._temporary.name
        os.makedirs(os.path.join(self.case, "system"))

    def tearDown(self):
        self._temporary.cleanup()

    def write(self, name, text):
        path = os.path.join(self.case, "postProcessing", name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as f:
            f.write(text)

    def test_restarts(self):
        """A later start replaces what it repeats, whatever the order of the folders' names; one without rows replaces nothing."""
        self.write("m/0/a.dat", "# Time\tword\tU\n0\ta\t(1 2 3)\n5\tb\t(4 5 6)\n10\tc\t(7 8 9)\n")
        self.write("m/5/a.dat", "# Time\tword\tU\n5\td\t(0 0 1)\n20\te\t(0 0 2)\n")
        self.write("m/10/a.dat", "# Time\tword\tU\n")
        self.write("m/1_5/a.dat", "no start\n")
        table = haff.Case(self.case).table("m", frame=True)
        self.assertEqual(list(table["Time"]), [0, 5, 20])
        self.assertEqual([str(w) for w in table["word"]], ["a", "d", "e"])
        self.assertEqual(list(table["U_z"]), [3, 1, 2])
        np.testing.assert_array_equal(haff.Case(self.case).table("m", "a.dat"), [[0, np.nan, 1, 2, 3], [5, np.nan, 0, 0, 1], [20, np.nan, 0, 0, 2]])

    def test_other_columns_after_a_restart(self):
        self.write("m/0/a.dat", "# Time b\n0 1\n")
        self.write("m/1/a.dat", "# Time c b\n1 2 3\n")
        table = haff.Case(self.case).table("m", frame=True)
        np.testing.assert_array_equal(table["b"], [1, 3])
        np.testing.assert_array_equal(table["c"], [np.nan, 2])
        with self.assertRaisesRegex(ValueError, "1.a.dat: a row has 3 columns, the first one 2"):
            haff.Case(self.case).table("m")

    def test_rows_being_written(self):
        self.write("m/0/a.dat", "# Time b c\n0 1 2\n1 3 4\n2 5")
        self.assertEqual(haff.Case(self.case).table("m").tolist(), [[0, 1, 2], [1, 3, 4]])

    def test_without_names(self):
        self.write("m/0/a.dat", "0 1 (2 3 4)\n")
        self.assertEqual(tables.names_of(haff.Case(self.case).table("m", frame=True)), [f"column{i}" for i in range(1, 6)])

    def test_refusals(self):
        self.write("m/0/a.dat", "0 1\n")
        self.write("m/1/b.dat", "0 1\n")
        for function, file, message in (("mm", None, "mm has no tables; .*: m$"), ("m", "c.dat", "there is no c.dat; did you mean b.dat\\? The files are: a.dat, b.dat"),
                                        ("m", None, r"which file\?")):
            with self.assertRaisesRegex(FileNotFoundError, message):
                haff.Case(self.case).table(function, file)
        self.assertEqual(haff.Case(self.case).tables(), {"m": ["a.dat", "b.dat"]})

    def test_with_pandas_or_without(self):
        """The same columns by the same names; pandas is taken where it is."""
        columns = {"Time": np.array([0.0, 1]), "word": np.array(["a", "bcd"])}
        with mock.patch.dict(sys.modules, {"pandas": None}):
            bare = tables.frame(columns)
        self.assertIsInstance(bare, np.ndarray)
        self.assertEqual((tables.names_of(bare), bare["word"].tolist(), bare["Time"][1], len(bare)), (["Time", "word"], ["a", "bcd"], 1, 2))
        made = mock.Mock(DataFrame=mock.Mock(return_value="framed"))
        with mock.patch.dict(sys.modules, {"pandas": made}):
            self.assertEqual(tables.frame(columns), "framed")
        made.DataFrame.assert_called_once_with(columns)

    def test_data_frame(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        self.write("m/0/a.dat", "# Time\tword\tU\n0\ta\t(1 2 3)\n5\tb\t(4 5 6)\n")
        table = haff.Case(self.case).table("m", frame=True)
        self.assertIsInstance(table, pandas.DataFrame)
        self.assertEqual(tables.names_of(table), ["Time", "word", "U_x", "U_y", "U_z"])
        self.assertEqual(table[table.word == "b"].U_y.tolist(), [5])


class OfRuns(harness.Folder, unittest.TestCase):
    def columns(self, table):
        return {name: np.asarray(table[name]) for name in tables.names_of(table)}

    def test_gas(self):
        """Every table of a run has the names of its columns; a run from the middle, again, gives the tables of the whole run."""
        case = runs.make(os.path.join(self.folder, "gas"), (8, 6, 1), 0.004, interval=0.002)
        runs.add(case, "system/controlDict", "functions\n{" + FUNCTIONS + "}\n")
        harness.program("granularGas", "-case", case)
        result = haff.Case(case)
        whole = {key: self.columns(result.table(*key, frame=True)) for key in COLUMNS}
        for key, names in COLUMNS.items():
            self.assertEqual(list(whole[key]), names.split(), key)
        harness.edit(case, "system/controlDict", startFrom="startTime", startTime="0.002")
        harness.program("granularGas", "-case", case)
        for key in COLUMNS:
            joined = self.columns(result.table(*key, frame=True))
            for name, values in whole[key].items():
                np.testing.assert_array_equal(joined[name], values, err_msg=f"{key} {name}")
        budget, run = (self.columns(result.table(name, frame=True)) for name in ("budget", "run"))
        self.assertTrue({"Time", "mass", "energy", "cooling", "momentum_x"} <= budget.keys())
        self.assertTrue({"Time", "step", "dt", "limiter", "Courant"} <= run.keys())
        self.assertTrue((np.diff(run["Time"]) > 0).all() and run["Time"][-1] == 0.004)
        self.assertEqual(run["limiter"].dtype.kind, "U" if run["limiter"].dtype != object else "O")
        last = result.field("U").reshape(6, 8, 3)
        found = self.columns(result.table("points", "U", frame=True))
        np.testing.assert_allclose([found[f"probe1_{a}"][-1] for a in "xyz"], last[2, 3], rtol=1e-11)


if __name__ == "__main__":
    unittest.main()
