# SPDX-License-Identifier: GPL-3.0-or-later
"""Velocity, temperature and packing over the radius of the pipe, beside the solution of the steady equations."""
import numpy as np

import haff
from haff.plot import figures, script
from studies.exact import garzoDufty

folder = script.folder()
case, flow = haff.Case(folder), garzoDufty.pipe(folder)
fig, (panels,) = figures.panels(1, 3, width=9.0)
fine = np.linspace(1e-5, 10, 400)
x, r = case.centres[:, :2].T
column = np.flatnonzero(x < x.min() + 1e-6)
for panel, (field, name, label) in zip(panels, (("U", "u", "$u$"), ("T", "T", "$T$"), ("alpha", "alpha", r"$\alpha$"))):
    values = case.field(field, case.times[-1])
    values = values[:, 0] if field == "U" else values
    panel.plot(fine, flow(fine, name), color=figures.COLOURS[0], label="steady equations")
    panel.plot(r[column], values[column], "o", markersize=3, color=figures.COLOURS[1], fillstyle="none", label="granularGas")
    figures.label(panel, r"$r/\sigma$", label)
panels[0].legend(loc="lower left")
script.save(fig, "pipe")
