# SPDX-License-Identifier: GPL-3.0-or-later
"""The rhoCentralFoam twin of a granularGas case: the same mesh, initial state, patches and end time, for a gas that both know.

    twin = Twin("cases/sod", "twins", "build/bin", cells=100)
    twin.ours, twin.foam            # two case folders; nothing has run in them but one step of no length
    twin.end, twin.gamma

The gas must be dilute and elastic: a perfect gas, or so few grains that their pressure is a perfect gas's to DILUTE. The
initial state and the patches' rules are read from what granularGas itself writes, so every form it accepts will do.
"""
import os
import re
import shutil
import subprocess
import tempfile

import numpy as np

import haff
from haff.openfoam.mesh import block_mesh
from studies.made import rhocentral

DILUTE = 1e-3
CONSTRAINTS = ("empty", "cyclic", "symmetryPlane", "symmetry", "wedge")
WALLS = ("slip", "symmetry", "symmetryPlane")


class Refused(Exception):
    """The case has no twin, or cannot be read; says why and what would help."""


def called(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise Refused((done.stderr or done.stdout).strip()[-2000:])
    return done.stdout


def append(path, text):
    """Of two entries the last one counts."""
    with open(path, "a") as f:
        f.write(text)


def make_mesh(case, programs, cells=None):
    """constant/polyMesh from mesh.geo, with N = cells, or from system/blockMeshDict."""
    blocks = os.path.exists(os.path.join(case, "system", "blockMeshDict"))
    if blocks and not cells:
        return make_blocks(case)
    if not os.path.exists(os.path.join(case, "mesh.geo")):
        if blocks:
            raise Refused(f"{case}: system/blockMeshDict has no number N: leave out --grids, and the mesh that it says is taken")
        raise Refused(f"{case}: no mesh.geo to make {'a grid of N = %d' % cells if cells else 'constant/polyMesh'} from")
    size = ["-setnumber", "N", str(cells)] if cells else []
    msh = os.path.join(case, "mesh.msh")
    called("gmsh", "-3", "-v", "2", *size, os.path.join(case, "mesh.geo"), "-o", msh)
    called(os.path.join(programs, "gmshToCase"), msh, "-case", case)
    os.remove(msh)


def make_blocks(case):
    """constant/polyMesh as OpenFOAM's blockMesh makes it."""
    with tempfile.TemporaryDirectory(prefix="blockMesh") as folder:
        shutil.copytree(os.path.join(case, "system"), os.path.join(folder, "system"))
        why = block_mesh(folder)
        if why:
            raise Refused(f"{os.path.join(case, 'system', 'blockMeshDict')}: blockMesh failed: {why}")
        shutil.move(os.path.join(folder, "constant", "polyMesh"), os.path.join(case, "constant", "polyMesh"))


def copy(case, target, programs, cells=None):
    """The case as it starts, on its own mesh, or that of mesh.geo with N = cells; times other than 0 stay behind."""
    shutil.rmtree(target, ignore_errors=True)
    for name in ("0.orig", "0", "constant", "system", "mesh.geo"):
        source = os.path.join(case, name)
        if os.path.isdir(source):
            shutil.copytree(source, os.path.join(target, name), ignore=shutil.ignore_patterns("polyMesh") if cells else None)
        elif os.path.exists(source):
            shutil.copy(source, target)
    if not os.path.isdir(os.path.join(target, "constant", "polyMesh")):
        make_mesh(target, programs, cells)


def models(case, programs):
    """What checkCase says of the models: {name: value as text}, gamma with all its digits; and endTime."""
    text = called(os.path.join(programs, "checkCase"), case)
    block = text.split("\nModels\n")[1].split("\nControl\n")[0]
    found = {line.split()[0]: line.split(None, 1)[1].strip() for line in block.splitlines() if len(line.split()) > 1}
    found["gamma"] = (re.findall(r"^ +gamma ([^;\n]+);", text, re.M) or [found["gamma"]])[0]
    return found, float(re.findall(r"^endTime ([^;]+);", text, re.M)[0])


def refuse_others(case, found):
    """Names the key that takes the gas out of the elastic limit; the density is checked later."""
    properties = os.path.join(case, "constant", "granularProperties")
    if found["cooling"] != "none" and float(found.get("restitution", 1)) < 1:
        raise Refused(f"{properties}: cooling {found['cooling']} with restitution {found['restitution']} takes energy away, and "
                      "rhoCentralFoam knows no sink; needed: restitution 1, or cooling none")
    if found.get("transport", "none") != "none":
        raise Refused(f"{properties}: transport {found['transport']}; the twin is inviscid; needed: transport none")
    if np.any(np.array(re.findall(r"[-+.\deE]+", found.get("gravity", "0")), float) != 0):
        raise Refused(f"{os.path.join(case, 'constant', 'g')}: gravity {found['gravity']}, and rhoCentralFoam knows none; needed: no "
                      "gravity")


def refuse_dense(case, found, alpha):
    if found["equationOfState"] == "perfectGas":
        return
    more = 2 * (1 + float(found["restitution"])) * alpha.max()
    if more > DILUTE:
        sigma = float(found["diameter"]) * (DILUTE / more) ** (1 / 3)
        raise Refused(f"{os.path.join(case, 'constant', 'granularProperties')}: equationOfState {found['equationOfState']} at a "
                      f"volume fraction of {alpha.max():.3g} has a pressure {more:.1%} above the perfect gas's, which is all that "
                      f"rhoCentralFoam knows; needed: equationOfState perfectGas, or grain diameter {sigma:.2g} or less")


class Rules:
    """boundaryField of a field that granularGas wrote in ascii: {patch: (type, value or None)}."""

    def __init__(self, path):
        self.path = path
        text = haff.read_bytes(path).decode()
        block = text[text.rindex("boundaryField"):]
        self.patches = {name: self.rule(body) for name, body in re.findall(r"^    (\S+)\s*\{(.*?)^    \}", block, re.M | re.S)}

    @staticmethod
    def rule(body):
        kind = re.search(r"\btype\s+(\w+)\s*;", body).group(1)
        value = re.search(r"\b(?:value|inletValue)\s+(uniform|nonuniform)\s*(List<\w+>\s*\d*)?\s*([^;]*);", body)
        if not value:
            return kind, None
        numbers = np.array(re.sub(r"[()]", " ", value.group(3)).split(), float)
        width = 3 if "vector" in (value.group(2) or "") else 1
        return kind, numbers if value.group(1) == "uniform" else numbers.reshape(-1, width)


def as_entry(value):
    row = lambda v: "%.17g" % v[0] if len(v) == 1 else "(%.17g %.17g %.17g)" % tuple(v)
    if value.ndim == 1:
        return "uniform " + row(value)
    kind = "vector" if value.shape[1] == 3 else "scalar"
    return f"nonuniform List<{kind}> {len(value)}({' '.join(map(row, value))})"


def with_value(kind, value):
    if kind == "inletOutlet":
        return f"inletOutlet; inletValue {as_entry(value)}; value {as_entry(value)}"
    return kind if value is None else f"{kind}; value {as_entry(value)}"


def translate(patch, mesh_kind, velocity, density, energy, pressure):
    """{"p", "U", "T": rule} of a patch. velocity, density, energy: (type, value); energy is p's if pressure, else T's."""
    if mesh_kind in CONSTRAINTS:
        return dict.fromkeys(("p", "U", "T"), mesh_kind)
    if velocity[0] in WALLS:
        return {"p": "zeroGradient", "U": "slip", "T": "zeroGradient"}
    if velocity[0] == "noSlip":
        raise Refused(f"patch {patch}: U noSlip turns the whole velocity, which an inviscid rhoCentralFoam does not; needed: slip")
    if density[0] != energy[0]:
        raise Refused(f"patch {patch}: rho {density[0]} with {'p' if pressure else 'T'} {energy[0]} has no counterpart for p and T; "
                      "needed: the same type for both")
    p = T = energy[1]
    if p is not None:
        p, T = (p, p / density[1]) if pressure else (density[1] * T, T)
    return {"p": with_value(density[0], p), "T": with_value(density[0], T), "U": with_value(*velocity)}


class Twin:
    def __init__(self, case, folder, programs, courant=0.1, cells=None):
        name = os.path.basename(os.path.abspath(case))
        self.ours, self.foam = os.path.join(folder, name), os.path.join(folder, name + "-rhoCentralFoam")
        copy(case, self.ours, programs, cells)
        found, self.end = models(self.ours, programs)
        refuse_others(case, found)
        self.gamma = float(found["gamma"])
        self.start(case, programs, found, courant)
        append(os.path.join(self.ours, "system", "controlDict"),
               f"\n// at the end only\nwriteControl adjustableRunTime; writeInterval {self.end!r}; startFrom startTime; startTime 0; "
               "stopAt endTime; writeFormat binary;\n#remove functions\n")

    def start(self, case, programs, found, courant):
        """The twin, from what granularGas writes after a step of no length."""
        first = os.path.join(self.ours, "start")
        copy(self.ours, first, programs)
        append(os.path.join(first, "system", "controlDict"),
               "\nadjustTimeStep no; deltaT 1e-30; startFrom startTime; startTime 0; stopAt writeNow; writeFormat ascii;\n"
               "writePrecision 17; timeFormat general; #remove functions\n")
        called(os.path.join(programs, "granularGas"), "-case", first)
        written = haff.Case(first)
        state = {name: written.field(name) for name in ("alpha", "U", "T", "p")}
        refuse_dense(case, found, state.pop("alpha"))
        rules = {name: Rules(os.path.join(first, written.times[-1], name)).patches for name in ("rho", "U", "T", "p")}
        each = {}
        for patch, (kind, _, _) in written.mesh.patches.items():
            pressure = rules["p"][patch][0] != "calculated"
            each[patch] = translate(patch, kind, rules["U"][patch], rules["rho"][patch], rules["p" if pressure else "T"][patch], pressure)
        shutil.rmtree(self.foam, ignore_errors=True)
        shutil.copytree(os.path.join(self.ours, "constant", "polyMesh"), os.path.join(self.foam, "constant", "polyMesh"))
        rhocentral.write(self.foam, self.gamma, self.end, courant, state,
                         {name: {patch: rule[name] for patch, rule in each.items()} for name in ("p", "U", "T")})
        shutil.rmtree(first)
