# SPDX-License-Identifier: GPL-3.0-or-later
"""The measures of patterns on layers whose waves are known: with noise, without a wave, with the wrong period, growing;
from arrays and from the files of a case. The mean of the strongest wavelengths is shown to be the worse estimator."""
import os
import re
import shutil
import tempfile
import unittest

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes

from haff.layers import faraday
from studies.exact import disks

L, CELLS, CYCLES = 300.0, 150, 50
X = (np.arange(CELLS) + 0.5) * L / CELLS
PHASES = {0.0: 1.0, 0.25: 0.5, 0.5: 0.05, 0.75: 0.0}  # of the period: how high the wave then is


def wave(mode, amplitude=1.8, noise=0.6, seed=1, period=2, jitter=0.2):
    """Samples of a wave that turns over with `period` and wanders, each column shaken by independent noise."""
    rng = np.random.default_rng(seed)
    cycles, places = np.arange(20, 20 + CYCLES), np.cumsum(rng.normal(0, jitter, CYCLES))
    found = []
    for high in PHASES.values():
        sign = np.cos(2 * np.pi * cycles / period)
        clean = amplitude * high * sign[:, None] * np.cos(2 * np.pi * mode * X / L + 0.7 + places[:, None])
        found.append((cycles, faraday.modes(5 + clean + rng.normal(0, noise, (CYCLES, CELLS)))))
    return found


class Measures(unittest.TestCase):
    def test_amplitude_and_phase(self):
        c = faraday.modes((3 + 1.5 * np.cos(2 * np.pi * 4 * X / L + 0.4) - 0.2 * np.sin(2 * np.pi * 9 * X / L))[None])[0]
        np.testing.assert_allclose(c[[0, 4, 9]], [3, 1.5 * np.exp(0.4j), 0.2j], atol=1e-13)
        self.assertLess(np.abs(np.delete(c, [0, 4, 9])).max(), 1e-13)
        self.assertAlmostEqual(faraday.spectrum(c[None])[4], 1.5**2 / 2, places=12)

    def test_wave_in_noise(self):
        """Noise of 0.6 in a column is 0.1 in a mode; the wave is 1.8 at one phase and drowned at two of four."""
        for mode in (5, 8, 11):
            for seed in range(5):
                found = wave(mode, seed=seed)
                result = faraday.measure(found, L)
                self.assertEqual(result["mode"], mode)
                self.assertEqual(result["wavelength"], L / mode)
                self.assertTrue(result["stands"])
                self.assertEqual(result["phase"], 0)
                self.assertLess(result["flip"], -0.95)
                self.assertLess(abs(L / result["centroid"] - mode), 0.1)
                np.testing.assert_allclose([result["shorter"], result["longer"]], [L / (mode + 1), L / (mode - 1)])
                # one column of variance 0.36: 2 * 0.36 / CELLS in each mode, half of it alternates
                self.assertLess(abs(result["floor"] / (0.36 / CELLS) - 1), 0.06)

    def test_worse_estimator(self):
        """The mean of the strongest wavelengths misses by more than the box's quantum, with a deviation of its own size."""
        for seed in range(5):
            found = wave(8, seed=seed)
            mean, deviation = faraday.strongest(found, L)
            result = faraday.measure(found, L)
            self.assertGreater(abs(mean - L / 8), 2 * abs(result["centroid"] - L / 8))
            self.assertGreater(deviation, 5 * result["spread"] + 5)

    def test_between_two_modes(self):
        a, b = wave(7, amplitude=1.2, seed=3), wave(8, amplitude=1.2, seed=4)
        both = [(n, c + d) for (n, c), (_, d) in zip(a, b)]
        result = faraday.measure(both, L)
        self.assertIn(result["mode"], (7, 8))
        self.assertLess(abs(L / result["centroid"] - 7.5), 0.25)
        self.assertGreater(result["spread"], 1.5)

    def test_harmonic_is_not_the_pattern(self):
        cycles, c = wave(6, seed=5)[0]
        c = c + 0.6 * wave(12, seed=6)[0][1]
        self.assertLess(abs(L / faraday.measure([(cycles, c)], L)["centroid"] - 6), 0.1)

    def test_noise_is_no_pattern(self):
        for seed in range(60):
            result = faraday.measure(wave(8, amplitude=0.0, seed=seed), L)
            self.assertFalse(result["stands"], f"seed {seed}: {faraday.describe(result)}")

    def test_wave_of_the_plate_is_no_pattern(self):
        """A wave that stays as it is from period to period, as a tilted box would make."""
        found = wave(8, period=1)
        self.assertGreater(faraday.flip(found[0][1][:, 8], found[0][0]), 0.9)
        self.assertFalse(faraday.measure(found, L)["stands"])

    def slow(self, size, seed=2):
        """Amplitudes of long waves that come and go without a period, and little noise."""
        rng = np.random.default_rng(seed)
        a = np.zeros((CYCLES, CELLS // 2 + 1), complex)
        for n in range(1, CYCLES):
            a[n, 1:4] = 0.8 * a[n - 1, 1:4] + size * (rng.normal(size=3) + 1j * rng.normal(size=3))
        return a + 0.05 * (rng.normal(size=a.shape) + 1j * rng.normal(size=a.shape))

    def test_slow_waves_are_no_pattern(self):
        a = self.slow(1.0)
        self.assertGreater(faraday.spectrum(a)[1:4].min(), 100 * np.median(faraday.spectrum(a)))
        self.assertFalse(faraday.measure([(np.arange(CYCLES), a)], L)["stands"])

    def test_pattern_under_slow_waves(self):
        """The alternating part finds a wave that is lower than the grains' sloshing."""
        cycles, c = wave(8, amplitude=0.8, noise=0.3)[0]
        c = c + self.slow(0.6)
        self.assertLess(np.argmax(faraday.spectrum(c)), 4)
        result = faraday.measure([(cycles, c)], L)
        self.assertEqual(result["mode"], 8)
        self.assertTrue(result["stands"])

    def test_cycles_must_follow(self):
        cycles, c = wave(8)[0]
        with self.assertRaisesRegex(ValueError, "follow each other"):
            faraday.measure([(cycles[::2], c[::2])], L)

    def test_jumps(self):
        cycles, c = wave(8, noise=0.0, jitter=0.0)[0]
        np.testing.assert_allclose(faraday.jumps(c[:, 8], cycles), np.pi, atol=1e-10)

    def test_growth(self):
        cycles = np.arange(40)
        rng = np.random.default_rng(3)
        for factor in (1.3, 1.7):
            c = np.exp(rng.normal(0, 0.02, 40)) / (1 / 1.8 + 1 / (0.002 * factor**cycles))  # saturates at 1.8
            noisy = np.abs(c * np.exp(1j) + 0.003 * (rng.normal(size=40) + 1j * rng.normal(size=40)))
            found, first, last = faraday.growth(cycles, noisy, 0.003 * np.sqrt(2))
            self.assertLess(abs(found / factor - 1), 0.07)
            self.assertGreater(first, 2)
            self.assertLess(noisy[last], 0.91)
        self.assertTrue(np.isnan(faraday.growth(cycles, np.full(40, 0.1), 0.1)[0]))

    def test_fastest(self):
        """Findings, section 1: 1.617 (42.9), 1.681 (37.5), 1.573 (33.3) give 38.1."""
        found = faraday.fastest([300 / 7, 300 / 8, 300 / 9], [1.617, 1.681, 1.573])
        self.assertLess(abs(found - 38.1), 0.1)
        self.assertTrue(np.isnan(faraday.fastest([3, 2, 1], [1.5, 1.2, 1.4])))


G = "dimensions [0 1 -2 0 0 0 0]; // 1 2 3\nvalue ({0});\n"
SHAKING = "type sinusoidal; amplitude 2.75; // Gamma\nfrequency 4; phase 1.5707963267948966;\n"


class Files(unittest.TestCase):
    """A layer written into a case: a bell curve of alpha about the height wanted."""

    def setUp(self):
        self.case = tempfile.mkdtemp(prefix="haff")
        self.n, self.size = (60, 40, 1), (120.0, 20.0, 1.0)
        os.makedirs(os.path.join(self.case, "system"))
        self.gravity(1, "0 -981 0")

    def tearDown(self):
        shutil.rmtree(self.case)

    def gravity(self, up, value):
        """The plate lies across axis `up`, 0 or 1."""
        boxes.write_dictionary(self.case, "constant", "g", G.format(value))
        boxes.write_dictionary(self.case, "constant", "shaking", SHAKING)
        self.up = up
        turn = [1, 0, 2] if up == 0 else [0, 1, 2]
        n, size = [self.n[k] for k in turn], [self.size[k] for k in turn]
        boxes.write_mesh(self.case, n, size, {"xy"[1 - up]: "cyclic"})
        self.at = boxes.centres(n, size)

    def layer(self, t, height, **fields):
        """height: function of the place across."""
        y, x = self.at[:, self.up], self.at[:, 1 - self.up]
        boxes.write_field(self.case, "alpha", 0.5 * np.exp(-((y - height(x)) ** 2) / 4), time="%g" % t)
        for name, values in fields.items():
            boxes.write_field(self.case, name, values, time="%g" % t)

    def test_heights(self):
        self.layer(1, lambda x: 8 + np.sin(2 * np.pi * x / 40))
        layer = faraday.Layer(self.case)
        np.testing.assert_allclose(layer.height("1"), 8 + np.sin(2 * np.pi * layer.x / 40), atol=1e-4)
        self.assertEqual((layer.length, layer.frequency, layer.acceleration, layer.dim), (120, 4, 2.75, 2))
        self.assertAlmostEqual(layer.amplitude, 981 * 2.75 / (8 * np.pi) ** 2, places=12)
        boxes.write_dictionary(self.case, "constant", "shaking",
                               SHAKING.replace("2.75", "table\n(\n    (0 2.75)\n    (2 2.5)\n)"))
        ramped = faraday.Layer(self.case)
        self.assertEqual((ramped.frequency, ramped.acceleration), (4, 2.5))

    def test_without_shaking(self):
        """A layer that is not shaken has heights, and no phases: the command says so."""
        os.remove(os.path.join(self.case, "constant", "shaking"))
        self.layer(1, lambda x: 8 + 0 * x)
        done = harness.command("faraday", self.case)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"is not shaken \(it has no constant/shaking\)")

    def test_mass_and_lift(self):
        """Two heights, half the columns with a third of the mass of the others."""
        x, y = self.at[:, 0], self.at[:, 1]
        left = x < 60
        alpha = np.where(left, 0.1 * (np.abs(y - 10.25) < 0.1), 0.3 * (np.abs(y - 6.25) < 0.1))
        boxes.write_field(self.case, "alpha", alpha, time="1")
        layer = faraday.Layer(self.case)
        np.testing.assert_allclose(layer.mass("1"), np.where(layer.x < 60, 0.5, 1.5), rtol=1e-12)
        np.testing.assert_allclose(layer.height("1"), np.where(layer.x < 60, 10.25, 6.25), rtol=1e-12)
        mean = 7.25  # of the mass
        np.testing.assert_allclose(layer.lift("1"), layer.mass("1") * (layer.height("1") - mean), atol=1e-12)
        self.assertAlmostEqual(layer.lift("1").sum(), 0, places=10)

    def test_gravity_up_an_axis(self):
        """As in cases/vibratedLayer: the plate is where x is greatest."""
        self.gravity(0, "981 0 0")
        self.layer(1, lambda x: 20 - (8 + np.sin(2 * np.pi * x / 40)))
        layer = faraday.Layer(self.case)
        np.testing.assert_allclose(layer.height("1"), 8 + np.sin(2 * np.pi * layer.x / 40), atol=1e-4)

    def test_empty_column(self):
        x, y = self.at[:, 0], self.at[:, 1]
        boxes.write_field(self.case, "alpha", np.where((x > 30) & (np.abs(y - 5.25) < 0.1), 0.3, 0.0), time="1")
        np.testing.assert_allclose(faraday.Layer(self.case).height("1"), 5.25, atol=1e-9)

    def test_profile(self):
        """Two halves that move against each other at T = 1 have T = 1 + 9/dim of the whole; the mean of U is by mass."""
        right = self.at[:, 0] > 60
        U = np.zeros((len(self.at), 3))
        U[:, 1] = np.where(right, 3, -3)
        flat = lambda x: 6 + 0 * x
        self.layer(1, flat, U=U, T=np.ones(len(self.at)), p=np.where(right, 2.0, 4.0))
        layer = faraday.Layer(self.case)
        found = layer.profile("1")
        np.testing.assert_allclose(found["T"], 1 + 9 / 2, rtol=1e-12)
        np.testing.assert_allclose(layer.profile("1", dim=3)["T"], 1 + 9 / 3, rtol=1e-12)
        np.testing.assert_allclose(found["U"], 0, atol=1e-12)
        np.testing.assert_allclose(found["p"], 3, rtol=1e-12)
        np.testing.assert_allclose(found["alpha"], 0.5 * np.exp(-((found["y"] - 6) ** 2) / 4), rtol=1e-12)
        self.assertTrue((np.diff(found["y"]) > 0).all())

    def test_crests_and_valleys(self):
        """Over two times with the wave turned over in between."""
        zero = dict(U=np.zeros((len(self.at), 3)), T=np.zeros(len(self.at)))
        for n, sign in ((1, 1), (2, -1)):
            self.layer(n, lambda x: 8 + 3 * sign * np.cos(2 * np.pi * x / 40 + 0.3), **zero)
        layer = faraday.Layer(self.case)
        for where, centre in (("valleys", 5.3), ("all", 8), ("crests", 10.7)):
            masks = [layer.crests(t, 3, where == "valleys", "height") for t in ("1", "2")]
            self.assertLess(np.count_nonzero(masks[0] & masks[1]), 1)
            found = layer.profile(["1", "2"], None if where == "all" else masks)
            self.assertAlmostEqual(found["alpha"] @ found["y"] / found["alpha"].sum(), centre, delta=0.1)

    def test_interface(self):
        """Where the packing falls below 5 %: the last such height, and the Mach number there, of known profiles."""
        y = np.arange(0.5, 30)
        p = {"y": y, "alpha": 0.6 * np.exp(-y / 4), "U": -3 * y, "T": 2 + 0 * y}
        height, number = faraday.interface(p, disks.Disks(0.75))
        self.assertAlmostEqual(height, 4 * np.log(12), places=9)
        chi, slope = (1 - 0.436 * 0.05) / 0.95**2, (-0.436 * 0.95 + 2 * (1 - 0.436 * 0.05)) / 0.95**3
        A = 1 + 1.75 * 0.05 * chi
        c = np.sqrt(2 * (A + 1.75 * 0.05 * (chi + 0.05 * slope) + A * A))
        self.assertAlmostEqual(number, 3 * height / c, places=6)
        gap = {**p, "alpha": np.where(y < 3, 0.01, p["alpha"])}
        self.assertEqual(faraday.interface(gap, disks.Disks(0.75))[0], height)
        self.assertTrue(np.isnan(faraday.interface({**p, "alpha": 0 * y + 1e-3}, disks.Disks(0.75))[0]))

    def test_pairs(self):
        """Heaps of a wave of 30 that turns over lie where they lay two cycles before; valleys between them."""
        zero = dict(U=np.zeros((len(self.at), 3)), T=np.zeros(len(self.at)))
        x, y = self.at[:, 0], self.at[:, 1]
        for n in range(1, 8):
            for phase in (0, 0.25, 0.5, 0.75):
                wave = 1 + 0.5 * np.cos(np.pi * (n + phase)) * np.cos(2 * np.pi * x / 30)
                boxes.write_field(self.case, "alpha", 0.3 * wave * (y < 6), time="%g" % ((n + phase) / 4))
                for name, values in zero.items():
                    boxes.write_field(self.case, name, values, time="%g" % ((n + phase) / 4))
        layer = faraday.Layer(self.case)
        mode, found = faraday.pairs(layer, 2)
        self.assertEqual((mode, len(found)), (4, 3))
        names, mask = found[0]
        self.assertEqual([names[p] for p in sorted(names)], ["%g" % (0.5 + k / 16) for k in range(8)])
        self.assertTrue((np.cos(2 * np.pi * layer.x[mask] / 30) > 0.6).all())
        np.testing.assert_array_equal(mask, found[1][1])
        valleys = faraday.pairs(layer, 2, heaps=False)[1][0][1]
        self.assertTrue((np.cos(2 * np.pi * layer.x[valleys] / 30) < -0.6).all())

    def test_figures(self):
        """All pictures, of gas and grains that are the same run; the numbers of a known layer."""
        x, y = self.at[:, 0], self.at[:, 1]
        for n in range(1, 8):
            for phase in (0, 0.25, 0.5, 0.75):
                wave = 1 + 0.5 * np.cos(np.pi * n) * np.cos(2 * np.pi * x / 30)
                boxes.write_field(self.case, "alpha", 0.3 * wave * np.exp(-y / 3), time="%g" % ((n + phase) / 4))
                boxes.write_field(self.case, "U", np.outer(np.full(len(x), 5.0), (0, 1, 0)), time="%g" % ((n + phase) / 4))
                boxes.write_field(self.case, "T", np.full(len(x), 2.0), time="%g" % ((n + phase) / 4))
        boxes.write_dictionary(self.case, "constant", "granularProperties", "grain { diameter 1; mass 1; restitution 0.75; }\n")
        out = os.path.join(self.case, "figures")
        done = harness.command("faradayFigures", self.case, self.case, out, "-gas", "1", "-grains", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(os.listdir(out)), ["mach.png", "momentum.png", "patterns.png", "profiles.png"])
        alone = harness.command("faradayFigures", self.case, self.case, out + "5", "-gas", "1", "-grains", "2", "-only", "mach")
        self.assertEqual((alone.returncode, os.listdir(out + "5")), (0, ["mach.png"]), alone.stderr)
        self.assertEqual(alone.stdout.splitlines()[-1], os.path.join(out + "5", "mach.png"), "the last line is the path, as Allrun wants")
        heap = [float(v) for v in re.findall(r"^grains t = .*?heap at t = 0: at the plate (\S+),", done.stdout, re.M)]
        valley = [float(v) for v in re.findall(r"^grains t = .*?valley: at the plate (\S+),", done.stdout, re.M)]
        self.assertEqual((len(heap), len(valley)), (8, 8))
        self.assertGreater(heap[0], 0.35)
        self.assertLess(heap[4], 0.2)
        np.testing.assert_allclose(heap[0] + valley[0], heap[4] + valley[4], atol=0.01)
        self.assertEqual(len(re.findall(r"Mach 2\.\d\d", done.stdout)), 4)

    def test_command(self):
        rng = np.random.default_rng(4)
        for n in range(8):
            for phase, high in ((0, 2.0), (0.5, 0.1)):
                noise = rng.normal(0, 0.1, 60)
                up = lambda x: high * (-1)**n * np.cos(2 * np.pi * x / 30)
                self.layer((n + 1 + phase) / 4, lambda x: 8 + up(x) + noise[(x / 2).astype(int)])
        picture = os.path.join(self.case, "pattern.png")
        done = harness.command("faraday", self.case, "-of", "height", "-from", "3", "-figure", picture)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"^pattern: wavelength 30 \(24 \.\. 40\), centroid 30")
        last = re.search(r"phase 0.000 of the period, cycles 3 to 8: amplitude of height (\S+), "
                         r"mean height of the columns (\S+)\n", done.stdout)
        np.testing.assert_allclose([float(v) for v in last.groups()], [2, 8], atol=0.1)
        self.assertTrue(os.path.exists(picture))
        done = harness.command("faraday", self.case, "-from", "7.9")
        self.assertEqual(done.returncode, 1)
        self.assertIn("three cycles", done.stderr)

    def test_one_column(self):
        """As cases/vibratedLayer: profiles, but no waves."""
        self.n, self.size = (1, 40, 1), (1.0, 20.0, 1.0)
        self.gravity(1, "0 -981 0")
        self.layer(1, lambda x: 6 + 0 * x, U=np.outer(self.at[:, 1], (0, 2, 0)), T=np.full(len(self.at), 3.0))
        found = faraday.Layer(self.case).profile("1", dim=3)
        np.testing.assert_allclose(found["T"], 3, rtol=1e-9)
        np.testing.assert_allclose(found["U"], 2 * found["y"], rtol=1e-12)
        done = harness.command("faraday", self.case)
        self.assertEqual(done.returncode, 1)
        self.assertIn("1 cells wide", done.stderr)

    def test_no_box(self):
        hole = self.at[:, 0] < 3
        boxes.write_mesh(self.case, self.n, self.size, hole=hole & (self.at[:, 1] < 3))
        with self.assertRaisesRegex(ValueError, "no full box"):
            faraday.Layer(self.case)


if __name__ == "__main__":
    unittest.main()
