# SPDX-License-Identifier: GPL-3.0-or-later
"""T of the gas beside Haff's law, its first waves beside linear theory, and the clusters at the end."""
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.exact import disks

NU, LENGTH, EARLY = 0.2, 240, "100"
FIRST = {"across": 0.003, "density": 0.01}  # amplitudes in 0/U and 0/alpha


def wave(values, at, n):
    """Amplitude of exp(i k x), k = 2 pi n/LENGTH."""
    return 2 * np.mean(values * np.exp(-2j * np.pi / LENGTH * (at @ np.asarray(n))))


def across(case, n, time):
    """Amplitude of the velocity across a wave, over sqrt T of Haff's law."""
    u = case.field("U", time)[:, :2] @ np.array([-n[1], n[0]]) / np.hypot(*n)
    return abs(wave(u, case.centres[:, :2], n)) / np.sqrt(gas.cooled(NU, 1, float(time)))


def density(case, n, time):
    return abs(wave(case.field("alpha", time) / NU - 1, case.centres[:, :2], n))


folder = script.folder()
case, gas = haff.Case(folder), disks.Disks.of(folder)
theory = disks.Cooling(gas, NU)
tau = theory.tau(float(EARLY))
fig, ((cooling, waves, clusters),) = figures.panels(1, 3, width=9.5, height=2.9)

times = case.times[1:]  # 0/ holds expressions
t = np.array([float(time) for time in times])
T = np.array([np.average(case.field("T", time), weights=case.field("rho", time)) for time in times])
cooling.plot(t, gas.cooled(NU, 1, t) ** -0.5, color="0.3", linewidth=0.7, label="Haff's law")
cooling.plot(t, T**-0.5, "o", markersize=2.5, label="granularGas")
cooling.legend()
figures.label(cooling, r"$t\,\sqrt{T_0}/\sigma$", r"$\sqrt{T_0/T}$", r"$\alpha$ = 0.2, $e$ = 0.9")

modes = [(a, b) for a in range(6) for b in range(-5, 6) if 0 < a * a + b * b <= 26 and (a > 0 or b > 0)]
k = np.linspace(0.01, 0.15, 200)
for measure, curve, name, symbol, colour in (
        (across, [np.exp(theory.across(x) * tau) for x in k], r"vortices, $u/\sqrt{T}$", "o", figures.COLOURS[0]),
        (density, [abs(theory.along(x, (1, 0, 0), float(EARLY))[0]) for x in k], "clusters, density", "s", figures.COLOURS[1])):
    first = FIRST[measure.__name__]
    there = [n for n in modes if measure(case, n, times[0]) > 0.2 * first]
    found = np.array([measure(case, n, EARLY) for n in there]) / first
    at = 2 * np.pi / LENGTH * np.hypot(*np.transpose(there))
    waves.plot(k, curve, color=colour, linewidth=0.7)
    waves.plot(at, found, symbol, markersize=3, color=colour, fillstyle="none", label=name)
    error = np.abs(found - np.interp(at, k, curve)).max()
    print(f"{name}: {len(there)} waves, the greatest {found.max():.3f}, none further than {error:.3f} from theory", file=sys.stderr)
for limit in theory.thresholds():
    waves.axvline(limit, color="0.7", linewidth=0.6, linestyle=":")
waves.legend()
figures.label(waves, r"$k\sigma$", f"amplitude at $t$ = {EARLY} / first", "linear theory (lines)")

x, y = case.centres[:, :2].T
order = np.lexsort((np.round(x, 6), np.round(y, 6)))
side = int(np.sqrt(len(order)))
picture = clusters.imshow(case.field("alpha", case.times[-1])[order].reshape(side, side), origin="lower", extent=(0, LENGTH, 0, LENGTH), cmap="magma_r")
fig.colorbar(picture, ax=clusters, label=r"$\alpha$")
figures.label(clusters, r"$x/\sigma$", r"$y/\sigma$", f"$t$ = {case.times[-1]}")
script.save(fig, "coolingDisks")
