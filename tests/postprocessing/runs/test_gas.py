# SPDX-License-Identifier: GPL-3.0-or-later
"""haff.Gas: a case stepped from Python has the bits of granularGas; its fields, errors, lock and log."""
import os
import shutil
import subprocess
import sys
import unittest

import numpy as np

from tests.cases import harness, runs
from tests.cases.harness import haff
from tests.postprocessing.runs.test_run import tube

FIELDS = ("rho", "alpha", "U", "T", "p")


@unittest.skipUnless(os.path.exists(os.path.join(harness.BIN, "haffgas.so")), "a build with sanitizers has no library for Python")
class Gas(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.case = tube(os.path.join(cls.folder, "tube"))
        cls.whole = runs.make(os.path.join(cls.folder, "whole"), (20, 16, 1), 0.02, tables=True, hole=True)
        harness.edit(cls.whole, "system/controlDict", writeInterval=0.01)
        cls.new = shutil.copytree(cls.whole, os.path.join(cls.folder, "new", "whole"))
        harness.program("granularGas", "-case", cls.whole)

    def copy(self, case):
        return shutil.copytree(case, os.path.join(self.folder, self._testMethodName, os.path.basename(case)))

    def test_writes_what_granularGas_writes(self):
        """Every file of a whole run, byte by byte; the log begins and ends as granularGas's does."""
        path = self.copy(self.new)
        with haff.Gas(path) as gas:
            self.assertEqual((gas.time, gas.steps, gas.ended), (0, 0, False))
            lengths = []
            while not gas.ended:
                lengths.append(gas.step())
            self.assertEqual((gas.time, gas.steps), (0.02, len(lengths)))
            self.assertAlmostEqual(sum(lengths), 0.02, 12)
        runs.same(self, runs.results(path), runs.results(self.whole))
        with open(path + "/log") as f:
            self.assertRegex(f.read(), r"(?s)Models.*end at time 0.02: \d+ steps")

    def test_fields(self):
        """What haff.Case reads from written times, to the bit, where no time is written: steps end there all the same. Arrays keep
        their values while the gas goes on."""
        path = self.copy(self.new)
        harness.edit(path, "system/controlDict", writeInterval=1)
        case = haff.Case(self.whole)
        with haff.Gas(path) as gas:
            self.assertLessEqual({*FIELDS, "Ma", "vorticity"}, set(gas.fields))
            self.assertIn("alpha", dir(gas))
            kept = {}
            for time in ("0.01", "0.02"):
                gas.advance(float(time))
                self.assertEqual(gas.time, float(time))
                kept[time] = {name: gas.field(name) for name in FIELDS}
            self.assertIs(gas.T, kept["0.02"]["T"])
            for time, fields in kept.items():
                for name, values in fields.items():
                    np.testing.assert_array_equal(values, case.field(name, time), name)
            with self.assertRaisesRegex(KeyError, "Tee: no such field; there are rho "):
                gas.field("Tee")
            self.assertFalse(hasattr(gas, "Tee"))

    def test_write_and_go_on(self):
        """What write() leaves granularGas goes on with, to the same bits."""
        path = self.copy(self.new)
        with haff.Gas(path) as gas:
            gas.advance(0.01)
            self.assertFalse(os.path.exists(path + "/0.015"))
        with haff.Gas(path, log="log2") as gas:  # from the written time 0.01
            self.assertEqual(gas.time, 0.01)
            gas.step(), gas.step()
            gas.write()
        harness.program("granularGas", "-case", path)
        np.testing.assert_array_equal(haff.Case(path).field("alpha", "0.02"), haff.Case(self.whole).field("alpha", "0.02"))

    def test_a_case_is_held(self):
        """granularGas finds the case locked, this process finds it open; afterwards both may have it. A closed gas says so."""
        path = self.copy(self.case)
        gas = haff.Gas(path)
        self.assertIn("another run works on this case", harness.program("granularGas", "-case", path, check=False).stderr)
        with self.assertRaisesRegex(ValueError, "this process has it open"):
            haff.Gas(path + "/.")
        gas.step()
        gas.close()
        gas.close()
        with self.assertRaisesRegex(ValueError, "this haff.Gas is closed"):
            gas.step()
        haff.Gas(path)  # no name keeps it: closed at once
        harness.program("granularGas", "-case", path)
        with haff.Gas(path) as gas, self.assertRaisesRegex(ValueError, "the run has ended at 0.05"):
            gas.step()

    def test_errors_have_the_words_of_granularGas(self):
        path = self.copy(self.case)
        runs.add(path, "constant/granularProperties", "cooling Half;\n")
        said = harness.program("granularGas", "-case", path, check=False).stderr
        with self.assertRaises(haff.RunError) as caught:
            haff.Gas(path)
        self.assertIn("error: " + caught.exception.message, said)
        self.assertEqual((os.path.basename(caught.exception.file), caught.exception.code), ("granularProperties", 1))
        with self.assertRaisesRegex(haff.RunError, "no such folder; give that of a case"):
            haff.Gas(path + "/nothing")
        with self.assertRaisesRegex(ValueError, "no later than the time now"):
            haff.Gas(self.case).step(until=0)

    def test_own_process(self):
        """The log on standard output; a refusal under mpirun."""
        script = f"import sys; sys.path.insert(0, {os.path.dirname(os.path.dirname(haff.__file__))!r}); import haff; haff.Gas({self.copy(self.case)!r}, log=None)"
        run = lambda **more: subprocess.run([sys.executable, "-c", script], env={**os.environ, **more}, capture_output=True, text=True)
        self.assertRegex(run().stdout, "(?s)cooling +Haff.*end at time 0: 0 steps")
        self.assertIn("haff.Gas runs on one rank", run(OMPI_COMM_WORLD_SIZE="2").stderr)


if __name__ == "__main__":
    unittest.main()
