# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing in the two compartments at the end, and the share of the left one over time, beside the run that is shaken more."""
import os
import sys

import haff
from haff.plot import figures, script
from studies.checks import vibrated

runs = {"acceleration 10 g": script.folder(), "20 g": script.folder("strong")}
fig = figures.plt.figure(figsize=(8, 3), layout="constrained")
axes = fig.subplots(1, 3, width_ratios=(1.2, 1.2, 1.2))
for k, (name, path) in enumerate((n, p) for n, p in runs.items() if os.path.isdir(os.path.join(p, "constant", "polyMesh"))):
    case = haff.Case(path)
    plane = case.slice("alpha", "z")
    shown = axes[k].pcolormesh(plane.u, plane.v, plane["alpha"], cmap="magma_r", vmin=0, vmax=0.7)
    axes[k].set(aspect="equal", facecolor="0.5")
    figures.label(axes[k], r"$x/\sigma$", r"$y/\sigma$" if k == 0 else "", name)
    t, share = vibrated.shares(case)
    axes[2].plot(t, share, color=figures.COLOURS[k], label=name)
    print(f"{name}: share {share[0]:.4f} at {t[0]:g}, {share[-1]:.4f} at {t[-1]:g}, rate {vibrated.share_rate(case):.2e}", file=sys.stderr)
fig.colorbar(shown, ax=list(axes[:2]), label=r"$\alpha$", location="bottom", shrink=0.6, pad=0.02)
axes[2].axhline(0.5, color="0.7", linewidth=0.8)
figures.label(axes[2], r"$t$ ($\sqrt{\sigma/g}$)", "share in the left compartment")
axes[2].set_ylim(0.49, 0.62)
axes[2].legend(loc="center left", bbox_to_anchor=(0, 0.55))
script.save(fig, "demon")
