# SPDX-License-Identifier: GPL-3.0-or-later
"""The command lines of haffPlot and haffMovie: options, what is wrong with them, and where a picture goes without -o."""
import os
import re

from haff import command
from haff.case.case import Case
from haff.plot import quantity
from haff.plot.space import Space
from haff.plot.wish import Wish

FIGURES = os.path.join("postProcessing", "figures")
PARTS = ("x", "y", "z", "xx", "xy", "xz", "yy", "yz", "zz", "mag")


def add(parser, times=True):
    """The options that say what is shown and how."""
    if times:
        parser.add_argument("-time", metavar="T", default="last", help="last (default), all, a time, or several: 0.1,0.2")
    parser.add_argument("-slice", metavar="PLANE", help="x=0.5, y=.., z=.., or normal,point as nx,ny,nz:px,py,pz")
    parser.add_argument("-mirror", metavar="LINE", help="y=0: with the image beyond that line, as of a body of revolution; values are those of the mesh's half")
    parser.add_argument("-line", metavar="A:B", help="x0,y0,z0:x1,y1,z1: values along a line")
    parser.add_argument("-component", metavar="C", choices=PARTS, help="of vectors: x, y, z or mag (the size; default); also FIELD.x")
    parser.add_argument("-range", metavar="A:B", help="ends of the colours, or of the values of a curve")
    parser.add_argument("-log", action="store_true", help="logarithmic colours or values")
    parser.add_argument("-contours", metavar="N", type=int, default=0, help="N lines of equal values over the colours")
    parser.add_argument("-mesh", action="store_true", help="the edges of the cells")
    parser.add_argument("-iso", metavar="VALUE", type=float, help="3D: the surface on which the field has this value, alone")
    parser.add_argument("-volume", action="store_true", help="3D: the field as a cloud")
    parser.add_argument("-size", metavar="WxH", help="of the picture, in pixels")
    parser.add_argument("-dpi", type=int, default=150, help="pixels per inch: 150")


def parse(parser, words):
    """Parses words of which values may begin with a minus, and options may stand between the others."""
    valued = {o for a in parser._actions if a.nargs is None and a.option_strings for o in a.option_strings}
    joined, words = [], list(words)
    while words:
        word = words.pop(0)
        if word in valued and words and re.match(r"-[\d.]", words[0]):
            word = f"{word}={words.pop(0)}"
        joined.append(word)
    return parser.parse_intermixed_args(joined)


def numbers(parser, text, count, option, form):
    """So many numbers with commas between them; the command line is wrong otherwise."""
    try:
        found = tuple(float(w) for w in text.split(","))
    except ValueError:
        found = ()
    if len(found) != count:
        parser.error(f"{option} {text}: {form}")
    return found


def halves(parser, text, option, form):
    if text.count(":") != 1:
        parser.error(f"{option} {text}: {form}")
    return text.split(":")


def plane(parser, text):
    """(normal, point) of x=0.5 or of nx,ny,nz:px,py,pz."""
    form = "x=0.5, y=0.5, z=0.5, or a normal and a point: 1,1,0:0.5,0.5,0.5"
    simple = re.fullmatch(r"([xyz])=(.+)", text)
    if simple:
        axis = "xyz".index(simple.group(1))
        value, = numbers(parser, simple.group(2), 1, "-slice", form)
        return tuple(float(k == axis) for k in range(3)), tuple(value if k == axis else 0.0 for k in range(3))
    normal, point = (numbers(parser, part, 3, "-slice", form) for part in halves(parser, text, "-slice", form))
    if not any(normal):
        parser.error(f"-slice {text}: the normal is zero")
    return normal, point


def mirror(parser, text):
    """(coordinate, place) of y=0."""
    found = re.fullmatch(r"([xyz])=(.+)", text)
    if not found:
        parser.error(f"-mirror {text}: a coordinate and its place: y=0")
    return found.group(1), numbers(parser, found.group(2), 1, "-mirror", "y=0")[0]


def line(parser, text):
    form = "two points, x0,y0,z0:x1,y1,z1"
    return tuple(numbers(parser, part, 3, "-line", form) for part in halves(parser, text, "-line", form))


def span(parser, text):
    form = "two numbers, the lower first: 0:0.65"
    low, high = (numbers(parser, part, 1, "-range", form)[0] for part in halves(parser, text, "-range", form))
    if not low < high:
        parser.error(f"-range {text}: {form}")
    return low, high


def size(parser, text):
    found = re.fullmatch(r"(\d+)x(\d+)", text)
    if not found or not all(100 <= int(n) <= 20000 for n in found.groups()):
        parser.error(f"-size {text}: width and height in pixels, 100 to 20000 each: 1200x800")
    return tuple(int(n) for n in found.groups())


def wish(parser, o, fields):
    """The Wish of the options."""
    if o.contours < 0 or not 20 <= o.dpi <= 2000:
        parser.error(f"-contours {o.contours}: 0 or more" if o.contours < 0 else f"-dpi {o.dpi}: 20 to 2000")
    if sum(bool(x) for x in (o.slice, o.line, o.iso is not None, o.volume)) > 1:
        parser.error("one of -slice, -line, -iso, -volume at a time")
    cut = plane(parser, o.slice) if o.slice else None
    return Wish(fields=fields, time=getattr(o, "time", "last"), cut=cut, mirror=mirror(parser, o.mirror) if o.mirror else None, line=line(parser, o.line) if o.line else None,
                        component=o.component, span=span(parser, o.range) if o.range else None, log=o.log, contours=o.contours, mesh=o.mesh,
                        iso=o.iso, volume=o.volume, size=size(parser, o.size) if o.size else None, dpi=o.dpi)


def output(case, given, names, suffix):
    """The path to write: the given one, or NAMES.suffix in the folder of the case that is for pictures, which is made."""
    if given:
        return given
    folder = os.path.join(case.path, FIGURES)
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as e:
        raise quantity.CannotDraw(f"{folder} cannot be made ({e.strerror}); -o FILE writes elsewhere") from None
    return os.path.join(folder, "-".join(names) + suffix)


def space_of(path):
    """The Space of the case in a folder."""
    return Space(Case(path))


def parser(text):
    return command.parser(text)
