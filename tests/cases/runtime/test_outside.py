# SPDX-License-Identifier: GPL-3.0-or-later
"""A case is all that a run reaches: nothing outside of it is written, renamed, removed or shown, whatever links lead there."""
import os
import re
import shutil
import signal
import subprocess
import tempfile
import unittest

from tests.cases import harness, runs
from tests.cases.grains import test_particles as particles
from tests.cases.segregation.mixtures import Mixture
from tests.faults import faults

CONTROL = "system/controlDict"
SECRET = "root:x:0:0:hunter2"
REFUSED = r"this is a link, and nothing is written through a link: remove it, or put what it leads to in its place"
PHASES = "functions { phase { type phaseAverage; period 0.001; phases 2; fields (rho U); } }\n"


def everything(case):
    """A case whose run writes all that runs write."""
    runs.add(case, CONTROL, "writeProcessors yes;\npurgeWrite 2;\n" + PHASES)
    return case


class Outside(harness.Folder):
    def setUp(self):
        self.place = tempfile.mkdtemp(dir=self.folder)
        self.away = os.path.join(self.place, "away")
        os.mkdir(self.away)
        self.secret = os.path.join(self.away, "secret")
        with open(self.secret, "w") as f:
            f.write(f"{SECRET}\n{SECRET}\n")
        self.before = runs.contents(self.away)

    def case(self, **options):
        return runs.make(tempfile.mkdtemp(dir=self.place), (6, 6, 1), 0.002, interval=0.001, **options)

    def replace(self, case, name, target):
        """Puts a link in place of what may stand there."""
        path = os.path.join(case, name)
        if os.path.isdir(path):
            shutil.rmtree(path)
        elif os.path.lexists(path):
            os.remove(path)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        os.symlink(target, path)
        return path

    def refused(self, case, message, program="granularGas", options=()):
        done = harness.program(program, *(("-case",) if program[0] == "g" else ()), case, *options, check=False, timeout=60)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, message)
        self.assertNotIn("hunter2", done.stdout + done.stderr)
        self.assertNotIn("root", done.stdout + done.stderr)
        self.assertEqual(self.before, runs.contents(self.away))


class Reading(Outside, unittest.TestCase):
    def test_no_regular_file(self):
        """Refused at once, as a field, as a mesh, as what is included, zipped or not."""
        pipe = os.path.join(self.place, "pipe")
        os.mkfifo(pipe)
        for target, kind in (("/dev/zero", "a device"), (pipe, "a pipe"), (self.away, "a folder"), ("/dev/tty", "a device")):
            for name in ("0/rho", "constant/polyMesh/points", "system/fvSchemes", "constant/g", "0/U.gz", "system/more"):
                with self.subTest(target, name=name):
                    case = self.case()
                    path = self.replace(case, name, target)
                    if name.endswith(".gz"):
                        os.remove(path[:-3])
                    runs.add(case, CONTROL, '#includeIfPresent "more"\n')
                    self.refused(case, rf"{path}: is no file but {kind}; put the file there")
        for program, arguments in (("gmshToCase", ("-case", self.case())), ("gmshToCase", ("-case", self.place))):
            done = harness.program(program, "/dev/zero", *arguments, check=False, timeout=60)
            self.assertEqual((done.returncode, "is no file but a device" in done.stderr), (1, True))

    def test_too_large(self):
        """A file with a hole of 17 GiB."""
        case = self.case()
        os.truncate(os.path.join(case, "0", "rho"), 17 << 30)
        self.refused(case, r"0/rho: the file has 17 GiB; at most [\d.]+ GiB are read \(16 GiB, or the memory of this machine\)")

    def test_links_are_read(self):
        """A mesh, a start, a dictionary and what it includes, shared by links; and the case itself behind one."""
        plain, case = self.case(), self.case()
        for name in ("constant/polyMesh", "0", "system/fvSchemes"):
            shared = os.path.join(self.place, os.path.basename(name))
            shutil.move(os.path.join(case, name), shared)
            os.symlink(shared, os.path.join(case, name))
        with open(os.path.join(self.place, "more"), "w") as f:
            f.write("maxCo 0.5;\n")
        os.symlink(os.path.join(self.place, "more"), os.path.join(case, "system", "more"))
        runs.add(case, CONTROL, '#include "more"\n')
        os.symlink(case, os.path.join(self.place, "linked"))
        harness.program("granularGas", "-case", plain)
        harness.program("granularGas", "-case", os.path.join(self.place, "linked"))
        for name in ("0.001", "0.002"):
            runs.same(self, runs.contents(os.path.join(plain, name)), runs.contents(os.path.join(case, name)))
        self.assertEqual(runs.hidden(case), [])

    def test_text_is_not_shown(self):
        """Of a file outside of the case the message tells line and cure, and no text."""
        for name in ("0/rho", "constant/polyMesh/points", "constant/polyMesh/boundary", "system/fvSchemes", "system/controlDict",
                     "constant/granularProperties", "constant/g"):
            with self.subTest(name):
                case = self.case()
                self.replace(case, name, self.secret)
                self.refused(case, rf"{name}:\d: .* comes from a file outside of the case .* replace the link by a copy")
                self.refused(case, rf"{name}:\d: ", program="checkCase")
        case = self.case()
        self.replace(case, "system/more", self.secret)
        runs.add(case, CONTROL, '#include "more"\n')
        self.refused(case, r"system/more:\d: ")
        mesh = self.replace(case, "mesh.msh", self.secret)
        done = harness.program("gmshToCase", mesh, "-case", case, check=False)
        self.assertRegex(done.stderr, r"mesh.msh:1: .* outside of the case")
        self.assertNotIn("hunter2", done.stderr)

    def test_values_are_not_shown(self):
        """Nor where the file can be read, and its entries are none that the case may have."""
        with open(self.secret, "w") as f:
            f.write("password hunter2;\n")
        self.before = runs.contents(self.away)
        for text in ("", "maxCo $password;\n", "#if $password\n#endif\n", "maxCo #eval{ $password };\n", "writeFormat $password;\n",
                     "functions { $password { type probes; } }\n", "functions { a { type probes; fields ($password); } }\n"):
            with self.subTest(text):
                case = self.case()
                self.replace(case, "system/more", self.secret)
                runs.add(case, CONTROL, '#include "more"\n' + text)
                self.refused(case, r"system/(more|controlDict):\d+: ")

    def test_names_that_lead_out(self):
        for name in ("/etc/passwd", "../../away/secret", "$HOME/x"):
            case = self.case()
            runs.add(case, CONTROL, f'#include "{name}"\n')
            self.refused(case, r"system/controlDict:\d+: found '.*'; (#include takes a p|the path leads out of the case)")


class Writing(Outside, unittest.TestCase):
    def test_links_in_the_way(self):
        """Folders and files that a run would write through, with a cure; the case is left as it was."""
        for name in ("postProcessing", "VTK", "postProcessing/points", "postProcessing/points/0", "postProcessing/points/0/alpha",
                     "postProcessing/phase", "postProcessing/mass/0/volFieldValue.dat", "processor0", "processor0/constant",
                     "processor0/constant/polyMesh", ".haff.lock"):
            for target in (self.away, os.path.join(self.place, "nowhere")):
                with self.subTest(name, target=target):
                    case = everything(self.case(tables=True))
                    path = self.replace(case, name, target)
                    self.refused(case, re.escape(path) + ": " + REFUSED)
                    self.assertTrue(os.path.islink(path))
                    self.assertEqual(runs.times(case), ["0"])

    def test_links_that_are_replaced(self):
        """A time, and what a killed run left of one, may be links: these are replaced or removed, not what they lead to."""
        case = self.case()
        for name in ("0.001", ".0.001.tmp", ".0.001.old"):
            self.replace(case, name, self.away)
        harness.edit(case, CONTROL, startFrom="firstTime")
        harness.program("granularGas", "-case", case)
        self.assertEqual(self.before, runs.contents(self.away))
        runs.complete(self, case, "0.001")
        self.assertFalse(os.path.islink(os.path.join(case, "0.001")))

    def test_other_names_of_a_file(self):
        """A copy of a case made of hard links stays as it is."""
        case = everything(self.case(tables=True))
        harness.edit(case, CONTROL, startFrom="firstTime")
        harness.program("granularGas", "-case", case)
        copied = case + "_copy"
        subprocess.run(["cp", "-al", case, copied], check=True)
        before = runs.contents(copied)
        os.truncate(os.path.join(copied, "postProcessing", "points", "0", "alpha"), 7)  # of the one file with two names
        before["postProcessing/points/0/alpha"] = before["postProcessing/points/0/alpha"][:7]
        harness.program("granularGas", "-case", case)
        runs.same(self, before, runs.contents(copied))
        os.link(self.secret, os.path.join(case, ".haff.lock"))
        self.refused(case, r"\.haff\.lock: this file has another name elsewhere \(a hard link\)")

    def test_tools(self):
        case = self.case()
        self.replace(case, "VTK", self.away)
        self.refused(case, re.escape(case + "/VTK") + ": " + REFUSED, program="caseToVTK")
        mesh = os.path.join(harness.SOURCE, "tests", "fuzz", "seeds", "msh", "flat41")
        for name in ("constant", "constant/polyMesh", "case.foam"):
            case = self.case()
            path = self.replace(case, name, self.away if name != "case.foam" else self.secret)
            done = harness.program("gmshToCase", mesh, "-case", case, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, re.escape(path) + ": " + REFUSED)
            self.assertEqual(self.before, runs.contents(self.away))
        case = self.case()
        self.replace(case, "constant/polyMesh/points", self.secret)
        harness.program("gmshToCase", mesh, "-case", case)  # the link is replaced
        self.assertEqual(self.before, runs.contents(self.away))


class Swapped(Outside, unittest.TestCase):
    """The folder of a case is moved away under a run, and another one may stand in its place."""

    def endless(self, **options):
        case = self.case(**options)
        harness.edit(case, CONTROL, endTime=1e6, writeControl="none")
        runs.add(case, CONTROL, "runTimeModifiable yes;\nlogInterval 10;\n")
        return case

    def test_gone(self):
        """Said once in the log while it is gone, and as an error at the next write; put back, all is well."""
        for back in (False, True):
            case = self.endless(tables=True)
            runs.add(case, CONTROL, "runTimeModifiable no;\n")
            going, _ = faults.start(case, word="Time =")
            self.addCleanup(going.kill)
            os.rename(case, case + "_elsewhere")
            for line in going.stdout:
                if line.startswith("note: "):
                    break
            self.assertRegex(line, rf"{case}: this folder is gone .*; the next write fails unless the folder is put back")
            if back:
                os.rename(case + "_elsewhere", case)
            going.send_signal(signal.SIGTERM)
            text, error = going.communicate(timeout=60)
            self.assertNotIn("note: ", text)
            self.assertEqual(going.returncode, 0 if back else 3)
            if back:
                runs.complete(self, case, runs.times(case)[-1])
                continue
            self.assertRegex(error, rf"{case}: this folder is gone .*it was removed or renamed while the run was at work in it")
            self.assertFalse(os.path.exists(case))

    def test_another_stands_there(self):
        """With a lock, a half-written time, tables and processor folders of its own; not one byte of it changes."""
        foreign = everything(self.case(tables=True))
        harness.program("granularGas", "-case", foreign)
        for name in (".haff.lock", ".0.5.tmp"):
            with open(os.path.join(foreign, name), "w") as f:
                f.write("another run's")
        for ranks in (1, 2):
            case = self.endless(tables=True)
            command = (os.path.join(harness.BIN, "mpirun"), "-np", "2", faults.GAS) if ranks == 2 else (faults.GAS,)
            going, text = faults.start(case, word="Time =", command=command)
            self.addCleanup(going.kill)
            os.rename(case, case + "_elsewhere")
            shutil.copytree(foreign, case)
            if ranks == 1:
                going.send_signal(signal.SIGTERM)
            rest, error = going.communicate(timeout=60)  # or else its controlDict is read, which another folder's may not be
            self.assertNotEqual(going.returncode, 0)
            self.assertRegex(error, rf"{case}: another folder stands here than the one in which the run began")
            runs.same(self, runs.contents(foreign, ignore=()), runs.contents(case, ignore=()))
            self.assertNotIn("written:", text + rest)

    def test_late_tables(self):
        """Files that a run opens late are not made there, either."""
        case = self.endless()
        runs.add(case, CONTROL, "functions { line { type sets; fields (rho); writeControl timeStep; writeInterval 2000;\n"
                 "    sets { a { type uniform; axis x; start (0.1 0.3 0.05); end (0.5 0.3 0.05); nPoints 5; } } } }\n")
        going, _ = faults.start(case, word="Time =")
        self.addCleanup(going.kill)
        os.rename(case, case + "_elsewhere")
        os.mkdir(case)
        error = going.communicate(timeout=60)[1]
        self.assertEqual(going.returncode, 3)
        self.assertRegex(error, "another folder stands here")
        self.assertEqual(os.listdir(case), [])


@unittest.skipUnless(shutil.which("strace"), "strace is not installed")
class SystemCalls(harness.Folder, unittest.TestCase):
    """Every call that opens, makes, renames or removes a file, of whole runs."""
    CALLS = ("open,openat,openat2,creat,rename,renameat,renameat2,unlink,unlinkat,mkdir,mkdirat,rmdir,link,linkat,symlink,symlinkat,"
             "truncate,mknod,mknodat,chmod,fchmodat,chown,fchownat,lchown,setxattr")
    CHANGES = re.compile(r"O_WRONLY|O_RDWR|O_CREAT|O_TRUNC")
    # MPI's own: its folder is in TMPDIR, which is not the case's
    SYSTEM = re.compile(r"/(dev/(?!shm/haff)|proc/|sys/)")  # tests may run in /dev/shm

    def traced(self, case, *command):
        """Runs a program; returns (call, path, flags or None) of all its calls that change something."""
        logs, scratch = tempfile.mkdtemp(dir=self.folder), tempfile.mkdtemp(dir=self.folder)
        trace = ["strace", "-ff", "-y", "-qq", "-s", "4096", "-e", f"trace={self.CALLS}", "-e", "signal=none", "-o", os.path.join(logs, "log")]
        done = subprocess.run([*trace, *command], capture_output=True, text=True, timeout=600, env={**os.environ, "TMPDIR": scratch}, check=False)
        if "ptrace" in done.stderr and "Operation not permitted" in done.stderr:
            self.skipTest("strace may not trace here")
        self.assertEqual(done.returncode, 0, done.stderr)
        calls = []
        for name in os.listdir(logs):
            with open(os.path.join(logs, name), errors="replace") as f:
                calls += [found for line in f for found in self.changes(line, case, scratch)]
        self.assertTrue(calls)
        return calls

    def changes(self, line, case, scratch):
        """What one line of strace changes, MPI's own files left out."""
        call, _, rest = line.partition("(")
        names = re.findall(r'(?:(?:AT_FDCWD|\d+)<([^>]*)>, )?"((?:[^"\\]|\\.)*)"', rest)
        if call.startswith("open") and not self.CHANGES.search(rest):
            return []
        found = []
        for at, name in names:
            path = os.path.normpath(os.path.join(at or harness.SOURCE, name))
            if path.startswith(scratch + "/") or (scratch + "/").startswith(path + "/") or self.SYSTEM.match(path):
                continue
            found.append((call, path, rest if call.startswith("open") else None, name))
        return found

    def check(self, case, *command, least):
        real, seen = os.path.realpath(case), 0
        for call, path, flags, name in self.traced(case, *command):
            with self.subTest(call, path=path):
                self.assertTrue(path.startswith(real + "/"), f"{call} {path} lies outside of the case")
                self.assertIn(call, ("openat", "renameat", "unlinkat", "mkdirat"))
                self.assertNotIn("/", name, "a name is looked up in a folder that was opened without following links")
                if flags is not None:
                    self.assertIn("O_NOFOLLOW", flags)
                seen += 1
        self.assertGreater(seen, least)

    def bin(self, name):
        return os.path.join(harness.BIN, name)

    def gas(self, name):
        return everything(runs.make(os.path.join(self.folder, name), (70, 40, 1), 0.003, interval=0.001, tables=True, compression="on"))

    def test_gas(self):
        case = self.gas("gas")
        self.check(case, self.bin("granularGas"), "-case", case, least=100)
        self.check(case, self.bin("caseToVTK"), case, least=4)
        self.assertIn("processor0", os.listdir(case))

    def test_ranks(self):
        case = self.gas("ranks")
        self.check(case, self.bin("mpirun"), "-np", "2", self.bin("granularGas"), "-case", case, least=200)

    def test_link_to_the_case(self):
        case = self.gas("real")
        os.symlink(case, case + "_link")
        self.check(case, self.bin("granularGas"), "-case", case + "_link", least=100)

    def test_grains(self):
        case = particles.make(os.path.join(self.folder, "grains"), end=0.2, interval=0.1,
                              control="functions { pictures { type vtk; fields (alpha); writeControl writeTime; } }\n")
        self.check(case, self.bin("granularMD"), "-case", case, least=50)
        self.check(case, self.bin("caseToVTK"), case, least=4)

    def test_mesh(self):
        case = self.gas("mesh")
        mesh = os.path.join(harness.SOURCE, "tests", "fuzz", "seeds", "msh", "flat41")
        self.check(case, self.bin("gmshToCase"), mesh, "-case", case, "-compress", least=10)


@unittest.skipUnless(shutil.which("strace"), "strace is not installed")
class SegregationCalls(Mixture, unittest.TestCase):
    traced, changes, check, bin = SystemCalls.traced, SystemCalls.changes, SystemCalls.check, SystemCalls.bin
    CALLS, CHANGES, SYSTEM = SystemCalls.CALLS, SystemCalls.CHANGES, SystemCalls.SYSTEM

    def test_segregation(self):
        case = self.chute(10, endTime=0.02, writeInterval=0.01)
        self.check(case, self.bin("granularSegregation"), "-case", case, least=20)


if __name__ == "__main__":
    unittest.main()
