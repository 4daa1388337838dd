# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of cases: profiles in one dimension, colours in two, cuts and surfaces in three, grains as what they are.

    wish = Wish(fields=["alpha"])
    figure = picture.draw(Space(haff.Case("cases/wedge")), wish)

What is not wished is chosen: the fields that one wants to see first, the last time, the whole range of values. CannotDraw says what a
case lacks.
"""
import dataclasses

import numpy as np

from haff.plot import quantity
from haff.plot.maps import sections, shown_values
from haff.plot.profiles import along_line, profiles, vector_part
from haff.plot.quantity import CannotDraw, GRAINS
from haff.plot.views import cuts, draw_grains, read_grains, surface_alone
from haff.plot.wish import chosen_times


def filmed(space, wish, time):
    """The values that a picture at a time gives colours to."""
    if wish.fields == [GRAINS]:
        return read_grains(space.case, time, wish)[2].values
    q = quantity.read(space.case, wish.fields[0], time, wish.component, along=vector_part(space, wish.fields[0], wish, time))
    return q.values if not wish.cut or space.dim < 3 else shown_values(q, space.cut(*wish.cut))


def draw(space, wish):
    """The figure of a case as wished."""
    case = space.case
    first = chosen_times(case, wish.time)[-1]
    if wish.fields == [GRAINS] or (not wish.fields and wish.plain and quantity.has_grains(case, first)):
        if not wish.plain:
            raise CannotDraw("grains are drawn where they are; -slice, -line, -iso and -volume are for fields")
        return draw_grains(space, wish)
    if wish.line:
        return along_line(space, wish)
    if space.dim == 1 and wish.cut:
        raise CannotDraw(f"{case.path} has cells along one axis only, which a plane cuts in one point; -line or no option shows the profile")
    if space.dim == 1 and not wish.plain:
        raise CannotDraw(f"{case.path} has one dimension; -iso and -volume are for three")
    if space.column is not None and wish.plain:
        return profiles(space, wish)
    if wish.cut and space.dim == 2:
        return along_line(space, dataclasses.replace(wish, line=line_of_cut(space, wish.cut), cut=None))
    if space.dim == 2:
        if wish.iso is not None or wish.volume:
            raise CannotDraw(f"{case.path} has two dimensions; -iso and -volume are for three, -contours N draws lines")
        return sections(space, wish)
    if wish.cut:
        return sections(space, wish)
    return surface_alone(space, wish) if wish.volume or wish.iso is not None else cuts(space, wish)


def line_of_cut(space, cut):
    """The line in which a plane cuts a case of two dimensions, from end to end."""
    normal, point = (np.asarray(v, float) for v in cut)
    away = ({0, 1, 2} - set(space.axes)).pop()
    along = np.cross(normal, np.eye(3)[away])
    if not np.linalg.norm(along):
        raise CannotDraw(f"{space.case.path} has no cells along {'xyz'[away]}, across which the plane lies; give x or y")
    along /= np.linalg.norm(along)
    middle = (space.low + space.high) / 2
    point = point.copy()
    point[away] = middle[away]
    free = [k for k in space.axes if abs(normal[k]) < 1e-12]
    for k in free:
        point[k] = middle[k]
    reach = np.linalg.norm(space.size) * 1.01
    a, b = point - reach * along, point + reach * along
    if len(free) == 1:  # along an axis: from its lower end to its upper one
        k = free[0]
        a, b = point.copy(), point.copy()
        a[k], b[k] = space.low[k], space.high[k]
    return tuple(a), tuple(b)
