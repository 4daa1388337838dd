# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas that moves along axes which the mesh does not resolve, without viscosity: shocks, floors, gravity, the bits of restarts and
ranks, what is written of it, and what is refused. The same as with three cells along such an axis, to round-off."""
import os
import shutil
import unittest

import numpy as np

from tests.cases import harness, runs, sections
from tests.cases.runtime import test_forces as forces

FLUXES = ("common", "Marquina", "MarquinaStable", "LaxFriedrichs", "globalLaxFriedrichs", "Rusanov")
RECONSTRUCTIONS = ("PHM", "WENO5", "WENOZ", "TENO5", "WPENO5", "firstOrder")
PERFECT = {"eos": "perfectGas", "cooling": "none", "e": 1.0, "viscous": False, "step": 1e-3}


def shocked(at):
    return np.where(at[:, 0] + at[:, 1] < 3, 5.0, 0.625)


def hot(at):
    return np.where(at[:, 0] + at[:, 1] < 3, 10.0, 8.0)


def across(at):
    """At rest along x, y and z as one of them is resolved: both others move."""
    x = at[:, 0] + at[:, 1]
    steps = np.where(x < 2, 1.0, -0.5)
    return tuple((steps + 0.3 * np.sin((4 + k) * x)) * (1 - (at[:, k].max() > 0)) * (1 + k) for k in range(3))


def tagged(at):
    return 0, np.where(at[:, 0] < 3, 2.0, -1.0), 0


def bubble(at):
    away = (at[:, 0] - 1.4)**2 + (at[:, 1] - 0.9)**2
    return 50 + 300 * np.exp(-4 * away)


def apart(at):
    return np.where((np.abs(at[:, 1] - 0.6) < 0.3) | (np.abs(at[:, 1] - 2.1) < 0.3), 800.0, 1e-5)


def against(at):
    return 30 * np.sign(at[:, 1] - 1.5), np.where(at[:, 1] < 1.5, 80.0, -80.0), 0 * at[:, 1] + 5


def tepid(at):
    return 0.2 + 0 * at[:, 0]


def swirl(at):
    return np.sin(at[:, 0]), -np.cos(at[:, 1]), 2 + np.sin(3 * at[:, 0] + at[:, 1])


def packed(at):
    return np.where((at[:, 0] < 0.7) & (at[:, 1] < 0.8), 0.6, 1e-4) * 6 / np.pi / 0.1 ** 3


def sliding(at):
    return 0 * at[:, 0], 0 * at[:, 0], np.where((at[:, 0] < 0.7) & (at[:, 1] < 0.8), 0.5 + at[:, 1], 0)


def chilled(at):
    return np.where((at[:, 0] < 0.7) & (at[:, 1] < 0.8), 1e-3, 0.1)


class Components(harness.Folder, unittest.TestCase):
    def pair(self, name, n, *state, **options):
        return sections.pair(self.folder, name, n, *state, **{**PERFECT, **options})

    def test_fluxes(self):
        """A shock tube whose gas moves along both other axes, by every flux."""
        for flux in FLUXES:
            for engine, tolerance in (("lattice", 5e-14), ("polyhedral", 5e-11)):
                with self.subTest(flux=flux, engine=engine):
                    found, _ = self.pair(flux + engine, (0, 40, 0), shocked, across, hot, 0.15, flux=flux, engine=engine)
                    self.assertLess(found, tolerance)

    def test_reconstructions(self):
        """By every reconstruction. CWENO3 has other polynomials in one dimension than in three."""
        for reconstruct in RECONSTRUCTIONS:
            with self.subTest(reconstruct):
                found, _ = self.pair(reconstruct, (60, 0, 0), shocked, across, hot, 0.15, reconstruct=reconstruct)
                self.assertLess(found, 5e-14)
        found, _ = self.pair("fit", (60, 0, 0), shocked, across, hot, 0.15, engine="polyhedral", fit="firstOrder")
        self.assertLess(found, 5e-11)
        found, _ = self.pair("CWENO3", (60, 0, 0), shocked, across, hot, 0.15, engine="polyhedral", fit="CWENO3")
        self.assertLess(found, 1.3 * 0.032)

    def test_contact(self):
        """The component goes with the gas: shock and fan leave it, it jumps at the contact, where the rest does as without it."""
        for engine in ("lattice", "polyhedral"):
            cases = [sections.make(os.path.join(self.folder, "contact" + engine, kind), (60, 0, 0), shocked, u, hot, 0.3,
                                   engine=engine, fit="CWENO3", **PERFECT) for kind, u in (("moves", tagged), ("rests", lambda at: (0, 0, 0)))]
            for case in cases:
                harness.program("granularGas", "-case", case)
            moves, rests = (harness.haff.Case(case) for case in cases)
            w, x = moves.field("U")[:, 1], moves.centres[:, 0]
            u, rho = rests.field("U")[:, 0], rests.field("rho")
            contact = 3 + 0.3 * u[(x > 3.2) & (x < 3.5)].mean()
            self.assertGreater(contact, 3.3)
            far = np.abs(x - contact) > 0.55  # five cells, over which it is smeared
            np.testing.assert_allclose(w[far], np.where(x[far] < contact, 2.0, -1.0), atol=0.03 * 3)
            # kinetic energy that mixes at the contact heats the gas there, of a few cells
            self.assertLess(np.abs(moves.field("rho") - rho)[far].max(), 0.02 * rho.max())

    def test_gravity(self):
        """Along a missing axis all gas falls alike, cold gas, too: momentum is that of u = g t to round-off, whatever happens in
        the plane, and each cell's u and T are to the error of Runge-Kutta schemes, whose stages have densities of their own."""
        for engine in ("lattice", "polyhedral"):
            for T in (tepid, lambda at: 1e-7 + 0 * at[:, 0]):
                case = sections.make(os.path.join(self.folder, "fall%s%d" % (engine, T is tepid)), (24, 20, 0), bubble, lambda at: (0, 0, 0.5), T, 0.02,
                                     engine=engine, gravity=(0.0, 0.0, -7.0), viscous=False)
                log = harness.program("granularGas", "-case", case).stdout
                self.assertNotRegex(log, "limited:|rejected:|floor:")
                result = harness.haff.Case(case)
                np.testing.assert_allclose(result.field("U")[:, 2], 0.5 - 7 * 0.02, rtol=1e-6)
                start = (result.field("rho", "0") * result.volumes).sum()
                np.testing.assert_allclose((result.field("rhoU")[:, 2] * result.volumes).sum(), start * (0.5 - 7 * 0.02), rtol=1e-12)
                still = sections.make(case + "Still", (24, 20, 0), bubble, lambda at: (0, 0, 0), T, 0.02, engine=engine, viscous=False)
                harness.program("granularGas", "-case", still)
                if T is tepid:
                    np.testing.assert_allclose(result.field("T"), harness.haff.Case(still).field("T"), rtol=1e-6)

    def test_limited(self):
        """Lumps that collide at Mach 100 in a near vacuum, sheared as fast along a missing axis: limited, filled, and at each step
        the same."""
        for engine, tolerance in (("lattice", 1e-9), ("polyhedral", 1e-7)):
            with self.subTest(engine):
                options = {"viscous": False, "cooling": "Haff", "engine": engine, "step": 1e-4, "solution": "limits { alphaFloor 5e-9; }\n"}
                cases = [sections.make(os.path.join(self.folder, "limited" + engine, kind), (0, 30, 0), apart, against, tepid, 0.003,
                                       thick=kind == "thick", **options) for kind in ("thin", "thick")]
                tables = []
                for case in cases:
                    harness.program("granularGas", "-case", case)
                    tables.append(np.loadtxt(os.path.join(case, "postProcessing", "limiter", "0", "limiter.dat"), ndmin=2))
                self.assertLess(sections.difference(*cases, (0, 30, 0)), tolerance)
                self.assertGreater(tables[0][:, 2].sum(), 0)
                np.testing.assert_array_equal(9 * tables[0][:, 2], tables[1][:, 2])

    def test_bits(self):
        """The same bits on two ranks, after a restart, and where nothing is left out as uniform."""
        for engine in ("lattice", "polyhedral"):
            for viscous in (False, True):
                name = "bits%s%d" % (engine, viscous)
                case = sections.make(os.path.join(self.folder, name), (40, 30, 0), bubble, swirl, tepid, 0.02, engine=engine, fit="CWENO3",
                                     viscous=viscous, gravity=(0.0, -9.0, 4.0), interval=0.005)
                runs.add(case, "system/controlDict", runs.TABLES.format("0.31 0.2 5000", "2.1 2.9 5000"))
                full, two = (shutil.copytree(case, os.path.join(case + kind, name)) for kind in ("Full", "Two"))
                runs.add(full, "system/fvSolution", "skipUniform no;\n")
                harness.program("granularGas", "-case", full)
                harness.program("granularGas", "-case", two, ranks=2)
                harness.program("granularGas", "-case", case)
                for other in (full, two):
                    runs.same(self, runs.results(case), runs.results(other), other)
                part = runs.until(case, case + "Part", "0.01")
                harness.program("granularGas", "-case", part)
                for time in ("0.015", "0.02"):
                    runs.same(self, *(runs.contents(os.path.join(c, time)) for c in (case, part)), time)

    def test_written(self):
        """Fields, probes, integrals and extremes have the component."""
        case = sections.make(os.path.join(self.folder, "written"), (24, 20, 0), bubble, lambda at: (0, 0, 3 + 0 * at[:, 0]), tepid, 0.01,
                             viscous=False)
        runs.add(case, "system/controlDict", runs.TABLES.format("0.31 0.2 5000", "2.1 1.9 5000"))
        log = harness.program("granularGas", "-case", case).stdout
        self.assertRegex(log, r"velocity +along z, too, an axis without cells")
        result = harness.haff.Case(case)
        np.testing.assert_allclose(result.field("U")[:, 2], 3, rtol=1e-13)
        mass, _, _, momentum = result.table("mass", "volFieldValue.dat")[-1][1:5]
        self.assertAlmostEqual(momentum, 3 * result.volumes.sum(), delta=1e-9 * momentum)
        self.assertAlmostEqual(mass, (result.field("rho") * result.volumes).sum(), delta=1e-9 * mass)
        self.assertGreater(result.table("points", "U")[-1][3], 2.999)
        with open(os.path.join(case, "postProcessing", "extreme", "0", "fieldMinMax.dat")) as f:
            rows = [line.split() for line in f if line.split()[1:2] == ["U"]]
        self.assertGreater(float(rows[-1][2]), 2.99)

    def test_asked(self):
        """A patch whose list of values leads along the missing axis brings the component in; an expression is averaged over cells."""
        for engine in ("lattice", "polyhedral"):
            case = sections.make(os.path.join(self.folder, "asked" + engine), (8, 8, 0), bubble, lambda at: (2, 0, 0), tepid, 0.2, engine=engine,
                                 viscous=False, rules={"U": {"xLow": "fixedValue; value nonuniform List<vector> 8 (%s)" % ("(2 0 1) " * 8),
                                                             "xHigh": "zeroGradient"}})
            harness.program("granularGas", "-case", case)
            w = harness.haff.Case(case).field("U")[:, 2].reshape(8, 8)
            self.assertGreater(w[:, 0].min(), 0.5)
            self.assertLess(w[:, -1].max(), 0.1)
            case = sections.make(os.path.join(self.folder, "averaged" + engine), (8, 8, 0), tepid, lambda at: (0, 0, 0), tepid, 1e-9, engine=engine,
                                 viscous=False, fit="CWENO3", step=1e-9)
            with open(os.path.join(case, "0", "U")) as f:
                text = f.read()
            with open(os.path.join(case, "0", "U"), "w") as f:
                f.write(text.replace("internalField", 'expression ("0" "0" "x^2");\ninternalField', 1))
            harness.program("granularGas", "-case", case)
            result = harness.haff.Case(case)
            mean = 0.1**2 / 12 if engine == "polyhedral" else 0
            np.testing.assert_allclose(result.field("U")[:, 2], result.centres[:, 0]**2 + mean, rtol=1e-6)

    def test_refused(self):
        """Disks do not leave their plane."""
        case = sections.make(os.path.join(self.folder, "disks"), (8, 8, 0), bubble, swirl, tepid, 0.01, viscous=False, eos="TorquatoDisks",
                             cooling="Haff")
        for program in ("granularGas", "checkCase"):
            done = harness.program(program, "-case", case, check=False)
            self.assertEqual(done.returncode, 1)
            for word in ("granularProperties:", "is for disks", "along z", "choose spheres"):
                self.assertIn(word, done.stderr)

    def block(self, name, gravity=0.0, **options):
        """A cold dense block falls into a corner, with implicit acoustics, and slides along z, down which gravity may pull, too."""
        case = sections.make(os.path.join(self.folder, name), (12, 14, 0), packed, sliding, chilled, 0.2, step=1.25e-3, gravity=(0.0, -9.0, gravity),
                             solution="acoustics { type implicit; }\n", **options)
        harness.edit(case, "constant/granularProperties", restitution="0.9; thresholdSpeed 0.03")
        runs.add(case, "system/controlDict", "functions { budget { type energyBudget; } }\n")
        self.assertIn("implicit acoustics", harness.program("granularGas", "-case", case).stdout)
        return case

    def test_implicit_acoustics(self):
        """The same to round-off. What gravity along z gives is exact but for the mass that crosses the border of the bed in a step,
        on whose sides it acts on masses of different moments."""
        for engine in ("lattice", "polyhedral"):
            for viscous in (False, True):
                with self.subTest(engine, viscous=viscous):
                    thin, thick = (self.block(f"acoustics{engine}{viscous}{kind}", viscous=viscous, engine=engine, thick=kind == "thick")
                                   for kind in ("thin", "thick"))
                    self.assertLess(sections.difference(thin, thick, (12, 14, 0)), 1e-6)
            result = harness.haff.Case(self.block(f"pulled{engine}", 4.0, viscous=False, engine=engine))
            mass = (result.field("rho") * result.volumes).sum()
            before = harness.haff.Case(os.path.join(self.folder, f"acoustics{engine}Falsethin"))
            momentum = [(case.field("rhoU")[:, 2] * case.volumes).sum() for case in (before, result)]
            np.testing.assert_allclose(momentum[1], momentum[0] + mass * 4 * 0.2, rtol=1e-4)
            budget = forces.columns(result.path, "budget", "energyBudget.dat")
            self.assertLess(np.abs(budget["residual"]).max(), 1e-12 * np.abs(budget["gravity"]).max())

    def test_line_of_disks(self):
        """On a line they may move along one more axis: that is a plane."""
        case = sections.make(os.path.join(self.folder, "line"), (0, 20, 0), bubble, lambda at: (1 + at[:, 1], 0, 0), tepid, 0.01, viscous=False,
                             eos="TorquatoDisks", cooling="Haff")
        harness.program("granularGas", "-case", case)
        self.assertGreater(harness.haff.Case(case).field("U")[:, 0].min(), 0.9)


if __name__ == "__main__":
    unittest.main()
