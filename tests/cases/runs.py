# SPDX-License-Identifier: GPL-3.0-or-later
"""Small cases that make every kind of wave, and comparison of what runs of them have written, byte by byte."""
import os
import re
import shutil

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes

FIELDS = ("rho", "alpha", "U", "T", "p", "rhoU", "rhoE")
TABLES = """functions
{{
    points  {{ type probes; fields (alpha U); probeLocations (({0}) ({1})); }}
    extreme {{ type fieldMinMax; fields (T U); }}
    mass    {{ type volFieldValue; fields (rho U); operation volIntegrate; }}
    mean    {{ type volFieldValue; fields (p); operation volAverage; writeControl timeStep; writeInterval 3; }}
    line    {{ type sets; fields (rho U); writeControl writeTime;
               sets {{ a {{ type uniform; axis distance; start ({0}); end ({1}); nPoints 31; }} }} }}
    pictures {{ type vtk; fields (alpha U); writeControl writeTime; }}
}}
"""


SPHERES = {"eos": "TorquatoSpheres", "e": 0.9, "cooling": "GarzoDufty"}


def conduct(case):
    """Gives a case of SPHERES viscosity and conduction, with all terms."""
    harness.edit(case, "constant/granularProperties", transport="GarzoDufty; GarzoDuftyCoeffs { zetaU full; }")


def make(path, n, end, hole=False, tables=False, types=None, viscous=False, **options):
    """A hot bubble in a cooling gas that falls on slip walls; n: cells, 0.1 wide. hole: a step in the low corner. viscous:
    spheres with transport between walls that hold them."""
    options = {**(SPHERES if viscous else {}), **options}
    n, size = np.array(n), np.where(np.array(n) > 1, 0.1 * np.array(n), 0.1)
    at = boxes.centres(n, size)
    away = sum(((at[:, k] - 0.6 * size[k]) / size[k]) ** 2 for k in range(3) if n[k] > 1)
    rho, p = 100 + 20 * np.cos(3 * at[:, 0]), np.where(away < 0.04, 20000.0, 2000.0)
    u = np.stack([2 * np.sin(at[:, 0] + at[:, 1]) if n[0] > 1 else 0 * rho, 0 * rho, 0 * rho], axis=1)
    gravity = [(-3.0, -20.0, -5.0)[k] if n[k] > 1 else 0.0 for k in range(3)]
    harness.box_case(path, n, size, rho, u, p, end, types=types, **{"gravity": tuple(gravity), "e": 0.9, "cooling": "Haff", **options})
    if hole:
        gone = np.all([(at[:, k] < 0.4 * size[k]) | (n[k] == 1) for k in range(3)], axis=0)
        boxes.write_mesh(path, n, size, types, hole=gone)
        at, rho, p, u = (values[~gone] for values in (at, rho, p, u))
    rules = "\n".join(f"{a}Empty empty" for a, k in zip("xyz", n) if k == 1)
    rules += "".join(f"\n{name} cyclic" for name in (a + s for a in types or "" for s in ("Low", "High")))
    for name, values in (("rho", rho), ("p", p), ("U", u)):
        wall = "zeroGradient" if name != "U" else "noSlip" if viscous else "slip"
        boxes.write_field(path, name, values, f'".*" {wall}\n{rules.strip()}'.strip())
    add(path, "system/fvSchemes", "divSchemes { } gradSchemes { } laplacianSchemes { }\n")
    if viscous:
        conduct(path)
    if tables:
        ends = [" ".join("%.3f" % v for v in at[i] + 1e-3) for i in (0, -1)]
        add(path, "system/controlDict", TABLES.format(*ends))
    return path


SQUARE = """DefineConstant[ N = 16 ]; h = 1/N; Point(1) = {0, 0, 0, h}; Point(2) = {1, 0, 0, h}; Point(3) = {1, 1, 0, h}; Point(4) = {0, 1, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Physical Curve("around") = {1:4}; Physical Surface("gas") = {1};
"""
CUBE = """DefineConstant[ N = 16 ]; SetFactory("OpenCASCADE"); Box(1) = {0, 0, 0, 1, 1, 1}; Mesh.MeshSizeMax = 1/N; Mesh.MeshSizeMin = 1/N;
Physical Surface("around") = {1:6}; Physical Volume("gas") = {1};
"""


def unit_box(path, mesh, dim, cells, fields):
    """A case of perfect gas, to be looked at as it begins, in a unit square or cube; fields: centres -> {rho, p, U}; mesh: lattice,
    polyhedral (the same cells) or simplices (triangles, tetrahedra)."""
    n, size = (cells, cells, cells if dim == 3 else 1), (1.0, 1.0, 1.0 if dim == 3 else 0.1)
    first = fields(boxes.centres(n, size))
    harness.box_case(path, n, size, first["rho"], first["U"], first["p"], 1e-9, e=1.0, cooling="none", eos="perfectGas")
    if mesh == "simplices":
        with open(path + "/mesh.geo", "w") as f:
            f.write(SQUARE if dim == 2 else CUBE)
        shutil.rmtree(path + "/constant/polyMesh")
        harness.mesh(path, cells)
        rules = '"(front|back)" empty\naround zeroGradient' if dim == 2 else "around zeroGradient"
        for name, values in fields(harness.haff.Case(path).centres).items():
            boxes.write_field(path, name, values, rules)
    add(path, "system/fvSchemes", f"meshEngine {'lattice' if mesh == 'lattice' else 'polyhedral'};\n")
    return path


def add(case, file, text):
    with open(os.path.join(case, file), "a") as f:
        f.write(text)


def times(case):
    """Names of the time folders, ascending."""
    return sorted((n for n in os.listdir(case) if re.fullmatch(r"[-+.\de]+", n) and n[0].isdigit()), key=float)


def contents(folder, ignore=("provenance", "run.dat")):
    """Every file in a folder: relative path -> bytes. Provenance holds date and ranks, run.dat seconds of clocks, which also
    choose its rows."""
    found = {}
    for base, _, names in os.walk(folder):
        for name in names:
            if name not in ignore:
                with open(os.path.join(base, name), "rb") as f:
                    found[os.path.relpath(os.path.join(base, name), folder)] = f.read()
    return found


def results(case):
    """All that a run writes: times after 0, postProcessing, VTK."""
    folders = [t for t in times(case) if float(t)] + [n for n in ("postProcessing", "VTK") if os.path.isdir(os.path.join(case, n))]
    return {os.path.join(n, k): v for n in folders for k, v in contents(os.path.join(case, n)).items()}


def same(test, one, other, message=""):
    """Fails with the names of the files that differ."""
    test.assertTrue(one)
    differ = sorted(k for k in one.keys() | other.keys() if one.get(k) != other.get(k))
    test.assertEqual(differ, [], message)


def until(case, target, time):
    """A copy of the case as a stop at that written time leaves it."""
    shutil.copytree(case, target, ignore=shutil.ignore_patterns("postProcessing", "VTK"))
    for name in times(target):
        if float(name) > float(time):
            shutil.rmtree(os.path.join(target, name))
    return target


def complete(test, case, name):
    """The time folder can be read in full: sizes, stamp, finite values; no temporary file in it."""
    folder = os.path.join(case, name)
    result = harness.haff.Case(case)
    for field in FIELDS:
        values = result.field(field, name)
        test.assertEqual(len(values), result.mesh.cells, f"{folder}/{field}")
        test.assertTrue(np.isfinite(values).all(), f"{folder}/{field}")
    with open(os.path.join(folder, "uniform", "time")) as f:
        test.assertRegex(f.read(), r"writePrecision +\d+;\s*$")
    test.assertEqual([k for k in contents(folder) if k.endswith(".tmp")], [])


def hidden(case):
    return [n for n in os.listdir(case) if n.startswith(".")]
