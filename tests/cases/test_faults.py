"""Whatever is done to a run, no result is lost that had been reported as written, and the message says what to do."""
import itertools
import os
import shutil
import signal
import subprocess
import unittest

from tests.cases import harness, runs

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


class Folders(harness.Folder, unittest.TestCase):
    def test_gone(self):
        """The folder goes while the run is on: said, and not made anew."""
        case = runs.make(os.path.join(self.folder, "gone"), (40, 30, 1), 1e6)
        run = start(case)
        os.rename(case, case + "_elsewhere")
        run.send_signal(signal.SIGTERM)
        error = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, 3)
        self.assertIn(f"{case}: this folder is gone", error)
        self.assertFalse(os.path.exists(case))

    def test_read_only(self):
        """A folder that cannot be written to is named before anything is run; readers take it."""
        who = {"user": 65534, "group": 65534} if os.geteuid() == 0 else {}
        try:
            subprocess.run([GAS, "-help"], capture_output=True, check=True, **who)
        except (OSError, subprocess.CalledProcessError):
            self.skipTest("root may write everywhere, and nobody else can start the program")
        case = runs.make(os.path.join(self.folder, "closed"), (8, 1, 1), 1e-3)
        os.chmod(self.folder, 0o755)
        os.chmod(case, 0o555)
        try:
            done = try_it(case, **who)
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertRegex(done.stderr, rf"{case}: this folder cannot be written to: Permission denied; .*chmod")
            self.assertEqual(try_it(case, "-dry-run", **who).returncode, 0)
        finally:
            os.chmod(case, 0o755)


if __name__ == "__main__":
    unittest.main()
