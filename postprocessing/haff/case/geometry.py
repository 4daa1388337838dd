# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures of the cells of a case in the axes that are solved, and means over them."""
import numpy as np


class Geometry:
    """Of a case that reads like haff.Case: centres in the axes that are solved, volumes, cell size h."""

    def __init__(self, case):
        at, self.volumes = case.centres, case.volumes
        size = np.ptp(case.mesh.points, axis=0)
        self.axes = [a for a in range(3) if np.ptp(at[:, a]) > 1e-9 * size.max()]
        self.at = at[:, self.axes]
        across = np.prod([size[a] for a in range(3) if a not in self.axes])
        self.h = float((self.volumes.mean() / across) ** (1 / len(self.axes)))

    def mean(self, values):
        return float(values @ self.volumes / self.volumes.sum())

    def average(self, fine, state):
        """A state on a finer mesh, averaged over the cells whose centres are the nearest."""
        from scipy.spatial import cKDTree
        cell = cKDTree(self.at).query(fine.at)[1]
        volume = np.bincount(cell, fine.volumes, len(self.at))
        each = lambda v: np.bincount(cell, v * fine.volumes, len(self.at)) / volume
        return {name: each(v) if v.ndim == 1 else np.stack([each(c) for c in v.T], axis=1) for name, v in state.items()}
