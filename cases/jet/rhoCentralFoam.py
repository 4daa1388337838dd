# SPDX-License-Identifier: GPL-3.0-or-later
"""The jet by OpenFOAM's rhoCentralFoam, on a wedge with as many cells and with the open sides of its tutorial, as a table of the axis: x, rho, U, p in SI units, Mach
number; its last line has the processor time. Inviscid, T is p/rho.

    haff figure cases/jet/rhoCentralFoam.py [-keep]
"""
import os
import resource
import subprocess
import sys
import tempfile

import numpy as np

import haff
from haff.case import foam
from haff.openfoam.mesh import ENVIRONMENT, block_mesh
from haff.plot import script
from studies.made import rhocentral

N, RADIUS, END, SLOPE = 10, 0.005, 3e-4, np.tan(np.radians(2.5))  # N as in the tutorial
OUTSIDE, NOZZLE = (101325.0, 101325 / 1.1843, 0.0), (271724.0, 271724 / 3.8302, 315.6)  # p, T = p/rho, U
BLOCKS = """convertToMeters 1;
vertices ( {points} );
blocks ( hex (0 1 3 2 0 1 7 6) ({along} {n} 1) simpleGrading (1 1 1)  hex (2 3 5 4 6 7 9 8) ({along} {n} 1) simpleGrading (1 1 1) );
edges ( );
boundary
(
    nozzle {{ type patch; faces ( (0 2 6 0) ); }}
    rim {{ type wall; faces ( (2 4 8 6) ); }}
    out {{ type patch; faces ( (1 3 7 1) (3 5 9 7) ); }}
    free {{ type patch; faces ( (4 8 9 5) ); }}
    low {{ type wedge; faces ( (0 2 3 1) (2 4 5 3) ); }}
    high {{ type wedge; faces ( (0 1 7 6) (6 7 9 8) ); }}
);
mergePatchPairs ( );
"""


def rules():
    """Of rhoCentralFoam's tutorial LadenburgJet60psi, without the friction of its rim."""
    p, T, _ = OUTSIDE
    value = lambda v: f"value uniform {v!r}"
    total = "rho none; psi thermo:psi; gamma 1.4"
    both = {"low": "wedge", "high": "wedge"}
    return {"p": {"nozzle": f"fixedValue; {value(NOZZLE[0])}", "rim": "zeroGradient", "free": f"totalPressure; p0 uniform {p!r}; {total}; {value(p)}",
                  "out": f"waveTransmissive; field p; psi thermo:psi; gamma 1.4; fieldInf {p!r}; lInf 0.025; {value(p)}", **both},
            "T": {"nozzle": f"fixedValue; {value(NOZZLE[1])}", "rim": "zeroGradient", "free": f"totalTemperature; T0 uniform {T!r}; {total}; {value(T)}",
                  "out": "zeroGradient", **both},
            "U": {"nozzle": f"fixedValue; value uniform ({NOZZLE[2]!r} 0 0)", "rim": "slip", "free": "zeroGradient",
                  "out": "inletOutlet; inletValue uniform (0 0 0); value uniform (0 0 0)", **both}}


def made(case):
    points = [(x, 0, 0) for x in (0, 6 * RADIUS)] + [(x, r, side * SLOPE * r) for side, rows in ((-1, (1, 2)), (1, (1, 2))) for r in (RADIUS * k for k in rows)
                                                    for x in (0, 6 * RADIUS)]
    text = " ".join("(%.17g %.17g %.17g)" % p for p in points)
    foam.write_dictionary(case, "system", "blockMeshDict", BLOCKS.format(points=text, along=6 * N, n=N))
    if why := block_mesh(case):
        sys.exit(f"blockMesh failed: {why}")
    cells = 12 * N * N
    state = {"p": np.full(cells, OUTSIDE[0]), "T": np.full(cells, OUTSIDE[1]), "U": np.zeros((cells, 3))}
    rhocentral.write(case, 1.4, END, 0.5, state, rules())


if not rhocentral.installed():
    sys.exit(rhocentral.MISSING)
with tempfile.TemporaryDirectory(prefix="jet") as case:
    made(case)
    with open(os.path.join(case, "log"), "w") as log:
        done = subprocess.run(["rhoCentralFoam", "-case", case], stdout=log, stderr=subprocess.STDOUT, env=ENVIRONMENT)
    if done.returncode:
        with open(log.name) as f:
            sys.exit(f"rhoCentralFoam failed: {f.read()[-500:]}")
    result = haff.Case(case)
    axis = result.centres[:, 1] < RADIUS / N
    x, p, T, U = result.centres[axis, 0], result.field("p")[axis], result.field("T")[axis], result.field("U")[axis, 0]
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    path = script.target("rhoCentralFoam.csv")
    np.savetxt(path, np.stack((x, p / T, U, p, U / np.sqrt(1.4 * T)), axis=1), fmt="%.6g", delimiter=",", header="x,rho,U,p,mach", comments="",
               footer=f"# {used.ru_utime + used.ru_stime:.0f} s of processor time, N = {N}")
    print(path)
