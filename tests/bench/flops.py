#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Floating-point work per cell and stage of the benchmark's schemes, counted as executed:

    tests/bench/flops.py [cells a side [flux reconstruct]]

Counts every executed instruction of build/bin/bench_throughput under valgrind (callgrind) with one step and with two; the
difference, looked up in the disassembly, gives additions, multiplications, divisions, roots, minima and maxima by the
lanes of their vectors, an fma as two: what a processor's own counters count. Beside it the same with an fma as one, which
is what the two vector units issue, and the divisions and roots among them, which take a unit of their own. Lanes that are computed and thrown away
count, too. Valgrind knows AVX2 at most; the loops of wider vectors do the same work a lane.
"""
import os
import re
import subprocess
import sys
import tempfile

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
PROGRAM = os.path.join(os.environ.get("HAFF_BIN", os.path.join(SOURCE, "build", "bin")), "bench_throughput")
SCHEMES = [("common", "PHM"), ("common", "WENO5"), ("common", "WENOZ"), ("common", "WPENO5"), ("common", "TENO5"),
           ("LaxFriedrichs", "WENO5"), ("Marquina", "PHM"), ("Marquina", "WPENO5"), ("Rusanov", "firstOrder")]
PLAIN = re.compile(r"v?(add|sub|mul|div|sqrt|min|max)([sp])d$")
FUSED = re.compile(r"vfn?m(add|sub)\d+([sp])d$")


def operations(program):
    """Address -> (operations, issued, divisions and roots) of that instruction, of those that do any."""
    found = {}
    listing = subprocess.run(["objdump", "-d", "--no-show-raw-insn", program], capture_output=True, text=True, check=True)
    for line in listing.stdout.splitlines():
        parts = line.split(None, 2)
        if len(parts) < 3 or not parts[0].endswith(":"):
            continue
        plain, fused = PLAIN.match(parts[1]), FUSED.match(parts[1])
        if plain or fused:
            lanes = 1 if (plain or fused)[2] == "s" else 8 if "%zmm" in parts[2] else 4 if "%ymm" in parts[2] else 2
            slow = plain and plain[1] in ("div", "sqrt")
            found[int(parts[0][:-1], 16)] = (2 * lanes if fused else lanes, lanes, lanes if slow else 0)
    return found


def executed(program, per_address, arguments):
    """The three sums of one run."""
    total, mine, inclusive = [0, 0, 0], False, False
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "counts")
        subprocess.run(["valgrind", "--tool=callgrind", "--dump-instr=yes", "--dump-line=no", "--compress-strings=no",
                        "--compress-pos=no", f"--callgrind-out-file={out}", program, *arguments],
                       capture_output=True, check=True)
        with open(out) as f:
            for line in f:
                if line.startswith("ob="):
                    mine = os.path.realpath(line[3:].strip()) == os.path.realpath(program)
                elif line.startswith("calls="):
                    inclusive = True  # the next line is the cost of the callee, which is counted there
                elif line.startswith("0x"):
                    if mine and not inclusive:
                        address, count = line.split()
                        for i, n in enumerate(per_address.get(int(address, 16), ())):
                            total[i] += n * int(count)
                    inclusive = False
    return total


def main():
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    schemes = [tuple(sys.argv[2:4])] if len(sys.argv) > 3 else SCHEMES
    per_address = operations(PROGRAM)
    print("2D, a cell and stage         operations  fma as one  divisions, roots")
    for scheme in schemes:
        one, two = (executed(PROGRAM, per_address, [str(side), str(steps), *scheme]) for steps in (1, 2))
        numbers = [(b - a) / (3 * side * side) for a, b in zip(one, two)]
        print(f"{' '.join(scheme):28s} {numbers[0]:10.0f}  {numbers[1]:10.0f}  {numbers[2]:10.1f}", flush=True)


if __name__ == "__main__":
    main()
