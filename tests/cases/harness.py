"""Runs short forms of the cases through the real programs, in a temporary folder."""
import os
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = os.environ.get("HAFF_SOURCE", os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..")))
BIN = os.environ.get("HAFF_BIN", os.path.join(SOURCE, "build", "bin"))
sys.path.insert(0, os.path.join(SOURCE, "postprocessing"))

import expected  # noqa: E402
import haff  # noqa: E402
from tests.cases import boxes  # noqa: E402


def program(name, *arguments, ranks=1, check=True, timeout=900):
    """Runs a program of haff; a failure shows its output."""
    command = [os.path.join(BIN, name), *arguments]
    if ranks > 1:
        command = [os.path.join(BIN, "mpirun"), "-np", str(ranks), *command]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
    if check and done.returncode:
        raise AssertionError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    return done


def copy(name, folder):
    """Copy of a shipped case without results, in a new folder inside `folder`."""
    target = os.path.join(tempfile.mkdtemp(dir=folder), name)
    shutil.copytree(os.path.join(SOURCE, "cases", name), target,
                    ignore=shutil.ignore_patterns("[1-9]*", "0.*", "*.msh", "polyMesh", "postProcessing", "VTK", "e0.*"))
    return target


def edit(case, file, **entries):
    """Sets the first entry `key value;` of each key in a dictionary; it must be there."""
    path = os.path.join(case, file)
    with open(path) as f:
        text = f.read()
    for key, value in entries.items():
        text, count = re.subn(rf"\b{key}(\s+)[^;{{}}]*;", rf"{key}\g<1>{value};", text, count=1)
        if not count:
            raise KeyError(f"{path} has no entry {key}")
    with open(path, "w") as f:
        f.write(text)


def drop_vtk(case):
    """Tests of numbers need no VTK files."""
    path = os.path.join(case, "system", "controlDict")
    with open(path) as f:
        text = f.read()
    with open(path, "w") as f:
        f.write(re.sub(r"^ *vtk +\{[^}]*\}\n", "", text, flags=re.M))


def mesh(case, cells):
    """mesh.geo with N = cells through gmsh and gmshToCase."""
    msh = os.path.join(case, "mesh.msh")
    subprocess.run(["gmsh", "-3", "-v", "2", "-setnumber", "N", str(cells), os.path.join(case, "mesh.geo"), "-o", msh],
                   check=True, capture_output=True)
    program("gmshToCase", msh, "-case", case)


def run(case, ranks=1, **control):
    """The solver, with entries of controlDict changed; returns the case with its results."""
    if control:
        edit(case, "system/controlDict", **control)
    drop_vtk(case)
    program("granularGas", "-case", case, ranks=ranks)
    return haff.Case(case)


class Folder:
    """A temporary folder for the tests of a class: self.folder."""

    @classmethod
    def setUpClass(cls):
        cls._temporary = tempfile.TemporaryDirectory(prefix="haff")
        cls.folder = cls._temporary.name

    @classmethod
    def tearDownClass(cls):
        cls._temporary.cleanup()

    def short(self, name, cells, **control):
        """A shipped case on another grid."""
        case = copy(name, self.folder)
        mesh(case, cells)
        return run(case, **control)

    def compare(self, case, entries):
        """Every entry of expected.json, each a subtest."""
        self.assertTrue(entries)
        for entry in entries:
            with self.subTest(expected.describe(entry)):
                value = expected.measure(case, entry)
                self.assertLessEqual(abs(value - entry["value"]), entry["tolerance"],
                                     f"{value:.9g}, expected {entry['value']:.9g}: {entry['source']}")


def entries(name, **wanted):
    """The short entries of a case's expected.json that have these properties (or do not mention them)."""
    path = os.path.join(SOURCE, "cases", name)
    return [e for e in expected.load(path, "short") if all(e.get(k, v) == v for k, v in wanted.items())]


CONTROL = """application granularGas; startFrom latestTime; startTime 0; stopAt endTime; endTime {end!r};
deltaT {step!r}; adjustTimeStep {adjust}; maxCo 0.5; writeControl {control}; writeInterval {interval!r};
writeFormat {format}; writePrecision {digits}; writeCompression {compression}; timeFormat general; timePrecision 12;
runTimeModifiable no;
"""
PROPERTIES = """grain {{ diameter 0.1; mass 1; restitution {e!r}; }}
equationOfState {eos};
{eos}Coeffs {{ gamma 1.6666666666666667; }}
cooling {cooling}; transport none;
"""
SCHEMES = "fluxScheme {flux}; reconstruct {reconstruct}; timeScheme SSPRK3;\n"
STANDARD = {"eos": "GoldshteinShapiro", "e": 1.0, "cooling": "none", "flux": "common", "reconstruct": "PHM", "adjust": "yes", "step": 1e-6,
            "control": "adjustableRunTime", "interval": None, "format": "binary", "digits": 17, "compression": "off", "types": None, "slip": ()}


def write_dictionary(case, location, name, text):
    os.makedirs(os.path.join(case, location), exist_ok=True)
    with open(os.path.join(case, location, name), "w") as f:
        f.write(boxes.header("dictionary", name, location) + text)


def box_case(case, n, size, rho, u, p, end, **options):
    """A case on a box of n cells from arrays in the cells (u: [cells][3]). options: see STANDARD; types is for
    boxes.write_mesh, patches in `slip` are slip walls, all others are zero gradient, cyclic or empty."""
    o = {**STANDARD, **options}
    boxes.write_mesh(case, n, size, o["types"])
    rules = {"scalar": [], "U": []}
    for name, (kind, _, _) in haff.Mesh(os.path.join(case, "constant", "polyMesh")).patches.items():
        kind = kind if kind in ("empty", "cyclic") else "zeroGradient"
        rules["scalar"].append(f"{name} {kind}")
        rules["U"].append(f"{name} {'slip' if name in o['slip'] else kind}")
    for name, values in (("rho", rho), ("p", p), ("U", u)):
        boxes.write_field(case, name, values, "\n".join(rules.get(name, rules["scalar"])))
    o["interval"] = o["interval"] or end
    write_dictionary(case, "system", "controlDict", CONTROL.format(end=end, **o))
    write_dictionary(case, "system", "fvSchemes", SCHEMES.format(**o))
    write_dictionary(case, "system", "fvSolution", "")
    write_dictionary(case, "constant", "granularProperties", PROPERTIES.format(**o))
    if "gravity" in o:
        write_dictionary(case, "constant", "g", "dimensions [0 1 -2 0 0 0 0];\nvalue (%r %r %r);\n" % o["gravity"])
    return case
