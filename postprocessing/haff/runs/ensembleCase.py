# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case of granularMD with several seeds, several runs at once, and writes the means over them with their standard errors.

    haff ensemble CASE -members 8 -cores 2        the same as  granularMD -ensemble 8 -np 2 -case CASE

Member k has the seed k and the folder CASE/ensemble/seed=k. The time folders of the case get the means: fields of the usual names, and
their standard errors: alphaError, UError, alphaError.big of alpha.big. Ctrl-C stops the members, which write their states; the same command goes on from there, also to a
later endTime or with more members. Exit code 1: the case cannot be an ensemble, or a member has failed.
"""
import os
import sys

from haff import command
from haff.runs import runCase
from haff.runs.ensemble import ensemble


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case")
    parser.add_argument("-members", type=int, required=True, metavar="N", help="number of runs, 2 or more")
    parser.add_argument("-cores", type=int, default=1, metavar="N", help="members that run at once (default 1)")
    parser.add_argument("-quiet", action="store_true", help="no line of progress on stderr")
    o = parser.parse_args()

    def action():
        print(os.path.relpath(ensemble(o.case, o.members, cores=o.cores, progress=not o.quiet).path))
        return 0
    return runCase.reported(action, "the same command goes on from there")


if __name__ == "__main__":
    sys.exit(main())
