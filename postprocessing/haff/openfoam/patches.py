# SPDX-License-Identifier: GPL-3.0-or-later
"""Conditions on patches: OpenFOAM's of U, p and T (kelvin) as haff's of U, rho and one of T (R times kelvin) and p.

A condition of p or T is one of three: given (a value stands beyond the patch), free (that of the gas inside), or inletOutlet (free where
gas leaves, given where it enters). haff has rho in place of one of both, so that what was p given and T free is rho free and p given.
"""
import numpy as np

from haff.openfoam import values
from haff.openfoam.report import Refused
from haff.openfoam.values import Series, combined

MIRRORS = ("empty", "cyclic", "symmetry", "symmetryPlane", "wedge")
# type: the entry of its value
GIVEN = {"fixedValue": "value", "uniformFixedValue": "uniformValue", "freestreamPressure": "freestreamValue", "freestream": "freestreamValue",
         "totalTemperature": "T0"}
TOTAL = {"totalPressure": "p0", "uniformTotalPressure": "p0"}
TURNING = {"inletOutlet": "inletValue", "uniformInletOutlet": "uniformInletValue", "inletOutletTotalTemperature": "T0"}
FREE = {"zeroGradient": "", "calculated": "", "slip": "", "symmetry": "", "fixedFluxPressure": "", "buoyantPressure": "", "advective": "waves leave",
        "waveTransmissive": "waves leave; fieldInf is not held: where gas leaves slower than sound, fixedValue of p holds it, and reflects",
        "fixedGradient": "its gradient is left out", "smoluchowskiJumpT": "",
        "fixedMean": "its mean is not held"}
WALLS = {"noSlip": "", "slip": "", "partialSlip": "", "maxwellSlipU": "", "movingWallVelocity": "", "translatingWallVelocity": "", "rotatingWallVelocity": "",
         "symmetry": "", "symmetryPlane": "", "fixedNormalSlip": ""}
STREAMS = {"fixedValue": "value", "uniformFixedValue": "uniformValue", "freestream": "freestreamValue", "freestreamVelocity": "freestreamValue"}
DRIVEN = ("zeroGradient", "calculated", "pressureInletVelocity", "pressureInletOutletVelocity", "pressureInletUniformVelocity", "pressureDirectedInletVelocity",
          "pressureDirectedInletOutletVelocity", "pressureNormalInletOutletVelocity", "fluxCorrectedVelocity", "waveTransmissive", "advective")


class Condition:
    """kind: given, free or inletOutlet; value; total: of gas at rest far away."""

    def __init__(self, kind, value=None, total=False):
        self.kind, self.value, self.total = kind, value, total


class Rule:
    """Of a patch in the new case: velocity, the entry of U as text; p and T, Conditions, or None on walls and mirrors."""

    def __init__(self, velocity):
        self.velocity = velocity
        self.p = self.T = None


def kind_of(entry, what):
    if "type" not in entry:
        raise Refused(f"{entry.place}: the entry of a patch in {what} has no type")
    return str(entry["type"])


def value(entry, key, what):
    if key not in entry:
        raise Refused(f"{entry.place}: '{key}' is missing in {what}, type {entry.get('type')}")
    return values.value_of(entry[key], entry.lists)


def scalar(entry, what, report):
    """The Condition of p or T."""
    kind = kind_of(entry, what)
    for table, made in ((GIVEN, "given"), (TURNING, "inletOutlet"), (TOTAL, "given")):
        if kind in table:
            key = table[kind]
            key = "pressure" if key not in entry and "pressure" in entry else key
            return Condition(made, value(entry, key, what), table is TOTAL)
    if kind in FREE:
        if kind not in ("zeroGradient", "slip", "symmetry"):
            report.changed(entry["type"].place, f"{what} {kind} -> zeroGradient" + (f": {FREE[kind]}" if FREE[kind] else ""))
        return Condition("free")
    raise Refused(f"{entry['type'].place}: {what}: haff has nothing for the type {kind}; put one of these in its place: {' '.join([*GIVEN, *TURNING, *FREE])}")


class Sides:
    """The patches of a mesh: geometry and the gas beside them."""

    def __init__(self, mesh, p, T):
        self.mesh, self.fields = mesh, {"p": p, "T": T}

    def beside(self, name, patch):
        """p or T of the cells beside a patch."""
        all_cells = self.fields[name]
        return all_cells if all_cells.ndim == 1 else all_cells[self.mesh.owner[patch.first:patch.first + patch.count]]

    def normals(self, patch):
        area = self.mesh.face_geometry(patch.first, patch.first + patch.count)[1]
        return area / np.linalg.norm(area, axis=1)[:, None]

    def tangential(self, patch, u):
        """Does a velocity lead along all faces?"""
        through = np.abs((self.normals(patch) * u).sum(axis=1))
        return bool((through <= 1e-6 * np.linalg.norm(np.broadcast_to(u, (patch.count, 3)), axis=1)).all())


class Translator:
    """rules(): {patch: Rule} from the dictionaries of boundaryField of U, p, T."""

    def __init__(self, mesh, boundary, p, T, report):
        self.converted, self.boundary, self.report = mesh, boundary, report
        self.sides = Sides(mesh.mesh, p, T)

    def rules(self):
        return {patch.name: self.rule(patch) for patch in self.converted.patches}

    def entry(self, patch, name):
        found = self.boundary[name].matching(patch.names)
        if found is None or not hasattr(found, "lists"):
            raise Refused(f"{self.boundary[name].place}: {name} has no entry for patch {patch.old}")
        return found

    def rule(self, patch):
        if patch.count == 0 or patch.type in MIRRORS:
            return Rule(f"type {patch.type if patch.type in MIRRORS else 'slip'};")
        own = {name: self.entry(patch, name) for name in ("U", "p", "T")}
        kind = kind_of(own["U"], f"U of {patch.old}")
        if kind in WALLS or self.is_wall(patch, own["U"], kind):
            return self.wall(patch, own, kind)
        if patch.type == "wall":
            self.converted.change(patch, "patch", "as gas goes through it")
        return self.open(patch, own, kind)

    def is_wall(self, patch, entry, kind):
        """Is a velocity given that leads along the patch, so that nothing goes through?"""
        if kind != "fixedValue" or kind_of(self.entry(patch, "p"), "p") not in FREE:
            return False
        u = value(entry, "value", "U")
        return not np.any(u) or (patch.type == "wall" and self.sides.tangential(patch, u))

    def wall(self, patch, own, kind):
        if kind not in ("slip", "symmetry", "symmetryPlane"):
            self.report.changed(own["U"]["type"].place, f"{patch.name}: U {kind} -> slip: gas without viscosity goes along a wall freely")
        for name in ("p", "T"):
            scalar_kind = kind_of(own[name], name)
            if scalar_kind not in ("zeroGradient", "slip", "symmetry"):
                self.report.dropped(own[name]["type"].place, f"{patch.name}: {name} {scalar_kind} -> zeroGradient: a wall gives no heat without conduction")
        return Rule("type slip;")

    def open(self, patch, own, kind):
        if kind == "supersonicFreestream":
            return self.freestream(patch, own)
        p, T = (scalar(own[name], f"{name} of {patch.old}", self.report) for name in ("p", "T"))
        if p.total:
            return self.reservoir(patch, own, p, T)
        rule = Rule(self.velocity(patch, own["U"], kind))
        rule.p, rule.T = p, T
        if kind == "flowRateInletVelocity" and "volumetricFlowRate" in own["U"] and p.kind == "free":
            self.report.changed(own["p"]["type"].place, f"{patch.name}: p {kind_of(own['p'], 'p')} -> given as it stands inside at the start: a "
                                "volumetricFlowRate wants rho in haff")
            rule.p = Condition("given", self.sides.beside("p", patch))
        return rule

    def freestream(self, patch, own):
        entry = own["U"]
        rule = Rule(f"type fixedValue; value {values.as_entry(value(entry, 'UInf', 'U'))};")
        rule.p, rule.T = (Condition("given", value(entry, key, "U")) for key in ("pInf", "TInf"))
        self.report.changed(entry["type"].place, f"{patch.name}: U supersonicFreestream -> fixedValue of U, rho and T at UInf, pInf, TInf: the state beyond "
                            "the patch")
        return rule

    def reservoir(self, patch, own, p, T):
        """Gas at rest beyond the patch."""
        rule = Rule("type fixedValue; value uniform (0 0 0);")
        rule.p, rule.T = p, T if T.value is not None else Condition("given", self.sides.beside("T", patch))
        rule.T.kind = "given"
        self.report.changed(own["p"]["type"].place, f"{patch.name}: p {own['p']['type']} -> gas at rest beyond the patch, U (0 0 0), at p0 and T: it enters "
                            "through a wave, not along an isentrope, so less comes in than at the same p0")
        return rule

    def velocity(self, patch, entry, kind):
        place = entry["type"].place
        if kind in STREAMS:
            u = value(entry, STREAMS[kind], "U")
            if isinstance(u, Series):
                return f"type uniformFixedValue; uniformValue {values.as_table(u)}; value uniform {values.row(u.values[0])};"
            if kind != "fixedValue":
                self.report.changed(place, f"{patch.name}: U {kind} -> fixedValue, the velocity beyond the patch")
            return f"type fixedValue; value {values.as_entry(u)};"
        if kind in ("inletOutlet", "uniformInletOutlet"):
            u = value(entry, TURNING[kind], "U")
            if isinstance(u, Series):
                return f"type uniformInletOutlet; uniformInletValue {values.as_table(u)};"
            return f"type inletOutlet; inletValue {values.as_entry(u)}; value {values.as_entry(u)};"
        if kind == "surfaceNormalFixedValue":
            speed = value(entry, "refValue", "U")
            self.report.changed(place, f"{patch.name}: U {kind} -> fixedValue of each face")
            return f"type fixedValue; value {values.as_entry(self.sides.normals(patch) * speed)};"
        if kind == "flowRateInletVelocity":
            return self.flow_rate(patch, entry)
        if kind in DRIVEN:
            if kind != "zeroGradient":
                self.report.changed(place, f"{patch.name}: U {kind} -> zeroGradient")
            return "type zeroGradient;"
        raise Refused(f"{place}: U of {patch.old}: haff has nothing for the type {kind}; put one of these in its place: "
                      + " ".join([*STREAMS, *DRIVEN[:2], "inletOutlet", "flowRateInletVelocity", *WALLS]))

    def flow_rate(self, patch, entry):
        key = "massFlowRate" if "massFlowRate" in entry else "volumetricFlowRate"
        rate = value(entry, key, "U")
        text = values.as_table(rate) if isinstance(rate, Series) else values.row(rate)
        self.report.took(entry["type"].place, f"{patch.name}: U flowRateInletVelocity, {key} {text}")
        return f"type flowRateInletVelocity; {key} {text}; value uniform (0 0 0);"


class Scalars:
    """Entries of rho and of the energy, T or p, from the rules. energy: the field that the case gets beside rho."""

    def __init__(self, rules, sides, patches, R, report, places):
        self.rules, self.sides, self.patches, self.R, self.report, self.places = rules, sides, patches, R, report, places
        holds = any(r.p and r.p.kind == "given" and r.T.kind != "given" for r in rules.values())
        self.energy = "p" if holds else "T"

    def entries(self):
        """{patch: (entry of rho, entry of the energy)}."""
        return {patch.name: self.of(patch, self.rules[patch.name]) for patch in self.patches}

    def of(self, patch, rule):
        if rule.p is None:
            kind = patch.type if patch.type in MIRRORS else "zeroGradient"
            return f"type {kind};", f"type {kind};"
        p, T = rule.p, rule.T
        kinds = {p.kind, T.kind}
        if kinds == {"free"}:
            return "type zeroGradient;", "type zeroGradient;"
        energy = p if self.energy == "p" else T
        other = T if energy is p else p
        return self.entry(self.density(patch, p, T, energy, other)), self.entry(self.energy_of(energy))

    def energy_of(self, energy):
        if energy.kind == "free":
            return energy
        return Condition(energy.kind, energy.value if self.energy == "p" else times(energy.value, self.R))

    def density(self, patch, p, T, energy, other):
        """Given where both are; free where only the energy's own is; else what makes the other come out."""
        kind = "inletOutlet" if "inletOutlet" in (p.kind, T.kind) else "given" if other.kind == "given" else "free"
        if kind == "free":
            if energy.kind == "given" and energy is T:
                self.report.changed(self.places[patch.name], f"{patch.name}: p free and T given -> rho free and T given")
            else:
                self.report.changed(self.places[patch.name], f"{patch.name}: p given and T free -> rho free and p given")
            return Condition("free")
        known = {"p": p.value, "T": T.value}
        for name in known:
            if known[name] is None:
                known[name] = self.sides.beside(name, patch)
                self.report.changed(self.places[patch.name], f"{patch.name}: {name} is free and the other is not: rho beyond the patch is that of the {name} "
                                    "that stands inside at the start")
        try:
            return Condition(kind, combined(known["p"], times(known["T"], self.R), lambda a, b: a / b))
        except Refused as why:
            raise Refused(f"{self.places[patch.name]}: patch {patch.name}: {why}") from None

    @staticmethod
    def entry(c):
        if c.kind == "free":
            return "type zeroGradient;"
        inlet = c.kind == "inletOutlet"
        if isinstance(c.value, Series):
            kind, key = ("uniformInletOutlet", "uniformInletValue") if inlet else ("uniformFixedValue", "uniformValue")
            return f"type {kind}; {key} {values.as_table(c.value)}; value uniform {values.row(np.atleast_1d(c.value.values[0]))};"
        text = values.as_entry(c.value)
        return f"type inletOutlet; inletValue {text}; value {text};" if inlet else f"type fixedValue; value {text};"


def times(v, factor):
    return Series(v.times, v.values * factor) if isinstance(v, Series) else v * factor
