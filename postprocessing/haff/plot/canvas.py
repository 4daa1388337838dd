# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws triangles, spheres and lines in three dimensions into an image, nearest first, without a display and without a graphics card.

    canvas = Canvas(View(low, high), pixels=(900, 700))
    canvas.triangles(corners, normals, colours)      [n][3][3], [n][3][3], [n][3] or [3]
    canvas.spheres(centres, radii, colours)          [n][3], [n], [n][3]
    canvas.lines(ends, colour)                       [n][2][3]
    image = canvas.image()                           [rows][columns][4] from 0 to 1

Parallel rays; a lamp beside the eye, one from above, and shade. Everything is drawn at twice the pixels and averaged.
"""
import numpy as np

FINE = 2  # drawn pixels per pixel
ROOM = 4_000_000  # trials at once


class View:
    """From where one looks at a box, and the frame that holds it. up: 0, 1, 2, the axis that points upwards."""

    def __init__(self, low, high, azimuth=35.0, height=22.0, up=1):
        a, h = np.radians(azimuth), np.radians(height)
        right_axis, far_axis = {1: (0, 2), 2: (1, 0), 0: (1, 2)}[up]
        unit = np.eye(3)
        side = np.cos(a) * unit[far_axis] + np.sin(a) * unit[right_axis]
        self.back = np.cos(h) * side + np.sin(h) * unit[up]  # towards the eye
        self.right = np.cross(unit[up], self.back)
        self.right /= np.linalg.norm(self.right)
        self.up = np.cross(self.back, self.right)
        self.low, self.high = np.asarray(low, float), np.asarray(high, float)
        at = self.project(box_corners(self.low, self.high))[:, :2]
        self.middle = (at.min(axis=0) + at.max(axis=0)) / 2
        self.span = np.maximum(np.ptp(at, axis=0), 1e-300)

    def project(self, points):
        """Right, up and towards the eye: [n][3]."""
        return points @ np.stack([self.right, self.up, self.back], axis=1)


def box_corners(low, high):
    return np.array(np.meshgrid(*zip(low, high), indexing="ij")).reshape(3, -1).T


class Canvas:
    def __init__(self, view, pixels=(800, 640), margin=0.04):
        self.view = view
        self.width, self.height = (FINE * p for p in pixels)
        self.scale = min(self.width / view.span[0], self.height / view.span[1]) * (1 - 2 * margin)
        self.depth = np.full(self.width * self.height, -np.inf)
        self.colour = np.zeros((self.width * self.height, 4), np.float32)
        lamp = 0.75 * view.back + 0.7 * view.up - 0.45 * view.right
        self.lamp = lamp / np.linalg.norm(lamp)

    def place(self, points):
        """Column, row (downwards) and nearness of points [n][3], in drawn pixels."""
        at = self.view.project(points)
        out = np.empty_like(at)
        out[:, 0] = (at[:, 0] - self.view.middle[0]) * self.scale + self.width / 2
        out[:, 1] = self.height / 2 - (at[:, 1] - self.view.middle[1]) * self.scale
        out[:, 2] = at[:, 2] * self.scale
        return out

    def put(self, pixel, depth, colour):
        """Colours [n][3] at pixels [n], where they are nearer than what is there."""
        nearer = np.flatnonzero(depth > self.depth[pixel])
        order = nearer[np.argsort(depth[nearer], kind="stable")]  # of those on one pixel the last, the nearest, stays
        self.depth[pixel[order]] = depth[order]
        self.colour[pixel[order], :3] = colour[order]
        self.colour[pixel[order], 3] = 1

    def shade(self, normals, colours):
        """Light on surfaces with normals [n][3], of either side."""
        towards = normals @ self.view.back
        normals = np.where(towards[:, None] < 0, -normals, normals)
        lit = np.clip(normals @ self.lamp, 0, 1)
        glint = np.clip(2 * lit * (normals @ self.view.back) - self.lamp @ self.view.back, 0, 1) ** 24
        bright = 0.42 + 0.20 * np.abs(towards) + 0.42 * lit
        return np.clip(colours * bright[:, None] + 0.16 * glint[:, None], 0, 1)

    # ---- surfaces ----

    def triangles(self, corners, normals, colours, shaded=True):
        """corners, normals: [n][3][3]; colours: [3], [n][3] or, at the corners, [n][3][3]."""
        if not len(corners):
            return
        colours = np.broadcast_to(np.asarray(colours, float), (len(corners), 3)) if np.ndim(colours) < 3 else np.asarray(colours, float)
        at = self.place(corners.reshape(-1, 3)).reshape(-1, 3, 3)
        low = np.floor(at[:, :, :2].min(axis=1)).astype(int)
        size = np.ceil(at[:, :, :2].max(axis=1)).astype(int) - low + 1
        size = size.max(axis=1)
        for width in (2, 3, 4, 6, 9, 14, 22, 36, 64, 128, 256, 1024, 4096):
            some = np.flatnonzero(size <= width)
            size[some] = 1 << 30
            step = max(1, ROOM // (width * width))
            for first in range(0, len(some), step):
                part = some[first:first + step]
                self.fill(at[part], low[part], width, normals[part], colours[part], shaded)

    def fill(self, at, low, width, normals, colours, shaded):
        dy, dx = (g.ravel() for g in np.mgrid[:width, :width])
        x, y = low[:, :1] + dx + 0.5, low[:, 1:] + dy + 0.5
        a, b, c = at[:, 0], at[:, 1], at[:, 2]
        area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        with np.errstate(divide="ignore", invalid="ignore"):
            u = ((x - a[:, :1]) * (c[:, 1:2] - a[:, 1:2]) - (y - a[:, 1:2]) * (c[:, :1] - a[:, :1])) / area[:, None]
            v = ((b[:, :1] - a[:, :1]) * (y - a[:, 1:2]) - (b[:, 1:2] - a[:, 1:2]) * (x - a[:, :1])) / area[:, None]
            slack = 1e-6
            hit = (u >= -slack) & (v >= -slack) & (u + v <= 1 + slack) & (x > 0) & (x < self.width) & (y > 0) & (y < self.height)
        which, where = np.nonzero(hit)
        if not len(which):
            return
        u, v = u[which, where], v[which, where]
        w = np.stack([1 - u - v, u, v], axis=1)
        depth = np.einsum("ij,ij->i", w, at[which, :, 2])
        pixel = (low[which, 1] + dy[where]) * self.width + low[which, 0] + dx[where]
        colour = colours[which] if colours.ndim == 2 else np.einsum("ij,ijk->ik", w, colours[which])
        if shaded:
            normal = np.einsum("ij,ijk->ik", w, normals[which])
            normal /= np.linalg.norm(normal, axis=1)[:, None] + 1e-300
            colour = self.shade(normal, colour)
        self.put(pixel, depth, colour)

    def spheres(self, centres, radii, colours):
        """Spheres as round, shaded dots; none is smaller than a pixel of the image."""
        at = self.place(centres)
        radius = np.maximum(np.broadcast_to(radii, len(at)) * self.scale, 0.6 * FINE)
        reach = np.ceil(radius).astype(int)
        for r in np.unique(reach):
            some = np.flatnonzero(reach == r)
            some = some[np.argsort(-at[some, 2])]  # from the front to the back: what is hidden by earlier ones is not shaded
            dy, dx = (g.ravel() for g in np.mgrid[-r:r + 1, -r:r + 1])
            step = max(1, ROOM // len(dx))
            for first in range(0, len(some), step):
                part = some[first:first + step]
                self.balls(at[part], radius[part], colours[part], dx, dy)

    def balls(self, at, radius, colours, dx, dy):
        column, row = (np.floor(at[:, k]).astype(int)[:, None] + d for k, d in ((0, dx), (1, dy)))
        x, y = (column + 0.5 - at[:, :1]) / radius[:, None], (row + 0.5 - at[:, 1:2]) / radius[:, None]
        hit = (x * x + y * y < 1) & (column >= 0) & (column < self.width) & (row >= 0) & (row < self.height)
        which, where = np.nonzero(hit)
        x, y = x[which, where], y[which, where]
        z = np.sqrt(1 - x * x - y * y)
        pixel, depth = row[which, where] * self.width + column[which, where], at[which, 2] + z * radius[which]
        seen = depth > self.depth[pixel]
        which, x, y, z, pixel, depth = (a[seen] for a in (which, x, y, z, pixel, depth))
        normal = x[:, None] * self.view.right - y[:, None] * self.view.up + z[:, None] * self.view.back
        rim = np.clip((z - 0.12) / 0.2, 0.35, 1)[:, None]  # a dark rim parts spheres of one colour
        self.put(pixel, depth, self.shade(normal, colours[which]) * rim)

    # ---- lines ----

    def lines(self, ends, colour, width=1.0, hidden=None):
        """Lines [n][2][3]; parts behind surfaces are left out, or drawn with the strength `hidden`."""
        if not len(ends):
            return
        at = self.place(ends.reshape(-1, 3)).reshape(-1, 2, 3)
        steps = np.maximum(np.ceil(np.abs(at[:, 1, :2] - at[:, 0, :2]).max(axis=1) * 1.5).astype(int), 1) + 1
        line = np.repeat(np.arange(len(at)), steps)
        share = (np.arange(len(line)) - np.repeat(np.cumsum(steps) - steps, steps)) / np.repeat(steps - 1, steps)
        place = at[line, 0] + share[:, None] * (at[line, 1] - at[line, 0])
        reach = int(np.ceil(width * FINE / 2))
        dy, dx = (g.ravel() for g in np.mgrid[-reach:reach + 1, -reach:reach + 1])
        disk = dx * dx + dy * dy <= (width * FINE / 2) ** 2
        for x, y in zip(dx[disk], dy[disk]):
            column, row = np.floor(place[:, 0]).astype(int) + x, np.floor(place[:, 1]).astype(int) + y
            inside = (column >= 0) & (column < self.width) & (row >= 0) & (row < self.height)
            pixel, depth = (row * self.width + column)[inside], place[inside, 2] + 1.5
            free = depth >= self.depth[pixel]
            self.colour[pixel[free], :3], self.colour[pixel[free], 3] = colour, 1
            if hidden:
                behind = np.unique(pixel[~free])
                self.colour[behind, :3] = (1 - hidden) * self.colour[behind, :3] + hidden * np.asarray(colour)

    def image(self):
        """[rows][columns][4], from 0 to 1, transparent where nothing is."""
        fine = self.colour.reshape(self.height // FINE, FINE, self.width // FINE, FINE, 4)
        strength = fine[..., 3].mean(axis=(1, 3))
        colour = (fine[..., :3] * fine[..., 3:]).mean(axis=(1, 3)) / np.maximum(strength, 1e-6)[..., None]
        return np.clip(np.concatenate([colour, strength[..., None]], axis=2), 0, 1)
