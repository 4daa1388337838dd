# SPDX-License-Identifier: GPL-3.0-or-later
"""The figure of flow along a channel of disks (cases couetteDisks, poiseuilleDisks)."""
import os
import sys

import numpy as np

import haff
from haff.plot import figures, script
from studies.exact import disks


def channel(picture, variants, flow_of, **legend):
    """Velocity, temperature and packing across, beside the steady flow_of(case folder). variants: title, folder below the
    case's; those that were not run are left out."""
    folder = script.folder()
    variants = [(title, os.path.join(folder, sub)) for title, sub in variants if os.path.isdir(os.path.join(folder, sub))]
    fig, (panels,) = figures.panels(1, 3, width=9.0)
    fine = np.linspace(0, 20, 400)
    for (title, path), colour in zip(variants, figures.COLOURS):
        case, flow = haff.Case(path), flow_of(path)
        x, y = case.centres[:, :2].T
        column = np.flatnonzero(x < x.min() + 1e-6)
        for panel, (field, name) in zip(panels, (("U", "u"), ("T", "T"), ("alpha", "alpha"))):
            values = case.field(field, case.times[-1])
            values = values[:, 0] if field == "U" else values
            panel.plot(fine, flow(fine, name), color=colour, label=title)
            panel.plot(y[column], values[column], "o", markersize=3, color=colour, fillstyle="none")
            error = disks.error(case, flow, field, 0 if field == "U" else None, 1)
            print(f"{title}, {field}: mean error {error:.1e} of the largest", file=sys.stderr)
    panels[0].legend(**legend)
    for panel, name in zip(panels, ("$u$", "$T$", r"$\alpha$")):
        figures.label(panel, r"$y/\sigma$", name)
    panels[0].set_title("steady equations (lines), granularGas", fontsize=9)
    script.save(fig, picture)
