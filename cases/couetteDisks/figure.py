"""Velocity, temperature and packing between the walls, beside the solution of the steady equations."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import numpy as np  # noqa: E402

import disks  # noqa: E402
import figures  # noqa: E402
import haff  # noqa: E402

folder = figures.folder()
variants = [(title, os.path.join(folder, sub)) for title, sub in (("$e$ = 1, $U$ = 2", "elastic"), ("$e$ = 0.9, $U$ = 2", ""), ("$e$ = 0.9, $U$ = 4", "fast"))]
variants = [(title, path) for title, path in variants if os.path.isdir(path)]
fig, (panels,) = figures.panels(1, 3, width=9.0)
fine = np.linspace(0, 20, 400)
for (title, path), colour in zip(variants, figures.COLOURS):
    case, flow = haff.Case(path), disks.couette(path)
    x, y = case.centres[:, :2].T
    column = np.flatnonzero(x < x.min() + 1e-6)
    for panel, (field, name) in zip(panels, (("U", "u"), ("T", "T"), ("alpha", "alpha"))):
        values = case.field(field, case.times[-1])
        values = values[:, 0] if field == "U" else values
        panel.plot(fine, flow(fine, name), color=colour, label=title)
        panel.plot(y[column], values[column], "o", markersize=3, color=colour, fillstyle="none")
        error = disks.error(case, flow, field, 0 if field == "U" else None, 1)
        print(f"{title}, {field}: mean error {error:.1e} of the largest", file=sys.stderr)
panels[0].legend(loc="upper left", fontsize=8)
for panel, name in zip(panels, ("$u$", "$T$", r"$\alpha$")):
    figures.label(panel, r"$y/\sigma$", name)
panels[0].set_title("steady equations (lines), granularGas", fontsize=9)
figures.save(fig, os.path.join(folder, "couetteDisks.png"))
