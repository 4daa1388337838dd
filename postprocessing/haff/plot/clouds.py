# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a scalar in a cube of cells as a cloud in the light of a lamp: rays through the cube add up what each layer sends and
what it leaves through; the light that reaches it has been dimmed by the layers above it. Needs scipy and matplotlib; no display.

    image = clouds.picture(values)               # [side][side][side], axes z, y, x; [rows][columns][3] from 0 to 1
"""
import numpy as np
from matplotlib import colormaps
from scipy.ndimage import gaussian_filter, map_coordinates, zoom

GROUND = np.array([0.024, 0.030, 0.052])


def view(azimuth, height):
    """Unit vectors to the right, upwards and away from who looks, components x, y, z; y is up."""
    a, h = np.radians(azimuth), np.radians(height)
    away = -np.array([np.cos(h) * np.sin(a), np.sin(h), np.cos(h) * np.cos(a)])
    right = np.cross(away, [0, 1, 0])
    right /= np.linalg.norm(right)
    return right, np.cross(right, away), away


def lit(thick, lean):
    """Light that reaches each place of a cube [z][y][x] from above, from a lamp that leans towards x and z by that number of places a layer."""
    light, above = np.empty_like(thick), np.zeros(thick[:, 0].shape)
    for y in range(thick.shape[1] - 1, -1, -1):
        at = np.indices(above.shape)
        above = map_coordinates(above, [at[0] + lean[1], at[1] + lean[0]], order=1, cval=0.0, prefilter=False)
        light[:, y] = np.exp(-(above + thick[:, y] / 2))
        above = above + thick[:, y]
    return light


class Cube:
    def __init__(self, values, low, high, depth=45.0, fine=3):
        """low, high: values at which a place becomes visible, and fully so; depth: optical, of a cube full of the latter."""
        side = len(values)
        pad = 4
        wide = zoom(np.pad(values, pad, mode="wrap"), fine, order=3, grid_mode=True, mode="nearest")
        self.values = wide[(slice(pad * fine, -pad * fine),) * 3]
        self.side = side * fine
        rise = np.clip((self.values - low) / (high - low), 0, 1)
        self.share = rise
        self.thick = depth / self.side * 4 * rise * (1.5 - 0.5 * rise)
        smooth = gaussian_filter(self.values, 1.0, mode="wrap")
        self.slope = np.array(np.gradient(smooth)[::-1])  # x, y, z
        soft = gaussian_filter(self.thick, 1.5 * fine, mode="nearest")
        self.light = 0.75 * lit(self.thick, (0.45, -0.35)) + 0.25 * np.exp(-soft * 0.9 * self.side / 26)

    def layer(self, at, lamp, colours):
        """Colour and thickness at places [3][..] in units of cells."""
        take = lambda q: map_coordinates(q, at[::-1] - 0.5, order=1, mode="nearest", prefilter=False)
        thick = take(self.thick)
        seen = np.flatnonzero(thick.ravel() > 1e-4)
        colour = np.zeros((thick.size, 3))
        if len(seen):
            at = at.reshape(3, -1)[:, seen]
            take = lambda q: map_coordinates(q, at[::-1] - 0.5, order=1, mode="nearest", prefilter=False)
            slope = np.array([take(q) for q in self.slope])
            facing = -(slope * lamp[:, None]).sum(axis=0) / (np.linalg.norm(slope, axis=0) + 1e-9)
            bright = 0.24 + take(self.light) * (0.5 + 1.3 * np.clip(0.3 + 0.7 * facing, 0, 1))
            colour[seen] = colours(0.27 + 0.66 * take(self.share) ** 0.85)[:, :3] * bright[:, None]
        return colour.reshape(thick.shape + (3,)), thick


def picture(values, low, high, pixels=512, azimuth=32.0, height=24.0, steps=0.6, colours=colormaps["inferno"], **options):
    cube = Cube(values, low, high, **options)
    right, up, away = view(azimuth, height)
    lamp = np.array([0.45, 1.0, 0.55]) / np.linalg.norm([0.45, 1.0, 0.55])
    reach, side = 0.78 * cube.side, cube.side
    x = np.linspace(-reach, reach, pixels)
    flat = right[:, None, None] * x[None, None, :] + up[:, None, None] * -x[None, :, None] + side / 2
    image, clear = np.zeros((pixels, pixels, 3)), np.ones((pixels, pixels))
    crossed = np.sort([-flat / away[:, None, None], (side - flat) / away[:, None, None]], axis=0)
    enters, leaves = crossed[0].max(axis=0), crossed[1].min(axis=0)
    for s in np.arange(-0.87 * side, 0.87 * side, steps):
        inside = (enters < s) & (s < leaves) & (clear > 0.004)
        if not inside.any():
            continue
        colour, thick = cube.layer(flat[:, inside] + away[:, None] * s, lamp, colours)
        left = np.exp(-thick * steps)
        image[inside] += (clear[inside] * (1 - left))[:, None] * colour
        clear[inside] *= left
    glow = np.exp(-((x[None, :] / reach) ** 2 + ((x[:, None] + 0.1 * reach) / reach) ** 2) * 1.2)
    image += clear[..., None] * GROUND * (0.5 + 1.4 * glow[..., None])
    edges(image, clear, right, up, away, side, reach)
    return np.clip(image, 0, 1) ** 0.9


def edges(image, clear, right, up, away, side, reach):
    """Draws the edges of the cube, as far as nothing lies before them (those behind the cloud are dimmed by it)."""
    pixels = len(clear)
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")).reshape(3, -1).T
    nearest = corners[np.argmin((corners - 0.5) @ away)]
    glow = np.zeros_like(clear)
    for a in corners:
        for k in range(3):
            if a[k]:
                continue
            b = a + np.eye(3, dtype=int)[k]
            line = (a + np.linspace(0, 1, 4 * pixels)[:, None] * (b - a) - 0.5) * side
            col = np.rint((line @ right / reach + 1) / 2 * (pixels - 1)).astype(int)
            row = np.rint((1 - line @ up / reach) / 2 * (pixels - 1)).astype(int)
            front = (a == nearest).all() or (b == nearest).all()
            use = (col >= 0) & (col < pixels) & (row >= 0) & (row < pixels)
            glow[row[use], col[use]] = np.maximum(glow[row[use], col[use]], 0.0 if front else 1.0)
    image += (gaussian_filter(glow, 0.7) * 0.55 * clear)[..., None] * np.array([0.45, 0.55, 0.75])
