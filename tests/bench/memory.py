#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Peak memory of each rank (VmHWM) of a whole run: start from expressions, two steps, a written time, and again from that time.

    tests/bench/memory.py N0 N1 N2 [-by blockMesh|gmsh] [-ranks 1 2 4 8] [-format binary|ascii] [-bin FOLDER]
    tests/bench/memory.py -triangles N [-reconstruct NAME] ...

A box of N0 x N1 x N2 cells (N2 = 1: 2D) from system/blockMeshDict, gas with cooling and gravity, an inlet; with -by from a
constant/polyMesh in that format, which OpenFOAM's blockMesh made of that dictionary, or gmshToCase of a mesh of gmsh; or the unit
square in about N triangles, from a polyMesh likewise. Prints for each number of ranks the largest VmHWM of a rank in MB, in bytes a cell of that rank's share, and its ratio to that of one rank over N."""
import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, HERE)
os.environ.setdefault("HAFF_SOURCE", HERE)
MESH = """
vertices ((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 1) (1 0 1) (1 1 1) (0 1 1));
blocks (hex (0 1 2 3 4 5 6 7) (%d %d %d) simpleGrading (1 1 1));
boundary
(
    inlet  { type patch; faces ((0 4 7 3)); }
    outlet { type patch; faces ((1 2 6 5)); }
    walls  { type wall; faces ((0 1 5 4) (3 7 6 2)); }
    sides  { type %s; faces ((0 3 2 1) (4 5 6 7)); }
);
"""


SQUARE = """
h = %.9g;
Point(1) = {0, 0, 0, h};   Point(2) = {1, 0, 0, h};   Point(3) = {1, 1, 0, h};   Point(4) = {0, 1, 0, h};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Physical Curve("inlet") = {4};   Physical Curve("outlet") = {2};   Physical Curve("walls") = {1, 3};
Physical Surface("gas") = {1};
"""

BOX = """
Point(1) = {0, 0, 0};   Point(2) = {1, 0, 0};   Point(3) = {1, 1, 0};   Point(4) = {0, 1, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Transfinite Curve {1, 3} = %d + 1;   Transfinite Curve {2, 4} = %d + 1;
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};   Transfinite Surface {1};   Recombine Surface {1};
b[] = Extrude {0, 0, 1} { Surface{1}; Layers{%d}; Recombine; };
Physical Surface("inlet") = {b[5]};   Physical Surface("outlet") = {b[3]};   Physical Surface("walls") = {b[2], b[4]};
Physical Surface("sides") = {1, b[0]};   Physical Volume("gas") = {b[1]};
"""


def by_gmsh(case, geometry, dim, patches, form, programs, cut=0):
    """Replaces the mesh of a case by one of gmsh, whose cells are cut into halves along each axis `cut` times; returns what gmshToCase says."""
    geo, msh = os.path.join(case, "mesh.geo"), os.path.join(case, "mesh.msh")
    with open(geo, "w") as f:
        f.write(geometry)
    for words in ([f"-{dim}", geo], *cut * (["-refine", msh],)):
        subprocess.run(["gmsh", *words, "-v", "2", "-bin", "-o", msh], check=True)
    os.remove(os.path.join(case, "system", "blockMeshDict"))
    with open(os.path.join(case, "system", "meshDict"), "w") as f:
        f.write('FoamFile { version 2.0; format ascii; class dictionary; object meshDict; }\n'
                f'patches {{ {patches} }}\n')
    done = subprocess.run([os.path.join(programs, "gmshToCase"), msh, "-case", case, "-" + form], check=True, capture_output=True,
                          text=True)
    os.remove(msh)
    return done.stdout


def boxes_of(program, case, n, form, programs):
    """Gives a case the polyMesh that its blockMeshDict says, made by that program."""
    if program == "gmsh":
        by_gmsh(case, BOX % tuple(n), 3, f"sides {{ type {'empty' if n[2] == 1 else 'wall'}; }} walls {{ type wall; }}", form, programs)
        return
    from tests.cases.runtime import test_blockMesh as meshes
    subprocess.run(["blockMesh", "-case", case], check=True, capture_output=True, env=meshes.FOAM)
    os.remove(os.path.join(case, "system", "blockMeshDict"))


def triangles(case, n, form, programs, cut=0):
    """Replaces the mesh of a case by about n triangles, each a 4^cut-th of one by gmsh, which takes long for many; returns how many there are."""
    said = by_gmsh(case, SQUARE % (4 ** (cut + 1) / (3 ** 0.5 * n)) ** 0.5, 2, "back { type empty; } front { type empty; }", form, programs, cut)
    for name in ("rho", "p", "U"):
        path = os.path.join(case, "0.orig", name)
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("sides {", '"back|front" {'))
    return int(next(line for line in said.splitlines() if line.startswith("cells")).split()[1].rstrip(":"))


def make(case, n, form):
    from tests.cases.harness import boxes
    from tests.cases.runtime import test_blockMesh as meshes
    flat = n[2] == 1
    meshes.channel(case, MESH % (*n, "empty" if flat else "wall"))
    sides = "sides { type empty; }" if flat else "sides { type zeroGradient; }"
    for name, expression, rules in (("rho", '"100 + 20*cos(9*x)*sin(7*y)"', meshes.RULES[""] % 100 + sides),
                                    ("p", '"100 + 300*pos(0.02 - (x - 0.4)^2 - (y - 0.3)^2)"', meshes.RULES[""] % 100 + sides),
                                    ("U", ('"1 + sin(5*y)"', '"0.1*x"', '"0"'), meshes.RULES["U"]
                                     + ("sides { type empty; }" if flat else "sides { type slip; }"))):
        meshes.field(case, name, expression, rules)
    path = os.path.join(case, "system", "controlDict")
    with open(path, "w") as f:
        f.write(boxes.header("dictionary", "controlDict", "system") + "application granularGas; startFrom latestTime; stopAt endTime; "
                "endTime 2e-7; deltaT 1e-7; adjustTimeStep no; writeControl timeStep; writeInterval 2; timeFormat general; "
                f"timePrecision 12; writeFormat {form}; writePrecision 12; writeCompression off; runTimeModifiable no;\n")


def peaks(program, case, ranks):
    """kB of each rank, of one run."""
    log = tempfile.mkdtemp()
    subprocess.run(["mpirun", "--oversubscribe", "-np", str(ranks), sys.executable, os.path.abspath(__file__), "-child", log, program,
                    case], check=True)
    values = [int(open(os.path.join(log, name)).read()) for name in os.listdir(log)]
    shutil.rmtree(log)
    assert len(values) == ranks
    return values


def child(log, program, case):
    """One rank: runs the program in its place of the MPI job, and notes its peak."""
    with open(os.devnull, "w") as nothing:
        code = subprocess.run([program, "-case", case], stdout=nothing).returncode
    with open(os.path.join(log, str(os.getpid())), "w") as f:
        f.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
    return code


def main():
    if sys.argv[1:2] == ["-child"]:
        return child(*sys.argv[2:5])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("n", type=int, nargs="*")
    parser.add_argument("-triangles", type=int)
    parser.add_argument("-by", choices=("blockMesh", "gmsh"))
    parser.add_argument("-reconstruct", help="polyReconstruct of fvSchemes")
    parser.add_argument("-ranks", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("-format", default="binary")
    parser.add_argument("-bin", default=os.environ.get("HAFF_BIN", os.path.join(HERE, "build", "bin")))
    a = parser.parse_args()
    if len(a.n) != (0 if a.triangles else 3):
        parser.error("give three numbers of cells, or -triangles N")
    first = {}
    for key, value in {"OMPI_MCA_mpi_yield_when_idle": "1", "OMP_NUM_THREADS": "1"}.items():
        os.environ.setdefault(key, value)
    with tempfile.TemporaryDirectory() as whole:
        mesh = os.path.join(whole, "mesh")
        make(mesh, a.n or (1, 1, 1), a.format)
        cells = triangles(mesh, a.triangles, a.format, a.bin) if a.triangles else a.n[0] * a.n[1] * a.n[2]
        if a.by:
            boxes_of(a.by, mesh, a.n, a.format, a.bin)
        if a.reconstruct:
            with open(os.path.join(mesh, "system", "fvSchemes"), "a") as f:
                f.write(f"polyReconstruct {a.reconstruct};\n")
        measure(a, mesh, cells, first)
    return 0


def measure(a, mesh, cells, first):
    """Prints the table."""
    print(f"{cells} cells\nranks  start: MB, B/cell, ratio   restart: MB, B/cell, ratio")
    for ranks in a.ranks:
        with tempfile.TemporaryDirectory() as folder:
            case = os.path.join(folder, "box")
            shutil.copytree(mesh, case)
            row = f"{ranks:5d}"
            for run in ("start", "restart"):
                most = 1024 * max(peaks(os.path.join(a.bin, "granularGas"), case, ranks))
                first.setdefault(run, most * ranks)
                row += f"   {most / 1e6:8.0f} {most * ranks / cells:7.0f} {most * ranks / first[run]:7.2f}"
                path = os.path.join(case, "system", "controlDict")
                with open(path) as f:
                    text = f.read()
                with open(path, "w") as f:
                    f.write(text.replace("endTime 2e-7", "endTime 4e-7"))
        print(row, flush=True)


if __name__ == "__main__":
    sys.exit(main())
