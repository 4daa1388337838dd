# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenFOAM's files: header, lists, fields on cells; ascii or binary, plain or .gz.

A plain file is read into memory once, and the numbers of a binary list are a view of that memory: no copy is made, and what
happens to the file later does not reach the arrays. (A memory map would save that one read, and would end Python where a run
shortens the file.)
"""
import functools
import gzip
import os
import re
import warnings
import zlib

import numpy as np

COMPONENTS = {"Scalar": 1, "Vector": 3, "SymmTensor": 6, "Tensor": 9}
SKIP = rb"(?:\s|//[^\n]*\n|/\*.*?\*/)*"
LIST = re.compile(SKIP + rb"(\d+)" + SKIP + rb"([({])", re.S)
FIRST_LIST = re.compile(rb"\n\s*\d+\s*\(")
HEADER_WITHIN = 1 << 16  # bytes
MEMORY = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")  # bytes of this machine
UNZIPPED, RATIO, PIECE = 1 << 30, 100, 1 << 24  # what unzips to more than UNZIPPED bytes may not grow by more than RATIO, as for the solvers
MOST_ENTRIES = (1 << 31) - 1  # of a list
MOVED = 1 << 26  # bytes: longer lists move in place
WORD = re.compile(SKIP + rb'("[^"]*"|[{};]|[^\s{};"]+)', re.S)
BLANKS = bytes.maketrans(b"()[]{};", b"       ")
BASE_UNITS = 7  # kg, m, s, K, mol, A, cd


class FormatError(ValueError):
    """A file is not what it should be."""


def is_time(name):
    """Whether a folder of that name is a time."""
    return re.fullmatch(r"\d+(\.\d*)?([eE][-+]?\d+)?", name) is not None


def times_in(folder):
    """The names of the folders of times in a folder, ascending in value; none where it is not there."""
    names = os.listdir(folder) if os.path.isdir(folder) else []
    return sorted((n for n in names if is_time(n) and os.path.isdir(os.path.join(folder, n))), key=float)


def located(path):
    """path, or path.gz where only that exists. FormatError where both do: one of them is not what is meant."""
    if not os.path.exists(path + ".gz"):
        return path
    if os.path.exists(path):
        raise FormatError(f"{path}: {path}.gz stands beside it, and only one of both can be meant: remove the other")
    return path + ".gz"


def read_bytes(path):
    """The file's bytes, unzipped; path.gz is taken where only that exists."""
    data = read_buffer(path)
    return data if isinstance(data, bytes) else data.tobytes()


def read_buffer(path):
    """The same as bytes, or as a memoryview that can be written to, which needs the file's size of memory and no more.

    The content of the first list begins at a multiple of 8 bytes, so that its numbers need not be moved."""
    path = located(path)
    if os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path):
        raise FormatError(f"{path}: is no file but a pipe or a device; put the file there, or a link to it")
    with open(path, "rb") as f:
        if path.endswith(".gz"):
            return unzipped(f, path)
        if os.fstat(f.fileno()).st_size > MEMORY:
            raise too_large(path)
        head = f.read(HEADER_WITHIN)
        first = FIRST_LIST.search(head)
        room = np.empty(os.fstat(f.fileno()).st_size + 8, np.uint8)
        off = -(room.ctypes.data + (first.end() if first else 0)) % 8
        f.seek(0)
        data = memoryview(room)[off:len(room) - 8 + off]
        return data[:f.readinto(data)]


def readable(text):
    """Bytes of a file as a text; what is no UTF-8 becomes a sign that stands for that."""
    return text.decode(errors="replace")


def too_large(path):
    return FormatError(f"{path}: it holds more than {MEMORY / 2**30:.3g} GiB, the memory of this machine; is it the right file?")


def unzipped(f, path):
    """The content of an open .gz in pieces, so that one that unzips without end is refused before it fills the memory."""
    size, found = os.fstat(f.fileno()).st_size, bytearray()
    try:
        with gzip.GzipFile(fileobj=f) as packed:
            while piece := packed.read(PIECE):
                found += piece
                if len(found) > UNZIPPED and len(found) > RATIO * size:
                    raise FormatError(f"{path}: unzips to more than {RATIO} times its size; if that is meant, gunzip it")
                if len(found) > MEMORY:
                    raise too_large(path)
    except (OSError, EOFError, zlib.error) as e:
        raise FormatError(f"{path}: it cannot be unzipped ({e})") from None
    return memoryview(found)


class FoamFile:
    """Header and body of a file in OpenFOAM's format.

    path, header {key: text}, binary; label, scalar: the numpy types of its numbers.
    FormatError where there is no header; FileNotFoundError.
    """

    def __init__(self, path):
        self.path = path
        self.data = read_buffer(path)
        header = re.search(rb"FoamFile\s*\{(.*?)\}", self.data[:HEADER_WITHIN], re.S)
        if not header:
            raise FormatError(f"{path}: no FoamFile header")
        self.header = {readable(k): readable(v).strip('" ') for k, v in
                       re.findall(rb"(\w+)\s+(\"[^\"]*\"|[^;]*);", header.group(1))}
        self.binary = self.header.get("format") == "binary"
        arch = self.header.get("arch", "LSB;label=32;scalar=64")
        self.label = np.dtype("<i8" if "label=64" in arch else "<i4")
        self.scalar = np.dtype("<f4" if "scalar=32" in arch else "<f8")
        self.view = self.data[header.end():]

    @property
    def body(self):
        """What follows the header, as bytes: a copy."""
        return self.view if isinstance(self.view, bytes) else self.view.tobytes()

    def numbers(self, start, components, kind):
        """The list `N ( ... )` that begins at byte `start` of the body: array [N] or [N][components], and the byte where it ends."""
        head = LIST.match(self.view, start)
        if not head:
            raise FormatError(f"{self.path}: no list where one should begin")
        count, at = int(head.group(1)), head.end()
        if count > MOST_ENTRIES:
            raise FormatError(f"{self.path}: a list of {count} entries; at most {MOST_ENTRIES} are read")
        shape = (count, components) if components > 1 else (count,)
        if head.group(2) == b"{":
            end = self.find(b"}", at)
            row = text_numbers(self.part(at, end), kind, self.path)
            if row.size != components:
                raise FormatError(f"{self.path}: {row.size} numbers in a list {count}{{..}} of {components}")
            return np.broadcast_to(row if components > 1 else row[0], shape), end + 1  # needs no memory, whatever the count
        if self.binary:
            end = at + count * components * kind.itemsize
            if len(self.view) <= end or self.view[end:end + 1] != b")":
                raise FormatError(f"{self.path}: the binary list of {count} entries does not end where it should")
            return self.aligned(at, end, kind).reshape(shape), end + 1
        close = self.closing(at, count, components)
        values = text_numbers(self.part(at, close), kind, self.path)
        if values.size != count * components:
            raise FormatError(f"{self.path}: {values.size} numbers in a list of {count} x {components}")
        return values.reshape(shape), close + 1

    def aligned(self, at, end, kind):
        """Numbers at any byte, at a place of memory that their type likes: others are slow. Long lists move within their own
        memory, over the bracket before them, so that they can be read once only."""
        values = np.frombuffer(self.view[at:end], np.uint8)
        off = values.ctypes.data % kind.itemsize
        if not values.flags.writeable or off > at or (off and len(values) < MOVED):
            return values.copy().view(kind)
        if off:
            moved = np.frombuffer(self.view[at - off:end - off], np.uint8)
            for a in range(0, len(moved), 1 << 24):
                moved[a:a + (1 << 24)] = values[a:a + (1 << 24)].copy()
            values = moved
        return values.view(kind)

    def find(self, text, at):
        found = re.compile(re.escape(text)).search(self.view, at)
        if not found:
            raise FormatError(f"{self.path}: '{text.decode()}' is missing")
        return found.start()

    def part(self, start, end):
        part = self.view[start:end]
        return part if isinstance(part, bytes) else part.tobytes()

    def closing(self, at, count, components):
        """Where the list ends whose content starts at `at`: of rows in brackets behind the second of two closing ones."""
        found = re.compile(rb"\)" + SKIP + rb"(\))" if components > 1 and count else rb"(\))", re.S).search(self.view, at)
        if not found:
            raise FormatError(f"{self.path}: a list is not closed")
        return found.start(1)


def read_head(path):
    """The first HEADER_WITHIN bytes of a file, unzipped: header and dimensions, whatever the size of the rest."""
    path = located(path)
    with (gzip.open if path.endswith(".gz") else open)(path, "rb") as f:
        try:
            return f.read(HEADER_WITHIN)
        except (gzip.BadGzipFile, EOFError, zlib.error):
            return b""


def class_of(path):
    """The class in the header of a file; "" where there is none."""
    found = re.search(rb"FoamFile\s*\{[^}]*\bclass\s+(\w+)\s*;", read_head(path))
    return readable(found.group(1)) if found else ""


def exponents(path):
    """Exponents of kg, m, s, K, mol, A, cd of the unit of a field file: a list of 7 numbers. FormatError without `dimensions`."""
    found = re.search(rb"\bdimensions\s*\[([^\]]*)\]", read_head(path))
    if not found:
        raise FormatError(f"{path}: no dimensions")
    powers = text_numbers(found.group(1), float, path).tolist()
    return powers + [0.0] * (BASE_UNITS - len(powers))


def without_comments(text):
    return re.sub(rb"/\*.*?\*/|//[^\n]*", b" ", text, flags=re.S) if b"/" in text else text


def text_numbers(text, kind, path):
    """The numbers of a text, whatever its brackets; FormatError names the file."""
    text = without_comments(text).translate(BLANKS)
    if not text.strip():
        return np.empty(0, kind)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, kind, sep=" ")
        except (DeprecationWarning, ValueError):
            raise FormatError(f"{path}: a list holds something that is no number") from None


class Field:
    """A file of a field on cells.

    path; components: 1, 3, 6 or 9 numbers in a cell; values(cells): its internal values; patches(): what
    boundaryField says. FormatError where the file is no such field; FileNotFoundError.
    """

    def __init__(self, path):
        self.file = FoamFile(path)
        kind = re.match(r"vol(\w+?)Field", self.file.header.get("class", ""))
        if not kind or kind.group(1) not in COMPONENTS:
            raise FormatError(f"{path}: class {self.file.header.get('class')} is no field on cells")
        self.path, self.components = path, COMPONENTS[kind.group(1)]
        self.entry = re.compile(rb"(?:internalField|value)\s+(uniform|nonuniform)\s*(?:List<\w+>)?").search(self.file.view)
        if not self.entry:
            raise FormatError(f"{path}: no internalField")

    @functools.cached_property
    def internal(self):
        """The internal values, one row or all, and the byte of the body behind them."""
        f, end = self.file, self.entry.end()
        if self.entry.group(1) == b"uniform":
            close = f.find(b";", end)
            return text_numbers(f.part(end, close), float, self.path), close
        return f.numbers(end, self.components, f.scalar)

    @property
    def expression(self):
        """Whether an expression gives the internal values, which only the solver evaluates; patches may have expressions, too."""
        tail = self.file.part(self.internal[1], len(self.file.view))
        outside = self.file.part(0, self.entry.start()) + b"\n" + tail.split(b"boundaryField", 1)[0] + b"\n" + tail.rsplit(b"}", 1)[-1]
        return re.search(rb"^\s*expression\b", outside, re.M) is not None

    def values(self, cells):
        """[cells] or [cells][components]; FormatError where the file has another number of them, or an expression."""
        values, _ = self.internal
        if self.expression:
            raise FormatError(f"{self.path}: the field is given by an expression, which only the solver evaluates")
        return self.spread(values, self.entry.group(1) == b"uniform", cells, "cells")

    def spread(self, values, uniform, count, things):
        """Values as they stand, of all `things`; one row of a uniform list is repeated."""
        if uniform:
            if len(values) != self.components:
                raise FormatError(f"{self.path}: {len(values)} numbers for {self.components}")
            return np.tile(values, (count, 1)) if self.components > 1 else np.full(count, values[0])
        if len(values) != count:
            raise FormatError(f"{self.path}: {len(values)} values on {'a mesh of ' if things == 'cells' else ''}{count} {things}")
        return values.astype(float, copy=not values.flags.writeable)

    def patches(self):
        """{name as written: Patch}, in the order of the file."""
        at = self.internal[1]
        start = re.compile(rb"\bboundaryField" + SKIP + rb"\{", re.S).search(self.file.view, at)
        if not start:
            raise FormatError(f"{self.path}: no boundaryField")
        found, at = {}, start.end()
        while True:
            name, at = self.word(at)
            if name == b"}":
                return found
            brace, at = self.word(at)
            if brace != b"{":
                raise FormatError(f"{self.path}: a dictionary is missing behind '{readable(name)}' in boundaryField")
            patch, at = self.patch(at)
            found[readable(name)] = patch

    def word(self, at):
        """The word, quoted text, bracket or semicolon at a byte of the body, and the byte behind it."""
        found = WORD.match(self.file.view, at)
        if not found:
            raise FormatError(f"{self.path}: boundaryField is not closed")
        return found.group(1), found.end()

    def patch(self, at):
        """The Patch whose entries begin at a byte, and the byte behind its }. Lists are passed by their lengths: they may be binary."""
        patch, depth, key, before = Patch(), 0, None, None
        while True:
            word, end = self.word(at)
            if word == b"{":
                depth += 1
            elif word == b"}":
                depth -= 1
                if depth < 0:
                    return patch, end
            elif word == b"nonuniform":
                kind, listed = self.word(end)
                size = COMPONENTS.get(kind.decode("latin-1")[5:-1].capitalize().replace("tensor", "Tensor"), self.components)
                values, end = self.file.numbers(listed if kind.startswith(b"List<") else end, size, self.file.scalar)
                if depth == 0 and key == b"value":
                    patch.value, patch.uniform = values, False
            elif depth == 0 and key == b"type" and before == b"type":
                patch.type = readable(word)
            elif depth == 0 and key == b"value" and word == b"uniform":
                close = self.file.find(b";", end)
                patch.value, patch.uniform, end = text_numbers(self.file.part(end, close), float, self.path), True, close
            if before in (None, b";", b"{", b"}"):
                key = word
            before, at = word, end


class Patch:
    """What a field file says of a patch: its type; value: numbers as they stand, or None without such an entry; uniform: one for all."""
    type, value, uniform = None, None, True


def read_field(path, cells):
    """Internal field: array [cells] or [cells][components]; FormatError says what is wrong with the file."""
    return Field(path).values(cells)


def header(kind, name, location="constant/polyMesh", note="", binary=False):
    """The text of a header for a file that is written."""
    note = f'    note        "{note}";\n' if note else ""
    how = 'binary;\n    arch        "LSB;label=32;scalar=64"' if binary else "ascii"
    return (f"FoamFile\n{{\n    version     2.0;\n    format      {how};\n    class       {kind};\n{note}"
            f'    location    "{location}";\n    object      {name};\n}}\n')


def write_dictionary(case, location, name, text):
    """Writes a dictionary of a case below its header."""
    os.makedirs(os.path.join(case, location), exist_ok=True)
    with open(os.path.join(case, location, name), "w") as f:
        f.write(header("uniformDimensionedVectorField" if name == "g" else "dictionary", name, location) + text)
