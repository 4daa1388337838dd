# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of grains or gas on a slope, and the friction and packing of grains that flow down a rough one: mu(I) and alpha(I)."""
import os

import numpy as np
from scipy.optimize import curve_fit

import haff

DIAMETER, DENSITY = 1e-3, 2600.0  # m, kg/m^3
LAYER, BULK = 1e-3, (3.4e-3, 9.6e-3)  # m: thickness of a layer; heights on a rough slope away from floor and surface
DYNAMIC = 1.0  # muDynamic
STOPS = 0.03  # inertial number: below it flows come to rest
SLOPES = "21", "22", "23", "24.5", "26", "29", "32"  # degrees: copies rough21 and so on of chuteDEM


def layers(case, times):
    """Means over times of the layers of a slope: y, u, alpha, and the pressure p, of grains across the slope, and their shear stress
    (Pa)."""
    alpha = np.mean([case.field("alpha", t) for t in times], axis=0)
    k = np.floor(case.centres[:, 1] / LAYER).astype(int)
    k, on = k - k.min(), alpha > 1e-4

    def mean(values, weight=np.ones(len(alpha))):
        return np.bincount(k, values * weight) / np.maximum(np.bincount(k, weight), 1e-300)

    def field(name, component):
        return np.mean([case.field(name, t)[:, component] for t in times], axis=0)
    found = {"y": mean(case.centres[:, 1]), "alpha": mean(alpha), "u": mean(field("U", 0), alpha * on)}
    if os.path.isfile(os.path.join(case.path, times[-1], "pShear")):
        found["shear"], found["p"] = -mean(field("pShear", 0)), mean(field("pComponents", 1))
    else:
        found["p"] = mean(np.mean([case.field("p", t) for t in times], axis=0))
    return found


def late(case):
    return [t for t in case.times if float(t) > 0.5 * float(case.times[-1]) + 1e-9]


def bulk(case):
    """Inertial number, shear stress over pressure and packing of the bulk of a rough slope in the second half of the run, each with the standard
    error of its layers."""
    a = layers(case, late(case))
    on = (a["y"] > BULK[0]) & (a["y"] < BULK[1])
    inertial = np.gradient(a["u"], a["y"])[on] * DIAMETER / np.sqrt(a["p"][on] / DENSITY)
    rows = inertial, a["shear"][on] / a["p"][on], a["alpha"][on]
    return [(float(r.mean()), float(r.std(ddof=1) / np.sqrt(len(r)))) for r in rows]


def law(inertial, static, dynamic, scale):
    return static + (dynamic - static) / (1 + scale / inertial)


def fit(rows):
    """muStatic, I0, packing at I = 0 and its slope, each with its standard error, of [slope][I, mu, alpha][value, error]. The errors follow from
    how far the slopes lie off the law. mu of slow flows is straight in I, so that muDynamic is given: DYNAMIC."""
    inertial, mu, alpha = (np.array([r[k] for r in rows]).T for k in range(3))
    found, spread = curve_fit(lambda i, static, scale: law(i, static, DYNAMIC, scale), inertial[0], mu[0], (0.38, 0.8), sigma=mu[1])
    line, of_line = np.polyfit(inertial[0], alpha[0], 1, w=1 / alpha[1], cov=True)
    return list(zip(found, np.sqrt(np.diag(spread)))) + [(line[1], of_line[1, 1] ** 0.5), (line[0], of_line[0, 0] ** 0.5)]


def measured(folder):
    """Rows of `fit` of the copies whose flow lasts (I > STOPS), and those of all by their slope."""
    rows = {slope: bulk(haff.Case(os.path.join(folder, "rough" + slope))) for slope in SLOPES}
    return [r for r in rows.values() if r[0][0] > STOPS], rows
