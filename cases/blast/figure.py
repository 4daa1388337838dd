# SPDX-License-Identifier: GPL-3.0-or-later
"""The inelastic blasts: the lower row of Fig. 3 and Fig. 4 of Serna & Marquina."""
import os

import haff
from haff.plot import figures, script

variants = [(e, os.path.join(script.folder(), sub)) for e, sub in ((0.9, ""), (0.7, "e0.7"), (0.2, "e0.2"))]
variants = [(e, haff.Case(path)) for e, path in variants if os.path.isdir(path)]
fig, axes = figures.panels(len(variants), 2, height=2.3)
for row, (e, case) in zip(axes, variants):
    time = case.times[-1]
    x, alpha, T = case.line(("alpha", "T"), time)
    for panel, name, values in zip(row, ("alpha", "T"), (alpha, T)):
        panel.plot(x, values)
        figures.label(panel, "x", name)
        panel.set_xlim(4.5, 9)
    row[0].set_title(rf"$e$ = {e}, $t$ = {time} s, $\alpha_\mathrm{{max}}$ = {alpha.max():.4f}", fontsize=9)
script.save(fig, "blast")
