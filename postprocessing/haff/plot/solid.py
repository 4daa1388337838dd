# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces and clouds of fields in three dimensions.

    surface = isosurface(space, values, value)       corners, normals [n][3][3] of the surface on which a field has the value
    walls(space, view)                               the walls behind the gas, as one sees them from there
    cloud(canvas, space, values, span, colours)      the field as a cloud: thick and bright where it is large

Cells are cut into tetrahedra, on each of which the field is linear: a lattice into five of the cubes between the middles of its cells,
any other mesh into those between the middle of a cell and the triangles of its faces, with means at the points of the mesh.
"""
import numpy as np

from haff.plot.quantity import CannotDraw

SIDE = 200  # places along an axis of a raster beyond which a lattice is averaged
FIVE = (((0, 3, 5, 6), (1, 0, 3, 5), (2, 0, 3, 6), (4, 0, 5, 6), (7, 3, 5, 6)),  # corners i + 2 j + 4 k of a cube; its mirror image
        ((1, 2, 4, 7), (0, 1, 2, 4), (3, 1, 2, 7), (5, 1, 4, 7), (6, 2, 4, 7)))


# ---- tetrahedra ----

def cut_tetrahedra(tetrahedra, values, value):
    """Triangles of edges: [n][3][2] numbers of points, for tetrahedra [m][4] of points with values [points]."""
    above = values[tetrahedra] > value
    count = above.sum(axis=1)
    found = []
    for lonely, rows in ((True, count == 1), (False, count == 3)):
        t, a = tetrahedra[rows], above[rows]
        apex = np.argmax(a if lonely else ~a, axis=1)
        others = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[apex]
        top, base = np.take_along_axis(t, apex[:, None], 1), np.take_along_axis(t, others, 1)
        found.append(np.stack([np.broadcast_to(top, base.shape), base], axis=2))
    t, a = tetrahedra[count == 2], above[count == 2]
    order = np.argsort(~a, axis=1, kind="stable")
    p, q, r, s = np.take_along_axis(t, order, 1).T  # p, q above
    edge = lambda i, j: np.stack([i, j], axis=1)
    found.append(np.stack([edge(p, r), edge(p, s), edge(q, r)], axis=1))
    found.append(np.stack([edge(q, r), edge(p, s), edge(q, s)], axis=1))
    return np.concatenate(found)


def surface_of(tetrahedra, points, values, value):
    """corners, normals [n][3][3]: normals are means over the triangles around a corner."""
    edges = cut_tetrahedra(tetrahedra, values, value)
    if not len(edges):
        return np.empty((0, 3, 3)), np.empty((0, 3, 3))
    a, b = np.sort(edges.reshape(-1, 2).astype(np.int64), axis=1).T
    _, first, index = np.unique(a * np.int64(len(values)) + b, return_index=True, return_inverse=True)
    index = index.reshape(-1)
    a, b = a[first], b[first]
    share = np.clip((value - values[a]) / np.where(values[a] == values[b], 1, values[b] - values[a]), 0, 1)
    place = points(a) + share[:, None] * (points(b) - points(a))
    index = index.reshape(-1, 3)
    corners = place[index]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = points(edges[:, 0, 0]) - points(edges[:, 0, 1])  # turned to one side: from below to above
    side = np.where((values[edges[:, 0, 0]] > values[edges[:, 0, 1]]), 1, -1)
    area *= np.sign(side * np.einsum("ij,ij->i", area, middle))[:, None]
    normal = np.stack([np.bincount(index.ravel(), np.repeat(area[:, k], 3), len(place)) for k in range(3)], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None] + 1e-300
    return corners, normal[index]


# ---- rasters ----

def raster(space, values, side=SIDE):
    """(x, y, z): middles of places, and means [nz][ny][nx] of the field there, nan where no cell is; side: the most along an axis."""
    if space.lattice is None:
        raise CannotDraw("only a lattice has a raster")
    grid, middles = space.lattice.raster(values), space.lattice.middles
    for axis in range(3):
        at = 2 - axis
        step = -(-grid.shape[at] // side)
        if step > 1:
            keep = grid.shape[at] // step * step
            part = np.moveaxis(grid, at, 0)[:keep].reshape(keep // step, step, *np.delete(grid.shape, at))
            grid = np.moveaxis(part.mean(axis=1), 0, at)
            middles = tuple(m[:keep].reshape(-1, step).mean(axis=1) if k == axis else m for k, m in enumerate(middles))
    return middles, grid


def wrapped(space, middles, grid):
    """The raster with one more layer at each end, on the end of the mesh itself, with the values of the last cells."""
    middles = tuple(np.concatenate(([space.low[k]], m, [space.high[k]])) for k, m in enumerate(middles))
    return middles, np.pad(grid, 1, mode="edge")


def lattice_surface(space, values, value):
    (x, y, z), grid = wrapped(space, *raster(space, values))
    flat = grid.ravel()
    nz, ny, nx = grid.shape
    mark = grid > value
    low = mark[:-1, :-1, :-1].copy()
    high = low.copy()
    known = ~np.isnan(grid)
    whole = known[:-1, :-1, :-1].copy()
    for k in range(1, 8):
        some = tuple(slice((k >> bit) & 1, n - 1 + ((k >> bit) & 1)) for bit, n in ((2, nz), (1, ny), (0, nx)))
        low &= mark[some]
        high |= mark[some]
        whole &= known[some]
    at = np.flatnonzero((high & ~low & whole).ravel())
    i = at % (nx - 1)
    j = at // (nx - 1) % (ny - 1)
    k = at // ((nx - 1) * (ny - 1))
    corner = i + nx * (j + ny * k)
    step = np.array([(c & 1) + nx * ((c >> 1 & 1) + ny * (c >> 2)) for c in range(8)])
    odd = (i + j + k) % 2
    parts = [corner[odd == s, None, None] + step[np.array(FIVE[s])][None] for s in range(2)]
    tetrahedra = np.concatenate([p.reshape(-1, 4) for p in parts])
    points = lambda p: np.stack([x[p % nx], y[p // nx % ny], z[p // (nx * ny)]], axis=1)
    return surface_of(tetrahedra, points, flat, value)


# ---- any mesh ----

def point_values(space, values):
    """Means over the cells around each point of the mesh [points]."""
    mesh = space.mesh
    count = np.diff(mesh.face_start)
    total, weight = np.zeros(len(mesh.points)), np.zeros(len(mesh.points))
    for cell, some in ((mesh.owner, slice(None)), (mesh.neighbour, slice(0, len(mesh.neighbour)))):
        corners = mesh.face_points[:mesh.face_start[len(cell)]]
        total += np.bincount(corners, np.repeat(values[cell], count[some]), len(total))
        weight += np.bincount(corners, minlength=len(total))
    return total / np.maximum(weight, 1)


def mesh_surface(space, values, value):
    mesh = space.mesh
    at_points = point_values(space, values)
    both = np.concatenate((at_points, values))
    place = np.concatenate((mesh.points, space.case.centres))
    count = np.diff(mesh.face_start)
    low = np.minimum.reduceat(at_points[mesh.face_points], mesh.face_start[:-1])
    high = np.maximum.reduceat(at_points[mesh.face_points], mesh.face_start[:-1])
    found = []
    for cell, faces in ((mesh.owner, np.arange(len(mesh.owner))), (mesh.neighbour, np.arange(len(mesh.neighbour)))):
        near = (np.minimum(low[faces], values[cell]) <= value) & (np.maximum(high[faces], values[cell]) >= value)
        f, c = faces[near], cell[near]
        first = mesh.face_start[f]
        for k in range(1, count.max() - 1):
            some = count[f] > k + 1
            corners = [mesh.face_points[first[some] + j] for j in (0, k, k + 1)]
            found.append(np.stack([*corners, len(mesh.points) + c[some]], axis=1))
    return surface_of(np.concatenate(found), lambda p: place[p], both, value)


def isosurface(space, values, value):
    return lattice_surface(space, values, value) if space.lattice else mesh_surface(space, values, value)


# ---- walls ----

def wall_area(space, view):
    """How much of the walls one sees from there, through the gas: their projected area."""
    faces, wall = space.ends if space.few else (np.empty(0, int), np.empty(0, bool))
    if not wall.any():
        return 0.0
    return float(np.maximum(-space.end_areas[wall] @ view.back, 0).sum())


def walls(space, view):
    """corners, normals [n][3][3] of the walls whose inner side one sees: those behind the gas, and bodies in it."""
    empty = np.empty((0, 3, 3))
    if not space.few:
        return empty, empty
    faces, wall = space.ends
    faces = faces[wall]
    if not len(faces):
        return empty, empty
    corners, count = space.corners(faces)
    start = np.cumsum(count) - count
    triangles = []
    for k in range(1, count.max() - 1):
        some = start[count > k + 1]
        triangles.append(np.stack([corners[some], corners[some + k], corners[some + k + 1]], axis=1))
    triangles = np.concatenate(triangles)
    area = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    seen = area @ view.back < 0  # areas point out of the gas
    triangles, area = triangles[seen], area[seen]
    normal = area / (np.linalg.norm(area, axis=1)[:, None] + 1e-300)
    return triangles, np.repeat(normal[:, None], 3, axis=1)


def edges(space):
    """Edges [n][2][3] of the ends of the mesh: where faces of its boundary meet at more than 40 degrees. A big lattice: its box."""
    if space.lattice and (space.lattice.full or not space.few):
        low, high = space.low, space.high
        corner = lambda i, j, k: np.where([i, j, k], high, low)
        pairs = [((0, a, b), (1, a, b)) for a in (0, 1) for b in (0, 1)]
        pairs += [((a, 0, b), (a, 1, b)) for a in (0, 1) for b in (0, 1)] + [((a, b, 0), (a, b, 1)) for a in (0, 1) for b in (0, 1)]
        return np.array([[corner(*p), corner(*q)] for p, q in pairs])
    mesh = space.mesh
    faces = np.arange(len(mesh.neighbour), len(mesh.owner))
    start = mesh.face_start[faces[0]]
    corners = mesh.face_points[start:]
    first = mesh.face_start[faces[0]:] - start
    following = np.arange(1, len(corners) + 1)
    following[first[1:] - 1] = first[:-1]
    face = np.repeat(np.arange(len(faces)), np.diff(first))
    normal = mesh.face_geometry(faces[0])[1]
    normal /= np.linalg.norm(normal, axis=1)[:, None] + 1e-300
    pair = np.sort(np.stack([corners, corners[following]], axis=1), axis=1)
    order = np.lexsort((pair[:, 1], pair[:, 0]))
    same = (pair[order][1:] == pair[order][:-1]).all(axis=1)
    one, two = order[:-1][same], order[1:][same]
    sharp = np.einsum("ij,ij->i", normal[face[one]], normal[face[two]]) < np.cos(np.radians(40))
    return mesh.points[pair[one[sharp]]]


# ---- clouds ----

def any_raster(space, values, side=120):
    """The raster of a lattice; of another mesh one of about `side` places along its longest axis, each of the nearest cell."""
    if space.lattice:
        return raster(space, values, side)
    from scipy.spatial import cKDTree
    step = space.size.max() / side
    middles = tuple(np.linspace(a, b, 2 * max(2, int(round((b - a) / step))) + 1)[1::2] for a, b in zip(space.low, space.high))
    z, y, x = np.meshgrid(*middles[::-1], indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    cell = cKDTree(space.case.centres).query(places)[1]
    grid = values[cell]
    grid[outside(space, places, cell)] = np.nan
    return middles, grid.reshape(x.shape)


def outside(space, places, cell):
    """Places [n] beyond a boundary face of their nearest cell."""
    mesh = space.mesh
    centre, area = mesh.face_geometry()
    first = len(mesh.neighbour)
    order = np.argsort(mesh.owner[first:], kind="stable")
    owner = mesh.owner[first:][order]
    begin, end = np.searchsorted(owner, cell, "left"), np.searchsorted(owner, cell, "right")
    beyond = np.zeros(len(places), bool)
    for k in range(int((end - begin).max(initial=0))):
        some = np.flatnonzero(begin + k < end)
        face = first + order[begin[some] + k]
        beyond[some] |= np.einsum("ij,ij->i", places[some] - centre[face], area[face]) > 0
    return beyond


def cloud(canvas, space, values, span, colours, depth=6.0, steps=220):
    """Draws a field as a cloud into the canvas, in front of and behind what is drawn there. depth: optical, of a box full of the upper
    end of the span. Light comes from the lamp of the canvas by the slope of the field."""
    try:
        from scipy.ndimage import map_coordinates
    except ImportError:
        raise CannotDraw("-volume needs scipy (Debian: python3-scipy)") from None
    middles, grid = any_raster(space, values, 160)
    level = np.clip((grid - span[0]) / ((span[1] - span[0]) or 1), 0, 1)
    level[np.isnan(grid)] = 0
    slope = np.array(np.gradient(level)[::-1]) if min(level.shape) > 1 else np.zeros((3, *level.shape))
    view, fine = canvas.view, canvas.width // 450 or 1
    column, row = np.arange(0, canvas.width, fine) + fine // 2, np.arange(0, canvas.height, fine) + fine // 2
    x = (column + 0.5 - canvas.width / 2) / canvas.scale + view.middle[0]
    y = (canvas.height / 2 - row - 0.5) / canvas.scale + view.middle[1]
    flat = (x[None, :, None] * view.right + y[:, None, None] * view.up).reshape(-1, 3)
    reach = np.abs(view.back) @ space.size / 2
    middle = ((space.low + space.high) / 2) @ view.back
    depths = np.linspace(middle - reach, middle + reach, steps)
    clear, image = np.ones(len(flat)), np.zeros((len(flat), 3))
    solid = canvas.depth.reshape(canvas.height, canvas.width)[np.minimum(row, canvas.height - 1)][:, np.minimum(column, canvas.width - 1)].ravel()
    with np.errstate(divide="ignore", invalid="ignore"):  # where the ray of a pixel enters the box, or leaves what is drawn, and where it ends
        ends = (space.low - flat) / view.back, (space.high - flat) / view.back
    near, far = np.maximum(np.minimum(*ends).max(axis=1), solid / canvas.scale), np.maximum(*ends).min(axis=1)
    rays = np.flatnonzero(near < far)
    width = np.array([(m[-1] - m[0]) / max(len(m) - 1, 1) or 1 for m in middles])
    start, shift = ((flat - [m[0] for m in middles]) / width).T[::-1], (view.back / width)[::-1, None]
    for s in depths[::-1]:
        inside = rays[(near[rays] < s) & (s < far[rays]) & (clear[rays] > 0.01)]
        if not len(inside):
            continue
        at = start[:, inside] + s * shift
        here = map_coordinates(level, at, order=1, mode="nearest", prefilter=False)
        left = np.exp(-depth * here**1.5 * 3 / steps * np.linalg.norm(space.size) / space.size.max())
        normal = -np.stack([map_coordinates(g, at, order=1, mode="nearest", prefilter=False) for g in slope], axis=1)
        normal /= np.linalg.norm(normal, axis=1)[:, None] + 0.02
        bright = 0.8 + 0.35 * (normal @ canvas.lamp)
        image[inside] += (clear[inside] * (1 - left))[:, None] * np.clip(colours(here)[:, :3] * bright[:, None], 0, 1)
        clear[inside] *= left
    blend(canvas, image.reshape(len(row), len(column), 3), clear.reshape(len(row), len(column)), fine)


def blend(canvas, image, clear, fine):
    """Lays an image, of one pixel for each `fine` of the canvas, and what it leaves clear over the canvas."""
    tall = lambda a: np.repeat(np.repeat(a, fine, axis=0), fine, axis=1)[:canvas.height, :canvas.width]
    image, clear = tall(image), tall(clear)
    under, strength = canvas.colour[:, :3].reshape(*clear.shape, 3), canvas.colour[:, 3].reshape(clear.shape)
    total = 1 - clear * (1 - strength)
    colour = image + (clear * strength)[..., None] * under
    canvas.colour[:, :3] = (colour / np.maximum(total, 1e-6)[..., None]).reshape(-1, 3)
    canvas.colour[:, 3] = total.ravel()
