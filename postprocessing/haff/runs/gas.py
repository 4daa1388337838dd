# SPDX-License-Identifier: GPL-3.0-or-later
"""A gas that Python steps: a run of granularGas in this process.

    with haff.Gas("myCase") as gas:
        while not gas.ended:
            gas.step()
            print(gas.time, gas.T.mean())

It writes what granularGas writes, with the same bits, and holds the case's lock until it is closed. Fields are computed from the
state of the gas into new numpy arrays when they are asked for, once a step.
"""
import contextlib
import ctypes
import os
import sys

import numpy as np

from haff.paths import folder_of_programs
from haff.runs.run import RunError

LIBRARY = "haffgas.so"


class State(ctypes.Structure):
    """struct stepped_state of haffgas.c."""

    _fields_ = [("time", ctypes.c_double), ("steps", ctypes.c_long), ("cells", ctypes.c_long), ("ended", ctypes.c_int)]


def load():
    """The library, and the folder of the programs it belongs to. FileNotFoundError says what to do where it is not there."""
    folder = folder_of_programs()
    paths = [os.path.join(folder, "..", "lib", "haff", LIBRARY), os.path.join(folder, LIBRARY)]
    path = next(filter(os.path.exists, paths), None)
    if path is None:
        raise FileNotFoundError(f"{paths[1]} is not there: build haff (cmake --build build), or set HAFF_BIN to the folder of its programs")
    library = ctypes.CDLL(path)
    library.haff_field.restype = ctypes.c_char_p
    library.haff_state.restype = None
    return library, folder


class Gas:
    """A case of granularGas that is stepped from Python.

    case: its folder, with a mesh. log: where the log goes, a file name in the case; None: to standard output.

    time      s                     ended     has it reached endTime, or stopped?
    steps     since the case began  fields    {name: components} of all fields
    gas.alpha, gas.U, gas.T, ..     numpy arrays [cells] or [cells, 3], in the order of haff.Case(case).field

    A haff.RunError has the words of granularGas; the run has ended then."""

    opened = set()  # real paths of the cases that this process holds: their locks do not keep it out itself

    def __init__(self, case, log="log"):
        self._handle, self._stored = None, {}
        self.path = os.path.realpath(case)
        if any(int(os.environ.get(name, 1)) > 1 for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE")):
            raise ValueError("haff.Gas runs on one rank: start Python without mpirun, or take haff.run(.., ranks=N)")
        if self.path in self.opened:
            raise ValueError(f"{case}: this process has it open; call close() of that haff.Gas first")
        self._library, programs = load()
        self._log = None if log is None or not os.path.isdir(self.path) else os.path.join(self.path, log)
        if self._log:
            open(self._log, "w", encoding="utf-8").close()
        handle = ctypes.c_void_p()
        self._call("haff_open", os.fsencode(case), os.fsencode(programs), ctypes.byref(handle))
        self._handle = handle
        self.opened.add(self.path)
        components = ctypes.c_int()
        self._numbers, self.fields = {}, {}
        for i in range(self._library.haff_fields(handle)):
            if name := self._library.haff_field(handle, i, ctypes.byref(components)):
                self._numbers[name.decode()], self.fields[name.decode()] = i, components.value

    @contextlib.contextmanager
    def _logged(self):
        """What C prints meanwhile goes to the log."""
        if not self._log:
            yield
            return
        sys.stdout.flush()
        ctypes.CDLL(None).fflush(None)
        kept = os.dup(1)
        with open(self._log, "ab") as file:
            os.dup2(file.fileno(), 1)
            try:
                yield
            finally:
                ctypes.CDLL(None).fflush(None)
                os.dup2(kept, 1)
                os.close(kept)

    def _call(self, name, *arguments):
        """Calls a function that may fail."""
        error = ctypes.create_string_buffer(4096)
        with self._logged():
            code = getattr(self._library, name)(*arguments, error)
        if code:
            raise RunError("haff.Gas", code, self._log or "standard output", "error: " + error.value.decode(errors="replace"))

    def _state(self):
        if not self._handle:
            raise ValueError(f"{self.path}: this haff.Gas is closed")
        state = State()
        self._library.haff_state(self._handle, ctypes.byref(state))
        return state

    time = property(lambda self: self._state().time, doc="s")
    steps = property(lambda self: self._state().steps, doc="since the case began")
    ended = property(lambda self: bool(self._state().ended), doc="has it reached endTime, or stopped?")

    def step(self, until=float("inf")):
        """Takes one step, which ends at the time `until` at the latest, and returns its length (s)."""
        before = self._state()
        if before.ended:
            raise ValueError(f"{self.path}: the run has ended at {before.time:.10g}; a later endTime in system/controlDict lets a new one go on")
        if until <= before.time:
            raise ValueError(f"until = {until:.10g} is no later than the time now, {before.time:.10g}")
        self._stored = {}
        self._call("haff_step", self._handle, ctypes.c_double(until))
        return self.time - before.time

    def advance(self, time):
        """Takes steps until this time, at which the last one ends as at a written time; fewer where the run ends before."""
        while self.time < time and not self.ended:
            self.step(time)

    def field(self, name):
        """A field now, by its name: an array that stays as it is while the gas goes on."""
        cells = self._state().cells
        if name not in self.fields:
            raise KeyError(f"{name}: no such field; there are {' '.join(self.fields)}")
        if name not in self._stored:
            components = self.fields[name]
            values = np.empty((cells, components) if components > 1 else cells)
            self._call("haff_values", self._handle, self._numbers[name], values.ctypes.data_as(ctypes.POINTER(ctypes.c_double)))
            self._stored[name] = values
        return self._stored[name]

    def __getattr__(self, name):
        if not name.startswith("_") and name in self.__dict__.get("fields", ()):
            return self.field(name)
        raise AttributeError(name)

    def __dir__(self):
        return [*super().__dir__(), *self.fields]

    def write(self):
        """Writes the time now into the case, as granularGas does, and waits until it is on the disk."""
        self._state()
        self._call("haff_write", self._handle)

    def close(self):
        """Ends the run and gives the case free. What was written stays; the time now is not written."""
        handle, self._handle = self._handle, None
        if handle:
            self.opened.discard(self.path)
            self._call("haff_close", handle)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if sys.meta_path is not None and self.__dict__.get("_handle"):  # None: Python ends
            self.close()
