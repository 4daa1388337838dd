# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume fraction on the triangles; along the lowest row beside the lattice's fine runs."""
import os

import numpy as np

import haff
from haff.plot import cellmap, figures, script
from studies.checks.wedges import REFERENCES
from studies.exact.eos import of_case
from studies.measured import shocks

case = haff.Case(script.folder())
alpha = case.field("alpha")
fig, axes = figures.panels(1, 2, height=3.4)
tint = cellmap.draw(axes[0][0], case, alpha)
axes[0][0].set_title(rf"$t$ = {case.times[-1]} s, {case.mesh.cells} triangles", fontsize=9)
fig.colorbar(tint, ax=axes[0][0], label=figures.AXES["alpha"], shrink=0.8)
with np.load(os.path.join(REFERENCES, "wedge.npz")) as f:
    known = f["mean"].astype(float)
n = len(known)
gas, x = of_case(case), (np.arange(n) + 0.5) * 10 / n
flow = shocks.Samples(case, ("alpha",))
for height, colour in ((1.0, figures.COLOURS[0]), (4.0, figures.COLOURS[1])):
    row = known[int(height / 10 * n)]
    s = np.linspace(0.02, 4.98, 200)
    axes[0][1].plot(x, gas.nu(row), color="0.2", linewidth=0.7)
    axes[0][1].plot(s, flow(np.column_stack((s, height + 0 * s)))["alpha"], "o", markersize=2, markerfacecolor="none",
                    markeredgewidth=0.5, color=colour, label=f"$y$ = {height:g} cm")
figures.label(axes[0][1], "x", "alpha", "line: lattice of 800 x 800 cells")
axes[0][1].set_xlim(3, 5)
axes[0][1].legend(loc="upper left")
script.save(fig, "wedgeTriangles")
