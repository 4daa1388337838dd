# SPDX-License-Identifier: GPL-3.0-or-later
"""A small sound case for test_bad_input.py: 6 x 4 cells with an inlet, a wall, a cyclic pair and an empty patch."""
import os

from tests.cases.harness import boxes

CELLS, SIZE = (6, 4, 1), (6.0, 4.0, 1.0)
TYPES = {"xLow": "patch", "xHigh": "wall", "y": "cyclic", "z": "empty"}

CONTROL = """application granularGas;
startFrom latestTime;
startTime 0;
stopAt endTime;
endTime 0.002;
deltaT 0.001;
adjustTimeStep no;
maxCo 0.5;
maxDeltaT 1;
writeControl adjustableRunTime;
writeInterval 0.001;
purgeWrite 0;
writeFormat ascii;
writePrecision 17;
writeCompression off;
timeFormat general;
timePrecision 6;
runTimeModifiable no;
functions
{
    points
    {
        type probes;
        fields (alpha U);
        probeLocations ((0.5 0.5 0.5) (3 2 0.5));
        writeControl timeStep;
        writeInterval 1;
    }
    lines
    {
        type sets;
        fields (T);
        sets
        {
            a
            {
                type uniform;
                axis x;
                start (0.5 1 0.5);
                end (5 1 0.5);
                nPoints 5;
            }
        }
        writeControl writeTime;
    }
    extremes { type fieldMinMax; fields (p); log false; }
    mass { type volFieldValue; fields (rho); operation volIntegrate; }
    vtk { type vtk; writeControl writeTime; }
}
"""
PROPERTIES = """grain
{
    diameter 0.1;
    mass 1;
    restitution 0.9;
}
equationOfState GoldshteinShapiro;
GoldshteinShapiroCoeffs
{
    gamma 1.6666666666666667;
    alphaMax 0.65;
    printedSoundSpeed no;
}
cooling Haff;
transport none;
"""
SCHEMES = """fluxScheme common;
reconstruct PHM;
timeScheme SSPRK3;
ddtSchemes {}
gradSchemes {}
divSchemes {}
"""
SOLUTION = """limits
{
    minDeltaTFraction 1e-3;
}
"""
GRAVITY = """dimensions [0 1 -2 0 0 0 0];
value (1 -2 0);
"""
SHAKING = """type sinusoidal;
amplitude 3;
frequency 1;
phase 0;
"""
BOUNDARY = """boundaryField
{{
    xLow
    {{
        type fixedValue;
        value uniform {value};
    }}
    xHigh
    {{
        type {wall};
    }}
    yLow
    {{
        type cyclic;
    }}
    yHigh
    {{
        type cyclic;
    }}
    zEmpty
    {{
        type empty;
    }}
}}
"""
LIST = "nonuniform List<scalar>\n24\n(\n" + "".join("%g\n" % (0.2 + 0.001 * i) for i in range(24)) + ")\n;\n"
ALPHA = ("dimensions [0 0 0 0 0 0 0];\ninternalField " + LIST + BOUNDARY.format(value="0.2", wall="zeroGradient"))
TEMPERATURE = ("dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 25;\n" + BOUNDARY.format(value="25", wall="slip"))
VELOCITY = ("dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (1 0.5 0);\n"
            + BOUNDARY.format(value="(1 0.5 0)", wall="slip"))

FILES = {"system/controlDict": ("dictionary", CONTROL), "system/fvSchemes": ("dictionary", SCHEMES),
         "system/fvSolution": ("dictionary", SOLUTION), "constant/granularProperties": ("dictionary", PROPERTIES),
         "constant/g": ("uniformDimensionedVectorField", GRAVITY), "constant/shaking": ("dictionary", SHAKING),
         "0/alpha": ("volScalarField", ALPHA), "0/T": ("volScalarField", TEMPERATURE),
         "0/U": ("volVectorField", VELOCITY)}


def header(path):
    folder, name = os.path.split(path)
    return boxes.header(FILES[path][0], name, folder)


def write(case):
    boxes.write_mesh(case, CELLS, SIZE, TYPES)
    for path, (_, text) in FILES.items():
        os.makedirs(os.path.join(case, os.path.dirname(path)), exist_ok=True)
        with open(os.path.join(case, path), "w") as f:
            f.write(header(path) + text)
    with open(os.path.join(case, "mesh.msh"), "w") as f:
        f.write(MSH2)


# Two quadrangles side by side, as gmsh writes them.
MSH2 = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "ends"
1 2 "sides"
2 3 "gas"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1 0 0
3 2 0 0
4 0 1 0
5 1 1 0
6 2 1 0
$EndNodes
$Elements
8
1 1 2 1 1 1 4
2 1 2 1 2 3 6
3 1 2 2 3 1 2
4 1 2 2 3 2 3
5 1 2 2 4 4 5
6 1 2 2 4 5 6
7 3 2 3 1 1 2 5 4
8 3 2 3 1 2 3 6 5
$EndElements
"""
