# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes and runs cases of OpenFOAM's rhoCentralFoam: the dilute elastic gas, p = rho T, by other people's code.

T per unit mass is granularGas's T: molWeight makes the gas constant 1. Needs Debian's package openfoam and one variable in the
environment, WM_PROJECT_DIR.
"""
import os
import re
import shutil

from haff.openfoam.gas import UNIVERSAL
from haff.openfoam.mesh import ENVIRONMENT
from studies.made import boxes

MISSING = "rhoCentralFoam (package openfoam) is not installed"
SCHEMES = """fluxScheme Kurganov;
ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes { default none; div(tauMC) Gauss linear; }
laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; reconstruct(rho) vanLeer; reconstruct(U) vanLeerV; reconstruct(T) vanLeer; }
snGradSchemes { default corrected; }
"""
SOLUTION = """solvers
{
    "(rho|rhoU|rhoE)" { solver diagonal; }
    U { solver smoothSolver; smoother GaussSeidel; nSweeps 2; tolerance 1e-09; relTol 0.01; }
    e { $U; tolerance 1e-10; relTol 0; }
}
"""
GAS = """thermoType {{ type hePsiThermo; mixture pureMixture; transport const; thermo hConst; equationOfState perfectGas;
    specie specie; energy sensibleInternalEnergy; }}
mixture {{ specie {{ molWeight {weight!r}; }} thermodynamics {{ Cp {cp!r}; Hf 0; }} transport {{ mu 0; Pr 1; }} }}
"""


def installed():
    return shutil.which("rhoCentralFoam") and os.path.isdir(ENVIRONMENT["WM_PROJECT_DIR"])


def write(case, gamma, end, courant, fields, rules):
    """All but constant/polyMesh. fields: {"p", "U", "T": values in the cells}; rules: {"p", "U", "T": {patch: type, maybe with
    "; value uniform 1"}}. Writes at `end` only."""
    for name, values in fields.items():
        boxes.write_field(case, name, values, "\n".join(f"{patch} {rule}" for patch, rule in rules[name].items()), binary=True)
    control = boxes.CONTROL.format(**{**boxes.STANDARD, "end": end, "interval": end, "courant": courant})
    boxes.write_dictionary(case, "system", "controlDict", control.replace("granularGas", "rhoCentralFoam"))
    boxes.write_dictionary(case, "system", "fvSchemes", SCHEMES)
    boxes.write_dictionary(case, "system", "fvSolution", SOLUTION)
    boxes.write_dictionary(case, "constant", "thermophysicalProperties", GAS.format(cp=gamma / (gamma - 1), weight=UNIVERSAL))
    boxes.write_dictionary(case, "constant", "turbulenceProperties", "simulationType laminar;\n")


def progress(log):
    """Steps and seconds of the loop from what it printed."""
    return len(re.findall(r"^Time = ", log, re.M)), float(re.findall(r"ExecutionTime = ([\d.]+)", log)[-1])
