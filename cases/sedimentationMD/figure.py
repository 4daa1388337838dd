"""Density, momentum, energy (Fig. 3 of Shakeri et al.) and temperature (Fig. 4) over the height at 50, 100 and 150 ms."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "postprocessing"))

import numpy as np  # noqa: E402

import enskog  # noqa: E402
import faraday  # noqa: E402
import figures  # noqa: E402

DENSITY, T0, G = 2600.0, 7.345612758e-3, 9.81  # of the material; at the start; gravity
FREE = {0.05: (0.02, 0.07), 0.1: (0.018, 0.035)}  # m: where neither floor nor the edge above has been felt
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
        ax.set_xlim(0, 100)
        figures.label(ax, "", name if t == times[0] else "")
    column[0].set_title(f"$t$ = {1e3 * t:g} ms", fontsize=9)
    figures.label(column[-1], "$y$ (mm)", rows[-1][0] if t == times[0] else "")
    dense = p["alpha"] > 0.5
    column[-1].axhline(enskog.cooled(T0, t, 0.1, 0.9, 3, 1e-3), color="0.5", linewidth=0.7, linestyle=":")
    if t in FREE:
        free = (p["y"] > FREE[t][0]) & (p["y"] < FREE[t][1])
        late = t - 0.5e-3  # fields are means over the last millisecond
        mean = {k: np.average(p[k][free], weights=p["alpha"][free]) for k in ("U", "T")}
        print(f"t = {1e3 * t:g} ms: T of the gas between {1e3 * FREE[t][0]:g} and {1e3 * FREE[t][1]:g} mm "
              f"{mean['T'] / enskog.cooled(T0, late, 0.1, 0.9, 3, 1e-3):.4f} of Haff's law, velocity "
              f"{mean['U'] / (-G * late):.4f} of free fall", file=sys.stderr)
    mass, momentum = p["alpha"].sum(), rho * p["U"]
    print(f"t = {1e3 * t:g} ms: alpha at the floor {p['alpha'][0]:.4f}, greatest {p['alpha'].max():.4f}, above 0.5 up to "
          f"{1e3 * p['y'][dense].max() if dense.any() else 0:.1f} mm, centre of mass {1e3 * p['alpha'] @ p['y'] / mass:.3f} mm, "
          f"least momentum {momentum.min():.1f} at {1e3 * p['y'][np.argmin(momentum)]:.1f} mm, T at the floor "
          f"{p['T'][0]:.3g}, greatest {p['T'].max():.3g} at {1e3 * p['y'][np.argmax(p['T'])]:.1f} mm", file=sys.stderr)
figures.save(fig, os.path.join(figures.folder(), "sedimentationMD.png"))
