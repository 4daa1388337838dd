# SPDX-License-Identifier: GPL-3.0-or-later
"""Names, symbols, units and colours of quantities, for axes and titles. Without matplotlib, so that who only reads times starts fast."""
from haff.case.units import SI
from haff.case.units import read as units  # noqa: F401

NAMES = {  # name of a field: what it is, its symbol, its colours
    "alpha": ("packing fraction", r"$\alpha$", "viridis"),
    "rho": ("density", r"$\rho$", "viridis"),
    "T": ("temperature", "$T$", "magma"),
    "p": ("pressure", "$p$", "cividis"),
    "U": ("velocity", "$U$", "cividis"),
    "rhoU": ("momentum", r"$\rho U$", "cividis"),
    "rhoE": ("energy", r"$\rho E$", "magma"),
    "Ma": ("Mach number", "Ma", "cividis"),
    "c": ("speed of sound", "$c$", "cividis"),
    "phi": ("fraction of small grains", r"$\phi$", "cividis"),
    "vorticity": ("vorticity", r"$\omega$", "viridis"),
    "gradAlpha": ("gradient of the packing", r"$\nabla\alpha$", "viridis"),
    "stressRatio": ("friction: shear stress over pressure", r"$|\tau|/p$", "magma"),
    "Kn": ("Knudsen number", "Kn", "magma"),
    "limited": ("limited faces", "limited faces", "magma"),
}
SIGNED = "RdBu_r"  # for values of both signs
PAPER = {"mass": "", "length": "cm", "time": "s"}
DIMENSIONS = {"x": (0, 1, 0), "y": (0, 1, 0), "z": (0, 1, 0), "t": (0, 0, 1), "rho": (1, -3, 0), "alpha": (0, 0, 0), "T": (0, 2, -2),
              "p": (1, -1, -2), "U": (0, 1, -1), "rhoU": (1, -2, -1), "rhoE": (1, -1, -2), "c": (0, 1, -1), "Ma": (0, 0, 0), "phi": (0, 0, 0)}
AXES = {"impedance": r"impedance $\rho c_s$ (cm$^{-2}$ s$^{-1}$)"}


def unit(dimensions, of=SI):
    """The unit of a quantity with exponents of mass, length and time, as "cm$^2$ s$^{-2}$"; empty where it has none, and where the
    unit of its length or of its time has no name. A mass without a name is that of a grain: 1."""
    words = []
    if any(power and not of[name] for name, power in zip(("length", "time"), dimensions[1:3])):
        return ""
    for name, power in zip(("mass", "length", "time"), dimensions):
        if power and of[name]:
            words.append(of[name] if power == 1 else f"{of[name]}$^{{{power:g}}}$")
    return " ".join(words)


def with_unit(text, dimensions, of=SI):
    measured = unit(dimensions, of)
    return f"{text} ({measured})" if measured else text


def with_time(time, of=SI):
    """A time as it stands in a title: t = 0.05 s."""
    return f"$t$ = {float(time):.6g} {of['time']}".rstrip()


def axis(name, of=PAPER):
    """What stands along an axis: "x", "t", a field."""
    if name in NAMES and name in DIMENSIONS:
        return with_unit(" ".join(dict.fromkeys(NAMES[name][:2])), DIMENSIONS[name], of)
    return with_unit(f"${name}$", DIMENSIONS[name], of) if name in DIMENSIONS else AXES.get(name, name)


AXES.update({name: axis(name) for name in DIMENSIONS})
