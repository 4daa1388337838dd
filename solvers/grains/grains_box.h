/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The box of the grains from the case's mesh and the patch types of its field U. Axes are computational: the solved
 * axes in order. */
#ifndef SOLVERS_GRAINS_BOX_H
#define SOLVERS_GRAINS_BOX_H

#include "solvers/case/case.h"
#include "solvers/grains/grains_models.h"

/* Fails unless the mesh is a full box with two or three solved axes. */
status grains_box_check(const struct setup *s);
/* Makes the box. The patches of U must be walls; other types are an error. */
status grains_box_make(const struct setup *s, const struct grains_models *m, const struct field *U,
                       struct grain_box *out);
/* Returns the index of the cell that holds x (m), axis 0 fastest; a place outside counts for the nearest cell. */
long grains_box_cell(const struct lattice *l, const double x[3]);
/* Sets out to x along physical axes; along axes that are not solved it lies in the middle of the mesh. */
void grains_box_place(const struct setup *s, const double x[3], double out[3]);

#endif
