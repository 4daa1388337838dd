# SPDX-License-Identifier: GPL-3.0-or-later
"""Radial flow of a perfect gas without a sink: plane, cylindrical or spherical waves by a finite-volume scheme of its own.

    r, rho, u, p = solve(cells=4000, end=0.25, start=toro, geometry=2, gamma=1.4)      # on 0 < r < 1, walls at both ends

Areas r^geometry and volumes are exact, p pushes on the sides; MUSCL with van Leer's limiter in rho, u, p, HLLC fluxes (Toro 2009, 10.4),
Heun's method, Courant number 0.4. start(r) gives rho, u, p at the centres. Written apart from the solver, so that one can test the other.
"""
import numpy as np


def slopes(w):
    """Van Leer's, limited; 0 at both ends."""
    d = np.diff(w, axis=1)
    product = d[:, :-1] * d[:, 1:]
    inner = np.where(product > 0, 2 * product / np.where(product > 0, d[:, :-1] + d[:, 1:], 1), 0)
    return np.pad(inner, ((0, 0), (1, 1)))


def hllc(left, right, gamma):
    """Fluxes [3][n] between states rho, u, p."""
    def energy(w):
        return w[2] / (gamma - 1) + w[0] * w[1] ** 2 / 2
    cl, cr = (np.sqrt(gamma * w[2] / w[0]) for w in (left, right))
    sl, sr = np.minimum(left[1] - cl, right[1] - cr), np.maximum(left[1] + cl, right[1] + cr)
    ml, mr = left[0] * (sl - left[1]), right[0] * (sr - right[1])
    star = (right[2] - left[2] + ml * left[1] - mr * right[1]) / (ml - mr)
    out = []
    for w, s, m in ((left, sl, ml), (right, sr, mr)):
        U = np.array((w[0], w[0] * w[1], energy(w)))
        F = np.array((U[1], U[1] * w[1] + w[2], (U[2] + w[2]) * w[1]))
        middle = m / (s - star) * np.array((np.ones_like(s), star, U[2] / w[0] + (star - w[1]) * (star + w[2] / m)))
        out.append((F, F + s * (middle - U)))
    (FL, ML), (FR, MR) = out
    return np.where(sl > 0, FL, np.where(star > 0, ML, np.where(sr > 0, MR, FR)))


def solve(cells, end, start, geometry, gamma, length=1.0):
    edges = np.linspace(0, length, cells + 1)
    r, h = (edges[1:] + edges[:-1]) / 2, length / cells
    area, volume = edges**geometry, np.diff(edges ** (geometry + 1)) / (geometry + 1)
    side = np.diff(area)
    rho, u, p = (np.broadcast_to(v, r.shape).astype(float) for v in start(r))
    U = np.array((rho, rho * u, p / (gamma - 1) + rho * u**2 / 2))

    def primitive(U):
        return np.array((U[0], U[1] / U[0], (gamma - 1) * (U[2] - U[1] ** 2 / (2 * U[0]))))

    def rate(U):
        w = primitive(U)
        s = slopes(w) / 2
        low, high = w - s, w + s
        mirror = np.array([[1.0], [-1.0], [1.0]])
        F = hllc(np.hstack((mirror * low[:, :1], high)), np.hstack((low, mirror * high[:, -1:])), gamma) * area
        out = -np.diff(F, axis=1)
        out[1] += w[2] * side
        return out / volume

    t = 0.0
    while t < end:
        w = primitive(U)
        dt = min(0.4 * h / (np.abs(w[1]) + np.sqrt(gamma * w[2] / w[0])).max(), end - t)
        one = U + dt * rate(U)
        U = (U + one + dt * rate(one)) / 2
        t = end if end - t <= dt else t + dt
    return (r, *primitive(U))
