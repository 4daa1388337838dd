"""A case directory: mesh, times, fields, tables of function objects."""
import functools
import os
import re

import numpy as np

from haff.case.foam import read_field
from haff.case.mesh import Mesh


def is_time(name):
    return re.fullmatch(r"\d+(\.\d*)?([eE][-+]?\d+)?", name) is not None


class Case:
    """A case directory. Times are the names of folders, ascending in value."""

    def __init__(self, path):
        if not os.path.isdir(os.path.join(path, "system")):
            raise FileNotFoundError(f"{path} is no case directory (it has no folder 'system')")
        self.path = path

    @property
    def times(self):
        return sorted((n for n in os.listdir(self.path) if is_time(n)), key=float)

    @functools.cached_property
    def mesh(self):
        """The mesh.Mesh of constant/polyMesh."""
        return Mesh(os.path.join(self.path, "constant", "polyMesh"))

    def lattice(self):
        """The haff.case.lattice.Lattice that the cells are places of (edges along x, y, z, place of each cell), or None."""
        return self.mesh.lattice

    @functools.cached_property
    def _geometry(self):
        return self.mesh.cell_geometry()

    @functools.cached_property
    def centres(self):
        """Of the cells, [cells][3], in m."""
        found = self.lattice()
        return found.centres() if found else self._geometry[0]

    @functools.cached_property
    def volumes(self):
        """Of the cells, [cells], in m^3."""
        found = self.lattice()
        return found.volumes() if found else self._geometry[1]

    def time(self, value):
        """The name of the time nearest to a number."""
        return min(self.times, key=lambda name: abs(float(name) - value))

    def field(self, name, time=None):
        """The internal field at a time (name or number; default the last)."""
        time = self.times[-1] if time is None else time if isinstance(time, str) else self.time(time)
        return read_field(os.path.join(self.path, time, name), self.mesh.cells)

    def line(self, names, time=None):
        """x and fields of a one-dimensional case, ordered in x."""
        x = self.centres[:, 0]
        order = np.argsort(x)
        values = [self.field(name, time)[order] for name in names]
        return (x[order], *[v[:, 0] if v.ndim > 1 else v for v in values])

    def table(self, function, file):
        """Rows of postProcessing/FUNCTION/*/FILE, all starts joined; vectors are flattened. Words give nan."""
        folder = os.path.join(self.path, "postProcessing", function)
        rows = []
        for start in sorted(os.listdir(folder), key=float):
            with open(os.path.join(folder, start, file)) as f:
                rows += [[number(w) for w in re.sub(r"[()]", " ", line).split()]
                         for line in f if line.strip() and not line.startswith("#")]
        return np.array(rows)


def number(word):
    try:
        return float(word)
    except ValueError:
        return np.nan
