# SPDX-License-Identifier: GPL-3.0-or-later
"""Grains that enter a tube at x = 0 with a speed that is modulated in time, as electrons leave the gap of a klystron, and fly on freely: the
exact solution of cold gas (no pressure) as long as none overtakes another.

    alpha = bunches.packing(x, t)         with the numbers of cases/pulsedInlet
    bunches.FOCUS                         where the first grains overtake others
"""
import numpy as np

SPEED, SWING, OMEGA, FLUX = 10.0, 2.0, 2 * np.pi, 0.2  # u = SPEED + SWING sin(OMEGA t), alpha u = FLUX at x = 0, t > 0


def speed(s):
    return np.where(s > 0, SPEED + SWING * np.sin(OMEGA * s), SPEED)


def change(s):
    """du/ds"""
    return np.where(s > 0, SWING * OMEGA * np.cos(OMEGA * s), 0.0)


def focus():
    """Grains that enter at s and s + ds meet where x = u (t - s) does not change with s: u' x = u^2."""
    s = np.linspace(0.01, 1, 100000)
    return float((speed(s)**2 / change(s))[change(s) > 0].min())


FOCUS = focus()


def packing(x, t):
    """alpha at places x < FOCUS: the grains between entries s and s + ds, FLUX ds, lie between x and x + dx."""
    s = np.linspace(t - 1.2 * FOCUS / (SPEED - SWING), t, 200001)
    place = speed(s) * (t - s)
    return np.interp(x, place[::-1], (FLUX / np.abs(change(s) * (t - s) - speed(s)))[::-1])


def error(case, time):
    """Mean error of alpha before 0.8 of the focus, over the packing of the stream."""
    x, alpha = case.line(("alpha",), time)
    near = x < 0.8 * FOCUS
    return float(np.abs(alpha[near] - packing(x[near], float(time))).mean() * SPEED / FLUX)
