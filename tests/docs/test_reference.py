# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference of all keywords: -keywords, docs/reference.md, docs/examples.

Two ways to find a key that is read but not told, since each sees what the other cannot. A scan of the sources finds every call of a typed
read, also on ways that no case takes: its key is the text of a row, or stands there as a name that belongs to a table. Where a key counts,
the programs are asked: an unknown key in a dictionary makes them list all that they asked for there, by whatever way."""
import glob
import os
import re
import shutil
import subprocess
import tempfile
import unittest
import unittest.mock

import numpy as np

from tests.cases import harness
from tests.cases.harness import boxes

SOURCE = harness.SOURCE
DOCS = os.path.join(SOURCE, "docs")
PROGRAMS = {"granularGas": "gas", "granularMD": "grains", "granularDEM": "softGrains", "granularSegregation": "segregation", "gmshToCase": "gas"}

# Reads whose key is no text in the source: the name of a row of a table, or a name that the user gave.
TABLES = {
    "solvers/case/blockmesh.c": {"key", "name"},
    "solvers/case/changes.c": {"file[i].name"},
    "solvers/case/checksums.c": {"group_name[g]", "dict_key(group, i)"},
    "solvers/case/control.c": {"application",  # the name of the program
                               "dict_key(c->functions, i)"},
    "solvers/case/fields.c": {"key", "value"},
    "solvers/functions/functions.c": {"name", "key"},
    "solvers/functions/functions_patches.c": {"key"},
    "solvers/functions/functions_phase.c": {"key"},
    "solvers/functions/functions_sets.c": {"dict_key(all, i)"},
    "solvers/functions/functions_surfaces.c": {"dict_key(all, i)"},
    "solvers/case/varying.c": {"v->key", "key", "motion"},
    "solvers/case/version.c": {"*key", "sub", "key", "row->with.entry", "row->without.entry"},
    "solvers/gas/carried.c": {"name", "c->name", "dict_key(all, i)"},
    "solvers/gas/gas_medium.c": {"names[polyhedral]", "names[!polyhedral]"},  # reconstruct, polyReconstruct
    "solvers/functions/functions_means.c": {"key"},
    "solvers/functions/functions_average.c": {"key", "quantity_of(f, it->field)->name"},
    "solvers/gas/limiter.c": {"counts[i].key"},
    "solvers/gas/models.c": {"families[ENGINE].key"},
    "solvers/grains/grains_models.c": {"patch->name", "mesh->patch[p].name", "name", "kind[a].name", "kind[b].name", "dict_key(all, k)"},
    "solvers/programs/meshrules.c": {"rule->patch"},
    "solvers/programs/run.c": {"p->name"},
    "solvers/output/totals.c": {"first[i].name"},
    "solvers/segregation/segregation_models.c": {"key", "sub"},
}
# Files that programs write and read again: no user writes them.
WRITTEN = {
    "solvers/case/changes.c": {"cells", "meshChecksum", "version", "date", "dictionaries"},
    "solvers/case/checksums.c": {"size", "crc32", "files", "part"},
    "solvers/case/times.c": {"index"},
    "solvers/functions/functions_average.c": {"total", "averages", "lines"},
    "solvers/functions/functions_phase.c": {"counts"},
    "solvers/gas/limiter.c": {"energy", "fillMass", "fillEnergy", "pause", "paused", "place"},
}
READERS = ["dict_" + what for what in ("has sub sub_optional number number_or count_or switch_or word word_or vector choice words numbers "
                                       "vectors dimensions table raw").split()]
ARGUMENT = r"((?:[^,()]|\((?:[^()]|\([^()]*\))*\))+)"
ROW = re.compile(r"\b(?:NUMBER|WHOLE|SWITCH|VECTOR|CHOICE|EITHER|ONLY|NOTED|IGNORED)\(\s*\"([^\"]+)\"")


def sources(*folders):
    found = {}
    for folder in folders:
        for path in glob.glob(os.path.join(SOURCE, folder, "**", "*.[ch]"), recursive=True):
            with open(path, encoding="utf-8") as file:
                found[os.path.relpath(path, SOURCE)] = re.sub(r"/\*.*?\*/|^[ \t]*#define.*?(?<!\\)$", "", file.read(), flags=re.DOTALL | re.MULTILINE)
    return found


def reads(files):
    """(file, key as the source has it) of each call of a typed read, or of a function that hands its key to one."""
    wrappers = {name for text in files.values() for name in re.findall(r"\b(\w+)\((?:const )?struct dict \*\w+, const char \*\w+", text)}
    names = READERS + sorted(name for name in wrappers if not name.startswith("dict_"))
    call = re.compile(rf"(?<!status )(?<!char \*)\b(?:{'|'.join(names)})\(\s*{ARGUMENT},\s*{ARGUMENT}")
    return [(path, " ".join(found[2].split())) for path, text in files.items() for found in call.finditer(text)
            if not found[2].startswith("const char")]


def untold(files, names):
    """Complaints about reads and rows whose key is not among the names; and the exceptions above that were needed."""
    wrong, needed = [], set()
    for path, key in reads(files):
        known = names if key.startswith('"') else TABLES.get(path, set())
        if key.strip('"') in known:
            needed.add((path, key))
        elif key.startswith('"') and key.strip('"') in WRITTEN.get(path, set()):
            needed.add((path, key.strip('"')))
        elif key.startswith('"') or not path.startswith("solvers/dict/"):
            wrong.append(f"{path}: reads the key {key}, which no row tells of")
    for path, text in files.items():
        wrong += [f"{path}: the row {key} is in no reference" for key in ROW.findall(text) if key not in names]
        for table in set(re.findall(r"\bparams_read\([^;]*?,\s*(\w+_(?:param|type|table))\b", text)):
            where = text if re.search(rf"struct param {table}\[\]", text) else "".join(files.values())
            if not re.search(rf"keywords_params\(k,\s*&?{table}\b|go_through\(k, \w+, {table}\b", where):
                wrong.append(f"{path}: {table} is read, but goes into no reference")
    return wrong, needed


class Row:
    def __init__(self, file, inside, when, cells):
        self.files, self.inside, self.when = file.split(", "), inside, when
        self.word = cells[0].startswith("&nbsp;")
        self.value = re.search("`(.*)`", cells[0])[1]
        self.name = cells[1].removeprefix("word of ") if self.word else self.value
        self.type, self.standard, self.meaning = cells[1], cells[4], cells[5]
        self.example = cells[6].strip("`").replace("\\|", "|")


def reference(program):
    rows = []
    for line in harness.program(program, "-keywords", "-markdown").stdout.splitlines():
        if line.startswith("### "):
            place, _, when = line[4:].partition(", type ")
            file, _, inside = place.partition(": ")
        elif line.startswith("| ") and not line.startswith("| keyword"):
            rows.append(Row(file, inside, when, [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]))
    return rows


def takes_it(file, fields):
    """Does a boundary condition of these fields ("scalars", "U", "T") go into that file?"""
    return "U" in fields if file == "0.orig/U" else "scalars" in fields or (file == "0.orig/T" and "T" in fields)


class Sources(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rows = {program: reference(program) for program in PROGRAMS}
        cls.names = {part for rows in cls.rows.values() for row in rows for part in (row.name, *row.inside.split("/"))}

    def test_every_key_is_told(self):
        files = sources("solvers", "libcore")
        self.assertGreater(len(reads(files)), 80)
        self.assertGreater(sum(len(ROW.findall(text)) for text in files.values()), 150)
        wrong, needed = untold(files, self.names)
        self.assertEqual(wrong, [])
        for path, keys in [*TABLES.items(), *WRITTEN.items()]:
            self.assertEqual({key for key in keys if (path, key) not in needed}, set(), f"{path}: exceptions that nothing needs")

    def test_a_new_key_is_found(self):
        """The scan itself: each of these is a way to read a key that is not told."""
        for text in ('TRY(dict_number(d, "newKey", NULL, &x));', 'if (dict_has(\n    d,\n    "newKey"))', "dict_word(d, key, &word)",
                     'NUMBER("newKey", x, 0, POSITIVE, NO_UNIT, "of x")', "params_read(d, new_param, COUNT(new_param), m)",
                     'dict_sub_optional(of(m)->dict, "newKey", &sub)',
                     'static status read_own(struct dict *d, const char *key) { }\nTRY(read_own(d, "newKey"));'):
            self.assertTrue(untold({"solvers/gas/column.c": text}, self.names)[0], text)
        told = 'dict_has(d, "maxCo") params_read(d, a_param, 1, m) keywords_params(k, a_param, 1)'
        self.assertFalse(untold({"solvers/gas/column.c": told}, self.names)[0])

    def test_every_row_is_read(self):
        """A row that documents a key with a reader of its own: that reader is there."""
        files = sources("solvers", "libcore")
        text = "".join(files.values())
        read = {key.strip('"') for _, key in reads(files)}
        read |= set(re.findall(r'\.sub = "(\w+)"', text))
        noted = set(re.findall(r"\bNOTED\(\s*\"([^\"]+)\"", text))
        self.assertEqual(noted - read, set())

    def test_rows_say_what_a_user_needs(self):
        for program, rows in self.rows.items():
            for row in rows:
                with self.subTest(f"{program} {row.files} {row.inside} {row.name}"):
                    self.assertTrue(row.type and row.meaning)
                    self.assertTrue(row.word or row.standard)
                    self.assertTrue(row.example or row.standard == "ignored")


class Page(unittest.TestCase):
    def test_is_up_to_date(self):
        made = subprocess.run(["/usr/bin/python3", os.path.join(DOCS, "makeReference"), "-print"], capture_output=True, text=True,
                              env={**os.environ, "HAFF_BIN": harness.BIN})
        self.assertEqual(made.returncode, 0, made.stderr)
        with open(os.path.join(DOCS, "reference.md"), encoding="utf-8") as file:
            self.assertEqual(file.read(), made.stdout, "docs/reference.md is stale: run docs/makeReference")


class Options(unittest.TestCase):
    def test_one_keyword(self):
        said = harness.program("granularGas", "-keywords", "maxCo").stdout
        for part in ("system/controlDict", "number", "1e-06 .. 6", "default    1", "largest Courant number", "maxCo 1;"):
            self.assertIn(part, said)
        self.assertEqual(said.count("means"), 1)

    def test_a_name_in_several_places(self):
        said = harness.program("granularGas", "-keywords", "restitution").stdout
        self.assertIn("constant/granularProperties: grain\n", said)
        self.assertIn("boundaryField/PATCH, type granularWall\n", said)

    def test_words_and_dictionaries(self):
        self.assertIn("cooling Haff;", harness.program("granularGas", "-keywords", "Haff").stdout)
        self.assertIn("knudsenCut", harness.program("granularGas", "-keywords", "GarzoDuftyCoeffs").stdout)
        every = "0.orig/alpha, 0.orig/rho, 0.orig/U, 0.orig/T, 0.orig/p"
        for name, files, fields in (("JohnsonJacksonSlip", "0.orig/U, 0.orig/T", "T, U: "), ("granularWall", "0.orig/T", "T: "),
                                    ("flowRateInletVelocity", "0.orig/U", "U: "), ("specularityCoefficient", "0.orig/U, 0.orig/T", ""),
                                    ("zeroGradient", every, "scalars, U: ")):
            said = harness.program("granularGas", "-keywords", name).stdout
            self.assertRegex(said, rf"\n    in         {files}: boundaryField/PATCH\S*[ \n]", name)
            self.assertRegex(said, rf"\n    means      {fields}", name)

    def test_restitutions(self):
        """Those of grains and of both kinds of walls name each other."""
        said = harness.program("granularGas", "-keywords", "restitution").stdout + harness.program("granularGas", "-keywords", "restitutionCoefficient").stdout
        for part in ("restitutionCoefficient of JohnsonJacksonSlip", "JohnsonJacksonSlip calls restitutionCoefficient", "granularWall calls restitution"):
            self.assertIn(part, said)

    def test_unknown(self):
        for program, word, near in (("granularGas", "maxC0", "did you mean 'maxCo'?"), ("granularMD", "kernell", "did you mean 'kernel'?"),
                                    ("granularSegregation", "clozure", "did you mean 'closure'?"),
                                    ("gmshToCase", "neighborPatch", "did you mean 'neighbourPatch'?"), ("granularGas", "xyzzyx", "lists all")):
            done = harness.program(program, "-keywords", word, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn(near, done.stderr)

    def test_all_by_file(self):
        said = harness.program("granularGas", "-keywords").stdout
        places = [line for line in said.splitlines() if line and not line.startswith(" ")]
        self.assertEqual(len(places), len(set(places)), "each dictionary stands in one place")
        self.assertIn("system/fvSolution: acoustics/implicitCoeffs", places)
        for program in PROGRAMS:
            self.assertIn("-keywords", harness.program(program, "-help").stdout)


# Names of the user's own, in the made dictionaries.
# What a function object says around a dictionary in it.
PLANE = "planeType pointAndNormal; pointAndNormalDict { point (0.01 0.01 0.01); normal (1 0 0); }"
AROUND = {"LINE": "type sets;", "SURFACE": "type surfaces;", "fields/FIELD": "type fieldAverage;",
          "sampledSurfaceDict": "type surfaceFieldValue; regionType sampledSurface; operation sum;"}
NAMES = {"NAME": "added", "LINE": "upwards", "PATCH": "lid"}
# What a dictionary made of the examples of its rows needs besides: its own examples need it, or do not go together.
BESIDES = {
    ("system/controlDict", "functions/NAME", ""): "probeLocations ((0.01 0.02 0));",
    ("constant/granularProperties", "", ""): "transport GarzoDufty; sources ();",
    ("constant/particleProperties", "contact", ""): "youngsModulus 5e9;",
    ("constant/segregationProperties", "percolation", ""): "velocity 0.1;",
    ("constant/segregationProperties", "percolation", "constant"): "direction (0 1 0);",
    ("constant/segregationProperties", "percolation", "expression"): "direction (0 1 0);",
    ("constant/segregationProperties", "percolation", "kineticStress"): "direction (0 1 0);",
    ("constant/segregationProperties", "diffusivity", ""): "value 1e-6;",
}
RUBBING = {"constant/granularProperties": "friction { type muI; }\n"}  # muWall needs it
SPHERES = "equationOfState TorquatoSpheres;\n"  # the examples have disks
ALSO = {("0.orig/alpha", "rotatingWallVelocity"): {"constant/granularProperties": SPHERES},  # a lid that rotates leads out of the plane
        ("0.orig/U", "rotatingWallVelocity"): {"constant/granularProperties": SPHERES},
        **{("0.orig/alpha", wall): RUBBING for wall in ("frictionalSlip", "granularWall", "JohnsonJacksonSlip")},
        ("0.orig/phi", "fixedValue"): {"0.orig/U": "boundaryField { lid { type zeroGradient; } }\n"}}  # beside a wall phi is noFlux
# Dictionaries that are put in place of those of the example, whose entries are of another type.
ANEW = ("percolation", "diffusivity", "contact")
PLAIN = ("gas", "grains", "softGrains")  # examples that have a plain form
# Of whole entries: words that a program knows and that no case of docs/examples can have. It refuses them with the reason; two closures
# want a line whose last cells are half as wide, as in cases/kink. Local time steps are those of polyhedra (cases/sphere3D).
REFUSED = {("granularGas", "local"), ("granularMD", "zeroGradient"), ("granularMD", "energyBudget"), ("granularDEM", "energyBudget"), ("granularSegregation", "energyBudget"),
           ("granularSegregation", "symmetry"), ("granularSegregation", "symmetryPlane"),
           ("granularSegregation", "paper"), ("granularSegregation", "neumann")}
FIELD = {"granularGas": "rho", "granularMD": "rho", "granularDEM": "rho", "granularSegregation": "phi", "gmshToCase": ""}
DIMENSIONS = {"alpha": "[0 0 0 0 0 0 0]", "rho": "[1 -3 0 0 0 0 0]", "U": "[0 1 -1 0 0 0 0]", "T": "[0 2 -2 0 0 0 0]", "phi": "[0 0 0 0 0 0 0]"}
JUNK = "zzzzzzzz"
CARRIED = """FoamFile { version 2.0; format ascii; class volScalarField; object carried; }
dimensions [0 0 0 0 0 0 0]; internalField uniform 0.5;
boundaryField { "front|back" { type empty; } floor { type zeroGradient; } lid { type zeroGradient; } "left|right" { type cyclic; } }
"""


class Programs(unittest.TestCase):
    """Each dictionary of the reference, made of the examples of its rows, in a case of docs/examples: checkCase takes it, and tells of no key
    that the reference lacks."""

    @classmethod
    def setUpClass(cls):
        if not shutil.which("gmsh"):
            raise unittest.SkipTest("gmsh is not installed")
        cls.folder = tempfile.mkdtemp(prefix="reference")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.keep_lammps()
        shutil.copytree(os.path.join(DOCS, "examples"), cls.folder, dirs_exist_ok=True)
        cls.msh = os.path.join(cls.folder, "mesh.msh")
        subprocess.run(["gmsh", "-3", "-v", "2", os.path.join(cls.folder, "mesh.geo"), "-o", cls.msh], check=True, capture_output=True)
        harness.program("gmshToCase", cls.msh, "-case", os.path.join(cls.folder, "gas"))
        for name in ("grains", "softGrains", "segregation"):
            shutil.copytree(os.path.join(cls.folder, "gas", "constant", "polyMesh"), os.path.join(cls.folder, name, "constant", "polyMesh"))
        cls.make_line()
        cls.make_round()
        cls.make_plain("gas")
        cls.make_plain("grains")
        cls.make_plain("softGrains")
        # a run of granularGas beside the copies, for the rows of granularSegregation that read one
        shutil.copytree(os.path.join(cls.folder, "gas"), os.path.join(cls.folder, "run", "gas"))
        with open(os.path.join(cls.folder, "run", "gas", "system", "controlDict"), "a", encoding="utf-8") as file:
            file.write("endTime 1e-3; writeInterval 1e-3;\n")
        harness.program("granularGas", "-case", os.path.join(cls.folder, "run", "gas"))
        cls.rows = {program: reference(program) for program in PROGRAMS}

    @classmethod
    def keep_lammps(cls):
        """checkCase reads `lmp -h`, which takes three times as long as all the rest: a script repeats what lmp says."""
        if not shutil.which("lmp"):
            return
        said, script = (os.path.join(cls.folder, "programs", name) for name in ("said", "lmp"))
        os.mkdir(os.path.dirname(said))
        with open(said, "w", encoding="utf-8") as file:
            subprocess.run(["lmp", "-h"], stdout=file, check=True)
        with open(script, "w", encoding="utf-8") as file:
            file.write(f"#!/bin/sh\nexec cat '{said}'\n")
        os.chmod(script, 0o755)
        cls.enterClassContext(unittest.mock.patch.dict(os.environ, PATH=f"{os.path.dirname(said)}:{os.environ['PATH']}"))

    @classmethod
    def make_line(cls):
        """The example of segregation on a line of cells: some of its choices are for lines only."""
        line = os.path.join(cls.folder, "line")
        shutil.copytree(os.path.join(cls.folder, "segregation"), line, ignore=shutil.ignore_patterns("polyMesh", "U"))
        boxes.write_mesh(line, (1, 20, 1), (0.01, 0.04, 0.01))
        with open(os.path.join(line, "0.orig", "phi"), "w", encoding="utf-8") as file:
            file.write('dimensions [0 0 0 0 0 0 0]; internalField uniform 0.5;\n'
                       'boundaryField { "y.*" { type noFlux; } ".*Empty" { type empty; } }\n')
        with open(os.path.join(line, "constant", "segregationProperties"), "w", encoding="utf-8") as file:
            file.write("percolation { type constant; velocity 0.01; } diffusivity { type constant; value 1e-6; }\n")

    @classmethod
    def make_round(cls):
        """A mesh beside an axis, for the rows of system/meshDict that a solver reads."""
        path, one = os.path.join(cls.folder, "round"), np.ones(16)
        boxes.box_case(path, (4, 4, 1), (1.0, 1.0, 0.1), one, np.zeros((16, 3)), one, 1.0, eos="perfectGas",
                       types={"x": "wall", "yLow": "symmetryPlane", "yHigh": "wall"}, slip=("xLow", "xHigh", "yHigh"))
        boxes.write_dictionary(path, "system", "meshDict", "")

    @classmethod
    def make_plain(cls, name):
        """An example without a layer at rest, dense gas and rough walls: for any model and any boundary condition."""
        plain = os.path.join(cls.folder, f"plain {name}")
        shutil.copytree(os.path.join(cls.folder, name), plain)
        for file in ("0.orig/alpha", "0.orig/T", "0.orig/U", "system/fvSolution"):
            path = os.path.join(plain, file)
            if not os.path.exists(path):
                continue
            with open(path, encoding="utf-8") as old:
                text = re.sub(r"^(settledLayer|perturbation|expression|acoustics).*\n", "", old.read(), flags=re.MULTILINE)
            text = re.sub(r"JohnsonJacksonSlip;[^}]*", "slip; " if file == "0.orig/U" else "zeroGradient; ", text)
            if file.startswith("0.orig/") and "internalField" not in text:
                text += "internalField uniform 0.1;\n"
            with open(path, "w", encoding="utf-8") as new:
                new.write(text)

        boundary = os.path.join(plain, "constant", "polyMesh", "boundary")
        with open(boundary, encoding="utf-8") as old:
            text = re.sub(r"(lid\s*\{\s*type\s+)wall", r"\1patch", old.read())  # which is open with some of the conditions
        with open(boundary, "w", encoding="utf-8") as new:
            new.write(text)

    def check(self, program, base, changes, lid=None):
        """A copy of an example with lines added to files, through checkCase (or gmshToCase): what it says. lid: type of that patch of the mesh."""
        if program == "granularMD" and re.search(r"type (uniform|expr)?([fF]ixedValue|[iI]nletOutlet)", changes.get("0.orig/U", "")):
            changes = {**changes, "constant/particleProperties": "coarseGraining { kernel cell; }\n"}  # behind an inlet walls are facets
        case = os.path.join(self.folder, "run", "copy")
        shutil.copytree(os.path.join(self.folder, base), case)
        try:
            for file, text in changes.items():
                with open(os.path.join(case, file), "a", encoding="utf-8") as out:
                    out.write(text + (SPHERES if "cooling BerziVescovi;" in text else ""))
                for name in re.findall(r"carried \{ (\w+) \{", text):
                    with open(os.path.join(case, "0.orig", name), "w", encoding="utf-8") as out:
                        out.write(CARRIED)
            if lid:
                boundary = os.path.join(case, "constant", "polyMesh", "boundary")
                with open(boundary, encoding="utf-8") as old:
                    text = re.sub(r"(lid\s*\{\s*type\s+)\w+", rf"\g<1>{lid}", old.read())
                with open(boundary, "w", encoding="utf-8") as new:
                    new.write(text)
            if "system/blockMeshDict" in changes:
                shutil.rmtree(os.path.join(case, "constant", "polyMesh"))
            if program == "gmshToCase":
                return harness.program(program, self.msh, "-case", case, check=False)
            return harness.program("checkCase", case, check=False)
        finally:
            shutil.rmtree(case)

    def rotates(self, row):
        """Is it of a wall with friction that rotates, in place of its velocity?"""
        return row.name in ("origin", "axis", "omega") and row.when in ("frictionalSlip", "JohnsonJacksonSlip")

    def dictionaries(self, program):
        """(files, dictionary, type) -> its rows, keywords only."""
        found = {}
        for row in self.rows[program]:
            if not row.word and row.standard != "ignored" and row.name not in ("volumetricFlowRate", "frictionAngle") and not self.rotates(row):  # they stand in place of others
                found.setdefault((tuple(row.files), row.inside, row.when), []).append(row)
        return found

    def text(self, program, place, rows, last):
        """A dictionary of the examples of rows, in the dictionaries around it."""
        file, inside, when = place
        field = os.path.basename(file)
        entries = " ".join(row.example for row in rows if field == "U" or not row.meaning.startswith("of U "))
        if field in DIMENSIONS:
            entries = re.sub(r"dimensions \[[^]]*\]", f"dimensions {DIMENSIONS[field]}", entries)
        if field == "U":
            entries = re.sub(r"(uniform|uniformValue|uniformInletValue) [\d.]+", r"\1 (1 0 0)", entries)
            entries = re.sub(r'valueExpr "[\d.]+"', 'valueExpr "vector(1, 0, 0)"', entries)
            entries = re.sub(r'expression (".*?")', r'expression (\1 "0" "0")', entries)
        if program != "granularGas":
            entries = entries.replace("application granularGas", f"application {program}").replace("(alpha)", f"({FIELD[program]})")
            entries = entries.replace("isoField alpha", f"isoField {FIELD[program]}")
        if program in ("granularMD", "granularDEM"):
            entries = re.sub(r"table \(.*?\)\);", "2;", entries)
        entries += f" {BESIDES.get(place, '')} {f'type {when};' if when else ''} {last}"
        for part in reversed(inside.split("/") if inside else []):
            if part == "NAME":
                fields = "" if when in ("forces", "forceCoeffs", "fieldAverage", "writeObjects") or "/fields/" in inside or inside in ("carried/NAME", "species/NAME") else f"fields ({FIELD[program]});"
                type_ = next((text for key, text in AROUND.items() if key in inside), "")
                entries = f"{type_} {fields} {entries}"
            if part == "PATCH" and inside in ("patches/PATCH", "boundary/PATCH"):
                part = "left"  # one of the two that are cyclic
            elif part == "PATCH" and field in DIMENSIONS and not when:
                part = "front"  # one that is empty
            if part == "SURFACE" and inside.endswith("pointAndNormalDict"):
                entries = f"type cuttingPlane; planeType pointAndNormal; {entries}"
            elif part == "SURFACE" and not when:
                entries += PLANE
            entries = f"{FIELD[program] if part == 'FIELD' else NAMES.get(part, part)} {{ {entries} }}"
            if part.endswith("Coeffs") and part != inside:  # beside the word that it belongs to
                entries = f"type {part.removesuffix('Coeffs')}; {entries}"
        if inside.endswith("Coeffs") and "/" not in inside:
            row = next(row for row in self.rows[program] if row.word and row.value + "Coeffs" == inside and file in row.files)
            entries = f"{row.example} {entries}"
        return f"\n{'#inputMode overwrite' if inside in ANEW else ''}\n{entries}\n"

    def changes(self, program, base, place, rows, last=""):
        """Text for the files of a case. A boundary condition is given to all fields that take it."""
        files, inside, when = place
        takes = [row.meaning.split(":")[0] for row in self.rows[program] if row.word and row.value == when and row.inside == inside]
        here = [file for file in files if len(files) == 1 or os.path.exists(os.path.join(self.folder, base, file))]
        if when and len(files) > 1:
            here = [file for file in here if takes_it(file, takes[0].split(", "))]
        return {file: self.text(program, (file, inside, when), rows, last) for file in here} | ALSO.get((files[0], when), {})

    def each(self):
        """(program, example, place, rows) of every dictionary."""
        for program, example in PROGRAMS.items():
            for place, rows in self.dictionaries(program).items():
                if program == "granularSegregation" and place[2] == "flowRateInletVelocity":
                    continue  # the patches of its example are walls
                if program == "granularDEM" and place[2] == "translatingWallVelocity":
                    continue  # of the ways to give U it takes one, a constant vector
                plain = len(place[0]) == 5 or place[1].endswith("Coeffs") and "/" not in place[1]
                base = "line" if place[2] == "exponential" else f"plain {example}" if plain and example in PLAIN else example
                yield program, "round" if place[0] == ("system/meshDict",) and program == "granularGas" else base, place, rows

    def known(self, program, place):
        """Keys that the reference knows in a dictionary."""
        files, inside, _ = place
        names = set()
        for row in self.rows[program]:
            if not set(row.files) & set(files):
                continue
            if row.inside == inside:
                names.add(row.name)
            elif row.inside.startswith(f"{inside}/" if inside else ""):
                names.add(row.inside[len(inside) + 1 if inside else 0:].split("/")[0])
        return names

    def test_examples_of_rows(self):
        """Function objects know nothing of each other: all of a program stand in one case."""
        for program, example in PROGRAMS.items():
            objects, checks = "", []
            for _, base, place, rows in (one for one in self.each() if one[0] == program):
                changes = self.changes(program, base, place, rows)
                if place[1].startswith("functions/NAME"):
                    objects += changes.pop("system/controlDict").replace("added {", f"added{len(objects)} {{", 1)
                    self.assertEqual((base, changes), (example, {}))
                else:
                    checks.append((base, changes, place))
            if objects:
                checks.append((example, {"system/controlDict": objects}, "functions"))
            self.sound(program, checks)

    def sound(self, program, checks):
        """Each of (example, changes, what[, lid]) is a sound case. Changes of other files of an example go into one case, as each file is read by
        itself; what is refused so stands alone."""
        groups = []
        for base, changes, what, *lid in checks:
            self.assertTrue(changes, what)
            fields = any(file.startswith("0.orig/") for file in changes)
            place = next((g for g in groups if g[0] == (base, lid) and not set(changes) & set(g[1]) and not (fields and g[2])), None)
            if not place:
                groups.append(place := [(base, lid), {}, False, []])
            place[1].update(changes)
            place[2] |= fields
            place[3].append((base, changes, what, *lid))
        for (base, lid), changes, _, alone in groups:
            if len(alone) > 1 and not self.check(program, base, changes, *lid).returncode:
                continue
            for base, changes, what, *lid in alone:
                with self.subTest(f"{program} {what}"):
                    done = self.check(program, base, changes, *lid)
                    self.assertEqual(done.returncode, 0, f"{changes}\n{done.stderr}")

    def whole(self, program, row):
        """(example, {file: text}) of the entry that -keywords prints for a word: in a case of docs/examples, where the entry belongs."""
        example = PROGRAMS[program]
        if row.inside == "boundaryField/PATCH":
            base = f"plain {example}" if example in PLAIN else example
            patch = {"empty": "front", "cyclic": "left"}.get(row.value, "lid")
            of = dict(zip(("scalars", "U"), row.example.split("    in U: ")))
            takes = row.meaning.split(":")[0].split(", ") if ":" in row.meaning else ["scalars", "U"]
            takes = takes if len(row.files) > 1 else ["scalars", "U"]
            here = [file for file in row.files if os.path.exists(os.path.join(self.folder, base, file))]
            entries = {file: of.get("U" if file == "0.orig/U" else "scalars") or row.example for file in here if takes_it(file, takes)}
            if "0.orig/phi" in entries and row.value in ("fixedValue", "zeroGradient"):
                entries["0.orig/U"] = "type zeroGradient;"  # beside a wall phi is noFlux
            return base, {file: f"\nboundaryField {{ {patch} {{ {entry} }} }}\n" for file, entry in entries.items()} | ALSO.get((row.files[0], row.value), {})
        around = {"carried/NAME": "carried { added { %s } }"}.get(row.inside, row.inside and row.inside + " { %s }") or "%s"
        base = f"plain {example}" if example in PLAIN and row.files == ["constant/granularProperties"] else example
        anew = "#inputMode overwrite\n" if row.inside == "contact" else ""
        return base, {row.files[0]: "\n" + anew + around % row.example + "\n"}

    def test_whole_entries(self):
        """What -keywords prints for a model, a boundary condition, a source, a function object is taken as it stands. Function objects, and
        warnings that are accepted, stand in one case."""
        for program, example in PROGRAMS.items():
            objects, warnings, checks = "", "", []
            for row in self.rows[program]:
                if not row.word or (program, row.value) in REFUSED:
                    continue
                if row.inside == "functions/NAME":
                    objects += f"added{len(objects)} {{ {row.example} }}\n"
                elif row.name == "acceptWarnings":
                    warnings += re.fullmatch(r"acceptWarnings \((\w+)\);", row.example)[1] + " "
                else:
                    lid = row.value if row.value.startswith("symmetry") else "patch" if row.value == "flowRateInletVelocity" else None
                    checks.append((*self.whole(program, row), f"{row.files} {row.inside} {row.value}", lid))
            if objects:
                checks.append((example, {"system/controlDict": f"\nfunctions {{ {objects} }}\nacceptWarnings ( {warnings});\n"}, "functions"))
            self.sound(program, checks)

    def test_no_key_is_asked_for_that_is_not_told(self):
        for program, base, place, rows in self.each():
            if (program, place[0]) == ("granularSegregation", ("constant/g",)):
                continue  # of that file it takes the value, and leaves the rest to others
            with self.subTest(f"{program} {place}"):
                changes = self.changes(program, base, place, rows)
                file = list(changes)[0]
                changes[file] = self.changes(program, base, place, rows, f"{JUNK} 1;")[file]
                said = self.check(program, base, changes).stderr
                found = re.search(rf"{file}:\d+: keyword '{JUNK}' is not used; remove it; known here: (.*?) \(", said)
                self.assertTrue(found, f"{changes}\n{said}")
                asked = set(found[1].split())
                if program in ("granularMD", "granularDEM"):  # parameters of the gas may stay in the file
                    asked = {key for key in asked if not key.endswith("Coeffs")}
                self.assertEqual(asked - self.known(program, place), set())

    def test_examples(self):
        for name in ("gas", "grains", "segregation") + (("softGrains",) if shutil.which("lmp") else ()):
            with self.subTest(name):
                said = harness.program("checkCase", os.path.join(self.folder, name)).stdout
                self.assertIn("The case is sound.", said)
                self.assertNotIn("warning", said)
