# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the shock ahead of a cylinder or a sphere in air stands by the Euler equations, by a program of its own: a reference for
the cases cylinder and sphere3D and for denseShocks, beside the fit of Billig (1967).

    python3 -m studies.exact.bluntBody cylinder 4 2.8 1.25 5 10      # body, Mach number, edge of the grid, times: stand-off then

Lengths are in radii of the body, times in radii over the speed of sound of the stream, which fills a polar grid at the start.
Second order: HLL (Harten, Lax & van Leer 1983) with the speeds of Davis (1988) and slopes by van Albada's mean, two stages a
step. HLL damps all waves, so there is no carbuncle.
"""
import sys

import numpy as np

GAMMA = 1.4


def conserved(W):
    rho, u, v, p = W
    return np.array([rho, rho * u, rho * v, p / (GAMMA - 1) + rho * (u * u + v * v) / 2])


def primitives(U):
    rho, u, v = U[0], U[1] / U[0], U[2] / U[0]
    return np.array([rho, u, v, np.maximum((GAMMA - 1) * (U[3] - rho * (u * u + v * v) / 2), 1e-8)])


def flux(W, nx, ny):
    rho, u, v, p = W
    q = u * nx + v * ny
    return q, np.sqrt(GAMMA * p / rho), np.array([rho * q, rho * u * q + p * nx, rho * v * q + p * ny, (conserved(W)[3] + p) * q])


def hll(G, nx, ny):
    """Fluxes across the faces between the states G [4][lines][n + 4], two of which at either end are beyond the grid."""
    a, b = G[..., 1:-1] - G[..., :-2], G[..., 2:] - G[..., 1:-1]
    slope = np.where(a * b > 0, a * b * (a + b) / (a * a + b * b + 1e-300), 0)
    left, right = (G[..., 1:-1] + slope / 2)[..., :-1], (G[..., 1:-1] - slope / 2)[..., 1:]
    (ql, cl, fl), (qr, cr, fr) = flux(left, nx, ny), flux(right, nx, ny)
    low, high = np.minimum(np.minimum(ql - cl, qr - cr), 0), np.maximum(np.maximum(ql + cl, qr + cr), 0)
    return (high * fl - low * fr + low * high * (conserved(right) - conserved(left))) / (high - low)


class Grid:
    """Cells [angle][radius] from the axis ahead of the body to `reach` radians off it, from the body to the radius `edge`."""

    def __init__(self, body, mach, edge, cells=(36, 45), reach=1.4):
        angle, radius = np.linspace(0, reach, cells[0] + 1), np.linspace(1, edge, cells[1] + 1)
        self.sphere, self.mach, self.stream = body == "sphere", mach, np.array([1, -mach, 0, 1 / GAMMA])
        self.middle, self.radius = (angle[1:] + angle[:-1])[:, None] / 2, (radius[1:] + radius[:-1]) / 2
        turn, side, ring = np.diff(angle)[:, None], np.diff(radius), np.diff(radius**2) / 2
        if self.sphere:  # of one radian about the axis
            cap = -np.diff(np.cos(angle))[:, None]
            self.volume, self.across, self.along = cap * np.diff(radius**3) / 3, cap * radius**2, np.sin(angle)[:, None] * ring
        else:
            self.volume, self.across, self.along = turn * ring, turn * radius, np.ones((len(angle), 1)) * side
        self.normal = np.cos(self.middle), np.sin(self.middle)
        self.slant = -np.sin(angle), np.cos(angle)
        self.width = 1 / (1 / side + 1 / (self.radius * turn))

    def rate(self, U):
        W, (nx, ny) = primitives(U), self.normal
        wall = W[..., 1::-1].copy()
        q = wall[1] * nx + wall[2] * ny
        wall[1:3] -= 2 * q * np.array([nx + 0 * q, ny + 0 * q])
        out = np.broadcast_to(self.stream[:, None, None], wall.shape)
        F = hll(np.concatenate((wall, W, out), axis=2), nx, ny) * self.across
        V = W.transpose(0, 2, 1)
        axis = V[..., 1::-1] * np.array([1, 1, -1, 1])[:, None, None]
        G = hll(np.concatenate((axis, V, V[..., -1:], V[..., -1:]), axis=2), *self.slant).transpose(0, 2, 1) * self.along
        rate = -np.diff(F, axis=2) - np.diff(G, axis=1)
        if self.sphere:  # the pressure on the sides of a cell about the axis: what closes its surface
            for k in (0, 1):
                rate[k + 1] += W[3] * (np.diff(self.across * self.normal[k], axis=1) + np.diff(self.along * self.slant[k][:, None], axis=0))
        return rate / self.volume

    def stand_off(self, U):
        """Where the density passes the mean of those ahead of and behind a normal shock, on the axis."""
        level = (1 + (GAMMA + 1) * self.mach**2 / ((GAMMA - 1) * self.mach**2 + 2)) / 2
        rho = 9 / 8 * U[0, 0] - U[0, 1] / 8  # it is even in the angle
        i = np.flatnonzero(rho < level)[0]
        return self.radius[i - 1] + (rho[i - 1] - level) / (rho[i - 1] - rho[i]) * (self.radius[i] - self.radius[i - 1]) - 1

    def run(self, times):
        """The stand-off at the times."""
        U, t, found = conserved(np.broadcast_to(self.stream[:, None, None], (4, *self.volume.shape))), 0.0, []
        for end in times:
            while t < end:
                W = primitives(U)
                dt = min(0.6 * (self.width / (np.hypot(W[1], W[2]) + np.sqrt(GAMMA * W[3] / W[0]))).min(), end - t)
                first = U + dt * self.rate(U)
                U, t = (U + first + dt * self.rate(first)) / 2, t + dt
            found.append(self.stand_off(U))
        return found


if __name__ == "__main__":
    numbers = [float(x) for x in sys.argv[2:]]
    print(*("%.3f" % x for x in Grid(sys.argv[1], *numbers[:2]).run(numbers[2:])))
