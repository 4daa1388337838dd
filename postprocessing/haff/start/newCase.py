# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the smallest sound case around a geometry: start, gas, schemes, times, each entry with what it means.

    newCase DIR mesh.geo                                    a geometry of gmsh, whose physical groups become the patches
    newCase DIR mesh.msh                                    a mesh of gmsh
    newCase DIR -box 2x1 -cells 200x100                     a box: left right bottom top (back front); also of one axis or three
    newCase DIR mesh.geo -Mach 4                            a stream that enters at the patch `inlet`
    newCase DIR -box 100x40 -gravity 981 -shaking 3,10 -diameter 1 -grains disks -transport
    newCase DIR mesh.geo -application granularMD            grains in place of a gas; granularDEM: soft ones with friction
    newCase DIR -box 2x1 -round                             the body of revolution of a plane mesh about the x axis
    newCase DIR -chute 25                                   a layer slides down a rough floor, inclined by 25 degrees
    newCase DIR -silo 8                                     a silo runs out of a slot, 8 grains wide; its flow rate is written
    newCase DIR -column 2                                   a column, twice as high as wide, collapses on a floor

What a patch is, its name says: inlet; outlet; open, farfield; symmetry; periodic; wall, floor, left, ..; body, cylinder, obstacle, ..
(a wall, whose forces are measured). Patches of other names become walls, which newCase says; -patch NAME=KIND says else (KIND: wall body inlet
outlet open symmetry periodic empty rough: a wall that grains rub on). Gravity points against the last axis of the mesh (y in a plane, z
in space), whatever its sign, unless it is a vector.
With an inlet the domain is full of the stream; with gravity and a floor a layer lies on it; else the gas is at rest but for faint waves,
and cools. Nothing that is there is overwritten: DIR is new, empty, or holds the mesh alone. Exit code: 2 for a wrong command line, 1
where no case could be made.
"""
import argparse
import difflib
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

from haff import command, paths
from haff.start import flow, geometry, patches, problems, texts


MOST_CELLS = 20_000_000  # of a box


def number(word):
    """0, or between 1e-30 and 1e30 or minus such a number: what is made of it stays finite. ArgumentTypeError."""
    try:
        found = float(word)
    except ValueError:
        found = float("nan")
    if found and not 1e-30 <= abs(found) <= 1e30:
        raise argparse.ArgumentTypeError(f"{word}: a number from 1e-30 to 1e30")
    return found


def positive(word):
    found = number(word)
    if found <= 0:
        raise argparse.ArgumentTypeError(f"{word}: a number above 0")
    return found


def numbers(text, option, counts, form):
    """So many numbers, with commas between them. ValueError."""
    try:
        found = [number(word) for word in text.split(",")]
    except argparse.ArgumentTypeError:
        found = []
    if len(found) not in counts:
        raise ValueError(f"{option} {text}: {form}; from 1e-30 to 1e30")
    return found


def sizes(text, option, make, form):
    """Up to three positive numbers with x between them. ValueError."""
    try:
        found = [make(word) for word in text.split("x")]
    except ValueError:
        found = []
    if not 1 <= len(found) <= 3 or not all(1e-15 < x < 1e15 for x in found):
        raise ValueError(f"{option} {text}: {form}")
    return found


def parser():
    made = command.parser(__doc__, usage="newCase DIR [mesh.geo | mesh.msh | -box LxH -cells NxM] [options]")
    made.add_argument("dir", metavar="DIR")
    made.add_argument("mesh", nargs="?", help="mesh.geo or mesh.msh")
    made.add_argument("-application", metavar="NAME", default="granularGas", choices=("granularGas", "granularMD", "granularDEM"), help="granularGas (default), granularMD or granularDEM")
    made.add_argument("-grains", choices=("spheres", "disks"), help="spheres (default; also in a plane) or disks")
    made.add_argument("-diameter", type=positive, metavar="D", help="of a grain (a quarter of a cell)")
    made.add_argument("-restitution", type=number, metavar="E", help="0 to 1 (0.9; of a stream 0.95); 1: elastic")
    made.add_argument("-alpha", type=number, metavar="A", help="volume fraction (0.2; of a stream 0.05; in a layer 0.6, of disks 0.8)")
    made.add_argument("-speed", metavar="U", help="of the stream, or X,Y,Z (1, into the inlet); without a stream that of the grains")
    made.add_argument("-Mach", type=positive, metavar="M", help="of the stream (3)")
    made.add_argument("-gravity", metavar="G", help="a number, downwards, or X,Y,Z; in a plane X,Y")
    made.add_argument("-shaking", metavar="A,F", help="acceleration of the plate over gravity's (no length), and its frequency (no rad/s)")
    made.add_argument("-transport", action="store_true", help="viscosity and heat conduction; walls then hold the gas")
    made.add_argument("-walls", choices=("slip", "noSlip"), help="with -transport or granularDEM (noSlip)")
    made.add_argument("-patch", metavar="NAME=KIND", action="append", default=[], help="what a patch is; may be repeated")
    made.add_argument("-periodic", metavar="A,B", action="append", default=[], help="two patches that are joined; may be repeated")
    made.add_argument("-box", metavar="LxHxD", help="extent of a box, along one to three axes (1x1)")
    made.add_argument("-cells", metavar="NxMxK", help="of a box (100x100)")
    made.add_argument("-round", action="store_true", help="the mesh of (x, y) cells stands for the body of revolution about the x axis")
    made.add_argument("-chute", type=number, metavar="ANGLE", help="degrees")
    made.add_argument("-silo", type=number, nargs="?", const=8.0, metavar="WIDTH", help="of the slot, in grain diameters (8)")
    made.add_argument("-column", type=number, nargs="?", const=1.0, metavar="ASPECT", help="height over width (1)")
    made.add_argument("-end", type=positive, metavar="T", help="time at which the run ends")
    return made


def parse(words):
    """The options. Values may begin with a minus; an unknown option is refused with the one that was meant."""
    made, joined, words = parser(), [], list(words)
    valued = {o for a in made._actions if a.nargs is None for o in a.option_strings}
    known = [o for a in made._actions for o in a.option_strings]
    while words:
        word = words.pop(0)
        if word.startswith("-") and word.split("=")[0] not in known:
            near = difflib.get_close_matches(word, known, 1, 0.5)
            made.error(f"there is no option {word}" + (f"; did you mean {near[0]}?" if near else "  (-help lists them)"))
        joined.append(f"{word}={words.pop(0)}" if word in valued and words and re.match(r"-[\d.]", words[0]) else word)
    o = made.parse_intermixed_args(joined)
    try:
        o.speed = o.speed and numbers(o.speed, "-speed", (1, 3), "a number, or a velocity as 1,0,0")
        o.gravity = o.gravity and numbers(o.gravity, "-gravity", (1, 2, 3), "a number, downwards, or a vector as 0,-9.81,0; in a plane 0,-9.81")
        o.shaking = o.shaking and numbers(o.shaking, "-shaking", (2,), "two numbers: acceleration over gravity's, and frequency, as 3,10")
        o.periodic = [tuple(pair.split(",")) for pair in o.periodic]
        if any(len(pair) != 2 for pair in o.periodic):
            raise ValueError(f"-periodic {','.join(next(p for p in o.periodic if len(p) != 2))}: two patches, as left,right")
        o.problem = problems.chosen(o)
        if o.problem and o.cells:
            raise ValueError("-cells: a chute, a silo or a column has cells of its own; mesh.geo has their numbers")
        if o.mesh and (o.box or o.cells):
            raise ValueError("-box and -cells are there where no mesh is given")
        o.box = sizes(o.box or "1x1", "-box", float, "one to three lengths, as 2x1")
        o.cells = sizes(o.cells, "-cells", int, "one to three whole numbers, as 200x100") if o.cells else [100, 100, 100][:len(o.box)]
        if math.prod(o.cells) > MOST_CELLS:
            raise ValueError(f"-cells: {math.prod(o.cells):.3g} cells are too many for gmsh, which makes them one by one: give {MOST_CELLS:.0e} at most; "
                             "larger lattices stand in system/blockMeshDict, which granularGas reads itself")
        if len(o.box) != len(o.cells):
            raise ValueError(f"-box and -cells: {len(o.box)} lengths and {len(o.cells)} numbers of cells")
    except ValueError as wrong:
        made.error(str(wrong))
    return o


def check_target(o):
    """DIR is new, empty, or holds only the mesh. ValueError."""
    mesh = o.mesh and os.path.realpath(o.mesh)
    if o.mesh and os.path.isdir(o.mesh):
        raise ValueError(f"{o.mesh} is a folder; a mesh is mesh.geo or mesh.msh, of gmsh")
    if o.mesh and not os.path.isfile(o.mesh):
        folder = os.path.dirname(os.path.abspath(o.mesh))
        near = difflib.get_close_matches(os.path.basename(o.mesh), os.listdir(folder) if os.path.isdir(folder) else [], 1, 0.5)
        raise ValueError(f"{o.mesh}: no such file" + (f"; did you mean {near[0]}?" if near else ""))
    if o.mesh and not o.mesh.endswith((".geo", ".msh")):
        raise ValueError(f"{o.mesh}: a mesh is mesh.geo or mesh.msh, of gmsh; gmsh makes a .msh of what else it reads (gmsh -3 FILE -o mesh.msh)")
    if os.path.lexists(o.dir) and not os.path.isdir(o.dir):
        raise ValueError(f"{o.dir} is there, and no folder: give another name")
    there = [name for name in sorted(os.listdir(o.dir)) if os.path.realpath(os.path.join(o.dir, name)) != mesh] if os.path.isdir(o.dir) else []
    if there:
        raise ValueError(f"{o.dir} is not empty (it holds {there[0]}{', ..' if there[1:] else ''}): give another name; nothing is overwritten")


def write(folder, made):
    for name, text in made.items():
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        if name.startswith("All"):
            os.chmod(path, 0o755)


def version():
    """Of the programs: the two numbers that a case names."""
    return re.search(r"(\d+\.\d+)", subprocess.run([paths.program("granularGas"), "-version"], capture_output=True, text=True, check=True).stdout)[1]


def mesh_of(o, folder):
    """Puts mesh.geo or mesh.msh into the folder, and makes constant/polyMesh. A box needs no gmsh."""
    if o.mesh and o.mesh.endswith(".msh"):
        shutil.copy(o.mesh, os.path.join(folder, "mesh.msh"))
    elif o.mesh:
        geometry.with_merged(o.mesh, folder)
        geometry.make_msh(folder)
    elif not o.problem and not shutil.which("gmsh"):
        write(folder, {"./mesh.msh": geometry.box_msh(o.box, o.cells)})
    else:
        write(folder, {"./mesh.geo": o.problem.geo if o.problem else geometry.box(o.box, o.cells)})
        geometry.make_msh(folder)
    geometry.make_poly_mesh(folder)


def make(o, folder):
    """The case in an empty folder: (the numbers, lines to say). ValueError."""
    mesh_of(o, folder)
    found = geometry.Geometry(folder)
    if o.round:
        o.patch = patches.on_axis(found) + o.patch
    kind, unknown = patches.kinds(found, [f"{name}={what}" for name, what in (o.problem.kind if o.problem else {}).items()] + o.patch, o.periodic)
    pairs = patches.partners(found, kind, o.periodic)
    if any(kind[p.name] == "empty" and p.type != "empty" for p in found.patches):  # of a mesh of one layer: the axis counts no more
        for p in found.patches:
            p.type = "empty" if kind[p.name] == "empty" else p.type
        found.find_axes()
    numbers_of = flow.Flow(o, found, kind)
    unknown = [name for name in unknown if name != numbers_of.lid]
    notes = {name: "a wall, for its name says nothing else" for name in unknown}
    if numbers_of.lid:
        notes[numbers_of.lid] = f"{patches.KINDS['outlet']}, for the floor is inclined; else  -patch {numbers_of.lid}=wall"
    write(folder, texts.files(numbers_of, pairs, notes, version(), os.path.exists(os.path.join(folder, "mesh.geo"))))
    if os.path.exists(os.path.join(folder, "system", "meshDict")):
        geometry.make_poly_mesh(folder)
    said = [f"patch    {p.name:<16} {kind[p.name]}: {notes.get(p.name) or patches.KINDS[kind[p.name]]}" for p in found.patches]
    if unknown:
        said.append(f"note     {', '.join(unknown)}: if that is no wall, say  -patch {unknown[0]}=outlet  (kinds: {', '.join(patches.KINDS)})")
    return numbers_of, said


def checked(folder):
    """What checkCase warns of. ValueError where it finds the case wrong."""
    done = subprocess.run([paths.program("checkCase"), "."], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise ValueError("checkCase refuses the case that was to be written: " + re.sub(r"^error: ", "", done.stderr.strip(), flags=re.M))
    return re.findall(r"^warning: .*", done.stdout, re.M)


def move(folder, target):
    """What was made goes to the target; the user's own mesh, where it lies there under another name, stays."""
    os.makedirs(target, exist_ok=True)
    for name in os.listdir(folder):
        place = os.path.join(target, name)
        if not os.path.lexists(place):
            shutil.move(os.path.join(folder, name), place)


def new_case(o):
    check_target(o)
    with tempfile.TemporaryDirectory(prefix="newCase") as folder:
        numbers_of, said = make(o, folder)
        warnings = checked(folder)
        move(folder, o.dir)
    g = numbers_of.geometry
    print(f"mesh     {g.cells} cells, {len(g.axes)}D, {'a lattice' if g.lattice else 'polyhedra'}; cells are {g.cell_text} wide, grains {numbers_of.diameter:g}")
    print("\n".join(said))
    if o.gravity:
        print(f"gravity  {numbers_of.gravity_text}")
    print(f"start    {numbers_of.summary()}")
    if o.shaking:
        print(f"plate    {numbers_of.plate_text}")
    if o.problem:
        print(f"note     {o.problem.note}")
    elif numbers_of.friction:
        print("friction glass beads, friction { type muI; } in constant/granularProperties; type none: a heap goes flat")
    print(f"end      {numbers_of.end:g}, written every {numbers_of.interval:g}")
    for warning in warnings:
        print(warning.replace("./", os.path.join(o.dir, ""), 1))
    go = "" if os.path.realpath(o.dir) == os.getcwd() else f"cd {shlex.quote(o.dir)} && "
    print(f"\n{o.dir} is a case, which checkCase finds {'sound' if not warnings else 'to be run with warnings'}. Now:\n\n    {go}./Allrun"
          f"\n    haffPlot .{o.problem.look if o.problem else ''}      # a picture of the last time")


def main():
    o = parse(sys.argv[1:])
    try:
        new_case(o)
    except (ValueError, OSError) as wrong:
        print(f"error: {command.message(wrong)}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
