# SPDX-License-Identifier: GPL-3.0-or-later
"""Sound and shocks in hot dense gas, whose cells take no implicit steps then (docs/physics.md 9.2): a threshold speed that has no effect on
the gas leaves the default the bits of explicit steps, on both engines, on any ranks and over restarts; implicit steps on demand say that
they damp waves, and are no more than explicit ones where a bed cools faster than it moves."""
import os
import re
import shutil
import unittest

import numpy as np

from tests.cases import harness

EXPLICIT, IMPLICIT = "acoustics { type explicit; }\n", "acoustics { type implicit; }\n"
PER = 6 / np.pi  # grains of mass 1 and diameter 1 per volume and alpha

def sound(x):
    return 0.5 * np.sin(np.pi * x / 20)


def streams(x):
    return np.where(x < 20, 3.0, -3.0)


class DenseSound(harness.Folder, unittest.TestCase):
    def wave(self, name, acoustics="", n=(40, 6, 1), h=1.0, u=sound, alpha=0.6, e=0.95, T=1.0, end=0.3, threshold=1e-3,
             interval=None, scheme="", walls=False, diameter=1.0, gravity=None):
        """Spheres of packing alpha that move with u along x in a box of walls, or without ends; u, T, alpha: of x (and y, if so), or numbers."""
        case, at = os.path.join(self.folder, name), harness.boxes.centres(n, np.array(n) * h)
        value = [np.broadcast_to(f(*at.T[:f.__code__.co_argcount]) if callable(f) else f, len(at)) for f in (alpha, u, T)]
        rho = value[0] * PER / diameter ** 3
        velocity = np.stack([value[1], 0 * rho, 0 * rho], axis=1)
        kind = {} if walls else {a: "cyclic" for a, k in zip("xyz", n) if k > 1}
        options = {} if gravity is None else {"gravity": gravity}
        harness.box_case(case, n, tuple(np.array(n) * h), rho, velocity, rho, end, types=kind, eos="TorquatoSpheres", e=e, cooling="Haff", courant=1.0,
                         reconstruct="TENO5", interval=interval, slip=[a + b for a in "xyz" for b in ("Low", "High")] if walls else (), **options)
        os.remove(os.path.join(case, "0", "p"))
        rules = "".join(f'"{a}.*" {"empty" if k == 1 else "zeroGradient" if walls else "cyclic"}\n' for a, k in zip("xyz", n))
        harness.boxes.write_field(case, "T", value[2], rules.strip())
        harness.edit(case, "constant/granularProperties", diameter=diameter, restitution=f"{e}; thresholdSpeed {threshold}")
        harness.write_dictionary(case, "system", "fvSolution", acoustics)
        with open(os.path.join(case, "system", "fvSchemes"), "a") as f:
            f.write(scheme)
        return case

    def run_case(self, case, ranks=1, *arguments, check=True):
        done = harness.program("granularGas", "-case", case, *arguments, ranks=ranks, check=check)
        return harness.haff.Case(case), done.stdout + done.stderr

    def same(self, a, b, time):
        for name in ("rho", "rhoU", "rhoE"):
            np.testing.assert_array_equal(a.field(name, time), b.field(name, time))

    def steps(self, log):
        return int(re.findall(r"(\d+) steps in", log)[-1])

    def test_waves(self):
        """The default says that it leaves implicit steps out, and has the explicit bits."""
        packed = {"u": 0.0, "T": lambda x, y: np.where((x - 12) ** 2 + (y - 12) ** 2 < 9, 100.0, 1.0), "n": (24, 24, 1), "end": 0.2}
        for name, options in (("squares", {}), ("fine", {"n": (80, 1, 1), "h": 0.5, "alpha": 0.58}), ("cubes", {"n": (40, 4, 4), "e": 0.9}),
                              ("hexahedra", {"scheme": "meshEngine polyhedral;\n", "end": 0.15}), ("streams", {"u": streams, "alpha": 0.59}),
                              ("piston", {"u": -3.0, "walls": True, "n": (40, 6, 1)}), ("blast", packed)):
            with self.subTest(name):
                default, log = self.run_case(self.wave(name, **options))
                end = f"{options.get('end', 0.3):g}"
                self.same(default, self.run_case(self.wave(name + "Explicit", EXPLICIT, **options))[0], end)
                self.assertEqual(log.count("implicit steps of the bed are left out: they would take "), 1)

    def test_threshold_that_has_no_effect(self):
        """The gas with a threshold of a thousandth of its speeds is the gas without one, to the cooling that this makes less (1e-5)."""
        with_threshold, without = (self.run_case(self.wave(f"threshold{v}", threshold=v))[0] for v in (1e-3, 0))
        for name in ("rho", "U", "T"):
            a, b = with_threshold.field(name, "0.3"), without.field(name, "0.3")
            np.testing.assert_allclose(a, b, atol=1e-4 * np.ptp(b))

    def settling(self, name, scheme):
        """Dense gas with a wave comes to rest under gravity: first steps are refused, then implicit."""
        return self.wave(name, n=(32 if scheme else 70, 24, 1), alpha=lambda x, y: np.where(y < 20, 0.6, 1e-4), end=1.25, interval=0.25, threshold=0.3, walls=True,
                         gravity=(0.0, -3.0, 0.0), scheme=scheme)

    def test_bits_on_ranks_and_over_restarts(self):
        """Steps are refused on any ranks alike, and the pause behind them goes on in a restart: each written time continues to the same bits."""
        for engine, scheme in (("lattice", ""), ("polyhedra", "meshEngine polyhedral; polyReconstruct linear;\n")):
            with self.subTest(engine):
                whole, log = self.run_case(self.settling(engine, scheme))
                self.assertIn("implicit acoustics:", log)
                self.assertIn("left out", log)
                again = self.settling(engine + "2", scheme)
                self.same(whole, self.run_case(again, 2)[0], "1.25")
                for time in ("1", "1.25"):
                    shutil.rmtree(os.path.join(again, time))
                with open(os.path.join(again, "0.75", "uniform", "limiter")) as f:
                    self.assertGreater(float(re.search(r"paused +(\S+);", f.read())[1]), 0)
                self.same(whole, self.run_case(again)[0], "1.25")

    def test_restart_within_a_pause(self):
        """A run that goes on in a pause tries no implicit step before that is over, as the one that went through did not."""
        whole, _ = self.run_case(self.wave("through", interval=0.1))
        again = os.path.join(self.folder, "continued")
        shutil.copytree(whole.path, again)
        for time in ("0.2", "0.3"):
            shutil.rmtree(os.path.join(again, time))
        self.run_case(again)
        said = []
        for case in (whole.path, again):
            with open(os.path.join(case, "0.3", "uniform", "limiter")) as f:
                said.append(re.findall(r"pause.*", f.read()))
        self.assertEqual(len(said[0]), 2)
        self.assertEqual(*said)

    def test_on_demand(self):
        """`implicit` damps waves, and says so once, with size and place; -strict makes an error of that, unless it is accepted."""
        log = self.run_case(self.wave("asked", IMPLICIT))[1]
        said = re.findall(r"warning: .*fvSolution:\d+: implicit steps damp waves .* takes ([\d.]+) % .* around \(([\d. ]+)\).*\[dampedSound\]", log)
        self.assertEqual(len(said), 1)
        self.assertTrue(2 < float(said[0][0]) <= 100)
        self.assertTrue(all(0 <= float(x) <= size for x, size in zip(said[0][1].split(), (40, 6, 1))))
        strict = self.run_case(self.wave("strict", IMPLICIT), 1, "-strict", check=False)[1]
        self.assertIn("-strict: warning dampedSound", strict)

    def falling(self, name, acoustics, n=(24, 16, 1), e=0.9):
        """A block of spheres falls on the floor of a box, with its middle plane as a mirror; cells of three and six grains."""
        h = 3.0 / n[0]
        return self.wave(name, acoustics, n, h, 0.0, alpha=lambda x, y: np.where((abs(x - 1.5) < 0.6) & (y < 1), 0.55, 1e-4), e=e, T=1e-3, end=0.2,
                         threshold=0.01, walls=True, diameter=0.02, gravity=(0.0, -9.81, 0.0))

    def test_block_that_cools_faster_than_it_moves(self):
        """`implicit` takes no more steps than `explicit`, and keeps the mirror image as that does."""
        for n, e in (((24, 16, 1), 0.9), ((24, 16, 1), 0.97), ((48, 32, 1), 0.9)):
            with self.subTest(n=n, e=e):
                (implicit, log), (explicit, plain) = (self.run_case(self.falling(f"{word[17:20]}{n[0]}e{e}", word, n, e)) for word in (IMPLICIT, EXPLICIT))
                self.assertLessEqual(self.steps(log), 1.1 * self.steps(plain))
                for case in (implicit, explicit):
                    for name in ("rho", "rhoE"):
                        rows = case.field(name, "0.2").reshape(n[1], n[0])
                        np.testing.assert_array_equal(rows, rows[:, ::-1])


if __name__ == "__main__":
    unittest.main()
