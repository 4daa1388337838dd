# SPDX-License-Identifier: GPL-3.0-or-later
"""haffPlot, haffMovie and haffLog as they are called: files made and files left alone, exit codes, what they say when something is wrong."""
import fcntl
import os
import shutil
import struct
import subprocess
import sys
import unittest

import numpy as np

from tests.cases import harness
from tests.postprocessing.plot import cases

COMMANDS = os.path.join(harness.SOURCE, "postprocessing", "bin", "haff")
MAGIC = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}


call = harness.command


def alone(name, *words):
    """A command of haff in a process of its own; links to bin/haff are what the build makes."""
    return subprocess.run([sys.executable, COMMANDS, name, *words], capture_output=True, text=True, timeout=120)


class Called(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.path = os.path.join(cls.folder, "case")
        at = cases.box(cls.path, (9, 7, 1), (0.9, 0.7, 0.1))
        for time, k in (("0.5", 1.0), ("1", 3.0), ("1.5", 2.0)):
            cases.fields(cls.path, time, alpha=k * at[:, 0], T=1 + at[:, 1])

    def refused(self, code, message, name, *words):
        done = call(name, *words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertRegex(done.stderr, message)
        self.assertNotIn("Traceback", done.stderr)

    def only_new(self, before, *new):
        """Nothing of the case has changed but for these new files."""
        after = cases.files(self.path)
        self.assertEqual({k: v for k, v in after.items() if k not in new}, {k: v for k, v in before.items() if k not in new})
        self.assertLessEqual(set(new), after.keys())


class Plot(Called):
    def test_without_options(self):
        before = cases.files(self.path)
        done = alone("Plot", self.path)
        made = "postProcessing/figures/alpha-T.png"
        self.assertEqual((done.returncode, done.stdout), (0, os.path.join(self.path, made) + "\n"), done.stderr)
        self.only_new(before, made)
        self.assertEqual(call("Plot", self.path, "alpha", "-line", "0,0.35,0.05:0.9,0.35,0.05", "-range", "-1:4").returncode, 0)
        self.only_new(before, made, "postProcessing/figures/alpha.png")

    def test_formats(self):
        before = cases.files(self.path)
        for suffix, magic in MAGIC.items():
            path = os.path.join(self.folder, "picture" + suffix)
            done = call("Plot", self.path, "T", "-time", "0.5", "-o", path)
            self.assertEqual((done.returncode, done.stdout), (0, path + "\n"), done.stderr)
            with open(path, "rb") as f:
                self.assertEqual(f.read(len(magic)), magic)
        self.only_new(before)
        self.assertEqual([n for n in os.listdir(self.folder) if n.endswith(".tmp")], [])

    def test_size(self):
        path = os.path.join(self.folder, "sized.png")
        self.assertEqual(call("Plot", self.path, "T", "-size", "640x480", "-o", path).returncode, 0)
        with open(path, "rb") as f:
            self.assertEqual(struct.unpack(">II", f.read(24)[16:]), (640, 480))

    def test_wrong_command_lines(self):
        for message, *words in ((r"pictures are \.png, \.pdf or \.svg", "-o", "x.jpg"), ("the lower first", "-range", "2:1"), ("two points", "-line", "0,0:1,1"),
                                ("the normal is zero", "-slice", "0,0,0:1,1,1"), (r"x=0\.5", "-slice", "w=3"), ("1200x800", "-size", "12"),
                                ("one of -slice", "-slice", "x=0.1", "-volume"), ("unrecognized arguments: -colour", "-colour", "red"),
                                ("invalid choice", "-component", "w"), ("0 or more", "-contours=-3")):
            with self.subTest(words):
                self.refused(2, message, "Plot", self.path, *words)
        self.refused(2, "required: CASE", "Plot")
        self.assertEqual(alone("Plot", self.path, "-range", "2:1").returncode, 2)

    def test_cases_that_cannot_be_drawn(self):
        self.refused(1, "no field 'alpa' at time 1.5; did you mean alpha", "Plot", self.path, "alpa")
        self.refused(1, "no time 7; the nearest is 1.5, the times are 0.5 1 1.5", "Plot", self.path, "-time", "7")
        self.assertEqual(alone("Plot", self.path, "alpa").returncode, 1)
        self.refused(1, "is no case directory", "Plot", self.folder)
        empty = os.path.join(self.folder, "empty")
        cases.control(empty)
        self.refused(1, "has no mesh .*make it by  gmshToCase", "Plot", empty)
        self.refused(1, "No such file", "Plot", self.path, "-o", os.path.join(self.folder, "nowhere", "x.png"))

    def test_help(self):
        for name in ("Plot", "Movie", "Log"):
            done = call(name, "-help")
            self.assertEqual(done.returncode, 0)
            self.assertIn(f"haff{name} CASE", done.stdout)


class Movie(Called):
    def test_gif(self):
        """A picture for each time; they differ, as alpha does, and one range holds for all."""
        from PIL import Image
        before = cases.files(self.path)
        path = os.path.join(self.folder, "film.gif")
        done = call("Movie", self.path, "alpha", "-o", path, "-fps", "5")
        self.assertEqual((done.returncode, done.stdout), (0, path + "\n"), done.stderr)
        self.only_new(before)
        with Image.open(path) as film:
            self.assertEqual((film.n_frames, film.info["duration"]), (3, 200))
            seen = []
            for k in range(3):
                film.seek(k)
                seen.append(np.asarray(film.convert("RGB")).astype(int))
        high, wide, _ = seen[0].shape
        self.assertEqual((high % 2, wide % 2), (0, 0))
        ends = [s[high // 2, int(0.8 * wide)] for s in seen]  # alpha near the right end, of 3 times the range in the second picture
        self.assertGreater(ends[1].sum(), ends[2].sum())
        self.assertGreater(ends[2].sum(), ends[0].sum())

    def test_too_few_times(self):
        one = os.path.join(self.folder, "one")
        at = cases.box(one, (9, 7, 1), (0.9, 0.7, 0.1))
        cases.fields(one, "2", alpha=at[:, 0])
        self.refused(1, r"has one time with alpha \(2\); a film needs two", "Movie", one, "alpha")
        self.refused(1, "no field 'beta'", "Movie", self.path, "beta")

    def test_mp4(self):
        path = os.path.join(self.folder, "film.mp4")
        if shutil.which("ffmpeg"):
            self.assertEqual(call("Movie", self.path, "alpha", "-o", path).returncode, 0)
            self.assertGreater(os.path.getsize(path), 1000)
        else:
            self.refused(1, "mp4 needs ffmpeg, which is not there .*film.gif needs none", "Movie", self.path, "alpha", "-o", path)
        self.refused(2, r"films are \.mp4 or \.gif", "Movie", self.path, "alpha", "-o", "x.avi")


LOG = """haff 0.1.0
Control
    from time 0 (step 0) to 2, maxCo 0.5
Time = 0.5  step 10  deltaT = 0.05 (limited by: deltaT of the first step)  Courant 0.1000
    alpha 0.1 .. 0.5  T 1 .. 3  Ma 0.2 .. 5
    mass 7 (change -2.00e-16)  momentum (1 -2)  energy 8 (change +1.00e-03)
    wall 1.0 s, 0.1 s/step
Time = 1  step 20  deltaT = 0.04 (limited by: Courant, cell at (0.1 0.2 0))  Courant 0.5000
    alpha 0.1 .. 0.6  T 1e-05 .. 4  Ma 0.2 .. 5
    mass 7 (change +1.00e-16)  momentum (1 -3)  energy 9 (change +1.25e-01)
    wall 3.0 s, 0.15 s/step, ETA 4 s
"""
END = """Time = 2  step 40  deltaT = 0.05 (limited by: write time)  Courant 0.5000
    alpha 0.1 .. 0.4  T 1 .. 2  Ma 0.2 .. 5
    mass 7 (change +1.00e-16)  momentum (1 -3)  energy 9 (change +1.25e-01)
    wall 6.0 s, 0.15 s/step
    written: 2
end at time 2: 40 steps in 6.00 s, 0.2 million cell steps per second
64.3 % of the cell updates were computed; the rest was uniform
"""
TABLE = "# Time\tstep\tdt\tlimiter\tCourant\talphaMin\talphaMax\tTMin\tTMax\tmassChange\tcomputed\tclockTime\tcpuTime\n"


class Log(Called):
    def setUp(self):
        self.path = os.path.join(self.folder, self._testMethodName)
        cases.control(self.path)

    def write(self, name, text):
        path = os.path.join(self.path, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as f:
            f.write(text)

    def read(self):
        from haff.plot import runlog
        return runlog.read(self.path)

    def test_text(self):
        self.write("log.granularGas", LOG)
        story = self.read()
        self.assertEqual(story.limiters, ["deltaT of the first step", "Courant"])
        for name, values in (("Time", [0.5, 1]), ("step", [10, 20]), ("dt", [0.05, 0.04]), ("Courant", [0.1, 0.5]), ("alphaMax", [0.5, 0.6]),
                             ("TMin", [1, 1e-5]), ("MaMax", [5, 5]), ("massChange", [-2e-16, 1e-16]), ("energyChange", [1e-3, 0.125]),
                             ("momentum_x", [1, 1]), ("momentum_y", [-2, -3]), ("clockTime", [1, 3])):
            np.testing.assert_array_equal(story.rows[name], values, name)
        self.assertEqual((story.end_time, story.ended, story.running()), (2, False, False))
        np.testing.assert_allclose(story.pace(), [[np.nan, 0.2], [np.nan, 0.25]])
        np.testing.assert_allclose(story.eta(), [np.nan, 4])
        done = call("Log", self.path)
        self.assertIn("stopped at time 1 of 2 (50 %), step 20, wall 3 s", done.stdout)
        self.assertIn("0.2 s/step, time 0.25 per second", done.stdout)
        self.assertIn("deltaT of the first step 50 %, Courant 50 %", done.stdout)

    def test_the_end_and_a_picture(self):
        self.write("log.granularGas", LOG + END)
        before = cases.files(self.path)
        path = os.path.join(self.folder, "log.svg")
        done = call("Log", self.path, "-o", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("ended at time 2 of 2 (100 %), step 40, wall 6 s", done.stdout)
        self.assertIn("64.3 % of the updates were computed", done.stdout)
        self.only_new(before)
        with open(path) as f:
            self.assertIn("<svg", f.read())

    def test_tables(self):
        """Tables of two starts behind one another; the second repeats a time; a torn last line is left out; the table goes before the log."""
        row = "{}\t{}\t{}\t{}\t0.5\t0.1\t0.5\t1\t{}\t1e-16\t0.75\t{}\t1\n"
        self.write("postProcessing/run/0/run.dat", TABLE + row.format(0, 0, 0, "start", 1, 0) + row.format(0.5, 5, 0.1, "write_time", 2, 1)
                   + row.format(1, 10, 0.1, "Courant", 3, 2) + row.format(1.2, 12, 0.1, "Courant", 4, 3))
        self.write("postProcessing/run/1/run.dat", TABLE + row.format(1, 10, 0, "start", 3, 0) + row.format(1.1, 11, 0.1, "free_fall", 7, 1)
                   + row.format(1.5, 15, 0.1, "Courant", 8, 2) + "1.6\t16\t0.")
        self.write("log.granularGas", LOG)
        story = self.read()
        np.testing.assert_array_equal(story.rows["Time"], [0.5, 1, 1.1, 1.5])
        np.testing.assert_array_equal(story.rows["TMax"], [2, 3, 7, 8])
        self.assertEqual(story.limiters, ["write time", "Courant", "free fall", "Courant"])
        np.testing.assert_array_equal(story.parts, [0, 0, 1, 1])
        np.testing.assert_allclose(story.pace()[0], [np.nan, 0.2, np.nan, 0.25])
        self.assertEqual(story.computed, 0.75)

    def test_rest_of_a_run(self):
        """The time that is left goes by the pace of the last fifth of the clock: nothing before it tells. Each start begins anew."""
        from haff.plot.runlog import Story
        clock, t = np.array([0, 50, 80, 90, 100.0]), np.array([0, 5, 5.5, 5.7, 6])
        story = Story("", "", {"clockTime": clock, "Time": t}, [""] * 5, np.zeros(5), end_time=8)
        np.testing.assert_allclose(story.eta(), [np.nan, 3 * 50 / 5, 2.5 * 30 / 0.5, 2.3 * 10 / 0.2, 2 * 20 / 0.5])
        story.parts, story.end_time = np.array([0, 0, 1, 1, 1]), 5
        np.testing.assert_array_equal(np.isnan(story.eta()), [True, False, True, False, False])
        np.testing.assert_array_equal(story.eta()[3:], 0)

    def test_follow_ends_with_the_run(self):
        """While another holds the lock of the case it waits; once the run has ended it says so and ends."""
        self.write("log.granularGas", LOG)
        self.write(".haff.lock", "granularGas, pid 1\n")
        with open(os.path.join(self.path, ".haff.lock"), "r+") as lock:
            fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            run = subprocess.Popen([sys.executable, COMMANDS, "Log", self.path, "-follow", "-every", "0.1"], stdout=subprocess.PIPE, text=True)
            first = run.stdout.readline()
            self.assertIn("running at time 1 of 2", first)
            self.assertIsNone(run.poll())
            self.write("log.granularGas", LOG + END)
            out, _ = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 0)
        self.assertIn("ended at time 2 of 2", out)

    def test_nothing_to_tell(self):
        self.refused(1, "neither postProcessing/run/.*nor a log with steps: run it, and keep the log", "Log", self.path)
        self.refused(1, "is not there", "Log", self.path, "-log", os.path.join(self.path, "other"))
        self.refused(1, "is no case directory", "Log", self.folder)
        self.refused(2, "0.05 to 86400", "Log", self.path, "-every", "0")


if __name__ == "__main__":
    unittest.main()
