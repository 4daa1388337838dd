# SPDX-License-Identifier: GPL-3.0-or-later
"""Five cycles of the shaken layer: Figs 6 (volume fraction, temperature) and 7 (velocity) of Serna & Marquina."""
import haff
from haff.plot import figures, script

FREQUENCY = 200
case = haff.Case(script.folder())
last = float(case.times[-1])
cycles = [phase for phase in (0.35, 1.35, 2.35, 3.35, 4.35) if phase / FREQUENCY <= last]
fig, axes = figures.panels(len(cycles) + 1, 2, height=1.6)
for row, phase in zip(axes, cycles):
    x, alpha, T = case.line(("alpha", "T"), phase / FREQUENCY)
    near = x >= 0.08
    for panel, name, values in zip(row, ("alpha", "T"), (alpha, T)):
        panel.plot(x[near], values[near])
        figures.label(panel, "", name)
        panel.set_xlim(0.08, 0.15)
    row[0].set_ylabel(r"$\alpha$")
    row[1].set_ylabel(r"$T$ (cm$^2$ s$^{-2}$)")
    row[0].set_title(rf"$ft$ = {phase}, $\Sigma\alpha$ = {alpha.sum():.3f}", fontsize=8)
for panel, phase in zip(axes[-1], (3.15, 4.15)):
    if phase / FREQUENCY <= last:
        x, u = case.line(("U",), phase / FREQUENCY)
        panel.plot(x[x >= 0.08], u[x >= 0.08])
        panel.set_title(f"$ft$ = {phase}", fontsize=8)
    figures.label(panel, "x", "U")
    panel.set_xlim(0.08, 0.15)
script.save(fig, "vibratedLayer")
