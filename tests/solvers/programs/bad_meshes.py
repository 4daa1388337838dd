# SPDX-License-Identifier: GPL-3.0-or-later
"""The mistakes of test_bad_input.py in meshes, mesh files, restarts and conversions (the others: bad_rows.py)."""
import os
import re
import shutil

from tests.solvers.programs import bad_case
from tests.solvers.programs.bad_rows import (Row, remove, write, cut, cut_list, both, change_bytes, replace, mesh, MESH)

BOX_MESH = [
    Row("no " + name, remove(MESH + name), "No such file", where=MESH + name)
    for name in ("points", "faces", "owner", "neighbour", "boundary")
] + [
    Row("cut " + name, cut(MESH + name, 0.7), where=MESH + name)
    for name in ("points", "faces", "owner", "neighbour", "boundary")
] + [
    Row("no mesh", lambda case: shutil.rmtree(os.path.join(case, MESH)), "gmshToCase", where=MESH[:-1]),
    Row("bad point", (MESH + "points", "(6 4 1)", "(6 four 1)"), "'four'", "number"),
    Row("nan point", (MESH + "points", "(6 4 1)", "(6 nan 1)"), "'nan'", "number"),
    Row("point too many", (MESH + "points", "(6 4 1)", "(6 4 1)\n(7 4 1)"), "70 entries", "has more", at="(7 4 1)"),
    Row("index of no point", (MESH + "faces", "4(1 8 43 36)", "4(1 8 70 36)"), "point 70", "0 to 69"),
    Row("face of two points", (MESH + "faces", "4(1 8 43 36)", "2(1 8)"), "2 points", "at least 3"),
    Row("point twice in a face", (MESH + "faces", "4(1 8 43 36)", "4(1 8 8 36)"), "point 8 twice"),
    Row("owner of no cell", lambda case: line_of(case, "owner", 3, "7777"), "7777", where=MESH + "owner", at="7777"),
    Row("owner < 0", lambda case: line_of(case, "owner", 3, "-7"), "cell -7", where=MESH + "owner", at="-7"),
    Row("owner leaves a gap", lambda case: line_of(case, "owner", 105, "90"), "cell 24", "up to 90", where=MESH[:-1]),
    Row("not upper triangular", lambda case: swap(case), "sorted by owner", "renumberMesh", where=MESH + "neighbour"),
    Row("neighbour not above owner", lambda case: line_of(case, "neighbour", 0, "0"), "neighbour 0, owner 0",
        where=MESH + "neighbour"),
    Row("neighbour of no cell", lambda case: line_of(case, "neighbour", 37, "50"), "cell 24", "up to 50", where=MESH[:-1]),
    Row("unknown patch type", (MESH + "boundary", "type wall", "type wal"), "'wal'", "allowed are patch wall"),
    Row("patches overlap", (MESH + "boundary", "startFace 42", "startFace 41"), "startFace 41", "allowed is 42"),
    Row("too many faces in a patch", (MESH + "boundary", "nFaces 48", "nFaces 49"), "49", "106"),
    Row("patch twice", (MESH + "boundary", "xHigh {", "xLow {"), "second patch", "xLow", at="xLow { type wall"),
    Row("wrong number of patches", (MESH + "boundary", "5\n(", "6\n("), "5 patches", "6", at=""),
    Row("cyclic without neighbourPatch", (MESH + "boundary", "neighbourPatch yHigh;", ""), "neighbourPatch", "yLow"),
    Row("cyclic halves that do not name each other", (MESH + "boundary", "neighbourPatch yLow;", "neighbourPatch yHigh;"),
        "each half must name the other", at=""),
    Row("cyclic with a patch that is not there", (MESH + "boundary", "neighbourPatch yHigh;", "neighbourPatch why;"),
        "'why'", at=""),
    Row("cyclic halves of different size", both(
        replace(MESH + "boundary", "xLow { type patch;", "xLow { type cyclic; neighbourPatch yLow;"),
        replace(MESH + "boundary", "neighbourPatch yHigh;", "neighbourPatch xLow;"),
        replace(MESH + "boundary", "yHigh { type cyclic;", "yHigh { type patch;")), "4 and 6 faces", where=MESH[:-1]),
    Row("cyclic halves that do not match", both(
        replace(MESH + "boundary", "xLow { type patch;", "xLow { type cyclic; neighbourPatch xHigh;"),
        replace(MESH + "boundary", "xHigh { type wall;", "xHigh { type cyclic; neighbourPatch xLow;"),
        replace(MESH + "points", "(6 2 0)", "(6 2.3 0)"), replace(MESH + "points", "(6 2 1)", "(6 2.3 1)")),
        "cyclic faces do not match", "'xLow'", where=MESH[:-1]),
    Row("two layers between empty patches", mesh((6, 4, 2)), "cell 0 at", "one cell thick", "Layers{1}",
        where=MESH[:-1]),
    Row("more patches than announced", (MESH + "boundary", "zEmpty { type empty; nFaces 48; startFace 58; }",
                                                   "zEmpty { type empty; nFaces 40; startFace 58; }\n"
                                                   "rest { type patch; nFaces 8; startFace 98; }"),
        "more than the 5 patches", at="rest { type patch"),
    Row("defaultFaces", replace(MESH + "boundary", "xHigh {", "defaultFaces {"), "'defaultFaces' holds 4 faces", "name",
        where="0/alpha"),
    Row("cells inside out", replace(MESH + "points", "(3 2 1)", "(3 2 -5)"), "cell", "at (", where=MESH[:-1]),
    Row("class of a mesh file", (MESH + "owner", "labelList", "scalarField"), "scalarField", "labelList", at=""),
]


def line_of(case, name, entry, text):
    """Replaces entry number `entry` of a list with one entry in a line."""
    path = os.path.join(case, MESH, name)
    with open(path) as f:
        lines = f.read().splitlines()
    lines[lines.index("(") + 1 + entry] = text
    with open(path, "w") as f:
        f.write("\n".join(lines) + "\n")


def swap(case):
    """The first two inner faces of the mesh change places: 0-1 and 0-6."""
    for name in ("faces", "neighbour"):
        path = os.path.join(case, MESH, name)
        with open(path) as f:
            lines = f.read().splitlines()
        at = lines.index("(") + 1
        lines[at], lines[at + 1] = lines[at + 1], lines[at]
        with open(path, "w") as f:
            f.write("\n".join(lines) + "\n")


RESTART = [
    Row("restart: cut field", cut_list("0.002/rho"), "binary list of 24 entries", "the file was cut", where="0.002/rho", base="binary"),
    Row("restart: cut conserved field", cut_list("0.002/rhoE"), "binary list of 24 entries", where="0.002/rhoE", base="binary"),
    Row("restart: wrong count of a binary list", change_bytes("0.002/U", b"\n24\n(", b"\n25\n("),
        "binary list of 25 entries", "count", where="0.002/U", base="binary"),
    Row("restart: nan in a binary list", change_bytes("0.002/T", b"\n24\n(", b"\n24\n(\0\0\0\0\0\0\xf8\x7f", 8),
        "entry 0 of the binary list is nan", "finite", where="0.002/T", base="binary"),
    Row("restart: ascii header on a binary file", change_bytes("0.002/p", b"binary;", b"ascii;"), "format",
        where="0.002/p", base="binary"),
    Row("restart: cut ascii field", cut("0.002/U", 0.5), where="0.002/U", base="ascii"),
    Row("restart: no uniform/time", remove("0.002/uniform/time"), "uniform/time is missing", "start from another time",
        where="0.002", base="ascii"),
    Row("restart: cut uniform/time", cut("0.002/uniform/time", 0.8), where="0.002/uniform/time", base="ascii"),
    Row("restart: empty uniform/time", write("0.002/uniform/time", ""), "'value' is missing",
        where="0.002/uniform/time", base="ascii"),
    Row("restart: index that is none", ("0.002/uniform/time", "index           2;", "index           two;"), "two",
        "expected a number", base="ascii"),
    Row("restart: index beyond all numbers", ("0.002/uniform/time", "index           2;", "index           1e300;"), "1e300",
        "whole number", base="ascii"),
    Row("restart: digits beyond all numbers", ("0.002/uniform/time", "writePrecision  17;", "writePrecision  2000000000;"),
        "1 to 17", base="ascii"),
    Row("restart: another time inside", ("0.002/uniform/time", "value           0.002;", "value           0.9;"),
        "0.9", "0.002", base="ascii"),
    Row("restart: other number of cells", mesh((5, 4, 1)), "20 cells", "time 0.002", "24 cells", "put that mesh back",
        where="constant/polyMesh", base="ascii"),
    Row("restart: changed T", ("0.002/T", "internalField   nonuniform List<scalar> \n24\n(\n",
                                "internalField   nonuniform List<scalar> \n24\n(\n30 //"), "remove rhoU and rhoE",
        at="30 //", base="ascii"),
    Row("restart: rhoU is lost", remove("0.002/rhoU"), "rhoU", where="0.002", base="ascii"),
    Row("restart: nan in rhoE", lambda case: line_of_field(case, "0.002/rhoE", 4, "nan"), "'nan'", "expected a number",
        where="0.002/rhoE", at="nan", base="ascii"),
    Row("restart: negative energy", lambda case: line_of_field(case, "0.002/rhoE", 4, "-1"), "cell 4",
        where="0.002/T", base="ascii"),
]


def line_of_field(case, path, cell, text):
    path = os.path.join(case, path)
    with open(path) as f:
        lines = f.read().splitlines()
    lines[lines.index("(") + 1 + cell] = text
    with open(path, "w") as f:
        f.write("\n".join(lines) + "\n")


def two_layers(case):
    """The squares of the file, made into two layers of boxes between patches that are to be empty."""
    points = "".join(f"{1 + p + 6 * k} {p % 3} {p // 3} {k}\n" for k in range(3) for p in range(6))
    cells, low, high, side = [], [], [], []
    for k in range(2):
        for a in (1, 2):
            square = [a + 6 * k, a + 1 + 6 * k, a + 4 + 6 * k, a + 3 + 6 * k]
            cells.append("5 2 4 1 " + " ".join(map(str, square + [p + 6 for p in square])))
            low.append("3 2 1 1 " + " ".join(map(str, square)) if k == 0 else "")
            high.append("3 2 2 2 " + " ".join(str(p + 6) for p in square) if k == 1 else "")
        for a, b in ((1, 2), (2, 3), (4, 5), (5, 6), (1, 4), (3, 6)):
            side.append("3 2 3 3 " + " ".join(str(p + 6 * k) for p in (a, b, b + 6, a + 6)))
    elements = [e for e in low + high + side + cells if e]
    write("mesh.msh", '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n2 1 "emptyLow"\n2 2 "emptyHigh"\n'
          '2 3 "side"\n3 4 "gas"\n$EndPhysicalNames\n$Nodes\n18\n' + points + f"$EndNodes\n$Elements\n{len(elements)}\n"
          + "".join(f"{i + 1} {e}\n" for i, e in enumerate(elements)) + "$EndElements\n")(case)


MESH_FILE = [
    Row("msh: no file", remove("mesh.msh"), "No such file", where="mesh.msh"),
    Row("msh: no Physical Surface", write("mesh.msh", re.sub(r"\n[78] 3 2 3 .*", "", bad_case.MSH2).replace(
        "$Elements\n8", "$Elements\n6").replace('2 3 "gas"\n', "").replace("Names\n3", "Names\n2")), "lines only", "Physical Surface",
        "with -2", where="mesh.msh"),
    Row("msh: no mesh at all", write("mesh.msh", "solid cube\n"), "is this a .msh file?", where="mesh.msh"),
    Row("msh: empty", write("mesh.msh", ""), "empty", "2.2 or 4.1", where="mesh.msh"),
    Row("msh: version 3", ("mesh.msh", "2.2 0 8", "3 0 8"), "3", "2.2", "4.1"),
    Row("msh: version 4.0", ("mesh.msh", "2.2 0 8", "4 0 8"), "4", "2.2", "4.1"),
    Row("msh: cut in the nodes", ("mesh.msh", bad_case.MSH2[bad_case.MSH2.index("5 1 1 0"):], "5 1"), "6 nodes", "truncated",
        at="6\n1 0 0 0"),
    Row("msh: cut in the elements", ("mesh.msh", bad_case.MSH2[bad_case.MSH2.index("8 3 2"):], "8 3 2"), "the file ends",
        "truncated"),
    Row("msh: no elements", ("mesh.msh", bad_case.MSH2[bad_case.MSH2.index("$Elements"):], ""), "no elements", at=""),
    Row("msh: node that is not there", ("mesh.msh", "8 3 2 3 1 2 3 6 5", "8 3 2 3 1 2 3 6 9"), "node 9", "6 of $Nodes"),
    Row("msh: node that is no number", ("mesh.msh", "5 1 1 0\n6 2", "5 one 1 0\n6 2"), "'one'", "number"),
    Row("msh: nan", ("mesh.msh", "5 1 1 0\n6 2", "5 nan 1 0\n6 2"), "'nan'", "finite number"),
    Row("msh: wrong count", ("mesh.msh", "$Nodes\n6", "$Nodes\n5"), "$EndNodes", "count", at="6 2 1 0"),
    Row("msh: no physical groups", write("mesh.msh", re.sub(r" 2 (\d) \d ", r" 2 0 \1 ", re.sub(
        r"\$PhysicalNames.*EndPhysicalNames\n", "", bad_case.MSH2, flags=re.S))), "no physical groups",
        "Physical Curve", where="mesh.msh"),
    Row("msh: part of the boundary without a group", ("mesh.msh", "4 1 2 2 3 2 3", "4 1 2 0 3 2 3"),
        "1 of 10 boundary faces", "no physical group", "(1.5, 0, ", at=""),
    Row("msh: group without a name", ("mesh.msh", '1 2 "sides"', '1 3 "sides"'), "no name", "Physical Curve", at=""),
    Row("msh: name with a blank", ("mesh.msh", '"sides"', '"both sides"'), "letters, digits", "both_sides", at=""),
    Row("msh: second order", ("mesh.msh", "3 1 2 2 3 1 2\n", "3 8 2 2 3 1 2 4\n"), "line of 3 nodes",
        "Mesh.ElementOrder = 1"),
    Row("msh: not in a plane", ("mesh.msh", "6 2 1 0", "6 2 1 0.5"), "plane", at=""),
    Row("msh: two layers", two_layers, "one cell thick", "Layers{1}"),
    Row("meshDict: unknown patch", write("system/meshDict", "patches\n{\n    side { type wall; }\n}\n"),
        "no patch 'side'", "sides", where="system/meshDict", at="    side"),
    Row("meshDict: unknown type", write("system/meshDict", "patches\n{\n    sides { type wal; }\n}\n"), "'wal'",
        "allowed are patch wall", where="system/meshDict", at="    sides"),
    Row("meshDict: no ;", write("system/meshDict", "patches\n{\n    sides { type wall }\n}\n"), "missing ';'",
        where="system/meshDict", at="    sides"),
    Row("meshDict: unpaired cyclic", write("system/meshDict",
                                           "patches\n{\n    sides { type cyclic; neighbourPatch ends; }\n}\n"),
        "cyclic", "'ends'"),
    Row("meshDict: cyclic without its half", write("system/meshDict", "patches\n{\n    sides { type cyclic; }\n}\n"),
        "neighbourPatch", where="system/meshDict", at="    sides"),
    Row("meshDict: unknown key", write("system/meshDict", "patches\n{\n    sides { type wall; colour red; }\n}\n"),
        "'colour' is not used", where="system/meshDict", at="    sides"),
]



CONVERSION = [
    Row("VTK: no mesh", remove(MESH + "faces"), "No such file", where=MESH + "faces", base="ascii"),
    Row("VTK: cut field", cut("0/alpha", 0.5), where="0/alpha", base="ascii"),
    Row("VTK: wrong count", ("0/alpha", "24\n(", "25\n("), "25 entries", "has 24", at="", base="ascii"),
    Row("VTK: nan", ("0/alpha", "0.207", "nan"), "'nan'", "expected a number", base="ascii"),
    Row("VTK: class of a field", ("0/T", "volScalarField", "surfaceScalarField"), "surfaceScalarField", "volScalarField",
        at="", base="ascii"),
    Row("VTK: other number of cells", mesh((5, 4, 1)), "24 values", "20", where="0/alpha", base="ascii"),
]
