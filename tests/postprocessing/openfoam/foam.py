# SPDX-License-Identifier: GPL-3.0-or-later
"""A small case of rhoCentralFoam, written here: a box along x with an inlet and an outlet, or what a test makes of it."""
import os

HEADER = 'FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n'
GAS = """thermoType { type hePsiThermo; mixture pureMixture; transport const; thermo hConst; equationOfState perfectGas; specie specie;
    energy sensibleInternalEnergy; }
mixture { specie { molWeight 28.96; } thermodynamics { Cp 1004.5; Hf 0; } transport { mu 0; Pr 1; } }
"""
CONTROL = """application rhoCentralFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 0.005; deltaT 1e-06;
writeControl adjustable; writeInterval 0.005; writeFormat ascii; writePrecision 12; timeFormat general; timePrecision 6;
runTimeModifiable true; adjustTimeStep yes; maxCo 0.2; maxDeltaT 1; cycleWrite 0;
"""
SCHEMES = """fluxScheme Kurganov; ddtSchemes { default Euler; } gradSchemes { default Gauss linear; }
divSchemes { default none; div(tauMC) Gauss linear; } laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; reconstruct(rho) vanLeer; reconstruct(U) vanLeerV; reconstruct(T) vanLeer; }
snGradSchemes { default corrected; }
"""
SOLUTION = """solvers { "(rho|rhoU|rhoE)" { solver diagonal; } U { solver smoothSolver; smoother GaussSeidel; tolerance 1e-9; relTol 0.01; }
    e { $U; } h { $U; tolerance 1e-10; relTol 0; } }
"""
BLOCKS = """scale 1; n 100;
vertices ((-5 -1 -1) (5 -1 -1) (5 1 -1) (-5 1 -1) (-5 -1 1) (5 -1 1) (5 1 1) (-5 1 1));
blocks (hex (0 1 2 3 4 5 6 7) ($n 1 1) simpleGrading (1 1 1));
edges (); mergePatchPairs ();
boundary ( inlet { type patch; faces ((0 4 7 3)); } outlet { type patch; faces ((1 2 6 5)); } );
"""
TUBE = """defaultFieldValues ( volVectorFieldValue U (0 0 0) volScalarFieldValue T 348.432 volScalarFieldValue p 100000 );
regions ( boxToCell { box (0 -1 -1) (5 1 1); fieldValues ( volScalarFieldValue T 278.746 volScalarFieldValue p 10000 ); } );
"""
DIMENSIONS = {"p": "[1 -1 -2 0 0 0 0]", "T": "[0 0 0 1 0 0 0]", "U": "[0 1 -1 0 0 0 0]"}
UNIFORM = {"p": "uniform 1e5", "T": "uniform 300", "U": "uniform (100 0 0)"}
SIDES = "inlet { type fixedValue; value $internalField; } outlet { type zeroGradient; }"


def put(case, name, text, kind="dictionary"):
    path = os.path.join(case, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="latin-1") as f:
        f.write(HEADER.format(kind=kind, name=os.path.basename(name)) + text)


def field(case, name, sides=SIDES, internal=None, folder="0", dimensions=None):
    put(case, f"{folder}/{name}", f"dimensions {dimensions or DIMENSIONS[name]};\ninternalField {internal or UNIFORM[name]};\n"
        f"boundaryField\n{{\n{sides}\ndefaultFaces {{ type empty; }}\n}}\n", "volVectorField" if name == "U" else "volScalarField")


def write(folder, blocks=BLOCKS, **sides):
    """The case; sides: of U, p, T."""
    case = os.path.join(folder, "foam")
    for name, text in (("system/controlDict", CONTROL), ("system/fvSchemes", SCHEMES), ("system/fvSolution", SOLUTION), ("system/blockMeshDict", blocks),
                       ("constant/thermophysicalProperties", GAS), ("constant/turbulenceProperties", "simulationType laminar;\n")):
        put(case, name, text)
    for name in ("U", "p", "T"):
        field(case, name, sides.get(name, SIDES))
    return case


def tube(folder):
    """A shock tube by setFieldsDict, as 0.orig."""
    case = write(folder)
    for name in ("U", "p", "T"):
        os.remove(os.path.join(case, "0", name))
        field(case, name, '".*" { type zeroGradient; }', folder="0.orig", internal={"p": "uniform 0", "T": "uniform 1", "U": "uniform (0 0 0)"}[name])
    os.rmdir(os.path.join(case, "0"))
    put(case, "system/setFieldsDict", TUBE)
    return case
