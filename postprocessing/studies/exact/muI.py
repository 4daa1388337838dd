# SPDX-License-Identifier: GPL-3.0-or-later
"""Steady flow of a dense layer down a rough slope by the law of Jop, Forterre & Pouliquen, Nature 441 (2006) 727.

    haff muI [-slope 27] [-depth 22.5] [-width 48] [-cells 40]

prints V* = u_max/sqrt(g d) and Q* = Q/(d^1.5 g^0.5), Q the flow per width, of the layer between rough side walls and of one without; depth and width in
grain diameters d. The law is that of an incompressible fluid: tau = mu(I) p, mu = MU_S + (MU_2 - MU_S)/(1 + I_0/I), I = d |grad u|/sqrt(p/rho_grain), with the
pressure p of the weight alone. Without side walls I is the same at all depths, and the velocity is Bagnold's, as in the grains of Silbert, Landry & Grest
(2003): V* goes as depth^1.5, Q* as depth^2.5.

Between side walls u(x, y) obeys div(mu p grad u/|grad u|) + rho g sin(slope) = 0: u = 0 at floor and side walls, no stress at the surface. Finite volumes, the
viscosity mu p/|grad u| of the iteration before, until u_max changes by less than 1e-6."""
import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

from haff import command

MU_S, MU_2, I_0, PACKING = np.tan(np.radians(20.9)), np.tan(np.radians(32.76)), 0.279, 0.6  # glass beads, as printed there
FLAT = 1e-7  # of the shear rates: what is added under the root where nothing shears


def bagnold(slope, depth):
    """(V*, Q*) of a layer without side walls; (0, 0) where it rests. ValueError where no steady flow exists."""
    tangent = np.tan(np.radians(slope))
    if tangent >= MU_2:
        raise ValueError(f"at {slope:g} degrees this law has no steady flow: mu is {MU_2:.3f} at most, tan(slope) {tangent:.3f}")
    number = max(0.0, I_0 * (tangent - MU_S) / (MU_2 - tangent)) * np.sqrt(PACKING * np.cos(np.radians(slope)))
    return 2 / 3 * number * depth**1.5, 2 / 5 * number * depth**2.5


def viscosity(shear, pressure):
    """mu(I) p/|grad u|, all in units of grain diameter, g and the density of the grains."""
    shear = np.maximum(shear, FLAT)
    return (MU_S + (MU_2 - MU_S) / (1 + I_0 * np.sqrt(pressure) / shear)) * pressure / shear


def faces(u, h):
    """|grad u| on the faces across x [nx + 1][ny] and y [nx][ny + 1], with their normal derivatives. Ghosts: walls left, right and below, a free surface above."""
    side = np.vstack([-u[:1], u, -u[-1:]])
    wide = np.hstack([-side[:, :1], side, side[:, -1:]])
    dx, dy = np.diff(wide[:, 1:-1], axis=0) / h[0], np.diff(wide[1:-1], axis=1) / h[1]
    along_y, along_x = (wide[:, 2:] - wide[:, :-2]) / (2 * h[1]), (wide[2:] - wide[:-2]) / (2 * h[0])
    return np.hypot(dx, (along_y[1:] + along_y[:-1]) / 2), np.hypot(dy, (along_x[:, 1:] + along_x[:, :-1]) / 2)


def system(eta_x, eta_y, h):
    """The matrix of -div(eta grad u) on cells, walls at half a cell and no flux through the surface."""
    nx, ny = eta_x.shape[0] - 1, eta_x.shape[1]
    number = np.arange(nx * ny).reshape(nx, ny)
    west, east, south, north = eta_x[:-1] / h[0]**2, eta_x[1:] / h[0]**2, eta_y[:, :-1] / h[1]**2, eta_y[:, 1:] / h[1]**2
    centre = west + east + south + north
    centre[0] += west[0]
    centre[-1] += east[-1]
    centre[:, 0] += south[:, 0]
    centre[:, -1] -= north[:, -1]
    parts = [(number, number, centre), (number[1:], number[:-1], -west[1:]), (number[:-1], number[1:], -east[:-1]),
             (number[:, 1:], number[:, :-1], -south[:, 1:]), (number[:, :-1], number[:, 1:], -north[:, :-1])]
    rows, columns, values = (np.concatenate([part[k].ravel() for part in parts]) for k in range(3))
    return csr_matrix((values, (rows, columns)))


def channel(slope, depth, width, cells=40):
    """(V*, Q*) between rough side walls, on cells x cells."""
    bagnold(slope, depth)
    h, angle = (width / cells, depth / cells), np.radians(slope)
    below = lambda y: PACKING * np.cos(angle) * (depth - y)
    p_x, p_y = below((np.arange(cells) + 0.5) * h[1]), below(np.arange(cells + 1) * h[1])
    u, before = np.ones((cells, cells)) * (np.arange(cells) + 0.5) * h[1], 0.0
    while abs(u.max() - before) > 1e-6 * u.max():
        before = u.max()
        shear_x, shear_y = faces(u, h)
        matrix = system(viscosity(shear_x, p_x), viscosity(shear_y, p_y), h)
        u = spsolve(matrix, np.full(cells * cells, PACKING * np.sin(angle))).reshape(cells, cells)
    return u.max(), u.sum() * h[0] * h[1] / width


def main():
    parser = command.parser(__doc__)
    parser.add_argument("-slope", type=float, default=27, metavar="DEGREES")
    parser.add_argument("-depth", type=float, default=22.5)
    parser.add_argument("-width", type=float, default=48)
    parser.add_argument("-cells", type=int, default=40)
    o = parser.parse_args()
    for name, (velocity, flow) in (("between rough side walls", channel(o.slope, o.depth, o.width, o.cells)), ("without side walls", bagnold(o.slope, o.depth))):
        print(f"{name}: V* {velocity:.2f}, Q* {flow:.1f}")


if __name__ == "__main__":
    main()
