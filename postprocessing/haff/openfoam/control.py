# SPDX-License-Identifier: GPL-3.0-or-later
"""controlDict and fvSchemes of a case of OpenFOAM as those of haff."""
import re

from haff.openfoam.dictionary import number
from haff.openfoam.report import Refused

DENSITY = ("rhoCentralFoam",)  # explicit: time steps follow sound
PRESSURE = ("rhoPimpleFoam", "sonicFoam", "rhoPimpleAdiabaticFoam")  # implicit: they do not
ON, OFF = ("on", "yes", "true", "y", "t"), ("off", "no", "false", "n", "f", "none")
KEPT = ("startFrom", "startTime", "stopAt", "endTime")
WRITTEN = ("purgeWrite", "writeFormat", "writePrecision", "timeFormat", "timePrecision")
SILENT = ("application", "functions", "deltaT", "adjustTimeStep", "maxCo", "maxDeltaT", "writeControl", "writeInterval", "writeCompression",
          "runTimeModifiable", "haffVersion")
REASONS = {"libs": "nothing is loaded", "cycleWrite": "haff overwrites no written times but by purgeWrite", "graphFormat": "haff has raw tables",
           "maxAcousticCo": "sound is what maxCo counts in haff", "maxDi": "no diffusion"}
OPENFOAM = "ddtSchemes gradSchemes divSchemes laplacianSchemes interpolationSchemes snGradSchemes".split()  # its tools want these
LIMITS = {"SSPRK3": 1.0, "SSPRK43": 2.0}
FLUXES = {"Kurganov": ("common", "upwind by waves: as robust, and sharper at contacts"),
          "Tadmor": ("LaxFriedrichs", "the one speed of a face that Tadmor's has, wave by wave")}
LIMITERS = ("vanLeer", "vanAlbada", "Minmod", "minmod", "superBee", "SuperBee", "MUSCL", "UMIST", "OSPRE", "QUICK", "limitedLinear", "Gamma",
            "SFCD", "limitedVanLeer", "limitedMUSCL")


def switch(d, key, default=False):
    return d[key] in ON if key in d else default


class Control:
    """entries: [(key, value)] of the new controlDict but its functions; scheme: of time; pressure: does the solver go by pressure?"""

    def __init__(self, d, schemes, version, report):
        self.d, self.report, self.version = d, report, version
        self.application = d.get("application", "")
        if self.application not in DENSITY + PRESSURE:
            place = getattr(d.get("application"), "place", d.place)
            raise Refused(f"{place}: application {self.application or 'is missing'}: what is converted are the cases of {', '.join(DENSITY + PRESSURE)}")
        self.pressure = self.application in PRESSURE
        self.scheme = self.time_scheme(schemes)
        self.entries = [("application", "granularGas"), ("haffVersion", version), *self.times(), *self.steps(), *self.writing()]
        report.changed(d["application"].place, f"application {self.application} -> granularGas")
        for key in d:
            if key not in (*KEPT, *WRITTEN, *SILENT):
                report.dropped(getattr(d[key], "place", d.place), f"{key.split()[0]}: {REASONS.get(key, 'haff has no such keyword')}")

    def time_scheme(self, schemes):
        ddt = schemes.get("ddtSchemes", {})
        kind = (ddt.get("default", "Euler").split() or ["Euler"])[0]
        if kind in ("steadyState", "localEuler", "SLTS"):
            raise Refused(f"{ddt['default'].place}: ddtSchemes {kind}: haff goes through times, and knows no steady state but the one that a run comes to; "
                          "take Euler, and an endTime in seconds")
        made = "SSPRK3" if not self.pressure and number(self.d, "maxCo", default=0.5) <= 0.5 else "SSPRK43"
        self.report.changed(getattr(ddt.get("default"), "place", schemes.place), f"ddtSchemes {kind} -> timeScheme {made}, of third order")
        return made

    def times(self):
        for key in KEPT:
            if key in self.d:
                self.report.took(self.d[key].place, f"{key} {self.d[key]}")
        found = [(key, str(self.d[key])) for key in KEPT if key in self.d]
        return found if "startFrom" in self.d else [("startFrom", "latestTime"), *found]

    def steps(self):
        d, say = self.d, self.report
        number(d, "deltaT")
        adjust = switch(d, "adjustTimeStep")
        if self.pressure and not adjust:
            say.changed(d["deltaT"].place, f"deltaT {d['deltaT']} of all steps -> adjustTimeStep yes, maxCo 1: haff's steps follow sound, those of "
                        f"{self.application} do not")
            return [("deltaT", str(d["deltaT"])), ("adjustTimeStep", "yes"), ("maxCo", "1")]
        if not adjust:
            self.fixed()
            return [("deltaT", str(d["deltaT"])), ("adjustTimeStep", "no")]
        courant = number(d, "maxCo", default=1)
        if not courant > 0:
            raise Refused(f"{d['maxCo'].place}: maxCo {courant:g}: it must be positive")
        found = [("deltaT", str(d["deltaT"])), ("adjustTimeStep", "yes"), ("maxCo", f"{1 if self.pressure else min(courant, LIMITS[self.scheme]):g}")]
        if self.pressure:
            say.changed(getattr(d.get("maxCo"), "place", d.place), f"maxCo {courant:g} of the flow -> 1, with sound")
        elif courant <= LIMITS[self.scheme]:
            say.took(getattr(d.get("maxCo"), "place", d.place), f"adjustTimeStep, maxCo {courant:g}" + (
                f"; with SSPRK43 and maxCo 1 there are {1 / courant:.2g} times fewer steps" if courant <= 0.5 else ""))
        else:
            say.changed(d["maxCo"].place, f"maxCo {courant:g} -> {LIMITS[self.scheme]:g}, the most of {self.scheme}")
        if "maxDeltaT" in d:
            say.took(d["maxDeltaT"].place, f"maxDeltaT {d['maxDeltaT']}")
            found.append(("maxDeltaT", str(d["maxDeltaT"])))
        return found

    def fixed(self):
        d = self.d
        self.report.took(d["deltaT"].place, f"deltaT {d['deltaT']} of all steps, as adjustTimeStep is no")
        for key in ("maxCo", "maxDeltaT"):
            if key in d:
                self.report.dropped(d[key].place, f"{key} {d[key]}: OpenFOAM does not read it beside adjustTimeStep no")

    def writing(self):
        d, say = self.d, self.report
        how, every = d.get("writeControl", "timeStep"), d.get("writeInterval", "1")
        if how == "adjustable":
            how = "adjustableRunTime"
        if self.pressure and not switch(d, "adjustTimeStep") and how in ("timeStep", "runTime"):
            length = number(d, "writeInterval", default=1) * (number(d, "deltaT") if how == "timeStep" else 1)
            say.changed(getattr(d.get("writeControl"), "place", d.place), f"writeControl {how}, writeInterval {every} -> adjustableRunTime, {length:.12g}")
            how, every = "adjustableRunTime", f"{length:.12g}"
        else:
            say.took(getattr(d.get("writeControl"), "place", d.place), f"writeControl {how}, writeInterval {every}")
        found = [("writeControl", how), ("writeInterval", every)]
        found += [(key, str(d[key])) for key in WRITTEN if key in d]
        compression = d.get("writeCompression", "off")
        found += [("writeCompression", "on" if compression in (*ON, "compressed") else "off"),
                  ("runTimeModifiable", "yes" if switch(d, "runTimeModifiable", True) else "no")]
        say.took(d.place.split(":")[0], ", ".join(key for key in (*WRITTEN, "writeCompression", "runTimeModifiable") if key in d))
        return found


class Schemes:
    """flux, reconstruct (lattices), polyReconstruct (other meshes)."""

    def __init__(self, d, control, report):
        kind = d.get("fluxScheme")
        if kind in FLUXES:
            self.flux, why = FLUXES[kind]
            report.changed(kind.place, f"fluxScheme {kind} -> {self.flux}: {why}")
        elif kind:
            raise Refused(f"{kind.place}: fluxScheme {kind}: {' or '.join(FLUXES)} was expected")
        else:
            self.flux = "common"
            report.added("system/fvSchemes", f"fluxScheme common: {control.application} goes by pressure and has none")
        self.reconstruct, self.poly = self.reconstruction(d, report)
        for name in ("gradSchemes", "laplacianSchemes", "snGradSchemes", "divSchemes", "wallDist"):
            if name in d:
                report.dropped(d[name].place, f"{name}: nothing of it is left without viscosity" if name != "divSchemes" or kind else
                               "divSchemes: what is carried goes through the one flux above")

    @staticmethod
    def reconstruction(d, report):
        inner = d.get("interpolationSchemes", {})
        given = {key: inner[key] for key in inner if key.startswith("reconstruct(")}
        words = {re.sub(r"(?<=[a-z])V$", "", value.split()[0]) for value in given.values() if value}
        if words and words <= {"upwind"}:
            made = ("firstOrder", "firstOrder")
        elif words == {"linear"}:
            made = ("WPENO5", "CWENO3")
        else:
            made = ("PHM", "linear")
        for word in words - {"upwind", "linear", *LIMITERS}:
            report.changed(d.place.split(":")[0], f"reconstruct: {word} is not known here, and is taken as a limited scheme of second order")
        place = next(iter(given.values())).place if given else d.place
        text = ", ".join(f"{key[12:-1]} {value}" for key, value in given.items()) or "no reconstruct(..)"
        report.changed(place, f"{text} -> reconstruct {made[0]} on a lattice, polyReconstruct {made[1]} on other meshes")
        return made


def schemes_text(schemes, control, polyhedral, unused):
    """The new fvSchemes, without the entries that are not used."""
    entries = [("fluxScheme", schemes.flux, ""), *([("meshEngine", "polyhedral", "")] if polyhedral else []),
               ("reconstruct", schemes.reconstruct, " // of lattices"), ("polyReconstruct", schemes.poly, " // of other meshes"),
               ("timeScheme", control.scheme, "")]
    return "".join(f"{key:<15} {value};{note}\n" for key, value, note in entries if key not in unused) + "\n// OpenFOAM's own tools want these to be there.\n" + "".join(
        f"{name} {{}}\n" for name in OPENFOAM)
