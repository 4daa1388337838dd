#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What local time steps in powers of two could save, counted from the written times of a run on any mesh of the solver.

    tests/bench/localSteps/count.py CASE [-times 0.1 0.3] [-most 5] [-rings 3]

The limit of a cell is the rate sum_k |u_k| girth_k + c total_girth, as libcore/polyhedral/cells.c has it. A cell of level l takes steps of
2^l times the shortest one. Levels of neighbours across a face differ by 1 at most. Printed for each time: the cells of each level, and the
work of equal steps over that of local steps,
    own      each cell at its own limit
    powers   at its level, without the rule for neighbours
    cells    at its level
    faces    each face at the lower level of its two cells: fluxes
    rings R  a step of a level also computes R rings of cells around the cells of this level: stages without a predictor
    size, rate  all of BATCH cells at the lowest of their levels, where cells stand in the order of their size, or of this rate
"""
import argparse
import os
import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../postprocessing"))
from haff.case.case import Case  # noqa: E402
from studies.exact import eos  # noqa: E402


BATCH = 32  # cells that are fitted together


class Cells:
    """Faces between cells, girths (1/m) along x, y, z and in all."""

    def __init__(self, case):
        mesh, volume = case.mesh, case.volumes
        area = np.abs(mesh.face_geometry()[1])
        inner, solved = len(mesh.neighbour), np.ones(len(mesh.owner), bool)
        for kind, first, count in mesh.patches.values():
            solved[first:first + count] = kind != "empty"
        size = np.linalg.norm(area, axis=1)
        self.left, self.right, self.n = mesh.owner[:inner], mesh.neighbour, mesh.cells
        self.faces = int(solved.sum())
        self.edge = mesh.owner[inner:][solved[inner:]]
        both = lambda a: (np.bincount(mesh.owner, a * solved, self.n) + np.bincount(self.right, a[:inner], self.n)) / (2 * volume)
        self.girth, self.total = np.stack([both(a) for a in area.T], axis=1), both(size)

    def widened(self, inside):
        """The cells of a set, and those across their faces."""
        wider = inside.copy()
        wider[self.left] |= inside[self.right]
        wider[self.right] |= inside[self.left]
        return wider

    def walk(self):
        """The place of each cell in a walk from neighbour to neighbour, breadth first."""
        links = coo_matrix((np.ones(len(self.left)), (self.left, self.right)), shape=(self.n, self.n))
        place = np.empty(self.n, int)
        place[breadth_first_order(links, 0, directed=False, return_predecessors=False)] = np.arange(self.n)
        return place

    def batched(self, level, key):
        """Levels lowered until batches of cells, in the order of a key and of the walk, have one level each."""
        batch = np.empty(self.n, int)
        batch[np.lexsort((self.walk(), key))] = np.arange(self.n) // BATCH
        while True:
            lowest = np.full(batch.max() + 1, level.max())
            np.minimum.at(lowest, batch, level)
            before, level = level, self.graded(lowest[batch])
            if (level == before).all():
                return level

    def graded(self, level):
        """Levels lowered until neighbours differ by 1 at most."""
        level = level.copy()
        while True:
            before = level.copy()
            np.minimum.at(level, self.left, before[self.right] + 1)
            np.minimum.at(level, self.right, before[self.left] + 1)
            if (level == before).all():
                return level


def rates(case, cells, time):
    state = eos.of_case(case)
    factor = np.pi * state.sigma**3 / 6 if hasattr(state, "sigma") else 1
    rho = case.field("alpha", time) / factor if hasattr(state, "sigma") else case.field("rho", time)
    c = state.c(rho, case.field("T", time))
    return np.einsum("ik,ik->i", np.abs(case.field("U", time)), cells.girth) + c * cells.total


def ringed(cells, level, rings, most):
    """Steps of cells, if a step of a level also computes rings around its cells."""
    work = 0
    for k in range(most + 1):
        inside = level == k
        for _ in range(rings):
            inside = cells.widened(inside)
        work += inside.sum() / 2**k
    return work


def count(cells, rate, most, rings):
    slack = rate.max() / rate
    plain = np.minimum(np.floor(np.log2(slack)).astype(int), most)
    level = cells.graded(plain)
    lower = np.minimum(level[cells.left], level[cells.right])
    batched = [cells.batched(level, np.floor(key)) for key in (4 * np.log2(cells.total), np.log2(slack))]
    fluxes = (0.5**lower).sum() + (0.5**level[cells.edge]).sum()
    return level, {"own": cells.n / (1 / slack).sum(), "powers": cells.n / (0.5**plain).sum(), "cells": cells.n / (0.5**level).sum(),
                   "faces": cells.faces / fluxes, f"rings {rings}": cells.n / ringed(cells, level, rings, most),
                   "size": cells.n / (0.5**batched[0]).sum(), "rate": cells.n / (0.5**batched[1]).sum()}


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case")
    parser.add_argument("-times", nargs="+")
    parser.add_argument("-most", type=int, default=5, help="highest level (5)")
    parser.add_argument("-rings", type=int, default=3, help="rings of the last count (3)")
    given = parser.parse_args(arguments)
    case = Case(given.case)
    cells = Cells(case)
    print(f"{case.path}: {cells.n} cells, {cells.faces} faces")
    for time in given.times or case.times:
        level, gain = count(cells, rates(case, cells, time), given.most, given.rings)
        shares = " ".join(f"{100 * n / cells.n:.1f}" for n in np.bincount(level, minlength=given.most + 1))
        print(f"t = {time}: % of cells of levels 0 ..: {shares}; gain " + ", ".join(f"{k} {v:.2f}" for k, v in gain.items()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
