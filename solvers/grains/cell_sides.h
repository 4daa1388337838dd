/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds cells that are convex and have flat faces by half spaces, several times as fast as mesh/grid/search.h finds
 * cells of any shape. */
#ifndef SOLVERS_CELL_SIDES_H
#define SOLVERS_CELL_SIDES_H

#include "mesh/format/polymesh.h"

struct cell_sides;
/* axis[dim]: the solved axes; bounds[cells]: low and high corner (m) of each cell along them. *out stays NULL if a cell
 * has a face that is not flat, or is not convex. */
status cell_sides_make(const struct polymesh *m, int dim, const int axis[3], const double (*bounds)[6],
                       struct cell_sides **out);
void cell_sides_free(struct cell_sides *s);
/* Returns the cell that holds x (m, along the solved axes), the lowest of those that share it. *inside: false if none
 * does; then it is the nearest one of those about x, -1: there is none. */
long cell_sides_find(const struct cell_sides *s, const double x[3], bool *inside);

#endif
