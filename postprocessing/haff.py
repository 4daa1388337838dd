"""Reads a case: mesh, fields, times, tables of function objects. Needs numpy only.

    case = haff.Case("cases/wedge")
    x, y, z = case.centres.T
    alpha = case.field("alpha", case.times[-1])

Fields and meshes may be ascii or binary, plain or .gz; numbers come back as they stand in the file (doubles).
"""
import gzip
import os
import re

import numpy as np

COMPONENTS = {"Scalar": 1, "Vector": 3, "SymmTensor": 6, "Tensor": 9}
PUNCTUATION = re.compile(rb"[()\[\]{};]")


class FormatError(ValueError):
    """A file is not what it should be."""


def read_bytes(path):
    """The file's bytes, unzipped; path.gz is taken where only that exists."""
    if not os.path.exists(path) and os.path.exists(path + ".gz"):
        path += ".gz"
    with open(path, "rb") as f:
        data = f.read()
    return gzip.decompress(data) if path.endswith(".gz") else data


class FoamFile:
    """Header and body of a file in OpenFOAM's format."""

    def __init__(self, path):
        self.path = path
        data = read_bytes(path)
        header = re.search(rb"FoamFile\s*\{(.*?)\}", data, re.S)
        if not header:
            raise FormatError(f"{path}: no FoamFile header")
        self.header = {k.decode(): v.decode().strip('" ') for k, v in
                       re.findall(rb"(\w+)\s+(\"[^\"]*\"|[^;]*);", header.group(1))}
        self.binary = self.header.get("format") == "binary"
        arch = self.header.get("arch", "LSB;label=32;scalar=64")
        self.label = np.dtype("<i8" if "label=64" in arch else "<i4")
        self.scalar = np.dtype("<f4" if "scalar=32" in arch else "<f8")
        self.body = data[header.end():]

    def numbers(self, start, components, kind):
        """The list `N ( ... )` that begins at body[start]: array [N] or [N][components], and where it ends."""
        head = re.compile(rb"(?:\s|//[^\n]*\n|/\*.*?\*/)*(\d+)\s*([({])", re.S).match(self.body, start)
        if not head:
            raise FormatError(f"{self.path}: no list where one should begin")
        count, at = int(head.group(1)), head.end()
        shape = (count, components) if components > 1 else (count,)
        if head.group(2) == b"{":
            end = self.body.index(b"}", at)
            return np.tile(np.array(words(self.body[at:end]), float).astype(kind), count).reshape(shape), end + 1
        if self.binary:
            end = at + count * components * kind.itemsize
            if len(self.body) <= end or self.body[end:end + 1] != b")":
                raise FormatError(f"{self.path}: the binary list of {count} entries does not end where it should")
            return np.frombuffer(self.body[at:end], kind).reshape(shape), end + 1
        close = list_end(self.body, at)
        values = np.array(words(self.body[at:close]), kind)
        if values.size != count * components:
            raise FormatError(f"{self.path}: {values.size} numbers in a list of {count} x {components}")
        return values.reshape(shape), close + 1


def words(text):
    """Numbers as byte strings; brackets are blanks."""
    return PUNCTUATION.sub(b" ", re.sub(rb"//[^\n]*", b"", text)).split()


def list_end(text, at):
    """Position of the bracket that closes the list whose content starts at `at`."""
    depth = 1
    for m in re.compile(rb"[()]").finditer(text, at):
        depth += 1 if m.group() == b"(" else -1
        if depth == 0:
            return m.start()
    raise FormatError("a list is not closed")


def read_field(path, cells):
    """Internal field: array [cells] or [cells][components]."""
    f = FoamFile(path)
    kind = re.match(r"vol(\w+?)Field", f.header.get("class", ""))
    if not kind or kind.group(1) not in COMPONENTS:
        raise FormatError(f"{path}: class {f.header.get('class')} is no field on cells")
    n = COMPONENTS[kind.group(1)]
    entry = re.search(rb"(?:internalField|value)\s+(uniform|nonuniform)\s*(?:List<\w+>)?", f.body)
    if not entry:
        raise FormatError(f"{path}: no internalField")
    outside = f.body.split(b"boundaryField", 1)[0] + b"\n" + f.body.rsplit(b"}", 1)[-1]  # patches may have expressions, too
    if re.search(rb"^\s*expression\b", outside, re.M):
        raise FormatError(f"{path}: the field is given by an expression, which only the solver evaluates")
    if entry.group(1) == b"uniform":
        value = np.array(words(f.body[entry.end():f.body.index(b";", entry.end())]), float)
        return np.tile(value, (cells, 1)) if n > 1 else np.full(cells, value[0])
    values = f.numbers(entry.end(), n, f.scalar)[0].astype(float)
    if len(values) != cells:
        raise FormatError(f"{path}: {len(values)} values on a mesh of {cells} cells")
    return values


class Mesh:
    """constant/polyMesh: points, faces, owner, neighbour, patches {name: (type, first face, faces)}."""

    def __init__(self, folder):
        path = lambda name: os.path.join(folder, name)
        f = FoamFile(path("points"))
        self.points = f.numbers(0, 3, f.scalar)[0].astype(float)
        self.face_start, self.face_points = self.read_faces(path("faces"))
        f = FoamFile(path("owner"))
        self.owner = f.numbers(0, 1, f.label)[0]
        f = FoamFile(path("neighbour"))
        self.neighbour = f.numbers(0, 1, f.label)[0]
        self.cells = int(max(self.owner.max(), self.neighbour.max(initial=-1))) + 1
        self.patches = {}
        text = FoamFile(path("boundary")).body.decode()
        for name, entries in re.findall(r"(\S+)\s*\{(.*?)\}", text, re.S):
            value = dict(re.findall(r"(\w+)\s+([^;]*);", entries))
            self.patches[name] = (value["type"], int(value["startFace"]), int(value["nFaces"]))

    @staticmethod
    def read_faces(path):
        f = FoamFile(path)
        if f.header["class"] == "faceCompactList":
            start, end = f.numbers(0, 1, f.label)
            return start, f.numbers(end, 1, f.label)[0]
        faces = [np.array(t.split(), int) for t in re.findall(rb"\d+\s*\(([\d\s]+)\)", f.body)]
        return np.concatenate(([0], np.cumsum([len(t) for t in faces]))), np.concatenate(faces)

    def face_geometry(self):
        """Centres and area vectors [faces][3]: triangles about the mean of the points."""
        count = np.diff(self.face_start)
        face = np.repeat(np.arange(len(count)), count)
        here = self.points[self.face_points]
        following = np.arange(1, len(face) + 1)
        following[self.face_start[1:] - 1] = self.face_start[:-1]
        there = here[following]
        middle = sums(face, here, len(count)) / count[:, None]
        area = np.cross(here - middle[face], there - middle[face]) / 2
        size = np.linalg.norm(area, axis=1)
        centre = sums(face, size[:, None] * (here + there + middle[face]) / 3, len(count))
        return centre / sums(face, size, len(count))[:, None], sums(face, area, len(count))

    def cell_geometry(self):
        """Centres [cells][3] and volumes [cells]: pyramids about the mean of the face centres."""
        centre, area = self.face_geometry()
        inner = len(self.neighbour)
        cell = np.concatenate((self.owner, self.neighbour))
        centre = np.concatenate((centre, centre[:inner]))
        area = np.concatenate((area, -area[:inner]))
        middle = sums(cell, centre, self.cells) / np.bincount(cell, minlength=self.cells)[:, None]
        pyramid = np.einsum("ij,ij->i", area, centre - middle[cell]) / 3
        volume = sums(cell, pyramid, self.cells)
        moment = sums(cell, pyramid[:, None] * (0.75 * centre + 0.25 * middle[cell]), self.cells)
        return moment / volume[:, None], volume


def sums(index, values, n):
    """Sum of values by index: [n] or [n][3]."""
    if values.ndim == 1:
        return np.bincount(index, values, n)
    return np.stack([np.bincount(index, v, n) for v in values.T], axis=1)


def is_time(name):
    return re.fullmatch(r"\d+(\.\d*)?([eE][-+]?\d+)?", name) is not None


class Case:
    """A case directory. Times are the names of folders, ascending in value."""

    def __init__(self, path):
        if not os.path.isdir(os.path.join(path, "system")):
            raise FileNotFoundError(f"{path} is no case directory (it has no folder 'system')")
        self.path = path
        self._mesh = self._geometry = None

    @property
    def times(self):
        return sorted((n for n in os.listdir(self.path) if is_time(n)), key=float)

    @property
    def mesh(self):
        if self._mesh is None:
            self._mesh = Mesh(os.path.join(self.path, "constant", "polyMesh"))
        return self._mesh

    @property
    def centres(self):
        self._geometry = self._geometry or self.mesh.cell_geometry()
        return self._geometry[0]

    @property
    def volumes(self):
        self._geometry = self._geometry or self.mesh.cell_geometry()
        return self._geometry[1]

    def time(self, value):
        """The name of the time nearest to a number."""
        return min(self.times, key=lambda name: abs(float(name) - value))

    def field(self, name, time=None):
        """The internal field at a time (name or number; default the last)."""
        time = self.times[-1] if time is None else time if isinstance(time, str) else self.time(time)
        return read_field(os.path.join(self.path, time, name), self.mesh.cells)

    def line(self, names, time=None):
        """x and fields of a one-dimensional case, ordered in x."""
        x = self.centres[:, 0]
        order = np.argsort(x)
        values = [self.field(name, time)[order] for name in names]
        return (x[order], *[v[:, 0] if v.ndim > 1 else v for v in values])

    def table(self, function, file):
        """Rows of postProcessing/FUNCTION/*/FILE, all starts joined; vectors are flattened. Words give nan."""
        folder = os.path.join(self.path, "postProcessing", function)
        rows = []
        for start in sorted(os.listdir(folder), key=float):
            with open(os.path.join(folder, start, file)) as f:
                rows += [[number(w) for w in re.sub(r"[()]", " ", line).split()]
                         for line in f if line.strip() and not line.startswith("#")]
        return np.array(rows)


def number(word):
    try:
        return float(word)
    except ValueError:
        return np.nan
