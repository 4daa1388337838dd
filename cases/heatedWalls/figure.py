# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature and packing between the walls, beside the solution of the steady equations."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.exact import disks

folder = script.folder()
variants = [(title, os.path.join(folder, sub)) for title, sub in (("$e$ = 1", "elastic"), ("$e$ = 0.95", ""),
                                                                ("$e$ = 0.95, $e_w$ = 0.8", "dissipative"))]
variants = [(title, path) for title, path in variants if os.path.isdir(path)]
fig, (panels,) = figures.panels(1, 2)
fine = np.linspace(0, 20, 400)
for (title, path), colour in zip(variants, figures.COLOURS):
    case, flow = haff.Case(path), disks.heated_walls(path)
    x, T, alpha = case.line(("T", "alpha"), case.times[-1])
    for panel, name, values in zip(panels, ("T", "alpha"), (T, alpha)):
        panel.plot(fine, flow(fine, name), color=colour, label=title)
        panel.plot(x[2::5], values[2::5], "o", markersize=3, color=colour, fillstyle="none")
        print(f"{title}, {name}: mean error {disks.error(case, flow, name):.1e} of the largest", file=sys.stderr)
panels[0].legend()
figures.label(panels[0], r"$x/\sigma$", "$T$", "steady equations (lines), granularGas")
figures.label(panels[1], r"$x/\sigma$", r"$\alpha$")
script.save(fig, "heatedWalls")
