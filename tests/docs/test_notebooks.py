# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/notebooks: each runs from its first cell to its last one, and shows a picture and numbers that can be."""
import base64
import glob
import importlib.util
import json
import os
import re
import subprocess
import unittest

from tests.cases import harness

FOLDER = os.path.join(harness.SOURCE, "docs", "notebooks")
MISSING = next((name for name in ("nbconvert", "ipykernel") if not importlib.util.find_spec(name)), None)


NAMES = ("firstCase", "sweep", "gasAndGrains")


def cells_of(name):
    with open(os.path.join(FOLDER, name + ".ipynb"), encoding="utf-8") as file:
        return json.load(file)


@unittest.skipIf(MISSING, f"python3-{MISSING} is not there")
class Notebooks(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """One kernel runs them all, for its start takes seconds; before each it forgets what it knows."""
        super().setUpClass()
        whole, path = cells_of(NAMES[0]), os.path.join(cls.folder, "all.ipynb")
        reset = {"cell_type": "code", "metadata": {}, "source": "%reset -f\n%matplotlib inline", "outputs": [], "execution_count": None}
        whole["cells"] = [cell for k, name in enumerate(NAMES) for cell in [{**reset, "id": f"reset{k}"}, *cells_of(name)["cells"]]]
        with open(path, "w", encoding="utf-8") as file:
            json.dump(whole, file)
        env = {k: v for k, v in os.environ.items() if k != "MPLBACKEND"}
        env.update(PATH=f"{harness.BIN}:{env['PATH']}", IPYTHONDIR=os.path.join(cls.folder, "ipython"), JUPYTER_CONFIG_DIR=os.path.join(cls.folder, "jupyter"))
        done = subprocess.run(["/usr/bin/python3", "-m", "nbconvert", "--to", "notebook", "--execute", "--inplace", path], capture_output=True, text=True, cwd=cls.folder, env=env,
                              timeout=600)
        if done.returncode:
            raise AssertionError(done.stderr[-3000:])
        with open(path, encoding="utf-8") as file:
            cls.ran = json.load(file)["cells"]

    def said(self, name):
        """What the cells print; the notebook shows one picture."""
        first = next(k for k, cell in enumerate(self.ran) if cell["id"] == f"reset{NAMES.index(name)}")
        outputs = [output for cell in self.ran[first:first + 1 + len(cells_of(name)["cells"])] for output in cell.get("outputs", [])]
        pictures = [base64.b64decode(output["data"]["image/png"]) for output in outputs if "image/png" in output.get("data", {})]
        self.assertEqual([True], [picture.startswith(b"\x89PNG") and len(picture) > 5000 for picture in pictures])
        return "".join("".join(output.get("text", "")) for output in outputs)

    def test_first_case(self):
        """Inelastic grains pack at the wall to near 0.64, elastic ones do not; mass comes in: 0.1 behind the inlet at speed 1 for a time of 2, into a length of 4."""
        said = self.said("firstCase")
        self.assertAlmostEqual(float(re.search(r"at the start: ([\d.]+)", said)[1]), 1.5, delta=1e-3)
        inelastic, elastic = map(float, re.search(r"e = 0.9 and e = 1: ([\d.]+) ([\d.]+)", said).groups())
        self.assertTrue(0.6 < inelastic < 0.65 and elastic < 0.3, said)
        packed, time = map(float, re.search(r"volume fraction ([\d.]+) at t = ([\d.]+)", said).groups())
        self.assertTrue(0.5 <= packed < 0.55 and 0.1 < time < 0.2, said)

    def test_sweep(self):
        """Less energy is left where collisions take more, by more than the error bars."""
        found = [tuple(map(float, row)) for row in re.findall(r"e = [\d.]+: ([\d.]+) \+- ([\d.]+)", self.said("sweep"))]
        self.assertEqual(3, len(found))
        for (low, error), (high, other) in zip(found, found[1:]):
            self.assertGreater(high - low, error + other)

    def test_gas_and_grains(self):
        """They cool alike, but for the noise of 458 grains, 1/sqrt(458) = 0.05."""
        self.assertLess(float(re.search(r"difference of gas and grains: ([\d.]+)", self.said("gasAndGrains"))[1]), 0.05)

    def test_are_kept_without_outputs(self):
        self.assertEqual({name + ".ipynb" for name in NAMES}, {os.path.basename(path) for path in glob.glob(os.path.join(FOLDER, "*"))})
        for name in NAMES:
            self.assertFalse(any(cell.get("outputs") for cell in cells_of(name)["cells"]), name)


if __name__ == "__main__":
    unittest.main()
