"""Runs variants of a shipped case and keeps what came out: how the numbers of the reports were made.

    haff variant FOLDER CASE [cells=N] [DICTIONARY_KEY=VALUE ...]

copies the case to FOLDER/CASE-..., sets the first entry of each key in its dictionaries (VTK output is dropped), makes
the mesh, runs granularGas of build/bin on one rank and appends a line of JSON to FOLDER/runs.json: case, settings, exit
code, CPU seconds, steps, limited faces and cells and rejected steps as last printed, last line of the log.
"""
import json
import os
import re
import resource
import shutil
import subprocess
import sys

from haff import command
from haff.case import entries
from haff.paths import TOP, program

FILES = ("controlDict", "fvSchemes", "fvSolution"), ("granularProperties", "g", "shaking")


def dictionaries(case):
    paths = [os.path.join(case, "system", name) for name in FILES[0]] + [os.path.join(case, "constant", name) for name in FILES[1]]
    return [path for path in paths if os.path.exists(path)]


def edit(case, settings):
    """Sets each key where it first stands; drops VTK files. A key that stands nowhere is an error."""
    for key, value in settings.items():
        for path in dictionaries(case):
            try:
                entries.edit(path, {key: value}, anywhere=True)
                break
            except entries.EntryError:
                continue
        else:
            sys.exit(f"no dictionary of {case} has an entry {key}")
    entries.drop(os.path.join(case, "system", "controlDict"), "vtk")


def make(folder, name, settings):
    """The copy with its mesh; its path."""
    label = "-".join([name] + [f"{k}={v}" for k, v in settings.items()]).replace("/", "_").replace(" ", "_")
    case = os.path.join(folder, label)
    shutil.rmtree(case, ignore_errors=True)
    shutil.copytree(os.path.join(TOP, "cases", name), case, ignore=shutil.ignore_patterns(
        "[1-9]*", "0", "0.[0-9]*", "*.msh", "polyMesh", "postProcessing", "VTK", "e0.*", "*.png", "log.*"))
    edit(case, {k: v for k, v in settings.items() if k != "cells"})
    mesh = os.path.join(case, "mesh.msh")
    size = ["-setnumber", "N", settings["cells"]] if "cells" in settings else []
    subprocess.run(["gmsh", "-3", "-v", "2", *size, os.path.join(case, "mesh.geo"), "-o", mesh], check=True)
    subprocess.run([program("gmshToCase"), mesh, "-case", case], check=True, stdout=subprocess.DEVNULL)
    os.remove(mesh)
    return case


def run(case, limit=1200):
    """granularGas with its output in log.granularGas; a dictionary of what the log says."""
    log = os.path.join(case, "log.granularGas")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    with open(log, "w") as f:
        try:
            code = subprocess.run([program("granularGas"), "-case", case], stdout=f, stderr=subprocess.STDOUT, timeout=limit).returncode
        except subprocess.TimeoutExpired:
            code = "stopped by hand"
    cpu = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with open(log) as f:
        text = f.read()
    steps = re.findall(r"^Time = (\S+)  step (\d+)", text, re.M)
    limited = re.findall(r"^ +limited: .*\(in all (\d+), (\d+)\)", text, re.M) or [(0, 0)]
    rejected = re.findall(r"^ +rejected: .*\(in all (\d+)\)", text, re.M) or [0]
    return {"code": code, "cpu": round(cpu, 2), "t": float(steps[-1][0]) if steps else 0, "steps": int(steps[-1][1]) if steps else 0,
            "limited": [int(n) for n in limited[-1]], "rejected": int(rejected[-1]), "last": text.strip().splitlines()[-1]}


def main():
    parser = command.parser(__doc__)
    parser.add_argument("folder")
    parser.add_argument("case", help="a case of cases/")
    parser.add_argument("settings", nargs="*", metavar="KEY=VALUE")
    o = parser.parse_args()
    wanted = dict(word.split("=", 1) for word in o.settings)
    made = make(o.folder, o.case, wanted)
    entry = {"case": o.case, "settings": wanted, "folder": os.path.basename(made), **run(made)}
    with open(os.path.join(o.folder, "runs.json"), "a") as f:
        f.write(json.dumps(entry) + "\n")
    print(json.dumps(entry))


if __name__ == "__main__":
    main()
