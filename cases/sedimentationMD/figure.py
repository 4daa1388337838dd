# SPDX-License-Identifier: GPL-3.0-or-later
"""Packing, velocity, temperature and its anisotropy over the height at 50, 100 and 150 ms: this run beside the whole box
(profiles.csv); prints what is exact of it, free fall and Haff's law. Beside the gas: ../sedimentation."""
import sys

import numpy as np

from haff.layers import columns
from haff.plot import script
from haff.start import enskog

T0, G = 9.81e-3, 9.81  # at the start; gravity
FREE = {0.05: (0.02, 0.07), 0.1: (0.018, 0.035)}  # m: where neither floor nor the edge above has been felt
folder = script.folder()
whole = columns.read(script.here("profiles.csv"))
runs = columns.at(folder, list(whole))
rows = ((r"$\alpha$", lambda p: p["alpha"]), ("$u_y$ (m/s)", lambda p: columns.seen(p, p["U"])),
        ("$T$ (m$^2$/s$^2$)", lambda p: columns.seen(p, p["T"])), ("$T_y/T_{xz}$", lambda p: columns.seen(p, columns.ratio(p))))
for t, p in runs.items():
    dense, ratio = p["alpha"] > 0.5, columns.seen(p, columns.ratio(p))
    print(f"t = {1e3 * t:g} ms: centre of mass {1e3 * columns.centre(p):.3f} mm, alpha at the floor {p['alpha'][0]:.4f}, greatest "
          f"{p['alpha'].max():.4f}, above 0.5 up to {1e3 * p['y'][dense].max() if dense.any() else 0:.1f} mm, T at the floor "
          f"{p['T'][0]:.3g}, greatest {p['T'].max():.3g} at {1e3 * p['y'][np.argmax(p['T'])]:.1f} mm, Ty/Txz greatest "
          f"{np.nanmax(ratio):.2f} at {1e3 * p['y'][np.nanargmax(ratio)]:.1f} mm; L1 differences to the whole box: "
          + ", ".join(f"{name} {columns.difference(p, whole[t], name):.3f}" for name in ("alpha", "U", "T")), file=sys.stderr)
    if t in FREE:
        free = (p["y"] > FREE[t][0]) & (p["y"] < FREE[t][1])
        mean = {k: np.average(p[k][free], weights=p["alpha"][free]) for k in ("U", "T")}
        print(f"    T of the gas between {1e3 * FREE[t][0]:g} and {1e3 * FREE[t][1]:g} mm "
              f"{mean['T'] / enskog.cooled(T0, t, 0.1, 0.9, 3, 1e-3):.4f} of Haff's law, velocity {mean['U'] / (-G * t):.4f} of free "
              "fall", file=sys.stderr)
columns.draw(script.target("sedimentationMD"),
             [(f"$t$ = {1e3 * t:g} ms", {"whole box": whole[t], "this run": runs[t]}) for t in whole], rows, 0.1)
