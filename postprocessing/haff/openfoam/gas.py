# SPDX-License-Identifier: GPL-3.0-or-later
"""constant/thermophysicalProperties as R and gamma of a perfect gas; grains that stand for its molecules."""
import os

from haff.openfoam import dictionary
from haff.openfoam.dictionary import number
from haff.openfoam.report import Refused

UNIVERSAL = 8314.4700665  # J/kmol/K: p/(rho T) times molWeight of rhoCentralFoam 1912; later versions differ in the seventh digit
AVOGADRO = 6.02214e26  # 1/kmol
AIR = (28.96, 3.7e-10)  # kg/kmol, m: a molecule; others are as dense
FILES = ("thermophysicalProperties", "physicalProperties")  # the second: OpenFOAM.org from 10 on


class Gas:
    """R (m^2/s^2/K) and gamma; mass (kg) and diameter (m) of a grain."""

    def __init__(self, case, report):
        path = next((p for name in FILES if os.path.exists(p := os.path.join(case, "constant", name))), None)
        if not path:
            raise Refused(f"{case}/constant/thermophysicalProperties: no such file: a case of a compressible gas was expected")
        d = dictionary.read(path, case)
        self.check_type(d)
        mixture = d.get("mixture")
        if not isinstance(mixture, dictionary.Dictionary):
            raise Refused(f"{getattr(mixture, 'place', d.place)}: mixture is no dictionary: OpenFOAM before 2.2 wrote it so; convert the file to that of today")
        weight = number(mixture, "specie", "molWeight")
        if not weight > 0:
            raise Refused(f"{mixture['specie']['molWeight'].place}: molWeight {weight:g}: it must be positive")
        self.R, self.weight = UNIVERSAL / weight, weight
        self.gamma = self.ratio(d, mixture)
        self.mass, self.diameter = weight / AVOGADRO, AIR[1] * (weight / AIR[0]) ** (1 / 3)
        report.changed(mixture["specie"]["molWeight"].place, f"molWeight {weight:.10g} -> R = {self.R:.10g} m^2/s^2/K, and grains of the mass of a molecule")
        self.say_viscosity(d, mixture, report)

    def check_type(self, d):
        kind = d.get("thermoType")
        if not isinstance(kind, dictionary.Dictionary):
            raise Refused(f"{getattr(kind, 'place', d.place)}: thermoType is no dictionary: OpenFOAM before 2.2 wrote it so; convert the file to that of today")
        self.thermo = kind.get("thermo", "")
        wanted = {"equationOfState": (("perfectGas",), "haff has p = rho R T here, and no other equation of a gas, a liquid or a solid"),
                  "mixture": (("pureMixture",), "haff has one gas, no mixture and no chemistry"),
                  "thermo": (("hConst", "eConst"), "haff has one gamma, so Cp must be constant: take hConst with Cp at the temperature of the flow")}
        for key, (allowed, why) in wanted.items():
            if kind.get(key) not in allowed:
                raise Refused(f"{getattr(kind.get(key), 'place', kind.place)}: {key} {kind.get(key, 'is missing')}: {why} ({' or '.join(allowed)})")

    def ratio(self, d, mixture):
        key = "Cp" if self.thermo == "hConst" else "Cv"
        heat = number(mixture, "thermodynamics", key)
        place = mixture["thermodynamics"][key].place
        Cv = heat - self.R if key == "Cp" else heat
        if not (Cv > 0 and 1 + self.R / Cv < 3):
            raise Refused(f"{place}: {key} {heat:g} with R = {self.R:.6g} gives no gamma between 1 and 3")
        self.place, self.heat = place, f"{key} {heat:g}"
        return 1 + self.R / Cv

    def say_viscosity(self, d, mixture, report):
        report.changed(self.place, f"{self.heat} -> gamma {self.gamma:.10g}")
        kind, own = d["thermoType"].get("transport", "const"), mixture.get("transport", {})
        if kind == "const" and "mu" in own and number(mixture, "transport", "mu") == 0:
            report.took(own["mu"].place, "mu 0: inviscid, transport none")
        else:
            place = getattr(own, "place", d.place)
            mu = f"mu {own['mu']}" if "mu" in own else kind
            report.dropped(place, f"viscosity and heat conduction ({mu}): haff's are those of grains, not of a gas in kelvin; the gas is inviscid, walls slip")
