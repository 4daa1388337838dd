# SPDX-License-Identifier: GPL-3.0-or-later
"""What the figure.py of a case begins and ends with: which run is drawn, and where the figure goes.

    haff figure CASE [RUN] [-keep] [-format png|pdf|svg]

draws what CASE/figure.py draws (CASE may also name such a script), of the run in the folder CASE or in RUN, into
postProcessing/figures of that folder; -keep writes beside the script instead, as the repository keeps it. Prints the paths.
"""
import functools
import os
import runpy
import sys

from haff import command, paths
from haff.plot import figures


@functools.lru_cache
def options():
    parser = command.parser(__doc__, prog=os.path.basename(sys.argv[0]))
    parser.add_argument("run", nargs="?", default=here(), help="folder of the run")
    parser.add_argument("-keep", action="store_true", help="write beside the script")
    parser.add_argument("-format", choices=("png", "pdf", "svg"), default="png")
    return parser.parse_args()


def here(*parts):
    """The folder of the script that runs, or a path from there."""
    return os.path.join(os.path.dirname(os.path.abspath(sys.argv[0])), *parts)


def folder(*parts):
    """The folder of the run that is drawn, or a path from there."""
    return os.path.join(os.path.abspath(options().run), *parts)


def target(name):
    """The path of the figure `name`, or of a table `name.csv`; its folder is made."""
    place = here() if options().keep else folder("postProcessing", "figures")
    os.makedirs(place, exist_ok=True)
    return os.path.join(place, name if "." in name else f"{name}.{options().format}")


def save(figure, name):
    """Writes the figure `name` and prints its path."""
    figures.save(figure, target(name))


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-help", "-h", "--help"):
        print(__doc__)
        sys.exit(0 if len(sys.argv) > 1 else 2)
    if sys.argv[1] in ("-version", "--version"):
        print(command.version_text("haff figure"))
        return
    case = sys.argv[1]
    path = os.path.join(case, "figure.py") if os.path.isdir(case) else case
    if not os.path.isfile(path):
        sys.exit(f"haff figure: {case} has no figure.py; haffPlot draws any case")
    if paths.has_studies():
        paths.find_studies()
    sys.argv = [path, *sys.argv[2:]]
    sys.exit(command.ended(f"haff figure {case}", lambda: runpy.run_path(path, run_name="__main__") and 0))


if __name__ == "__main__":
    main()
