# SPDX-License-Identifier: GPL-3.0-or-later
"""Small cases with what a run leaves, for tests of reports: nothing is run."""
import contextlib
import json
import os
import unittest.mock

import numpy as np

from tests.postprocessing.plot import cases

TIMES = ("0", "0.5", "1", "2")
LOG = """haff 0.2.0 (git 0)
Mesh
    patch low              wall           3 faces
    lattice, 2D: x 12 cells of 0.1; y 8 cells of 0.1; 1 tiles
Models
    equationOfState        TorquatoDisks
    restitution            0.9
Control
    from time 0 (step 0) to 2, maxCo 1

warning: ./constant/g:3: a <b>made up</b> warning [madeUp]
warning: ./constant/g:3: a <b>made up</b> warning [madeUp]
end at time 2: 4 steps in 0.5 s, 1 million cell steps per second
"""
PROVENANCE = """FoamFile
{
    object      provenance;
}

version         "0.2.0 (git 0)";
host            "made";
dictionaries
{
    controlDict
    {
        application granularGas;
    }
}
"""


BLANK = {}  # pictures with nothing on them as data of a page, by their sizes


@contextlib.contextmanager
def white():
    """Figures are set up and saved, but nothing is drawn on them, which takes most of the time: for tests that do not look at pictures."""
    from matplotlib import figure, layout_engine
    from haff.report import pictures
    patch, encode = unittest.mock.patch.object, pictures.encoded

    def encoded(image):
        if image.size not in BLANK:
            BLANK[image.size] = encode(image)
        return BLANK[image.size]
    with patch(figure.Figure, "draw"), patch(layout_engine.ConstrainedLayoutEngine, "execute"), patch(pictures, "encoded", encoded):
        yield


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as f:
        f.write(text)


def results(path, at, times=TIMES):
    """Fields, log, provenance and tables at some times: a warm front that moves."""
    for time in times:
        front = np.exp(-((at[:, 0] - 0.3 * float(time)) ** 2))
        cases.fields(path, time, alpha=0.1 + 0.2 * front, T=1 + front, U=np.outer(front, (1.0, 0.2, 0)), rho=np.full(len(at), 3.0))
        write(os.path.join(path, time, "uniform", "provenance"), PROVENANCE)
    write(os.path.join(path, "log.granularGas"), LOG)
    rows = ["# Time\tstep\tdt\tlimiter\tCourant\talphaMin\talphaMax\tTMin\tTMax\tmass\tmassChange\tenergy\tenergyChange\tclockTime"]
    rows += [f"{t}\t{k}\t{0.5 if k else 0}\t{'Courant' if k else 'start'}\t1\t0.1\t{0.3 - 0.01 * k}\t1\t{2 + 0.1 * k}\t4\t{1e-15 * k}\t7\t{-0.1 * k}\t{0.1 * k}"
             for k, t in enumerate(times)]
    write(os.path.join(path, "postProcessing", "run", "0", "run.dat"), "\n".join(rows) + "\n")
    rows = ["# Time\t(total_x total_y total_z)", *(f"{t}\t({k} {2 * k} 0)" for k, t in enumerate(times))]
    write(os.path.join(path, "postProcessing", "drag", "0", "force.dat"), "\n".join(rows) + "\n")


def gas(path, n=(12, 8, 1), times=TIMES):
    """A gas in two dimensions, or in one with n = (20, 1, 1)."""
    results(path, cases.box(path, n, (0.1 * n[0], 0.1 * n[1], 0.1)), times)
    write(os.path.join(path, "expected.json"), json.dumps({"seconds": 1, "full": [
        {"quantity": "maximum", "field": "T", "time": 2, "value": 2, "tolerance": 0.1, "source": "made"},
        {"quantity": "minimum", "field": "T", "time": 2, "value": 9, "tolerance": 0.1, "source": "made"}]}))
    return path


def grains(path):
    """The same with a cloud of grains at its times."""
    gas(path)
    rng = np.random.default_rng(1)
    for time in TIMES:
        cases.cloud(path, time, rng.uniform(0, 0.8, (20, 3)) * (1, 1, 0), rng.normal(size=(20, 3)) * (1, 1, 0), np.full(20, 0.05))
    return path


def sweep(folder):
    """Two runs that have ended, and one that failed."""
    for value in ("0.8", "0.9"):
        gas(os.path.join(folder, f"restitution={value}"))
    rows = ["restitution,hottest,state,seconds,folder,error", "0.8,1.5,done,3.5,restitution=0.8,", "0.9,1.75,done,4,restitution=0.9,",
            '1.1,,failed,0,restitution=1.1,"restitution is at most 1"']
    write(os.path.join(folder, "sweep.csv"), "\n".join(rows) + "\n")
    write(os.path.join(folder, "sweep.json"), json.dumps({"case": "/somewhere/blast", "base": {}}))
    return folder
