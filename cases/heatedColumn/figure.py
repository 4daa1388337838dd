# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature and packing over the height: the gas, the solution of the steady equations, the gas with Fourier's law alone, and grains."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.checks import vibrated

runs = {"gas": "", "gas, $\\mu$ = 0": "fourier", "grains": "grains"}
found = {name: haff.Case(script.folder(sub)) for name, sub in runs.items() if os.path.isdir(script.folder(sub, "constant", "polyMesh"))}
exact = vibrated.column(found["gas"])
fig, (panels,) = figures.panels(1, 2)
y = np.linspace(0, 600, 400)
for panel, field in zip(panels, ("T", "alpha")):
    panel.plot(y, exact(y, field), color="0.6", linewidth=2.5, label="steady equations")
    for (name, case), colour in zip(found.items(), figures.COLOURS):
        p = vibrated.steady(case)
        enough = p["alpha"] > 1e-4
        panel.plot(p["y"][enough], p[field][enough], "." if name == "grains" else "-", markersize=4, color=colour, label=name)
    figures.label(panel, r"$y/\sigma$", {"T": r"$T/(g\sigma)$", "alpha": r"$\alpha$"}[field])
panels[0].set_ylim(60, 180)
panels[1].set_yscale("log")
panels[1].legend()
for name, case in found.items():
    print(f"{name}: T " + ", ".join(f"{vibrated.temperature(case, 'T', None, h):.1f} at {h:g}" for h in (10, 50, 100, 200, 300, 400)), file=sys.stderr)
script.save(fig, "heatedColumn")
