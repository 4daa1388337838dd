# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a case of OpenFOAM as haff reads it: its polyMesh, its blockMeshDict, or what OpenFOAM's blockMesh makes of that."""
import os
import re
import shutil
import subprocess
import tempfile
import warnings

import numpy as np

from haff.case import entries, foam
from haff.case.blocks import mesh_of
from haff.case.foam import FormatError
from haff.openfoam import dictionary
from haff.openfoam.report import Refused

ALLOWED = ("patch", "wall", "empty", "symmetry", "symmetryPlane", "cyclic", "wedge")
CURES = {"processor": "the case is decomposed: run reconstructParMesh and reconstructPar first",
         "cyclicAMI": "haff joins patches whose faces fit one to one: mesh both sides alike, and make them cyclic"}
LEFTOVER = "defaultFaces"
PARTS = ("points", "faces", "owner", "neighbour")
ENVIRONMENT = {**os.environ, "WM_PROJECT_DIR": os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam")}
CONTROL = "application blockMesh; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;\n"


class Patch:
    """name, as haff has it; old: as OpenFOAM has it; type and groups; neighbour of a cyclic one; first and count of its faces."""

    def __init__(self, name, entry):
        self.name = self.old = name
        self.entry, self.place = entry, entry.place
        self.type, self.neighbour = str(entry.get("type", "patch")), entry.get("neighbourPatch")
        self.groups = re.findall(r"[\w.:]+", re.sub(r"List<word>|\d+\s*\(", " ", entry.get("inGroups", "")))
        self.first = self.count = 0

    @property
    def names(self):
        """Under which a field may have an entry for it: its own, those of its groups, its type."""
        return [self.old, *self.groups, self.type]


def listed(value, place):
    """The Patches of a list NAME { .. } NAME { .. } with brackets around it and maybe a count before it."""
    inside = re.fullmatch(r"\s*\d*\s*\((.*)\)\s*", value, re.S)
    if not inside:
        raise FormatError(f"{place}: no list of patches")
    found = dictionary.parse(inside[1], place)
    if not found or not all(isinstance(d, dictionary.Dictionary) for d in found.values()):
        raise FormatError(f"{place}: no list  NAME {{ type ..; }}")
    return [Patch(name, d) for name, d in found.items()]


def boundary_text(path):
    return re.sub(r"^.*?FoamFile\s*\{.*?\}", "", dictionary.decoded(path), count=1, flags=re.S)


def without_comments(text):
    return re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.S)


def block_mesh(case):
    """Makes constant/polyMesh of system/blockMeshDict by blockMesh; says why that failed, or "". The case gets a controlDict of OpenFOAM's: give a copy."""
    foam.write_dictionary(case, "system", "controlDict", CONTROL)
    done = subprocess.run(["blockMesh", "-case", case], capture_output=True, text=True, env=ENVIRONMENT)
    return " ".join((done.stderr or done.stdout).split())[:600] if done.returncode else ""


def box_mesh(case):
    """Of system/blockMeshDict. FormatError where its blocks are no boxes, collapsed ones among them."""
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return mesh_of(case)


class Converted:
    """The mesh in the folder of the new case. patches; mesh: a haff.case.mesh.Mesh; write_types() writes the types as they are then."""

    def __init__(self, case, new, report, by_block_mesh=False):
        self.case, self.new, self.report = case, new, report
        poly = os.path.join(case, "constant", "polyMesh")
        blocks = next((p for p in (os.path.join(case, "system", "blockMeshDict"), os.path.join(poly, "blockMeshDict")) if os.path.exists(p)), None)
        self.blocks = False
        if all(os.path.exists(p := os.path.join(poly, name)) or os.path.exists(p + ".gz") for name in (*PARTS, "boundary")):
            report.took("constant/polyMesh", "the mesh, as it is" + ("; blockMeshDict, from which it was made, is left out" if blocks else ""))
            self.take(poly)
        elif blocks and not by_block_mesh and self.boxes(blocks):
            pass
        elif blocks:
            self.call_block_mesh(blocks)
        else:
            raise Refused(f"{case}: there is neither constant/polyMesh nor system/blockMeshDict: make the mesh first, as the case's Allrun does")
        self.measure()

    def boxes(self, path):
        """Whether haff reads the dictionary itself."""
        target = os.path.join(self.new, "system", "blockMeshDict")
        os.makedirs(os.path.dirname(target), exist_ok=True)
        where = os.path.relpath(path, self.case)
        try:
            d = dictionary.read(path, self.case)
            self.patches = listed(d.get("boundary", ""), where)
            for p in self.patches:
                p.place = f"{where}, {p.old}"
            shutil.copyfile(path, target)
            default = d.get("defaultPatch", {})
            rest = Patch(LEFTOVER, dictionary.Dictionary(where))
            rest.old, rest.type = default.get("name", LEFTOVER), default.get("type", "empty")
            rest.name = self.free_name(rest)
            with open(target, "a", encoding="latin-1") as f:
                f.write(f"\ndefaultPatch {{ name {rest.name}; type {rest.type}; }}\n")
            found = box_mesh(self.new)
            if rest.name not in found.patches:
                shutil.copyfile(path, target)
                found = box_mesh(self.new)
            else:
                self.patches.append(rest)
                self.report.changed(where, f"the sides that `boundary` leaves, {rest.old} -> the patch {rest.name} of type {rest.type}")
        except (ValueError, LookupError, TypeError) as why:  # FormatError is a ValueError
            self.why = str(why).split(": ")[-1]
            if os.path.exists(target):
                os.remove(target)
            return False
        self.blocks = True
        self.report.took(where, f"{found.cells} cells, equal boxes: haff reads it as it is")
        return True

    def free_name(self, patch):
        """defaultFaces gets a name that says what it is."""
        if patch.old != LEFTOVER:
            return patch.old
        taken, wanted = [p.old for p in self.patches], "frontAndBack" if patch.type == "empty" else "otherFaces"
        return next(name for name in (wanted, *(f"{wanted}{k}" for k in range(2, 99))) if name not in taken)

    def call_block_mesh(self, path):
        where, why = os.path.relpath(path, self.case), getattr(self, "why", "haff does not read it")
        if not shutil.which("blockMesh"):
            raise Refused(f"{where}: haff does not read it as it is ({why}), and OpenFOAM's blockMesh is not there: run blockMesh in the case, or install "
                          "Debian's package openfoam")
        with tempfile.TemporaryDirectory(prefix="blockMesh") as folder:
            for part in ("system", "constant"):
                if os.path.isdir(os.path.join(self.case, part)):
                    shutil.copytree(os.path.join(self.case, part), os.path.join(folder, part), ignore=shutil.ignore_patterns("polyMesh"))
            if not os.path.exists(os.path.join(folder, "system", "blockMeshDict")):
                shutil.copyfile(path, os.path.join(folder, "system", "blockMeshDict"))
            failed = block_mesh(folder)
            if failed:
                raise Refused(f"{where}: blockMesh failed: {failed}")
            self.report.changed(where, f"OpenFOAM's blockMesh -> constant/polyMesh (as it is haff does not read it: {why})")
            self.take(os.path.join(folder, "constant", "polyMesh"))

    def take(self, poly):
        target = os.path.join(self.new, "constant", "polyMesh")
        os.makedirs(target, exist_ok=True)
        for name in PARTS:
            for file in (name, name + ".gz"):
                if os.path.exists(os.path.join(poly, file)):
                    shutil.copyfile(os.path.join(poly, file), os.path.join(target, file))
        self.patches = listed(without_comments(boundary_text(os.path.join(poly, "boundary"))), "constant/polyMesh/boundary")
        for p in self.patches:
            p.place = f"constant/polyMesh/boundary, {p.old}"
            p.first, p.count = (int(dictionary.number(p.entry, key)) for key in ("startFace", "nFaces"))
        for p in [p for p in self.patches if p.old == LEFTOVER and p.count]:
            p.name = self.free_name(p)
            self.report.changed("constant/polyMesh/boundary", f"{p.old} -> the patch {p.name}, of type {p.type}")
        self.check_types()
        self.write_boundary()

    def check_types(self):
        for p in self.patches:
            if p.type == "cyclic" and not p.neighbour:
                raise Refused(f"{p.place}: cyclic without a neighbourPatch: OpenFOAM before 2.0 wrote it so; foamUpgradeCyclics converts it")
            if p.type not in ALLOWED:
                kind = "cyclicAMI" if p.type.startswith("cyclic") else p.type
                raise Refused(f"{p.place}: patch {p.old} has the type {p.type}; {CURES.get(kind, 'haff has no such patch')} (haff has: {' '.join(ALLOWED)})")

    def write_boundary(self):
        rows = []
        for p in self.patches:
            more = f" neighbourPatch {p.neighbour}; matchTolerance {p.entry.get('matchTolerance', '1e-4')}; transform unknown;" if p.type == "cyclic" else ""
            rows.append(f"    {p.name} {{ type {p.type}; nFaces {p.count}; startFace {p.first};{more} }}\n")
        with open(os.path.join(self.new, "constant", "polyMesh", "boundary"), "w", encoding="latin-1") as f:
            f.write(foam.header("polyBoundaryMesh", "boundary") + f"\n{len(rows)}\n(\n{''.join(rows)})\n")

    def measure(self):
        self.check_types()
        self.mesh = mesh_of(self.new)
        for p in self.patches:
            _, p.first, p.count = self.mesh.patches[p.name]

    def has_corners(self):
        """Is it a lattice with corners that point into the gas: a box less a part?"""
        lattice = self.mesh.lattice
        return bool(lattice) and self.mesh.cells < np.prod([len(edges) - 1 for edges in lattice.edges])

    def change(self, patch, kind, why):
        """Another type."""
        self.report.changed(patch.place, f"patch {patch.old}: type {patch.type} -> {kind}, {why}")
        patch.type = kind
        if not self.blocks:
            self.write_boundary()
            return
        path = os.path.join(self.new, "system", "blockMeshDict")
        text = entries.read(path)
        start = re.search(r"\bboundary\b", text).end()
        part = re.compile(rf"(\b{re.escape(patch.old)}\s*\{{[^{{}}]*?\btype\s+)\w+(\s*;)").sub(rf"\g<1>{kind}\g<2>", text[start:], count=1)
        with open(path, "w", encoding="latin-1", newline="") as f:
            f.write(text[:start] + part)
