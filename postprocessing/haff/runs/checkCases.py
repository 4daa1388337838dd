# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs cases in full and compares them with their expected.json; ../Allcheck builds the programs and calls this.

Each case runs as its Allrun does it, in a copy in build/check/cases; the table below gives processor seconds of Allrun, figure
included, and `seconds` of expected.json is what that took when it was written, by which the cases are ordered. A case is run
again only if the programs or its files have changed since; one that was stopped goes on from its last time. A value that is not the
one written down as `measured` in expected.json is pointed at; -record writes all down. Exit code 1: a value is outside its tolerance
or missing, or a case did not run to its end."""
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time

from haff import command
from haff.paths import TOP
from haff.runs import expected

RESULTS = shutil.ignore_patterns("[1-9]*", "0", "0.[0-9]*", "polyMesh", "postProcessing", "VTK", "*.msh", "log.*", ".haff.lock", "__pycache__")
UNREAD = re.compile(r"README\.md|expected\.json|figure\.py|.*\.png")  # what a run does not depend on


def names():
    """All cases, the cheapest first."""
    folder = os.path.join(TOP, "cases")
    return sorted((n for n in os.listdir(folder) if os.path.isfile(os.path.join(folder, n, "expected.json"))),
                  key=lambda n: (cost(n), n))


def cost(name):
    return expected.load(os.path.join(TOP, "cases", name), "seconds")


def sources(name):
    """The case and the cases whose files its Allrun takes."""
    with open(os.path.join(TOP, "cases", name, "Allrun")) as f:
        return [name] + sorted(set(re.findall(r"\$top/cases/(\w+)", f.read())) - {name})


class Copy:
    """A case in build/check, as a tree that its scripts take for the whole repository."""

    def __init__(self, name, root):
        self.name, self.root = name, root
        self.path = os.path.join(root, "cases", name)
        self.notes = os.path.join(root, name + ".json")
        self.state = {"stamp": "", "seconds": 0.0, "done": False}
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
        for name in sources(self.name):
            folder = os.path.join(TOP, "cases", name)
            for base, folders, found in os.walk(folder):
                folders[:] = sorted(set(folders) - RESULTS(base, folders))
                files += [os.path.join(base, n) for n in sorted(set(found) - RESULTS(base, found)) if not UNREAD.fullmatch(n)]
            with open(os.path.join(folder, "system", "controlDict")) as f:
                programs.update(re.findall(r"^\s*application\s+(\w+)\s*;", f.read(), re.M))
        digest = hashlib.sha256()
        for file in files + [os.path.join(TOP, "build", "bin", p) for p in sorted(programs)]:
            with open(file, "rb") as f:
                digest.update(os.path.relpath(file, TOP).encode() + b"\0" + f.read() + b"\0")
        return digest.hexdigest()

    def make(self):
        """The case anew, and links to whatever else its scripts look for."""
        for link in [".ci", "postprocessing", "build/bin", "tests/oracles"] + [f"cases/{n}" for n in names() if n != self.name]:
            at = os.path.join(self.root, link)
            os.makedirs(os.path.dirname(at), exist_ok=True)
            if not os.path.lexists(at):
                os.symlink(os.path.join(TOP, link), at)
        if os.path.islink(self.path):
            os.remove(self.path)
        shutil.rmtree(self.path, ignore_errors=True)
        shutil.copytree(os.path.join(TOP, "cases", self.name), self.path, ignore=RESULTS)
        subprocess.run([os.path.join(self.path, "Allclean")], check=True)  # copies that variants made
        for name in sources(self.name)[1:]:
            if not os.path.islink(os.path.join(self.root, "cases", name)):
                shutil.copytree(os.path.join(TOP, "cases", name), os.path.join(self.root, "cases", name), ignore=RESULTS,
                                dirs_exist_ok=True)

    def refresh(self):
        """Takes over what a run does not depend on, as the values to compare with."""
        for name in ("expected.json", "figure.py"):
            shutil.copy(os.path.join(TOP, "cases", self.name, name), self.path)

    def run(self):
        """Runs Allrun to its end unless that stands; returns what went wrong."""
        stamp = self.stamp()
        if stamp != self.state["stamp"]:
            self.make()
            self.keep(stamp=stamp, seconds=0.0, done=False)
        self.refresh()
        if self.state["done"]:
            return ""
        log = os.path.join(self.root, self.name + ".log")
        before = os.times()
        with open(log, "w") as f:
            code = subprocess.run([os.path.join(self.path, "Allrun")], stdin=subprocess.DEVNULL, stdout=f, stderr=f,
                                  env={**os.environ, "HAFF_REPORT": "no"}).returncode
        after = os.times()
        spent = after.children_user + after.children_system - before.children_user - before.children_system
        self.keep(seconds=self.state["seconds"] + spent, done=code == 0)
        return "" if code == 0 else f"Allrun ended with {code}; see {os.path.relpath(log)}"


def show(name, quantity, measured, wanted, tolerance, verdict):
    print(f"{name:<24}{quantity:<50}{measured:>14} {wanted:>14} {tolerance:>9}  {verdict}", flush=True)


def verdict(entry, value, right):
    """What the row of a value says at its end."""
    if not right:
        return "FAILED"
    stands = f"{entry['measured']:.6g}" if "measured" in entry else "nothing"
    return "ok" if stands == f"{value:.6g}" else f"ok, but {stands} is written down (-record)"


def write_down(name, values):
    """The values of `full` into the expected.json of the case itself; what was not measured stays."""
    path = os.path.join(TOP, "cases", name)
    known = expected.read(path)
    for entry, value in zip(known["full"], values):
        if value == value:
            entry["measured"] = float(f"{value:.9g}")
    expected.save(path, known)


def check(name, root, record=False):
    """Runs a case and prints its rows; returns whether all is well."""
    copy = Copy(name, root)
    trouble = copy.run()
    good, values = not trouble, []
    if trouble:
        show(name, trouble, "", "", "", "FAILED")
    for entry in expected.load(copy.path, "full"):
        value, right, why = expected.judge(copy.path, entry)
        good = good and right
        show(name, expected.describe(entry), why or f"{value:.9g}", f"{entry['value']:.9g}", f"{entry['tolerance']:.2g}",
             "ok" if record and right else verdict(entry, value, right))
        values.append(value)
    if record and not trouble:
        write_down(name, values)
    print(f"{name:<24}{copy.state['seconds']:.1f} s of processor time (written down: {cost(name):g} s)", flush=True)
    return good


def main():
    parser = command.parser(__doc__.split("\n\n")[1], prog="Allcheck")
    parser.add_argument("cases", nargs="*", metavar="CASE", help="all by default")
    parser.add_argument("-list", action="store_true", help="says what there is and what it costs; runs nothing")
    parser.add_argument("-within", type=float, metavar="SECONDS", default=float("inf"), help="only cases that cost no more than that")
    parser.add_argument("-record", action="store_true", help="writes what was measured into expected.json; then run docs/makeValidation")
    parser.add_argument("-np", type=int, default=1, metavar="N", help="on N ranks")
    parser.add_argument("-scratch", metavar="FOLDER", default=os.path.join(TOP, "build", "check"), help="instead of build/check")
    options = parser.parse_args()
    known, wanted = names(), [os.path.basename(os.path.abspath(c)) for c in options.cases]
    for name in wanted:
        if name not in known:
            parser.error(f"no case {name}; there are: {' '.join(sorted(known))}")
    chosen = [n for n in known if (n in wanted or not wanted) and cost(n) <= options.within]
    if options.list:
        for name in chosen:
            print(f"{name:<24}{cost(name):>7g} s {len(expected.load(os.path.join(TOP, 'cases', name), 'full')):>3} values")
        return 0
    os.environ["ranks"] = str(options.np)
    os.makedirs(options.scratch, exist_ok=True)
    show("case", "quantity", "measured", "expected", "tolerance", "")
    bad, done, began = [], [], time.time()
    try:
        for name in chosen:
            if not check(name, os.path.abspath(options.scratch), options.record):
                bad.append(name)
            done.append(name)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here")
    left = [n for n in known if n not in done]
    print(f"\n{len(done)} of {len(known)} cases in {time.time() - began:.0f} s: {len(done) - len(bad)} as expected, {len(bad)} not"
          + (": " + " ".join(bad) if bad else ""))
    if left:
        print("not run: " + " ".join(f"{n} ({cost(n):g} s)" for n in left))
    return 1 if bad or set(chosen) - set(done) else 0


if __name__ == "__main__":
    sys.exit(main())
