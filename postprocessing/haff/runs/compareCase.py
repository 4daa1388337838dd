# SPDX-License-Identifier: GPL-3.0-or-later
"""Two results beside each other: a gas and grains, two grids, two schemes, two codes.

    haff compare CASE OTHER [FIELD ..] [-times 0.1 0.2] [-o FIGURE.png] [-csv TABLE.csv]

At the times that both have (or those named), on the coarser of the two meshes. Prints a row for each time and field: L1 (mean difference), L2
(root of the mean square), max, scale (the range of CASE; of a vector its greatest length), relative (L1 over scale), x, y, z of the greatest
difference, and covered (the part of the mesh's volume in which both have values). FIGURE (png, pdf, svg) shows the last of the times.
"""
import sys

from haff import command
from haff.runs.compare import compare


def main():
    parser = command.parser(__doc__)
    parser.add_argument("case", metavar="CASE")
    parser.add_argument("other", metavar="OTHER")
    parser.add_argument("fields", nargs="*", metavar="FIELD")
    parser.add_argument("-times", type=float, nargs="+")
    parser.add_argument("-o", metavar="FIGURE", help="png, pdf or svg")
    parser.add_argument("-csv", metavar="TABLE")
    o = parser.parse_args()
    try:
        found = compare(o.case, o.other, o.fields or None, times=o.times, figure=o.o)
    except (ValueError, FileNotFoundError) as why:
        sys.exit(f"haff compare: {command.message(why)}")
    for text in found.notes:
        print(f"note: {text}", file=sys.stderr)
    if o.csv:
        found.write(o.csv)
    show = lambda v: v if isinstance(v, str) else f"{v:.4g}"
    print("  ".join(f"{name:>10}" for name in found.columns))
    for row in zip(*found.columns.values()):
        print("  ".join(f"{show(v):>10}" for v in row))


if __name__ == "__main__":
    main()
