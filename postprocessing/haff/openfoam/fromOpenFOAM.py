# SPDX-License-Identifier: GPL-3.0-or-later
"""A case of OpenFOAM's rhoCentralFoam, rhoPimpleFoam or sonicFoam as a case of haff.

    haff fromOpenFOAM CASE NEWCASE        writes NEWCASE, and says line by line what was taken, changed and dropped

The mesh is CASE's polyMesh or blockMeshDict (OpenFOAM's blockMesh makes a polyMesh where haff does not read the dictionary). p and T in
kelvin become rho = p/(R T) and T = R times kelvin, in m^2/s^2; the gas is perfect, elastic and inviscid. What has no counterpart is refused,
with its place and the cure. NEWCASE is new or empty; CASE is not touched. The lines stand in NEWCASE/fromOpenFOAM.txt, too; what is where:
docs/fromOpenFOAM.md. Exit code: 1 where there is no such case or no counterpart, 2 for a wrong command line.
"""
import os
import re
import subprocess
import sys
import tempfile

from haff import command, paths
from haff.case import foam
from haff.case.entries import EntryError
from haff.openfoam import control, dictionary, functions, state
from haff.openfoam.gas import Gas
from haff.openfoam.mesh import Converted
from haff.openfoam.report import Refused, Report
from haff.start import newCase

READ = {"constant": ("polyMesh", "thermophysicalProperties", "physicalProperties"),
        "system": ("controlDict", "fvSchemes", "blockMeshDict", "setFieldsDict"),
        "0": ("p", "T", "U", "rho", "uniform", "include", "phi", "rhoU", "rhoE")}
NO_TURBULENCE = "haff has no model of turbulence"
DROPPED = {"fvSolution": "solvers of equations that haff does not solve so", "decomposeParDict": "granularGas -np N deals the mesh out itself",
           **dict.fromkeys(("turbulenceProperties", "momentumTransport", "RASProperties", "LESProperties"), NO_TURBULENCE),
           "g": "rhoCentralFoam and its kin do not read it; copy it where gravity is meant",
           "fvOptions": "haff has the sources of granularGas -keywords sources", "radiationProperties": "haff has no radiation",
           "MRFProperties": "haff has no rotating frames", **dict.fromkeys(("chemistryProperties", "combustionProperties"), "haff has no chemistry"),
           **dict.fromkeys(("sample", "sampleDict"), "haff has such lines as function objects of the type sets, in controlDict")}
UNUSED = re.compile(r"fvSchemes:\d+: (\w+) is not used: .*\[unusedScheme\]")
ACCEPTED = {"temperature": "T is R times kelvin: sound is much faster than the flow",
            "openSide": "the state beyond a patch is given, whichever way U leads there"}


class Conversion:
    """case -> new, an empty folder."""

    def __init__(self, case, new, by_block_mesh=False):
        self.case, self.new, self.report = case, new, Report()
        self.accepted, self.unused = [], set()
        d = self.dictionary("system/controlDict")
        schemes = self.dictionary("system/fvSchemes")
        self.control = control.Control(d, schemes, newCase.version(), self.report)
        self.schemes = control.Schemes(schemes, self.control, self.report)
        self.refuse_motion()
        self.gas = Gas(case, self.report)
        self.mesh = Converted(case, new, self.report, by_block_mesh)
        self.folder = state.convert(case, new, d, self.mesh, self.gas, self.report)
        self.functions = functions.found_in(case, d, self.report)
        self.properties()
        self.write_schemes()
        self.write_control()
        self.say_rest()

    def dictionary(self, name):
        path = os.path.join(self.case, name)
        if not os.path.exists(path) and not os.path.exists(path + ".gz"):
            raise Refused(f"{path}: no such file: {self.case} is no case of OpenFOAM")
        return dictionary.read(path, self.case)

    def refuse_motion(self):
        path = os.path.join(self.case, "constant", "dynamicMeshDict")
        if os.path.exists(path) and dictionary.read(path, self.case).get("dynamicFvMesh", "") != "staticFvMesh":
            raise Refused("constant/dynamicMeshDict: the mesh moves; haff's meshes stand still")

    def properties(self):
        g = self.gas
        foam.write_dictionary(self.new, "constant", "granularProperties", f"""
// A perfect gas, elastic and inviscid: grains are its molecules. R = {g.R:.10g} m^2/s^2/K: the T of haff is R times kelvin.
grain {{ diameter {g.diameter:.6g}; mass {g.mass:.6g}; restitution 1; }}

equationOfState  perfectGas;
perfectGasCoeffs {{ gamma {g.gamma:.12g}; }}

cooling          none;
transport        none;
""")
        self.report.added("constant/granularProperties", f"perfectGas, gamma {g.gamma:.10g}, restitution 1, cooling none, transport none")

    def write_schemes(self):
        if self.mesh.has_corners():
            self.report.added("system/fvSchemes", "meshEngine polyhedral: along walls behind a corner that points into the gas the lattice engine "
                              "keeps a thicker hot layer (cases/forwardStep); meshEngine lattice takes half the time")
        foam.write_dictionary(self.new, "system", "fvSchemes", "\n" + control.schemes_text(self.schemes, self.control, self.mesh.has_corners(), self.unused))
        foam.write_dictionary(self.new, "system", "fvSolution", "\n// haff's defaults: granularGas -keywords lists what may stand here.\n")

    def write_control(self):
        lines = [f"{key:<17} {value};" for key, value in self.control.entries]
        if self.accepted:
            lines.append(f"{'acceptWarnings':<17} ({' '.join(self.accepted)});")
        self.text = foam.header("dictionary", "controlDict", "system") + "\n" + "\n".join(lines) + "\n\n" + functions.text_of(self.functions)
        with open(os.path.join(self.new, "system", "controlDict"), "w", encoding="latin-1") as f:
            f.write(self.text)

    def say_rest(self):
        """Files that nothing of haff reads."""
        for folder, known in READ.items():
            where = self.folder if folder == "0" else folder
            for name in sorted(os.listdir(os.path.join(self.case, where))):
                name = name.removesuffix(".gz")
                if name not in known and not name.endswith((".orig", "~", ".m4", ".unused")):
                    why = DROPPED.get(name) or ("no field of a perfect gas" if folder == "0" else "haff reads nothing of it")
                    self.report.dropped(f"{where}/{name}", why)
        with open(os.path.join(self.new, "case.foam"), "w", encoding="latin-1"):
            pass

    # ---- checkCase ----

    def check(self):
        """What checkCase warns of at the end. Function objects that it refuses are dropped; warnings that are meant are accepted."""
        for _ in range(functions.TRIES):
            done = subprocess.run([paths.program("checkCase"), "."], cwd=self.new, capture_output=True, text=True)
            unused = set(UNUSED.findall(done.stdout)) - self.unused
            if unused:  # the one of the two reconstructions that is for another kind of mesh
                self.unused |= unused
                self.write_schemes()
            elif done.returncode == 0:
                fresh = [name for name in ACCEPTED if f"[{name}]" in done.stdout and name not in self.accepted]
                if not fresh:
                    return re.findall(r"^warning: .*", done.stdout, re.M)
                self.accept(fresh)
            elif not self.drop_blamed(done.stderr):
                raise Refused("checkCase refuses the case that was to be written: " + re.sub(r"^error: ", "", done.stderr.strip(), flags=re.M))
        raise Refused(f"checkCase finds the same again: {done.stderr.strip()}")

    def accept(self, fresh):
        for name in fresh:
            self.accepted.append(name)
            self.report.added("system/controlDict", f"acceptWarnings {name}: {ACCEPTED[name]}")
        self.write_control()

    def drop_blamed(self, message):
        blamed = functions.blamed(message, self.text, self.functions)
        if not blamed:
            return False
        name, key = blamed
        said = " ".join(message.split()).removeprefix("error: ").split("controlDict:")[-1].split(": ", 1)[-1]
        if key and key in self.functions[name] and "not used" in message:
            del self.functions[name][key]
            self.report.dropped(self.functions[name].place, f"functions/{name}/{key}: {said}")
        else:
            self.report.dropped(self.functions.pop(name).place, f"functions/{name}: {said}")
        self.write_control()
        return True


def check_folders(case, new):
    if not os.path.isdir(os.path.join(case, "system")):
        raise Refused(f"{case} is no case directory (it has no folder 'system')")
    if os.path.lexists(new) and (not os.path.isdir(new) or os.listdir(new)):
        raise Refused(f"{new} is there, and not an empty folder: give another name; nothing is overwritten")


def convert(case, new):
    """Writes the new case: (Report, warnings of checkCase). Refused, FormatError, OSError."""
    check_folders(case, new)
    with tempfile.TemporaryDirectory(prefix="fromOpenFOAM") as folder:
        made, target = None, os.path.join(folder, "boxes")
        os.mkdir(target)
        try:
            made = Conversion(case, target)
            warnings = made.check()
        except Refused as why:
            if "blockMeshDict" not in str(why) or not made or not made.mesh.blocks:
                raise
            target = os.path.join(folder, "polyMesh")  # haff does not read the dictionary after all
            os.mkdir(target)
            made = Conversion(case, target, by_block_mesh=True)
            warnings = made.check()
        with open(os.path.join(target, "fromOpenFOAM.txt"), "w", encoding="utf-8") as f:
            f.write(f"haff fromOpenFOAM {case} {new}\n\n{made.report.text()}")
        newCase.move(target, new)
    return made.report, warnings


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case", metavar="CASE", help="a case of OpenFOAM")
    parser.add_argument("new", metavar="NEWCASE", help="a new folder")
    o = parser.parse_args()
    return command.ended("haff fromOpenFOAM", lambda: work(o))


def work(o):
    try:
        report, warnings = convert(o.case, o.new)
    except (ValueError, EntryError, OSError) as wrong:  # Refused and FormatError are ValueErrors
        print("error: " + re.sub(r"^(?=(constant|system|0|0[.]orig)/)", lambda _: os.path.join(o.case, ""), command.message(wrong)), file=sys.stderr)
        return 1
    print(report.text(), end="")
    for warning in warnings:
        print(warning.replace("./", os.path.join(o.new, ""), 1))
    print(f"\n{o.new} is a case, which checkCase finds {'sound' if not warnings else 'to be run with warnings'}. Now:\n\n    granularGas -case {o.new}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
