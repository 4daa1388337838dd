# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact shocks of elastic disks, whose energy per mass is T and whose pressure is rho T A(alpha), with Torquato's contact value: mass, momentum and
energy across the shock. Packing stands for density. Written from the jump conditions, not from the solver.

    packing, T, speed = diskShocks.piston(0.1)       # ahead of a piston of speed 1 in cold disks, seen from the piston
    packing, T = diskShocks.normal(0.1, 0.003)       # behind a normal shock in a stream of speed 1
    beta, packing = diskShocks.wedge(0.1, 0.003, 15) # weak shock over a wedge (degrees) in such a stream
"""
import numpy as np
from scipy.optimize import brentq

from studies.exact import disks


def piston(alpha):
    """Packing and T behind the shock, and its speed: all motion becomes heat."""
    gas, T = disks.Disks(1.0), 0.5
    packed = brentq(lambda b: b * T * gas.A(b) - alpha * (1 + alpha / (b - alpha)), 1.01 * alpha, 0.99 * gas.packed)
    return packed, T, alpha / (packed - alpha)


def jump(alpha, T, fast, slow):
    """Packing and T behind a shock across which the normal speed falls from `fast` to `slow`, and what momentum leaves of the pressure there."""
    gas = disks.Disks(1.0)
    packed, p = alpha * fast / slow, alpha * T * gas.A(alpha)
    pressure = p + alpha * fast * (fast - slow)
    hot = T + p / alpha + fast**2 / 2 - slow**2 / 2 - pressure / packed
    return packed, hot, pressure - packed * hot * gas.A(packed)


def normal(alpha, T):
    """Packing and T behind a normal shock."""
    slow = brentq(lambda u: jump(alpha, T, 1, u)[2], 1.02 * alpha / disks.Disks.packed, 0.8)
    return tuple(map(float, jump(alpha, T, 1, slow)[:2]))


def wedge(alpha, T, deflection):
    """Angle of the weak shock from the stream (degrees), and packing behind it."""
    turn = np.radians(deflection)

    def behind(beta):
        fast = np.sin(beta)
        return jump(alpha, T, fast, fast * np.tan(beta - turn) / np.tan(beta))
    beta = brentq(lambda angle: behind(angle)[2], 1.2 * turn, turn + np.radians(25))
    return float(np.degrees(beta)), float(behind(beta)[0])
