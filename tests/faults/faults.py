# SPDX-License-Identifier: GPL-3.0-or-later
"""What can happen to a run, done to real runs: each function below is a fault, and returns what the fault table says of it.

A time is lost if the log had reported it ("written: NAME") and it is not whole afterwards: a file missing, or not of the size
and CRC-32 that its uniform/checksums gives. After each fault the run is taken up again and must come to the same bytes."""
import dataclasses
import functools
import gzip
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import time
import zlib

from tests.cases import harness, runs

GAS = os.path.join(harness.BIN, "granularGas")
CONTROL = "system/controlDict"
PLACES = {"fields": (), "uniform": ("uniform",), "grains": ("lagrangian", "grains")}  # of the files in checksums
SOFT = ("rho", "U", "T", "uniform/lammps", "lagrangian/grains/positions")  # files of a time of granularDEM
END = "0.002"  # of the cases below, after ten steps, each written


@dataclasses.dataclass
class Outcome:
    done: str  # to the run
    note: str = ""  # what the fault itself took
    times: int = 0  # how often
    reported: int = 0  # times as written, over all runs
    lost: list = dataclasses.field(default_factory=list)  # of these
    said: str = ""  # the message
    after: list = dataclasses.field(default_factory=list)  # what went wrong when the run was taken up again

    def take(self, case, text, said=""):
        """What is left of a run that printed `text`."""
        names = reported(text)
        self.times += 1
        self.reported += len(names)
        self.lost += [f"{self.times}: {name}" for name in names if not whole(case, name)]
        self.said = said.strip().replace(case, "CASE") or self.said


def make(folder, name, n=(8, 6, 1), steps=10, **options):
    """A case that writes at every step."""
    options = {"control": "timeStep", "interval": 1, "format": "ascii", **options}
    return runs.make(os.path.join(folder, name), n, steps * 2e-4, adjust="no", step=2e-4, **options)


def reported(text):
    return re.findall(r"^    written: (\S+)$", text, flags=re.M)


def sums(folder):
    """What uniform/checksums of a time lists: {file: (size, CRC-32)}."""
    with open(os.path.join(folder, "uniform", "checksums")) as f:
        text = f.read()
    (count,), found = re.findall(r"\nfiles +(\d+);", text), {}
    for group, body in re.findall(r"\n(fields|uniform|grains)\n\{\n(.*?)\n\}", text, flags=re.S):
        for name, size, crc in re.findall(r'(\S+) +\{ size (\d+); crc32 "([0-9a-f]{8})"; \}', body):
            found[os.path.join(*PLACES[group], name)] = int(size), int(crc, 16)
    if len(found) != int(count):
        raise ValueError(f"{folder}: {len(found)} checksums, not {count}")
    return found


def stored(folder, name):
    """Path and contents of a file, zipped or not."""
    path = os.path.join(folder, name)
    path = path if os.path.exists(path) else path + ".gz"
    with (gzip.open if path.endswith(".gz") else open)(path, "rb") as f:
        return path, f.read()


def whole(case, name):
    """Are all files of that time there, as they were written? One that a run replaced when it died stands beside its place."""
    folder = os.path.join(case, name)
    folder = folder if os.path.isdir(folder) else os.path.join(case, f".{name}.old")
    try:
        listed = sums(folder)
        contents = {key: stored(folder, key)[1] for key in listed}
    except (OSError, ValueError, EOFError, zlib.error):
        return False
    needed = SOFT if "uniform/softGrains" in listed else runs.FIELDS
    return {*needed, "uniform/time"} <= listed.keys() and all(
        (len(data), zlib.crc32(data)) == listed[key] for key, data in contents.items())


def run(case, *options, fault=None, program=GAS, **more):
    environment = dict(os.environ)
    if fault:
        environment.update(LD_PRELOAD=os.path.join(harness.BIN, "faultydisk.so"), HAFF_FAULT=fault, HAFF_FAULT_FOLDER=case,
                           ASAN_OPTIONS="verify_asan_link_order=0")
    return subprocess.run([program, "-case", case, *options], capture_output=True, text=True, timeout=300, env={**environment, **more.pop("env", {})}, **more)


def start(case, lines=1, word="    written", command=(GAS,), **options):
    """A run in the background that has printed that number of lines that begin with the word; and what it printed."""
    going = subprocess.Popen([*command, "-case", case], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)
    text = []
    for line in going.stdout:
        text.append(line)
        lines -= line.startswith(word)
        if not lines:
            break
    return going, "".join(text)


def rest(going):
    """(stdout, stderr) of a run since `start`, to its end. Popen.communicate would leave out the lines that the reader of `start` holds."""
    said = going.stdout.read(), going.stderr.read()
    going.wait(timeout=60)
    return said


def again(outcome, case, straight, name=END, program=GAS):
    """Takes the run up: it comes to the end of one that nothing happened to, byte by byte, and leaves nothing behind."""
    done = run(case, program=program)
    # pieces of granularDEM follow the clock, and LAMMPS's restart files hold what its memory held
    ignore = ("provenance", *(("time", "lammps", "checksums") if program != GAS else ()))
    if done.returncode or runs.hidden(case) or runs.contents(os.path.join(case, name), ignore) != runs.contents(os.path.join(straight, name), ignore):
        outcome.after.append(f"{outcome.times}: exit code {done.returncode}, {runs.hidden(case)}: {done.stderr}")


def straight_run(folder, name, **options):
    case = make(folder, name, **options)
    done = run(case)
    if done.returncode:
        raise AssertionError(done.stderr)
    return case


# ---- sudden death ----------------------------------------------------------------------------------------------------


def kills(folder, count, seed=1):
    """kill -9 at random moments of runs that write all the time, each taken up where the one before died."""
    chance = random.Random(seed)
    outcome = Outcome("kill -9 at random moments, while it writes at every step; taken up again and again")
    case = make(folder, "kills", n=(30, 20, 1), steps=60)
    straight = shutil.copytree(case, case + "_straight")
    for c in (case, straight):
        runs.add(c, CONTROL, "purgeWrite 4;\n")
    begin = time.monotonic()
    run(straight)
    moment = 4 * (time.monotonic() - begin) / 60  # the time of a few writes on this machine
    fresh, last = case + "_fresh", runs.times(straight)[-1]
    shutil.copytree(case, fresh)
    while outcome.times < count:
        going, text = start(case)
        if going.poll() is None and reported(text):
            time.sleep(chance.random() * moment)
        going.kill()
        text += rest(going)[0]
        left = reported(text)[-3:]  # purgeWrite may be at work on the fourth
        outcome.take(case, "".join(f"    written: {name}\n" for name in left))
        if going.returncode == 0 or outcome.times == count:
            again(outcome, case, straight, last)
            shutil.rmtree(case)
            shutil.copytree(fresh, case)
    return outcome


@functools.lru_cache(1)
def writes_over(folder):
    """A run of three steps; a case that writes its times again, two of them over old ones; how many calls of it change a file."""
    straight = straight_run(folder, "each_call", steps=3)
    base = shutil.copytree(straight, straight + "_base")
    shutil.rmtree(os.path.join(base, runs.times(straight)[-1]))
    harness.edit(base, CONTROL, startFrom="firstTime")  # 0.0002 and 0.0004 are written over, 0.0006 is new
    case = shutil.copytree(base, straight + "_try")
    calls = int(re.search(r"(\d+) calls", run(case, fault="count:0").stderr)[1])
    shutil.rmtree(case)
    return straight, base, calls


def at_each_call(folder, kind, done, every=1, seed=1, codes=(0, 3)):
    """The fault replaces each call (or every n-th) that changes a file, of a run that writes new times over old ones."""
    chance = random.Random(seed)
    outcome = Outcome(done)
    straight, base, calls = writes_over(folder)
    case, last = straight + "_try", runs.times(straight)[-1]
    if every > 1:
        outcome.done += f" (tried at one of {every} of the {calls} calls)"
    for at in range(1 + chance.randrange(every), calls + 1, every):
        shutil.copytree(base, case)
        tried = run(case, fault=f"{kind}:{at}")
        outcome.take(case, "    written: 0.0002\n    written: 0.0004\n" + tried.stdout, tried.stderr)
        if tried.returncode not in codes or (tried.returncode == 3) != ("error: " in tried.stderr):
            outcome.after.append(f"call {at}: exit code {tried.returncode}: {tried.stderr}")
        harness.edit(case, CONTROL, startFrom="latestTime")
        again(outcome, case, straight, last)
        shutil.rmtree(case)
    return outcome


def death_at_each_call(folder, every=1):
    return at_each_call(folder, "kill", "kill -9 instead of each system call of a run that writes new times over old ones", every,
                        codes=(-signal.SIGKILL,))


def power_cuts(folder, every=1):
    return at_each_call(folder, "power", "the power fails instead of each system call: what was not synced is gone", every,
                        codes=(-signal.SIGKILL,))


def disk_errors(folder, every=1):
    return at_each_call(folder, "error", "an input/output error (EIO) in each system call that changes a file", every)


def torn_files(folder, every=1):
    return at_each_call(folder, "torn", "the power fails instead of each system call: files that were not synced keep their names and half of their contents", every,
                        codes=(-signal.SIGKILL,))


def unsaid(folder, every=1):
    return at_each_call(folder, "unsaid", "each system call that changes a file is done and reported as failed (EIO), as by a server whose answer is lost", every)


def no_rename(folder, every=1):
    return at_each_call(folder, "rename", "renames fail (EXDEV) from each system call on", every)


def permission_lost(folder, every=1):
    return at_each_call(folder, "denied", "nothing can be made, renamed or removed (EACCES) from each system call on", every)


def full_from_each_call(folder, every=1):
    return at_each_call(folder, "full", "the disk is full (ENOSPC) from each system call on", every)


def clock_jumps(folder):
    """The date is wrong by ten years, this way and that: no result knows."""
    outcome = Outcome("the date jumps by ten years, forwards and back, at every third reading")
    straight = straight_run(folder, "date_straight")
    case = make(folder, "date")
    done = run(case, fault="clock:3")
    outcome.take(case, done.stdout, done.stderr)
    if done.returncode or runs.results(case) != runs.results(straight):
        outcome.after.append(f"exit code {done.returncode}: {done.stderr}")
    shutil.rmtree(os.path.join(case, END))
    again(outcome, case, straight)
    return outcome


def endless(folder, name, **options):
    """A run that writes at every step, keeps three times and does not end by itself."""
    case = make(folder, name, steps=10, purge=3, **options)
    harness.edit(case, CONTROL, endTime=1e6)
    return case


def to_an_end(outcome, folder, case, **options):
    """The run is taken up for two more steps, and compared with one that went through to there."""
    steps = round(float(runs.times(case)[-1]) / 2e-4) + 2
    straight = make(folder, os.path.basename(case) + "_straight", steps=steps, **{**options, "interval": steps})
    run(straight)
    harness.edit(case, CONTROL, endTime=repr(steps * 2e-4))
    again(outcome, case, straight, runs.times(straight)[-1])


def signals(folder):
    """Deaths that the program could notice, and wishes to stop."""
    for number, wish in ((signal.SIGSEGV, False), (signal.SIGABRT, False), (signal.SIGTERM, True), (signal.SIGINT, True),
                         (signal.SIGHUP, True), (signal.SIGXCPU, True), (signal.SIGUSR1, True)):
        outcome = Outcome(f"{number.name}, " + ("a wish to stop" if wish else "sudden death"))
        if signal.getsignal(number) == signal.SIG_IGN:  # nohup ignores SIGHUP, and a run inherits that
            signal.signal(number, signal.SIG_DFL)
        case = endless(folder, number.name)
        going, text = start(case, 2)
        going.send_signal(number)
        text += rest(going)[0]
        outcome.take(case, last_lines(text), "".join(re.findall(r"stopped as asked.*", text)) if wish else "")
        if going.returncode != (0 if wish else -number):
            outcome.after.append(f"exit code {going.returncode}")
        to_an_end(outcome, folder, case)
        yield outcome


def last_lines(text):
    """What was said of the times that purgeWrite keeps and is not at work on."""
    return "".join(f"    written: {name}\n" for name in reported(text)[-2:])


def ranks(folder, count=1):
    """One rank of two dies; mpirun ends the others."""
    for victim in (0, 1):
        outcome = Outcome(f"kill -9 of rank {victim} of 2, while times are written")
        for k in range(count):
            case = endless(folder, f"rank{victim}_{k}", n=(70, 40, 1))
            going, text = start(case, 2, command=(os.path.join(harness.BIN, "mpirun"), "-np", "2", GAS))
            os.kill(rank_process(going.pid, victim), signal.SIGKILL)
            more, error = rest(going)
            outcome.take(case, last_lines(text + more), error or f"(no message; exit code {going.returncode})")
            if not going.returncode:
                outcome.after.append("exit code 0")
            to_an_end(outcome, folder, case, n=(70, 40, 1))
        yield outcome


def rank_process(parent, rank):
    """The process of that rank, below mpirun (which may be below a shell)."""
    with open(f"/proc/{parent}/task/{parent}/children") as f:
        children = [int(word) for word in f.read().split()]
    for child in children:
        try:
            with open(f"/proc/{child}/environ", "rb") as f:
                if b"OMPI_COMM_WORLD_RANK=%d" % rank in f.read().split(b"\0"):
                    return child
        except OSError:
            continue
        found = rank_process(child, rank)
        if found:
            return found
    return None


# ---- the child of granularDEM ---------------------------------------------------------------------------------------------


DEM = os.path.join(harness.BIN, "granularDEM")
ANSWERS = {"killed": "LAMMPS is killed (SIGKILL)", "ends": "LAMMPS ends without a word", "nan": "LAMMPS answers nan", "far": "LAMMPS answers with grains at 1e300",
           "short": "LAMMPS answers with rows that are cut", "words": "LAMMPS answers with words and control characters", "twice": "LAMMPS answers with one number for all grains",
           "together": "LAMMPS answers with all grains at one place", "negative": "LAMMPS answers with a negative number of grains",
           "many": "LAMMPS answers with too many grains", "none": "LAMMPS answers without grains", "endless": "LAMMPS prints without end"}


def soft_bed(folder, name):
    """A few spheres that fall on a floor; it is written five times."""
    from tests.cases.grains import test_softGrains
    return test_softGrains.make(os.path.join(folder, name), "type linear; stiffness 100; friction 0.5;", T=1e-3, alpha=0.1, e=0.9, g=(0, -9.81, 0), end=2.5e-3, interval=5e-4)


@functools.lru_cache(1)
def soft_straight(folder):
    straight = soft_bed(folder, "soft_straight")
    done = run(straight, program=DEM)
    if done.returncode:
        raise AssertionError(done.stderr)
    return straight


def before_lammps(fault):
    """The environment in which the program beside this file stands before LAMMPS."""
    return {"PATH": os.path.dirname(os.path.abspath(__file__)) + os.pathsep + os.environ["PATH"], "HAFF_FAULT": fault}


def answers(folder, kinds, seed=1):
    """The child dies or answers rubbish behind the second written time."""
    if not shutil.which("lmp"):
        return
    chance = random.Random(seed)
    straight = soft_straight(folder)
    for kind in kinds:
        outcome = Outcome(ANSWERS[kind])
        case = soft_bed(folder, f"soft_{kind}")
        tried = run(case, program=DEM, env=before_lammps(f"{kind}:{chance.randint(70, 75)}"))
        outcome.take(case, tried.stdout, tried.stderr)
        if tried.returncode != 3 or not outcome.reported:
            outcome.after.append(f"exit code {tried.returncode}, {outcome.reported} times: {tried.stderr}")
        again(outcome, case, straight, "0.0025", DEM)
        yield outcome


def runs_on(pid, within=20):
    """Is the process still there after so many seconds, and no zombie? One that was killed may take a while to die on a busy machine."""
    end = time.monotonic() + within
    while time.monotonic() < end:
        try:
            with open(f"/proc/{pid}/stat") as f:
                if f.read().rpartition(") ")[2][0] in "ZX":
                    return False
        except OSError:
            return False
        time.sleep(0.02)
    return True


def child_stops(folder):
    """A signal stops the child behind the second written time; it is sent on, or the run is asked to end."""
    if not shutil.which("lmp"):
        return
    straight = soft_straight(folder)
    for ends in (False, True):
        outcome = Outcome("LAMMPS is stopped (SIGSTOP), then " + ("the run is asked to end (SIGTERM)" if ends else "sent on (SIGCONT)"))
        case = soft_bed(folder, f"stops{ends}")
        going, text = start(case, word="LAMMPS (pid", command=(DEM,), env={**os.environ, **before_lammps("stops:72")})
        said = re.search(r"LAMMPS \(pid (\d+)\) is stopped; .*", text)
        if ends:
            going.send_signal(signal.SIGTERM)
        else:
            os.kill(int(said[1]), signal.SIGCONT)
        more, error = rest(going)
        outcome.take(case, text + more, re.sub(r"\d+", "N", said[0]) + "\n" + error)
        if going.returncode != (3 if ends else 0) or not outcome.reported or runs_on(said[1]):
            outcome.after.append(f"exit code {going.returncode}, {outcome.reported} times: {error}")
        again(outcome, case, straight, "0.0025", DEM)
        yield outcome


def child_killed(folder, count, seed=1):
    """kill -9 of the child at random moments."""
    if not shutil.which("lmp"):
        return None
    chance = random.Random(seed)
    outcome = Outcome("kill -9 of LAMMPS at random moments")
    straight = soft_straight(folder)
    for k in range(count):
        case = soft_bed(folder, f"child{k}")
        going, text = start(case, command=(DEM,))
        time.sleep(chance.random() * 0.1)
        with open(f"/proc/{going.pid}/task/{going.pid}/children") as f:
            children = f.read().split()
        for child in children:
            os.kill(int(child), signal.SIGKILL)
        more, error = rest(going)
        outcome.take(case, text + more, error)
        if going.returncode != (3 if children else 0):
            outcome.after.append(f"exit code {going.returncode}: {error}")
        again(outcome, case, straight, "0.0025", DEM)
    return outcome


# ---- disks and folders -----------------------------------------------------------------------------------------------


def full_disk(folder):
    """A real one of 2 MB; None where it cannot be mounted."""
    outcome = Outcome("a disk of 2 MB runs full")
    place = os.path.join(folder, "small")
    os.mkdir(place)
    if os.geteuid() or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", place], capture_output=True, check=False).returncode:
        return None
    try:
        straight = straight_run(folder, "disk_straight", n=(40, 30, 1), steps=30)
        case = shutil.copytree(make(folder, "disk", n=(40, 30, 1), steps=30), os.path.join(place, "disk"))
        done = run(case)
        outcome.take(case, done.stdout, done.stderr)
        if done.returncode != 3 or runs.hidden(case) or "No space left" not in done.stderr:
            outcome.after.append(f"exit code {done.returncode}, {runs.hidden(case)}")
        for name in runs.times(case)[1:-1]:
            shutil.rmtree(os.path.join(case, name))
        runs.add(case, CONTROL, "purgeWrite 2;\n")
        again(outcome, case, straight, runs.times(straight)[-1])
    finally:
        subprocess.run(["umount", place], check=True)
    return outcome


def file_size_limit(folder):
    outcome = Outcome("files may not grow any more (ulimit -f)")
    straight = straight_run(folder, "limit_straight", n=(60, 40, 1), digits=17)
    case = make(folder, "limit", n=(60, 40, 1), digits=17)
    limit = (20000, 20000)
    done = run(case, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit))
    outcome.take(case, done.stdout, done.stderr)
    if done.returncode != 3 or runs.hidden(case) or "File too large" not in done.stderr:
        outcome.after.append(f"exit code {done.returncode}: {done.stderr}")
    again(outcome, case, straight)
    return outcome


def nobody():
    """Who may not write everywhere: root's tests run as another. None if that one cannot start the program."""
    who = {"user": 65534, "group": 65534} if os.geteuid() == 0 else {}
    try:
        subprocess.run([GAS, "-help"], capture_output=True, check=True, **who)
    except (OSError, subprocess.CalledProcessError):
        return None
    return who


def closed_folder(folder):
    """Write permission is taken away before, and in the middle of a run."""
    who = nobody()
    if who is None:
        return
    os.chmod(folder, 0o755)
    straight = straight_run(folder, "closed_straight")
    for during in (False, True):
        outcome = Outcome("the case folder becomes unwritable during the run" if during else "the case folder is not writable")
        case = make(folder, f"closed{during}", control="none")
        os.chmod(case, 0o777)
        if during:
            harness.edit(case, CONTROL, endTime=1e6)
            going, text = start(case, word="Time =", **who)
            os.chmod(case, 0o555)
            going.send_signal(signal.SIGTERM)
            more, error = rest(going)
            outcome.take(case, text + more, error)
            code = going.returncode
        else:
            os.chmod(case, 0o555)
            done = run(case, **who)
            outcome.take(case, done.stdout, done.stderr)
            code = done.returncode
        os.chmod(case, 0o777)
        if code != 3 or "Permission denied" not in outcome.said:
            outcome.after.append(f"exit code {code}")
        harness.edit(case, CONTROL, endTime=END, writeControl="timeStep")
        again(outcome, case, straight)
        yield outcome


def folder_gone(folder):
    outcome = Outcome("the case folder is moved away during the run")
    case = make(folder, "gone", steps=10**7, control="none")
    going, text = start(case, word="Time =")
    os.rename(case, case + "_elsewhere")
    going.send_signal(signal.SIGTERM)
    more, error = rest(going)
    outcome.take(case, text + more, error)
    if going.returncode != 3 or os.path.exists(case):
        outcome.after.append(f"exit code {going.returncode}, made anew: {os.path.exists(case)}")
    return outcome


def folder_swapped(folder):
    outcome = Outcome("the case folder is moved away during the run, and another case put in its place")
    case = make(folder, "swapped", steps=10**7, control="none")
    other = make(folder, "other")
    before = runs.contents(other, ignore=())
    going, text = start(case, word="Time =")
    os.rename(case, case + "_elsewhere")
    os.rename(other, case)
    going.send_signal(signal.SIGTERM)
    more, error = rest(going)
    outcome.take(case, text + more, error)
    if going.returncode != 3 or runs.contents(case, ignore=()) != before:
        outcome.after.append(f"exit code {going.returncode}")
    return outcome


def log_lost(folder):
    """The log cannot be written: the run goes on."""
    straight = straight_run(folder, "log_straight")
    for what in ("the disk of the log is full", "the log is a pipe that nobody reads any more"):
        outcome = Outcome(what)
        case = make(folder, what.replace(" ", "_"))
        if "disk" in what:
            with open("/dev/full", "w") as log:
                done = subprocess.run([GAS, "-case", case], stdout=log, stderr=subprocess.PIPE, text=True, timeout=120, check=False)
            code, error = done.returncode, done.stderr
        else:
            going, _ = start(case)
            going.stdout.close()
            with going.stderr:
                code, error = going.wait(120), going.stderr.read()
        outcome.take(case, "".join(f"    written: {name}\n" for name in runs.times(straight)[1:]), error)
        if code:
            outcome.after.append(f"exit code {code}")
        again(outcome, case, straight)
        yield outcome


# ---- changes between runs, and a second run --------------------------------------------------------------------------


def settled(folder, name, **options):
    """A case that has written three times and goes on to a fourth; and what its run had said of the three."""
    case = make(folder, name, steps=4, **options)
    text = run(case).stdout
    shutil.rmtree(os.path.join(case, "0.0008"))
    return case, text.replace("    written: 0.0008\n", "")


def second_run(folder):
    outcome = Outcome("a second solver is started on the case")
    case = endless(folder, "second")
    going, text = start(case, 2)
    done = run(case)
    going.send_signal(signal.SIGTERM)
    text += rest(going)[0]
    outcome.take(case, last_lines(text), done.stderr)
    if done.returncode != 1 or going.returncode:
        outcome.after.append(f"exit codes {done.returncode}, {going.returncode}")
    to_an_end(outcome, folder, case)
    return outcome


def damage(path, how):
    with open(path, "rb") as f:
        data = bytearray(f.read())
    data[len(data) // 2] ^= 4
    os.remove(path)
    if how != "is removed":
        with open(path, "wb") as f:
            f.write(data if how == "has one bit turned" else data[:len(data) // 2])


def damaged(folder):
    """The state a run would start from."""
    for how in ("is cut in half", "has one bit turned", "is removed"):
        for previous in (False, True) if how == "is cut in half" else (False,):
            outcome = Outcome(f"rhoE of the last time {how}" + (", with onCorruptTime previous" if previous else ""), note="the damaged file itself")
            case, text = settled(folder, f"damaged {how} {previous}")
            straight = shutil.copytree(case, case + "_straight")
            run(straight)
            damage(os.path.join(case, "0.0006", "rhoE"), how)
            if previous:
                runs.add(case, CONTROL, "onCorruptTime previous;\n")
            done = run(case)
            said = "".join(re.findall(r"note: time .* is damaged(?:.*\n)(?:    .*\n)*", done.stdout)) or done.stderr
            outcome.take(case, text.replace("    written: 0.0006\n", ""), said)
            if done.returncode == previous:
                outcome.after.append(f"exit code {done.returncode}")
            if not previous:
                shutil.rmtree(os.path.join(case, "0.0006"))  # one of the cures
            again(outcome, case, straight, "0.0008")
            yield outcome


def changed(folder):
    """Mesh and dictionaries, between a time and the restart from it."""
    for what in ("restitution and maxCo are changed", "the mesh is changed to one of as many cells", "the mesh is changed to one of other cells"):
        outcome = Outcome(what + " before the restart")
        case, text = settled(folder, what)
        if "mesh" in what:
            cells = (8, 6, 1) if "as many" in what else (8, 5, 1)
            harness.boxes.write_mesh(case, cells, (1.0, 0.6, 0.1))
        else:
            harness.edit(case, "constant/granularProperties", restitution=0.8)
            harness.edit(case, CONTROL, maxCo=0.4)
        done = run(case)
        outcome.take(case, text, "".join(re.findall(r"Changed since time.*\n(?:    .*\n)*", done.stdout)) or done.stderr)
        if done.returncode != ("other cells" in what):
            outcome.after.append(f"exit code {done.returncode}")
        yield outcome


def broken_control(folder):
    outcome = Outcome("controlDict is broken by an editor during the run")
    case = endless(folder, "broken")
    harness.edit(case, CONTROL, runTimeModifiable="yes")
    with open(os.path.join(case, CONTROL)) as f:
        good = f.read()
    going, text = start(case, 2)
    with open(os.path.join(case, CONTROL), "w") as f:
        f.write(good.replace("maxCo 0.5;", "maxCo 0.5"))
    for line in going.stdout:
        text += line
        if "stays in force" in line:
            break
    going.send_signal(signal.SIGTERM)
    more, error = rest(going)
    outcome.take(case, last_lines(text + more), line + error)
    if going.returncode:
        outcome.after.append(f"exit code {going.returncode}")
    with open(os.path.join(case, CONTROL), "w") as f:
        f.write(good)
    to_an_end(outcome, folder, case)
    return outcome


def write_cost(folder, n=400, writes=12):
    """Seconds for one written time of n x n cells: (with nothing synced, as it is, MB)."""
    spent = {}
    case = make(folder, "cost", n=(n, n, 1), steps=writes, format="binary", purge=1)
    for what, fault in (("sync", None), ("none", None), ("free", "count:0")) * 3:
        harness.edit(case, CONTROL, writeControl="none" if what == "none" else "timeStep")
        for name in runs.times(case)[1:]:
            shutil.rmtree(os.path.join(case, name))
        seconds = float(re.search(r"steps in (\S+) s,", run(case, fault=fault).stdout)[1])
        spent[what] = min(spent.get(what, seconds), seconds)
    harness.edit(case, CONTROL, writeControl="timeStep")
    run(case)
    size = sum(size for size, _ in sums(os.path.join(case, runs.times(case)[-1])).values())
    return (spent["free"] - spent["none"]) / writes, (spent["sync"] - spent["none"]) / writes, size / 1e6


def every_fault(folder, every, count):
    """`count` random kills, and every so-manyth system call."""
    yield kills(folder, count)
    yield death_at_each_call(folder, every)
    yield power_cuts(folder, every)
    yield torn_files(folder, 2 * every - 1)
    yield full_from_each_call(folder, every)
    yield permission_lost(folder, 2 * every - 1)
    yield no_rename(folder, 2 * every - 1)
    yield unsaid(folder, 2 * every - 1)
    yield disk_errors(folder, every)
    yield clock_jumps(folder)
    yield from answers(folder, ANSWERS if every == 1 else ("killed", "far", "negative"))
    yield from child_stops(folder)
    yield child_killed(folder, 1 + count // 50)
    yield from ranks(folder)
    yield from signals(folder)
    yield full_disk(folder)
    yield file_size_limit(folder)
    yield from closed_folder(folder)
    yield folder_gone(folder)
    yield folder_swapped(folder)
    yield from log_lost(folder)
    yield second_run(folder)
    yield from damaged(folder)
    yield from changed(folder)
    yield broken_control(folder)
