#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run waits for a slow disk: CPU and wall time of a case whose every fsync takes some ms, in turn with other programs.

    tests/bench/slowDisk.py [-case cases/wedge] [-ms 20] [-rounds 3] [-bin FOLDER ...]

The disk is tests/faults/disk.c, preloaded, on the folder of temporary files. FOLDER has programs, ours if none is given. Prints
medians. From the wall time is taken what the run's first thread waited for a processor, which other programs had (schedstat of
Linux): what stays is computing and waiting for the disk."""
import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OURS = os.environ.get("HAFF_BIN", os.path.join(ROOT, "build", "bin"))


def mesh(case):
    message = os.path.join(case, "mesh.msh")
    subprocess.run(["gmsh", "-3", "-v", "1", os.path.join(case, "mesh.geo"), "-o", message], check=True)
    subprocess.run([os.path.join(OURS, "gmshToCase"), message, "-case", case], check=True, capture_output=True)
    os.remove(message)


def run(programs, case, ms):
    """CPU and wall time of a run, s, and how many times it has written."""
    with tempfile.TemporaryDirectory() as folder:
        copy = shutil.copytree(case, os.path.join(folder, "case"))
        slow = {"LD_PRELOAD": os.path.join(OURS, "faultydisk.so"), "HAFF_FAULT": f"slow:{ms}", "HAFF_FAULT_FOLDER": copy}
        begin = time.monotonic()
        going = subprocess.Popen([os.path.join(programs, "granularGas"), "-case", copy], stdout=subprocess.PIPE, env={**os.environ, **slow})
        text = going.stdout.read().decode()
        os.waitid(os.P_PID, going.pid, os.WEXITED | os.WNOWAIT)
        wall = time.monotonic() - begin
        with open(f"/proc/{going.pid}/schedstat") as file:
            queued = 1e-9 * int(file.read().split()[1])
        _, code, used = os.wait4(going.pid, 0)
        if code:
            sys.exit(f"{programs}: the run failed\n{text}")
        return used.ru_utime + used.ru_stime, wall - queued, text.count("    written: ")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-case", default=os.path.join(ROOT, "cases", "wedge"))
    parser.add_argument("-ms", type=int, default=20)
    parser.add_argument("-rounds", type=int, default=3)
    parser.add_argument("-bin", nargs="+", default=[OURS])
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        case = shutil.copytree(given.case, os.path.join(folder, "case"))
        mesh(case)
        rows = {(programs, ms): [] for programs in given.bin for ms in (0, given.ms)}
        for _ in range(given.rounds):
            for (programs, ms), found in rows.items():
                found.append(run(programs, case, ms))
        for (programs, ms), found in rows.items():
            cpu, wall, times = (statistics.median(column) for column in zip(*found))
            print(f"{programs}: fsync {ms:3d} ms: CPU {cpu:.2f} s, wall {wall:.2f} s ({wall / cpu:.2f} of it), {times:.0f} times written")


if __name__ == "__main__":
    main()
