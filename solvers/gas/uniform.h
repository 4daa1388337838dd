/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The axes along which a run is uniform to the bit: the forest then holds one layer of cells, which stands for all. */
#ifndef SOLVERS_UNIFORM_H
#define SOLVERS_UNIFORM_H

#include "solvers/gas/initial.h"

/* Sets l->uniform for each axis along which the state to start from and the rules of the patches are the same, bit by
 * bit. Such a run stays so: no model looks at a place, the order of additions belongs to the cell, and what a run reads
 * again while it runs, controlDict, holds neither states nor rules. Collective. */
status uniform_find(const struct polymesh *m, const struct initial *s, struct lattice *l);

#endif
