# SPDX-License-Identifier: GPL-3.0-or-later
"""Faint waves of inelastic spheres that cool, from near vacuum to dense, against linear theory with mu and zeta_U."""
import functools
import os
import unittest

import numpy as np

from tests.cases import harness, runs

from studies.exact import garzoDufty  # noqa: E402

SCHEMES = ["RKJ2", "RKL2", "explicit"] + ["implicit"] * os.path.exists(os.path.join(harness.BIN, "haffimplicit.so"))


def faint(diffusion):
    """Amplitude of the waves: they do not see each other, but errors of PETSc's solver of 4e-6."""
    return 1e-4 if diffusion == "implicit" else 1e-6


class Gas:
    """Spheres at rest with a packing, a restitution, and T = 1 at the start; the diameter sets how stiff waves of length 1 are:
    heat diffuses at (2/3) heat/rho = `diffusivity`."""

    def __init__(self, packing, e, diffusivity):
        unit = garzoDufty.Grains(3, e)
        of_unit = 2 / 3 * unit.heat(packing / unit.per, 1.0) / (packing / unit.per)
        self.grains, self.nu, self.e = garzoDufty.Grains(3, e, diffusivity / of_unit), packing, e
        self.rho = packing / self.grains.per
        g, nu = self.grains, packing
        for name in ("G", "A", "slope", "stiffness", "starred"):  # theory asks for a few packings, thousands of times
            setattr(g, name, functools.cache(getattr(g, name)))
        self.c = np.sqrt(g.stiffness(nu) + 2 / 3 * g.A(nu)**2)
        self.scale = np.array([1, self.c, 1, self.c])

    def T(self, t):
        return self.grains.cooled(self.nu, 1.0, t)

    def matrix(self, t, k):
        """d/dt of the amplitudes (rho/rho0, u, T) ~ exp(ikx), and of a velocity across the wave."""
        g, rho, nu, T = self.grains, self.rho, self.nu, self.T(t)
        p_rho, p_T, B = T * g.stiffness(nu), rho * g.A(nu), g.cooling(nu)
        slope = (g.cooling(nu * (1 + 1e-5)) - g.cooling(nu * (1 - 1e-5))) / 2e-5  # of B by ln rho
        along = (g.bulk(rho, T) + 4 / 3 * g.shear(rho, T)) * k**2 / rho
        work = 2 / 3 * T * g.A(nu) + T * g.zeta_u(nu)
        return np.array([
            [0, -1j * k, 0, 0],
            [-1j * k * p_rho, -along, -1j * k * p_T / rho, 0],
            [-2 / 3 * k**2 * g.cross(rho, T) - slope * T**1.5, -1j * k * work,
             -2 / 3 * k**2 * g.heat(rho, T) / rho - 1.5 * B * np.sqrt(T), 0],
            [0, 0, 0, -g.shear(rho, T) * k**2 / rho]])

    def theory(self, k, start, end, steps=150):
        """The amplitudes at the end: exponentials of the matrix in the middle of each step, of second order."""
        y, dt = np.array(start, complex), end / steps
        for i in range(steps):
            y = exponential(dt * self.matrix((i + 0.5) * dt, k)) @ y
        return y


def exponential(M):
    halvings = max(0, int(np.ceil(np.log2(np.abs(M).sum() + 1e-300))) + 4)
    M, result, term = M / 2**halvings, np.eye(len(M), dtype=complex), np.eye(len(M), dtype=complex)
    for j in range(1, 10):
        term = term @ M / j
        result = result + term
    for _ in range(halvings):
        result = result @ result
    return result


class Waves(harness.Folder, unittest.TestCase):
    """Several waves in a periodic box do not see each other, so that one run has them all."""

    @staticmethod
    def start(m):
        """Amplitudes of wave m in rho/rho0, u/c, T and u/c across the wave: of any phase, and of a size of their own."""
        return np.exp(1j * np.array([0.3 * m, 1 + m, 2 - m, 0.7 * m])) * [1, 1, 0.7, 0.8]

    @staticmethod
    def directions(wave):
        """Along the wave and across it; in one dimension nothing is across."""
        along = np.array(wave) / np.linalg.norm(wave)
        across = np.cross(along, (0.3, 0.5, 0.8)) if np.count_nonzero(wave) > 1 else np.zeros(3)
        return along, across / max(np.linalg.norm(across), 1e-9)

    def case(self, name, gas, n, waves, end, steps, diffusion):
        """A case with the waves (integer vectors), and the cells' centres."""
        size = [1.0 if k > 1 else 0.1 for k in n]
        x = harness.boxes.centres(n, size)
        rho, T, u = np.full(len(x), gas.rho), np.ones(len(x)), np.zeros((len(x), 3))
        for m, wave in enumerate(waves):
            along, across = self.directions(wave)
            y = (faint(diffusion) * gas.scale * self.start(m))[:, None] * np.exp(2j * np.pi * (x @ np.array(wave)))
            rho, T = rho * (1 + y[0].real), T + y[2].real
            u = u + np.outer(y[1].real, along) + np.outer(y[3].real, across)
        types = {axis: "cyclic" for axis, k in zip("xyz", n) if k > 1}
        case = harness.box_case(os.path.join(self.folder, name), n, size, rho, u, rho, end, types=types, e=gas.e,
                                eos="TorquatoSpheres", reconstruct="WENO5", adjust="no", step=end / steps, cooling="GarzoDufty")
        os.remove(os.path.join(case, "0", "p"))
        harness.boxes.write_field(case, "T", T, "\n".join(f"\"{axis}.*\" {types.get(axis, 'empty')}" for axis in "xyz"))
        harness.edit(case, "constant/granularProperties", diameter=repr(float(gas.grains.sigma)),
                     transport="GarzoDufty; GarzoDuftyCoeffs { zetaU geometric; alphaMin 0; }")
        harness.write_dictionary(case, "system", "fvSolution", "diffusion { type %s; }\n" % diffusion)
        return case, x

    def run_waves(self, name, gas, n, waves, end, steps, diffusion="RKJ2", engine="lattice"):
        """What is left of each wave in the units of its start, what theory leaves, and the largest of what else there is."""
        case, x = self.case(name, gas, n, waves, end, steps, diffusion)
        if engine != "lattice":
            runs.add(case, "system/fvSchemes", f"meshEngine {engine};\n")
        harness.program("granularGas", "-case", case)
        result = harness.haff.Case(case)
        rho, U, T = (result.field(f) for f in ("rho", "U", "T"))
        unit = faint(diffusion)
        other = [rho / gas.rho / unit, T / unit, U / (gas.c * unit)]
        rest = []
        for m, wave in enumerate(waves):
            along, across = self.directions(wave)
            phase = np.exp(2j * np.pi * (x @ np.array(wave)))
            found = np.array([np.mean(2 * q / phase) for q in (rho / gas.rho, U @ along, T, U @ across)]) / (unit * gas.scale)
            begin = gas.scale * self.start(m) * [1, 1, 1, np.any(across)]
            rest.append((found, gas.theory(2 * np.pi * np.linalg.norm(wave), begin, end) / gas.scale))
            of_wave = (found[:, None] * phase).real
            for k, q in enumerate((of_wave[0], of_wave[2], np.outer(of_wave[1], along) + np.outer(of_wave[3], across))):
                other[k] = other[k] - q
        return rest, max(np.ptp(q, axis=0).max() for q in other)

    def errors(self, name, gas, n, waves, end, diffusion="RKJ2", **options):
        """The largest error of each wave."""
        rest, other = self.run_waves(name, gas, n, waves, end, n[0], diffusion, **options)
        self.assertLess(other, 0.01 if diffusion == "implicit" else 1e-4)
        return np.array([np.abs(found - theory).max() for found, theory in rest])

    def orders(self, name, gas, n, waves, end, **options):
        coarse, fine = (self.errors(f"{name}{k}", gas, [k * i if i > 1 else 1 for i in n], waves, end, **options) for k in (1, 2))
        return np.log2(coarse / fine), fine

    def test_cooling(self):
        """A damped wave and its overtone while the gas loses up to half of its heat: second order, amplitude and phase. What mu
        does to these waves is 0.03 to 0.25, what zeta_U does in dense gas 0.1 to 0.2."""
        for nu in (1e-4, 0.01, 0.3, 0.55):
            for e in (0.7, 0.9):
                gas = Gas(nu, e, 0.2)
                end = min(0.7 / gas.c, 1 / gas.grains.cooling(nu))
                with self.subTest(nu=nu, e=e):
                    waves = [(1, 0, 0), (2, 0, 0)]
                    if e == 0.7:
                        order, error = self.orders(f"cooling{nu}", gas, (32, 1, 1), waves, end)
                        self.assertGreater(order.min(), 1.85)
                    else:
                        error = self.errors(f"cooling{nu}", gas, (64, 1, 1), waves, end)
                    self.assertLess(error[0], 8e-4)
                    self.assertLess(error[1], 6e-3)

    def test_schemes(self):
        gas = Gas(0.3, 0.7, 0.5)
        for diffusion in SCHEMES:
            with self.subTest(diffusion):
                order, error = self.orders(diffusion, gas, (32, 1, 1), [(1, 0, 0), (2, 0, 0)], 0.19 / gas.c, diffusion=diffusion)
                self.assertGreater(order.min(), 1.85)
                self.assertLess(error.max(), 2e-3)

    def test_oblique(self):
        """Sound, heat and shear along no axis, on a lattice and on the same boxes as polyhedra."""
        gas = Gas(0.3, 0.7, 0.1)
        for engine, least, most in (("lattice", 1.9, 2.5e-3), ("polyhedral", 1.9, 7e-3)):
            with self.subTest(engine):
                order, error = self.orders(engine, gas, (12, 12, 12), [(1, 1, 1)], 0.15 / gas.c, engine=engine)
                self.assertGreater(order.min(), least)
                self.assertLess(error.max(), most)

    def test_stiff(self):
        """Heat and momentum diffuse across a wave ten times, or thousands of times, in a step. Then only what pressure moves
        against friction is left, too fast by an error that is of first order in dt; no wave grows."""
        waves = [(1, 0, 0), (2, 0, 0), (3, 0, 0)]
        for nu in (1e-4, 0.55):
            for diffusion, diffusivity in [("RKJ2", 20)] + [(s, 1e4) for s in SCHEMES if s != "explicit"]:
                gas = Gas(nu, 0.7, diffusivity)
                with self.subTest(nu=nu, diffusivity=diffusivity, diffusion=diffusion):
                    rest, other = self.run_waves(f"stiff{nu}{diffusivity}{diffusion}", gas, (32, 1, 1), waves, 0.7 / gas.c, 32,
                                                 diffusion)
                    self.assertLess(other, 0.06)
                    for found, theory in rest:
                        self.assertLess(np.abs(found).max(), np.abs(theory).max())


if __name__ == "__main__":
    unittest.main()
