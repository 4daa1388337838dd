# SPDX-License-Identifier: GPL-3.0-or-later
"""Where shocks stand on meshes without order, and the state behind them: the measurements of wedge15, cylinder, sphere3D.

    case = haff.Case("cases/wedge15")
    shock = upstream(case, eos.of_case(case))            # the stream as an ObliqueShock
    fit = straight_shock(case, shock, np.radians(15))    # angle, offset, scatter from a line fitted to points of the shock
    jump = behind_wedge(case, shock, np.radians(15))     # means behind it, and how far from the exact ones
    wedge_error(case, shock, np.radians(15))             # of the density, against the exact flow
    stand_off(case, shock)                               # ahead of a blunt body about the origin, on the axis y = z = 0

The shock is where the density passes the mean of the exact values ahead of and behind it. A stream comes along +x.
"""
from types import SimpleNamespace

import numpy as np

from haff.plot import cellmap
from studies.exact.obliqueShock import ObliqueShock


WEDGE = np.radians(15)  # of the cases wedge15, wedge15Dilute


class Samples:
    """Fields at arbitrary points: the linear function fitted to the nearest cells (nearer ones weigh more).

    mirror: axes (0 x, 1 y, 2 z) across whose plane through the origin the gas is continued by its mirror image."""
    def __init__(self, case, fields, time=None, mirror=()):
        self.dim = dimensions(case)
        self.centre = case.centres[:, :self.dim]
        self.value = {name: case.field(name, time) for name in fields}
        reach = 3 * spacing(case)
        for axis in mirror:
            near = np.abs(self.centre[:, axis]) < reach
            image = self.centre[near] * np.where(np.arange(self.dim) == axis, -1, 1)
            self.centre = np.concatenate((self.centre, image))
            self.value = {k: np.concatenate((v, v[near])) for k, v in self.value.items()}

    def __call__(self, points):
        points, n = np.atleast_2d(points), 4 * self.dim - 1
        out = {name: np.empty(len(points)) for name in self.value}
        for i, point in enumerate(points):
            away = self.centre - point
            d2 = np.einsum("ij,ij->i", away, away)
            nearest = np.argpartition(d2, n)[:n]
            weight = 1 / np.sqrt(d2[nearest] + d2[nearest].max() / n)
            basis = np.column_stack((np.ones(n), away[nearest]))
            row = np.linalg.pinv(basis * weight[:, None])[0] * weight
            for name, value in self.value.items():
                out[name][i] = row @ value[nearest]
        return out


def dimensions(case):
    return 2 if any(kind == "empty" for kind, _, _ in case.mesh.patches.values()) else 3


def spacing(case):
    """Side of the equilateral triangle or the regular tetrahedron of median size."""
    if dimensions(case) == 3:
        return (6 * np.sqrt(2) * np.median(case.volumes)) ** (1 / 3)
    return np.sqrt(4 / np.sqrt(3) * np.median(case.volumes) / np.ptp(case.mesh.points[:, 2]))


def upstream(case, eos, time=None):
    """The stream in a cell ahead of the body and to its side, as far as the domain goes."""
    cell = np.argmax(case.centres[:, 1] - 2 * case.centres[:, 0])
    rho, p = case.field("rho", time)[cell], case.field("p", time)[cell]
    speed = np.linalg.norm(case.field("U", time)[cell])
    return ObliqueShock(eos, rho, p, speed / eos.c(rho, eos.T(rho, p)))


def crossing(flow, start, end, step, level):
    """The point nearest to start on the way to end where rho passes the level; ValueError where it does not."""
    start, end = np.array(start, float), np.array(end, float)
    length = np.linalg.norm(end - start)
    s = np.linspace(0, 1, int(np.ceil(length / step)) + 1)
    rho = flow(start + s[:, None] * (end - start))["rho"]
    above = np.flatnonzero(rho > level)
    if not len(above) or above[0] == 0:
        raise ValueError(f"the density does not rise through {level:g} between {start} and {end}")
    i = above[0]
    part = (level - rho[i - 1]) / (rho[i] - rho[i - 1])
    return start + (s[i - 1] + part * (s[i] - s[i - 1])) * (end - start)


def straight_shock(case, shock, theta, time=None, window=(2.0, 8.0), points=25):
    """Line through the shock of a wedge whose tip is the origin, by least squares over points at equal x in the window:
    angle in radians, offset of the line at x = 0 and rms distance of the points from it in sides of a cell."""
    h = spacing(case)
    beta = shock.angle(theta)
    level = (shock.rho + shock.behind(beta).rho) / 2
    flow = Samples(case, ("rho",), time)
    top = case.centres[:, 1].max()
    at = [crossing(flow, (x, min(x * np.tan(beta) + 12 * h, top)), (x, x * np.tan(theta)), h / 4, level)
          for x in np.linspace(*window, points)]
    x, y = np.array(at).T
    slope, offset = np.polyfit(x, y, 1)
    angle = np.arctan(slope)
    return SimpleNamespace(angle=angle, offset=offset * np.cos(angle) / h,
                           scatter=np.std(y - offset - slope * x) * np.cos(angle) / h)


def behind_wedge(case, shock, theta, time=None, window=(2.0, 8.0), margin=np.radians(5)):
    """Means over the cells behind the shock, `margin` off it and off the wedge: rho, p, mach over their exact values, less 1."""
    beta = shock.angle(theta)
    exact = shock.behind(beta)
    x, y = case.centres[:, :2].T
    angle = np.arctan2(y, x)
    here = (x > window[0]) & (x < window[1]) & (angle > theta + margin) & (angle < beta - margin)
    weight = case.volumes[here] / case.volumes[here].sum()
    rho, p = case.field("rho", time)[here], case.field("p", time)[here]
    mach = np.linalg.norm(case.field("U", time)[here], axis=1) / shock.eos.c(rho, shock.eos.T(rho, p))
    return SimpleNamespace(rho=weight @ rho / exact.rho - 1, p=weight @ p / exact.p - 1, mach=weight @ mach / exact.mach - 1)


def wedge_error(case, shock, theta, time=None, window=(2.0, 8.0)):
    """Mean |rho - exact| over the cells of the window above the wedge, over the jump of rho; exact: averages over
    the triangles."""
    beta = shock.angle(theta)
    behind = float(shock.behind(beta).rho)
    x = case.centres[:, 0]
    here = (x > window[0]) & (x < window[1])
    at = cellmap.spread(case.mesh)
    exact = shock.rho + (behind - shock.rho) * (np.arctan2(at[..., 1], at[..., 0]) < beta).mean(axis=1)
    weight = case.volumes[here] / case.volumes[here].sum()
    return float(weight @ np.abs(case.field("rho", time) - exact)[here] / (behind - shock.rho))


def body_radius(case):
    """Distance of the points of the patch `wall` from the origin."""
    mesh = case.mesh
    _, start, count = mesh.patches["wall"]
    points = mesh.face_points[mesh.face_start[start]:mesh.face_start[start + count]]
    return np.linalg.norm(mesh.points[points, :dimensions(case)], axis=1).max()


def stand_off(case, shock, time=None):
    """Distance from the shock to the nose of a round body about the origin over its radius, on the axis."""
    radius = body_radius(case)
    flow = Samples(case, ("rho",), time, mirror=range(1, dimensions(case)))
    level = (shock.rho + shock.behind(np.pi / 2).rho) / 2
    axis = np.eye(flow.dim)[0]
    first = case.mesh.points[:, 0].min()
    return -crossing(flow, first * axis, -radius * axis, spacing(case) / 8, level)[0] / radius - 1


def billig(mach, body):
    """Stand-off distance over the radius of a sphere or cylinder in air (perfect gas, 1.4): Billig (1967), a fit to experiments."""
    a, b = {"sphere": (0.143, 3.24), "cylinder": (0.386, 4.67)}[body]
    return a * np.exp(b / mach**2)
