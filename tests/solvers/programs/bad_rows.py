# SPDX-License-Identifier: GPL-3.0-or-later
"""The mistakes of test_bad_input.py: what is changed in a sound case, and what the programs must say of it."""
import gzip
import os
import shutil

from tests.cases.harness import boxes
from tests.solvers.programs import bad_case


class Row:
    """One mistake. change: (file, old, new) of a text that stands there once, or a function of the case folder.
    says: what the message must hold. at: the text, unique in the file, whose line must be named; default: the line of
    the change; "": the file without a line. where: the file that is to be named, if not the changed one."""

    def __init__(self, name, change, *says, at=None, where=None, base="box"):
        self.name, self.says, self.at, self.where, self.base = name, says, at, where, base
        self.file, self.old, self.new = change if isinstance(change, tuple) else (None, None, None)
        self.apply = None if isinstance(change, tuple) else change

    def spoil(self, case):
        """Makes the mistake; returns the place that the message must name."""
        line = None
        if self.apply:
            self.apply(case)
        else:
            path = os.path.join(case, self.file)
            with open(path) as f:
                text = f.read()
            assert text.count(self.old) == 1, f"{self.name}: '{self.old}' stands {text.count(self.old)} times"
            start = text.index(self.old)
            text = text.replace(self.old, self.new)
            with open(path, "w") as f:
                f.write(text)
            start += len(self.new) - len(self.new.lstrip())
            line = text.count("\n", 0, start) + 1
        file = self.where or self.file
        if self.at == "" or (self.apply and not self.at) or not file:
            return file and os.path.join(case, file)
        if self.at:
            with open(os.path.join(case, file)) as f:
                text = f.read()
            assert text.count(self.at) == 1, f"{self.name}: '{self.at}' stands {text.count(self.at)} times"
            line = text.count("\n", 0, text.index(self.at)) + 1
        return f"{os.path.join(case, file)}:{line}:"


CONTROL, SCHEMES, SOLUTION = "system/controlDict", "system/fvSchemes", "system/fvSolution"
PROPERTIES, GRAVITY, SHAKING = "constant/granularProperties", "constant/g", "constant/shaking"
MESH = "constant/polyMesh/"


COEFFICIENTS = "forceCoeffs; patches (xHigh); CofR (0 0 0); magUInf 1; rhoInf 1; lRef 1; Aref 1; "
CUT = "surfaces; fields (p); surfaces { a { type cuttingPlane; planeType pointAndNormal; pointAndNormalDict { %s } } }"
LEVEL = "surfaces; fields (p); surfaces { a { type isoSurface; isoField %s; isoValue %s; } }"
SURFACE = "surfaceFieldValue; regionType patch; name xHigh; "


def function(text):
    """One more function object, of type ..."""
    return CONTROL, "    vtk {", "    f { type %s }\n    vtk {" % text


def remove(path):
    return lambda case: os.remove(os.path.join(case, path))


def folder_instead(path):
    def change(case):
        os.remove(os.path.join(case, path))
        os.makedirs(os.path.join(case, path))
    return change


def write(path, text):
    def change(case):
        with open(os.path.join(case, path), "w") as f:
            f.write(text)
    return change


def cut(path, share):
    def change(case):
        path_ = os.path.join(case, path)
        os.truncate(path_, int(share * os.path.getsize(path_)))
    return change


def cut_list(path):
    """Ends the file within the bytes of its list."""
    def change(case):
        with open(os.path.join(case, path), "rb") as f:
            start = f.read().index(b"\n24\n(")
        os.truncate(os.path.join(case, path), start + 5 + 24 * 4)
    return change


def both(*changes):
    def change(case):
        for one in changes:
            one(case)
    return change


def change_bytes(path, old, new, dropped=0):
    """`dropped` bytes behind `old` go, too."""
    def change(case):
        with open(os.path.join(case, path), "rb") as f:
            data = f.read()
        start = data.index(old)
        with open(os.path.join(case, path), "wb") as f:
            f.write(data[:start] + new + data[start + len(old) + dropped:])
    return change


def append(path, text):
    def change(case):
        with open(os.path.join(case, path), "a") as f:
            f.write(text)
    return change


def rename(path, new):
    return lambda case: os.rename(os.path.join(case, path), os.path.join(case, new))


def zipped(path, new):
    def change(case):
        with open(os.path.join(case, path), "rb") as f, gzip.open(os.path.join(case, new), "wb") as out:
            out.write(f.read())
        os.remove(os.path.join(case, path))
    return change


def replace(path, old, new):
    return lambda case: Row("", (path, old, new)).spoil(case)


OF_DISKS = replace(PROPERTIES, "equationOfState GoldshteinShapiro;", "equationOfState TorquatoDisks;")


def disks(coefficients):
    """A gas of disks with transport and these coefficients."""
    return both(OF_DISKS, replace(PROPERTIES, "transport none;", "transport JenkinsRichman;\n" + coefficients))


def garzo_dufty(coefficients, eos="TorquatoSpheres"):
    """A gas with the transport law GarzoDufty and these coefficients."""
    return both(replace(PROPERTIES, "equationOfState GoldshteinShapiro;", f"equationOfState {eos};"),
                replace(PROPERTIES, "transport none;", "transport GarzoDufty;\n" + coefficients))


def mesh(n=bad_case.CELLS, types=None):
    def change(case):
        shutil.rmtree(os.path.join(case, MESH))
        boxes.write_mesh(case, n, bad_case.SIZE, types or bad_case.TYPES)
    return change


DICTIONARIES = [
    # a missing ';' in each dictionary
    Row("no ; in controlDict", (CONTROL, "maxCo 0.5;", "maxCo 0.5"), "missing ';'", "'maxCo'", "'maxDeltaT'"),
    Row("no ; in a function object", (CONTROL, "nPoints 5;", "nPoints 5"), "missing ';'", "'nPoints'"),
    Row("no ; in fvSchemes", (SCHEMES, "reconstruct PHM;", "reconstruct PHM"), "missing ';'", "'timeScheme'"),
    Row("no ; in fvSolution", (SOLUTION, "1e-3;", "1e-3"), "missing ';'", "'minDeltaTFraction'"),
    Row("no ; in granularProperties", (PROPERTIES, "mass 1;", "mass 1"), "missing ';'", "'mass'", "'restitution'"),
    Row("no ; at the end of granularProperties", (PROPERTIES, "transport none;\n", "transport none\n"), "missing ';'"),
    Row("no ; in g", (GRAVITY, "value (1 -2 0);", "value (1 -2 0)"), "missing ';'", "'value'"),
    Row("no ; after dimensions of g", (GRAVITY, "0 0 0];", "0 0 0]"), "missing ';'", "'dimensions'"),
    Row("no ; in shaking", (SHAKING, "amplitude 3;", "amplitude 3"), "missing ';'", "'amplitude'"),
    Row("no ; in a patch", ("0/T", "value uniform 25;", "value uniform 25"), "missing ';'", "'value'"),
    Row("no ; after a list", ("0/alpha", ")\n;\n", ")\n"), "missing ';'", "'internalField'", at="internalField"),
    Row("no ; in FoamFile", (CONTROL, "object      controlDict;", "object      controlDict"), "';'"),
    # keys that nothing reads, at every level
    Row("unknown key in controlDict", (CONTROL, "maxCo 0.5;", "maxC0 0.5;"), "'maxC0' is not used",
        "did you mean 'maxCo'?"),
    Row("unknown key in functions", (CONTROL, "writeInterval 1;", "writeIntervall 1;"), "'writeIntervall'",
        "did you mean 'writeInterval'?"),
    Row("unknown key in probes", (CONTROL, "probeLocations", "probeLocation"), "'probeLocation",
        "did you mean 'probeLocations'?"),
    Row("unknown key in a line of sets", (CONTROL, "nPoints 5;", "nPoints 5; npoints 6;"), "'npoints' is not used",
        "did you mean 'nPoints'?"),
    Row("unknown key in fieldMinMax", (CONTROL, "log false;", "logg false;"), "'logg'", "did you mean 'log'?"),
    Row("unknown key in volFieldValue", (CONTROL, "operation volIntegrate;", "operation sum; regiontype all;"),
        "'regiontype' is not used", "did you mean 'regionType'?"),
    Row("unknown key in vtk", (CONTROL, "type vtk;", "type vtk; writeformat ascii;"), "'writeformat'",
        "did you mean 'writeFormat'?"),
    Row("unknown key in fvSchemes", (SCHEMES, "timeScheme SSPRK3;", "timeSchemes SSPRK3;"), "'timeSchemes' is not used",
        "did you mean 'timeScheme'?"),
    Row("unknown key in fvSolution", (SOLUTION, "limits", "limit"), "'limit' is not used", "did you mean 'limits'?"),
    Row("unknown key in limits", (SOLUTION, "minDeltaTFraction", "minDeltaFraction"), "'minDeltaFraction' is not used",
        "did you mean 'minDeltaTFraction'?"),
    Row("unknown key in granularProperties", (PROPERTIES, "transport none;", "transport none; colour red;"),
        "'colour' is not used", "known here:"),
    Row("unknown key in grain", (PROPERTIES, "mass 1;", "mas 1;"), "'mas' is not used", "did you mean 'mass'?"),
    Row("misspelt required key in grain", (PROPERTIES, "diameter 0.1;", "diametre 0.1;"),
        "'diameter' is missing", "did you mean 'diameter'?", "(grain diameter)"),
    Row("gamma in grain", (PROPERTIES, "mass 1;", "mass 1; gamma 1.4;"), "'gamma' is not used here",
        "it belongs in  GoldshteinShapiroCoeffs { gamma ..; }"),
    Row("restitution beside grain", (PROPERTIES, "transport none;", "transport none; restitution 0.9;"), "'restitution' is not used here",
        "it belongs in  grain { restitution ..; }"),
    Row("a wall's restitution in grain", (PROPERTIES, "mass 1;", "mass 1; restitutionCoefficient 0.9;"), "did you mean 'restitution'?"),
    Row("unknown key in Coeffs", (PROPERTIES, "alphaMax", "alphamax"), "'alphamax' is not used",
        "did you mean 'alphaMax'?"),
    Row("misspelt Coeffs", (PROPERTIES, "GoldshteinShapiroCoeffs", "GoldshteinShapiroCoefs"),
        "'GoldshteinShapiroCoefs' is not used", "did you mean 'GoldshteinShapiroCoeffs'?"),
    Row("unknown key in g", (GRAVITY, "value", "values"), "'value' is missing", "did you mean 'value'?"),
    Row("unknown key in shaking", (SHAKING, "phase 0;", "phasis 0;"), "'phasis' is not used", "did you mean 'phase'?"),
    Row("unknown key in a field", ("0/T", "internalField", "referenceLevel 0;\ninternalField"),
        "'referenceLevel' is not used"),
    Row("unknown key in a patch", ("0/T", "value uniform 25;", "value uniform 25; valeu 3;"), "'valeu' is not used",
        "did you mean 'value'?"),
    # names of models
    Row("unknown equation of state", (PROPERTIES, "equationOfState GoldshteinShapiro", "equationOfState Goldstein"),
        "Goldstein", "allowed are", "GoldshteinShapiro, perfectGas"),
    Row("no equation of state", (PROPERTIES, "equationOfState GoldshteinShapiro;\n", ""), "'equationOfState' is missing",
        "GoldshteinShapiro, perfectGas", at=""),
    Row("unknown cooling", (PROPERTIES, "cooling Haff", "cooling haff"), "allowed are: none, Haff",
        "did you mean 'Haff'?"),
    Row("no cooling with e < 1", (PROPERTIES, "cooling Haff;\n", ""), "'cooling' is missing", "cooling Haff;", at=""),
    Row("unknown transport", (PROPERTIES, "transport none", "transport Jenkins"), "Jenkins", "allowed are: none"),
    Row("misspelt transport", (PROPERTIES, "transport none", "transport JenkinsRichmann"),
        "allowed are: none, JenkinsRichman", "did you mean 'JenkinsRichman'?"),
    Row("transport of other grains", (PROPERTIES, "transport none", "transport JenkinsRichman"),
        "JenkinsRichman is for disks, equationOfState GoldshteinShapiro for spheres"),
    # of disks; the coefficients of GoldshteinShapiro stay in the file
    Row("misspelt word in Coeffs", disks("JenkinsRichmanCoeffs { bulk papre; }"), "'bulk' is papre",
        "allowed are: corrected, paper", "did you mean 'paper'?", at="JenkinsRichmanCoeffs", where=PROPERTIES),
    Row("unknown key in Coeffs of a law", disks("JenkinsRichmanCoeffs { alphaMim 1e-3; }"), "'alphaMim' is not used",
        "did you mean 'alphaMin'?", at="JenkinsRichmanCoeffs", where=PROPERTIES),
    Row("misspelt Coeffs of a law", disks("JenkinsRichmannCoeffs { bulk paper; }"),
        "'JenkinsRichmannCoeffs' is not used", "did you mean 'JenkinsRichmanCoeffs'?", at="JenkinsRichmannCoeffs",
        where=PROPERTIES),
    Row("alphaMin 0", disks("JenkinsRichmanCoeffs { alphaMin 0; }"), "alphaMin is 0", "allowed is 0 .. 1",
        at="JenkinsRichmanCoeffs", where=PROPERTIES),
    # of GarzoDufty
    Row("misspelt GarzoDufty", (PROPERTIES, "transport none", "transport GarzoDuffty"),
        "allowed are: none, JenkinsRichman, GarzoDufty", "did you mean 'GarzoDufty'?"),
    Row("unknown friction", (PROPERTIES, "transport none;", "transport none; friction { type mui; }"), "allowed are: none, Coulomb, muI",
        "did you mean 'muI'?"),
    Row("friction without a type", (PROPERTIES, "transport none;", "transport none; friction { muStatic 0.3; }"), "'type' is missing in 'friction'"),
    Row("friction that is a word", (PROPERTIES, "transport none;", "transport none; friction muI;"), "'friction'", "dictionary"),
    Row("muDynamic of Coulomb", (PROPERTIES, "transport none;", "transport none; friction { type Coulomb; muDynamic 0.6; }"),
        "'muDynamic' is not used", "muStatic"),
    Row("unknown key beside friction none", (PROPERTIES, "transport none;", "transport none; friction { type none; mu 0.6; }"), "'mu' is not used",
        "muStatic"),
    Row("muStatic and frictionAngle", (PROPERTIES, "transport none;", "transport none; friction { type muI; muStatic 0.4; frictionAngle 24; }"),
        "key 'frictionAngle' is 24", "leave one of them out"),
    Row("muStatic above 1", (PROPERTIES, "transport none;", "transport none; friction { type Coulomb; muStatic 1.5; }"), "muStatic is 1.5", "0 .. 1"),
    Row("muDynamic below muStatic", (PROPERTIES, "transport none;", "transport none; friction { type muI; muStatic 0.7; }"),
        "muDynamic is below muStatic"),
    Row("alphaSolid below alphaFriction", (PROPERTIES, "transport none;", "transport none; friction { type muI; alphaSolid 0.3; }"),
        "alphaSolid must be above alphaFriction"),
    Row("friction of a gas without packing", both(replace(PROPERTIES, "equationOfState GoldshteinShapiro;", "equationOfState perfectGas;"),
                                                  replace(PROPERTIES, "transport none;", "transport none; friction { type muI; }")),
        "perfectGas has no alphaMax", "type none;", at="friction", where=PROPERTIES),
    Row("friction with explicit acoustics", both(replace(PROPERTIES, "transport none;", "transport none; friction { type muI; }"),
                                                 append(SOLUTION, "acoustics { type explicit; }\n")),
        "friction muI lets packed gas rest in implicit acoustic steps", "type automatic;", at="type explicit;", where=SOLUTION),
    Row("GarzoDufty without a diameter", both(replace(PROPERTIES, "diameter 0.1;", "diameter 0;"), garzo_dufty("")),
        "grains without a diameter do not collide", "transport none;", at="transport GarzoDufty;", where=PROPERTIES),
    Row("misspelt GarzoDuftyCoeffs", garzo_dufty("GarzoDuffyCoeffs { knudsenCut 0.1; }"),
        "'GarzoDuffyCoeffs' is not used", "did you mean 'GarzoDuftyCoeffs'?", at="GarzoDuffyCoeffs", where=PROPERTIES),
    *[Row(f"GarzoDufty: {entry}", garzo_dufty(f"GarzoDuftyCoeffs {{ {entry} }}"), *says, at="GarzoDuftyCoeffs",
          where=PROPERTIES)
      for entry, *says in (
          ("alphaMim 1e-3;", "'alphaMim' is not used", "did you mean 'alphaMin'?"),
          ("knudsencut 1e-3;", "'knudsencut' is not used", "did you mean 'knudsenCut'?"),
          ("zeta_U full;", "'zeta_U' is not used", "did you mean 'zetaU'?"),
          ("bulk paper;", "'bulk' is not used", "known here: alphaMin knudsenCut zetaU stress"),
          ("alphaMin -1e-4;", "alphaMin is -0.0001", "allowed is 0 .. 0.1"),
          ("alphaMin 0.2;", "alphaMin is 0.2", "allowed is 0 .. 0.1"),
          ("knudsenCut -0.1;", "knudsenCut is -0.1", "allowed is 0 .. 1"),
          ("knudsenCut 1.5;", "knudsenCut is 1.5", "allowed is 0 .. 1"),
          ("knudsenCut nan;", "nan", "expected a number"),
          ("knudsenCut off;", "'knudsenCut' is off", "expected a number"),
          ("zetaU on;", "'zetaU' is on", "allowed are: off, geometric, full"),
          ("zetaU fulll;", "'zetaU' is fulll", "did you mean 'full'?"),
          ("zetaU 1;", "'zetaU' is 1", "off, geometric, full"),
          ("zetaU;", "'zetaU' is empty", "off, geometric, full"),
          ("stress diagonel;", "'stress' is diagonel", "allowed are: full, diagonal", "did you mean 'diagonal'?"),
          ("stress yes;", "'stress' is yes", "full, diagonal"))],
    Row("GarzoDufty: diagonal stress on polyhedra",
        both(replace(SCHEMES, "reconstruct PHM;", "meshEngine polyhedral;"),
             garzo_dufty("GarzoDuftyCoeffs { stress diagonal; }")),
        "stress diagonal is for lattices", "stress full;", where=PROPERTIES, at="transport GarzoDufty;"),
    Row("unknown flux", (SCHEMES, "fluxScheme common;", "fluxScheme Marqina;"), "Marqina", "allowed are: common, ",
        "did you mean 'Marquina'?"),
    Row("unknown reconstruct", (SCHEMES, "reconstruct PHM", "reconstruct WENO6"), "WENO6", "allowed are",
        "did you mean 'WENO5' or 'WENOZ'?"),
    Row("unknown timeScheme", (SCHEMES, "timeScheme SSPRK3", "timeScheme RK4"), "RK4", "allowed are", "SSPRK3"),
    Row("unknown shaking", (SHAKING, "type sinusoidal;", "type sinusodal;"), "sinusodal", "did you mean 'sinusoidal'?"),
    Row("unknown function object", (CONTROL, "type fieldMinMax;", "type fieldMinMac;"), "fieldMinMac", "allowed are",
        "did you mean 'fieldMinMax'?"),
    Row("unknown field of a function object", (CONTROL, "fields (p);", "fields (p alpa);"), "no field 'alpa'",
        "did you mean 'alpha'?"),
    Row("field listed twice", (CONTROL, "fields (p);", "fields (p p);"), "'p' is listed twice"),
    Row("no fields", (CONTROL, "fields (p); ", ""), "'fields' is missing in 'functions.extremes'", "rho alpha U T p c Ma",
        at="extremes { type fieldMinMax;"),
    Row("unknown operation", (CONTROL, "operation volIntegrate;", "operation volIntegral;"), "volIntegral",
        "did you mean 'volIntegrate'?"),
    Row("a patch that is not there", function("forces; patches (xHig); CofR (0 0 0);"), "'xHig'", "did you mean 'xHigh'?"),
    Row("a cyclic patch has no force", function("forces; patches (yLow); CofR (0 0 0);"), "'yLow'", "is cyclic"),
    Row("a pattern of cyclic patches", function('forces; patches ("y.*"); CofR (0 0 0);'), "'y.*'", "empty or cyclic"),
    Row("no centre of moments", function("forces; patches (xHigh);"), "'CofR' is missing"),
    Row("density of an incompressible solver", function("forces; patches (xHigh); CofR (0 0 0); rho rhoInf;"), "rhoInf", "allowed are: rho"),
    Row("lift along the drag", function(COEFFICIENTS + "dragDir (1 0 0); liftDir (1 1 0);"), "'liftDir'", "right angles"),
    Row("pitch about another axis", function(COEFFICIENTS + "dragDir (1 0 0); liftDir (0 1 0); pitchAxis (0 0 1);"), "'pitchAxis'", "(0 0 -1)"),
    Row("a flow is averaged", function(SURFACE + "operation average; fields (phi);"), "'phi' is a flow", "operation sum;"),
    Row("a field of a surface that is not there", function(SURFACE + "operation sum; fields (alpa);"), "'alpa'", "did you mean 'alpha'?"),
    Row("no weights", function(SURFACE + "operation weightedSum; fields (p);"), "'weightField' is missing"),
    Row("weights that are not used", function(SURFACE + "operation sum; fields (p); weightField rho;"), "no weights", "weighted.."),
    Row("a plane beside the mesh", function("surfaceFieldValue; regionType sampledSurface; operation sum; fields (p); sampledSurfaceDict "
                                            "{ type plane; basePoint (9 0 0); normalVector (1 0 0); }"), "'basePoint'", "does not cut the mesh"),
    Row("no objects", function("writeObjects;"), "'objects' is missing", "objects (Ma vorticity);"),
    Row("objects under two names", function("writeObjects; objects (Ma); fields (Ma);"), "'fields'", "another word for `objects`"),
    Row("an object that is not there", function("writeObjects; objects (vorticty);"), "'vorticty'", "did you mean 'vorticity'?"),
    Row("objects at times of their own", function("writeObjects; objects (Ma); writeControl timeStep;"), "'writeControl'", "leave it out"),
    Row("objects that another writes", function("writeObjects; objects (Ma); } g { type writeObjects; fields (c Ma);"), "'f' writes Ma already"),
    Row("objects that the first function writes", (CONTROL, "functions\n{", "functions\n{\n    f { type writeObjects; objects (Ma); } "
                                                   "g { type writeObjects; objects (Ma); }"), "'f' writes Ma already", at="g { type"),
    Row("a plane of surfaces beside the mesh", function(CUT % "point (9 0 0); normal (1 0 0);"), "'point'", "does not cut the mesh"),
    Row("a plane of surfaces without direction", function(CUT % "point (0 0 0); normal (0 0 0);"), "'normal'", "has a length"),
    Row("unknown key in a plane of surfaces", function(CUT % "point (0.1 0 0); normal (1 0 0); basePoint (0 0 0);"), "'basePoint' is not used"),
    Row("a surface of no known type", function(LEVEL.replace("isoSurface", "isoSurfce") % ("p", 1)), "isoSurfce", "did you mean 'isoSurface'?"),
    Row("an isosurface of a field that is not there", function(LEVEL % ("alpa", 1)), "'alpa'", "did you mean 'alpha'?"),
    Row("an isosurface of a vector", function(LEVEL % ("U", 1)), "'isoField'", "scalar field"),
    Row("an isosurface of a word", function(LEVEL % ("p", "low")), "'isoValue'", "expected a number"),
    Row("surfaces without any", function("surfaces; fields (p); surfaces { }"), "'surfaces'", "it is empty"),
    Row("a surface that leads out of the case", function((LEVEL % ("p", 1)).replace("{ a {", '{ "../a" {')), "'../a'", "below postProcessing/"),
    Row("a scheme of sets that is not there", function("sets; fields (p); interpolationScheme cellPoin; sets { a { type uniform; axis x; "
                                                      "start (0 0 0); end (1 0 0); nPoints 3; } }"), "cellPoin", "did you mean 'cellPoint'?"),
    Row("a picture of no field", function("image; fields (alpa);"), "alpa", "did you mean 'alpha'?"),
    Row("a picture with a path", function("image; fields (../U);"), "'../U' is no name of a field"),
    Row("a picture twice", function("image; fields (U U);"), "'U' is listed twice"),
    Row("pictures of one file", function("image; fields (U); options (-log -o x.png);"), "-o", "a file of its own"),
    Row("pictures at times of their own", function("image; fields (U); writeControl timeStep;"), "'writeControl'", "leave it out"),
    Row("pictures of an unknown format", function("image; fields (U); format jpg;"), "jpg", "allowed are: png"),
    Row("a function object that leads out of the case", (CONTROL, "    vtk {", "    ../../vtk {"), "'../../vtk'",
        "below postProcessing/"),
    Row("a line that leads out of the case", (CONTROL, "            a\n", "            ../../../a\n"), "'../../../a'",
        "below postProcessing/"),
    Row("a function object that is hidden", (CONTROL, "    vtk {", "    ..vtk {"), "'..vtk'", "no '.' in front"),
    Row("a function object that is no dictionary", (CONTROL, "    vtk {", "    extra 3;\n    vtk {"), "'extra'",
        "{ ... }"),
    # values: type
    Row("word for a number", (CONTROL, "maxCo 0.5;", "maxCo half;"), "'maxCo' is half", "expected a number"),
    Row("two numbers for one", (CONTROL, "maxCo 0.5;", "maxCo 0.5 0.6;"), "0.5 0.6", "expected one number"),
    Row("no value", (CONTROL, "maxCo 0.5;", "maxCo;"), "'maxCo' is empty", "expected a number"),
    Row("number for a switch", (CONTROL, "adjustTimeStep no;", "adjustTimeStep 0;"), "'adjustTimeStep' is 0", "yes",
        "no"),
    Row("number for a word", (CONTROL, "startFrom latestTime;", "startFrom 0;"), "'startFrom' is 0", "latestTime"),
    Row("fraction for a count", (CONTROL, "purgeWrite 0;", "purgeWrite 1.5;"), "1.5", "whole number"),
    Row("dictionary for a number", (CONTROL, "maxCo 0.5;", "maxCo { value 0.5; }"), "'maxCo'", "not a dictionary"),
    Row("value for a dictionary", (SOLUTION, "limits\n{\n    minDeltaTFraction 1e-3;\n}", "limits 3;"), "'limits' is 3",
        "limits { ... }"),
    Row("scalar for a vector", (GRAVITY, "(1 -2 0)", "-2"), "'value' is -2", "(x y z)"),
    Row("vector of two", (GRAVITY, "(1 -2 0)", "(1 -2)"), "(1 -2)", "(x y z)"),
    Row("0x10", (CONTROL, "purgeWrite 0;", "purgeWrite 0x10;"), "0x10", "expected a number"),
    Row("decimal comma", (CONTROL, "maxCo 0.5;", "maxCo 0,5;"), "0 , 5", "expected one number"),
    Row("nan", (CONTROL, "maxCo 0.5;", "maxCo nan;"), "nan", "expected a number"),
    Row("inf", (PROPERTIES, "diameter 0.1;", "diameter inf;"), "inf", "expected a number"),
    Row("1e999", (PROPERTIES, "diameter 0.1;", "diameter 1e999;"), "1e999", "out of range"),
    # values: range
    Row("restitution 1.2", (PROPERTIES, "restitution 0.9;", "restitution 1.2;"), "restitution is 1.2", "0 .. 1"),
    Row("diameter < 0", (PROPERTIES, "diameter 0.1;", "diameter -0.1;"), "diameter is -0.1", "allowed is"),
    Row("mass 0", (PROPERTIES, "mass 1;", "mass 0;"), "mass is 0", "allowed is"),
    Row("alphaMax 0", (PROPERTIES, "alphaMax 0.65;", "alphaMax 0;"), "alphaMax is 0", "allowed is"),
    Row("gamma 1", (PROPERTIES, "gamma 1.6666666666666667;", "gamma 1;"), "gamma is 1", "allowed is 1 .. 3"),
    Row("maxCo -1", (CONTROL, "maxCo 0.5;", "maxCo -1;"), "maxCo is -1", "allowed is"),
    Row("maxCo 1.5", (CONTROL, "maxCo 0.5;", "maxCo 1.5;"), "SSPRK3 allows 1 at most"),
    Row("deltaT 0", (CONTROL, "deltaT 0.001;", "deltaT 0;"), "deltaT is 0", "greater than 0"),
    Row("endtime", (CONTROL, "endTime 0.002;", "endtime 0.002;"), "'endTime' is missing", "this line has 'endtime'"),
    Row("no solver of ours", (CONTROL, "application granularGas;", "application granularGaz;"), "allowed are: granularGas, granularMD",
        "did you mean 'granularGas'?"),
    Row("a step that is too long", (CONTROL, "deltaT 0.001;", "deltaT 1;"), "'deltaT' is 1", "the time scheme allows 0.0327 s at most",
        "Courant number of 30.6", "adjustTimeStep yes;"),
    Row("no such warning", (CONTROL, "maxCo 0.5;", "maxCo 0.5; acceptWarnings (fewgrains);"), "there is no 'fewgrains'",
        "did you mean 'fewGrains'?"),
    Row("runTable", (CONTROL, "maxCo 0.5;", "maxCo 0.5; runTable everystep;"), "'runTable' is everystep", "did you mean 'everyStep'?"),
    Row("no deltaT", (CONTROL, "deltaT 0.001;\n", ""), "time step must be given", "add  deltaT <seconds>;", at="adjustTimeStep no;"),
    Row("writePrecision 99", (CONTROL, "writePrecision 17;", "writePrecision 99;"), "99", "1 .. 17"),
    Row("writeFormat", (CONTROL, "writeFormat ascii;", "writeFormat asci;"), "asci", "did you mean 'ascii'?"),
    Row("writeControl", (CONTROL, "writeControl adjustableRunTime;", "writeControl adjustableRuntime;"),
        "did you mean 'adjustableRunTime'?"),
    Row("writeInterval 0", (CONTROL, "writeInterval 0.001;", "writeInterval 0;"), "'writeInterval' is 0",
        "greater than 0"),
    Row("no writeInterval", (CONTROL, "writeInterval 0.001;\n", ""), "'writeInterval' is missing", at=""),
    Row("fraction of a step", (CONTROL, "writeControl adjustableRunTime;", "writeControl timeStep;"), "0.001",
        "whole number of steps", at="writeInterval 0.001;"),
    Row("endTime before startTime", (CONTROL, "endTime 0.002;", "endTime -1;"), "'endTime' is -1", "from time 0"),
    Row("no endTime", (CONTROL, "endTime 0.002;\n", ""), "'endTime' is missing", "endTime <seconds>;", at=""),
    Row("start at a time that is not there", (CONTROL, "startFrom latestTime;\nstartTime 0;",
                                              "startFrom startTime;\nstartTime 0.0005;"),
        "no such time folder", "there are: 0", at="startTime 0.0005;"),
    Row("amplitude missing", (SHAKING, "amplitude 3;\n", ""), "'amplitude' is missing", at=""),
    Row("table that is none", (SHAKING, "amplitude 3;", "amplitude table (0 3 1 2);"), "table ((t v) (t v) ...)"),
    Row("table without pairs", (SHAKING, "amplitude 3;", "amplitude table ();"), "one pair at least"),
    Row("table back in time", (SHAKING, "amplitude 3;", "amplitude table ((0 3) (0.1 2) (0.1 1));"), "0.1 follows 0.1"),
    Row("gamma at the top", (PROPERTIES, "cooling Haff;", "cooling Haff; gamma 1.4;"), "it belongs in  GoldshteinShapiroCoeffs"),
    Row("diameter at the top", (PROPERTIES, "cooling Haff;", "cooling Haff; diameter 0.1;"), "it belongs in  grain { diameter ..; }"),
    Row("misnamed properties", rename(PROPERTIES, "constant/granularPropertis"), "did you mean 'constant/granularProperties'? rename it",
        "granularProperties: cannot open", where="constant/granularPropertis"),
    Row("misnamed density", rename("0/alpha", "0/alfa"), "did you mean '0/alpha'? rename it", "neither rho nor alpha is there",
        "rho = p/(R T)", "docs/fromOpenFOAM.md", where="0/alfa"),
    Row("gravity that is a number", (GRAVITY, "value (1 -2 0);", "value -9.81;"), "(x y z)", "(0 -9.81 0)"),
    Row("ramp of the frequency", (SHAKING, "frequency 1;", "frequency table ((0 20) (1 30));"), "expected a number"),
    Row("frequency < 0", (SHAKING, "frequency 1;", "frequency -20;"), "frequency is -20", "greater than 0"),
    Row("minDeltaTFraction 2", (SOLUTION, "1e-3;", "2;"), "minDeltaTFraction is 2", "allowed is 0 .. 1"),
    Row("shaking without g", remove(GRAVITY), "constant/g is missing", where=SHAKING, at="type sinusoidal;"),
    Row("probe outside", (CONTROL, "(3 2 0.5)", "(30 2 0.5)"), "(30 2 0.5)", "outside the mesh", "allowOutside yes;"),
    Row("probes of two numbers", (CONTROL, "(3 2 0.5)", "(3 2)"), "'probeLocations'", "((x y z) ...)"),
    Row("line outside", (CONTROL, "start (0.5 1 0.5);\n                end (5 1 0.5);",
                         "start (0.5 9 0.5);\n                end (5 9 0.5);"), "no point of the line", "mesh"),
    Row("nPoints 1", (CONTROL, "nPoints 5;", "nPoints 1;"), "nPoints is 1", "2 .. "),
    # dimensions
    Row("unit of g", (GRAVITY, "[0 1 -2 0 0 0 0]", "[0 1 -1 0 0 0 0]"), "[0 1 -1 0 0 0 0]", "[0 1 -2 0 0 0 0]"),
    Row("unit of the value of g", (GRAVITY, "value (1", "value [0 1 0 0 0 0 0] (1"), "[0 1 -2 0 0 0 0]"),
    Row("unit of a diameter", (PROPERTIES, "diameter 0.1;", "diameter [1 0 0 0 0 0 0] 0.1;"), "[0 1 0 0 0 0 0]"),
    Row("unit of a number without one", (PROPERTIES, "restitution 0.9;", "restitution [0 0 1 0 0 0 0] 0.9;"),
        "[0 0 0 0 0 0 0]"),
    Row("gravity along an empty axis, of disks", both(OF_DISKS, replace(GRAVITY, "(1 -2 0)", "(1 -2 9.81)")),
        "TorquatoDisks is for disks, which move in a plane", "along z, out of it", at="equationOfState T", where=PROPERTIES),
    # grammar
    Row("brace not closed", (PROPERTIES, "restitution 0.9;\n}", "restitution 0.9;\n"), "'{'", "not closed",
        at="{\n    diameter"),
    Row("brace too many", (SCHEMES, "timeScheme SSPRK3;", "} timeScheme SSPRK3;"), "found '}'", "no '{' is open"),
    Row("bracket not closed", (CONTROL, "probeLocations ((0.5", "probeLocations (((0.5"), "'('", "is open"),
    Row("bracket too many", (CONTROL, "(3 2 0.5));", "(3 2 0.5)));"), "')'", "no bracket is open"),
    Row("string not closed", (CONTROL, "application granularGas;", 'application "granularGas;'), "not closed"),
    Row("comment not closed", (CONTROL, "deltaT 0.001;", "/* deltaT 0.001;"), "/* is not closed"),
    Row("include loop", both(append(CONTROL, '#include "more"\n'), write("system/more", '\n#include "controlDict"\n')),
        "includes itself", where="system/more", at='#include "controlDict"'),
    Row("included file not there", (CONTROL, "maxCo 0.5;", '#include "Courant"'), "no file", "system/Courant"),
    Row("mistake in an included file", both(replace(CONTROL, "maxCo 0.5;", '#include "Courant"'),
                                            write("system/Courant", "// more\nmaxC0 0.5;\n")),
        "did you mean 'maxCo'?", where="system/Courant", at="maxC0"),
    Row("macro that is not there", (CONTROL, "maxCo 0.5;", "maxCo $Co;"), "$Co", "stands before it"),
    Row("eval: syntax", (CONTROL, "maxCo 0.5;", "maxCo #eval{ 2 * };"), "2 *"),
    Row("eval: unknown name", (CONTROL, "maxCo 0.5;", "maxCo #eval{ 2 * limit };"), "limit"),
    Row("eval: division by zero", (CONTROL, "maxCo 0.5;", "maxCo #eval{ 1 / 0 };"), "1 / 0"),
    Row("shell", (CONTROL, "type fieldMinMax;", "type systemCall; executeCalls (\"ls\");"), "systemCall", "allowed are"),
    Row("code", (CONTROL, "maxCo 0.5;", "maxCo #codeStream { code #{ return 1; #}; };"), "no code is run"),
    Row("#if without #endif", (CONTROL, "maxCo 0.5;", "#if yes\nmaxCo 0.5;"), "#if has no #endif", at=""),
    Row("a binary file as a dictionary", write(SCHEMES, "\x01\x02\x03 fluxScheme common;"), "byte 0x01", where=SCHEMES),
    # numbers beyond all that is physical: products of them are infinite, or 0
    Row("huge phase", (SHAKING, "phase 0;", "phase 1e300;"), "'phase'", "between 1e-60 and 1e+60"),
    Row("huge gravity", (GRAVITY, "value (1 -2 0);", "value (1 -1e300 0);"), "'value'", "between 1e-60 and 1e+60"),
    Row("tiny diameter", (PROPERTIES, "diameter 0.1;", "diameter 1e-300;"), "'diameter'", "between 1e-60 and 1e+60"),
    Row("huge time", (CONTROL, "endTime 0.002;", "endTime 1e300;"), "'endTime'", "between 1e-60 and 1e+60"),
    # files
    Row("no controlDict", remove(CONTROL), "No such file", where=CONTROL),
    Row("no fvSchemes", remove(SCHEMES), "No such file", where=SCHEMES),
    Row("no fvSolution", remove(SOLUTION), "No such file", where=SOLUTION),
    Row("no granularProperties", remove(PROPERTIES), "No such file", where=PROPERTIES),
    Row("folder for a file", folder_instead(SCHEMES), "is no file", where=SCHEMES),
    Row("folder for a field", folder_instead("0/T"), "is no file", where="0/T"),
    Row("no time folder", lambda case: shutil.rmtree(os.path.join(case, "0")), "no time folder", "/0"),
    Row("broken gzip", both(remove(SCHEMES), write(SCHEMES + ".gz", "\x1f\x8b broken")), SCHEMES + ".gz"),
]

FIELDS = [
    Row("wrong dimensions of a field", ("0/T", "[0 2 -2 0 0 0 0]", "[0 0 0 1 0 0 0]"), "[0 0 0 1 0 0 0]",
        "[0 2 -2 0 0 0 0]", "it is no kelvin"),
    Row("no dimensions", ("0/T", "dimensions [0 2 -2 0 0 0 0];\n", ""), "'dimensions' is missing", at=""),
    Row("dimensions of four numbers", ("0/T", "[0 2 -2 0 0 0 0]", "[0 2 -2 0]"), "5 or 7 numbers"),
    Row("rho and alpha", lambda case: shutil.copy(os.path.join(case, "0/alpha"), os.path.join(case, "0/rho")),
        "both rho and alpha", "remove one", where="0"),
    Row("T and p", lambda case: shutil.copy(os.path.join(case, "0/T"), os.path.join(case, "0/p")), "both T and p",
        "remove one", where="0"),
    Row("neither rho nor alpha", remove("0/alpha"), "neither rho nor alpha", "give one", where="0"),
    Row("neither T nor p", remove("0/T"), "neither T nor p", "give one", where="0"),
    Row("no U", remove("0/U"), "no such file", where="0/U"),
    Row("nan uniform", ("0/T", "uniform 25;\nboundary", "uniform nan;\nboundary"), "'nan'", "finite"),
    Row("inf in a list", ("0/alpha", "0.207", "inf"), "'inf'", "expected a number"),
    Row("huge uniform", ("0/U", "uniform (1 0.5 0);\nboundary", "uniform (1 -1e300 0);\nboundary"), "cell 0", "(1 -1e+300 0)", "between -1e60 and 1e60"),
    Row("huge in a list", ("0/alpha", "0.207", "1e200"), "cell 7", "1e+200", "between -1e60 and 1e60"),
    Row("huge on a patch", ("0/U", "value uniform (1 0.5 0);", "value uniform (1e300 0.5 0);"), "patch xLow", "between -1e60 and 1e60"),
    Row("huge parameter of a patch", ("0/U", "type slip;", "type frictionalSlip; muWall 1e300;"), "patch xHigh", "muWall", "between 1e-60 and 1e+60"),
    Row("nan in a list", ("0/alpha", "0.207", "nan"), "'nan'", "expected a number"),
    Row("T < 0", ("0/T", "uniform 25;\nboundary", "uniform -25;\nboundary"), "cell 0 at (0.5 0.5 0.5): T is -25",
        "greater than 0"),
    Row("T = 0", ("0/T", "uniform 25;\nboundary", "uniform 0;\nboundary"), "T is 0", "greater than 0"),
    Row("T < 0 at a patch", ("0/T", "value uniform 25;", "value uniform -25;"), "patch xLow", "-25",
        at="value uniform -25;"),
    Row("alpha > alphaMax in one cell", ("0/alpha", "0.207", "0.7"), "cell 7 at (1.5 1.5 0.5): alpha is 0.7",
        "between 0 and 0.65"),
    Row("alpha = alphaMax", ("0/alpha", "0.207", "0.65"), "alpha is 0.65", "between 0 and 0.65"),
    Row("alpha > alphaMax uniform", write("0/alpha", bad_case.FILES["0/alpha"][1].replace(
        bad_case.LIST, "uniform 0.7;\n")), "cell 0 at", "alpha is 0.7", where="0/alpha", at="uniform 0.7;"),
    Row("alpha > alphaMax from an expression",
        ("0/alpha", "internalField", 'expression "0.2 + 0.1*x";\ninternalField'), "cell 4 at (4.5 0.5 0.5)",
        "alpha is 0.65"),
    Row("alpha > alphaMax at a patch", ("0/alpha", "value uniform 0.2;", "value uniform 0.66;"), "patch xLow", "0.66",
        "0.65", at="value uniform 0.66;"),
    Row("expression: syntax", ("0/T", "internalField", 'expression "25 + * x";\ninternalField'), "25 + * x", "column"),
    Row("expression: function", ("0/T", "internalField", 'expression "25 + sinn(x)";\ninternalField'), "'sinn'",
        "did you mean 'sin' or 'sinh'?"),
    Row("expression: variable", ("0/T", "internalField", 'expression "25 + r";\ninternalField'), "'r'", "x y z t"),
    Row("expression: not finite", ("0/T", "internalField", 'expression "25/(x - 1.5)";\ninternalField'), "cell 1 at",
        "gives inf"),
    Row("expression: one for a vector", ("0/U", "internalField", 'expression "x";\ninternalField'), "1 expression",
        "3 components"),
    Row("wrong count", ("0/alpha", "24\n(", "25\n("), "25 entries", "has 24", at=""),
    Row("too few values", ("0/alpha", "24\n(\n0.2\n", "23\n(\n"), "23 values", "24", at="internalField"),
    Row("one value too many", ("0/alpha", "0.207", "0.207 0.208"), "24 entries", "has more", at=""),
    Row("vector in a scalar field", ("0/T", "uniform 25;\nboundary", "uniform (1 0 0);\nboundary"), "'('", "finite number"),
    Row("scalar in a vector field", ("0/U", "uniform (1 0.5 0);\nboundary", "uniform 1;\nboundary"), "'1'", "'('"),
    Row("vector of two in U", ("0/U", "uniform (1 0.5 0);\nboundary", "uniform (1 0.5);\nboundary"), "')'", "number"),
    Row("vector of four in U", ("0/U", "uniform (1 0.5 0);\nboundary", "uniform (1 0.5 0 0);\nboundary"), "')'"),
    Row("List<vector> in a scalar field", ("0/alpha", "List<scalar>", "List<vector>"), "List<vector>", "List<scalar>"),
    Row("neither uniform nor nonuniform", ("0/T", "uniform 25;\nboundary", "constant 25;\nboundary"), "'constant'",
        "uniform VALUE;"),
    Row("no internalField", ("0/T", "internalField uniform 25;\n", ""), "'internalField' is missing", at=""),
    Row("velocity along an empty axis, of disks",
        both(OF_DISKS, replace("0/U", "uniform (1 0.5 0);\nboundary", "uniform (1 0.5 3);\nboundary")),
        "TorquatoDisks is for disks, which move in a plane", "along z, out of it", at="equationOfState T", where=PROPERTIES),
    Row("field cut short", cut("0/alpha", 0.5), where="0/alpha"),
    Row("empty field file", write("0/T", ""), "'dimensions' is missing", where="0/T"),
    Row("no boundaryField", ("0/T", "boundaryField", "boundaryfield"), "'boundaryField' is missing",
        "did you mean 'boundaryField'?", at="boundaryfield"),
    # patches
    Row("a wall that nothing moves through, by a value", ("0/U", "type slip;", "type fixedValue; value uniform (0 0 0);"),
        "patch xHigh: U is 'fixedValue', which lets gas through", "type slip;", "type patch there"),
    Row("a wall that draws gas", ("0/U", "type slip;", "type fixedValue; value uniform (0 -5 0);"), "lets gas through"),
    Row("a wall that is open", ("0/U", "type slip;", "type zeroGradient;"), "U is 'zeroGradient', which lets gas through"),
    Row("an open wall in viscous gas", both(garzo_dufty(""), replace("0/U", "type slip;", "type zeroGradient;")),
        "say here  type noSlip;", where="0/U", at="type zeroGradient;"),
    Row("patch by a wrong expression", ("0/T", "    xHigh\n", '    "xHi.*t"\n'), "no entry for patch 'xHigh'",
        "'xHi.*t' fits no patch", at=""),
    Row("expression that fits no patch", ("0/T", "    xHigh\n", '    "wal.*" { type slip; }\n    xHigh\n'), "'wal.*' is not used",
        "known here: xLow xHigh"),
    Row("patch without entry", ("0/T", "    xHigh\n    {\n        type slip;\n    }\n", ""), "no entry for patch 'xHigh'",
        at="boundaryField"),
    Row("misspelt patch", ("0/T", "xHigh", "xHihg"), "no entry for patch 'xHigh'", "did you mean 'xHigh'?"),
    Row("entry for no patch", ("0/T", "    xHigh\n", "    top { type slip; }\n    xHigh\n"), "'top'", "xLow"),
    Row("unknown boundary type", ("0/T", "type slip;", "type slipp;"), "slipp", "allowed are", "did you mean 'slip'?"),
    Row("noSlip on a scalar", ("0/T", "type slip;", "type noSlip;"), "noSlip", "allowed are", "zeroGradient"),
    Row("moving wall without viscosity", ("0/U", "type slip;", "type translatingWallVelocity; U (0 1 0);"),
        "'translatingWallVelocity'", "transport"),
    Row("moving wall without U", ("0/U", "type slip;", "type translatingWallVelocity; u (0 1 0);"), "'U' is missing", at="    xHigh"),
    Row("wall with friction in a gas without", ("0/U", "type slip;", "type frictionalSlip; muWall 0.3;"), "patch xHigh: U is 'frictionalSlip' with muWall",
        "friction { type muI; }"),
    Row("wall with friction without muWall", ("0/U", "type slip;", "type frictionalSlip;"), "'muWall' is missing", at="    xHigh"),
    Row("muWall below 0", ("0/U", "type slip;", "type frictionalSlip; muWall -1;"), "at least 0"),
    Row("wall with friction that leads through", both(replace(PROPERTIES, "transport none;", "transport none; friction { type muI; }"),
                                                      replace("0/U", "type slip;", "type frictionalSlip; muWall 0.3; U (1 0 0);")),
        "leads through the wall", at="type frictionalSlip;", where="0/U"),
    Row("wall that rotates without viscosity", ("0/U", "type slip;", "type rotatingWallVelocity; origin (0 0 0); axis (1 0 0); omega 3;"),
        "'rotatingWallVelocity'", "transport"),
    Row("wall that rotates without omega", ("0/U", "type slip;", "type rotatingWallVelocity; origin (0 0 0); axis (1 0 0);"),
        "'omega' is missing", at="    xHigh"),
    Row("wall that rotates without an origin", ("0/U", "type slip;", "type rotatingWallVelocity; axis (1 0 0); omega 3;"),
        "'origin' is missing", at="    xHigh"),
    Row("wall that rotates about a point", ("0/U", "type slip;", "type rotatingWallVelocity; origin (0 0 0); axis (0 0 0); omega 3;"),
        "axis", "a direction has a length"),
    Row("wall that rotates into the gas", ("0/U", "type slip;", "type rotatingWallVelocity; origin (0 0 0); axis (0 0 1); omega 3;"),
        "would push the gas at the face at", "surface of revolution", "check origin and axis"),
    Row("wall that rotates by place", ("0/U", "type slip;", 'type rotatingWallVelocity; origin (0 0 0); axis (1 0 0); omega "3*y";'),
        "omega", "it may depend on t alone"),
    Row("wall that rotates by half an expression", ("0/U", "type slip;", 'type rotatingWallVelocity; origin (0 0 0); axis (1 0 0); omega "3*";'),
        'omega "3*"'),
    Row("wall that rotates by two rules", ("0/U", "type slip;", "type frictionalSlip; muWall 0.3; origin (0 0 0); axis (1 0 0); omega 3; "
                                           'expression ("0" "t" "0");'), "omega says how the wall moves; remove one of the two"),
    Row("moving wall that is a number", ("0/U", "type slip;", "type translatingWallVelocity; U 1;"), "'U'", "(x y z)"),
    Row("misspelt moving wall", ("0/U", "type slip;", "type translatingwallvelocity; U (0 1 0);"),
        "did you mean 'translatingWallVelocity'?"),
    Row("wall that takes heat without conduction", ("0/T", "type slip;", "type granularWall; restitution 0.9;"),
        "T is 'granularWall'", "transport"),
    Row("calculated on U", ("0/U", "type slip;", "type calculated;"), "calculated", "allowed are"),
    Row("calculated that says nothing", ("0/T", "type slip;", "type calculated;"), "'calculated'", "give its type"),
    Row("no type", ("0/T", "type slip;", ""), "'type' is missing", at="    xHigh"),
    Row("empty on a patch that is not", ("0/T", "type slip;", "type empty;"), "of type wall", "constant/polyMesh/boundary"),
    Row("not empty on a patch that is", ("0/T", "type empty;", "type slip;"), "of type empty", "must have type empty"),
    Row("cyclic on a patch that is not", ("0/U", "type slip;", "type cyclic;"), "of type wall", "cyclic"),
    Row("not cyclic on a patch that is", ("0/U", "yLow\n    {\n        type cyclic;",
                                          "yLow\n    {\n        type zeroGradient;"), "must have type cyclic",
        at="        type zeroGradient;"),
    Row("symmetryPlane on a wall", ("0/U", "type slip;", "type symmetryPlane;"), "of type wall", "symmetryPlane"),
    Row("fixedValue without value", ("0/T", "        value uniform 25;\n", ""), "'value' is missing", at="    xLow"),
    Row("inletOutlet without inletValue", ("0/T", "type fixedValue;", "type inletOutlet;"), "'inletValue' is missing",
        at="    xLow"),
    Row("scalar value in a vector patch", ("0/U", "value uniform (1 0.5 0);", "value uniform 1;"), "'1'", "'('"),
    Row("list of the wrong length on a patch", ("0/T", "value uniform 25;", "value nonuniform List<scalar> 3(25 25 25);"),
        "3 values", "4"),
    Row("expression of a patch without value", ("0/T", "value uniform 25;", 'expression "25";'), "'value' is missing", at="    xLow"),
    Row("expression of a patch, misspelt", ("0/T", "value uniform 25;", 'value uniform 25; expresion "25";'), "'expresion' is not used",
        "did you mean 'expression'?"),
    Row("expression of a patch that ends early", ("0/T", "value uniform 25;", 'value uniform 25; expression "25 +";'), "expression \"25 +\"",
        "column 5", "patch xLow"),
    Row("expression of a patch as a value", ("0/T", "value uniform 25;", 'value expression "25";'), "'value' is  uniform VALUE;"),
    Row("expression at a smooth wall", ("0/U", "type slip;", 'type slip; expression ("0" "0" "0");'), "'expression' is not used"),
    Row("two expressions for a vector", ("0/U", "value uniform (1 0.5 0);", 'value uniform (1 0.5 0); expression ("1" "0");'),
        "it holds 2 expressions", "wanted are three"),
    Row("infinite expression of a patch", ("0/T", "value uniform 25;", 'value uniform 25; expression "25/(y - 1.5 < 0)";'),
        "gives inf at the face at (0 1.5 0.5), t = 0; it must lie between -1e60 and 1e60"),
    Row("expression of a patch out of range", ("0/T", "value uniform 25;", 'value uniform 25; expression "25 - 20*y";'),
        "patch xLow: expression gives -5 at the face at (0 1.5 0.5), t = 0; it must be greater than 0"),
    Row("expression of alpha beyond packing", ("0/alpha", "value uniform 0.2;", 'value uniform 0.2; expression "0.2*y";'),
        "patch xLow: expression gives 0.7 at the face at (0 3.5 0.5)", "alphaMax"),
    Row("table that does not rise", ("0/T", "type fixedValue;", "type uniformFixedValue; uniformValue table ((0 25) (1 26) (1 27));"),
        "its times must rise: 1 follows 1"),
    Row("table with a bad value at a later time", ("0/T", "type fixedValue;", "type uniformFixedValue; uniformValue table ((0 25) (9 -1));"),
        "uniformValue gives -1", "t = 9; it must be greater than 0"),
    Row("table of triples", ("0/T", "type fixedValue;", "type uniformFixedValue; uniformValue table ((0 25 1));"), "table ((t v) (t v) ...)"),
    Row("table of scalars for a vector", ("0/U", "type fixedValue;", "type uniformFixedValue; uniformValue table ((0 1));"),
        "table ((t (x y z)) (t (x y z)) ...)"),
    Row("table that miscounts", ("0/T", "type fixedValue;", "type uniformFixedValue; uniformValue table 3 ((0 25) (1 26));"),
        "says 3 entries, but has 2"),
    Row("empty table", ("0/T", "type fixedValue;", "type uniformFixedValue; uniformValue table ();"), "table ((t v) (t v) ...)"),
    Row("table that goes on", ("0/T", "type fixedValue;", "type uniformFixedValue; uniformValue table ((0 25)) 4;"), "nothing behind it"),
    Row("function of an unknown kind", ("0/T", "type fixedValue;", "type uniformFixedValue; uniformValue sine;"), "sine", "constant NUMBER"),
    Row("function that is missing", ("0/T", "type fixedValue;", "type uniformFixedValue;"), "'uniformValue' is missing", at="    xLow"),
    Row("misspelt type that varies", ("0/T", "type fixedValue;", "type exprFixedvalue; valueExpr \"25\";"), "did you mean 'exprFixedValue'?"),
    Row("valueExpr in another grammar", ("0/T", "type fixedValue;", 'type exprFixedValue; valueExpr "25 + t";'), "column 6", "found 't'",
        "pos().x()", "time()"),
    Row("valueExpr with a power", ("0/T", "type fixedValue;", 'type exprFixedValue; valueExpr "5^2";'), "pow(a, b)"),
    Row("valueExpr of another field", ("0/T", "type fixedValue;", 'type exprFixedValue; valueExpr "2*alpha";'), "found 'alpha'"),
    Row("valueExpr of a scalar for U", ("0/U", "type fixedValue;", 'type exprFixedValue; valueExpr "1";'), "vector(a, b, c)"),
    Row("valueExpr of a vector for T", ("0/T", "type fixedValue;", 'type exprFixedValue; valueExpr "vector(1, 0, 0)";'), "the field is a scalar"),
    Row("valueExpr with variables", ("0/T", "type fixedValue;", 'type exprFixedValue; valueExpr "25"; variables ("a = 1");'),
        "'variables' is not used"),
    Row("mass flux through a wall", ("0/U", "type slip;", "type flowRateInletVelocity; massFlowRate 1;"), "xHigh is a wall", "nothing flows"),
    Row("negative mass flux", ("0/U", "type fixedValue;", "type flowRateInletVelocity; massFlowRate -1;"), "a rate of 0 or more"),
    Row("mass flux that turns", ("0/U", "type fixedValue;", "type flowRateInletVelocity; massFlowRate table ((0 1) (1 -1));"),
        "t = 1; it must lead into the domain"),
    Row("two rates", ("0/U", "type fixedValue;", "type flowRateInletVelocity; massFlowRate 1; volumetricFlowRate 1;"), "remove one"),
    Row("no rate", ("0/U", "type fixedValue;", "type flowRateInletVelocity;"), "'massFlowRate' is missing", at="    xLow"),
    Row("profile of a rate", ("0/U", "type fixedValue;", "type flowRateInletVelocity; massFlowRate 1; extrapolateProfile yes;"),
        "the profile is uniform"),
    Row("mass flux of a scalar", ("0/T", "type fixedValue;", "type flowRateInletVelocity; massFlowRate 1;"), "allowed are"),
    Row("mass flux with implicit acoustics", both(replace("0/U", "type fixedValue;", "type flowRateInletVelocity; massFlowRate 1;"),
                                                  append(SOLUTION, "acoustics { type implicit; }\n")),
        "a flow rate is for explicit acoustics", at="type flowRateInletVelocity", where="0/U"),
    Row("moving wall by a table without viscosity", ("0/U", "type slip;", "type translatingWallVelocity; U table ((0 (0 1 0)));"),
        "'translatingWallVelocity'", "transport"),
    Row("moving wall whose table leads through", ("0/U", "type slip;", "type translatingWallVelocity; U table ((0 (0 1 0)) (1 (1 1 0)));"),
        "U gives (1 1 0)", "t = 1; it must lead along the wall"),
    Row("moving wall by a table and an expression", ("0/U", "type slip;", "type translatingWallVelocity; U table ((0 (0 1 0))); "
                                                     'expression ("0" "t" "0");'), "U is a table; remove one"),
    Row("fixed T at a slip wall", ("0/T", "type slip;", "type fixedValue; value uniform 25;"), "patch xHigh", "wall",
        "zeroGradient"),
]

# program and arguments (CASE: a sound case that has run; MSH: a sound mesh file), what the message holds
COMMANDS = [
    (["granularGas", "-cse", "CASE"], "'-cse'", "did you mean '-case'?"),
    (["granularGas", "-case", "CASE", "-dryrun"], "'-dryrun'", "did you mean '-dry-run'?"),
    (["granularGas", "-case"], "-case wants a value"),
    (["granularGas", "CASE"], "unknown argument", "-case"),
    (["granularGas", "-case", "CASE", "-parallel"], "say  -np N ", "mpirun -np N", "no decomposePar"),
    (["granularGas", "-case", "CASE/nowhere"], "CASE/nowhere: no such folder"),
    (["granularGas", "-case", "CASE/0/T"], "CASE/0/T: is no folder"),
    (["granularGas", "-case", "CASE", "-np", "two"], "-np two", "whole number"),
    (["granularGas", "-case", "CASE", "-np", "0"], "-np 0", "from 1"),
    (["granularGas", "-case", "CASE", "-np", "100000"], "-np 100000: this machine has", "say  -np "),
    (["granularGas", "-case", "CASE", "-listModel"], "did you mean '-listModels'?"),
    (["granularGas", "-case", "CASE/system"], "system/controlDict", "cannot open"),
    (["checkCase"], "usage: checkCase DIR"),
    (["checkCase", "CASE/nowhere"], "CASE/nowhere: no such folder"),
    (["checkCase", "-hepl"], "'-hepl'", "did you mean '-help'?"),
    (["checkCase", "CASE", "CASE"], "unknown argument"),
    (["gmshToCase"], "usage: gmshToCase MESH.msh -case DIR"),
    (["gmshToCase", "MSH"], "usage: gmshToCase MESH.msh -case DIR"),
    (["gmshToCase", "MSH", "-case"], "-case wants a value"),
    (["gmshToCase", "MSH", "-case", "CASE/nowhere"], "no such folder"),
    (["gmshToCase", "MSH", "-case", "CASE", "-binry"], "'-binry'", "did you mean '-binary'?"),
    (["gmshToCase", "CASE/0/T", "-case", "CASE"], "CASE/0/T:1:", ".msh"),
    (["gmshToCase", "CASE", "-case", "CASE"], "CASE: is no file"),
    (["caseToVTK"], "usage: caseToVTK DIR"),
    (["caseToVTK", "CASE/nowhere"], "no such folder"),
    (["caseToVTK", "CASE/system"], "no time folders"),
    (["caseToVTK", "CASE", "-tim", "0"], "'-tim'", "did you mean '-time'?"),
    (["caseToVTK", "CASE", "-time"], "-time wants a value"),
    (["caseToVTK", "CASE", "-time", "7"], "no time '7'", "there are: 0 0.001 0.002"),
    (["caseToVTK", "CASE", "-time", "last"], "no time 'last'"),
    (["caseToVTK", "CASE", "-fields", "alpa"], "0/alpa: no such field", "did you mean 'alpha'?"),
]
