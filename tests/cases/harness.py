# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs short forms of the cases through the real programs, in a temporary folder."""
import contextlib
import functools
import io
import os
import shutil
import subprocess
import sys
import tempfile
import time
import warnings

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
BIN = os.environ.get("HAFF_BIN", os.path.join(SOURCE, "build", "bin"))
os.environ.update(PYTHONPATH=os.path.join(SOURCE, "postprocessing"), HAFF_BIN=BIN)  # of the commands that tests run
sys.path.insert(0, os.environ["PYTHONPATH"])

import haff  # noqa: E402
from haff import __main__ as commands  # noqa: E402
from haff.case import entries as dictionary  # noqa: E402
from haff.runs import expected  # noqa: E402
from studies.made import boxes  # noqa: E402
from studies.made.boxes import box_case, write_dictionary  # noqa: E402


def program(name, *arguments, ranks=1, check=True, timeout=900):
    """Runs a program of haff; a failure shows its output."""
    command = [os.path.join(BIN, name), *arguments]
    if ranks > 1:
        command = [os.path.join(BIN, "mpirun"), "-np", str(ranks), *command]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
    if check and done.returncode:
        raise AssertionError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    return done


def command(*words, cwd=None):
    """What `haff WORDS` does, called in this process, for a start of Python takes longer than most commands. Returns what subprocess.run
    would; what programs print that the command starts is not in it."""
    out, said, was = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["haff", *words]
    if "haff.plot.script" in sys.modules:
        sys.modules["haff.plot.script"].options.cache_clear()
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(said), contextlib.chdir(cwd or "."), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            code = commands.main()
    except SystemExit as end:
        code = end.code
        if isinstance(code, str):
            code, said = 1, io.StringIO(code)
    finally:
        sys.argv = was
        if "matplotlib.pyplot" in sys.modules:
            sys.modules["matplotlib.pyplot"].close("all")
    return subprocess.CompletedProcess(["haff", *words], code or 0, out.getvalue(), said.getvalue())


def refused(test, case, place, cure):
    """granularGas says no to the case: a place FILE:LINE as a pattern, and the cure."""
    done = program("granularGas", "-case", case, check=False)
    test.assertEqual(done.returncode, 1)
    test.assertRegex(done.stderr, place)
    test.assertIn(cure, done.stderr)


PEAK = "import os, sys; pid = os.posix_spawn(sys.argv[2], sys.argv[2:], os.environ, file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]); " \
       "_, state, used = os.wait4(pid, 0); print(used.ru_maxrss, file=open(f'{sys.argv[1]}/{os.getpid()}', 'w')); sys.exit(state != 0)"


def peak(name, *arguments, ranks):
    """Bytes of memory of the rank that takes most. Each rank writes a file of its own: mpirun may join their lines."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([os.path.join(BIN, "mpirun"), "-np", str(ranks), sys.executable, "-I", "-S", "-c", PEAK, folder, os.path.join(BIN, name), *arguments],
                       check=True, capture_output=True)
        found = [int(open(os.path.join(folder, file)).read()) for file in os.listdir(folder)]
    assert len(found) == ranks, found
    return 1024 * max(found)


def processes(name, case):
    """The processes of a program of haff that run the case."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/cmdline", "rb") as f:
                words = f.read().decode().split("\0")
        except OSError:
            continue
        if words[0] == os.path.join(BIN, name) and case in words:
            found.append(int(pid))
    return found


def work(pid):
    """Seconds of processor time that a process has taken, from its first thread."""
    with open(f"/proc/{pid}/schedstat") as f:
        return int(f.read().split()[0]) / 1e9


def await_work(pids, seconds):
    """Returns when each of the processes has computed for so long from now."""
    begun = {pid: work(pid) for pid in pids}
    while any(work(pid) < before + seconds for pid, before in begun.items()):
        time.sleep(0.001)


def copy(name, folder):
    """Copy of a shipped case without results, in a new folder inside `folder`."""
    target = os.path.join(tempfile.mkdtemp(dir=folder), name)
    shutil.copytree(os.path.join(SOURCE, "cases", name), target,
                    ignore=shutil.ignore_patterns("[1-9]*", "0", "0.[0-9]*", "*.msh", "polyMesh", "postProcessing", "VTK", "e0.*", "gas"))
    return target


def edit(case, file, **values):
    """Sets the first entry `key value;` of each key in a dictionary; it must be there."""
    dictionary.edit(os.path.join(case, file), values, anywhere=True)


def drop_vtk(case):
    """Tests of numbers need no VTK files."""
    dictionary.drop(os.path.join(case, "system", "controlDict"), "vtk")


@functools.lru_cache(16)
def made_by_gmsh(text, option, cells):
    """The .msh of a geometry that needs no other file. Tests of a module often ask for the same one."""
    with tempfile.TemporaryDirectory() as folder:
        geo, msh = os.path.join(folder, "mesh.geo"), os.path.join(folder, "mesh.msh")
        with open(geo, "w") as f:
            f.write(text)
        subprocess.run(["gmsh", "-3", "-v", "2", "-setnumber", option, str(cells), geo, "-o", msh], check=True, capture_output=True)
        with open(msh, "rb") as f:
            return f.read()


def mesh(case, cells, option="N"):
    """mesh.geo with N (or another option) = cells through gmsh and gmshToCase."""
    msh = os.path.join(case, "mesh.msh")
    with open(os.path.join(case, "mesh.geo")) as f:
        text = f.read()
    with open(msh, "wb") as f:
        f.write(made_by_gmsh(text, option, cells))
    program("gmshToCase", msh, "-case", case)


def meshes(cases):
    """mesh.geo -> mesh.msh -> polyMesh of many cases by one gmsh, which takes longer to start than to make most meshes; each .msh is
    that of a gmsh of its own, but for round-off. cases: case -> {option: value}."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "all.geo"), "w") as f:
            for k, (case, options) in enumerate(cases.items()):
                f.write("".join(f"{name} = {value};\n" for name, value in options.items()))
                with open(os.path.join(case, "mesh.geo")) as geo:  # gmsh keeps the values of options by their names
                    f.write(geo.read().replace('Name "', f'Name "{k} '))
                f.write(f'\nMesh 3;\nSave "{case}/mesh.msh";\nDelete Physicals; Delete All; Delete Options; Delete Variables; NewModel;\n')
        done = subprocess.run(["gmsh", "-v", "2", f.name, "-"], capture_output=True, text=True, check=False)
    if done.returncode or "Error" in done.stdout + done.stderr:
        raise AssertionError(done.stdout + done.stderr)
    for case in cases:
        program("gmshToCase", os.path.join(case, "mesh.msh"), "-case", case)


def run(case, ranks=1, **control):
    """The solver, with entries of controlDict changed; returns the case with its results."""
    if control:
        edit(case, "system/controlDict", **control)
    drop_vtk(case)
    program("granularGas", "-case", case, ranks=ranks)
    return haff.Case(case)


def memory():
    """A folder in memory, where files of tests cost a fraction of what they cost on a disk; None if less than 4 GB are free there."""
    place = "/dev/shm"
    if not os.access(place, os.W_OK):
        return None
    there = os.statvfs(place)
    return None if there.f_flag & os.ST_NOEXEC or there.f_bavail * there.f_frsize < 4e9 else place


class Folder:
    """A temporary folder for the tests of a class: self.folder."""

    @classmethod
    def setUpClass(cls):
        cls._temporary = tempfile.TemporaryDirectory(prefix="haff", dir=memory())
        cls.folder = cls._temporary.name

    @classmethod
    def tearDownClass(cls):
        cls._temporary.cleanup()

    def short(self, name, cells, **control):
        """A shipped case on another grid."""
        case = copy(name, self.folder)
        mesh(case, cells)
        return run(case, **control)

    def compare(self, case, entries):
        """Every entry of expected.json, each a subtest."""
        self.assertTrue(entries)
        for entry in entries:
            with self.subTest(expected.describe(entry)):
                value = expected.measure(case, entry)
                self.assertTrue(expected.as_expected(value, entry),
                                f"{value:.9g}, expected {entry['value']:.9g} +- {entry['tolerance']:.3g}: {entry['source']}")


def entries(name, **wanted):
    """The short entries of a case's expected.json that have these properties (or do not mention them)."""
    path = os.path.join(SOURCE, "cases", name)
    return [e for e in expected.load(path, "short") if all(e.get(k, v) == v for k, v in wanted.items())]
