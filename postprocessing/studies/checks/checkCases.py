# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs cases in full and compares them with their expected.json; ../Allcheck builds the programs and calls this.

Each case runs as its Allrun does it, in a copy in build/check/cases; its variants (CASE/NAME: other entries or another grid) run in
build/check/variants. The table below gives processor seconds in user mode of Allrun, figure included. `seconds` of expected.json is what -record wrote down of them, by which the cases are ordered. A case is run
again only if the programs or its files have changed since; one that was stopped goes on from its last time. A value that is not the
one written down as `measured` in expected.json is pointed at; -record writes all down. Exit code 1: a value is outside its tolerance
or missing, or a case did not run to its end."""
import fcntl
import hashlib
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

from haff import command
from haff.paths import TOP, program
from haff.runs import expected, run
from studies.checks import variants

RESULTS = shutil.ignore_patterns("[1-9]*", "0", "0.[0-9]*", "polyMesh", "postProcessing", "VTK", "*.msh", "log.*", ".haff.lock", "__pycache__")
UNREAD = re.compile(r"README\.md|(expected|tables)\.json|figure\.py|.*\.png")  # what a run does not depend on


def names():
    """All cases."""
    folder = os.path.join(TOP, "cases")
    return sorted(n for n in os.listdir(folder) if os.path.isfile(os.path.join(folder, n, "expected.json")))


def home(name):
    return os.path.join(TOP, "cases", name)


def copies_in(root):
    """All cases and variants, the cheapest first."""
    found = [Copy(name, root) for name in names()]
    for name in names():
        found += [(Variant if variants.digest(v) else Extra)(name, v, root) for v in variants.load(home(name))]
    return sorted(found, key=lambda copy: (copy.cost, copy.name))


def sources(name):
    """The case and the cases whose files its Allrun takes."""
    with open(os.path.join(TOP, "cases", name, "Allrun")) as f:
        return [name] + sorted(set(re.findall(r"\$top/cases/(\w+)", f.read())) - {name})


class Copy:
    """A case in build/check, as a tree that its scripts take for the whole repository."""

    variant = {}

    def __init__(self, name, root):
        self.begin(name, name, root, os.path.join(root, "cases", name), os.path.join(root, name + ".json"))
        self.cost = expected.load(home(name), "seconds")

    def begin(self, name, case, root, path, notes):
        """name: what the table says; path: of the copy; notes: how far it has come."""
        self.name, self.case, self.root, self.path, self.notes = name, case, root, path, notes
        self.state = {"stamp": "", "seconds": 0.0, "done": False}

    def recall(self):
        """How far an earlier call has come."""
        if os.path.exists(self.notes) and os.path.isdir(self.path):
            with open(self.notes) as f:
                self.state = json.load(f)

    def keep(self, **state):
        self.state.update(state)
        with open(self.notes + ".tmp", "w") as f:
            json.dump(self.state, f)
        os.replace(self.notes + ".tmp", self.notes)

    def stamp(self):
        """Of the programs and of all files that the run may read."""
        files, programs = [], {"gmshToCase"}
        for name in sources(self.case):
            folder = os.path.join(TOP, "cases", name)
            for base, folders, found in os.walk(folder):
                folders[:] = sorted(set(folders) - RESULTS(base, folders))
                files += [os.path.join(base, n) for n in sorted(set(found) - RESULTS(base, found)) if not UNREAD.fullmatch(n)]
            with open(os.path.join(folder, "system", "controlDict")) as f:
                programs.update(re.findall(r"^\s*application\s+(\w+)\s*;", f.read(), re.M))
        digest = hashlib.sha256(" ".join(self.words()).encode())
        for file in files + [program(name) for name in sorted(programs)]:
            with open(file, "rb") as f:
                digest.update(os.path.relpath(file, TOP).encode() + b"\0" + f.read() + b"\0")
        return digest.hexdigest()

    def words(self):
        """What Allrun gets, where the check is less than all that it shows."""
        return expected.read(home(self.case)).get("words", "").split()

    def make(self):
        """The case anew, and links to whatever else its scripts look for; one case at a time, for they link each other."""
        with open(os.path.join(self.root, "lock"), "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.put()

    def put(self):
        for link in [".ci", "postprocessing", "build/bin", "tests/oracles"] + [f"cases/{n}" for n in names() if n != self.case]:
            at = os.path.join(self.root, link)
            os.makedirs(os.path.dirname(at), exist_ok=True)
            if not os.path.lexists(at):
                os.symlink(os.path.join(TOP, link), at)
        if os.path.islink(self.path):
            os.remove(self.path)
        shutil.rmtree(self.path, ignore_errors=True)
        shutil.copytree(home(self.case), self.path, ignore=RESULTS)
        subprocess.run([os.path.join(self.path, "Allclean")], check=True)  # copies that variants made
        for name in sources(self.case)[1:]:
            if not os.path.islink(os.path.join(self.root, "cases", name)):
                shutil.copytree(os.path.join(TOP, "cases", name), os.path.join(self.root, "cases", name), ignore=RESULTS,
                                dirs_exist_ok=True)

    def refresh(self):
        """Takes over what a run does not depend on, as the values to compare with."""
        for name in ("expected.json", "figure.py"):
            shutil.copy(os.path.join(home(self.case), name), self.path)

    def run(self):
        """Runs to the end unless that stands; returns what went wrong."""
        self.recall()
        stamp = self.stamp()
        if stamp != self.state["stamp"]:
            self.make()
            self.keep(stamp=stamp, seconds=0.0, done=False)
        self.refresh()
        if self.state["done"]:
            return ""
        before = os.times()
        trouble = self.carry_out()
        after = os.times()
        self.keep(seconds=self.state["seconds"] + after.children_user - before.children_user, done=not trouble)
        return trouble

    def carry_out(self):
        """Calls Allrun; returns what went wrong."""
        log = os.path.join(self.root, self.case + ".log")
        with open(log, "w") as f:
            code = subprocess.run([os.path.join(self.path, "Allrun"), *self.words()], stdin=subprocess.DEVNULL, stdout=f, stderr=f,
                                  env={**os.environ, "HAFF_REPORT": "no"}).returncode
        return "" if code == 0 else f"Allrun ended with {code}; see {os.path.relpath(log)}"

    def entries(self):
        return expected.load(self.path, "full")

    @staticmethod
    def stands(entry, value):
        """Is the value the one that is written down?"""
        return f"{entry['measured']:.6g}" == f"{value:.6g}"

    def write_down(self, values):
        """The values of `full` and the seconds into the expected.json of the case itself; what was not measured stays."""
        known = expected.read(home(self.case))
        known["seconds"] = variants.spent(self.state["seconds"])
        for entry, value in zip(known["full"], values):
            if value == value:
                entry["measured"] = float(f"{value:.9g}")
        expected.save(home(self.case), known)


class Extra(Copy):
    """More numbers of the case itself, of the same run: a variant that changes nothing."""

    def __init__(self, case, variant, root):
        super().__init__(case, root)
        self.name, self.variant = f"{case}/{variant['name']}", variant

    def entries(self):
        return variants.entries(self.variant)

    @staticmethod
    def stands(entry, value):
        return entry["measured"] == variants.rounded(value, entry["tolerance"])

    def write_down(self, values):
        variants.write_down(home(self.case), self.variant["name"], values)


class Variant(Extra):
    """A case with other entries or on another grid, in build/check/variants. The folder of the copy has the name of the case, which some
    quantities need."""

    def __init__(self, case, variant, root):
        folder = os.path.join(root, "variants", f"{case}-{variant['name']}")
        self.variant, self.cost = variant, variant.get("seconds", 0)
        self.begin(f"{case}/{variant['name']}", case, root, os.path.join(folder, case), os.path.join(folder, "notes.json"))

    def stamp(self):
        return hashlib.sha256(super().stamp().encode() + variants.digest(self.variant)).hexdigest()

    def make(self):
        shutil.rmtree(self.path, ignore_errors=True)
        os.makedirs(os.path.dirname(self.path), exist_ok=True)

    def refresh(self):
        pass

    def carry_out(self):
        wanted = self.variant.get("ends", 0)
        try:
            run.run(home(self.case), variants.changes(self.variant, home(self.case)), mesh=self.variant.get("mesh"), folder=self.path, ranks=int(os.environ.get("ranks", 1)))
        except run.RunError as error:
            return "" if error.code == wanted else f"{error.program} ended with {error.code}; see {os.path.relpath(error.log)}"
        return f"the run reached its end, and did not stop with {wanted}" if wanted else ""

    def write_down(self, values):
        variants.write_down(home(self.case), self.variant["name"], values, self.state["seconds"])


def show(name, quantity, measured, wanted, tolerance, verdict):
    print(f"{name:<32}{quantity:<50}{measured:>14} {wanted:>14} {tolerance:>9}  {verdict}", flush=True)


def verdict(copy, entry, value, right):
    """What the row of a value says at its end."""
    if not right:
        return "FAILED"
    if "measured" in entry and copy.stands(entry, value):
        return "ok"
    return f"ok, but {format(entry['measured'], '.6g') if 'measured' in entry else 'nothing'} is written down (-record)"


def families(chosen):
    """Lists of those that run one after the other, for they share files: a case, its variants that change nothing, and the cases
    whose files it takes."""
    found = []
    for copy in chosen:
        needed = {copy.path} if isinstance(copy, Variant) else {*sources(copy.case)}
        same = [family for family in found if family[0] & needed]
        found = [family for family in found if family not in same]
        found.append((needed.union(*(f[0] for f in same)), [c for f in same for c in f[1]] + [copy]))
    return [copies for needed, copies in found]


def run_family(copies):
    """Runs them in a process of its own, whose children are theirs alone; returns what went wrong with each, and its state."""
    fork = multiprocessing.get_context("fork")
    get, put = fork.Pipe(duplex=False)

    def work():
        try:
            put.send([(copy.run(), copy.state) for copy in copies])
        except KeyboardInterrupt:
            put.send(KeyboardInterrupt())
        except Exception as error:
            put.send(error)

    worker = fork.Process(target=work, daemon=True)
    worker.start()
    put.close()
    found = get.recv()
    worker.join()
    if isinstance(found, BaseException):
        raise found
    return found


def run_each(chosen, jobs):
    """Runs all, `jobs` families at once; yields each with what went wrong, in the order in which they were started."""
    with ThreadPoolExecutor(jobs) as pool:
        started = [(copies, pool.submit(run_family, copies)) for copies in families(chosen)]
        try:
            for copies, future in started:
                for copy, (trouble, copy.state) in zip(copies, future.result()):
                    yield copy, trouble
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def check(copy, trouble, record=False):
    """Prints the rows of a case or variant that has run; returns whether all is well."""
    good, values = not trouble, []
    if trouble:
        show(copy.name, trouble, "", "", "", "FAILED")
    for entry in copy.entries():
        value, right, why = expected.judge(copy.path, entry)
        right = right or (record and value == value and entry.get("own", False))
        good = good and right
        show(copy.name, expected.describe(entry), why or f"{value:.9g}", f"{entry['value']:.9g}", f"{entry['tolerance']:.2g}",
             "ok" if record and right else verdict(copy, entry, value, right))
        values.append(value)
    if record and not trouble:
        copy.write_down(values)
    print(f"{copy.name:<32}{copy.state['seconds']:.1f} s of processor time (written down: {copy.cost:g} s)", flush=True)
    return good


def choose(known, wanted, parser):
    """Those of the names CASE (with its variants) and CASE/VARIANT, or all that need not be named."""
    found = {copy.name for copy in known}
    wanted = [word if word in found else os.path.basename(os.path.abspath(word)) for word in wanted]
    for name in wanted:
        if name not in found:
            parser.error(f"no case {name}; there are: {' '.join(names())}")
    return [copy for copy in known if copy.name in wanted or copy.case in wanted or not (wanted or copy.variant.get("named"))]


def main():
    parser = command.parser(__doc__.split("\n\n")[1], prog="Allcheck")
    parser.add_argument("cases", nargs="*", metavar="CASE", help="a case with its variants, or CASE/VARIANT; by default all but those that are to be named (-list)")
    parser.add_argument("-list", action="store_true", help="says what there is and what it costs; runs nothing")
    parser.add_argument("-within", type=float, metavar="SECONDS", default=float("inf"), help="only cases that cost no more than that")
    parser.add_argument("-record", action="store_true", help="writes what was measured into expected.json; then run docs/makeTables and docs/makeValidation")
    parser.add_argument("-np", type=int, default=1, metavar="N", help="on N ranks")
    parser.add_argument("-jobs", type=int, default=0, metavar="N", help="N cases at once; by default one for each core, or each NP cores")
    parser.add_argument("-scratch", metavar="FOLDER", default=os.path.join(TOP, "build", "check"), help="instead of build/check")
    options = parser.parse_args()
    known = copies_in(os.path.abspath(options.scratch))
    chosen = choose(known, options.cases or names() * options.list, parser)
    chosen = [copy for copy in chosen if copy.cost <= options.within]
    if options.list:
        for copy in chosen:
            entries = copy.entries() if isinstance(copy, Extra) else expected.load(home(copy.case), "full")
            print(f"{copy.name:<32}{copy.cost:>7g} s {len(entries):>3} values" + "  if named" * copy.variant.get("named", False))
        return 0
    os.environ["ranks"] = str(options.np)
    os.makedirs(options.scratch, exist_ok=True)
    show("case", "quantity", "measured", "expected", "tolerance", "")
    bad, done, began = [], [], time.time()
    try:
        for copy, trouble in run_each(chosen, options.jobs or max(1, len(os.sched_getaffinity(0)) // options.np)):
            if not check(copy, trouble, options.record):
                bad.append(copy.name)
            done.append(copy)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here")
    left = [copy for copy in known if copy not in done]
    print(f"\n{len(done)} of {len(known)} cases and variants in {time.time() - began:.0f} s: {len(done) - len(bad)} as expected, {len(bad)} not"
          + (": " + " ".join(bad) if bad else ""))
    if left:
        print("not run: " + " ".join(f"{copy.name} ({copy.cost:g} s)" for copy in left))
    return 1 if bad or len(done) < len(chosen) else 0


if __name__ == "__main__":
    sys.exit(main())
