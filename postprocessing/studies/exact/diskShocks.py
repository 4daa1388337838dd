# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact shocks of elastic disks, whose energy per mass is T and whose pressure is rho T A(alpha), with Torquato's contact value: mass, momentum and
energy across the shock. Packing stands for density. Written from the jump conditions, not from the solver.

    packing, T, speed = diskShocks.piston(0.1)       # ahead of a piston of speed 1 in cold disks, seen from the piston
    beta, packing = diskShocks.wedge(0.1, 0.003, 15) # weak shock over a wedge (degrees) in a stream of speed 1
"""
import numpy as np
from scipy.optimize import brentq

from studies.exact import disks


def piston(alpha):
    """Packing and T behind the shock, and its speed: all motion becomes heat."""
    gas, T = disks.Disks(1.0), 0.5
    packed = brentq(lambda b: b * T * gas.A(b) - alpha * (1 + alpha / (b - alpha)), 1.01 * alpha, 0.99 * gas.packed)
    return packed, T, alpha / (packed - alpha)


def wedge(alpha, T, deflection):
    """Angle of the weak shock from the stream (degrees), and packing behind it."""
    gas, turn = disks.Disks(1.0), np.radians(deflection)

    def jump(beta):
        """Packing behind, and what momentum and energy across the shock leave of the pressure there."""
        normal = np.sin(beta)
        slow = normal * np.tan(beta - turn) / np.tan(beta)
        packed, p = alpha * normal / slow, alpha * T * gas.A(alpha)
        pressure = p + alpha * normal * (normal - slow)
        hot = T + p / alpha + normal**2 / 2 - slow**2 / 2 - pressure / packed
        return packed, pressure - packed * hot * gas.A(packed)

    beta = brentq(lambda angle: jump(angle)[1], 1.2 * turn, turn + np.radians(25))
    return float(np.degrees(beta)), float(jump(beta)[0])
