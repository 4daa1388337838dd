# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of Table 1 of Carrillo et al. (tests/oracles/carrillo_table1.csv) as cases: what the sweep of the grains
(cases/faradayMD/table1.py) and that of the gas (faradayDiagram.py) share. Lengths in grain diameters."""
import csv
import math
import os
import shutil
import subprocess

import haff
from haff.case import entries
from haff.paths import TOP, program

PAPER = os.path.join(TOP, "tests", "oracles", "carrillo_table1.csv")
GRAVITY = 981.0  # sigma/s^2
RESULTS = ("[1-9]*", "0", "0.[0-9]*", "*.msh", "polyMesh", "postProcessing", "VTK", "*.png", "log.*", "*.py", "*.csv", "__pycache__")


def paper():
    """{number from 1: row}."""
    with open(PAPER) as f:
        return {k: {key: float(v) for key, v in row.items()} for k, row in enumerate(csv.DictReader(f), 1)}


def numbers(text):
    """"1,5-9" as a list."""
    ends = [[int(w) for w in part.split("-")] for part in text.split(",")]
    return [k for e in ends for k in range(e[0], e[-1] + 1)]


def acceleration(amplitude, frequency):
    return amplitude * (2 * math.pi * frequency) ** 2 / GRAVITY


def throw(acceleration, frequency):
    """How high the plate's greatest speed carries."""
    speed = acceleration * GRAVITY / (2 * math.pi * frequency)
    return speed**2 / (2 * GRAVITY)


def edit(path, **values):
    """The first entry of each key, which must be there, gets a new value."""
    entries.edit(path, values, anywhere=True)


def call(case, name, *arguments, log="a"):
    with open(os.path.join(case, f"log.{name}"), log) as f:
        done = subprocess.run([name if name == "gmsh" else program(name), *arguments], stdout=f,
                              stderr=subprocess.STDOUT)
    if done.returncode:
        raise RuntimeError(f"{name} failed, see {f.name}")


def copy(template, case):
    """The template's files, without results and without the folder that `case` lies in, if that is in the template."""
    results, inside = shutil.ignore_patterns(*RESULTS), os.path.relpath(case, template).split(os.sep)[0]
    shutil.copytree(template, case, ignore=lambda folder, names: {*results(folder, names), *({inside} & set(names))})


def mesh(case, length, height):
    at = lambda name: os.path.join(case, name)
    size = ["-setnumber", "L", str(int(length)), "-setnumber", "H", str(int(height))]
    call(case, "gmsh", "-3", "-v", "2", *size, at("mesh.geo"), "-o", at("mesh.msh"))
    call(case, "gmshToCase", at("mesh.msh"), "-case", case)


def has_mesh(case):
    return os.path.exists(os.path.join(case, "constant", "polyMesh", "boundary"))


def clear(case):
    """Removes the times but the start."""
    for name in os.listdir(case):
        if haff.is_time(name) and float(name) > 0:
            shutil.rmtree(os.path.join(case, name))
