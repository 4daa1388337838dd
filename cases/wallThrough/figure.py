# SPDX-License-Identifier: GPL-3.0-or-later
"""The packed bed that grows on the wall, and what it costs: profiles, packing, steps per second."""
import numpy as np

import haff
from haff.plot import figures, script
from studies.exact.eos import of_case

case = haff.Case(script.folder())
gas = of_case(case)
fig, axes = figures.panels(2, 2)
for time in (case.time(t) for t in (0.2, 0.5, 1, 1.5, 2, 2.3)):
    x, alpha, T = case.line(("alpha", "T"), time)
    axes[0][0].plot(x, alpha, label=rf"$t$ = {time} s")
    axes[0][1].semilogy(x, T)
axes[0][0].legend(fontsize=6.5)
figures.label(axes[0][0], "x", "alpha")
figures.label(axes[0][1], "x", "T")

rows = case.table("extremes", "fieldMinMax.dat")[::2]  # alpha, T in turn: every 100 steps
seconds = rows[:, 0]
middle = 0.5 * (seconds[1:] + seconds[:-1])
axes[1][0].semilogy(middle, 100 / np.diff(seconds), label="steps taken")
flow, times = [], [t for t in case.times if float(t) > 0]
for time in times:
    x, alpha, rho, T, u = case.line(("alpha", "rho", "T", "U"), time)
    away = alpha < 0.5
    speed = np.abs(u[away]) + gas.c(rho[away], T[away])
    flow.append(speed.max() / (0.5 * (x[1] - x[0])))
axes[1][0].semilogy([float(t) for t in times], flow, linestyle="--", label="what the gas outside asks for")
axes[1][0].legend(fontsize=6.5)
figures.label(axes[1][0], "time (s)", "steps per second")

gap = [0.65 - case.field("alpha", t).max() for t in times]
axes[1][1].semilogy([float(t) for t in times], gap)
figures.label(axes[1][1], "time (s)", r"$0.65 - \alpha_\mathrm{max}$")
script.save(fig, "wallThrough")
