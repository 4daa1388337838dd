# SPDX-License-Identifier: GPL-3.0-or-later
"""A case directory: mesh, times, fields, values at points and on patches, tables of function objects."""
import functools
import os
import re

import numpy as np

from haff.case import blocks, foam, sample, tables, units
from haff.case.foam import Field, is_time, read_field
from haff.paths import suggestion


class Case:
    """A case directory. Times are the names of folders, ascending in value.

    Where a method takes a `time`, it may be such a name, a number (the nearest time is taken) or None (the last time). All numbers are
    in the units of the case, which `units` names. FileNotFoundError: the folder, a time or a field is not there; FormatError: a file is
    not what it should be.
    """

    def __init__(self, path):
        if not os.path.isdir(path):
            folder = os.path.dirname(os.path.abspath(path))
            raise FileNotFoundError(f"{path}: no such folder" + suggestion(os.path.basename(path), os.listdir(folder) if os.path.isdir(folder) else []))
        if not os.path.isdir(os.path.join(path, "system")):
            raise FileNotFoundError(f"{path} is no case directory (it has no folder 'system')")
        self.path = path

    # ---- mesh and times ----

    @property
    def times(self):
        """Names of the folders of times, ascending in value: a list of texts."""
        return sorted((n for n in os.listdir(self.path) if is_time(n)), key=float)

    @functools.cached_property
    def mesh(self):
        """The mesh.Mesh of constant/polyMesh or, without one, of system/blockMeshDict."""
        return blocks.mesh_of(self.path)

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
        """The name of the time nearest to a number; of the last time for None."""
        found = self._some_times()
        return found[-1] if value is None else min(found, key=lambda name: abs(float(name) - value))

    def _some_times(self):
        found = self.times
        if not found:
            raise FileNotFoundError(f"{self.path} has no times (folders like 0 or 0.5): run the case first")
        return found

    def later_times(self):
        """The names of all times after 0. FileNotFoundError: there are none."""
        found = [name for name in self._some_times() if float(name) > 0]
        if not found:
            raise FileNotFoundError(f"{self.path} has no times after 0: run the case first")
        return found

    def _time(self, time):
        return time if isinstance(time, str) else self.time(time)

    # ---- fields ----

    def fields(self, time=None):
        """Names of the fields on cells that a time has: a sorted list of texts."""
        folder = os.path.join(self.path, self._time(time))
        names = {n.removesuffix(".gz") for n in os.listdir(folder) if os.path.isfile(os.path.join(folder, n))}
        return sorted(n for n in names if re.fullmatch(r"vol\w+Field", foam.class_of(os.path.join(folder, n))))

    def field(self, name, time=None):
        """The internal field at a time: [cells] of a scalar; [cells][3] of a vector, [6] of a symmetric tensor, [9] of a tensor."""
        return read_field(self._field_path(name, time), self.mesh.cells)

    def _field_path(self, name, time):
        time = self._time(time)
        path = os.path.join(self.path, time, name)
        if os.path.isfile(path) or os.path.isfile(path + ".gz"):
            return path
        if not os.path.isdir(os.path.dirname(path)):
            raise FileNotFoundError(f"{self.path} has no time '{time}'; its times are: {', '.join(self.times) or 'none'}")
        if os.path.isdir(path):
            raise foam.FormatError(f"{path} is a folder, and no field: rename or remove it")
        known = self.fields(time)
        raise FileNotFoundError(f"{self.path} has no field '{name}' at time {time}{suggestion(name, known)} (fields there: {', '.join(known) or 'none'})")

    @functools.cached_property
    def units(self):
        """{"mass", "length", "time"}: what the numbers of the case are measured in, by its system/units; else kg, m, s."""
        return units.read(self.path)

    def unit(self, name, time=None):
        """The unit of a field as a short text: "m/s", "1/s", "kg/m^3"; "" where it has none. By the dimensions of its file."""
        return units.text(foam.exponents(self._field_path(name, time)), self.units)

    def patch_values(self, name, patch, time=None):
        """Values of a field on the faces of a patch: [faces], or [faces][components]; [0] on patches of type empty.

        They are those of the entry `value` where there is one. Without it, and where the type is zeroGradient, each face has the value
        of its cell; of that, a vector keeps on slip and symmetry the part along the face, and nothing on noSlip. A file of the start
        may give values by an expression or in time: those are not evaluated, and the cell's value stands. KeyError: the mesh has no
        such patch, or the file no entry for it.
        """
        if patch not in self.mesh.patches:
            raise KeyError(f"{self.path} has no patch '{patch}'{suggestion(patch, self.mesh.patches)} (patches: {', '.join(self.mesh.patches)})")
        kind, first, count = self.mesh.patches[patch]
        field = Field(self._field_path(name, time))
        if kind == "empty":
            return np.empty((0, field.components) if field.components > 1 else 0)
        said = self._said(field, patch)
        if said.value is not None and said.type != "zeroGradient":
            return field.spread(said.value, said.uniform, count, f"faces of patch {patch}")
        values = field.values(self.mesh.cells)[self.mesh.owner[first:first + count]]
        if field.components == 3 and said.type == "noSlip":
            return np.zeros_like(values)
        if field.components == 3 and said.type in ("slip", "symmetry", "symmetryPlane"):
            normal = self.mesh.face_geometry(first, first + count)[1]
            normal /= np.linalg.norm(normal, axis=1)[:, None]
            return values - np.einsum("ni,ni->n", values, normal)[:, None] * normal
        return values

    @staticmethod
    def _said(field, patch):
        """The Patch of that name in the file; else of the last pattern that fits."""
        patches = field.patches()
        if patch in patches:
            return patches[patch]
        for name in reversed(patches):
            if name.startswith('"') and re.fullmatch(name.strip('"'), patch):
                return patches[name]
        raise KeyError(f"{field.path}: boundaryField has no entry for the patch '{patch}'")

    def line(self, names, time=None):
        """x and fields of a one-dimensional case, ordered in x: arrays [cells]; of vectors the x component."""
        x = self.centres[:, 0]
        order = np.argsort(x)
        values = [self.field(name, time)[order] for name in names]
        return (x[order], *[v[:, 0] if v.ndim > 1 else v for v in values])

    # ---- values at points ----

    @functools.cached_property
    def finder(self):
        """The sample.Finder of the mesh: which cells hold points."""
        return sample.Finder(self)

    def cells_at(self, points):
        """The cells [n] that hold points [n][3] (m); -1 where none does. Along axes of one cell and empty patches any place will do."""
        return self.finder.cells(points)

    def sample(self, fields, points, time=None, order=1):
        """Values of a field at points [n][3] (m): [n] or [n][components]; of a list of fields: {name: values}. nan outside the mesh.

        order 1: the value of the cell that holds the point; order 2: with the cell's gradient, which is exact for linear fields, also
        beside walls. A point on a face has the value of one of its cells, the same in every run. ValueError for other orders.
        """
        names = [fields] if isinstance(fields, str) else list(fields)
        points = self.finder.flattened(points)
        cells = self.finder.cells(points)
        found = {name: self.finder.values(self.field(name, time), points, order, cells) for name in names}
        return found[fields] if isinstance(fields, str) else found

    def sample_line(self, fields, start, end, n=200, time=None, order=2):
        """n points from `start` to `end` (m, both among them): {"distance" [n] from the start, "x", "y", "z" [n], and each field}."""
        start, end = np.array(start, float), np.array(end, float)
        part = np.linspace(0, 1, n)
        points = start + np.outer(part, end - start)
        names = [fields] if isinstance(fields, str) else list(fields)
        values = self.sample(names, points, time, order)
        return {"distance": part * np.linalg.norm(end - start), **dict(zip("xyz", points.T)), **values}

    def slice(self, fields=(), normal="z", at=None, pixels=400, time=None, order=1):
        """A plane as a picture: the sample.Slice with its points, their cells and values of the fields; nan outside the mesh.

        normal: "x", "y", "z" or a vector; at: a point of the plane, its distance from 0 along the normal, or None (the middle of the
        mesh). On a lattice, planes across an axis have the cells themselves as their pixels; all others have `pixels` of them along the
        longer side. ValueError for a normal of length 0.
        """
        found = sample.cut(self.finder, sample.Plane(normal, at, self.finder), pixels)
        for name in [fields] if isinstance(fields, str) else fields:
            found.add(name, self.field(name, time), order)
        return found

    # ---- tables ----

    def tables(self):
        """The tables of function objects that there are: {function: [files]}."""
        return tables.there(os.path.join(self.path, "postProcessing"))

    def table(self, function, file=None, frame=False):
        """Rows of postProcessing/FUNCTION/START/FILE, those of all starts joined: rows of a later start replace what they repeat.

        Without frame: numbers [rows][columns]; vectors are spread out, words are nan. With frame=True: a pandas.DataFrame with the
        names of the columns, or where pandas is not installed a numpy structured array; table["Time"] is a column of both. Vectors have
        a column for each component (U_x, probe0_z), words stay. file may be left out where a function writes only one.
        FileNotFoundError names the functions and files that there are.
        """
        folder = os.path.join(self.path, "postProcessing", function)
        return tables.as_frame(folder, file) if frame else tables.as_array(folder, file)


def number(word):
    """The number that a word is; nan for other words."""
    return tables.number(word)
