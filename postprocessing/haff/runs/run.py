# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case, or a copy of it with other entries.

    case = haff.run("cases/wedge", {"constant/granularProperties": {"grain/restitution": 0.9}}, folder="wedge09", ranks=2)
    case = haff.run("cases/sod", mesh={"N": 100})       # in cases/sod-N=100
    case = haff.run("cases/sod")                        # in its own folder

What goes wrong in a program is a haff.RunError, with the program's own words: file, line, cure.
"""
import contextlib
import fcntl
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time

from haff.case import entries
from haff.case.case import Case
from haff.case.foam import times_in
from haff.paths import program
from haff.runs import copies

ENDINGS = {1: "the case or the command line is wrong", 2: "the run left the admissible states", 3: "disk, memory or MPI"}


class RunError(RuntimeError):
    """A program ended with an error.

    message: its error text, or the last lines of its log; file, line: where the error is, by that text (None: it does not
    say); code: the exit code (negative: the signal that ended it); log: the path of the log; program: its name."""

    def __init__(self, name, code, log, text):
        self.program, self.code, self.log = name, code, log
        self.message = error_text(text)
        place = re.search(r"^[ \t]*(\S.*?):(\d+):\s", self.message, re.M)
        self.file, self.line = (place.group(1), int(place.group(2))) if place else (None, None)
        super().__init__(name, code, log, text)

    def __str__(self):
        if self.code < 0:
            how = f"was ended by signal {-self.code} ({signal.Signals(-self.code).name})"
        else:
            how = f"ended with exit code {self.code}" + (f" ({ENDINGS[self.code]})" if self.code in ENDINGS and self.program != "gmsh" else "")
        return f"{self.message}\n  {self.program} {how}; its log: {self.log}"


class Stopped(Exception):
    """The run was asked to stop and has written its state."""


def error_text(text):
    """What a log says after its last "error: ", or its last lines."""
    found = list(re.finditer(r"^error: ", text, re.M))
    if found:
        return text[found[-1].end():].strip()
    gmsh = re.findall(r"^Error\s*: (.*)", text, re.M)
    return "\n".join(gmsh) if gmsh else "\n".join(text.strip().splitlines()[-5:]) or "(the log is empty)"


class Children:
    """The programs that a call has started, and the wish to stop them. They have a session of their own, so that Ctrl-C
    reaches them by this class alone, and are stopped if the thread that started them dies."""

    def __init__(self):
        self.lock, self.running, self.stopped = threading.Lock(), set(), False

    def start(self, command, log):
        guard = ["setpriv", "--pdeathsig", "TERM"] if shutil.which("setpriv") else []
        with self.lock:
            if self.stopped:
                raise Stopped
            process = subprocess.Popen([*guard, *command], stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                                       start_new_session=True, env={"OMP_NUM_THREADS": "1", **os.environ})
            self.running.add(process)
        return process

    def stop(self):
        """Asks all to write their state and end; asked again, ends them at once, which leaves their last written times."""
        with self.lock:
            for process in self.running:
                with contextlib.suppress(ProcessLookupError):
                    if self.stopped:
                        os.killpg(process.pid, signal.SIGKILL)
                    else:
                        process.terminate()
            self.stopped = True

    def wait(self, process):
        """Its exit code. KeyboardInterrupt stops all, and is raised when they have ended."""
        interrupt = None
        while process.returncode is None:
            try:
                process.wait()
            except KeyboardInterrupt as caught:
                interrupt = caught
                self.stop()
        with self.lock:
            self.running.discard(process)
        if interrupt:
            raise interrupt
        return process.returncode

    def call(self, command, log):
        """Runs a command, its output at the end of a log; returns the output. RunError; Stopped, if that was asked for."""
        with open(log, "ab") as f:
            before = f.seek(0, os.SEEK_END)
            code = self.wait(self.start(command, f))
        with open(log, encoding="utf-8", errors="replace") as f:
            f.seek(before)
            text = f.read()
        if self.stopped and (code or "stopped as asked" in text):
            raise Stopped
        if code:
            raise RunError(os.path.basename(command[0]), code, log, text)
        return text


def make_mesh(case, mesh, children):
    """constant/polyMesh from mesh.geo (its numbers set to `mesh`) or mesh.msh; a case that has none is left to its program.
    RunError, FileNotFoundError."""
    at = lambda name: os.path.join(case, name)
    geo, msh = at("mesh.geo"), at("mesh.msh")
    if not os.path.exists(geo) and not os.path.exists(msh):
        return
    shutil.rmtree(at("constant/polyMesh"), ignore_errors=True)
    from_geo = os.path.exists(geo)
    if from_geo:
        if not shutil.which("gmsh"):
            raise FileNotFoundError(f"gmsh is not in PATH, and {geo} needs it: on Debian, apt-get install gmsh")
        msh = at(".mesh.msh")
        numbers = [word for name, value in (mesh or {}).items() for word in ("-setnumber", name, copies.label(value))]
        children.call(["gmsh", "-3", "-v", "2", *numbers, geo, "-o", msh], at("log.gmsh"))
    children.call([program("gmshToCase"), msh, "-case", case], at("log.gmshToCase"))
    if from_geo:
        os.remove(msh)


def wait_for_lock(case, children):
    """Waits until no run works on a copy: one whose caller was killed still writes its state."""
    path, said = os.path.join(case, ".haff.lock"), False
    while os.path.exists(path) and not children.stopped:
        try:
            with open(path, "r+") as f:
                fcntl.lockf(f, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return
        except FileNotFoundError:
            return
        except BlockingIOError:
            if not said:
                print(f"waiting for the run that works on {case}", file=sys.stderr, flush=True)
            said = True
            time.sleep(0.1)


def application(case):
    """The path of the program that a case is for. EntryError, FileNotFoundError."""
    return program(entries.get(os.path.join(case, "system", "controlDict"), "application"))


def solve(case, ranks, children):
    """The run, from its last time. True: it has ended by itself; False: by a signal that another sent. RunError, Stopped."""
    solver = application(case)
    command = [solver, "-case", case] + (["-np", str(ranks)] if ranks > 1 else [])
    text = children.call(command, os.path.join(case, f"log.{os.path.basename(solver)}"))
    return "stopped as asked" not in text or copies.control(case, "stopAt", "endTime") != "endTime"


def go_on(case):
    """A copy that has run for a while starts from its last time, whatever startFrom says."""
    later = [t for t in times_in(case) if t != copies.start(case)]
    if later and copies.control(case, "startFrom") != "latestTime":
        entries.edit(os.path.join(case, "system", "controlDict"), {"+startFrom": "latestTime"})


def carry_out(folder, mesh, ranks, children):
    """Brings the copy in `folder` to its end from wherever it stands. RunError, Stopped, OSError."""
    if copies.notes(folder)["state"] == "done":
        return
    wait_for_lock(folder, children)
    if not copies.notes(folder)["meshed"]:
        make_mesh(folder, mesh, children)
        copies.keep(folder, meshed=True)
    go_on(folder)
    begin = time.time()
    try:
        ended = solve(folder, ranks, children)
    finally:
        copies.keep(folder, seconds=copies.notes(folder)["seconds"] + time.time() - begin)
    if not ended:
        raise Stopped
    copies.keep(folder, state="done")


def in_place(case, ranks, children):
    if not os.path.isdir(os.path.join(case, "constant", "polyMesh")):
        make_mesh(case, None, children)
    if not solve(case, ranks, children):
        raise Stopped


def folder_for(case, changes, mesh):
    """The name that a copy gets: beside the case, with what is another in it."""
    values = {**{entry[-1].lstrip("+"): value for wanted in (changes or {}).values() for entry, value in entries.flat(wanted)}, **(mesh or {})}
    return f"{case.rstrip('/')}-{copies.name_of(values)}"


def run(case, changes=None, *, ranks=1, folder=None, mesh=None):
    """Runs a case to its end and returns the haff.Case with the results.

    case:    its folder, or a haff.Case.
    changes: {file: {entry: value}}, entries to set, as {"constant/granularProperties": {"grain/restitution": 0.9}}; what a
             path and a value may be: haff.case.entries.
    mesh:    {name: number} for the DefineConstant of mesh.geo, as {"N": 20}.
    ranks:   of MPI.
    folder:  where the copy goes. Without it the copy goes beside the case, named after what is another; without changes and
             mesh, too, the case runs in its own folder.

    A copy is what a run starts from: no results, and the mesh only if it is not made anew. A mesh that is not there, or is older
    than mesh.geo, is made by gmsh and gmshToCase. The output of each program goes to log.PROGRAM in the folder of the run. The
    same call on a copy that was stopped goes on from its last time, and on one that is finished only returns it.

    RunError:          a program failed: .message (its text), .file, .line, .code, .log.
    EntryError, FileNotFoundError, ValueError: an entry, file or number that is not there; nothing was made.
    copies.ChangedCase (a ValueError): the folder holds a run of another case or with other changes.
    KeyboardInterrupt: Ctrl-C; the run has written its state. Twice: it was ended at once, and its last written time stands.
    InterruptedError:  someone else asked the run to stop; it has written its state.
    """
    case, children = copies.path_of(case), Children()
    if ranks != int(ranks) or ranks < 1:
        raise ValueError(f"ranks: {ranks}; needed: a number from 1 on")
    target = case
    try:
        if changes or mesh or folder is not None:
            target = os.path.abspath(folder if folder is not None else folder_for(case, changes, mesh))
            if target == case:
                raise ValueError(f"{folder} is the folder of the case itself, which a copy would overwrite: name another folder")
            os.makedirs(os.path.dirname(target), exist_ok=True)
            copies.make(case, target, changes, mesh)
            carry_out(target, mesh, ranks, children)
        else:
            in_place(case, ranks, children)
    except Stopped:
        raise InterruptedError(f"{target}: the run was asked to stop and has written its state; the same call goes on from there") from None
    return Case(target)
