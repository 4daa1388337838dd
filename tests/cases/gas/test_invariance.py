# SPDX-License-Identifier: GPL-3.0-or-later
"""What must not depend on the axis or the number of axes; and conservation. Ranks and stops: test_parallel, test_restart."""
import os
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes
from studies.exact.eos import of_case
from studies.exact.riemann import BLAST

LENGTH, CELLS, END = 10.0, 60, 1.5
FIELDS = ("rho", "U", "T", "p", "alpha")


def planar(axis, n):
    """The blast along an axis: rho, u, p in the cells."""
    size = tuple(LENGTH if k == axis else 1.0 for k in range(3))
    left = boxes.centres(n, size)[:, axis] < LENGTH / 2
    rho, speed, p = (np.where(left, a, b) for a, b in zip(*BLAST))
    return size, rho, np.outer(speed, np.eye(3)[axis]), p


class Invariance(harness.Folder, unittest.TestCase):
    def run_box(self, name, n, axis, **options):
        size, rho, u, p = planar(axis, n)
        case = harness.box_case(os.path.join(self.folder, name), n, size, rho, u, p, END, e=0.9, cooling="Haff",
                                **options)
        harness.program("granularGas", "-case", case)
        return harness.haff.Case(case)

    def profile(self, case, n, axis, field):
        """The values along the axis; all lines along it must be the same bits."""
        values = case.field(field)
        grid = values.reshape(*n[::-1], -1)
        lines = np.moveaxis(grid, 2 - axis, 0)
        first = lines[:, :1, :1]
        np.testing.assert_array_equal(lines, np.broadcast_to(first, lines.shape))
        line = first[:, 0, 0]
        return line[:, axis] if field == "U" else line[:, 0]

    def test_axes_and_dimensions(self):
        """1D along x, y, z, 2D and 3D: the same bits; PHM and WENO5."""
        for reconstruct in ("PHM", "WENO5"):
            reference = None
            for n in ((CELLS, 1, 1), (1, CELLS, 1), (1, 1, CELLS), (CELLS, 8, 1), (8, CELLS, 1), (1, 8, CELLS),
                      (CELLS, 6, 6), (6, CELLS, 6), (6, 6, CELLS)):
                axis = n.index(CELLS)
                # cyclic across, the same fixed step for all: the Courant number counts axes
                types = {"xyz"[k]: "cyclic" for k in range(3) if k != axis and n[k] > 1}
                case = self.run_box(f"{reconstruct}{'_'.join(map(str, n))}", n, axis, types=types,
                                    reconstruct=reconstruct, adjust="no", step=END / 64, control="runTime")
                got = {f: self.profile(case, n, axis, f) for f in FIELDS}
                reference = reference or got
                for field in FIELDS:
                    with self.subTest(f"{reconstruct} {n} {field}"):
                        np.testing.assert_array_equal(got[field], reference[field])

    def in_units(self, name, mass, length, time, engine, reconstruct):
        """Layers that fall in a cooling gas, in a unit of mass, length and time; its fields in the first one."""
        n, speed = (24, 16, 1), length / time
        size = np.array((2.4, 1.6, 0.1))
        x, y, _ = boxes.centres(n, size).T
        rho = np.where(x + 0.3 * y < 1.1, 300.0, 40 + 10 * np.sin(7 * y))
        u = np.stack([np.sin(3 * x + y), np.cos(2 * x - y), 0 * x], axis=1)
        case = harness.box_case(os.path.join(self.folder, name), n, size * length, rho * mass / length**3, u * speed,
                                500 * rho * mass / length / time**2, 0.02 * time, e=0.9, cooling="Haff", step=1e-6 * time,
                                gravity=(-3.0 * length / time**2, -20.0 * length / time**2, 0.0), reconstruct=reconstruct, binary=True)
        harness.edit(case, "constant/granularProperties", diameter=0.1 * length, mass=mass)
        harness.write_dictionary(case, "system", "fvSchemes", f"fluxScheme common; reconstruct {reconstruct}; timeScheme SSPRK43;\n"
                                 f"meshEngine {engine};\n")
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        units = {"rho": mass / length**3, "U": speed, "T": speed**2, "p": mass / length / time**2, "alpha": 1}
        return {f: result.field(f) / unit for f, unit in units.items()}

    def test_units(self):
        """Units of mass, length and time whose ratios are powers of two give the same bits."""
        for engine, reconstruct in (("lattice", "WPENO5"), ("lattice", "TENO5"), ("polyhedral", "WPENO5")):
            first = self.in_units(f"{engine}{reconstruct}", 1, 1, 1, engine, reconstruct)
            for i, powers in enumerate(((-66, 0, 0), (66, 10, -6), (-40, -8, 12))):
                other = self.in_units(f"{engine}{reconstruct}{i}", *(2.0**k for k in powers), engine, reconstruct)
                for field, values in other.items():
                    with self.subTest(f"{engine} {reconstruct} {powers} {field}"):
                        np.testing.assert_array_equal(values, first[field])

    def test_conservation(self):
        """Between slip walls and with periodic ends: mass always; momentum and energy where nothing takes them."""
        n, size = (40, 30, 1), (4.0, 3.0, 0.1)
        x, y, _ = boxes.centres(n, size).T
        rho = 100 + 60 * np.sin(np.pi * x / 2) * np.cos(2 * np.pi * y / 3)
        u = np.stack([np.cos(np.pi * x / 2), np.sin(2 * np.pi * y / 3), 0 * x], axis=1)
        p = 300 + 200 * np.cos(np.pi * x)
        walls = ("xLow", "xHigh", "yLow", "yHigh")
        for name, options in (("walls", {"slip": walls, "types": {"x": "wall", "y": "wall"}}),
                              ("periodic", {"types": {"x": "cyclic", "y": "cyclic"}})):
            case = harness.box_case(os.path.join(self.folder, name), n, size, rho, u, p, 1.0, **options)
            harness.program("granularGas", "-case", case)
            result = harness.haff.Case(case)
            new_rho, new_u, new_T = (result.field(f) for f in ("rho", "U", "T"))
            gas = of_case(result)
            energy = lambda rho, u, T: (rho * (1.5 * T + (u**2).sum(axis=1) / 2)).sum()
            with self.subTest(name):
                self.assertGreater(np.abs(new_rho - rho).max(), 1, "nothing has happened")
                self.assertAlmostEqual(new_rho.sum() / rho.sum(), 1, delta=1e-13)
                self.assertAlmostEqual(energy(new_rho, new_u, new_T) / energy(rho, u, gas.T(rho, p)), 1, delta=1e-13)
                if name == "periodic":
                    momentum = (rho[:, None] * u).sum(axis=0), (new_rho[:, None] * new_u).sum(axis=0)
                    np.testing.assert_allclose(momentum[1], momentum[0], atol=1e-12 * np.abs(rho[:, None] * u).sum())


if __name__ == "__main__":
    unittest.main()
