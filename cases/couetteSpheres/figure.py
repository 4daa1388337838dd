# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, temperature and velocity between the walls with and without correlations, beside the steady equations and the grains."""
import os

import numpy as np

import haff
from haff.plot import figures, script
from studies.exact import extended

folder = script.folder()
fig, (panels,) = figures.panels(1, 3, width=9.0)
fine = np.linspace(0, 18, 400)
for (title, sub), colour in zip((("correlated", ""), ("uncorrelated", "uncorrelated")), figures.COLOURS):
    path = os.path.join(folder, sub)
    if not os.path.isdir(path):
        continue
    case, flow = haff.Case(path), extended.couette(path)
    x, y = case.centres[:, :2].T
    column = np.flatnonzero(x < x.min() + 1e-6)
    for panel, (field, name) in zip(panels, (("alpha", "alpha"), ("T", "T"), ("U", "u"))):
        values = case.field(field, case.times[-1])
        values = values[:, 0] if field == "U" else values
        panel.plot(fine, flow(fine, name), color=colour, label=title)
        panel.plot(y[column], values[column], "o", markersize=3, color=colour, fillstyle="none")
for panel, field in zip(panels, ("alpha", "T", "U")):
    y, values = extended.grains(field)
    panel.plot(18 * y, values, "k+", label="grains")
panels[1].set_yscale("log")
panels[0].legend(loc="lower center")
for panel, name in zip(panels, (r"$\alpha$", "$T$", "$u$")):
    figures.label(panel, r"$y/\sigma$", name)
panels[0].set_title("steady equations (lines), granularGas", fontsize=9)
script.save(fig, "couetteSpheres")
