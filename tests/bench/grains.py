#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What soft grains cost beside LAMMPS, and what ensembles of hard grains gain on two ranks.

    tests/bench/grains.py soft [BIN] [-steps N] [-writes N] [-ranks N] [-width M]     BIN: folder of the programs (build/bin)
    tests/bench/grains.py ensemble [BIN] [-members 32] [-rounds 3] [-ranks 1 2] [-case cases/coolingMixture]

soft: CPU time of all processes of granularDEM and of LAMMPS alone. The case is cases/bouncingBedDEM, M meters wide (0.1: 8560 grains), in N
steps up to N written times of 10 samples each. LAMMPS then runs the same commands (dem/in.lammps) and steps from the same grains without
haff; and once more without the keyword `contacts` of walls.

ensemble: wall and CPU time of granularMD -ensemble N -np R on that case, for each R in turn, as medians of the rounds: members a second, and
how many times as fast as on the first R. Quiet cores are needed, one for each rank.
"""
import argparse
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
CASE = os.path.join(ROOT, "cases", "bouncingBedDEM")
GRAINS = 8560 / 0.1


def edit(path, *changes):
    with open(path) as f:
        text = f.read()
    for pattern, new in changes:
        text, n = re.subn(pattern, new, text, flags=re.M)
        assert n == 1, f"{path}: {pattern} is there {n} times"
    with open(path, "w") as f:
        f.write(text)


def cpu(command, **options):
    """CPU seconds of a command and of all that it starts; its output."""
    def spent():
        use = resource.getrusage(resource.RUSAGE_CHILDREN)
        return use.ru_utime + use.ru_stime
    before = spent()
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options).stdout
    return spent() - before, text


def copy_of(case, folder, programs, *numbers):
    """A copy of a shipped case in a folder, with its mesh of those gmsh numbers."""
    path, msh = os.path.join(folder, "case"), os.path.join(folder, "mesh.msh")
    shutil.copytree(case, path, ignore=shutil.ignore_patterns("[0-9]", "[1-9]*", "ensemble", "postProcessing", "polyMesh", "e0.*"))
    subprocess.run(["gmsh", "-3", *numbers, "-format", "msh2", "-o", msh, os.path.join(path, "mesh.geo")], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([os.path.join(programs, "gmshToCase"), msh, "-case", path], check=True, stdout=subprocess.DEVNULL)
    return path


def case_of(folder, options):
    path = copy_of(CASE, folder, options.programs, "-setnumber", "W", str(options.width))
    grains = round(GRAINS * options.width)
    edit(os.path.join(path, "constant/particleProperties"), (r"^N .*$", f"N {grains};"), (r"^coarseGraining .*$", "coarseGraining { kernel cell; samples 10; }"))
    return path, grains


def until(path, end, writes, solver):
    """Runs the case to a time with equal write intervals; CPU seconds and output."""
    edit(os.path.join(path, "system/controlDict"), (r"^endTime .*$", f"endTime {end:.17g};"), (r"^writeInterval .*$", f"writeInterval {end / writes:.17g};"))
    for old in [name for name in os.listdir(path) if re.fullmatch(r"[0-9.e-]+", name)]:
        shutil.rmtree(os.path.join(path, old))
    return cpu(solver)


def alone(folder, deck, steps, dt, ranks):
    """CPU seconds of LAMMPS with the commands of a deck, less those of reading and of the first set-up."""
    def run(n):
        name = os.path.join(folder, "in.alone")
        with open(name, "w") as f:
            f.write(deck + f"timestep {dt}\nvariable begin equal $(step)\nvariable time equal (step-v_begin)*{dt}\nrun {n} post no\n")
        launch = ["mpirun", "-np", str(ranks)] if ranks > 1 else []
        return cpu([*launch, "lmp", "-log", "none", "-in", name])[0]
    return run(steps) - run(0)


def soft(options):
    with tempfile.TemporaryDirectory() as folder:
        path, grains = case_of(folder, options)
        solver = [os.path.join(options.programs, "granularDEM"), "-case", path, "-np", str(options.ranks)]
        longest = float(re.search(r"steps of at most ([\d.e+-]+) s", cpu([*solver, "-dry-run"])[1])[1])
        end = 0.999 * longest * options.steps
        start = until(path, 1e-3 * longest, 1, solver)[0]
        both, text = until(path, end, options.writes, solver)
        found = re.search(r"(\d+) steps of (\d+) grains: ([\d.]+) s in LAMMPS, ([\d.]+) s for samples", text)
        assert found, text[-2000:]
        steps = int(found[1])
        with open(os.path.join(path, "dem", "in.lammps")) as f:
            deck = f.read()
        seconds = alone(folder, deck, steps, end / steps, options.ranks)
        bare = alone(folder, re.sub(r" contacts$|^(dump|dump_modify) walls .*$|^variable touch .*$", "", deck, flags=re.M), steps, end / steps, options.ranks)
    print(f"{grains} grains, {steps} steps, {options.writes} written times of 10 samples, ranks: {options.ranks}")
    print(f"granularDEM {both:.2f} s of CPU, {start:.2f} s of them at the start (by the clock {found[3]} s in LAMMPS, {found[4]} s for samples)")
    for what, alone_s in (("the same commands", seconds), ("without `contacts`", bare)):
        print(f"LAMMPS alone, {what}: {alone_s:.2f} s; granularDEM takes {100 * ((both - start) / alone_s - 1):.1f} % more, with its start {100 * (both / alone_s - 1):.1f} %")


def ensemble(options):
    program, found = os.path.join(options.programs, "granularMD"), {ranks: [] for ranks in options.ranks}
    with tempfile.TemporaryDirectory() as folder:
        path = copy_of(options.case, folder, options.programs)
        for _ in range(options.rounds):
            for ranks, times in found.items():
                with tempfile.TemporaryDirectory() as fresh:
                    copy = shutil.copytree(path, os.path.join(fresh, "case"))
                    begin = time.monotonic()
                    spent = cpu([program, "-ensemble", str(options.members), "-np", str(ranks), "-case", copy])[0]
                    times.append((time.monotonic() - begin, spent))
    medians = {ranks: [statistics.median(column) for column in zip(*times)] for ranks, times in found.items()}
    first = medians[options.ranks[0]][0]
    for ranks, (wall, spent) in medians.items():
        print(f"{options.members} members, {ranks} at once: {wall:.2f} s, {spent:.2f} s of CPU, {options.members / wall:.2f} members/s, "
              f"{first / wall:.2f} times as fast")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    work = parser.add_subparsers(dest="work", required=True)
    lammps, members = work.add_parser("soft"), work.add_parser("ensemble")
    lammps.add_argument("-steps", type=int, default=10000)
    lammps.add_argument("-writes", type=int, default=1)
    lammps.add_argument("-ranks", type=int, default=1)
    lammps.add_argument("-width", type=float, default=0.1)
    members.add_argument("-members", type=int, default=32)
    members.add_argument("-rounds", type=int, default=3)
    members.add_argument("-ranks", type=int, nargs="+", default=[1, 2])
    members.add_argument("-case", default=os.path.join(ROOT, "cases", "coolingMixture"))
    for part in (lammps, members):
        part.add_argument("programs", nargs="?", default=os.path.join(ROOT, "build", "bin"))
    options = parser.parse_args()
    soft(options) if options.work == "soft" else ensemble(options)


if __name__ == "__main__":
    sys.exit(main())
