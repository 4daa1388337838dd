# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of a new case as texts. What an entry means is taken from the programs' own tables of keywords (-keywords)."""
import re
import subprocess

import numpy as np

from haff import paths
from haff.start import patches

CLASSES = {"alpha": "volScalarField", "T": "volScalarField", "U": "volVectorField", "g": "uniformDimensionedVectorField"}
OPENFOAM = "ddtSchemes gradSchemes divSchemes laplacianSchemes interpolationSchemes snGradSchemes".split()


class Keywords:
    """What a program says of its keywords."""

    def __init__(self, program):
        self.rows = {}
        text = subprocess.run([paths.program(program), "-keywords", "-markdown"], capture_output=True, text=True, check=True).stdout
        for place, table in re.findall(r"^### ([^\n]+)\n\n(.*?)(?:\n\n|\Z)", text, re.M | re.S):
            files, _, inside = place.partition(", type ")[0].partition(": ")
            for line in table.splitlines()[2:]:
                cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
                word = cells[1].removeprefix("word of ") if cells[0].startswith("&nbsp;") else ""
                name = re.search("`(.*)`", cells[0])[1]
                for file in files.split(", "):
                    self.rows.setdefault((file, inside, word or name, name if word else ""), cells[5].replace("\\|", "|"))

    def meaning(self, file, inside, name, value):
        """Of a word that the keyword takes, else of the keyword; empty where no table has it."""
        return self.rows.get((file, inside, name, value)) or self.rows.get((file, inside, name, ""), "")


class File:
    """One dictionary while it is written: entry by entry, each with its meaning."""

    def __init__(self, keywords, path):
        self.keywords, self.path, self.lines = keywords, path, []
        folder, name = path.split("/")
        self.lines += ["FoamFile", "{", "    version     2.0;", "    format      ascii;", f"    class       {CLASSES.get(name, 'dictionary')};",
                       f'    location    "{folder}";', f"    object      {name};", "}", ""]

    def note(self, text):
        self.lines.append(f"// {text}" if text else "")

    def entry(self, name, value, note="", inside="", indent=0):
        """NAME VALUE; // what it means. note: in place of what the table of keywords says."""
        said = note or self.keywords.meaning(self.path, inside, name, value)
        key = f'"{name}"' if re.search(r"[^\w.]", name) else name
        body = f"{'    ' * indent}{key:<{17 - 2 * indent}} {value}{'' if value.endswith('}') else ';'}"
        self.lines.append(f"{body:<44} // {said}" if said else body)

    def dictionary(self, name, entries, note=""):
        """NAME { .. } of (key, value) or (key, value, note)."""
        self.lines += [f"{name}" + (f" // {note}" if note else ""), "{"]
        for key, value, *own in entries:
            self.entry(key, value, *own, inside=name, indent=1)
        self.lines.append("}")

    def text(self):
        return "\n".join(line.rstrip() for line in self.lines) + "\n"


def field(keywords, name, flow, notes):
    """alpha, U or T of 0.orig."""
    f, which = File(keywords, f"0.orig/{name}"), ("alpha", "U", "T").index(name)
    f.note(("Volume fraction of the grains.", "Velocity of the flow.",
            "Granular temperature: the mean square of one component of the grains' random velocity, no kelvin.")[which])
    f.entry("dimensions", ("[0 0 0 0 0 0 0]", "[0 1 -1 0 0 0 0]", "[0 2 -2 0 0 0 0]")[which])
    if name == "alpha" and (flow.start or (flow.layer and not flow.settled)):
        f.entry("expression", f'"{flow.start_text}"', "where the grains lie at the start; almost none elsewhere")
    elif name == "alpha" and flow.settled:
        f.entry("settledLayer", f"{{ depth {flow.depth:g}; packing {flow.alpha_text}; }}",
                "a layer at rest on the floor, by the equation of state: so many grain diameters deep where it is packed so densely")
        if flow.waves_along:
            f.entry("perturbation", "{ modes 20; amplitude 1e-2; seed 1; of depth; }", "faint waves of its depth, of random phases, along a periodic axis")
    elif name == "alpha" and not flow.stream:
        f.entry("expression", f'"{flow.wave}"', "faint waves, from which clusters may grow; or  internalField uniform 0.2;")
    else:
        f.entry("internalField", f"uniform {(flow.alpha_text, flow.velocity_text, flow.T_text)[which]}", "in all cells" + (
            f": the stream has Mach number {flow.Mach:g}" if name == "T" and flow.stream else ""))
    f.lines += ["boundaryField", "{"]
    for p in flow.geometry.patches:
        rule = patches.rules(p, flow.kind[p.name], flow)[which]
        f.lines.append(f"    {p.name:<14} {{ {rule} }} // {notes.get(p.name) or patches.KINDS[flow.kind[p.name]]}")
    f.lines.append("}")
    return f.text()


def units(keywords, flow):
    f = File(keywords, "system/units")
    f.note("What the numbers of this case are measured in: the labels of its pictures and reports. \"\": no label.")
    length, time = flow.units
    why = f"for gravity is {np.linalg.norm(flow.g):g}" if length else 'of the mesh; or  m, cm, "grain diameters", ..'
    f.entry("length", length or '""', why)
    f.entry("mass", '""', "a grain has the mass 1, so that rho counts grains")
    f.entry("time", time or '""', why if time else "or  s, ..")
    return f.text()


def properties(keywords, flow):
    f = File(keywords, "constant/granularProperties")
    f.note("The grains and their gas. Units are those of the mesh; a grain has the mass 1, so that rho counts grains.")
    f.dictionary("grain", [("diameter", f"{flow.diameter:g}"), ("mass", "1"), ("restitution", f"{flow.restitution:g}"),
                           ("thresholdSpeed", f"{flow.threshold:g}",
                            *(["sqrt(g diameter): slower impacts are elastic, so that packed gas stays warm and its sound slow; less is stiffer, with shorter steps"] if flow.falls and not flow.grains else []))])
    f.note("")
    f.entry("equationOfState", f"Torquato{'Disks' if flow.d == 2 else 'Spheres'}")
    f.entry("cooling", "GarzoDufty" if flow.restitution < 1 else "none")
    f.entry("transport", "GarzoDufty" if flow.transport else "none")
    if flow.friction:
        f.dictionary("friction", [("type", "muI"), ("muStatic", "0.38"), ("muDynamic", "0.64"), ("I0", "0.279")], "of grains that stay in contact, here glass beads; without it a heap goes flat")
    return f.text()


def gravity(keywords, flow):
    f = File(keywords, "constant/g")
    f.entry("dimensions", "[0 1 -2 0 0 0 0]", "m/s^2" if flow.units[0] == "m" else "length over time squared")
    f.entry("value", f"({' '.join(f'{x + 0.0:g}' for x in flow.g)})")
    return f.text()


def shaking(keywords, flow):
    f = File(keywords, "constant/shaking")
    f.note("The plate is shaken along gravity, and the case lies in its frame.")
    f.entry("type", "sinusoidal")
    f.entry("amplitude", f"{flow.o.shaking[0]:g}", "largest acceleration of the plate over that of gravity")
    f.entry("frequency", f"{flow.o.shaking[1]:g}")
    f.entry("phase", "1.5707963267948966", "the plate begins to move upwards, from its middle")
    return f.text()


def particles(keywords, flow):
    f = File(keywords, "constant/particleProperties")
    f.note("The number of grains is that of alpha of the start, or  N 1000;")
    f.entry("seed", "1")
    f.entry("writeCloud", "yes")
    if flow.soft:
        f.dictionary("contact", [("type", "linear"), ("stiffness", f"{flow.stiffness:g}", "the fastest impact overlaps two grains by a hundredth of their diameter"),
                                 ("friction", "0.5"), ("tangentialDamping", "0.5")], "how grains repel each other; walls are as grains")
    f.dictionary("coarseGraining", [("kernel", "cell"), ("window", "0"), ("samples", "10")], "how fields are made of grains")
    return f.text()


def control(keywords, flow, version):
    f = File(keywords, "system/controlDict")
    f.entry("application", flow.o.application)
    f.entry("haffVersion", version, "the version of haff that this case was written for")
    f.note("")
    f.entry("startFrom", "latestTime", "a run that was stopped goes on; the first starts from 0.orig")
    if flow.start:
        f.entry("acceptWarnings", "(dampedSound)", "how the grains flow and rest is wanted here, not the sound in them")
    f.entry("stopAt", "endTime", "or writeNow, which stops a run that is going on")
    f.entry("endTime", f"{flow.end:.12g}")
    f.note("")
    f.entry("deltaT", f"{flow.interval / 100:g}", "for OpenFOAM's tools; grains have steps of their own, or none" if flow.grains else "the most for the first step")
    f.entry("adjustTimeStep", "yes")
    f.entry("maxCo", "1")
    f.note("")
    f.entry("writeControl", "adjustableRunTime", "writeInterval counts time, and steps end on it")
    f.entry("writeInterval", f"{flow.interval:.12g}", "time between two written times")
    f.entry("writeFormat", "binary", "or ascii")
    f.entry("timePrecision", "8")
    f.note("")
    f.note(f"What is measured while the case runs; {flow.o.application} -listModels lists the types.")
    f.lines += ["functions", "{"]
    for name, body, note in flow.o.problem.functions if flow.o.problem else ():
        f.lines.append(f"    // {note}: postProcessing/{name}")
        f.lines.append(f"    {name} {body}")
    bodies = [p.name for p in flow.geometry.patches if flow.kind[p.name] == "body"]
    if bodies and not flow.grains:
        f.entry("forces", f"{{ type forces; patches ({' '.join(bodies)}); CofR (0 0 0); }}", "force.dat, moment.dat in postProcessing/forces/0", indent=1)
    f.lines.append("}")
    return f.text()


def schemes(keywords, flow):
    f = File(keywords, "system/fvSchemes")
    f.entry("fluxScheme", "common")
    if flow.geometry.lattice:
        f.entry("reconstruct", "WPENO5")
    else:
        f.entry("polyReconstruct", "CWENO3")
        if flow.falls:
            f.note("linear, of second order, takes a third of the time.")
    f.entry("timeScheme", "SSPRK43")
    f.note("")
    f.note("OpenFOAM's own tools want these to be there.")
    f.lines += [f"{name} {{}}" for name in OPENFOAM]
    return f.text()


def solution(keywords, flow):
    f = File(keywords, "system/fvSolution")
    if flow.start:
        f.entry("acoustics", "{ type implicit; }", "dense gas takes implicit steps, as friction asks for; they are as long as its flow allows")
    elif flow.stream:
        f.entry("acoustics", "{ type explicit; }", "steps follow each wave of sound: for shocks; automatic: dense slow gas takes longer ones")
    elif flow.falls and not flow.geometry.lattice:
        f.entry("acoustics", "{ type automatic; automaticCoeffs { gain 2; } }",
                "dense gas takes implicit steps where they are twice as long, for on this mesh they cost little more; explicit: for shocks in dense gas")
    else:
        f.entry("acoustics", "{ type automatic; }", "dense gas that comes to rest takes implicit steps; explicit: for shocks in dense gas")
    if flow.transport:
        f.entry("diffusion", "{ type RKJ2; }", keywords.meaning("system/fvSolution", "diffusion", "type", "RKJ2"))
    floor = [("alphaFloor", "1e-6", "gas that falls leaves hot near vacuum, which would limit the steps: alpha stays above it, and the mass that adds is counted")]
    f.dictionary("limits", [("minDeltaTFraction", "0.001")] + (floor if flow.falls else []))
    return f.text()


def mesh_rules(keywords, flow, pairs):
    """system/meshDict, or None where names say all."""
    f = File(keywords, "system/meshDict")
    f.note("Types of the patches, for gmshToCase; those that are not here are of type patch, or empty where the mesh was extruded.")
    f.lines += ["patches", "{"]
    known = len(f.lines)
    for p in flow.geometry.patches:
        kind = flow.kind[p.name]
        wanted = patches.mesh_type(p, kind)
        if wanted not in ("patch", "empty") or (wanted == "empty" and not p.extruded):
            other = f" neighbourPatch {pairs[p.name]};" if wanted == "cyclic" else ""
            f.lines.append(f"    {p.name:<14} {{ type {wanted};{other} }}")
    if len(f.lines) == known and not flow.o.round:
        return None
    f.lines.append("}")
    if flow.o.round:
        f.entry("axis", "{ direction (1 0 0); }", "the mesh stands for the body of revolution about it")
    return f.text()


def all_run(flow, from_geo):
    gmsh = "    gmsh -3 mesh.geo -o mesh.msh || exit 1\n" if from_geo else ""
    source = "mesh.geo" if from_geo else "mesh.msh"
    log = f"log.{flow.o.application}"
    return f"""#!/bin/sh
# Makes the mesh where it is older than {source}, and runs the case: ./Allrun -np 4 takes four ranks. A run that has ended stays as it is.
cd "$(dirname "$0")" || exit 1
if [ ! -f constant/polyMesh/boundary ] || [ {source} -nt constant/polyMesh/boundary ]; then
{gmsh}    gmshToCase mesh.msh -case . || exit 1
fi
report() {{
    if command -v haff >/dev/null && report=$(haff report "$PWD"); then echo "The report is $report"; fi
}}
echo "The log is {log}; to see how the run goes: haffLog '$PWD' -follow"
[ ! -f {log} ] || mv {log} log.before # of the start before
if ! {flow.o.application} -case . "$@" >{log} 2>&1; then
    tail -n 20 {log}
    report 2>/dev/null # where there are times to show
    exit 1
fi
if grep -q '^nothing to do: ' {log}; then
    changed=$(sed -n '/^Changed since/,/^nothing to do/{{/^    haff: /d;/^    /p;}}' {log}; find 0.orig -type f -newer log.before 2>/dev/null)
    [ ! -f log.before ] || mv log.before {log}
    if [ -n "$changed" ]; then
        printf '%s\\n' "The run has reached its end, and this has changed since:" "$changed" "Nothing was run. To run it again:  ./Allclean && ./Allrun"
        exit 1
    fi
    echo "The run has reached its end: nothing was run. To run it again:  ./Allclean && ./Allrun"
else
    tail -n 2 {log}
fi
report
"""


ALL_CLEAN = """#!/bin/sh
# Removes what runs made; mesh and dictionaries stay.
cd "$(dirname "$0")" || exit 1
rm -rf 0 [1-9]* 0.[0-9]* postProcessing VTK diverged dem log.*
"""


def files(flow, pairs, notes, version, from_geo):
    """{path in the case: text} of the whole case but its mesh."""
    keywords = Keywords(flow.o.application)
    found = {f"0.orig/{name}": field(Keywords("granularGas") if flow.grains else keywords, name, flow, notes) for name in ("alpha", "U", "T")}
    found.update({"constant/granularProperties": properties(Keywords("granularGas"), flow), "system/controlDict": control(keywords, flow, version),
                  "system/fvSchemes": schemes(Keywords("granularGas"), flow), "system/fvSolution": solution(Keywords("granularGas"), flow),
                  "system/units": units(keywords, flow)})
    if flow.g.any():
        found["constant/g"] = gravity(keywords, flow)
    if flow.o.shaking:
        found["constant/shaking"] = shaking(keywords, flow)
    if flow.grains:
        found["constant/particleProperties"] = particles(keywords, flow)
    rules = mesh_rules(keywords, flow, pairs)
    if rules:
        found["system/meshDict"] = rules
    found.update({"Allrun": all_run(flow, from_geo), "Allclean": ALL_CLEAN, "case.foam": ""})
    return found
