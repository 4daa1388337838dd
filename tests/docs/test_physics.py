# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/physics.md and what cites it. A citation is `docs/physics.md 2.2`, or with several numbers `docs/physics.md 2.5, S3`, or in a
document a link to `physics.md#s2.2` or `physics.md#erratum-s3`. Each leads to a section, or a row of the errata, that is about the same
thing; each section leads back to the files it names after Code:, which cite it, and which have the rows of tables that it names. The rules
are functions from texts to complaints, so that they are tested themselves, on made-up texts."""
import os
import re
import subprocess
import unittest

import numpy as np

from haff.start import enskog
from studies.exact.eos import GoldshteinShapiro
from tests.cases import harness

PAGE = "docs/physics.md"
NUMBER = r"(?:\d+(?:\.\d+)?|[SCHB]\d+)\b"
CITATION = re.compile(r"docs/physics\.md\s+(" + NUMBER + r"(?:(?:, | and )" + NUMBER + r")*)")
LINK = re.compile(r"\((?:[\w./-]*physics\.md)?#(s\d+(?:\.\d+)?|erratum-[schb]\d+)\)")
OLD = re.compile(r"\bphysics [1-9SC]|shared/physics|\(?\berrat(?:um|a) [SCHB]\d")  # as comments cited a page that was not there
SAID = re.compile(r"\berrat(?:um|a) ([SCHB]\d+)\b")  # as documents do, which have links or say where the errata are
SEARCHED = ("libcore", "mesh", "solvers", "postprocessing", "tests", "cases", "docs")
READ = (".c", ".h", ".py", ".json", ".md", "README.md", "CHANGELOG.md", "CONTRIBUTING.md")
ROW = re.compile(r"\b(?:MODEL|MODEL_WITH|ROW)\(\s*\"(\w+)\"")
TABLES = ("libcore/models/", "libcore/schemes/", "libcore/gas/", "libcore/acoustics/")


def sections(page):
    """{number: (heading, text)} of sections; a chapter's text ends where its first section begins."""
    parts = re.split(r'(?m)^<a id="(s[\d.]+)"></a>\n#+ ([\d.]+) (.*)$', page)
    found = {}
    for anchor, number, heading, text in zip(*(parts[i::4] for i in range(1, 5))):
        found[number] = (heading, text) if anchor == "s" + number else ("", "")
    return found


def errata(page):
    """{number: row} of the tables of errata."""
    rows = re.findall(r'(?m)^\| <a id="erratum-([schb]\d+)"></a>([SCHB]\d+) \|(.*)$', page)
    return {number: row if anchor == number.lower() else "" for anchor, number, row in rows}


def words(text):
    """Stems of a text's long words and names, by which two texts are seen to be about the same thing."""
    return {w.lower()[:5] for w in re.findall(r"[A-Za-z][A-Za-z0-9]{3,}", text)} - {"their", "which", "with", "that", "what", "from"}


def flat(text):
    """A text without line ends and what begins the lines of a comment."""
    return re.sub(r"\s*\n\s*(?:\* |# |// )?\s*", " ", text)


def citations(text):
    """(number, what stands around it) of each citation."""
    one = flat(text)
    for m in [*CITATION.finditer(one), *SAID.finditer(one)]:
        for number in re.findall(NUMBER, m[1]):
            yield number, one[max(0, m.start() - 500):m.end() + 500].replace("docs/physics.md", " ")


def cited(number, around, page):
    """What is wrong with one citation, or None."""
    of_section, of_erratum = sections(page).get(number), errata(page).get(number)
    about = of_section[0] if of_section else of_erratum
    if about is None:
        return f"cites {number}, which is not there"
    if not words(about):
        return f"cites {number}, which does not say what it is about"
    if not words(about) & words(around):
        return f"cites {number}, '{about.strip()[:60]}', in a text that shares no word with it"
    return None


def astray(page, files):
    """Citations and links that lead nowhere, or to something else."""
    anchors = set(re.findall(r'<a id="([^"]+)"></a>', page))
    for path, text in sorted(files.items()):
        for number, around in citations(text) if path != PAGE else ():
            wrong = cited(number, around, page)
            if wrong:
                yield f"{path} {wrong}"
        if path.endswith(".md"):
            for anchor in LINK.findall(text):
                if anchor not in anchors and ("physics.md#" + anchor in text or path == PAGE):
                    yield f"{path} links to #{anchor} of the page, which is not there"
        for m in OLD.finditer(flat(text)) if path.endswith((".c", ".h", ".py")) else ():
            yield f"{path}: '{m[0]}' is no citation: write docs/physics.md and the number"


def code_of(text):
    return [p for line in re.findall(r"(?m)^Code: (.*)$", text) for p in re.findall(r"`([\w./-]+)`", line.split("; held by")[0])]


def held_by(text):
    return [p for line in re.findall(r"(?m)^Code: .*; held by (.*)$", text) for p in re.findall(r"`([\w./-]+)`", line)]


def unreturned(page, files, exists):
    """Sections without code, or whose files are not there or do not cite them back."""
    for number, (_, text) in sections(page).items():
        if number in ("12", "13") or number.startswith("12.") or ("Code:" not in text and f"### {number}.1 " in page):
            continue
        if not code_of(text):
            yield f"{number} names no code"
        for path in code_of(text):
            if not exists(path):
                yield f"{number}: there is no {path}"
            elif number not in {n for n, _ in citations(files.get(path, ""))}:
                yield f"{number}: {path} does not cite it"
        for path in held_by(text):
            if not exists(path):
                yield f"{number}: there is no {path}"


def untold(page, files):
    """Rows of the tables of models that no section names which cites their file as its code."""
    for path, text in sorted(files.items()):
        if path.endswith(".c") and path.startswith(TABLES):
            for name in ROW.findall(text):
                if not any(f"`{name}`" in t and path in code_of(t) for _, t in sections(page).values()):
                    yield f"{path}: no section with this file as its code names `{name}`"


def listed(text):
    """Names of the models that -listModels prints: function objects are none."""
    family = ""
    for line in text.splitlines():
        if line and not line.startswith(" "):
            family = line
        found = re.match(r"  (?:kernel |closure )?(\w+)(?:  |$| )", line)
        if found and "functions" not in family and not re.match(r"  (?:fields:|bounded|    )", line):
            yield found[1]


def sources():
    files = {}
    found = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=harness.SOURCE, capture_output=True, text=True, check=True)
    for path in found.stdout.split("\n"):
        if path.endswith(READ) and (path.split("/")[0] in SEARCHED or "/" not in path) and os.path.exists(os.path.join(harness.SOURCE, path)):
            with open(os.path.join(harness.SOURCE, path), encoding="utf-8") as f:
                files[path] = f.read()
    return files


class Page(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.files = {path: text for path, text in sources().items() if path != "tests/docs/test_physics.py"}
        cls.page = cls.files[PAGE]

    def test_citations(self):
        """Every citation leads to a section or an erratum that is about the same thing; every link to an anchor."""
        self.assertEqual(list(astray(self.page, self.files)), [])

    def test_back(self):
        """Every section names code that is there and cites it back."""
        self.assertEqual(list(unreturned(self.page, self.files, lambda p: os.path.exists(os.path.join(harness.SOURCE, p)))), [])

    def test_rows(self):
        """Every row of a table of models is in a section whose code is the file of the table."""
        self.assertEqual(list(untold(self.page, self.files)), [])

    def test_listed(self):
        """Every model that a program lists is on the page."""
        for program, least in (("granularGas", 35), ("granularMD", 3), ("granularSegregation", 6)):
            out = subprocess.run([os.path.join(harness.BIN, program), "-listModels"], capture_output=True, text=True, check=True).stdout
            names = list(listed(out))
            self.assertGreaterEqual(len(names), least, f"{program}: {names}")
            self.assertEqual([n for n in names if f"`{n}`" not in self.page and n != "none"], [], program)

    def test_numbered(self):
        """Sections follow one another; the contents name every chapter; each erratum of a paper has the next number."""
        numbers = [[int(n) for n in number.split(".")] for number in sections(self.page)]
        expected = [[c] + s for c in range(1, 14) for s in [[]] + [[n[1]] for n in numbers if n[0] == c and len(n) > 1]]
        self.assertEqual(numbers, expected)
        for c in range(1, 14):
            last = [n[1] for n in numbers if n[0] == c and len(n) > 1]
            self.assertEqual(last, list(range(1, len(last) + 1)))
            self.assertIn(f"| [{c}](#s{c}) |", self.page)
        for letter in "SCHB":
            of = sorted(int(number[1:]) for number in errata(self.page) if number[0] == letter)
            self.assertEqual(of, list(range(1, len(of) + 1)), letter)

    def test_references(self):
        """Each author with a year in the text stands among the references with that year."""
        text, references = self.page.split("## 13 References")
        found = re.findall(r"([A-Z][a-z]+)(?: et al\.)?(?:'s [a-z ]+)? \((\d{4})\)", text) + re.findall(r"([A-Z][a-z]+)(?: et al\.)? (\d{4})\b", text)
        self.assertGreater(len(found), 25)
        for name, year in found:
            self.assertTrue(any(name in line and f"({year})" in line for line in references.splitlines()), f"{name} {year} is not among the references")


class Numbers(unittest.TestCase):
    """Numbers of the page that follow from its formulas, by the references in numpy."""

    @classmethod
    def setUpClass(cls):
        cls.page = sources()[PAGE]

    def tells(self, pattern, *values):
        found = re.search(pattern, self.page)
        self.assertIsNotNone(found, pattern)
        for text, value in zip(found.groups(), values):
            digits = len(text.split(".")[1]) if "." in text else 0
            self.assertAlmostEqual(float(text), value, delta=0.5000001 * 10**-digits, msg=found[0])

    def test_serna(self):
        gas = GoldshteinShapiro(0.97)
        rho, p, u = np.array([34.3774677, 343.774677]), np.array([1589.2685472, 10174.873548]), 63
        T = gas.T(rho, p)
        c = gas.c(rho, T)
        self.tells(r"c = ([\d.]+) \(nu = 0\.018\) and ([\d.]+) \(0\.18\), M = ([\d.]+) and ([\d.]+); T = ([\d.]+) and ([\d.]+)", *c, *u / c, *T)

    def test_exponent(self):
        """S3 and S4: the exponent is too large by (A - 1)^2/A, and its derivative is that of the exponent."""
        gas = GoldshteinShapiro(0.9)
        rho = gas.rho(np.array([0.55]))
        A, slope = gas.A(rho), gas.rho_dA(rho)

        def exponent(nu):
            r = gas.rho(np.array([nu]))
            return (1 + (gas.gamma - 1) * gas.A(r) + gas.rho_dA(r) / gas.A(r))[0]

        right = (1 + (gas.gamma - 1) * A + slope / A)[0]
        self.tells(r"by \(A - 1\)\^2/A, ([\d.]+) for ([\d.]+) at nu = 0\.55", right + ((A - 1)**2 / A)[0], right)
        h = 1e-5
        self.tells(r"at nu = 0\.55, e = 0\.9: 390\.7 for ([\d.]+)", (exponent(0.55 + h) - exponent(0.55 - h)) / (2 * h))

    def test_stream(self):
        """S11: the free stream of the wedge, as an ordinary differential equation."""
        gas = GoldshteinShapiro(0.97)
        rho, p = np.array([34.3774677, 343.774677]), np.array([1589.2685472, 10174.873548])
        t, T0 = np.array([0.0425, 0.0412]), gas.T(rho, p)
        G = (gas.A(rho) - 1) / (2 * 1.97)
        B = (gas.gamma - 1) * 12 / np.sqrt(np.pi) * (1 - 0.97**2) * G / 0.1
        T = T0 / (1 + B * np.sqrt(T0) * t / 2)**2
        self.tells(r"\| ([\d.]+) and ([\d.]+): the free stream", *(63 + 980 * t) / gas.c(rho, T))

    def test_layer(self):
        """S9, S10: thickness and sum of the vibrated layer."""
        x = (np.arange(1500) + 0.5) * 1e-4
        nu = 1e-4 + 0.13 * np.exp(-3000 * np.minimum(x - 0.145, 0)**2)
        self.tells(r"e-fold tail of ([\d.]+), the effective thickness is ([\d.]+)", 3000**-0.5, 0.005 + np.sqrt(np.pi / 3000) / 2)
        self.tells(r"the stated start has ([\d.]+) at cell centres", nu.sum())

    def test_contact(self):
        """The jumps of chi' where Torquato's branches meet, and how much the joint changes chi."""
        changes = []
        for d, row in ((2, "disks"), (3, "spheres")):
            f, c = enskog.TORQUATO[d]
            value, slope, _ = enskog.fluid(f, d)
            self.tells(rf"\| {row} \| {f} \| {c} \| ([\d.]+) to ([\d.]+) \|", slope, value / (c - f))
            nu = np.linspace(f - 0.01, f + 0.01, 2001)
            kinked = np.where(nu < f, enskog.fluid(nu, d)[0], value * (c - f) / (c - nu))
            changes.append(100 * np.max(np.abs(enskog.torquato(nu, d) / kinked - 1)))
        self.tells(r"chi changes by ([\d.]+) % at most \(spheres ([\d.]+) %\)", *changes)

    def test_sonine(self):
        self.tells(r"([\d.]+) at e = 0\.9 and ([\d.]+) at e = 0\.2 for spheres", *(1 + 3 / 16 * enskog.a2(e, 3) for e in (0.9, 0.2)))


class Rules(unittest.TestCase):
    """The rules complain about what they are for."""
    page = ('<a id="s1"></a>\n## 1 Walls\n<a id="s1.1"></a>\n### 1.1 Granular walls\n`rough`\n\nCode: `libcore/models/eos.c`.\n'
            '| <a id="erratum-s1"></a>S1 | c is printed half | the speed of sound | |\n')
    good = {"libcore/models/eos.c": '/* A granular wall\n * (docs/physics.md\n * 1.1): speed of sound as printed, docs/physics.md S1. */ MODEL("rough", "")'}

    def complaints(self, page=None, **files):
        page, files = page or self.page, {**self.good, **{k.replace("_md", ".md").replace("_c", ".c"): v for k, v in files.items()}}
        return [*astray(page, files), *unreturned(page, files, files.__contains__), *untold(page, files)]

    def test_good(self):
        self.assertEqual(self.complaints(), [])
        self.assertEqual(sorted(n for n, _ in citations(self.good["libcore/models/eos.c"])), ["1.1", "S1"])
        self.assertEqual([n for n, _ in citations("docs/physics.md 2.5, S3 and S4, 7 cells")], ["2.5", "S3", "S4", "7"])

    def test_astray(self):
        for text, part in (("a wall: docs/physics.md 1.2", "not there"), ("docs/physics.md C1", "not there"), ("flux: docs/physics.md 1.1", "shares no word"),
                           ("sound speed (erratum S1)", "no citation"), ("walls (physics 1.1)", "no citation")):
            self.assertIn(part, " ".join(self.complaints(b_c=text)), text)
        self.assertEqual(self.complaints(b_md="the printed speed of sound (erratum S1)"), [])
        self.assertIn("not there", " ".join(self.complaints(b_md="the printed speed of sound (erratum S2)")))
        self.assertIn("not there", " ".join(self.complaints(b_md="[S7](../docs/physics.md#erratum-s7)")))
        self.assertIn("which does not say", " ".join(self.complaints(self.page.replace("Granular walls", "1 a"))))

    def test_unreturned(self):
        more = '<a id="s1.2"></a>\n### 1.2 Smooth walls\n\nCode: `libcore/models/eos.c`.\n'
        self.assertIn("1.2: libcore/models/eos.c does not cite it", self.complaints(self.page + more))
        self.assertIn("there is no", " ".join(self.complaints(self.page.replace("eos.c`.", "gone.c`."))))
        self.assertIn("names no code", " ".join(self.complaints(self.page.replace("Code:", "Cod:"))))

    def test_untold(self):
        self.assertIn("`smooth`", " ".join(self.complaints(**{"libcore/models/param_c": 'MODEL_WITH("smooth", "", p)'})))

    def test_listed(self):
        text = ("fluxScheme\n  FORCE   centred\n    stages   4   0 .. 9\n  kernel cell  means\npercolation { type .. }\n  constant\n    velocity ..\n"
                "system/controlDict: functions\n  probes  values\n")
        self.assertEqual(list(listed(text)), ["FORCE", "cell", "constant"])


if __name__ == "__main__":
    unittest.main()
