# SPDX-License-Identifier: GPL-3.0-or-later
"""The travelling front beside the exact one (Christov, Fig. 1), and the errors on five grids (Fig. 2)."""
import os
import sys

import numpy as np

from haff.plot import figures, script
from studies.exact import segregation
from studies.measured import mixture

case = script.folder()
fig, axes = figures.panels(1, 2, width=7.0, height=2.8)
fine = np.linspace(-0.5, 0.5, 1001)
for t in (0, 1, 2):
    axes[0][0].plot(fine, segregation.kink(fine, t), color="0.3", linewidth=0.7)
    if t == 0:
        continue  # given, not computed
    y, phi = mixture.profile(case, t)
    axes[0][0].plot(y[::10], phi[::10], ".", markersize=3, label=f"$t$ = {t} s")
axes[0][0].legend()
figures.label(axes[0][0], "$y$ (m)", r"$\phi$")
table = np.array([list(mixture.front_errors(os.path.join(case, f"M{M}"), 2.0).values()) for M in (51, 101, 201, 401, 801)])
for k, name in enumerate(("max", "$L_2$", "$H_1$"), 1):
    axes[0][1].loglog(table[:, 0], table[:, k], "o-", markersize=3, label=name)
axes[0][1].loglog(table[:, 0], 2 * table[:, 0] ** 2, color="0.6", linewidth=0.7, label="second order")
axes[0][1].legend()
figures.label(axes[0][1], r"$\Delta y = \Delta t$", "error at 2 s")
print("dy, errors in max, L2, H1:", file=sys.stderr)
for k, row in enumerate(table):
    orders = "" if k == 0 else "  orders" + "".join(f" {v:.2f}" for v in np.log2(table[k - 1, 1:] / row[1:]))
    print("  ", " ".join(f"{v:.4e}" for v in row) + orders, file=sys.stderr)
script.save(fig, "kink")
