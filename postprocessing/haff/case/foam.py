"""OpenFOAM's files: header, lists, fields on cells; ascii or binary, plain or .gz."""
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
