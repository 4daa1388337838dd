# SPDX-License-Identifier: GPL-3.0-or-later
"""Steady supersonic flow of a perfect gas along a cone: the equation of Taylor & Maccoll (1933), conical flow behind an oblique shock.

    flow = Cone(rho=1.0, p=375.0, mach=2.0, half=np.radians(20), gamma=5/3)
    flow.angle                         # of the shock, from the stream (weak branch)
    flow.sample(theta)                 # rho, p, u along the ray, u across it (towards the axis < 0), at polar angles from the axis
    flow.shock                         # as studies.measured.shocks wants it: rho, angle(half), behind(angle)

Velocities are over the largest speed of the stream. RK4 from the shock inwards, on equal steps of theta; the cone is where u_theta = 0.
"""
from types import SimpleNamespace

import numpy as np

from studies.exact.eos import PerfectGas
from studies.exact.obliqueShock import ObliqueShock

STEPS = 500


class Cone:
    def __init__(self, rho, p, mach, half, gamma):
        self.stream = ObliqueShock(PerfectGas(gamma), rho, p, mach)
        self.rho, self.p, self.gamma, self.half = rho, p, gamma, half
        self.most = np.sqrt(self.stream.speed**2 + 2 * gamma / (gamma - 1) * p / rho)
        low, high = self.stream.mach_angle * (1 + 1e-9), np.radians(60)
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (middle, high) if self._march(middle)[0][-1] < half else (low, middle)
        self.angle = (low + high) / 2
        self.shock = SimpleNamespace(rho=rho, angle=lambda _: self.angle, behind=self.stream.behind)
        self.theta, self.along, self.across = (values[::-1] for values in self._march(self.angle))

    def _rate(self, theta, u, v):
        sound = (self.gamma - 1) / 2 * (1 - u * u - v * v)
        return v, (v * v * u - sound * (2 * u + v / np.tan(theta))) / (sound - v * v)

    def _march(self, beta):
        """theta, u, v from the shock to the angle where v = 0."""
        behind = self.stream.behind(beta)
        theta, u, v = beta, float(behind.tangential) / self.most, -float(behind.normal) / self.most
        rows, h = [(theta, u, v)], -beta / STEPS
        while v < 0 and theta + h > 0:
            start = (u, v)
            k = [self._rate(theta, u, v)]
            for part in (0.5, 0.5, 1.0):
                k.append(self._rate(theta + part * h, start[0] + part * h * k[-1][0], start[1] + part * h * k[-1][1]))
            u, v = (start[i] + h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]) for i in (0, 1))
            theta += h
            rows.append((theta, u, v))
        if v > 0:  # back to v = 0 on the last step
            (t0, u0, v0), (t1, u1, v1) = rows[-2:]
            s = v0 / (v0 - v1)
            rows[-1] = (t0 + s * (t1 - t0), u0 + s * (u1 - u0), 0.0)
        return np.array(rows).T

    def sample(self, theta):
        """rho, p, u_r, u_theta in the units of the stream."""
        theta = np.asarray(theta, float)
        u, v = (np.interp(theta, self.theta, values) for values in (self.along, self.across))
        behind = self.stream.behind(self.angle)
        first = 1 - self.along[-1] ** 2 - self.across[-1] ** 2
        ratio = (1 - u * u - v * v) / first
        rho, p = behind.rho * ratio ** (1 / (self.gamma - 1)), behind.p * ratio ** (self.gamma / (self.gamma - 1))
        outside, speed = theta > self.angle, self.stream.speed
        return SimpleNamespace(rho=np.where(outside, self.rho, rho), p=np.where(outside, self.p, p),
                               along=np.where(outside, speed * np.cos(theta), u * self.most),
                               across=np.where(outside, -speed * np.sin(theta), v * self.most))
