# SPDX-License-Identifier: GPL-3.0-or-later
"""Boxes of cells that lack axes along which gas moves all the same, and the same boxes with three periodic cells along each of
them: the flow must be the same to round-off."""
import os

import numpy as np

from tests.cases import harness, runs

boxes = harness.boxes
WIDE = 1e4  # three cells are so long that no time step, rate or number of stages feels them
SPHERES = {"eos": "TorquatoSpheres", "cooling": "GarzoDufty", "e": 0.9}
TRANSPORT = "transport GarzoDufty; GarzoDuftyCoeffs {{ zetaU full; stress {stress}; }}\n"


def make(path, n, rho, u, T, end, rules=None, thick=False, engine="lattice", fit="linear", viscous=True, stress="full",
         diffusion="RKJ2", solution="", **options):
    """n: cells along the axes, 0 for an axis that the mesh lacks, `thick`: that has three cells. rho, T: functions of places
    [cells][3], u: of places, to three components; all in the resolved axes alone. rules: {field: {patch: type}}, else slip walls
    and zeroGradient."""
    solved = [k > 0 for k in n]
    cells = np.array([k if k else 3 if thick else 1 for k in n])
    size = np.where(solved, 0.1 * cells, WIDE)
    at = boxes.centres(cells, size)
    inside = np.where(solved, at, 0)
    density, warm = rho(inside), T(inside)
    velocity = np.stack([v + 0 * density for v in u(inside)], axis=1)
    cyclic = {a: "cyclic" for a, s in zip("xyz", solved) if not s and thick}
    case = harness.box_case(path, cells, size, density, velocity, density, end, types=cyclic,
                            **{"adjust": "no", "step": 2e-3, **SPHERES, **options})
    os.remove(os.path.join(case, "0", "p"))
    rest = "".join(f'\n"{a}.*" {"cyclic" if thick else "empty"}' for a, s in zip("xyz", solved) if not s)
    patches = [a + side for a, s in zip("xyz", solved) if s for side in ("Low", "High")]
    for field, values, usual in (("U", velocity, "slip"), ("rho", density, "zeroGradient"), ("T", warm, "zeroGradient")):
        given = (rules or {}).get(field, {})
        boxes.write_field(case, field, values, "\n".join(f"{p} {given.get(p, usual)}" for p in patches) + rest)
    runs.add(case, "system/fvSchemes", f"meshEngine {engine}; polyReconstruct {fit};\n")
    if engine == "polyhedral":  # there the rule of fronts damps across a shock, too, but not on a line of cells
        runs.add(case, "system/fvSchemes", "commonCoeffs { fronts off; }\n")
    runs.add(case, "system/fvSolution", f"skipUniformAxes no; diffusion {{ type {diffusion}; }}\n" + solution)
    if viscous:
        path = os.path.join(case, "constant", "granularProperties")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("transport none;", TRANSPORT.format(stress=stress)))
    return case


def difference(thin, thick, n):
    """The largest difference of the fields of two cases made with the same n, over the fields' largest values; of all cells of the
    thick one."""
    most = 0
    for field in runs.FIELDS:
        one, three = (harness.haff.Case(c).field(field) for c in (thin, thick))
        one = one.reshape([k or 1 for k in n[::-1]] + [-1])
        three = three.reshape([k or 3 for k in n[::-1]] + [-1])
        most = max(most, np.abs(one - three).max() / np.abs(three).max())
    return most


def pair(folder, name, n, *state, **options):
    """Makes and runs both; returns their difference and the thin case."""
    cases = [make(os.path.join(folder, name, kind), n, *state, thick=kind == "thick", **options) for kind in ("thin", "thick")]
    for case in cases:
        harness.program("granularGas", "-case", case)
    return difference(*cases, n), cases[0]
