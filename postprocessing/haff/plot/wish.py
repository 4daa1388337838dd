# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wished of a picture, and the times it is of."""
import dataclasses
import os

import numpy as np

from haff.plot import labels, quantity
from haff.plot.quantity import CannotDraw


@dataclasses.dataclass
class Wish:
    """fields: names, U.x is a component; time: a name, "last", "all" or several names; cut: (normal, point); mirror: (coordinate, place); line: (a, b); span: (low, high) of
    colours and values; size: (width, height) in pixels."""
    fields: list = dataclasses.field(default_factory=list)
    time: str = "last"
    cut: tuple = None
    mirror: tuple = None
    line: tuple = None
    component: str = None
    span: tuple = None
    log: bool = False
    contours: int = 0
    mesh: bool = False
    iso: float = None
    volume: bool = False
    size: tuple = None
    dpi: int = 150

    @property
    def plain(self):
        """No option is set that only fields have."""
        return not (self.line or self.cut or self.iso is not None or self.volume)

    def names(self):
        """Of the fields with their components, for the name of a file."""
        return [f if not self.component or "." in f else f"{f}.{self.component}" for f in self.fields]


# ---- times ----

def times_with_results(case):
    """Names of times that hold fields or grains; CannotDraw without any."""
    found = [t for t in case.times if quantity.known(case, t)]
    if not found:
        start = " (0.orig is where a run starts: granularGas makes time 0 of it)" if os.path.isdir(os.path.join(case.path, "0.orig")) else ""
        raise CannotDraw(f"{case.path} has no times with fields: run it first{start}")
    return found


def chosen_times(case, word):
    """The names of the times that a word asks for: last, all, a number, or numbers with commas between them."""
    if word in case.times and quantity.known(case, word):
        return [word]
    there = times_with_results(case)
    if word == "last":
        return there[-1:]
    if word == "all":
        return there
    return [named_time(case, w, there) for w in word.split(",")]


def named_time(case, word, there):
    """The time within 1e-6 of its own value, or of the span of all times, of a number."""
    try:
        wanted = float(word)
    except ValueError:
        raise CannotDraw(f"'{word}' is no time; the times are {some_of(there)}, last, all") from None
    nearest = min(there, key=lambda t: abs(float(t) - wanted))
    if abs(float(nearest) - wanted) > 1e-6 * max(abs(wanted), float(there[-1]) - float(there[0])):
        raise CannotDraw(f"{case.path} has no time {word}; the nearest is {nearest}, the times are {some_of(there)}")
    return nearest


def some_of(names, most=12):
    return " ".join(names) if len(names) <= most else " ".join(names[:6]) + " .. " + " ".join(names[-5:])


def spread(names, count):
    """At most that number of names, evenly from the first to the last."""
    if len(names) <= count:
        return list(names)
    return [names[i] for i in np.unique(np.rint(np.linspace(0, len(names) - 1, count)).astype(int))]


def at_time(case, time):
    return labels.with_time(time, labels.units(case.path))


def title(case, time=None):
    name = os.path.basename(os.path.abspath(case.path))
    return name if time is None else f"{name}    {at_time(case, time)}"
