# SPDX-License-Identifier: GPL-3.0-or-later
"""haff in Python: cases, fields, pictures, runs and sweeps.

    import haff
    case = haff.Case("cases/wedge")
    x, y, z = case.centres.T
    alpha = case.field("alpha", case.times[-1])

haff.case    reads cases: meshes, fields, tables, grains (numpy)
haff.plot    pictures (matplotlib)
haff.runs    runs, steps and compares cases
haff.layers  measures layers on a plate
haff.report  reports of runs as HTML
haff.start   makes new cases

`python3 -m haff -help` lists what can be called from the command line.
"""
import importlib.util
import os
import sys

from haff.paths import lacking

if importlib.util.find_spec("numpy") is None:
    if os.path.basename(sys.argv[0]).startswith(("-m", "haff", "newCase")):
        sys.exit("haff: " + lacking("numpy"))  # a command ends in a sentence
    raise ImportError(lacking("numpy"))

from haff.case.case import Case, is_time, number
from haff.case.entries import EntryError
from haff.case.foam import FoamFile, FormatError, read_bytes, read_field
from haff.case.mesh import Mesh
from haff.runs.compare import Comparison, compare
from haff.runs.copies import ChangedCase
from haff.runs.ensemble import ensemble
from haff.runs.gas import Gas
from haff.runs.run import RunError, run
from haff.runs.sweep import sweep
