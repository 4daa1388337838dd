# SPDX-License-Identifier: GPL-3.0-or-later
"""The start: p, T (kelvin) and U of a time folder, with setFieldsDict, as rho, U and one of T (R times kelvin) and p."""
import os

import numpy as np

from haff.case import foam
from haff.openfoam import dictionary, patches, setFields, values
from haff.openfoam.dictionary import number
from haff.openfoam.report import Refused

DIMENSIONS = {"p": [1, -1, -2, 0], "T": [0, 0, 0, 1], "U": [0, 1, -1, 0]}


def folder_of(case, control):
    """The time folder that a run would start from; 0.orig where there is no 0."""
    times = foam.times_in(case)
    start = number(control, "startTime", default=0)
    how = control.get("startFrom", "latestTime")
    if how == "startTime":
        times = [t for t in times if abs(float(t) - start) < 1e-9 * max(1, abs(start))]
    if times:
        return times[-1] if how == "latestTime" else times[0]
    if os.path.isdir(os.path.join(case, "0.orig")) and (how != "startTime" or start == 0):
        return "0.orig"
    if os.path.isdir(os.path.join(case, "processor0")):
        raise Refused(f"{case}: the case is decomposed, and has no time to start from beside its processor folders: run reconstructPar first")
    raise Refused(f"{case}: there is no time to start from: neither 0 nor 0.orig" + (f", and startTime is {start:g}" if start else ""))


class State:
    """p, T, U of the cells: [1] or [cells][1], U [3] or [cells][3]; boundary: {name: Dictionary of boundaryField}."""

    def __init__(self, case, control, mesh, report):
        self.case, self.report, self.mesh = case, report, mesh
        self.folder = folder_of(case, control)
        self.cells, self.boundary = {}, {}
        for name in ("p", "T", "U"):
            self.read(name)
        self.set_fields()
        for name in ("p", "T"):
            if not (self.cells[name] > 0).all():
                raise Refused(f"{self.folder}/{name}: {self.cells[name].min():g} in a cell: {name} must be positive"
                              + (" (is it set by setFields? The case has no setFieldsDict)" if self.folder == "0.orig" else ""))

    def read(self, name):
        path = os.path.join(self.case, self.folder, name)
        if not os.path.exists(path) and not os.path.exists(path + ".gz"):
            raise Refused(f"{self.folder}/{name}: no such file; p, T and U make a start of a compressible gas")
        d = dictionary.read_field(path, self.case)
        self.check_dimensions(d, name)
        for key in ("internalField", "boundaryField"):
            if key not in d:
                raise Refused(f"{self.folder}/{name}: there is no {key}")
        found = values.value_of(d["internalField"], d.lists)
        wanted = 3 if name == "U" else 1
        if found.shape[-1] != wanted or (found.ndim == 2 and len(found) not in (1, self.mesh.cells)):
            raise Refused(f"{d['internalField'].place}: {name} has {found.size // found.shape[-1]} values of {found.shape[-1]} components on a mesh of "
                          f"{self.mesh.cells} cells")
        self.cells[name], self.boundary[name] = found, d["boundaryField"]

    def check_dimensions(self, d, name):
        text = d.get("dimensions", "")
        try:
            exponents = [float(x) for x in text.strip("[] ").split()][:4]
        except ValueError:
            return  # units by their names
        if name == "T" and exponents[:3] == [0, 2, -2]:  # of a gas whose R is 1, as crossCheck writes it; rhoCentralFoam does not look
            return
        if exponents != DIMENSIONS[name] and any(exponents):
            why = "p over rho, of an incompressible solver" if name == "p" and exponents[:3] == [0, 2, -2] else f"{DIMENSIONS[name]} were expected"
            raise Refused(f"{d['dimensions'].place}: dimensions {text} of {name}: {why}")

    def set_fields(self):
        path = os.path.join(self.case, "system", "setFieldsDict")
        if not os.path.exists(path):
            return
        if any(v.ndim == 2 for v in self.cells.values()):
            self.report.dropped("system/setFieldsDict", f"{self.folder} has values cell by cell already")
            return
        fields = {name: np.tile(v, (self.mesh.cells, 1)).astype(float) for name, v in self.cells.items()}
        setFields.apply(path, self.case, fields, self.centres(), self.report)
        self.cells = fields

    def centres(self):
        lattice = self.mesh.lattice
        return lattice.centres() if lattice else self.mesh.cell_geometry()[0]


UNITS = {"rho": "[1 -3 0 0 0 0 0]", "T": "[0 2 -2 0 0 0 0]", "p": "[1 -1 -2 0 0 0 0]", "U": "[0 1 -1 0 0 0 0]"}


def write(new, folder, name, cells, entries, note):
    """A field file."""
    rows = "\n".join(f"    {patch} {{ {entry} }}" for patch, entry in entries.items())
    os.makedirs(os.path.join(new, folder), exist_ok=True)
    with open(os.path.join(new, folder, name), "w") as f:
        f.write(foam.header("volVectorField" if name == "U" else "volScalarField", name, folder)
                + f"\n// {note}\ndimensions {UNITS[name]};\ninternalField {values.as_entry(cells)};\nboundaryField\n{{\n{rows}\n}}\n")


def convert(case, new, control, mesh, gas, report):
    """Writes rho, U and T or p of the start."""
    state = State(case, control, mesh.mesh, report)
    p, T = state.cells["p"], state.cells["T"]
    made = patches.Translator(mesh, state.boundary, p, T, report)
    rules = made.rules()
    places = {patch.name: f"{state.folder}/p, {state.folder}/T" for patch in mesh.patches}
    scalars = patches.Scalars(rules, made.sides, mesh.patches, gas.R, report, places)
    entries = scalars.entries()
    folder = state.folder if float(state.folder.replace(".orig", "")) else "0.orig"
    energy = scalars.energy
    write(new, folder, "U", state.cells["U"], {name: r.velocity for name, r in rules.items()}, "m/s, as OpenFOAM has it")
    write(new, folder, "rho", p / (gas.R * T), {name: e[0] for name, e in entries.items()}, f"kg/m^3: p/(R T), R = {gas.R:.10g} m^2/s^2/K")
    write(new, folder, energy, p if energy == "p" else gas.R * T, {name: e[1] for name, e in entries.items()},
          "Pa, as OpenFOAM has it" if energy == "p" else f"m^2/s^2: R T, R = {gas.R:.10g} m^2/s^2/K; T/R is kelvin")
    report.took(f"{state.folder}/U", f"-> {folder}/U")
    report.changed(f"{state.folder}/p, {state.folder}/T", f"-> {folder}/rho = p/(R T) and {folder}/{energy}"
                   + (" = R T, in m^2/s^2" if energy == "T" else "; haff's T is R times kelvin"))
    return state.folder
