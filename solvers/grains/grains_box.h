/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The space of the grains from the case's mesh and the patch types of its field U: a box, if the mesh fills one with
 * equal cells, or what the facets of its walls bound. Axes are computational: the solved axes in order. */
#ifndef SOLVERS_GRAINS_BOX_H
#define SOLVERS_GRAINS_BOX_H

#include "solvers/case/case.h"
#include "solvers/grains/grains_mesh.h"
#include "solvers/grains/grains_models.h"

/* Fails unless two or three axes are solved. */
status grains_box_check(const struct setup *s);
/* Finds the patches through which grains leave, by the types of U; returns whether there is one. */
bool grains_box_open(const struct setup *s, const struct field *U, bool *open);
/* Does the mesh fill a box with equal cells, and has each of its sides one restitution? */
bool grains_box_is_full(const struct setup *s, const struct grains_models *m);
/* Makes the box; mesh: NULL if it is full. The patches of U must be walls or let
 * grains out (zeroGradient); other types are an error. */
status grains_box_make(const struct setup *s, const struct grains_models *m, const struct field *U,
                       const struct grains_mesh *mesh, struct grain_box *out);
/* Prints periodic axes and walls. */
void grains_box_print(FILE *f, const struct setup *s, const struct grains_models *m, const struct grain_box *b);
/* Returns the polyMesh cell that holds x (m); a place outside counts for the nearest cell. */
long grains_box_cell(const struct setup *s, const struct grains_mesh *mesh, const double x[3]);
/* Sets out to x along physical axes; along axes that are not solved it lies in the middle of the mesh. */
void grains_box_place(const struct setup *s, const double x[3], double out[3]);

#endif
