# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case, or a copy of it with other entries.

    haff run CASE                                                                  in its own folder
    haff run CASE constant/granularProperties:grain/restitution=0.9 mesh:N=100     in CASE-restitution=0.9,N=100

FILE:ENTRY=VALUE sets an entry of a file of the copy (ENTRY: names of dictionaries and of the entry, with / between them; + before it
makes one that is not there); mesh:NAME=VALUE a number of mesh.geo. A mesh that is not there is made. Ctrl-C stops the run, which
writes its state; the same command goes on from there. Prints the folder of the run.
"""
import os
import signal
import sys

from haff import command
from haff.runs.run import RunError, run


def setting(word):
    """(file, entry, value as text) of FILE:ENTRY=VALUE. ValueError."""
    place, equals, value = word.partition("=")
    file, colon, entry = place.partition(":")
    if not (equals and colon and file and entry and value):
        raise ValueError(f"'{word}' is no setting; needed: FILE:ENTRY=VALUE, as constant/granularProperties:grain/restitution=0.9, or mesh:NAME=VALUE")
    return file, entry, value


def settings(words, values=lambda text: text):
    """(changes, mesh) for haff.run, or for haff.sweep where values gives lists. ValueError."""
    changes, mesh = {}, {}
    for word in words:
        file, entry, text = setting(word)
        of = mesh if file == "mesh" else changes.setdefault(file, {})
        if entry in of:
            raise ValueError(f"{file}:{entry} is given twice")
        of[entry] = values(text)
    return changes, mesh


def reported(action, again):
    """Calls a function, whose errors are lines on stderr; the exit code. SIGTERM does what Ctrl-C does."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    try:
        return action()
    except KeyboardInterrupt:
        print(f"stopped; {again}", file=sys.stderr)
        return 130
    except RunError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.code if error.code > 0 else 128 - error.code
    except (OSError, ValueError, KeyError) as error:
        print(f"error: {command.message(error)}", file=sys.stderr)
        return 1


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case")
    parser.add_argument("settings", nargs="*", metavar="FILE:ENTRY=VALUE")
    parser.add_argument("-folder", help="of the copy (default: CASE-ENTRY=VALUE,..)")
    parser.add_argument("-ranks", "-np", type=int, default=1, metavar="N", help="of MPI")
    o = parser.parse_args()

    def action():
        changes, mesh = settings(o.settings)
        print(os.path.relpath(run(o.case, changes, mesh=mesh, ranks=o.ranks, folder=o.folder).path))
        return 0
    return reported(action, "the same command goes on from there")


if __name__ == "__main__":
    sys.exit(main())
