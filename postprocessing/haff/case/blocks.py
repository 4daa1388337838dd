# SPDX-License-Identifier: GPL-3.0-or-later
"""system/blockMeshDict instead of constant/polyMesh: blocks of equal boxes along the axes, as the solvers read them.

Points, faces and cells have the numbers that OpenFOAM's blockMesh gives them. FormatError: the file says something else than a union of
boxes whose cells are all equal; the programs say what is wrong with it, and blockMesh makes a polyMesh of it.
"""
import ast
import functools
import math
import operator
import os
import re
import shlex

import numpy as np

from haff.case import entries
from haff.case.foam import FormatError
from haff.case.lattice import Lattice
from haff.case.mesh import Mesh

TOLERANCE = 1e-6  # of a cell
SIDES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))  # own axes 0, 1, 2: low, high
ENDS = (1, 3, 4)  # the corner one step from corner 0 along an own axis
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))  # steps along the own axes to each corner
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow,
             ast.USub: operator.neg, ast.UAdd: operator.pos}
FUNCTIONS = {"sqrt": math.sqrt, "sin": math.sin, "cos": math.cos, "tan": math.tan, "exp": math.exp, "log": math.log, "pow": math.pow,
             "min": min, "max": max, "mag": abs, "floor": math.floor, "ceil": math.ceil, "round": round}


def arithmetic(text):
    """The number that the text of #eval gives."""
    def value(node):
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return node.value
        if isinstance(node, ast.Name) and node.id in ("pi", "e"):
            return getattr(math, node.id)
        if isinstance(node, (ast.BinOp, ast.UnaryOp)) and type(node.op) in OPERATORS:
            of = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.operand,)
            return OPERATORS[type(node.op)](*map(value, of))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS:
            return FUNCTIONS[node.func.id](*map(value, node.args))
        raise FormatError(f"'{text.strip()}' is more than arithmetic")
    return value(ast.parse(text.strip().replace("^", "**"), mode="eval").body)


def expanded(text, known):
    """A value with its macros and #eval done; known: {name: value} of the entries before it."""
    def macro(found):
        name = found[1] or found[2]
        if name.lstrip(":") not in known:
            raise FormatError(f"macro '${name}' names no entry that stands before it")
        return known[name.lstrip(":")]

    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.S)
    inside = lambda found: repr(float(arithmetic(re.sub(r"\$(?:\{(:?\w+)\}|(:?\w+))", lambda m: f"({macro(m)})", found[1] or found[2]))))
    text = re.sub(r'#(?:eval|calc)\s*(?:\{((?:[^{}]|\{[^{}]*\})*)\}|"([^"]*)")', inside, text)
    return re.sub(r"\$(?:\{(:?\w+)\}|(:?\w+))", macro, text)


def nested(text):
    """The lists of a text as lists; words and numbers as texts."""
    stack = [[]]
    for token in re.findall(r"[()]|[^\s()]+", text):
        if token == "(":
            stack.append([])
        elif token == ")" and len(stack) > 1:
            stack[-2].append(stack.pop())
        else:
            stack[-1].append(token)
    return stack[0][0] if len(stack[0]) == 1 else stack[0]


class Block:
    """low, n: place of the first cell and cells along x, y, z; axis, down: x, y or z of each own axis, and does it lead down; first: number
    of the first cell; vertices: the labels of the eight corners."""

    def __init__(self, vertices, n, corners, first):
        self.vertices, self.first = vertices, first
        steps = [corners[end] - corners[0] for end in ENDS]
        self.axis = [int(np.abs(step).argmax()) for step in steps]
        if (sorted(self.axis) != [0, 1, 2] or any(abs(step[k]) != n[a] for a, (step, k) in enumerate(zip(steps, self.axis)))
                or not np.array_equal(corners, corners[0] + np.array(CORNERS) @ np.array(steps))):
            raise FormatError("blocks must be boxes along the axes, and all cells equal")
        self.down = [bool(step[k] < 0) for step, k in zip(steps, self.axis)]
        self.low, self.n = corners.min(axis=0), np.ptp(corners, axis=0)
        self.own = list(n)

    def view(self, grid, more=0):
        """The part of a grid [nz][ny][nx] that the block has, by its own axes: [n2][n1][n0] (points: more = 1)."""
        part = grid[tuple(slice(self.low[k], self.low[k] + self.n[k] + more) for k in (2, 1, 0))]
        part = part.transpose([2 - self.axis[a] for a in (2, 1, 0)])
        return np.flip(part, [2 - a for a in range(3) if self.down[a]])

    def side(self, view, own):
        """What a view has at one of its own sides, in the order in which blockMesh numbers faces there."""
        a = own // 2
        flat = view.take(-1 if own % 2 else 0, axis=2 - a)
        return (flat if a == 0 else flat.T).ravel()

    def outward(self, own):
        """x, y or z across an own side, and does the way out lead up?"""
        a = own // 2
        return self.axis[a], (own % 2 == 1) != self.down[a]


class BlockMesh(Mesh):
    """A Mesh that system/blockMeshDict says. Arrays of points and faces are made on demand."""

    def __init__(self, path):
        self.folder = self.path = path
        try:
            self._read()
        except FormatError as e:
            raise FormatError(f"{path}: {e}") from None
        except KeyError as e:
            raise FormatError(f"{path}: there is no entry '{e.args[0]}'") from None
        except (ValueError, IndexError, TypeError, SyntaxError, entries.EntryError) as e:
            raise FormatError(f"{path}: it cannot be read ({e})") from None

    # ---- reading ----

    def _read(self):
        text = entries.read(self.path)
        if re.search(r"^\s*#(include|if|inputMode|remove|default)", text, re.M):
            raise FormatError("#include, #if and the like are not read here; run blockMesh, and constant/polyMesh is read")
        known = {}
        for entry in entries.parse(text, self.path):
            if not entry.is_dictionary and len(entry.path) == 1:
                known[entry.path[0]] = expanded(text[slice(*entry.value)], known)
            elif len(entry.path) == 2 and not entry.is_dictionary:
                known["/".join(entry.path)] = expanded(text[slice(*entry.value)], known)
        scale = float(known.get("scale", known.get("convertToMeters", 1)))
        vertex = scale * np.array([[float(x) for x in point] for point in nested(known["vertices"])])
        self._place(vertex, nested(known["blocks"]))
        self._bound(known["boundary"], known.get("defaultPatch/name"), known.get("defaultPatch/type"))

    def _place(self, vertex, tokens):
        hexes = []
        for i, token in enumerate(tokens):
            if token == "hex":
                lists = [t for t in tokens[i + 1:i + 6] if isinstance(t, list)][:3]
                if any(float(g) != 1 for g in lists[2]):
                    raise FormatError("only gradings of 1 are read: all cells must be equal")
                hexes.append(([int(v) for v in lists[0]], [int(n) for n in lists[1]]))
        used = vertex[[v for vertices, _ in hexes for v in vertices]]
        low, high = used.min(axis=0), used.max(axis=0)
        vertices, n = hexes[0]
        edges = np.abs(vertex[[vertices[end] for end in ENDS]] - vertex[vertices[0]])
        width = np.empty(3)
        for a in range(3):
            width[edges[a].argmax()] = edges[a].max() / n[a]
        self.n = np.floor((high - low) / width + 0.5).astype(int)
        self.low, self.high, self.width = low, high, (high - low) / self.n
        self.blocks, first = [], 0
        for vertices, n in hexes:
            exact = (vertex[vertices] - low) / self.width
            if np.abs(exact - np.rint(exact)).max() > TOLERANCE:
                raise FormatError("vertices lie beside the lattice of the cells, which must all be equal")
            self.blocks.append(Block(vertices, n, np.rint(exact).astype(int), first))
            first += math.prod(n)
        self._count = first

    def _bound(self, text, name, kind):
        sides = {}
        for b, block in enumerate(self.blocks):
            for own, corners in enumerate(SIDES):
                sides.setdefault(frozenset(block.vertices[c] for c in corners), []).append((b, own))
        outside = {key: found[0] for key, found in sides.items() if len(found) == 1}
        self._sides, kinds = {}, {}
        for patch, inside in re.findall(r'"?([^\s"(){}]+)"?\s*\{(.*?)\}', text, re.S):
            value = dict(re.findall(r"(\w+)\s+([^;]*);", inside))
            kinds[patch] = value["type"].strip()
            faces = [frozenset(int(v) for v in face) for face in nested("(" + value["faces"] + ")")[0]]
            if any(face not in outside for face in faces):
                raise FormatError(f"patch '{patch}' has a face that is no side of a block, or one that has a patch already")
            self._sides[patch] = [outside.pop(face) for face in faces]
        if outside:
            kinds[name or "defaultFaces"] = kind or "empty"
            self._sides[name or "defaultFaces"] = sorted(outside.values())
        area = lambda b, own: math.prod(self.blocks[b].own) // self.blocks[b].own[own // 2]
        counts = {patch: sum(area(*side) for side in found) for patch, found in self._sides.items()}
        doubled = sum(2 * math.prod(b.own) // n for b in self.blocks for n in b.own) - sum(counts.values())
        start = sum((n - 1) * math.prod(b.own) // n for b in self.blocks for n in b.own) + doubled // 2
        self.patches = {}
        for patch, count in counts.items():
            self.patches[patch] = (kinds[patch], start, count)
            start += count

    # ---- arrays ----

    @functools.cached_property
    def cells(self):
        return self._count

    @functools.cached_property
    def lattice(self):
        lines = [self._line(k) for k in range(3)]
        return Lattice(lines, self._places)

    def _line(self, k):
        """Coordinates of the planes across an axis, as the solvers have them."""
        line = self.low[k] + self.width[k] * np.arange(self.n[k] + 1)
        line[-1] = self.high[k]
        return line

    @functools.cached_property
    def _numbers(self):
        """The cell at each place, [nz][ny][nx]; -1 in holes."""
        grid = np.full(self.n[::-1], -1, np.int64)
        for block in self.blocks:
            view = block.view(grid)
            view[...] = block.first + np.arange(view.size).reshape(view.shape)
        return grid

    @functools.cached_property
    def _places(self):
        """The place i + nx*(j + ny*k) of each cell."""
        flat = self._numbers.ravel()
        there = np.flatnonzero(flat >= 0)
        places = np.empty(self._count, np.int64)
        places[flat[there]] = there
        return places

    @functools.cached_property
    def _points(self):
        """Numbers of the points on the planes, [nz+1][ny+1][nx+1], -1 where there is none; and how many there are."""
        grid, count = np.full(self.n[::-1] + 1, -1, np.int64), 0
        for block in self.blocks:
            view = block.view(grid, 1)
            new = view < 0
            added = int(new.sum())
            view[new] = count + np.arange(added)
            count += added
        return grid, count

    @functools.cached_property
    def points(self):
        grid, count = self._points
        there, out = np.nonzero(grid >= 0), np.empty((count, 3))
        number = grid[there]
        for k in range(3):
            out[number, k] = self._line(k)[there[2 - k]]
        return out

    def _corners(self, cells, axis, up):
        """Points [faces][4] of the sides of cells across an axis, right-handed about the way out."""
        nx, ny, _ = self.n
        place = self._places[cells]
        at = np.stack([place % nx, place // nx % ny, place // (nx * ny)])
        p, q = (axis + 1) % 3, (axis + 2) % 3
        turn = ((0, 0), (1, 0), (1, 1), (0, 1)) if up else ((0, 0), (0, 1), (1, 1), (1, 0))
        out = np.empty((len(cells), 4), np.int64)
        for j, (a, b) in enumerate(turn):
            x = at.copy()
            x[axis] += up
            x[p] += a
            x[q] += b
            out[:, j] = self._points[0][x[2], x[1], x[0]]
        return out

    @functools.cached_property
    def _inner(self):
        """Owner, neighbour and points of the inner faces, in OpenFOAM's order."""
        owner, neighbour, points = [], [], []
        for axis in range(3):
            one = np.moveaxis(self._numbers, 2 - axis, 0)
            low, high = one[:-1].ravel(), one[1:].ravel()
            both = (low >= 0) & (high >= 0)
            low, high = low[both], high[both]
            for up, a, b in ((True, low, high), (False, high, low)):
                some = a < b
                owner.append(a[some])
                neighbour.append(b[some])
                points.append(self._corners(a[some], axis, up))
        owner, neighbour, points = (np.concatenate(x) for x in (owner, neighbour, points))
        order = np.lexsort((neighbour, owner))
        return owner[order], neighbour[order], points[order]

    @functools.cached_property
    def _outer(self):
        """Owner and points of the faces of patches."""
        owner, points = [], []
        for found in self._sides.values():
            for b, own in found:
                block = self.blocks[b]
                cells = block.side(block.view(self._numbers), own)
                owner.append(cells)
                points.append(self._corners(cells, *block.outward(own)))
        return np.concatenate(owner), np.concatenate(points)

    @functools.cached_property
    def owner(self):
        return np.concatenate((self._inner[0], self._outer[0]))

    @functools.cached_property
    def neighbour(self):
        return self._inner[1]

    @functools.cached_property
    def _faces(self):
        flat = np.concatenate((self._inner[2], self._outer[1])).ravel()
        return np.arange(0, len(flat) + 1, 4), flat

    def release(self):
        super().release()
        for name in ("_inner", "_outer", "_points"):
            self.__dict__.pop(name, None)


def mesh_of(case):
    """The Mesh of constant/polyMesh or, without one, of system/blockMeshDict."""
    folder, blocks = os.path.join(case, "constant", "polyMesh"), os.path.join(case, "system", "blockMeshDict")
    if not os.path.isdir(folder) and os.path.isfile(blocks):
        return BlockMesh(blocks)
    try:
        return Mesh(folder)
    except FileNotFoundError as e:
        raise FileNotFoundError(f"{case} has no mesh ({e.filename} is missing): make it by  gmshToCase mesh.msh -case {shlex.quote(case)}, or by the case's Allrun") from None
