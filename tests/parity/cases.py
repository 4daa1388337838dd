#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows that two builds compute the same bits: runs a short form of every shipped case, and some problems that no shipped case
holds, with the programs of two folders, and compares all that they write and say.

    tests/parity/cases.py BIN_A BIN_B [CASE...]             two folders of programs, say build/bin of two clones
    tests/parity/cases.py BIN_A -save FILE [CASE...]        keeps the checksums of one
    tests/parity/cases.py BIN_B -against FILE [CASE...]     compares with them later; the old programs are not needed
    tests/parity/cases.py -list                             names of the cases

Compared are the files of constant/polyMesh (by gmshToCase), of the times, of postProcessing and VTK, byte by byte and after
decompression; the exit codes and texts of gmshToCase, checkCase, the solver and caseToVTK and the files of caseToVTK; and what
-help, -listModels and -listBCs of each program say (the case "listings"). Left out are version, compiler, host, date, wall-clock
times (and run.dat, whose rows follow them), the estimate of memory, the share of cells
that was computed, and where the folders are. The input files are compared, too: checksums that were saved with other
input files say so. One line is printed for each case: `same`, or what differs first. Exit code 0: all the same; 1: something
differs; 2: the command line is wrong.
"""
import argparse
import collections
import gzip
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import types
import zlib

sys.path.insert(0, os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
os.environ["HAFF_SOURCE"] = sys.path[0]
for key, value in {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
                   "OMPI_MCA_hwloc_base_binding_policy": "none", "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_NUM_THREADS": "1",
                   "LC_ALL": "C"}.items():
    os.environ.setdefault(key, value)

from tests.cases import harness, runs  # noqa: E402
from tests.cases.gas import test_limiter  # noqa: E402
from tests.cases.transport import test_carried  # noqa: E402

CONTROL, SCHEMES, SOLUTION, GAS = "system/controlDict", "system/fvSchemes", "system/fvSolution", "constant/granularProperties"
BLOCK = 1024  # bytes of a file that is not text, whose checksum is saved
PROGRAMS = {"granularGas": ("-help", "-listModels", "-listBCs"), "granularMD": ("-help", "-listModels", "-listBCs"), "granularDEM": ("-help", "-listModels", "-listBCs"),
            "granularSegregation": ("-help", "-listModels", "-listBCs"), "gmshToCase": ("-help",), "checkCase": ("-help",),
            "caseToVTK": ("-help",)}

# Short forms. source: a shipped case, or a function that makes the case in a folder; mesh: options of its mesh.geo; control:
# entries of controlDict; replace: (file, pattern, text) with every match replaced, at least one; append: (file, text); ranks: of
# the solver; stop: a time at which the run is stopped first; prepare: a function of the copied case, called before its mesh;
# code: the exit code that the solver must have.
Row = collections.namedtuple("Row", "source mesh control replace append ranks stop prepare code", defaults=({}, {}, (), (), 1, None, None, 0))


def ended(end, interval=None, **control):
    return {"endTime": end, "writeInterval": interval or end / 2, **control}


def gas_of_wedge(case):
    """The gas that carries the mixture of segregationWedge, as its Allrun makes it."""
    gas = shutil.copytree(os.path.join(harness.SOURCE, "cases", "wedge"), os.path.join(case, "gas"))
    harness.edit(gas, CONTROL, writeInterval=0.0425)
    harness.drop_vtk(gas)
    mesh(gas, {"N": 20})
    harness.program("granularGas", "-case", gas)


SHIPPED = {
    "blast": Row("blast", {"N": 200}, ended(5.48)),
    "blastCold": Row("blastCold", {"N": 48}, ended(100)),
    "blastDense": Row("blastDense", {"N": 200}, ended(3)),
    "blastElastic": Row("blastElastic", {"N": 200}, ended(5.48)),
    "blastRound": Row("blastRound", {"N": 60}, ended(0.1)),
    "brazilNut": Row("brazilNut", {"W": 12}, ended(8), [("constant/particleProperties", r"N +300;", "N 100;")]),
    "bouncingBed": Row("bouncingBed", {"N": 50}, ended(0.1)),
    "bouncingBedMD": Row("bouncingBedMD", {"N": 20, "W": 0.01}, ended(0.1), [("constant/particleProperties", "3424", "856")]),
    "bouncingBedDEM": Row("bouncingBedDEM", {"N": 20, "W": 0.02}, ended(0.004), [("constant/particleProperties", "8560", "300")]),
    "chuteDEM": Row("chuteDEM", {}, ended(0.004), [("constant/particleProperties", r"N +0;", "N 200;")]),
    "columnDEM": Row("columnDEM", {}, ended(0.004), [("constant/particleProperties", r"N +0;", "N 200;")]),
    "chute": Row("chute", {"N": 18}, ended(0.1)),
    "drum": Row("drum", {"N": 6}, ended(0.05)),
    "columnCollapse": Row("columnCollapse", {"N": 12}, ended(0.03)),
    "columnRound": Row("columnRound", {"N": 12}, ended(0.03)),
    "cooling3D": Row("cooling3D", {"N": 16}, ended(40)),
    "cooling3DMD": Row("cooling3DMD", {"L": 24, "N": 6}, ended(40, deltaT=20)),
    "coolingDisks": Row("coolingDisks", {"N": 48}, ended(40)),
    "coolingDisksMD": Row("coolingDisksMD", {"N": 12}, ended(20, deltaT=10)),
    "cone": Row("cone", {"N": 10}, ended(0.2)),
    "coolingMixture": Row("coolingMixture", {"L": 40, "N": 4}, ended(8, deltaT=4)),
    "coolingGas": Row("coolingGas", {"L": 60, "N": 6}, ended(80)),
    "couetteDisks": Row("couetteDisks", {"N": 24}, ended(20)),
    "couetteSpheres": Row("couetteSpheres", {"N": 12}, ended(60)),
    "cylinderDisks": Row("cylinderDisks", {"N": 6}, ended(100)),
    "cylinder": Row("cylinder", {"N": 8}, ended(0.4)),
    "demon": Row("demon", {}, ended(4)),
    "demonMD": Row("demonMD", {}, ended(40)),
    "equationOfState": Row("equationOfState", {"L": 30}, ended(8)),
    "faraday": Row("faraday", {"L": 60}, ended(0.3)),
    "faradayMD": Row("faradayMD", {"L": 40}, ended(0.3), [("constant/particleProperties", "1879", "250")]),
    "faradaySweep": Row("faradaySweep", {"L": 48, "W": 2}, ended(0.3)),
    "forwardStep": Row("forwardStep", {"N": 30}, ended(1)),
    "heap2D": Row("heap2D", {"N": 32}, ended(0.02)),
    "heapPoured": Row("heapPoured", {}, ended(0.03)),
    "jetOnPile": Row("jetOnPile", {}, ended(0.008)),
    "tiltedBox": Row("tiltedBox", {}, ended(0.03)),
    "heatedColumn": Row("heatedColumn", {"N": 40}, ended(10)),
    "heatedWalls": Row("heatedWalls", {"N": 20}, ended(60)),
    "hopper": Row("hopper", {"N": 24}, ended(0.02)),
    "inclineSpheres": Row("inclineSpheres", {"N": 20}, ended(3)),
    "jetOnPlate": Row("jetOnPlate", {}, ended(20)),
    "jet": Row("jet", {"N": 6}, ended(5e-5)),
    "kink": Row("kink", {"M": 101}, ended(2, deltaT=0.01)),
    "leidenfrost": Row("leidenfrost", {}, ended(4)),
    "pile": Row("pile", {"N": 10}, ended(0.1)),
    "piston": Row("piston", {"N": 100}, ended(40)),
    "poiseuilleDisks": Row("poiseuilleDisks", {"N": 20}, ended(20)),
    "pipe": Row("pipe", {"N": 12}, ended(10)),
    "pulsedInlet": Row("pulsedInlet", {"N": 160}, ended(2), stop=1),
    "riemann2D": Row("riemann2D", {"N": 80}, ended(0.3)),
    "sedimentation": Row("sedimentation", {"N": 50}, ended(0.05)),
    "sedimentationMD": Row("sedimentationMD", {"N": 20, "W": 0.01}, ended(0.04), [("constant/particleProperties", r"N +0;", "N 1500;")]),
    "shockLayer": Row("shockLayer", {"N": 60}, ended(4)),
    "shearDEM": Row("shearDEM", {}, ended(0.004), [("constant/particleProperties", r"N +0;", "N 200;")]),
    "siloDEM": Row("siloDEM", {}, ended(0.004), [("constant/particleProperties", r"N +0;", "N 200;")]),
    "segregationChute": Row("segregationChute", {"N": 40}, ended(1)),
    "segregationExponential": Row("segregationExponential", {}, ended(100)),
    "segregationLinear": Row("segregationLinear", {}, ended(0.4)),
    "segregationWedge": Row("segregationWedge", {"N": 20}, ended(0.05), prepare=gas_of_wedge),
    "settlingColumn": Row("settlingColumn", {"N": 40}, ended(0.1)),
    "shearMD": Row("shearMD", {"L": 20, "N": 8}, ended(10), [("0.orig/U", "y - 20", "y - 10")]),
    "silo": Row("silo", {}, ended(0.01)),
    "siloRound": Row("siloRound", {}, ended(0.01)),
    "sod": Row("sod", {"N": 200}, ended(0.2)),
    "sphere3D": Row("sphere3D", {"N": 8}, ended(0.2)),
    "vibratedLayer": Row("vibratedLayer", {"N": 300}, ended(0.002)),
    "vortices": Row("vortices", {"N": 16}, ended(200)),
    "vortex": Row("vortex", {"N": 48}, ended(2.5)),
    "wall": Row("wall", {"N": 125}, ended(0.2)),
    "wallThrough": Row("wallThrough", {"N": 100}, ended(0.5)),
    "wedge": Row("wedge", {"N": 60}, ended(0.0425)),
    "wedge15": Row("wedge15", {"N": 12}, ended(0.2)),
    "wedge15Dilute": Row("wedge15Dilute", {"N": 12}, ended(0.2)),
    "wedgeDense": Row("wedgeDense", {"N": 60}, ended(0.0412)),
    "wedgeDisks": Row("wedgeDisks", {"N": 15}, ended(20)),
    "wedgeMD": Row("wedgeMD", {"N": 32}, ended(0.0425)),
    "wedgeElastic": Row("wedgeElastic", {"N": 60}, ended(0.1)),
    "wedgeTriangles": Row("wedgeTriangles", {"N": 30}, ended(0.0425)),
}


def box(n=(40, 30, 1), end=0.03, **options):
    """A hot bubble that falls between slip walls (tests/cases/runs.py)."""
    return lambda path: runs.make(path, n, end, **{"interval": end / 2, **options})


def shot(engine, end):
    """Dense lumps at a high Mach number through a near vacuum, as tests/cases/gas/test_limiter.py starts them."""
    return lambda path: test_limiter.Limiter.shot(types.SimpleNamespace(folder=os.path.dirname(path)), os.path.basename(path), engine, end)


def carrying(engine):
    """A bubble with a dye and a mixture (tests/cases/transport/test_carried.py)."""
    return lambda path: test_carried.make(path, (30, 16, 1), 0.01, engine, interval=0.005)


def open_box(path):
    """A stream that enters and leaves through fixedValue and inletOutlet."""
    runs.make(path, (40, 30, 1), 0.04, interval=0.02)
    sides = '\nxHigh inletOutlet; inletValue uniform %s\n"y.*" slip\nzEmpty empty'
    for name, value in (("rho", "90"), ("p", "2500"), ("U", "(-1 2 0)")):
        with open(os.path.join(path, "0", name)) as f:
            text = f.read()
        rules = ("xLow fixedValue; value uniform " + (value if name != "U" else "(9 1 0)") + sides % value)
        rules = rules if name == "U" else rules.replace("slip", "zeroGradient")
        lines = "\n".join("    %s { type %s; }" % tuple(line.split(None, 1)) for line in rules.splitlines())
        with open(os.path.join(path, "0", name), "w") as f:
            f.write(re.sub(r"boundaryField\n\{.*", f"boundaryField\n{{\n{lines}\n}}\n", text, flags=re.S))


TRIANGLES = ("mesh.geo", r"Transfinite Surface \{1\};\nRecombine Surface \{1\};\n", "")
MOVING = (("0.orig/T", r"floor .*", "floor { type granularWall; restitution 0.8; }"), ("0.orig/U", r"floor .*", "floor { type noSlip; }"),
          (CONTROL, r"functions\n\{\n", "functions\n{\n    budget { type energyBudget; }\n    mean { type phaseAverage; fields (rho alpha U T p);"
           " period 1; phases 4; }\n    extremes { type fieldMinMax; fields (c Ma T); }\n"))
BUDGET = (CONTROL, "functions\n{\n    budget { type energyBudget; }\n}\n")


def flow(scheme=None, diffusion=None, **more):
    """Disks between a granular wall at rest and a moving one of given T; scheme: on triangles; with a budget and phase means."""
    append = [(SOLUTION, f"diffusion {{ type {diffusion}; }}\n")] if diffusion else []
    append += [(SCHEMES, f"polyReconstruct {scheme};\n")] if scheme else []
    return Row("couetteDisks", {"N": 12}, ended(3), MOVING + ((TRIANGLES,) if scheme else ()), append, **more)


EXTRA = {
    "disks": flow(),
    "disksTwoRanks": flow(ranks=2),
    "disksRestarted": flow(stop=1.5),
    "disksExplicit": flow(diffusion="explicit"),
    "disksRKL2": flow(diffusion="RKL2"),
    "disksImplicit": flow(diffusion="implicit"),
    "disksLinear": flow("linear"),
    "disksCWENO3": flow("CWENO3"),
    "disksCWENO3Restarted": flow("CWENO3", ranks=2, stop=1.5),
    "disksCWENO3Implicit": flow("CWENO3", "implicit"),
    "heatedWallsDissipative": Row("heatedWalls", {"N": 20}, ended(30), [("0.orig/T", r"right .*", "right { type granularWall; restitution 0.8; }")],
                                  [(SCHEMES, "meshEngine polyhedral;\n")]),
    "faradayBudget": Row("faraday", {"L": 16}, ended(0.15), [(CONTROL, r"functions\n\{\n", "functions\n{\n    budget { type energyBudget; }\n")],
                         ranks=2, stop=0.075),
    **{f"faradayWalls{e.capitalize()}": Row("faraday", {"L": 16}, ended(0.1), [
        ("0.orig/T", r'"\(floor\|lid\)".*', "floor { type granularWall; restitution 0.7; } lid { type zeroGradient; }"),
        ("0.orig/U", r'"\(floor\|lid\)".*', "floor { type noSlip; } lid { type slip; }"),
        (CONTROL, r"functions\n\{\n", "functions\n{\n    budget { type energyBudget; }\n")],
        [(SCHEMES, f"meshEngine {e};\n")]) for e in ("lattice", "polyhedral")},
    "cylinderPerfect": Row("cylinder", {"N": 6}, ended(0.2), [
        (GAS, r"equationOfState .*", "equationOfState perfectGas;"), (GAS, r"GoldshteinShapiroCoeffs .*", "perfectGasCoeffs { gamma 1.4; }"),
        (GAS, r"cooling .*", "cooling none;"), (SCHEMES, r"polyReconstruct .*", "polyReconstruct linear;")]),
    "grainsRestarted": Row("faradayMD", {"L": 20}, ended(0.3), [
        ("constant/particleProperties", "1879", "125"),
        (CONTROL, r"functions\n\{\n", "functions\n{\n    mean { type phaseAverage; fields (rho U T); phases 4; }\n    vtk { type vtk; }\n")],
        stop=0.15),
    "equationOfStateSpheres": Row("equationOfState", {"D": 3, "L": 12}, ended(8), [
        (f"0.orig/{name}", "type empty", "type cyclic") for name in ("alpha", "T", "U")] + [
        ("system/meshDict", r"\n\}\n$", "\n    back { type cyclic; neighbourPatch front; }\n    front { type cyclic; neighbourPatch back; }\n}\n")]),
    "segregationChuteRestarted": Row("segregationChute", {"N": 20}, ended(1), stop=0.5),
    "segregationWedgeTwoRanks": Row("segregationWedge", {"N": 20}, ended(0.05), ranks=2, prepare=gas_of_wedge),
    "collapse": Row("blastDense", {"N": 250}, ended(4), [(GAS, r"restitution [^;]*;", "restitution 0;")], code=2),
    "spheres3D": Row(box((12, 10, 8), 0.02, stepper="SSPRK104", flux="Marquina", eos="TorquatoSpheres", tables=True)),
    "spheres3DPolyhedral": Row(box((12, 10, 8), 0.01, stepper="SSPRK104", flux="Marquina"), append=[(SCHEMES, "meshEngine polyhedral;\n")]),
    "hole": Row(box(hole=True, tables=True, format="ascii", compression="on", digits=6, courant=1.0), stop=0.015),
    "holeTwoRanks": Row(box((40, 30, 1), hole=True, tables=True), append=[(CONTROL, "writeProcessors yes;\n")], ranks=2),
    "openBox": Row(open_box, append=[BUDGET]),
    "openBoxPolyhedral": Row(open_box, append=[BUDGET, (SCHEMES, "meshEngine polyhedral; polyReconstruct linear;\n")]),
    **{f"limiter{e.capitalize()}": Row(shot(e, 0.006), append=[BUDGET]) for e in ("lattice", "polyhedral")},
    **{f"floor{e.capitalize()}": Row(shot(e, 0.004), append=[BUDGET, (SOLUTION, "limits { alphaFloor 5e-9; }\n")]) for e in ("lattice", "polyhedral")},
    **{f"flux{f[0].upper()}{f[1:]}": Row(box(flux=f, reconstruct="firstOrder" if f == "Rusanov" else "WPENO5"))
       for f in ("common", "Marquina", "MarquinaStable", "LaxFriedrichs", "globalLaxFriedrichs", "Rusanov")},
    **{f"reconstruct{r}": Row(box(reconstruct=r)) for r in ("PHM", "WPENO5", "WENO5", "WENOZ", "TENO5", "firstOrder")},
    **{f"time{t}": Row(box(stepper=t)) for t in ("SSPRK3", "SSPRK43", "SSPRK104", "SSPRK2", "Euler")},
    "timeLocal": Row(box(end=0.01, stepper="local", courant=1.0, gravity=(0.0, 0.0, 0.0)), append=[BUDGET, (SCHEMES, "meshEngine polyhedral; polyReconstruct linear;\n")],
                     ranks=2, stop=0.005),
    **{f"carried{e.capitalize()}": Row(carrying(e), ranks=2, stop=0.005) for e in ("lattice", "polyhedral")},
    **{f"flux{f}Polyhedral": Row(box(flux=f, end=0.01), append=[(SCHEMES, "meshEngine polyhedral;\n")])
       for f in ("Marquina", "MarquinaStable", "LaxFriedrichs", "Rusanov")},
}
ROWS = {**SHIPPED, **EXTRA}

# Each makes one entry of a case of disks wrong, so that checkCase says something.
WRONG = ((GAS, r"restitution [^;]*;", "restitution 2;"), (GAS, r"cooling .*", "cooling Half;"), (GAS, r"transport .*", "transport Garzo;"),
         (GAS, r"equationOfState .*", "equationOfState TorquatoSpheres;"), (GAS, r"diameter [^;]*;", ""), (SCHEMES, "WPENO5", "WENO7"),
         (SCHEMES, "common", "Roe"), (SCHEMES, "SSPRK3", "RK4"), (SOLUTION, "minDeltaTFraction 1e-3", "minDeltaTFraction 2"),
         (SOLUTION, "limits", "diffusion { type RKL3; } limits"), (SCHEMES, "reconstruct", "meshEngine tiles; reconstruct"),
         ("0.orig/T", r"floor .*", "floor { type granularWall; restitution 1.2; }"), ("0.orig/T", r"floor .*", "floor { type granularWal; }"),
         ("0.orig/T", r"floor .*", "floor { type granularWall; }"), ("0.orig/T", r"floor .*", "floor { type slip; value uniform; }"),
         ("0.orig/U", r"floor .*", "floor { type translatingWallVelocity; U (-2 1 0); }"), ("0.orig/U", r"floor .*", "floor { type noslip; }"),
         ("0.orig/U", r"floor .*", "floor { type translatingWallVelocity; }"), ("0.orig/U", r"lid .*", ""),
         (CONTROL, "functions\n{", "functions\n{ a { type energyBugdet; }"),
         (CONTROL, "functions\n{", "functions\n{ a { type phaseAverage; fields (rho); }"),
         (CONTROL, "functions\n{", "functions\n{ a { type probes; fields (rho); }"), (CONTROL, "maxCo .*", "maxCo -1;"),
         (CONTROL, "maxCo .*", "maxCo 5;"), (CONTROL, "granularGas", "granularGass"), (CONTROL, "granularGas", "granularMD"))


def replace(case, file, pattern, text):
    path = os.path.join(case, file)
    with open(path) as f:
        changed, count = re.subn(pattern, text, f.read())
    if not count:
        raise KeyError(f"{path} has no {pattern}")
    with open(path, "w") as f:
        f.write(changed)


meshes = {}  # what gmsh has made of a mesh.geo with these options: both builds get the same


def mesh(case, options):
    """mesh.geo through gmsh and gmshToCase; returns what gmshToCase says."""
    with open(os.path.join(case, "mesh.geo")) as f:
        key = f.read() + str(options)
    msh = os.path.join(case, "mesh.msh")
    if key not in meshes:
        numbers = [word for k, v in options.items() for word in ("-setnumber", k, str(v))]
        subprocess.run(["gmsh", "-3", "-v", "2", *numbers, os.path.join(case, "mesh.geo"), "-o", msh], check=True, capture_output=True)
        with open(msh, "rb") as f:
            meshes[key] = f.read()
    with open(msh, "wb") as f:
        f.write(meshes[key])
    return said("gmshToCase", msh, "-case", case)


def said(name, *arguments, **options):
    done = harness.program(name, *arguments, check=False, **options)
    return f"{done.stdout}{done.stderr}exit code {done.returncode}\n"


DROPPED = re.compile(r"""^haff\ [\d.]+\ \(.*\)\n | ^\ +compiler\ \ .*\n | ^\ +wall\ .*\n | ^\ +memory\ about\ .*\n
                     | ^Seconds\ of\ the\ clock,.*\n(\ {4}.*\ s\ +[\d.]+\ %\n)*
                     | ^[\d.e+-]+\ %\ of\ the\ cell\ updates\ were\ computed;.*\n
                     | ^(version|compiler|host|date)\ +".*";\n | (?<=[a-z])\ in\ [\d.]+\ s\b.*
                     | \ +\S+\ collisions/s.* | \ \([\d.e+-]+\ s\) | \d+-\d\d-\d\dT[\d:]+[+-]\d{4}(\ on\ [^,\n]*)?""", re.M | re.X)


WRITTEN = re.compile(r"^    written: .*\n", re.M)


def plain(text, folder):
    """The text without what names the build, the time of day, the machine and the folders. When a time is on the disk depends on
    the disk: the lines that say it stand at the end."""
    text = DROPPED.sub("", text)
    text = WRITTEN.sub("", text) + "".join(WRITTEN.findall(text))
    return text.replace(folder + "/", "").replace(folder, ".").replace(harness.BIN, "BIN")


def files(case, folder, names=None):
    """Relative path -> bytes, decompressed; in the order of the times. The gas of segregationWedge is compared as the case wedge."""
    found = {}
    names = names or [n for n in os.listdir(case) if os.path.isdir(os.path.join(case, n)) and n != "gas"]
    for name in sorted(names, key=lambda n: (not n[0].isdigit(), float(n) if re.fullmatch(r"[\d.e+-]+", n) else 0, n)):
        for path, data in sorted(runs.contents(os.path.join(case, name), ignore=("run.dat",)).items()):
            data = gzip.decompress(data) if path.endswith(".gz") else data
            if os.path.basename(path) in ("provenance", "provenance.gz"):
                data = plain(data.decode(), folder).encode()
            found[f"{name}/{path}"] = data
    return found


def make(name, row, case, mesh=mesh):
    """The case in its short form; returns what `mesh` does, the log of gmshToCase, where it has a mesh.geo."""
    if callable(row.source):
        row.source(case)
    else:
        copy = harness.copy(row.source, os.path.dirname(case))
        os.rename(copy, case)
        os.rmdir(os.path.dirname(copy))
    for change in row.replace:
        replace(case, *change)
    for file, text in [*row.append, (CONTROL, "logInterval 5;\n")]:  # else the log has an entry a second
        runs.add(case, file, text)
    if row.control:
        harness.edit(case, CONTROL, **row.control)
    if row.prepare:
        row.prepare(case)
    return "" if callable(row.source) else mesh(case, row.mesh)


def application(case):
    with open(os.path.join(case, CONTROL)) as f:
        return re.search(r"application +(\w+);", f.read())[1]


def solve(row, case):
    """The log of the run, or of both when it is stopped in between."""
    log = ""
    if row.stop:
        with open(os.path.join(case, CONTROL)) as f:
            text = f.read()
        harness.edit(case, CONTROL, endTime=row.stop)
        log = said(application(case), "-case", case, ranks=row.ranks)
        with open(os.path.join(case, CONTROL), "w") as f:
            f.write(text)
    return log + said(application(case), "-case", case, ranks=row.ranks)


class Failed(Exception):
    """A case that does not run as its row says proves nothing."""


def run_case(name, folder):
    """Runs one case; returns all that is compared: name -> bytes."""
    row, case = ROWS[name], os.path.join(folder, name)
    texts = {"log.gmshToCase": make(name, row, case), "log.checkCase": said("checkCase", case), "log.solver": solve(row, case)}
    result = files(case, folder)
    shutil.rmtree(os.path.join(case, "VTK"), ignore_errors=True)
    texts["log.caseToVTK"] = said("caseToVTK", case)
    if os.path.isdir(os.path.join(case, "postProcessing", "mean", "0", "0")):
        texts["log.caseToVTK"] += said("caseToVTK", case, "-phases", "mean")
    if os.path.isdir(os.path.join(case, "VTK")):
        result.update({f"caseToVTK: {k}": v for k, v in files(case, folder, ["VTK"]).items()})
    for key, text in texts.items():
        result[key] = plain(text, folder).encode()
        with open(os.path.join(case, key), "w") as f:
            f.write(text)
    if not texts["log.solver"].endswith(f"exit code {row.code}\n"):
        raise Failed(f"log.solver: {texts['log.solver'][-300:].strip()!r} instead of exit code {row.code}")
    return result


def listings(folder):
    """What the programs say of themselves."""
    return {f"{name} {option}": plain(said(name, option), folder).encode() for name, options in PROGRAMS.items() for option in options}


def messages(folder):
    """What checkCase says of wrong entries."""
    found = {}
    for i, wrong in enumerate(WRONG):
        case = os.path.join(folder, f"wrong{i}")
        row = Row("couetteDisks", {"N": 8}, replace=[wrong])
        make("wrong", row, case)
        found[f"{wrong[0]}: {wrong[2]}".replace("\n", " ")] = plain(said("checkCase", case), folder).encode()
    return found


OTHERS = {"listings": listings, "messages": messages}


def everything(name, programs, keep):
    """Runs a case with the programs of a folder, in scratch or in `keep`."""
    harness.BIN = os.path.abspath(programs)
    with tempfile.TemporaryDirectory(prefix="haff") as scratch:
        folder = os.path.realpath(keep or scratch)
        if keep:
            shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
            os.makedirs(folder, exist_ok=True)
        return OTHERS[name](folder) if name in OTHERS else run_case(name, folder)


def is_text(data):
    return data.isascii() and not re.search(rb"[\0-\x08\x0e-\x1f]", data)


def summary(key, data):
    """What is saved of a file: texts of programs as they are, checksums of the lines of texts and of the blocks of all others."""
    if isinstance(data, dict):
        return data
    if is_text(data) and (len(data) < 10000 or key.startswith("log.")):
        return {"text": data.decode(errors="surrogateescape")}
    parts = data.splitlines() if is_text(data) else [data[i:i + BLOCK] for i in range(0, len(data), BLOCK)]
    return {"size": len(data), "sums": [zlib.crc32(p) for p in parts], "lines": is_text(data)}


def first(one, other):
    return next((i for i, (a, b) in enumerate(zip(one, other)) if a != b), min(len(one), len(other)))


def line_of(texts, i):
    return " | ".join(repr(t[i][:100]) if i < len(t) else "end" for t in texts)


def difference(key, one, other):
    """Nothing, or where two contents differ; each is bytes or a summary."""
    if one == other:
        return ""
    if isinstance(one, bytes) and isinstance(other, bytes):
        if is_text(one) and is_text(other):
            lines = [d.decode(errors="replace").splitlines() for d in (one, other)]
            i = first(*lines)
            return f"line {i + 1}: {line_of(lines, i)}"
        return f"byte {first(one, other) + 1} of {len(one)} and {len(other)}"
    a, b = summary(key, one), summary(key, other)
    if a == b:
        return ""
    if "text" in a and "text" in b:
        lines = [d["text"].splitlines() for d in (a, b)]
        i = first(*lines)
        return f"line {i + 1}: {line_of(lines, i)}"
    if "text" in a or "text" in b or a["lines"] != b["lines"]:
        return "much shorter or longer"
    i = first(a["sums"], b["sums"])
    if a["lines"]:
        now = other.decode(errors="replace").splitlines() if isinstance(other, bytes) else []
        return f"line {i + 1}" + (f": now {line_of([now], i)}" if now else "")
    return f"bytes {i * BLOCK + 1} .. {(i + 1) * BLOCK} of {a['size']} and {b['size']}"


def rows_added(key, one, other):
    """Whether a listing, or the names that a message says are allowed, only has more entries than it had."""
    texts = [data.get("text", "") if isinstance(data, dict) else data.decode(errors="replace") for data in (one, other)]
    before, after = (re.split(r"\n|, |; ", text) for text in texts)
    after = iter(after)
    return ("-list" in key or "allowed are: " in texts[0]) and all(entry in after for entry in before)


def compare(one, other, new_rows=False):
    """Nothing, or what differs first and how much else does."""
    found = []
    for key in [*one, *(k for k in other if k not in one)]:
        if key not in one or key not in other:
            found.append(f"{key}: only in the {'first' if key in one else 'second'}")
            continue
        text = difference(key, one[key], other[key])
        if text and not (new_rows and rows_added(key, one[key], other[key])):
            found.append(f"{key}: {text}")
    return found[0] + (f" ({len(found) - 1} more of {len(one)} differ)" if len(found) > 1 else "") if found else ""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, add_help=False)
    parser.add_argument("words", nargs="*", metavar="BIN_A [BIN_B] [CASE...]")
    parser.add_argument("-save", metavar="FILE", help="write the checksums of BIN_A as JSON; no BIN_B")
    parser.add_argument("-against", metavar="FILE", help="compare with saved checksums instead of BIN_B")
    parser.add_argument("-keep", metavar="DIR", help="keep the cases in DIR/a and DIR/b")
    parser.add_argument("-newRows", action="store_true", help="names that listings and messages have in addition are no difference")
    parser.add_argument("-list", action="store_true", help="names of the cases")
    parser.add_argument("-help", "--help", action="help", help="this text")
    o = parser.parse_intermixed_args()
    o.all = [*OTHERS, *ROWS]
    if o.list:
        return o
    count = 1 if o.save or o.against else 2
    o.programs, o.cases = o.words[:count], o.words[count:] or o.all
    if o.save and o.against:
        parser.error("-save or -against, not both")
    if len(o.programs) < count:
        parser.error("which folders of programs?")
    for folder in o.programs:
        if not os.path.isfile(os.path.join(folder, "granularGas")):
            parser.error(f"{folder} holds no granularGas")
    for name in o.cases:
        if name not in o.all:
            parser.error(f"no case {name}; there are {' '.join(o.all)}")
    return o


def main():
    o = arguments()
    if o.list:
        print("\n".join(o.all))
        return 0
    begin, differ, saved, old = time.time(), 0, {}, {}
    if o.against:
        with open(o.against) as f:
            old = json.load(f)
    for name in o.cases:
        start = time.time()
        kept = [o.keep and os.path.join(o.keep, side) for side in "ab"]
        try:
            sides = [everything(name, folder, keep) for folder, keep in zip(o.programs, kept)]
            one = old.get(name) if o.against else sides[0]
            found = compare(one, sides[-1], o.newRows) if one else "not among the saved checksums"
        except (Failed, subprocess.SubprocessError) as e:
            sides, found = [{}], str(e)
        if o.save and not found:
            saved[name] = {key: summary(key, data) for key, data in sides[0].items()}
        differ += bool(found)
        print(f"{name:24} {found or ('saved' if o.save else 'same') + f'  ({len(sides[-1])} files and texts, {time.time() - start:.1f} s)'}", flush=True)
    if o.save:
        with open(o.save, "w") as f:
            json.dump(saved, f)
    print(f"{o.save}: {len(saved)} cases," if o.save else f"{differ} of {len(o.cases)} differ,", f"{time.time() - begin:.0f} s")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
