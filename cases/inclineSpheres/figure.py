# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, inertial number and velocity over the height of a layer that flows down a slope, beside the local balance."""
import numpy as np

import haff
from haff.plot import figures, script
from studies.checks import inclines

folder = script.folder()
case, flow = haff.Case(folder), inclines.local(folder)
y, alpha, u, inertial = inclines.column(case, case.times[-1])
height = inclines.DEPTH
fig, panels_ = figures.panels(1, 3, width=9.0)
panels = panels_[0]
fine = np.linspace(0, height, 200)
lines = (np.full_like(fine, flow.packing), np.full_like(fine, flow.inertial), flow.surface * (height**1.5 - (height - fine)**1.5))
for panel, values, line, name in zip(panels, (alpha, inertial, u), lines, (r"$\alpha$", "$I$", "$u$")):
    shown = alpha > 0.05
    panel.plot(line, fine, color=figures.COLOURS[1], label="local balance")
    panel.plot(values[shown], y[shown], "o", markersize=3, color=figures.COLOURS[0], fillstyle="none", label="granularGas")
    figures.label(panel, name, r"$y/\sigma$")
panels[1].set_xlim(0, 2 * flow.inertial)
panels[0].legend(loc="center left")
script.save(fig, "inclineSpheres")
