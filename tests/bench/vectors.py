#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guards against silent loss of vectorisation: the solver with the machine's widest vectors against the same sources
compiled without any, in turn on one core, best of several. Exit code 1 if a ratio is below FLOOR. Builds both first, where the folder
is that of a build: the sources without vectors are compiled for nothing else.

    tests/bench/vectors.py [folder of programs]
"""
import os
import re
import subprocess
import sys

SCHEMES = (("common", "WENO5"), ("common", "PHM"), ("Marquina", "PHM"), ("LaxFriedrichs", "WENO5"))
FLOOR = 1.5  # leaves room for noise and for machines with vectors of four
ROUNDS = 3
SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))


def rate(program, scheme):
    """Best million cell-stages per second of 10 steps of 200 x 200 cells."""
    command = [program, "200", "10", *scheme]
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return float(re.search(r"best +([0-9.]+) M", output)[1])


def build(folder):
    top = os.path.dirname(os.path.abspath(folder))
    if os.path.exists(os.path.join(top, "CMakeCache.txt")):
        subprocess.run(["cmake", "--build", top, "--parallel", "--target", "bench_throughput", "bench_throughput_plain"], check=True,
                       stdout=subprocess.DEVNULL)


def main(folder):
    build(folder)
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    failed = False
    print("M cell-stages/s, 2D          vectors   without   ratio")
    for scheme in SCHEMES:
        vectors = plain = 0.0
        for _ in range(ROUNDS):
            vectors = max(vectors, rate(os.path.join(folder, "bench_throughput"), scheme))
            plain = max(plain, rate(os.path.join(folder, "bench_throughput_plain"), scheme))
        ratio = vectors / plain
        failed |= ratio < FLOOR
        print(f"{' '.join(scheme):28s} {vectors:7.2f}   {plain:7.2f}   {ratio:5.2f}{'  TOO SMALL' if ratio < FLOOR else ''}")
    print(f"FAILED: vectorisation was lost, a ratio is below {FLOOR}" if failed else f"passed: every ratio is at least {FLOOR}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else os.path.join(SOURCE, "build", "bin")))
