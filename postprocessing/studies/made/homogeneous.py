# SPDX-License-Identifier: GPL-3.0-or-later
"""Homogeneous gases of grains: copies of the cases coolingGas and equationOfState with another dimension, packing and
restitution, run by granularMD, and what is measured in them. Lengths in diameters, T = 1 at the start.

    gas = Gas(folder, "cases/coolingGas", d=3, packing=0.2, grains=10000)
    gas.run(5)                      # elastic: the places become those of a fluid in equilibrium
    gas.run(30, restitution=0.9)
    t, T = temperatures(gas.case)
"""
import os
import shutil
import subprocess

import numpy as np

import haff
from haff.case import entries
from haff.start import enskog


def edit(path, **values):
    """Sets the first entry `key value;` of each key."""
    entries.edit(path, values, anywhere=True)


def to_spheres(path):
    """The dictionaries of a square become those of a cube: its front and back are periodic too."""
    for name in ("alpha", "T", "U"):
        file = os.path.join(path, "0.orig", name)
        with open(file) as f:
            text = f.read()
        with open(file, "w") as f:
            f.write(text.replace("type empty", "type cyclic"))
    file = os.path.join(path, "system", "meshDict")
    with open(file) as f:
        text = f.read()
    both = "    back { type cyclic; neighbourPatch front; }\n    front { type cyclic; neighbourPatch back; }\n}"
    with open(file, "w") as f:
        f.write(both.join(text.rsplit("}", 1)))


def short(x):
    """Six digits: the names of times that are multiples of it are exact."""
    return float(f"{x:.6g}")


def impact_rate(packing, d, T=1):
    """Of a grain, with the fit to simulations."""
    return float(enskog.collision_rate(packing, T, d, 1, enskog.simulated))


class Gas:
    def __init__(self, path, source, d, packing, grains, seed=1, cells=4):
        self.path, self.d, self.packing = path, d, packing
        self.length = (grains * enskog.volume(d, 1) / packing) ** (1 / d)
        shutil.rmtree(path, ignore_errors=True)
        for part in ("0.orig", "constant", "system"):
            shutil.copytree(os.path.join(source, part), os.path.join(path, part), ignore=shutil.ignore_patterns("polyMesh"))
        if d == 3:
            to_spheres(path)
        edit(os.path.join(path, "0.orig", "alpha"), internalField=f"uniform {packing}")
        edit(os.path.join(path, "constant", "particleProperties"), seed=seed)
        entries.drop(os.path.join(path, "system", "controlDict"), "vtk")
        msh = os.path.join(path, "mesh.msh")
        numbers = [w for k, v in (("D", d), ("L", self.length), ("N", cells)) for w in ("-setnumber", k, f"{v:.17g}")]
        for command in (["gmsh", "-3", "-v", "2", *numbers, os.path.join(source, "mesh.geo"), "-o", msh],
                        ["gmshToCase", msh, "-case", path]):
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        os.remove(msh)

    def run(self, end, interval=None, restitution=None):
        """On from the last time to `end`, writing every `interval` (default: at the end)."""
        if restitution is not None:
            edit(os.path.join(self.path, "constant", "granularProperties"), restitution=restitution)
        edit(os.path.join(self.path, "system", "controlDict"), endTime=f"{end:.12g}", writeInterval=f"{interval or end:.12g}")
        with open(os.path.join(self.path, "log.granularMD"), "a") as f:
            subprocess.run(["granularMD", "-case", self.path], check=True, stdout=f)
        self.case = haff.Case(self.path)

    def pressure(self, after):
        """p/(n T) of every window that ends after a time. T is the kinetic energy of all grains, n T is what they carry
        themselves: that cells have flows of their own by chance does not matter."""
        found = []
        for time in (t for t in self.case.times if float(t) > after * (1 + 1e-9)):
            rho, T, p, U = (self.case.field(name, time) for name in ("rho", "T", "p", "U"))
            energy = np.sum(rho * (T + np.sum(U**2, axis=1) / self.d))
            found.append(1 + np.sum(p - rho * T) / energy)
        return np.array(found)


def temperatures(case):
    """Times and T of all grains."""
    return case.table("grains", "grains.dat")[:, [0, 5]].T


def cooling(path, source, d, packing, e, number, seed=1, ratio=0.5):
    """Rate of cooling from T = 1 to about `ratio`, over that of Enskog's theory for T = 1; the start is an elastic gas of
    10 impacts a grain."""
    gas = Gas(path, source, d, packing, number, seed)
    begin = 10 / impact_rate(packing, d)
    zeta = float(enskog.cooling_rate(packing, 1, e, d, 1, enskog.simulated))
    gas.run(begin, restitution=1)
    end = begin + 2 / zeta * (ratio**-0.5 - 1)
    gas.run(end, restitution=e)
    t, T = temperatures(gas.case)
    first = np.argmin(np.abs(t - begin))
    return 2 * (T[-1] ** -0.5 - T[first] ** -0.5) / (t[-1] - t[first]) / zeta


def compressibility(path, source, d, packing, number, impacts, windows=20, seed=1):
    """p/(n T) of the elastic gas and its standard error, over `impacts` of each grain after 40 that make the start a fluid
    in equilibrium."""
    gas = Gas(path, source, d, packing, number, seed)
    interval = short(impacts / impact_rate(packing, d) / windows)
    first = np.ceil(40 * windows / impacts)
    gas.run((first + windows) * interval, interval, 1)
    z = gas.pressure(first * interval)
    return z.mean(), z.std(ddof=1) / np.sqrt(len(z))


def cooling_pressure(path, source, d, packing, e, number, seed=1, windows=8, ratio=0.5):
    """p/(n T) of a gas that cools from T = 1 to about `ratio`, the mean over windows; the start as in cooling()."""
    gas = Gas(path, source, d, packing, number, seed)
    zeta = float(enskog.cooling_rate(packing, 1, e, d, 1, enskog.simulated))
    interval = short(2 / zeta * (ratio**-0.5 - 1) / windows)
    begin = interval * np.ceil(10 / impact_rate(packing, d) / interval)
    gas.run(begin, interval, 1)
    gas.run(begin + windows * interval, interval, e)
    return gas.pressure(begin).mean()
