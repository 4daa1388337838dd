#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What open sides reflect of sound, and what comes in from rest: the table of docs/userGuide.md.

    tests/bench/openSides.py [BIN]        BIN: folder of granularGas (build/bin)

A pulse of sound (1e-4 of p) in a perfect gas (5/3) that moves at Mach 0.23 along x meets a side upstream (an inlet) or downstream
(an outlet). R: the greatest p' of what comes back over that of the pulse, with its sign; 1: a wall, -1: a side of given pressure.
Inflow: the part of rho u that comes in in the first tenth of the time in which sound crosses, where the gas inside is at rest.
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "postprocessing"))
import haff  # noqa: E402
from studies.made import boxes  # noqa: E402

CELLS, GAMMA, SMALL, MACH = 400, 5 / 3, 1e-4, 0.23
X = (np.arange(CELLS) + 0.5) / CELLS
SPEED = np.sqrt(GAMMA)  # of sound, at rho = p = T = 1
U = MACH * SPEED
FLOW = "flowRateInletVelocity; %s %r; value uniform (0 0 0)"
FIXED, FREE = {"rho": "fixedValue; value uniform 1", "U": f"fixedValue; value uniform ({U!r} 0 0)", "T": "fixedValue; value uniform 1"}, "zeroGradient"
BOTH = {name: rule.replace("fixedValue; value", "inletOutlet; inletValue") for name, rule in FIXED.items()}
INLETS = {
    "U, rho, T `fixedValue`": FIXED,
    "U, T `fixedValue`, rho `zeroGradient`": {**FIXED, "rho": FREE},
    "U, rho `fixedValue`, T `zeroGradient`": {**FIXED, "T": FREE},
    "rho, T `fixedValue`, U `zeroGradient`": {**FIXED, "U": FREE},
    "`massFlowRate`, rho, T `fixedValue`": {**FIXED, "U": FLOW % ("massFlowRate", U / 100)},
    "`volumetricFlowRate`, rho, T `fixedValue`": {**FIXED, "U": FLOW % ("volumetricFlowRate", U / 100)},
    "`massFlowRate`, T `fixedValue`, rho `zeroGradient`": {**FIXED, "rho": FREE, "U": FLOW % ("massFlowRate", U / 100)},
    "all `inletOutlet`": BOTH,
    "all `zeroGradient`": dict.fromkeys(FIXED, FREE),
}
OUTLETS = {
    "all `zeroGradient`": dict.fromkeys(FIXED, FREE),
    "all `inletOutlet`": BOTH,
    "p `fixedValue`, U, rho `zeroGradient`": {"rho": FREE, "U": FREE, "p": "fixedValue; value uniform 1"},
    "all `fixedValue`": FIXED,
}


def run(folder, programs, rules, inlet, u, p, rho, end, other=None):
    """Runs the gas on a line with these rules on one side, and on the other side those of `other`; returns the case."""
    case = tempfile.mkdtemp(dir=folder)
    one = np.ones(CELLS)
    thermal = "p" if "p" in rules else "T"
    boxes.box_case(case, (CELLS, 1, 1), (1, 0.1, 0.1), rho, np.outer(u, (1, 0, 0)), p, end, eos="perfectGas", e=1.0, reconstruct="WPENO5",
                   stepper="SSPRK43", courant=1.0)
    os.remove(case + "/0/p")
    values = {"rho": rho, "U": np.outer(u, (1, 0, 0)), "p": p, "T": p / rho * one}
    other = other or {**FIXED, "p": FREE}
    for name in ("rho", "U", thermal):
        low, high = (rules[name], other[name]) if inlet else (other[name], rules[name])
        boxes.write_field(case, name, values[name], f'xLow {low}\nxHigh {high}\n"[yz].*" empty')
    done = subprocess.run([os.path.join(programs, "granularGas"), "-case", case], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stdout + done.stderr)
    return haff.Case(case)


def reflection(folder, programs, rules, inlet):
    """R of a pulse that runs towards the side from 0.3 away from it, and back as far."""
    side, way = (0.0, -1) if inlet else (1.0, 1)
    pulse = SMALL * np.exp(-((X - side + way * 0.3) / 0.05)**2)  # p'
    towards, back = SPEED + way * U, SPEED - way * U
    end = 0.3 / towards + 0.3 / back
    rho, u = 1 + pulse / SPEED**2, U + way * pulse / SPEED
    case = run(folder, programs, rules, inlet, u, 1 + pulse, rho, end)
    # characteristic of the sound that comes back, without the pulse of entropy, which has neither p' nor u'
    wave = 0.5 * (case.field("p") - 1 - way * SPEED * (case.field("U")[:, 0] - U))
    return wave[np.abs(wave).argmax()] / SMALL


def inflow(folder, programs, rules):
    one = np.ones(CELLS)
    end = 0.1 / SPEED
    case = run(folder, programs, rules, True, 0 * one, one, one, end, {"rho": FREE, "U": "slip", "T": FREE})
    return (case.field("rho") - 1).mean() / (U * end)


def main(programs):
    with tempfile.TemporaryDirectory() as folder:
        print("| inlet | R | from rest, of rho u |\n|---|---|---|")
        for name, rules in INLETS.items():
            print(f"| {name} | {reflection(folder, programs, rules, True):.2f} | {inflow(folder, programs, rules):.2f} |")
        print("\n| outlet | R |\n|---|---|")
        for name, rules in OUTLETS.items():
            print(f"| {name} | {reflection(folder, programs, rules, False):.2f} |")


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "build", "bin")))
