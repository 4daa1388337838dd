"""Density, momentum, energy (Fig. 3 of Shakeri et al.) and temperature (Fig. 4) over the height at 50, 100 and 150 ms."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import numpy as np  # noqa: E402

import faraday  # noqa: E402
import figures  # noqa: E402

DENSITY = 2600.0  # of the material
layer = faraday.Layer(figures.folder())
times = [t for t in (0.05, 0.1, 0.15) if t <= float(layer.case.times[-1]) + 1e-9]
fig, axes = figures.panels(4, 3, height=1.7)
for column, t in zip(axes.T, times):
    p = layer.profile(layer.case.time(t))
    rho = DENSITY * p["alpha"]
    rows = ((r"$\rho$ (kg/m$^3$)", rho), (r"$\rho u_y$ (kg/m$^2$s)", rho * p["U"]),
            (r"$\rho(u^2 + 3T)/2$ (J/m$^3$)", rho * (p["U"]**2 + 3 * p["T"]) / 2), (r"$T$ (m$^2$/s$^2$)", p["T"]))
    for ax, (name, values) in zip(column, rows):
        ax.plot(1e3 * p["y"], np.where(p["alpha"] > 0, values, np.nan))
        figures.label(ax, "", name if t == times[0] else "")
    column[0].set_title(f"$t$ = {1e3 * t:g} ms", fontsize=9)
    figures.label(column[-1], "$y$ (mm)", "$T$ (m$^2$/s$^2$)" if t == times[0] else "")
    dense = p["alpha"] > 0.5
    print(f"t = {1e3 * t:g} ms: greatest alpha {p['alpha'].max():.4f}, at the floor {p['alpha'][0]:.4f}, above 0.5 up to "
          f"{1e3 * p['y'][dense].max() if dense.any() else 0:.1f} mm, centre of mass {1e3 * p['alpha'] @ p['y'] / p['alpha'].sum():.3f} mm, "
          f"least momentum {(rho * p['U']).min():.1f} at {1e3 * p['y'][np.argmin(rho * p['U'])]:.1f} mm, T at the floor {p['T'][0]:.3g}",
          file=sys.stderr)
figures.save(fig, os.path.join(figures.folder(), "sedimentationMD.png"))
