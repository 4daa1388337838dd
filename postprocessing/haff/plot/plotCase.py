# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of any case, of what one wants to see first or of what one asks for.

    haffPlot CASE                                the main fields at the last time; prints the path of the picture
    haffPlot CASE T -time 0.5 -log               one field at a time, logarithmic colours
    haffPlot CASE U.x rho -o pair.pdf            two fields; png, pdf or svg by the suffix
    haffPlot CASE alpha -time all                one field at all times
    haffPlot CASE alpha -line 0,0,0:1,0,0        values along a line
    haffPlot CASE T -slice z=0.5 -contours 12    a cut through a case in three dimensions, with lines of equal values
    haffPlot CASE alpha -iso 0.3                 the surface on which alpha is 0.3
    haffPlot CASE alpha -volume                  alpha as a cloud
    haffPlot CASE grains -component x            grains, coloured by a component of their velocity

One dimension, or one axis with more than four cells: profiles at several times, of means across. Two: colours, with walls. Three: cuts
through the middle (of a lattice, or of what differs in the field) and the surface that parts high values from low ones. Grains: circles
or spheres, coloured by speed. Without -o the picture goes to CASE/postProcessing/figures/FIELD.png, and nothing else is written. Units
are those of CASE/system/units (length cm; mass g; time s;), else kg, m, s. Exit code: 2 for a wrong command line, 1 for a case that
cannot be drawn.
"""
import sys

from haff import command
from haff.plot import figures, options, picture, quantity
from haff.plot.wish import chosen_times


def names_of(space, wish):
    """Names of what is drawn, of which the name of the file is made."""
    if wish.fields:
        return wish.names()
    time = chosen_times(space.case, wish.time)[-1]
    if wish.plain and quantity.has_grains(space.case, time):
        return [quantity.GRAINS]
    names = quantity.main_fields(space.case, time)
    several = chosen_times(space.case, wish.time)[1:] and not wish.line
    if space.column is not None and wish.plain:
        return names
    return names[:1] if several or (space.dim == 3 and not wish.line and not wish.cut) else names


def plot(case, wish, path=None):
    """Draws the case in a folder as wished into a file, and prints its path."""
    if path:
        figures.kind(path)
    space = options.space_of(case)
    if quantity.GRAINS in wish.fields and len(wish.fields) > 1:
        raise quantity.CannotDraw("grains are drawn alone")
    names = names_of(space, wish)
    figure = picture.draw(space, wish)
    figures.save(figure, options.output(space.case, path, names, ".png"), dpi=wish.dpi)


def main():
    parser = options.parser(__doc__)
    parser.add_argument("case", metavar="CASE")
    parser.add_argument("fields", nargs="*", metavar="FIELD")
    options.add(parser)
    parser.add_argument("-o", metavar="FILE", help="written; .png, .pdf or .svg")
    o = options.parse(parser, sys.argv[1:])
    if o.o and not o.o.lower().endswith(tuple("." + f for f in figures.FORMATS)):
        parser.error(f"-o {o.o}: pictures are .png, .pdf or .svg")
    wish = options.wish(parser, o, o.fields)
    return command.ended("haffPlot", lambda: plot(o.case, wish, o.o))


if __name__ == "__main__":
    sys.exit(main())
