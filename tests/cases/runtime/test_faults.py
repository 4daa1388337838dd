# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever is done to a run, no result is lost that had been reported as written, and the message says what to do."""
import contextlib
import ctypes
import functools
import gzip
import itertools
import os
import random
import re
import shutil
import signal
import subprocess
import time
import unittest
import zlib

from tests.cases import harness, runs
from tests.faults import faults

GAS = os.path.join(harness.BIN, "granularGas")
CONTROL = "system/controlDict"


def start(case, **options):
    """The solver, running: its first step is behind it."""
    run = subprocess.Popen([GAS, "-case", case], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)
    for line in run.stdout:
        if line.startswith("Time ="):
            break
    return run


def try_it(case, *options, **more):
    return subprocess.run([GAS, "-case", case, *options], capture_output=True, text=True, timeout=120, **more)


class Lock(harness.Folder, unittest.TestCase):
    def endless(self, name):
        return runs.make(os.path.join(self.folder, name), (40, 30, 1), 1e6)

    def end(self, run, number):
        run.send_signal(number)
        run.communicate(timeout=60)

    def test_second_run(self):
        """Refused while the first one runs, on any number of ranks; readers are not."""
        case = self.endless("two")
        run = start(case)
        for options in ((), ("-np", "2")):
            done = try_it(case, *options)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertRegex(done.stderr, rf"{case}: another run works on this case: granularGas, pid {run.pid} on \S+ since \d+-")
        for program in ("checkCase", "caseToVTK"):
            harness.program(program, case)
        self.assertIsNone(run.poll())
        self.end(run, signal.SIGTERM)
        self.assertEqual(run.returncode, 0)
        self.assertEqual(runs.hidden(case), [])
        self.assertEqual(len(runs.times(case)), 2)

    def test_killed_run(self):
        """The file that a killed run leaves behind is no obstacle, nor is that of a copy."""
        case = self.endless("killed")
        run = start(case)
        copied = shutil.copytree(case, case + "_copy")
        self.end(run, signal.SIGKILL)
        for folder in (case, copied):
            self.assertIn(".haff.lock", runs.hidden(folder))
            again = start(folder)
            self.end(again, signal.SIGTERM)
            self.assertEqual(again.returncode, 0)
            self.assertEqual(runs.hidden(folder), [])

    def test_lock_that_is_a_link(self):
        """What the link leads to is not touched."""
        case = self.endless("link")
        outside = os.path.join(self.folder, "outside")
        with open(outside, "w") as f:
            f.write("mine")
        os.symlink(outside, os.path.join(case, ".haff.lock"))
        done = try_it(case)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(".haff.lock: this is a link", done.stderr)
        with open(outside) as f:
            self.assertEqual(f.read(), "mine")

    def test_hang_up(self):
        """A terminal that closes is a wish to stop, unless nohup says no."""
        for ignored in (False, True):
            case = self.endless(f"terminal{ignored}")
            runs.add(case, CONTROL, "logInterval 1;\n")
            run = start(case, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN if ignored else signal.SIG_DFL))
            run.send_signal(signal.SIGHUP)
            if ignored:  # it goes on
                self.assertGreater(sum(line.startswith("Time =") for line in itertools.islice(run.stdout, 1000)), 100)
                run.send_signal(signal.SIGTERM)
            text = run.communicate(timeout=60)[0]
            self.assertEqual(run.returncode, 0)
            self.assertIn("stopped as asked", text)
            self.assertEqual(len(runs.times(case)), 2)


class Faults(harness.Folder, unittest.TestCase):
    """Every row of the fault table, in short: set HAFF_KILLS=1000 for the long form (an hour)."""
    SAYS = {"the disk is full": "No space left on device", "an input/output error": "Input/output error", "a disk of 2 MB": "No space left",
            "files may not grow": "earlier times are intact", "the case folder is not writable": "chmod u\\+w",
            "becomes unwritable": "earlier times are intact", "moved away during the run$": "this folder is gone",
            "put in its place": "another folder stands here",
            "the disk of the log": "the log is incomplete", "a second solver": "another run works on this case: granularGas, pid",
            "cut in half$": r"rhoE: the file has \d+ bytes, the run wrote \d+", "previous": r"goes on from time 0\.0004",
            "one bit": "not as it was written", "is removed": "the file is missing", "restitution": r"restitution 0\.9 -> 0\.8",
            "as many cells": "another mesh", "other cells": "put that mesh back", "a wish to stop": "stopped as asked",
            "controlDict is broken": r"controlDict:\d+: ", "EACCES": "Permission denied", "EXDEV": "Invalid cross-device link",
            "LAMMPS is killed": r"LAMMPS was ended by signal 9 \(Killed\); the times written before are whole",
            r"then sent on": r"LAMMPS \(pid N\) is stopped;  kill -CONT N  lets the run go on$",
            r"asked to end \(SIGTERM": "asked to end while LAMMPS was stopped, and ends without its state; the times written before are whole",
            "grains at 1e300": "grain 1 at .*, far outside of the box", "negative number": "without a number of rows"}

    def test_table(self):
        kills = int(os.environ.get("HAFF_KILLS", 10))
        seen = set()
        for outcome in faults.every_fault(self.folder, 1 if kills > 100 else 31, kills):
            if not outcome:
                continue  # it cannot be done here
            with self.subTest(outcome.done):
                self.assertGreater(outcome.times, 0)
                self.assertEqual(outcome.lost, [], outcome.said)
                self.assertEqual(outcome.after, [])
                for what, says in self.SAYS.items():
                    if re.search(what, outcome.done):
                        seen.add(what)
                        self.assertRegex(outcome.said, says)
        needs_root = {"a disk of 2 MB", "the case folder is not writable", "becomes unwritable"}
        needs_lammps = {what for what, says in self.SAYS.items() if "LAMMPS" in says} | {"grains at 1e300", "negative number"} if not shutil.which("lmp") else set()
        self.assertLessEqual(self.SAYS.keys() - seen, needs_root | needs_lammps)


class SlowDisk(harness.Folder, unittest.TestCase):
    """The run goes on while a time is on its way to the disk."""
    SLOW = 0.2  # s, that fsync takes

    def test_waits_together(self):
        """Files are brought to the disk together, beside the run: four times wait less than one by one two of them would."""
        case = faults.make(self.folder, "together", steps=4)
        begin = time.monotonic()
        done = faults.run(case, fault=f"slow:{1000 * self.SLOW:.0f}")
        took = time.monotonic() - begin
        self.assertEqual(done.returncode, 0, done.stderr)
        names = faults.reported(done.stdout)
        self.assertEqual(names, ["0.0002", "0.0004", "0.0006", "0.0008"])
        waits = [1 + sum(1 + len(files) for _, _, files in os.walk(os.path.join(case, name))) for name in names]
        self.assertGreater(min(waits), 10)
        self.assertLess(took, self.SLOW * sum(waits[:2]))
        steps = [found.start() for found in re.finditer("^Time = ", done.stdout, flags=re.M)]
        said = [done.stdout.index(f"    written: {name}\n") for name in names]
        self.assertTrue(any(a > b for a, b in zip(said, steps[1:])), "no step was taken while a time was on its way")
        straight = faults.straight_run(self.folder, "straight", steps=4)
        for name in names:
            self.assertEqual(runs.contents(os.path.join(case, name)), runs.contents(os.path.join(straight, name)), name)

    def test_killed_before_it_is_said(self):
        """A time that is on its way when the run is killed is not reported; on one rank and two, which share the folders of parts."""
        for ranks in (1, 2):
            case = faults.make(self.folder, f"killed{ranks}", steps=3)
            if ranks > 1:
                runs.add(case, CONTROL, "writeProcessors yes;\n")
            slow = {"LD_PRELOAD": os.path.join(harness.BIN, "faultydisk.so"), "HAFF_FAULT": "slow:500", "HAFF_FAULT_FOLDER": case}
            command = (GAS,) if ranks == 1 else (os.path.join(harness.BIN, "mpirun"), "-np", "2", GAS)
            going, text = faults.start(case, 2, "Time =", command, env={**os.environ, **slow}, start_new_session=True)
            os.killpg(going.pid, signal.SIGKILL)
            text += faults.rest(going)[0]
            for name in faults.reported(text):
                self.assertTrue(faults.whole(case, name), name)
            self.assertLess(len(runs.times(case)), 3)
            again = try_it(case)
            self.assertEqual((again.returncode, runs.hidden(case)), (0, []), again.stderr)
            self.assertEqual(runs.times(case)[-1], "0.0006")


    def test_two_times_fail(self):
        """Of a time on its way to the disk and the one behind it, which both fail, the error names the first."""
        case = faults.make(self.folder, "moved", steps=3)
        slow = {"LD_PRELOAD": os.path.join(harness.BIN, "faultydisk.so"), "HAFF_FAULT": "slow:1500", "HAFF_FAULT_FOLDER": case}
        going, _ = faults.start(case, 2, "Time =", (GAS,), env={**os.environ, **slow})
        os.rename(case, case + ".away")
        said = going.communicate(timeout=60)[1]
        self.assertNotEqual(going.returncode, 0)
        self.assertRegex(said, "error: while writing time 0.0002; earlier times are intact")


@unittest.skipUnless(shutil.which("lmp"), "needs LAMMPS")
class Orphans(harness.Folder, unittest.TestCase):
    def descendants(self, pid):
        with open(f"/proc/{pid}/task/{pid}/children") as f:
            children = [int(child) for child in f.read().split()]
        return children + [one for child in children for one in self.descendants(child)]

    def test_stopped_lammps(self):
        """LAMMPS that is stopped ends when the run is killed. The kernel wakes and ends it where its new parent is in another session; here that
        is this process, in the same one, as the first process of a container may be."""
        subreaper = functools.partial(ctypes.CDLL(None).prctl, 36)  # PR_SET_CHILD_SUBREAPER
        self.addCleanup(subreaper, 0)
        self.assertEqual(subreaper(1), 0)
        for ranks, processes in (("1", 1), ("2", 3)):
            case = faults.soft_bed(self.folder, ranks)
            going, _ = faults.start(case, command=(faults.DEM, "-np", ranks))
            children = self.descendants(going.pid)
            self.assertEqual(len(children), processes)  # mpirun is the first of three
            for pid in children[-2:]:
                os.kill(pid, signal.SIGSTOP)
            going.kill()
            left = [pid for pid in children if faults.runs_on(pid, 5)]
            for pid in left:
                os.kill(pid, signal.SIGKILL)
            faults.rest(going)
            self.assertEqual(left, [], f"{ranks} ranks")
            with contextlib.suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass


class Checksums(harness.Folder, unittest.TestCase):
    FORMS = {"ascii": {"format": "ascii", "digits": 6}, "binary": {}, "zipped": {"compression": "on"},
             "zipped ascii": {"format": "ascii", "digits": 6, "compression": "on"}}

    def written(self, name, **options):
        """A case of 36 cells that has written 0.001, 0.002, 0.003 and may go on to 0.004."""
        case = runs.make(os.path.join(self.folder, name), (6, 6, 1), 0.003, interval=0.001, **options)
        harness.program("granularGas", "-case", case)
        harness.edit(case, CONTROL, endTime=0.004)
        return case

    def test_cover_all_that_is_written(self):
        """By Python's zlib, in every form, and in the processor folders of one and two ranks."""
        for form, options in self.FORMS.items():
            case = runs.make(os.path.join(self.folder, "all " + form), (70, 40, 1), 0.002, interval=0.001, **options)
            runs.add(case, CONTROL, "writeProcessors yes;\n")
            parts = 2 if form in ("binary", "zipped ascii") else 1
            harness.program("granularGas", "-case", case, ranks=parts)
            for folder in ("", "processor0", "processor1")[:parts + 1]:
                folder = os.path.join(case, folder, "0.002")
                sums = faults.sums(folder)
                there = runs.contents(folder, ignore=("provenance", "checksums"))
                self.assertEqual(sums.keys(), {name.removesuffix(".gz") for name in there})
                self.assertLess({*runs.FIELDS}, sums.keys())
                for name, (size, crc) in sums.items():
                    data = faults.stored(folder, name)[1]
                    self.assertEqual((len(data), zlib.crc32(data)), (size, crc), f"{form} {folder}/{name}")
        self.assertEqual(faults.sums(os.path.join(self.folder, "all binary", "0.002")), faults.sums(os.path.join(self.folder, "all zipped", "0.002")))

    @unittest.skipUnless(shutil.which("foamDictionary"), "OpenFOAM is not installed")
    def test_openfoam_reads_them(self):
        case = self.written("foreign")
        said = subprocess.run(["foamDictionary", "-entry", "fields.rhoE.size", "-value", case + "/0.003/uniform/checksums"],
                              env={**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam"}, capture_output=True, text=True, check=False)
        # the last word: a PWD that is not the folder makes it warn on standard output
        self.assertEqual(said.stdout.split()[-1:], [str(faults.sums(case + "/0.003")["rhoE"][0])], said.stderr)

    def refused(self, case, file, *says):
        done = harness.program("checkCase", case, check=False)
        self.assertEqual(done.returncode, 1, done.stdout)
        for text in (f"error: {case}/{file}", "remove or rename the folder 0.003", "onCorruptTime previous;", "0.002 is whole",
                     f"on purpose, remove {case}/0.003/uniform/checksums", *says):
            self.assertIn(text, done.stderr)

    def test_damage_is_refused(self):
        """Each file of a time cut, emptied, with one bit turned, gone: named, with the cure."""
        chance = random.Random(5)
        for form in ("binary", "zipped ascii"):
            case = self.written("damaged " + form, **self.FORMS[form])
            for name in faults.sums(case + "/0.003"):
                path, _ = faults.stored(case + "/0.003", name)
                with open(path, "rb") as f:
                    good = f.read()
                bit = chance.randrange(8 * 10 if path.endswith(".gz") else 0, 8 * len(good))  # a header of gzip holds a date
                turned = bytearray(good)
                turned[bit // 8] ^= 1 << bit % 8
                for what, bad in (("cut", good[:chance.randrange(1, len(good))]), ("empty", b""), (f"bit {bit}", turned), ("gone", None)):
                    with self.subTest(form, file=name, what=what):
                        os.remove(path)
                        if bad is not None:
                            with open(path, "wb") as f:
                                f.write(bad)
                        self.refused(case, "0.003/" + name)
                with open(path, "wb") as f:
                    f.write(good)
            harness.program("checkCase", case)

    def test_damaged_list(self):
        """The list itself may not be cut anywhere, nor say other sizes."""
        case = self.written("list")
        path = os.path.join(case, "0.003", "uniform", "checksums")
        with open(path) as f:
            good = f.read()
        end = good.index("files ")
        for size in [0, end // 2, *range(end, len(good.rstrip()), 47)]:
            with self.subTest(size=size):
                with open(path, "w") as f:
                    f.write(good[:size])
                self.refused(case, "0.003/uniform/checksums")
        with open(path, "w") as f:
            f.write(re.sub(r" +U +\{.*?\}\n", "", good))
        self.refused(case, "0.003/uniform/checksums", "8 files, not 9")
        os.remove(path)
        harness.program("checkCase", case)

    def damage(self, case, *times):
        for name in times:
            path = os.path.join(case, name, "rhoE")
            os.truncate(path, os.path.getsize(path) - 8)

    def test_previous(self):
        """onCorruptTime previous: from the newest whole time, said loudly, to the same end."""
        case = self.written("previous")
        straight = shutil.copytree(case, case + "_straight")
        harness.program("granularGas", "-case", straight)
        runs.add(case, CONTROL, "onCorruptTime previous;\n")
        for damaged, taken, ranks in ((("0.003",), "0.002", 2), (("0.003", "0.002"), "0.001", 1), (("0.003", "0.002", "0.001"), "0", 1)):
            with self.subTest(damaged=damaged):
                part = runs.until(case, f"{case}_{taken}", "0.003")
                self.damage(part, *damaged)
                done = harness.program("granularGas", "-case", part, ranks=ranks)
                self.assertRegex(done.stdout, rf"note: time 0.003 is damaged .*onCorruptTime previous;.*\n.*0.003/rhoE.* it was cut.*\n"
                                              rf".*goes on from time {taken}, the newest whole one")
                self.assertIn(f"from time {taken} (step", done.stdout)
                for name in runs.times(straight)[1:]:
                    runs.same(self, runs.contents(os.path.join(straight, name)), runs.contents(os.path.join(part, name)), name)
        part = runs.until(case, case + "_start", "0.003")
        self.damage(part, "0.002")
        harness.edit(part, CONTROL, startFrom="startTime", startTime=0.002, endTime=0.002)
        self.assertIn("from time 0.001 (step", harness.program("granularGas", "-case", part).stdout)
        runs.same(self, runs.contents(straight + "/0.002"), runs.contents(part + "/0.002"))

    def test_nothing_to_fall_back_to(self):
        case = self.written("alone")
        runs.add(case, CONTROL, "onCorruptTime previous;\n")
        self.damage(case, "0.003", "0.002", "0.001")
        os.remove(os.path.join(case, "0", "U"))
        shutil.rmtree(os.path.join(case, "0"))
        done = harness.program("checkCase", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no time before it is whole", done.stderr)

    def test_other_times_do_not_matter(self):
        """Damage to a time that is not started from: a run goes on, pictures are made of the others."""
        case = self.written("others")
        for name in ("0.001", "0.002"):
            with open(os.path.join(case, name, "uniform", "time"), "r+b") as f:
                f.truncate(200 if name == "0.001" else 0)
        harness.program("granularGas", "-case", case)
        self.assertIn("0.004", runs.times(case))
        done = harness.program("caseToVTK", case, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"time 0.001 is damaged and was left out\n +\S+/0.001/uniform/time")
        self.assertEqual({n for n in os.listdir(case + "/VTK") if n.endswith(".vtk")}, {f"others_{t}.vtk" for t in ("0", "0.003", "0.004")})


class Beside(harness.Folder, unittest.TestCase):
    """A file beside its zipped form, which may be older or newer: it is not clear which is meant, so neither is read."""

    def test_refused(self):
        case = runs.make(os.path.join(self.folder, "zipped"), (6, 6, 1), 0.002, interval=0.001, compression="on")
        harness.program("granularGas", "-case", case)
        for file, ranks in (("0.002/rhoE", 2), ("0.002/uniform/totals", 1), ("constant/polyMesh/owner", 1), ("constant/polyMesh/owner", 2),
                            ("constant/polyMesh/boundary", 1), ("constant/granularProperties", 1), ("system/fvSchemes", 1), (CONTROL, 1)):
            with self.subTest(file, ranks=ranks):
                path = os.path.join(case, file)
                there = path if os.path.exists(path) else path + ".gz"
                other = path + ".gz" if there == path else path
                with (gzip.open if there.endswith(".gz") else open)(there, "rb") as f, (gzip.open if other.endswith(".gz") else open)(other, "wb") as g:
                    g.write(f.read())
                os.utime(other, (1e9, 1e9))
                done = harness.program("granularGas", "-case", case, ranks=ranks, check=False)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, f"{file}: \\S+{file}.gz stands beside it, .*remove the other \\(\\S*{os.path.basename(there)} is newer")
                os.remove(other)
        self.assertIn("nothing to do", harness.program("granularGas", "-case", case).stdout)

    def test_python(self):
        case = runs.make(os.path.join(self.folder, "python"), (6, 6, 1), 0.001)
        with open(case + "/0/rho", "rb") as f, gzip.open(case + "/0/rho.gz", "wb") as g:
            g.write(f.read())
        with self.assertRaisesRegex(ValueError, r"0/rho: \S+0/rho.gz stands beside it"):
            harness.haff.Case(case).field("rho", "0")


class Changes(harness.Folder, unittest.TestCase):
    """What was changed between a written time and the restart from it is said, entry by entry."""

    def written(self, name, **options):
        case = runs.make(os.path.join(self.folder, name), (6, 6, 1), 0.002, interval=0.001, tables=True, **options)
        harness.program("granularGas", "-case", case)
        return case

    def told(self, case, ranks=1):
        """The lines of the log that tell changes."""
        text = harness.program("granularGas", "-case", case, ranks=ranks).stdout
        found = re.search(r"^Changed since time \S+ was written \(\S+\)\n((?:    .*\n)*)", text, flags=re.M)
        return [line.strip() for line in found[1].splitlines()] if found else []

    def test_nothing(self):
        case = self.written("nothing")
        self.assertEqual(self.told(case), [])
        self.assertEqual(self.told(case, ranks=2), [])
        with open(os.path.join(case, CONTROL)) as f:  # macros, comments, order and other spellings change nothing
            text = f.read()
        with open(os.path.join(case, CONTROL), "w") as f:
            f.write(text.replace("endTime 0.002;", "last 2e-3; endTime $last; // the end").replace("application granularGas;", "")
                    + "application granularGas;\n#remove last\n")
        self.assertEqual(self.told(case), [])

    def test_entries(self):
        case = self.written("entries")
        harness.edit(case, CONTROL, endTime=0.003)
        harness.edit(case, "constant/granularProperties", restitution=0.8)
        with open(os.path.join(case, "system", "fvSchemes")) as f:
            text = f.read()
        with open(os.path.join(case, "system", "fvSchemes"), "w") as f:
            f.write(text.replace("reconstruct PHM;", "") + "meshEngine lattice;\n")
        runs.add(case, "system/fvSolution", "limits { minDeltaTFraction 1e-4; }\n")
        path = os.path.join(case, CONTROL)
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("fields (T U)", "fields (T)"))
        self.assertEqual(self.told(case, ranks=2), [
            "system/controlDict: endTime 0.002 -> 0.003", "system/controlDict: functions.extreme.fields (T U) -> (T)",
            "system/fvSchemes: reconstruct PHM -> (gone)", "system/fvSchemes: meshEngine (new) lattice",
            "system/fvSolution: limits.minDeltaTFraction (new) 1e-4", "constant/granularProperties: grain.restitution 0.9 -> 0.8"])
        self.assertEqual(self.told(case), [])  # 0.003 was written with them

    def test_files(self):
        case = self.written("files")
        os.remove(os.path.join(case, "constant", "g"))
        harness.edit(case, CONTROL, endTime=0.0025)
        self.assertEqual(self.told(case)[1:], ["constant/g: dimensions [0 1 -2 0 0 0 0] -> (gone)", "constant/g: value (-3.0 -20.0 0.0) -> (gone)"])

    def test_mesh(self):
        """As many cells elsewhere: said; another number: refused."""
        case = self.written("mesh")
        shutil.copytree(case, case + "_other")
        harness.boxes.write_mesh(case, (6, 6, 1), (1.2, 0.6, 0.1))
        runs.add(case, CONTROL, "endTime 0.0021;\n")
        mesh, warning, _ = self.told(case)
        self.assertRegex(mesh, r"constant/polyMesh: checksum [0-9a-f]{16} -> [0-9a-f]{16}")
        self.assertIn("another mesh", warning)
        harness.boxes.write_mesh(case + "_other", (6, 4, 1), (0.6, 0.4, 0.1))
        done = harness.program("granularGas", "-case", case + "_other", check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"constant/polyMesh: it has 24 cells, but time 0.002 was written on a mesh of 36 cells; put that mesh back")

    def test_unreadable(self):
        """Provenance is no part of the state: the run goes on without it."""
        case = self.written("unreadable")
        path = os.path.join(case, "0.002", "uniform", "provenance")
        os.truncate(path, os.path.getsize(path) // 2)
        text = harness.program("checkCase", case).stdout
        self.assertRegex(text, r"What has changed since time 0.002 is not known: \S+/provenance:\d+: ")


if __name__ == "__main__":
    unittest.main()
